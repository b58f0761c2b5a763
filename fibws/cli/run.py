"""``fibws run``: run a program of a package, as rosrun does."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import click

from fibws.cli.common_options import SETTINGS, examples
from fibws.cli.exit_handling import clean_exit
from fibws.client.hub_pages import master_variables
from fibws.command_names import command_name
from fibws.errors import FibwsError
from fibws.hub_address import hub_url
from fibws.processes import command_line, exec_command

if TYPE_CHECKING:
    from click.shell_completion import CompletionItem

    from fibws.ros1.workspace.packages import Packages

workspace_option: Callable[[Callable[..., None]], Callable[..., None]] = click.option(
    "--workspace",
    metavar="FOLDER",
    type=click.Path(path_type=Path, file_okay=False, exists=True),
    help="Use this workspace, too, without sourcing its devel/setup.bash.",
)
ARGUMENTS = {**SETTINGS, "ignore_unknown_options": True, "allow_interspersed_args": False}
"""All arguments and options after the program's name are passed to the program."""


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
@click.option("--prefix", metavar="COMMAND", help="Command to run the program with, as 'time -p'.")
@click.argument(
    "words", metavar="PACKAGE PROGRAM [ARGUMENT]...", nargs=-1, shell_complete=_complete
)
@examples(
    "{run} fibonacci fibonacci_listener_node.py numbers:=fibonacci",
    "{run} some/folder/script.py",
)
def command(workspace: Path | None, prefix: str | None, words: tuple[str, ...]) -> None:
    """Run a program of a package, or a Python script.

    Python programs can import rospy and the messages. Arguments FROM:=TO remap names,
    _NAME:=VALUE sets a private parameter, __name:=NAME renames the node.
    """
    with clean_exit():
        if workspace is not None:
            put_on_paths(workspace)
        if not words:
            raise click.UsageError("Missing arguments: PACKAGE PROGRAM, or the path of a script.")
        command_words = [*_prefix(prefix or ""), *_command_line(words, workspace)]
        os.environ.update(master_variables(hub_url(), os.environ))
        exec_command(command_words)


def _prefix(text: str) -> list[str]:
    from fibws.ros1.launch.environment import split

    try:
        return split(text)
    except ValueError as error:
        raise click.BadParameter(f"{error}: {text}", param_hint="--prefix") from None


def _command_line(words: Sequence[str], workspace: Path | None) -> list[str]:
    from fibws.ros1.workspace.packages import rosrun_command

    script = Path(words[0])
    if script.suffix == ".py" or (os.sep in words[0] and script.is_file()):
        if not script.is_file():
            text = f"File {script} not found in {Path.cwd()}."
            raise click.UsageError(text + _package_hint(_packages(workspace), script))
        return command_line(script, words[1:])
    packages = _packages(workspace)
    if len(words) == 1:
        raise _no_program(packages, words[0])
    package, program, *arguments = words
    line, _ = rosrun_command(packages, package, program, arguments)
    return line


def put_on_paths(workspace: Path) -> None:
    """Put a workspace on the paths of this process and its children, as its setup file does."""
    from fibws.ros1.workspace.paths import DEVEL, SOURCE
    from fibws.ros1.workspace.setup_files import entries

    folder = workspace.resolve()
    for variable, path, at_end in entries(folder / SOURCE, folder / DEVEL):
        if not path.is_dir():
            continue  # Not built, or empty.
        others = [each for each in os.environ.get(variable, "").split(os.pathsep) if each]
        others = [each for each in others if each != str(path)]
        os.environ[variable] = os.pathsep.join(
            [*others, str(path)] if at_end else [str(path), *others]
        )


def _package_hint(packages: Packages, script: Path) -> str:
    """Return a hint to the package that has a script."""
    found = packages.having(str(script)) if script.name == str(script) else ()
    if not found:
        return ""
    package = found[0].name
    return f" Package {package} has it: {command_name('run')} {package} {script}"


def _no_program(packages: Packages, package: str) -> click.UsageError:
    programs = ", ".join(packages.programs(packages.find(package))) or "none"
    return click.UsageError(f"Missing argument PROGRAM. Programs of {package}: {programs}.")


def _packages(workspace: Path | None) -> Packages:
    from fibws.ros1.workspace.packages import Packages

    return Packages.from_environment(workspace)
