"""``fibws help``: the help of a command, and how commands connect to the hub."""

from __future__ import annotations

import click

from fibws.cli.common_options import CONNECTION, ConnectionOption

CONNECTING = """\
How commands, and programs that are nodes, connect to the hub.

Each option has a variable of the environment, and counts more than that. The programs that a
command starts have the same connection. FIBWS_TOKEN may hold the token itself.
"""


@click.command()
@click.argument("words", nargs=-1, metavar="[COMMAND... | connection]")
@click.pass_context
def command(context: click.Context, words: tuple[str, ...]) -> None:
    """Show the help of a command, or how commands connect to the hub."""
    shown = context.find_root()
    if words == (CONNECTION,):
        click.echo(connection_help(shown))
        return
    for word in words:
        if not isinstance(shown.command, click.Group):
            raise click.UsageError(f"{shown.command_path!r} has no commands, such as {word!r}")
        name, found, _ = shown.command.resolve_command(shown, [word])
        assert found is not None
        shown = click.Context(found, info_name=name, parent=shown, **found.context_settings)
    click.echo(shown.command.get_help(shown), color=shown.color)


def connection_help(context: click.Context) -> str:
    """Return the text of ``fibws help connection``, as wide as a context's help."""
    formatter = context.make_formatter()
    for paragraph in CONNECTING.split("\n\n"):
        formatter.write_paragraph()
        formatter.write_text(paragraph.replace("\n", " "))
    with formatter.section("Options"):
        formatter.write_dl(ConnectionOption.records(context))
    return formatter.getvalue().strip("\n")
