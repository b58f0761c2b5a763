"""ROS's names for commands of fibws, as programs: ``python -m fibws.cli rostopic list``."""

from __future__ import annotations

import re
from copy import copy

import click

from fibws import names
from fibws.cli.commands import Root, command
from fibws.cli.common_options import SETTINGS, examples_text
from fibws.command_names import ALIASES, set_called_alias
from fibws.errors import InvalidName
from fibws.suggestions import suggestion

_AS_NODES = ("rosparam", "rosservice", "rostopic")
"""The commands that accept the arguments of a node, FROM:=TO, as launch files pass them."""
_REMAPPING = re.compile(r"[\w~/]+:=.*")


class _Aliases(Root):
    """A group of all aliases. It has no name, so that usage lines begin with the alias."""

    def resolve_command(
        self, ctx: click.Context, args: list[str]
    ) -> tuple[str | None, click.Command | None, list[str]]:
        """Return the alias that ``args`` begin with, its command, and the other arguments.

        Raises:
            UsageError: the alias is unknown.
        """
        alias, *others = args
        if alias not in ALIASES:
            raise click.UsageError(f"Unknown command {alias!r}{suggestion(alias, ALIASES)}")
        if alias in _AS_NODES:
            ctx.obj, others = _remapping(others)
        set_called_alias(alias)
        name, *words = ALIASES[alias].split()
        found = command.get_command(ctx, name)
        if words and isinstance(found, click.Group):
            found = found.get_command(ctx, words.pop())
        elif words:
            found = _open_part(words[0])
        return alias, found, [*words, *others]


aliases = _Aliases(modules={}, callback=command.callback, context_settings=SETTINGS)


def main() -> None:
    """Run the alias that the first argument names."""
    aliases.main(prog_name="")


def _remapping(words: list[str]) -> tuple[names.Remapping, list[str]]:
    """Split arguments into remappings and others, as ``rospy.myargv`` does."""
    found = [word for word in words if _REMAPPING.fullmatch(word)]
    try:
        remapping = names.parse_remappings(found)
    except InvalidName as error:
        raise click.UsageError(str(error)) from None
    return remapping, [word for word in words if word not in found]


def _open_part(part: str) -> click.Command:
    """Return ``fibws open`` for one part of the page, with a help of its own."""
    from fibws.cli import open as module

    found = copy(module.command)
    found.help = (
        f"Open the {part} tab of the hub's page in a browser, and print its address.\n\n"
        f"{examples_text(module.PARTS[part])}\n\n"
        "Without a browser, only print the address. rqt's own options are ignored."
    )
    found.params = [copy(each) for each in found.params]
    [words] = [each for each in found.params if isinstance(each, click.Argument)]
    words.metavar = "[NAME]..." if part in module.WITH_NAMES else ""
    return found
