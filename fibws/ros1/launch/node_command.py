"""The command, environment variables and folder that a node's program is started with."""

from __future__ import annotations

import os
import shlex
import subprocess
import sys
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from fibws.errors import FibwsError
from fibws.ros1.errors import LaunchError
from fibws.ros1.launch.environment import split
from fibws.ros1.launch.model import LaunchNode
from fibws.ros1.workspace.packages import Packages, rosrun_command

MODULES = {
    "broadcaster": "fibws.broadcaster",
    "listener": "fibws.listener",
    "action_client": "fibws.examples.action_client",
    "action_server": "fibws.examples.action_server",
    "add_two_ints_client": "fibws.examples.add_two_ints_client",
    "add_two_ints_server": "fibws.examples.add_two_ints_server",
    "static_transform_publisher": "fibws.programs.static_transform_publisher",
    "tf2_web_republisher": "fibws.programs.tf2_web_republisher",
}
"""The programs of the package ``fibws``."""
BUILT_IN = ("rosapi", "rosbridge_server", "rosout")
"""Packages whose programs are part of the hub."""
NAMESPACE = "ROS_NAMESPACE"
HUB = "FIBWS_HUB"


@dataclass(frozen=True)
class NodeCommand:
    """How to start a process.

    Attributes:
        command: its program and arguments.
        environment: all its environment variables.
        folder: its working directory.
    """

    command: list[str]
    environment: dict[str, str]
    folder: Path


def node_command(
    node: LaunchNode, packages: Packages, hub: str, environment: Mapping[str, str]
) -> NodeCommand:
    """Return how to start a node's program.

    Args:
        node: the node.
        packages: the known packages.
        hub: the hub's address.
        environment: the environment variables of this process.

    Raises:
        LaunchError: the package or program is not found, or an attribute is invalid.
    """
    try:
        arguments = split(node.args)
    except ValueError as error:
        raise _error(node, f"args: {error}: {node.args}") from None
    arguments += [f"{source}:={target}" for source, target in node.remaps]
    arguments.append(f"__name:={node.name}")
    try:
        program, folder = _program(node, packages, arguments)
        prefix = split(node.prefix)
    except (FibwsError, ValueError) as error:
        raise _error(node, str(error)) from None
    except OSError as error:
        raise _error(node, f"cannot read {error.filename}: {error.strerror}") from None
    return NodeCommand(
        command=[*prefix, *program],
        environment={**environment, **node_variables(node, hub, environment)},
        folder=folder if node.cwd == "node" else ros_home(environment),
    )


def node_variables(node: LaunchNode, hub: str, environment: Mapping[str, str]) -> dict[str, str]:
    """Return the variables that differ from this process's: namespace, hub, <env>."""
    own = {
        HUB: hub,
        # Without a trailing slash; this process's own value must not be inherited.
        NAMESPACE: node.namespace,
        # For output line by line, though it goes into a pipe.
        "PYTHONUNBUFFERED": "1",
        **dict(node.environment),
    }
    if node.namespace == "/" and NAMESPACE not in environment:
        own = {name: value for name, value in own.items() if (name, value) != (NAMESPACE, "/")}
    return {name: value for name, value in own.items() if environment.get(name) != value}


def is_built_in(node: LaunchNode, packages: Packages) -> bool:
    """Return whether the hub does what a node does, so that the node is not started."""
    return node.package in BUILT_IN and not packages.has_own(node.package)


def ros_home(environment: Mapping[str, str]) -> Path:
    """Return the working directory of nodes, $ROS_HOME or ~/.ros."""
    return Path(environment.get("ROS_HOME") or Path.home() / ".ros")


def log_folder(environment: Mapping[str, str]) -> Path:
    """Return the folder for log files, $ROS_LOG_DIR or log in `ros_home`."""
    return Path(environment.get("ROS_LOG_DIR") or ros_home(environment) / "log")


def shell_line(variables: Mapping[str, str], command: list[str]) -> str:
    """Return a command with variables as a person types it into a shell."""
    if os.name == "nt":
        sets = "".join(f"set {name}={value}&& " for name, value in variables.items())
        return f'cmd /c "{sets}{subprocess.list2cmdline(command)}"'
    sets = "".join(f"{name}={shlex.quote(value)} " for name, value in variables.items())
    return sets + shlex.join(command)


def _program(node: LaunchNode, packages: Packages, arguments: list[str]) -> tuple[list[str], Path]:
    """Return the command of a node's program, and the program's folder."""
    if node.package == "fibws" and node.type in MODULES:
        return [sys.executable, "-P", "-m", MODULES[node.type], *arguments], Path.cwd()
    return rosrun_command(packages, node.package, node.type, arguments)


def _error(node: LaunchNode, text: str) -> LaunchError:
    return LaunchError(node.file, node.line, f"<node {node.name}>: {text}")
