"""``fibws setup``: a shell in which roscore, rosrun, rospy and the others are there."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator
from pathlib import Path

import click
from click.shell_completion import ShellComplete, get_completion_class

from fibws.cli import output
from fibws.cli.completion import PROGRAM, VARIABLE
from fibws.command_names import is_set_up
from fibws.ros1.shell import environment, shells

SHELLS = ("bash", "zsh", "sh")
FAILED = "false\n"
"""Is printed when nothing is set up, so that whoever evaluates it can tell."""
HOW = """\
A program cannot change the shell that it is started in, so have the shell read what it says:

  source <(fibws setup)          bash and zsh
  eval "$(fibws setup)"          any sh, and the old bash of macOS

To take it back: source <(fibws setup --undo)
To have it in every new shell, put that line into ~/.bashrc or ~/.zshrc."""
WITHOUT = """\
The commands do without: `fibws run PACKAGE PROGRAM` is rosrun, `fibws launch` roslaunch,
`fibws topic` rostopic, `fibws workspace make` catkin_make; `fibws --help` tells of them all."""


@click.command()
@click.argument("shell_", metavar="[bash|zsh|sh]", required=False)
@click.option("--undo", is_flag=True, help="Take it back, with all workspaces.")
@click.option(
    "--shadow-ros",
    is_flag=True,
    help="Do it though a ROS is installed, whose commands it hides.",
)
@click.option("-q", "--quiet", is_flag=True, help="Do not say what it did.")
@click.pass_context
def command(
    context: click.Context, shell_: str | None, undo: bool, shadow_ros: bool, quiet: bool
) -> None:
    """Print what gives a shell the commands of ROS 1, and Python its modules.

    \b
      source <(fibws setup)          roscore, rosrun, rostopic, catkin_make, roscd ... are there
      source <(fibws setup --undo)   and are gone

    One text serves bash, zsh and sh. It sets PATH, PYTHONPATH (rospy and the messages), ROS_DISTRO
    and the like, and has TAB complete the commands. It is done for this one shell; the devel/
    setup.bash that catkin_make writes does it, too.
    """
    name = shell_ or _shell()
    if name not in SHELLS:
        _refuse(f"fibws setup speaks to bash, zsh and sh, not to {name}.\n{WITHOUT}")
    if output.is_terminal():
        click.echo(HOW)
        return
    if undo:
        click.echo(shells.end(environment.undo(os.environ, _workspaces())), nl=False)
        _say(quiet, "This shell has no more of fibws's ROS commands and modules, nor workspaces.")
        return
    if not shadow_ros and not is_set_up(os.environ):
        found = environment.other_ros(os.environ)
        if found is not None:
            _refuse(
                f"Nothing is set up: a ROS is installed ({found}), and would be hidden.\n"
                "To have that in this shell: source <(fibws setup --shadow-ros)\n" + WITHOUT
            )
    changes = environment.set_up(os.environ)
    click.echo(
        shells.begin(changes, *(_completion(context, each) for each in SHELLS[:2])), nl=False
    )
    _say(
        quiet,
        "roscore, rosrun, rostopic, catkin_make and the like are those of fibws in this shell, "
        "rospy too.\nTo take it back: source <(fibws setup --undo)",
    )


def _shell() -> str:
    """The shell that has started this one, as far as can be told, or else bash."""
    if os.name == "nt" and "MSYSTEM" not in os.environ:
        return "cmd or PowerShell"
    try:
        name = Path(f"/proc/{os.getppid()}/comm").read_text().strip()
    except OSError:
        name = Path(os.environ.get("SHELL", "")).name
    # Any other is a program that hands this on: a make, an editor, a uv run.
    return name if name in ("fish", "csh", "tcsh", "nu", "xonsh", "pwsh") else "bash"


def _workspaces() -> Iterator[tuple[str, Path]]:
    """What the setup files of workspaces that were built here have put on which path."""
    from fibws.ros1.workspace.build import RECORD
    from fibws.ros1.workspace.packages import PREFIXES
    from fibws.ros1.workspace.place import SOURCE
    from fibws.ros1.workspace.setup_files import entries

    for folder in filter(None, os.environ.get(PREFIXES, "").split(os.pathsep)):
        devel = Path(folder)
        if (devel / RECORD).is_file():
            for variable, path, _ in entries(devel.parent / SOURCE, devel):
                yield variable, path


def _completion(context: click.Context, name: str) -> str:
    kind = get_completion_class(name)
    assert kind is not None, "click knows both"
    # Its own source() starts bash to ask for its version, which the text does by itself.
    return ShellComplete.source(kind(context.find_root().command, {}, PROGRAM, VARIABLE))


def _refuse(text: str) -> None:
    if not output.is_terminal():
        click.echo(FAILED, nl=False)
    click.echo(text, err=True)
    sys.exit(1)


def _say(quiet: bool, text: str) -> None:
    if not quiet:
        click.echo(text, err=True)
