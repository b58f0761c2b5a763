"""``fibws setup``: ROS 1's commands and Python modules for a shell."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator
from pathlib import Path

import click
from click.shell_completion import ShellComplete, get_completion_class

from fibws.cli import output
from fibws.cli.common_options import examples
from fibws.cli.completion import PROGRAM, VARIABLE
from fibws.command_names import is_set_up
from fibws.ros1.shell import environment, setup_script

SHELLS = ("bash", "zsh", "sh")
FAILED = "false\n"
"""The script in case of an error, so that ``source`` fails."""
USAGE = """\
This command prints a script for the shell. To run that script:

  source <(fibws setup)          bash and zsh
  eval "$(fibws setup)"          any sh, and the old bash of macOS

To do it in every new shell, add that line to ~/.bashrc or ~/.zshrc.
To undo it: source <(fibws setup --undo)"""
WITHOUT = """\
All commands work without it: `fibws run PACKAGE PROGRAM` is rosrun, `fibws launch` is roslaunch,
`fibws topic` is rostopic, `fibws workspace make` is catkin_make; `fibws --help` lists them."""


@click.command()
@click.argument("shell_", metavar="[bash|zsh|sh]", required=False)
@click.option("--undo", is_flag=True, help="Undo the setup, and that of all workspaces.")
@click.option(
    "--shadow-ros",
    is_flag=True,
    help="Set up even if ROS is installed: hide its commands, and list those that remain.",
)
@click.option("-q", "--quiet", is_flag=True, help="Print only errors on standard error.")
@click.pass_context
@examples(
    ("source <(fibws setup)", "adds roscore, rosrun, rostopic, catkin_make, roscd ..."),
    ("source <(fibws setup --undo)", "removes them"),
)
def command(
    context: click.Context, shell_: str | None, undo: bool, shadow_ros: bool, quiet: bool
) -> None:
    """Print a script that gives a shell ROS 1's commands, and Python its modules.

    The same script serves bash, zsh and sh. It sets PATH, PYTHONPATH (for rospy and the messages),
    ROS_DISTRO and the like, and completes the commands by TAB. It affects the current shell only.
    The devel/setup.bash of a workspace includes it.
    """
    name = shell_ or _shell()
    if name not in SHELLS:
        _refuse(f"fibws setup supports bash, zsh and sh, not {name}.\n{WITHOUT}")
    if output.is_terminal():
        click.echo(USAGE)
        return
    if undo:
        click.echo(setup_script.undo(environment.undo(os.environ, _workspaces())), nl=False)
        _report(quiet, "Removed fibws's ROS commands, modules and workspaces from this shell.")
        return
    if not shadow_ros and not is_set_up(os.environ):
        found = environment.other_ros(os.environ)
        if found is not None and quiet:
            _refuse(
                f"This shell keeps the commands of the installed ROS ({found}). "
                "For those of fibws: source <(fibws setup --shadow-ros)"
            )
        if found is not None:
            _refuse(
                f"Nothing was set up, since ROS is installed ({found}) and would be hidden.\n"
                "To hide it in this shell: source <(fibws setup --shadow-ros)\n" + WITHOUT
            )
    changes = environment.set_up(os.environ, shadows=shadow_ros)
    click.echo(
        setup_script.set_up(changes, *(_completion(context, each) for each in SHELLS[:2])), nl=False
    )
    _report(
        quiet,
        "This shell now has roscore, rosrun, rostopic, catkin_make and the other commands, and "
        "rospy, from fibws.\nTo undo it: source <(fibws setup --undo)",
    )
    if others := environment.unreplaced_commands(os.environ):
        text = f"Still from the installed ROS, as fibws has no such commands: {', '.join(others)}"
        _report(quiet, output.visible(text))


def _shell() -> str:
    """Return the shell that started this program if it is an unsupported one, else bash."""
    if os.name == "nt" and "MSYSTEM" not in os.environ:
        return "cmd or PowerShell"
    try:
        name = Path(f"/proc/{os.getppid()}/comm").read_text("utf-8").strip()
    except OSError:
        name = Path(os.environ.get("SHELL", "")).name
    # Any other parent, such as make, an editor or uv run, passes the script on to some shell.
    return name if name in ("fish", "csh", "tcsh", "nu", "xonsh", "pwsh") else "bash"


def _workspaces() -> Iterator[tuple[str, Path]]:
    """Yield the path variables and folders that setup files of workspaces have added."""
    from fibws.ros1.workspace.build import RECORD
    from fibws.ros1.workspace.packages import PREFIXES
    from fibws.ros1.workspace.paths import SOURCE
    from fibws.ros1.workspace.setup_files import entries

    for folder in filter(None, os.environ.get(PREFIXES, "").split(os.pathsep)):
        devel = Path(folder)
        if (devel / RECORD).is_file():
            for variable, path, _ in entries(devel.parent / SOURCE, devel):
                yield variable, path


def _completion(context: click.Context, name: str) -> str:
    kind = get_completion_class(name)
    assert kind is not None, "click knows both"
    # Its own source() starts bash to ask for its version, which the script checks itself.
    return ShellComplete.source(kind(context.find_root().command, {}, PROGRAM, VARIABLE))


def _refuse(text: str) -> None:
    if not output.is_terminal():
        click.echo(FAILED, nl=False)
    click.echo(text, err=True)
    sys.exit(1)


def _report(quiet: bool, text: str) -> None:
    if not quiet:
        click.echo(text, err=True)
