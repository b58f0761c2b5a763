"""What is behind the doors of `fibws.command_names`: the commands of fibws, under ROS's names."""

from __future__ import annotations

import click

from fibws.cli.commands import Root, command
from fibws.cli.common_options import SETTINGS
from fibws.command_names import ALIASES, set_called_alias
from fibws.suggestions import hint


class _Doors(Root):
    """The group of all doors. It has no name, so that what they print begins with theirs."""

    def resolve_command(
        self, ctx: click.Context, args: list[str]
    ) -> tuple[str | None, click.Command | None, list[str]]:
        """The command behind the door that ``args`` begin with; `UsageError` if there is none."""
        door, *rest = args
        if door not in ALIASES:
            raise click.UsageError(f"There is no {door!r} here{hint(door, ALIASES)}")
        set_called_alias(door)
        words = ALIASES[door].split()
        found: click.Command | None = command
        passed = "fibws"
        while words and isinstance(found, click.Group):
            passed = f"{passed} {words[0]}"
            found = found.get_command(ctx, words.pop(0))
        if words and found is not None:
            _narrow(found, passed, words[0])
        _rename(found, " ".join([passed, *words]), door, ctx, rest)
        return door, found, [*words, *rest]


def main() -> None:
    """Run the door that the first argument names."""
    doors = _Doors(modules={}, callback=command.callback, context_settings=SETTINGS)
    doors.main(prog_name="")


def _narrow(found: click.Command, ours: str, part: str) -> None:
    """Have the help of a command be that of the one part of the page which it is to open."""
    from fibws.cli.open import WITH_NAMES

    lines = (found.help or "").splitlines()
    found.help = "\n".join(each for each in lines if ours not in each or f"{ours} {part}" in each)
    for argument in found.params:
        if isinstance(argument, click.Argument):
            argument.metavar = "[NAME]..." if part in WITH_NAMES else ""


def _rename(
    found: click.Command | None, ours: str, theirs: str, context: click.Context, args: list[str]
) -> None:
    """Have the help of a command, and of the one in it that is called, use the name of the door."""
    for word in [*args, ""]:
        if found is None:
            return
        found.help = (found.help or "").replace(ours, theirs)
        found = found.get_command(context, word) if isinstance(found, click.Group) else None
