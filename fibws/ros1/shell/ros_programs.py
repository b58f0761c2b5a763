"""Programs of ROS's own packages that have their like in fibws, and those that have none."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path

from fibws import processes
from fibws.errors import WorkspaceError

_EXAMPLES = Path(__file__).parents[2] / "examples"

_MODULES = {
    ("rqt_gui", "rqt_gui"): ("fibws", "open"),
    ("rqt_graph", "rqt_graph"): ("fibws", "open", "graph"),
    ("rqt_topic", "rqt_topic"): ("fibws", "open", "topics"),
    ("rqt_plot", "rqt_plot"): ("fibws", "open", "plot"),
    ("rqt_console", "rqt_console"): ("fibws", "open", "console"),
    ("tf", "static_transform_publisher"): ("fibws.tf.static_transform_publisher",),
    ("tf2_ros", "static_transform_publisher"): ("fibws.tf.static_transform_publisher",),
    ("tf2_web_republisher", "tf2_web_republisher"): ("fibws.tf.tf2_web_republisher",),
    ("rospy_tutorials", "add_two_ints_server"): ("fibws.examples.add_two_ints_server",),
    ("rospy_tutorials", "add_two_ints_client"): ("fibws.examples.add_two_ints_client",),
    ("actionlib_tutorials", "fibonacci_server"): ("fibws.examples.action_server",),
    ("actionlib_tutorials", "fibonacci_client"): ("fibws.examples.action_client",),
}
_SCRIPTS = {
    ("rospy_tutorials", "talker"): _EXAMPLES / "rospy_talker.py",
    ("rospy_tutorials", "listener"): _EXAMPLES / "rospy_listener.py",
}
_WINDOW = "draws in a window of its own, which fibws does not; its page shows the graph: fibws open"
_CPP = "is in C++, and no C++ is built here"
_NOT_THERE = {
    "turtlesim": f"{_WINDOW}. Its messages are there: fibws msg show turtlesim/Pose",
    "rviz": _WINDOW,
    "rqt_reconfigure": _WINDOW,
    "rqt_image_view": _WINDOW,
    "rqt_tf_tree": _WINDOW,
    "gazebo_ros": "simulates robots, which fibws does not",
    "roscpp_tutorials": f"{_CPP}; rosrun rospy_tutorials talker does the same",
    "rosbag": "is not there; fibws topic echo --json TOPIC > FILE keeps what a topic says",
    "rosbridge_server": "needs no start: the hub, roscore, is one",
    "rosapi": "needs no start: the hub, roscore, has it",
    "rosout": "needs no start: the hub, roscore, has it",
}


def command_line(package: str, program: str, arguments: Sequence[str]) -> list[str] | None:
    """What to start instead of a program of ROS's own, or None if it is not known.

    Args:
        package: its package.
        program: its name, with ``.py`` or without.
        arguments: what to call it with.

    Raises:
        WorkspaceError: it is known, and there is nothing like it here.
    """
    name = (package, program.removesuffix(".py"))
    if name in _MODULES:
        return [sys.executable, "-P", "-m", *_MODULES[name], *arguments]
    if name in _SCRIPTS:
        return processes.command_line(_SCRIPTS[name], arguments)
    if package in _NOT_THERE:
        raise WorkspaceError(f"{package} {_NOT_THERE[package]}")
    return None
