"""Substitutes for programs of ROS's own packages."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path

from fibws import processes
from fibws.command_names import command_name
from fibws.ros1.errors import WorkspaceError
from fibws.ros1.workspace.packages_outside_fibws import CPP, IN_CPP

_EXAMPLES = Path(__file__).parents[2] / "examples"
_PYTHON = Path(__file__).parents[1] / "python"

COMMANDS = (
    *("rosbag", "roslaunch", "rosmsg", "rosnode", "rosparam", "rosservice", "rostest", "rostopic"),
)
"""The commands that are programs of a package of their own name: ``rosrun rostopic rostopic``."""
_MODULES = {
    ("rqt_gui", "rqt_gui"): ("fibws", "open"),
    ("rqt_graph", "rqt_graph"): ("fibws", "open", "graph"),
    ("rqt_topic", "rqt_topic"): ("fibws", "open", "topics"),
    ("rqt_plot", "rqt_plot"): ("fibws", "open", "plot"),
    ("rqt_console", "rqt_console"): ("fibws", "open", "console"),
    ("rqt_reconfigure", "rqt_reconfigure"): ("fibws", "open", "reconfigure"),
    ("rqt_image_view", "rqt_image_view"): ("fibws", "open", "topics"),
    ("rqt_logger_level", "rqt_logger_level"): ("fibws", "open", "console"),
    ("rqt_publisher", "rqt_publisher"): ("fibws", "open", "topics"),
    ("rqt_robot_monitor", "rqt_robot_monitor"): ("fibws", "open", "topics", "/diagnostics"),
    ("rqt_robot_steering", "rqt_robot_steering"): ("fibws", "open", "topics", "/cmd_vel"),
    ("rqt_service_caller", "rqt_service_caller"): ("fibws", "open", "services"),
    ("rqt_tf_tree", "rqt_tf_tree"): ("fibws", "open", "topics", "/tf"),
    ("actionlib", "axclient"): ("fibws", "open", "actions"),
    **{(name, name): ("fibws.cli", name) for name in COMMANDS},
    ("rosbag", "record"): ("fibws", "bag", "record"),
    ("rosbag", "play"): ("fibws", "bag", "play"),
    ("tf", "static_transform_publisher"): ("fibws.programs.static_transform_publisher",),
    ("tf2_ros", "static_transform_publisher"): ("fibws.programs.static_transform_publisher",),
    ("tf", "tf_echo"): ("fibws.programs.tf_echo",),
    ("tf", "tf_monitor"): ("fibws.programs.tf_monitor",),
    ("tf", "view_frames"): ("fibws.programs.view_frames",),
    ("tf2_tools", "echo"): ("fibws.programs.tf_echo",),
    ("tf2_tools", "view_frames"): ("fibws.programs.view_frames",),
    ("web_video_server", "web_video_server"): ("fibws.programs.web_video_server",),
    ("turtlesim", "turtlesim_node"): ("fibws.programs.turtlesim.turtlesim_node",),
    ("turtlesim", "turtle_teleop_key"): ("fibws.programs.turtlesim.teleop_key",),
    ("turtlesim", "draw_square"): ("fibws.programs.turtlesim.draw_square",),
    ("turtlesim", "mimic"): ("fibws.programs.turtlesim.mimic",),
    ("tf2_web_republisher", "tf2_web_republisher"): ("fibws.programs.tf2_web_republisher",),
    ("rospy_tutorials", "add_two_ints_server"): ("fibws.examples.add_two_ints_server",),
    ("rospy_tutorials", "add_two_ints_client"): ("fibws.examples.add_two_ints_client",),
    ("actionlib_tutorials", "fibonacci_server"): ("fibws.examples.action_server",),
    ("actionlib_tutorials", "fibonacci_client"): ("fibws.examples.action_client",),
}
_LAUNCH = Path(__file__).parents[1] / "launch"
_AGGREGATOR = _PYTHON / "diagnostic_aggregator" / "aggregator.py"
_JOINT_STATES = _PYTHON / "joint_state_publisher" / "publisher.py"
_ROBOT_STATE = _PYTHON / "robot_state_publisher" / "publisher.py"
_SCRIPTS = {
    ("diagnostic_aggregator", "aggregator_node"): _AGGREGATOR,
    ("map_server", "map_server"): _PYTHON / "map_server" / "server.py",
    ("map_server", "map_saver"): _PYTHON / "map_server" / "saver.py",
    ("rospy_tutorials", "talker"): _EXAMPLES / "rospy_talker.py",
    ("rospy_tutorials", "listener"): _EXAMPLES / "rospy_listener.py",
    ("dynamic_reconfigure", "dynparam"): _PYTHON / "dynamic_reconfigure" / "dynparam.py",
    ("image_transport", "republish"): _PYTHON / "image_transport" / "republish.py",
    ("joint_state_publisher", "joint_state_publisher"): _JOINT_STATES,
    ("robot_state_publisher", "robot_state_publisher"): _ROBOT_STATE,
    ("robot_state_publisher", "state_publisher"): _ROBOT_STATE,
    ("xacro", "xacro"): _LAUNCH / "xacro" / "expand.py",
    ("tf", "tf_remap"): _PYTHON / "tf" / "tf_remap.py",
    ("tf2_ros", "buffer_server"): _PYTHON / "tf2_ros" / "buffer_server.py",
}

_NODE_TESTS = _PYTHON / "rostest" / "node_tests.py"
_TEST_PROGRAMS = [
    *("advertisetest", "hztest", "paramtest", "publishtest", "servicetest", "subscribetest"),
]
"""The programs of rostest, which are in one file."""
_TOPIC_TOOLS = _PYTHON / "topic_tools" / "programs.py"
_TOPIC_PROGRAMS = [
    *("delay", "demux", "drop", "mux", "mux_add", "mux_delete", "mux_list", "mux_select"),
    *("relay", "throttle"),
]
"""The programs of topic_tools, which are in one file, too."""
_EXPRESSIONS = _PYTHON / "topic_tools" / "expressions.py"
_EXPRESSION_PROGRAMS = ["relay_field", "transform"]
"""The programs of topic_tools that compute topics, which are in another file."""

_WINDOWS = ["image_view", "rqt_bag", "rqt_launch", "rqt_msg", "rqt_runtime_monitor", "rviz"]
"""Packages whose programs open windows."""


def command_line(package: str, program: str, arguments: Sequence[str]) -> list[str] | None:
    """Return the command to run instead of a program of ROS's own; None for other programs.

    Args:
        package: its package.
        program: its name, with ``.py`` or without.
        arguments: its arguments.

    Raises:
        WorkspaceError: the package has no substitute here.
    """
    name = (package, program.removesuffix(".py"))
    if name in _MODULES:
        return [sys.executable, "-P", "-m", *_MODULES[name], *arguments]
    if name in _SCRIPTS:
        return processes.command_line(_SCRIPTS[name], arguments)
    if package == "rostest" and program in _TEST_PROGRAMS:
        return processes.command_line(_NODE_TESTS, [program, *arguments])
    if package == "topic_tools" and program in _TOPIC_PROGRAMS:
        return processes.command_line(_TOPIC_TOOLS, [program, *arguments])
    if package == "topic_tools" and program in _EXPRESSION_PROGRAMS:
        return processes.command_line(_EXPRESSIONS, [program, *arguments])
    if fault := _unsupported().get(package):
        raise WorkspaceError(f"{package} {fault}")
    return None


def names(package: str) -> list[str]:
    """Return the programs of a package of ROS's own that have a substitute."""
    found = [program for owner, program in [*_MODULES, *_SCRIPTS] if owner == package]
    in_files = {"rostest": _TEST_PROGRAMS, "topic_tools": [*_TOPIC_PROGRAMS, *_EXPRESSION_PROGRAMS]}
    return [*found, *in_files.get(package, ())]


def _unsupported() -> dict[str, str]:
    """Return the packages of ROS without a substitute, each with the reason."""
    page = f"opens a window, which fibws cannot; see the hub's page instead: {command_name('open')}"
    built_in = "is part of the hub and needs no start"
    talker = command_name("run rospy_tutorials talker")
    return {
        **dict.fromkeys(_WINDOWS, page),
        **dict.fromkeys(sorted(IN_CPP), f"is {CPP}"),
        "joint_state_publisher_gui": "opens a window, which fibws cannot; publish joint_states, or "
        "start joint_state_publisher with ~source_list",
        "gazebo_ros": "is not supported: fibws does not simulate robots; an installed Gazebo joins "
        "a hub with --ros1",
        "roscpp_tutorials": f"is in C++, which fibws does not build; in Python: {talker}",
        "rosbridge_server": built_in,
        "rosapi": built_in,
        "rosout": built_in,
    }
