"""The command line: ``fibws demo``, ``fibws hub``. A command is imported when it is called."""

from __future__ import annotations

from importlib import import_module
from typing import NamedTuple

import click

from fibws import __version__


class Command(NamedTuple):
    """Where a command is, and what ``fibws --help`` says of it."""

    module: str
    help: str


COMMANDS = {
    "demo": Command("fibws.cli.demo", "Run the first tutorial: a hub, a broadcaster, a listener."),
    "hub": Command("fibws.hub.__main__", "Run a hub that nodes and web pages meet at."),
}


class LazyGroup(click.Group):
    """A group that knows its commands' names without importing them."""

    def list_commands(self, ctx: click.Context) -> list[str]:
        """The names, sorted."""
        return sorted(COMMANDS)

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        """The command of that name, imported now."""
        if cmd_name not in COMMANDS:
            return None
        command: click.Command = import_module(COMMANDS[cmd_name].module).command
        return command

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """Write the list of commands, of which none needs to be imported for that."""
        with formatter.section("Commands"):
            formatter.write_dl([(name, COMMANDS[name].help) for name in self.list_commands(ctx)])


@click.group(cls=LazyGroup, context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(__version__, message="fibws %(version)s")
def command() -> None:
    """The ROS graph over WebSockets.

    The nodes of the tutorial are programs of their own: python -m fibws.broadcaster, python -m
    fibws.listener.
    """


def main() -> None:
    """Run the command line."""
    command(prog_name="fibws")
