"""Commands on types: ``fibws msg``, as rosmsg, and ``fibws srv``, as rossrv."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from pathlib import Path
from typing import TYPE_CHECKING

import click

from fibws.cli import completers, output
from fibws.cli.arguments import piped_input
from fibws.cli.common_options import hub_option, json_option
from fibws.client.hub_client import HubClient
from fibws.errors import (
    AccessDenied,
    HubUnreachable,
    InvalidTypeName,
    ServiceError,
    UnknownPackage,
    UnknownType,
)
from fibws.suggestions import suggestion
from fibws.values.type_definitions import InstalledTypes, typedefs_lines
from fibws.values.typedefs import Typedefs

if TYPE_CHECKING:
    from fibws.interfaces.folders import Kind

NOUNS: dict[Kind, str] = {"msg": "message", "srv": "service", "action": "action"}
EXAMPLES: dict[Kind, str] = {
    "msg": "std_msgs/String",
    "srv": "std_srvs/Trigger",
    "action": "example_interfaces/Fibonacci",
}

_folders = click.option(
    "--interfaces",
    "folders",
    type=click.Path(path_type=Path),
    multiple=True,
    metavar="FOLDER",
    help="Folder of definitions (PACKAGE/msg/*.msg); may be repeated.  [$FIBWS_INTERFACES]",
)
_single_line = click.option("-s", "single_line", is_flag=True, help="List all in a single line.")


def group(kind: Kind) -> click.Group:
    """Return the commands on the types of one kind."""
    noun = NOUNS[kind]
    commands = [_list(kind), _md5(kind), _package(kind), _packages(kind)]
    return click.Group(
        "types",
        commands=[show(kind), show(kind, "info"), *commands],
        help=f"Show {noun} types.",
    )


def show(kind: Kind, name: str = "show") -> click.Command:
    """Return the command that prints the definition of a type."""

    @click.command(name, help=_help_of_show(kind))
    @_type_argument(kind)
    @click.option("-r", "--raw", is_flag=True, help="Print the file, with comments.")
    @_folders
    @hub_option
    def command(type_: str | None, raw: bool, folders: tuple[Path, ...], hub: str | None) -> None:
        installed, type_ = InstalledTypes(kind, folders), _given(type_, kind)
        if "/" in type_:
            output.line(_definition(installed, kind, type_, hub, raw=raw))
            return
        for found in _in_all_packages(installed, kind, type_):
            output.line(f"[{found}]:")
            output.line(_definition(installed, kind, found, hub, raw=raw))

    return command


def _help_of_show(kind: Kind) -> str:
    example = EXAMPLES[kind]
    return f"""Print the definition of TYPE, such as {example}.

    {example.partition("/")[2]}, without a package, prints each {NOUNS[kind]} of that name. Without
    TYPE, its name is read from standard input. Types without a definition on this machine are
    requested from the hub.
    """


def _list(kind: Kind) -> click.Command:
    @click.command("list", help=f"List all {NOUNS[kind]}s.")
    @_folders
    @json_option
    def command(folders: tuple[Path, ...], as_json: bool) -> None:
        _print(InstalledTypes(kind, folders).all(), as_json=as_json)

    return command


def _md5(kind: Kind) -> click.Command:
    @click.command("md5", help="Print the MD5 of TYPE.")
    @_type_argument(kind)
    @_folders
    def command(type_: str | None, folders: tuple[Path, ...]) -> None:
        installed, type_ = InstalledTypes(kind, folders), _given(type_, kind)
        if "/" not in type_:
            for found in _in_all_packages(installed, kind, type_):
                output.line(f"[{found}]: {installed.md5(found)}")
            return
        try:
            output.line(installed.md5(type_))
        except (UnknownPackage, UnknownType):
            raise _unknown(installed, kind, type_) from None

    return command


def _package(kind: Kind) -> click.Command:
    @click.command("package", help=f"List the {NOUNS[kind]}s of PACKAGE.")
    @click.argument("package", shell_complete=completers.packages(kind))
    @_single_line
    @_folders
    @json_option
    def command(package: str, single_line: bool, folders: tuple[Path, ...], as_json: bool) -> None:
        installed = InstalledTypes(kind, folders)
        try:
            names = installed.names(package)
        except UnknownPackage:
            text = f"Unknown package {package}{suggestion(package, installed.packages())}"
            raise click.ClickException(text) from None
        _print(names, single_line=single_line, as_json=as_json)

    return command


def _packages(kind: Kind) -> click.Command:
    @click.command("packages", help=f"List the packages with {NOUNS[kind]}s.")
    @_single_line
    @_folders
    @json_option
    def command(single_line: bool, folders: tuple[Path, ...], as_json: bool) -> None:
        names = InstalledTypes(kind, folders).packages()
        _print(names, single_line=single_line, as_json=as_json)

    return command


def _type_argument(kind: Kind) -> Callable[[Callable[..., None]], Callable[..., None]]:
    types = completers.defined(kind, short=True)
    return click.argument("type_", metavar="[TYPE]", required=False, shell_complete=types)


def _given(type_: str | None, kind: Kind) -> str:
    """Return the argument TYPE, or the first line of input: ``fibws topic type /x | ...``."""
    if type_ is None:
        type_ = next((line.strip() for line in piped_input() or () if line.strip()), None)
    if type_ is None:
        raise click.UsageError(f"Missing argument 'TYPE', such as {EXAMPLES[kind]}.")
    return type_.removesuffix(f".{kind}")


def _in_all_packages(installed: InstalledTypes, kind: Kind, short: str) -> list[str]:
    found = installed.find(short)
    if not found:
        nearest = installed.nearest(short)
        meant = f"; did you mean {nearest}?" if nearest else ""
        raise click.ClickException(f"Could not find {kind} '{short}'{meant}")
    return found


def _definition(
    installed: InstalledTypes, kind: Kind, type_: str, hub: str | None, *, raw: bool
) -> str:
    """Return a definition in the format of rosmsg, which ends with a line break."""
    try:
        definition = installed.definition(type_)
        return definition.text if raw else _text(definition.lines)
    except InvalidTypeName:
        raise click.UsageError(f"invalid type {type_!r}: expected package/Type") from None
    except (UnknownPackage, UnknownType):
        lines = _lines_from_hub(installed, kind, type_, hub)
        if raw:
            text = f"-r: only the hub defines {type_}, and it does not send the original text"
            raise click.ClickException(text) from None
        return _text(lines)


def _text(lines: Iterable[str]) -> str:
    return "".join(f"{line}\n" for line in lines)


def _lines_from_hub(
    installed: InstalledTypes, kind: Kind, type_: str, hub: str | None
) -> list[str]:
    """Return the lines of a type that only the hub may define."""
    try:
        with HubClient("tool", hub) as client:
            try:
                first, *others = [typedefs_lines(part) for part in _typedefs(client, kind, type_)]
            except ServiceError:
                where = f"on this machine or at the hub {client.url}"
                raise _unknown(installed, kind, type_, where) from None
    except AccessDenied:
        raise
    except HubUnreachable as error:
        where = f"on this machine, and the hub {error.url} cannot be reached"
        raise _unknown(installed, kind, type_, where) from None
    return [*first, *(line for part in others for line in ("---", *part))]


def _typedefs(client: HubClient, kind: Kind, type_: str) -> list[Typedefs]:
    if kind == "msg":
        return [Typedefs.of_message(client, type_)]
    if kind == "srv":
        return [Typedefs.of_request(client, type_), Typedefs.of_response(client, type_)]
    return [Typedefs.of_message(client, type_ + part) for part in ("Goal", "Result", "Feedback")]


def _unknown(
    installed: InstalledTypes, kind: Kind, type_: str, where: str = "on this machine"
) -> click.ClickException:
    nearest = installed.nearest(type_)
    meant = f"did you mean {nearest}?" if nearest else "see --interfaces and $FIBWS_INTERFACES"
    return click.ClickException(
        f"Unknown {NOUNS[kind]} type {type_}: no definition {where}; {meant}"
    )


def _print(names: Iterable[str], *, single_line: bool = False, as_json: bool = False) -> None:
    if as_json:
        for name in names:
            output.as_json(name)
    elif single_line:
        output.line(" ".join(names))
    else:
        for name in names:
            output.line(name)
