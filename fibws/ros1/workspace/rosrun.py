"""What rosrun starts: a program of a package, or what fibws has for one of ROS's own."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from fibws import processes
from fibws.ros1.shell import ros_programs
from fibws.ros1.workspace.packages import Packages


def command_line(
    packages: Packages, package: str, program: str, arguments: Sequence[str]
) -> tuple[list[str], Path]:
    """What to start a program with, and the folder that it is in.

    Args:
        packages: those that are known; one in a workspace comes before one of ROS's own.
        package: the program's package.
        program: its name.
        arguments: what to call it with.

    Raises:
        WorkspaceError: there is no such package or program, or none that can be run.
        OSError: the program's file cannot be read.
    """
    if not packages.has_own(package):
        found = ros_programs.command_line(package, program, arguments)
        if found is not None:
            return found, Path.cwd()
    executable = packages.executable(package, program)
    return processes.command_line(executable, arguments), executable.parent
