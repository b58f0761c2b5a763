"""Errors for imports that are not found: messages, services, and modules that scripts need."""

from __future__ import annotations

import os
import sys
from typing import NoReturn

from fibws.command_names import command_name
from fibws.definition_folders import VARIABLE, find_unnamed, hold_definitions
from fibws.suggestions import nearest, suggestion

MAKE = "workspace make"
_KINDS = {"msg": "message", "srv": "service"}

_ON_PYPI = {
    **{name: name for name in ("matplotlib", "numpy", "pandas", "pygame", "requests", "scipy")},
    "PIL": "pillow",
    "catkin_pkg": "catkin-pkg",
    "cv2": "opencv-python-headless",
    "rosdep2": "rosdep",
    "serial": "pyserial",
    "skimage": "scikit-image",
    "sklearn": "scikit-learn",
    "urdf_parser_py": "urdf-parser-py",
    "usb": "pyusb",
    "xacro": "xacro",
}
"""Modules that scripts of ROS import, each with its name on PyPI."""
_IN_WORKSPACES = {
    "bondpy": "ros/bond_core",
    "camera_calibration_parsers": "ros-perception/image_common",
    "genmsg": "ros/genmsg",
    "geodesy": "ros-geographic-info/geographic_info",
    "image_geometry": "ros-perception/vision_opencv",
    "laser_geometry": "ros-perception/laser_geometry",
    "rosserial_python": "ros-drivers/rosserial",
    "rospy_message_converter": "DFKI-NI/rospy_message_converter",
    "smach": "ros/executive_smach",
    "smach_ros": "ros/executive_smach",
    "sound_play": "ros-drivers/audio_common",
}
"""Modules in Python that a workspace can build, each with its repository."""
_CPP = {
    "moveit_commander": "moveit_commander needs MoveIt",
    "moveit_ros_planning_interface": "it is part of MoveIt",
    "pcl": "it needs the Point Cloud Library",
}
_QT = "windows of Qt are not part of fibws; see the hub's page"
_BUILT_IN = "it is built into the hub; PyPI's roslibpy is a client: pip install roslibpy"
_ROSPKG = "PyPI's rospkg has it: pip install 'fibws[ros1]'"
_ELSEWHERE = {
    "PyKDL": "install Debian's python3-pykdl, which only the system's Python finds; or use "
    "tf.transformations",
    "catkin": "workspaces are built by fibws; see fibws workspace. To find packages: import rospkg",
    "gazebo_ros": "fibws does not simulate robots; an installed Gazebo joins a hub with --ros1",
    "python_qt_binding": _QT,
    "qt_gui": _QT,
    "rosbridge_library": _BUILT_IN,
    "rosbridge_server": _BUILT_IN,
    "rosgraph.xmlrpc": "nodes of fibws speak no XML-RPC; rosgraph.Master asks the hub",
    "roslib.gentools": "the classes of messages have _md5sum and _full_text",
    "rosmaster": "the hub is the master; see fibws core",
    "rospkg.distro": _ROSPKG,
    "rospkg.stack": _ROSPKG,
    "roswtf": "checks of the graph are the command roswtf; see fibws doctor",
    "rqt_gui": _QT,
    "rqt_gui_py": _QT,
    "rviz": _QT,
    "tf2_kdl": "tf2_geometry_msgs transforms the same messages without KDL",
}
"""Modules that are not there, each with the nearest way out."""
_OWN = ("actionlib", "rosgraph", "roslaunch", "roslib", "rospy", "rostest", "rosunit")
"""Packages of fibws whose internal modules in ROS it does not have."""


def advise(fullname: str) -> None:
    """Explain how to get a module that was not found, if that is known.

    Args:
        fullname: the name of any module: ``package.msg`` or ``package.srv``, ``package`` on the way
            to one of these, or a module that scripts of ROS use.

    Raises:
        ModuleNotFoundError: it is known, and being imported.
    """
    package, _, rest = fullname.partition(".")
    for kind in _KINDS:
        if rest in ("", kind) and _is_being_imported(f"{package}.{kind}"):
            raise ModuleNotFoundError(_advice(fullname, package, kind), name=fullname)
    if (way_out := _way_out(fullname)) and _is_being_imported(fullname):
        raise ModuleNotFoundError(f"No module named {fullname!r}: {way_out}", name=fullname)


def advise_submodule(package: str, kind: str, name: str) -> NoReturn:
    """Explain how to import a type that was imported from its package.

    Raises:
        ImportError: always.
    """
    right = f"from {package}.{kind} import {name}"
    raise ImportError(f"cannot import name {name!r} from {package!r}: write {right}", name=package)


def no_such_name(package: str, kind: str, name: str, names: list[str]) -> str:
    """Return the error for a name that is not among the ``names`` in ``package.msg``."""
    return (
        f"cannot import name {name!r} from '{package}.{kind}': {package} has no {_KINDS[kind]} of "
        f"this name{suggestion(name, names)}"
    )


def _is_being_imported(name: str) -> bool:
    """Return whether a module is being imported, and not only searched for."""
    frame = sys._getframe()
    while frame.f_back is not None:
        frame = frame.f_back
        code = frame.f_code
        if code.co_name == "_find_and_load" and code.co_filename.startswith("<frozen importlib"):
            if frame.f_locals.get("name") == name:
                return True
    return False


def _way_out(module: str) -> str | None:
    """Return how to get a module that scripts of ROS use, or what to use instead."""
    if module in _ON_PYPI:
        return f"run pip install {_ON_PYPI[module]}"
    if module in _IN_WORKSPACES:
        address = f"https://github.com/{_IN_WORKSPACES[module]}"
        return f"clone {address} into the folder src of a workspace and run {command_name(MAKE)}"
    if module in _CPP:
        return f"{_CPP[module]}, which is C++ and not part of fibws"
    package, _, rest = module.partition(".")
    if module not in _ELSEWHERE and rest and package in _OWN:
        return f"fibws has the {package} that scripts use, and not this module, internal to ROS's"
    return _ELSEWHERE.get(module)


def _advice(fullname: str, package: str, kind: str) -> str:
    """Return the error for ``package.msg``, with the steps that make it importable."""
    text = f"No module named {fullname!r}"
    if hold_definitions(package):
        return f"{text}: {package} has no .{kind} files"
    folder = find_unnamed(package, kind)
    if folder is not None:
        root = next((each for each in folder.parents if each.name == "src"), None)
        if root is None:
            return f"{text}: set {VARIABLE}={folder.parents[1]}"
        setup = root.parent / "devel" / "setup.bash"
        make = "" if setup.is_file() else f"run {command_name(MAKE)} in {root.parent}, then "
        return f"{text}: {make}source {setup}"
    if way_out := _way_out(package):
        return f"{text}: {way_out}"
    near = nearest(package, _packages(), cutoff=0.8)
    guess = f"did you mean {near}? Or is " if near else "is "
    return (
        f"{text}: {guess}it in a workspace? Then run {command_name(MAKE)} there and source its "
        f"devel/setup.bash. Or set {VARIABLE} to its folder "
        f"(now: {os.environ.get(VARIABLE) or 'not set'})"
    )


def _packages() -> list[str]:
    """Return the packages with known definitions."""
    from fibws.errors import InterfaceError
    from fibws.msg import default_interfaces

    try:
        return default_interfaces().packages()
    except InterfaceError:  # Importing known messages reports it.
        return []
