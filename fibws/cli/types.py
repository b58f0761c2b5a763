"""The commands on types: those of rosmsg for messages, those of rossrv for services."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

import click

from fibws.cli import completers, output
from fibws.cli.arguments import piped_input
from fibws.cli.common_options import hub_option, json_option
from fibws.client.hub_client import HubClient
from fibws.errors import (
    HubUnreachable,
    InvalidTypeName,
    ServiceError,
    UnknownPackage,
    UnknownType,
)
from fibws.suggestions import suggestion
from fibws.values import type_text
from fibws.values.typedefs import Typedefs

if TYPE_CHECKING:
    from fibws.interfaces.folders import Kind
    from fibws.values.installed_types import Installed

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
    """The commands on the types of one kind."""
    noun = NOUNS[kind]
    commands = [_list(kind), _md5(kind), _package(kind), _packages(kind)]
    return click.Group(
        "types",
        commands=[show(kind), show(kind, "info"), *commands],
        help=f"Look at the types of {noun}s.",
    )


def show(kind: Kind, name: str = "show") -> click.Command:
    """The command that prints the definition of a type."""

    @click.command(name, help=_help_of_show(kind))
    @_type_argument(kind)
    @click.option("-r", "--raw", is_flag=True, help="Print the file's text, comments and all.")
    @_folders
    @hub_option
    def command(type_: str | None, raw: bool, folders: tuple[Path, ...], hub: str | None) -> None:
        installed, type_ = _installed(kind, folders), _read(type_, kind)
        if "/" in type_:
            output.line(_shown(installed, kind, type_, hub, raw=raw))
            return
        for found in _found(installed, kind, type_):
            output.line(f"[{found}]:")
            output.line(_shown(installed, kind, found, hub, raw=raw))

    return command


def _help_of_show(kind: Kind) -> str:
    example = EXAMPLES[kind]
    return f"""Print the definition of TYPE, such as {example}.

    Without its package, {example.partition("/")[2]}, every {NOUNS[kind]} of that name is printed.
    Without TYPE, it is read from a pipe. What this machine has no definition of is asked of the
    hub.
    """


def _list(kind: Kind) -> click.Command:
    @click.command("list", help=f"List all {NOUNS[kind]}s.")
    @_folders
    @json_option
    def command(folders: tuple[Path, ...], as_json: bool) -> None:
        _print(_installed(kind, folders).all(), as_json=as_json)

    return command


def _md5(kind: Kind) -> click.Command:
    @click.command("md5", help="Print the md5 of TYPE.")
    @_type_argument(kind)
    @_folders
    def command(type_: str | None, folders: tuple[Path, ...]) -> None:
        installed, type_ = _installed(kind, folders), _read(type_, kind)
        if "/" not in type_:
            for found in _found(installed, kind, type_):
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
        installed = _installed(kind, folders)
        try:
            names = installed.names(package)
        except UnknownPackage:
            text = f"Unknown package {package}{suggestion(package, installed.packages())}"
            raise click.ClickException(text) from None
        _print(names, single_line=single_line, as_json=as_json)

    return command


def _packages(kind: Kind) -> click.Command:
    @click.command("packages", help=f"List the packages that have {NOUNS[kind]}s.")
    @_single_line
    @_folders
    @json_option
    def command(single_line: bool, folders: tuple[Path, ...], as_json: bool) -> None:
        names = _installed(kind, folders).packages()
        _print(names, single_line=single_line, as_json=as_json)

    return command


def _installed(kind: Kind, folders: tuple[Path, ...]) -> Installed:
    from fibws.values.installed_types import Installed  # with all that reads definitions

    return Installed(kind, folders)


def _type_argument(kind: Kind) -> Callable[[Callable[..., None]], Callable[..., None]]:
    types = completers.defined(kind, short=True)
    return click.argument("type_", metavar="[TYPE]", required=False, shell_complete=types)


def _read(type_: str | None, kind: Kind) -> str:
    """The type that was given, or is the first word in a pipe: ``fibws topic type /x | ...``."""
    if type_ is None:
        type_ = next((line.strip() for line in piped_input() or () if line.strip()), None)
    if type_ is None:
        raise click.UsageError(f"Missing argument 'TYPE', such as {EXAMPLES[kind]}.")
    return type_.removesuffix(f".{kind}")


def _found(installed: Installed, kind: Kind, short: str) -> list[str]:
    found = installed.find(short)
    if not found:
        nearest = installed.nearest(short)
        meant = f"; did you mean {nearest}?" if nearest else ""
        raise click.ClickException(f"Could not find {kind} '{short}'{meant}")
    return found


def _shown(installed: Installed, kind: Kind, type_: str, hub: str | None, *, raw: bool) -> str:
    """A definition as rosmsg prints it: with a line break behind it."""
    try:
        shown = installed.show(type_)
        return shown.text if raw else _text(shown.lines)
    except InvalidTypeName:
        raise click.UsageError(f"{type_!r} is no type: write package/Type.") from None
    except (UnknownPackage, UnknownType):
        lines = _told(installed, kind, type_, hub)
        if raw:
            text = f"Only the hub has {type_}, and it tells what is in it, but not the text of it."
            raise click.ClickException(text) from None
        return _text(lines)


def _text(lines: Iterable[str]) -> str:
    return "".join(f"{line}\n" for line in lines)


def _told(installed: Installed, kind: Kind, type_: str, hub: str | None) -> list[str]:
    """The lines of a type of which this machine has no definition, as the hub knows it."""
    try:
        with HubClient("tool", hub) as client:
            try:
                first, *others = [
                    type_text.lines(
                        type_text.of_typedefs(found, found.root),
                        partial(type_text.of_typedefs, found),
                    )
                    for found in _typedefs(client, kind, type_)
                ]
            except ServiceError:
                known = f", nor does the hub at {client.url}"
                raise _unknown(installed, kind, type_, known) from None
    except HubUnreachable as error:
        missing = f", and no hub can be asked at {error.url}"
        raise _unknown(installed, kind, type_, missing) from None
    return [*first, *(line for part in others for line in ("---", *part))]


def _typedefs(client: HubClient, kind: Kind, type_: str) -> list[Typedefs]:
    if kind == "msg":
        return [Typedefs.of_message(client, type_)]
    if kind == "srv":
        return [Typedefs.of_request(client, type_), Typedefs.of_response(client, type_)]
    return [Typedefs.of_message(client, type_ + part) for part in ("Goal", "Result", "Feedback")]


def _unknown(
    installed: Installed, kind: Kind, type_: str, elsewhere: str = ""
) -> click.ClickException:
    nearest = installed.nearest(type_)
    meant = f"; did you mean {nearest}?" if nearest else ""
    return click.ClickException(
        f"Unknown {NOUNS[kind]} type {type_}: no definition here has it ($FIBWS_INTERFACES, "
        f"--interfaces){elsewhere}{meant}"
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
