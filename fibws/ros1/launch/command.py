"""How a node's program is started: its command, its variables, its folder."""

from __future__ import annotations

import os
import shlex
import subprocess
import sys
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from fibws.errors import FibwsError, LaunchError
from fibws.ros1.launch.model import Node
from fibws.ros1.launch.surroundings import split
from fibws.ros1.workspace.packages import Packages, rosrun_command

OWN = "fibws"
OWN_PROGRAMS = {"action_client", "action_server", "add_two_ints_client", "add_two_ints_server"}
OWN_PROGRAMS |= {"broadcaster", "listener", "static_transform_publisher", "tf2_web_republisher"}
ALREADY_THERE = ("rosapi", "rosbridge_server", "rosout")
"""The packages whose programs the hub stands for."""
NAMESPACE = "ROS_NAMESPACE"
HUB = "FIBWS_HUB"


@dataclass(frozen=True)
class Start:
    """What a process is started with.

    Attributes:
        command: its program and the words for that.
        environment: all its variables.
        folder: in which it runs.
    """

    command: list[str]
    environment: dict[str, str]
    folder: Path


def start_of(node: Node, packages: Packages, hub: str, environment: Mapping[str, str]) -> Start:
    """What a node's program is started with.

    Args:
        node: the node.
        packages: those that are known.
        hub: the hub's address.
        environment: the variables that there are.

    Raises:
        LaunchError: there is no such package or program.
    """
    try:
        arguments = split(node.args)
    except ValueError as error:
        raise _fault(node, f"args: {error}: {node.args}") from None
    arguments += [f"{source}:={target}" for source, target in node.remaps]
    arguments.append(f"__name:={node.name}")
    try:
        program, folder = _program(node, packages, arguments)
        prefix = split(node.prefix)
    except (FibwsError, ValueError) as error:
        raise _fault(node, str(error)) from None
    except OSError as error:
        raise _fault(node, f"cannot read {error.filename}: {error.strerror}") from None
    return Start(
        command=[*prefix, *program],
        environment={**environment, **variables_of(node, hub, environment)},
        folder=folder if node.cwd == "node" else ros_home(environment),
    )


def variables_of(node: Node, hub: str, environment: Mapping[str, str]) -> dict[str, str]:
    """The variables that a node has otherwise than they are: its namespace, its hub, its own."""
    own = {
        HUB: hub,
        # Without a slash at the end; what this process has must not be the node's.
        NAMESPACE: node.namespace,
        # What a node prints into a pipe is to come line by line, too.
        "PYTHONUNBUFFERED": "1",
        **dict(node.environment),
    }
    if node.namespace == "/" and NAMESPACE not in environment:
        own = {name: value for name, value in own.items() if (name, value) != (NAMESPACE, "/")}
    return {name: value for name, value in own.items() if environment.get(name) != value}


def hub_does_it(node: Node, packages: Packages) -> bool:
    """Whether a node needs no start, since the hub does what it does."""
    return node.package in ALREADY_THERE and not packages.has_own(node.package)


def ros_home(environment: Mapping[str, str]) -> Path:
    """The folder that nodes run in, which is ROS's for what is a person's own."""
    return Path(environment.get("ROS_HOME") or Path.home() / ".ros")


def log_folder(environment: Mapping[str, str]) -> Path:
    """The folder that holds what nodes have printed."""
    return Path(environment.get("ROS_LOG_DIR") or ros_home(environment) / "log")


def _program(node: Node, packages: Packages, arguments: list[str]) -> tuple[list[str], Path]:
    """The command of a node's program, and the folder that this is in."""
    if node.package == OWN and node.type in OWN_PROGRAMS:
        return [sys.executable, "-P", "-m", f"{OWN}.{node.type}", *arguments], Path.cwd()
    return rosrun_command(packages, node.package, node.type, arguments)


def _fault(node: Node, text: str) -> LaunchError:
    return LaunchError(node.file, node.line, f"<node {node.name}>: {text}")


def shown(variables: Mapping[str, str], command: list[str]) -> str:
    """A command as it can be typed into a shell, after the variables that it is given."""
    if os.name == "nt":
        sets = "".join(f"set {name}={value}&& " for name, value in variables.items())
        return f'cmd /c "{sets}{subprocess.list2cmdline(command)}"'
    sets = "".join(f"{name}={shlex.quote(value)} " for name, value in variables.items())
    return sets + shlex.join(command)
