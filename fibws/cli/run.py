"""``fibws run``: start a package's program, as rosrun does."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import click

from fibws.cli.common_options import SETTINGS
from fibws.cli.exit_handling import ending
from fibws.command_names import command_name
from fibws.errors import FibwsError
from fibws.processes import become, command_line

if TYPE_CHECKING:
    from click.shell_completion import CompletionItem

    from fibws.ros1.workspace.packages import Packages

workspace_option: Callable[[Callable[..., None]], Callable[..., None]] = click.option(
    "--workspace",
    metavar="FOLDER",
    type=click.Path(path_type=Path, file_okay=False, exists=True),
    help="Look into this workspace, too, though its devel/setup was not sourced.",
)
ARGUMENTS = {**SETTINGS, "ignore_unknown_options": True, "allow_interspersed_args": False}
"""What follows the program's name is the program's own, options too."""


def _complete(
    context: click.Context, parameter: click.Parameter, incomplete: str
) -> list[CompletionItem]:
    from click.shell_completion import CompletionItem

    words = list(context.params.get("words") or ())
    try:
        packages = _packages(context.params.get("workspace"))
        if not words:
            found = [package.name for package in packages if not package.is_standard]
            if not any(name.startswith(incomplete) for name in found):
                return [CompletionItem(incomplete, type="file")]
        elif len(words) == 1:
            found = packages.programs(packages.find(words[0]))
        else:
            return [CompletionItem(incomplete, type="file")]
    except (FibwsError, OSError):
        return []
    return [CompletionItem(name) for name in found if name.startswith(incomplete)]


@click.command(context_settings=ARGUMENTS)
@workspace_option
@click.option("--prefix", metavar="COMMAND", help="Start the program by this, such as 'time -p'.")
@click.argument(
    "words", metavar="PACKAGE PROGRAM [ARGUMENT]...", nargs=-1, shell_complete=_complete
)
def command(workspace: Path | None, prefix: str | None, words: tuple[str, ...]) -> None:
    """Start a program of a package, as rosrun does.

    \b
      fibws run fibonacci fibonacci_listener_node.py numbers:=fibonacci
      fibws run some/folder/script.py

    Python programs find rospy and the messages. Arguments FROM:=TO rename topics, _NAME:=VALUE set
    private parameters, __name:=NAME renames the node.
    """
    with ending():
        if workspace is not None:
            put_on_paths(workspace)
        if not words:
            raise click.UsageError("Write PACKAGE PROGRAM, or the path of a script.")
        become([*_prefix(prefix or ""), *_line(words, workspace)])


def _prefix(text: str) -> list[str]:
    from fibws.ros1.launch.surroundings import split

    try:
        return split(text)
    except ValueError as error:
        raise click.BadParameter(f"{error}: {text}", param_hint="--prefix") from None


def _line(words: Sequence[str], workspace: Path | None) -> list[str]:
    from fibws.ros1.workspace import rosrun

    script = Path(words[0])
    if script.suffix == ".py" or (os.sep in words[0] and script.is_file()):
        if not script.is_file():
            text = f"There is no file {script}, in {Path.cwd()}."
            raise click.UsageError(text + _owner(_packages(workspace), script))
        return command_line(script, words[1:])
    packages = _packages(workspace)
    if len(words) == 1:
        _ask_which(packages, words[0])
    package, program, *arguments = words
    line, _ = rosrun.command_line(packages, package, program, arguments)
    return line


def put_on_paths(workspace: Path) -> None:
    """Put a workspace on the paths of this process, and so of the program."""
    from fibws.ros1.workspace.place import DEVEL, SOURCE
    from fibws.ros1.workspace.setup_files import entries

    folder = workspace.resolve()
    for variable, path, at_end in entries(folder / SOURCE, folder / DEVEL):
        if not path.is_dir():
            continue  # It is not built, or has nothing of that kind.
        others = [each for each in os.environ.get(variable, "").split(os.pathsep) if each]
        others = [each for each in others if each != str(path)]
        os.environ[variable] = os.pathsep.join(
            [*others, str(path)] if at_end else [str(path), *others]
        )


def _owner(packages: Packages, script: Path) -> str:
    """Which package has it, if that was left out."""
    found = packages.having(str(script)) if script.name == str(script) else ()
    if not found:
        return ""
    package = found[0].name
    return f" Package {package} has one: {command_name('run')} {package} {script}"


def _ask_which(packages: Packages, package: str) -> None:
    programs = packages.programs(packages.find(package))
    of_it = f"Those of {package}: {', '.join(programs)}." if programs else f"{package} has none."
    raise click.UsageError(f"Which program of {package}? {of_it}")


def _packages(workspace: Path | None) -> Packages:
    from fibws.ros1.workspace.packages import Packages

    return Packages.from_environment(workspace)
