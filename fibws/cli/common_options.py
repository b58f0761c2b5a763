"""Shared parts of commands: options, examples in help texts, and a client of the hub."""

from __future__ import annotations

import os
import re
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import wraps
from inspect import cleandoc
from pathlib import Path
from typing import Any, TypeVar

import click

from fibws import tls
from fibws.cli.exit_handling import clean_exit
from fibws.cli.output import visible
from fibws.command_names import command_name
from fibws.errors import AccessError

SETTINGS = {"help_option_names": ["-h", "--help"], "max_content_width": 100}
"""Settings of a command that is run by itself; commands in a group inherit the group's."""
CONNECTION = "connection"
"""The topic of ``fibws help`` about connections to the hub."""
_COMMAND = re.compile(r"\{([a-z]+(?: [a-z]+)*)\}")

_Function = TypeVar("_Function", bound=Callable[..., Any])


def examples_text(*lines: str | tuple[str, str]) -> str:
    """Return examples as a paragraph of a help text.

    Args:
        lines: what a person types, or that and a comment. A command of fibws in braces, such as
            ``{topic pub}``, is shown by the name that it has in this shell.
    """
    pairs = [(line, "") if isinstance(line, str) else line for line in lines]
    rows = [(_COMMAND.sub(lambda found: command_name(found[1]), line), it) for line, it in pairs]
    width = max((len(line) for line, comment in rows if comment), default=0)
    return "\n".join(
        ["\b", *(f"  {f'{line:{width}}   {comment}'.rstrip()}" for line, comment in rows)]
    )


def examples(*lines: str | tuple[str, str]) -> Callable[[_Function], _Function]:
    """Add examples to a command's help, after the first paragraph of its docstring.

    Args:
        lines: as for `examples_text`.
    """

    def add(function: _Function) -> _Function:
        first, *others = cleandoc(function.__doc__ or "").split("\n\n")
        function.__doc__ = "\n\n".join([first, examples_text(*lines), *others])
        return function

    return add


def with_hub(
    tool: str = "tool", *, endless: bool = False
) -> Callable[[Callable[..., None]], Callable[..., None]]:
    """Give a command the options of a hub, and an open `HubClient` as its argument ``client``.

    Args:
        tool: begins the name of the command's node on the hub.
        endless: whether Ctrl-C is the command's normal end, with exit code 0.
    """

    def decorate(command: Callable[..., None]) -> Callable[..., None]:
        @wraps(command)
        def with_client(hub: str | None, **others: Any) -> None:
            from fibws.client.hub_client import HubClient  # 60 ms, which help does not need.

            remapping = click.get_current_context().obj
            with clean_exit(endless=endless), HubClient(tool, hub, remapping) as client:
                if (warning := client.credentials.warning(client.url)) is not None:
                    click.echo(visible(f"WARNING: {warning}."), err=True)
                command(client=client, **others)

        return hub_option(with_client)

    return decorate


def hub_option(
    function: Callable[..., None], purpose: str = "Address of the hub"
) -> Callable[..., None]:
    """Give a command the option ``--hub``, and those of the files for TLS and for the token."""
    for option in (
        click.option(
            "--token-file",
            cls=ConnectionOption,
            metavar="FILE",
            type=click.Path(path_type=Path),
            expose_value=False,
            callback=_use_token_file,
            help="File with the token for the hub.  [default: $FIBWS_TOKEN_FILE]",
        ),
        _file_option("--client-key", tls.CLIENT_KEY, "Private key of the client certificate."),
        _file_option("--client-cert", tls.CLIENT_CERT, "Certificate to present to the hub."),
        _file_option("--ca", tls.CA, "Certificates to trust besides the system's."),
        click.option(
            "--hub",
            cls=ConnectionOption,
            metavar="URL",
            help=f"{purpose}.  [default: $FIBWS_HUB, else ws://127.0.0.1:9090]",
        ),
    ):
        function = option(function)
    return function


class ConnectionOption(click.Option):
    """An option of nearly all commands, explained by ``fibws help connection``.

    The help of a command has one line for all of them, that of ``--hub``.
    """

    def get_help_record(self, ctx: click.Context) -> tuple[str, str] | None:
        """Return the line in a command's help; None if it has none."""
        if self.name != "hub":
            return None
        purpose, _, default = (self.help or "").partition(".")
        return "--hub URL", f"{purpose}; see fibws help {CONNECTION}.{default}"

    @staticmethod
    def records(context: click.Context) -> list[tuple[str, str]]:
        """Return all lines about the connection."""
        options = click.command()(hub_option(lambda: None)).params
        lines = (
            super(ConnectionOption, each).get_help_record(context)
            for each in options
            if isinstance(each, ConnectionOption)
        )
        return [line for line in lines if line is not None]


def _file_option(name: str, variable: str, help_: str) -> Callable[..., Any]:
    """Return an option that sets an environment variable while its command runs.

    Thus the programs that the command starts have the file, too.
    """

    def set_variable(context: click.Context, parameter: click.Parameter, file: str | None) -> None:
        if file is not None:
            context.with_resource(_variable(variable, os.path.abspath(file)))

    return click.option(
        name,
        cls=ConnectionOption,
        metavar="FILE",
        type=click.Path(exists=True, dir_okay=False),
        expose_value=False,
        callback=set_variable,
        help=f"{help_}  [default: ${variable}]",
    )


@contextmanager
def _variable(name: str, value: str) -> Iterator[None]:
    """Set an environment variable in the block."""
    old = os.environ.get(name)
    os.environ[name] = value
    try:
        yield
    finally:
        if old is None:
            del os.environ[name]
        else:
            os.environ[name] = old


def _use_token_file(context: click.Context, parameter: click.Parameter, file: Path | None) -> None:
    """Set the variable of the token's file while the command runs, as `_file_option` does."""
    if file is not None:
        try:
            context.with_resource(_token_file(file))
        except AccessError as error:
            raise click.BadParameter(str(error)) from None


@contextmanager
def _token_file(file: Path) -> Iterator[None]:
    from fibws.credentials import VARIABLES, Credentials  # It loads websockets.

    before = {name: os.environ[name] for name in VARIABLES if name in os.environ}
    Credentials(file=file, source="--token-file").set_in(os.environ)
    try:
        yield
    finally:
        for name in VARIABLES:
            os.environ.pop(name, None)
        os.environ.update(before)


json_option: Callable[[Callable[..., None]], Callable[..., None]] = click.option(
    "--json", "as_json", is_flag=True, help="Print JSON, one value per line."
)


delay_option = click.option(
    "-d",
    "delay",
    metavar="SECONDS",
    type=click.FloatRange(0.1, 3600),
    default=1.0,
    show_default=True,
    help="Time in which rates are measured.",
)
