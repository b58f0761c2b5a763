"""ROS 1's names for commands of fibws, and which of them this shell has."""

from __future__ import annotations

import os
from collections.abc import Mapping

ALIASES = {
    "catkin_create_pkg": "pkg create",
    "catkin_init_workspace": "workspace init",
    "catkin_make": "workspace make",
    "catkin_test_results": "workspace test-results",
    "rosbag": "bag",
    "roscore": "core",
    "roslaunch": "launch",
    "rosmsg": "msg",
    "rosnode": "node",
    "rospack": "pkg",
    "rosparam": "param",
    "rosrun": "run",
    "rosservice": "service",
    "rossrv": "srv",
    "rostest": "test",
    "rostopic": "topic",
    "rosversion": "pkg version",
    "roswtf": "doctor",
    "rqt": "open",
    "rqt_console": "open console",
    "rqt_graph": "open graph",
    "rqt_plot": "open plot",
    "rqt_topic": "open topics",
}
"""The command of ``fibws`` that each alias stands for."""
SETUP = "FIBWS_SETUP"
"""The variable that ``fibws setup`` sets in a shell, in which all aliases exist then."""

_called_alias: str | None = None


def command_name(command: str) -> str:
    """Return what a person types in this shell for a command of fibws.

    In a shell with ``fibws setup``, ``run`` is ``rosrun`` and ``topic list`` is ``rostopic list``;
    elsewhere they are ``fibws run`` and ``fibws topic list``. An alias by which this program was
    called is used in either.

    Args:
        command: its name without ``fibws``; words after it, such as arguments, are kept.
    """
    aliases = ALIASES if is_set_up(os.environ) else filter(None, [_called_alias])
    fitting = [each for each in aliases if f"{command} ".startswith(f"{ALIASES[each]} ")]
    if not fitting:
        return f"fibws {command}"
    alias = max(fitting, key=lambda each: len(ALIASES[each]))
    return alias + command.removeprefix(ALIASES[alias])


def is_set_up(environ: Mapping[str, str]) -> bool:
    """Return whether ``fibws setup`` was done in this shell, or in one that it inherits from."""
    return bool(environ.get(SETUP))


def called_alias() -> str | None:
    """Return the alias by which this program was called, such as ``rosservice``, if any."""
    return _called_alias


def set_called_alias(alias: str | None) -> None:
    """Remember the alias by which this program was called, for `command_name`."""
    global _called_alias
    _called_alias = alias
