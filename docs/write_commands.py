"""Write docs/commands.md, the help of every command: python docs/write_commands.py"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import click

from fibws.cli.commands import command as fibws_command
from fibws.cli.help import connection_help

PAGE = Path(__file__).with_name("commands.md")
BEGIN = """\
# All commands

What `-h` prints, for every command; the [guide](command-line.md) has examples. This page is written
by `python docs/write_commands.py`.
"""
WIDTH = 100


def commands(command: click.Command, context: click.Context) -> Iterator[click.Context]:
    """Yield the context of a command and of all commands below it."""
    yield context
    if isinstance(command, click.Group):
        for name in command.list_commands(context):
            found = command.get_command(context, name)
            if found is not None and not found.hidden:
                yield from commands(found, context_of(found, name, context))


def context_of(
    command: click.Command, name: str, parent: click.Context | None = None
) -> click.Context:
    """Return a context that prints help as a terminal of WIDTH columns would."""
    settings = {**command.context_settings, "terminal_width": WIDTH, "max_content_width": WIDTH}
    return click.Context(command, info_name=name, parent=parent, **settings)


def page() -> str:
    """Return the page's text."""
    root = context_of(fibws_command, "fibws")
    parts = [BEGIN]
    for context in commands(fibws_command, root):
        help_ = click.unstyle(context.command.get_help(context)).strip()
        lines = "\n".join(line.rstrip() for line in help_.splitlines())
        level = "##" if context.parent in (None, root) else "###"
        parts.append(f"{level} {context.command_path}\n\n```text\n{lines}\n```\n")
    parts.append(f"### fibws help connection\n\n```text\n{connection_help(root)}\n```\n")
    return "\n".join(parts)


if __name__ == "__main__":
    PAGE.write_text(page(), "utf-8")
