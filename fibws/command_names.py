"""The doors: commands of ROS 1, each of which is a command of fibws under another name."""

from __future__ import annotations

DOORS = {
    "catkin_create_pkg": "pkg create",
    "catkin_init_workspace": "workspace init",
    "catkin_make": "workspace make",
    "roscore": "core",
    "roslaunch": "launch",
    "rosmsg": "msg",
    "rosnode": "node",
    "rospack": "pkg",
    "rosparam": "param",
    "rosrun": "run",
    "rosservice": "service",
    "rossrv": "srv",
    "rostopic": "topic",
    "roswtf": "doctor",
    "rqt": "open",
    "rqt_console": "open console",
    "rqt_graph": "open graph",
    "rqt_plot": "open plot",
    "rqt_topic": "open topics",
}
"""What each door has ``fibws`` do."""
