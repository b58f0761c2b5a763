"""Starting nodes and launch files from scripts (http://wiki.ros.org/roslaunch/API%20Usage)."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Sequence

from roslaunch import core, parent, pmon, rlutil, scriptapi
from roslaunch.core import Node, RLException
from roslaunch.parent import DEFAULT_TIMEOUT_SIGINT, DEFAULT_TIMEOUT_SIGTERM
from roslaunch.pmon import Process
from roslaunch.scriptapi import ROSLaunch

__all__ = [
    "DEFAULT_TIMEOUT_SIGINT",
    "DEFAULT_TIMEOUT_SIGTERM",
    "Node",
    "Process",
    "RLException",
    "ROSLaunch",
    "configure_logging",
    "core",
    "main",
    "parent",
    "pmon",
    "rlutil",
    "scriptapi",
]


def configure_logging(uuid: str) -> None:
    """Do nothing: each launch has a folder of its own for log files.

    Args:
        uuid: the id of the run, by which roslaunch names its folder.
    """


def main(argv: Sequence[str] | None = None) -> None:
    """Run the command roslaunch until it ends, and exit with its exit code.

    Args:
        argv: its command line, program included; by default this program's.
    """
    words = list(sys.argv if argv is None else argv)[1:]
    sys.exit(subprocess.call([sys.executable, "-P", "-m", "fibws", "launch", *words]))
