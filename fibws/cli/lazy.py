"""Groups of commands that import a command when it is called."""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any, NamedTuple

import click

from fibws.suggestions import nearest, suggestion

if TYPE_CHECKING:
    from click.shell_completion import CompletionItem


class Command(NamedTuple):
    """A command's module, and its line in the help of its group."""

    module: str
    help: str
    section: str = "Commands"
    """The heading above it in the help."""
    attribute: str = "command"
    """The command's name in its module."""


class LazyGroup(click.Group):
    """A group that knows its commands' names without importing them.

    Each module has its command as ``command``. The help lists commands in their order in
    ``modules``, by sections.
    """

    def __init__(self, *args: Any, modules: dict[str, Command], **others: Any) -> None:
        super().__init__(*args, **others)
        self.modules = modules

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        """Parse arguments; for an unknown option, say that options follow the command."""
        try:
            return super().parse_args(ctx, args)
        except click.NoSuchOption as error:
            option = error.option_name
            own = [each.strip("-") for parameter in self.get_params(ctx) for each in parameter.opts]
            if nearest(option.strip("-"), own):
                raise  # It suggests the option.
            place = f"options follow the command: {ctx.command_path} COMMAND {option}"
            raise click.UsageError(f"No such option {option!r} here: {place}", ctx) from None

    def list_commands(self, ctx: click.Context) -> list[str]:
        """Return the names, in order."""
        return list(self.modules)

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        """Import and return the command of this name; None if it is unknown."""
        if cmd_name not in self.modules:
            return None
        found = self.modules[cmd_name]
        command: click.Command = getattr(import_module(found.module), found.attribute)
        return command

    def resolve_command(
        self, ctx: click.Context, args: list[str]
    ) -> tuple[str | None, click.Command | None, list[str]]:
        """Return the command that arguments call.

        Raises:
            UsageError: the command is unknown.
        """
        name = args[0]
        if name not in self.modules and not name.startswith("-"):
            raise click.UsageError(
                f"No such command {name!r}{suggestion(name, self.modules) or '.'}", ctx
            )
        return super().resolve_command(ctx, args)

    def shell_complete(self, ctx: click.Context, incomplete: str) -> list[CompletionItem]:
        """Complete commands and options without importing any command."""
        from click.shell_completion import CompletionItem  # needed for completion only

        commands = [
            CompletionItem(name, help=command.help)
            for name, command in self.modules.items()
            if name.startswith(incomplete)
        ]
        return [*commands, *click.Command.shell_complete(self, ctx, incomplete)]

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """Write the lists of commands without importing any."""
        width = max(map(len, self.modules))
        for section in dict.fromkeys(command.section for command in self.modules.values()):
            with formatter.section(section):
                formatter.write_dl(
                    [
                        (name.ljust(width), command.help)
                        for name, command in self.modules.items()
                        if command.section == section
                    ]
                )
