"""The nodes that scripts start."""

from __future__ import annotations

import re
import sys
from collections.abc import Sequence
from uuid import uuid1

from rosgraph.names import SEP, anonymous_name, make_global_ns

from fibws.ros1.launch import model

__all__ = ["Node", "RLException", "generate_run_id", "printerrlog", "printlog", "printlog_bold"]


class RLException(Exception):
    """A launch, or one of its nodes, cannot be started."""


class Node:
    """A node to start: the attributes of a <node> (http://wiki.ros.org/roslaunch/XML/node).

    Args:
        package: the package with its program.
        node_type: the program.
        name: its name; chosen when it is started if missing.
        namespace: its namespace.
        machine_name: ignored; all nodes are on this machine.
        args: the program's arguments, written as in a shell.
        respawn: whether it is started again when it ends.
        respawn_delay: seconds before that.
        remap_args: its remappings, from and to.
        env_args: additional environment variables.
        output: ``screen`` to show its output, else it is logged.
        cwd: ``node`` for the folder of its program, else $ROS_HOME.
        launch_prefix: a command to run its program with.
        required: whether its end ends the launch.
        filename: the file that it is from, for errors.

    Raises:
        ValueError: an argument is invalid.
    """

    def __init__(
        self,
        package: str,
        node_type: str,
        name: str | None = None,
        namespace: str = "/",
        machine_name: str | None = None,
        args: str = "",
        respawn: bool = False,
        respawn_delay: float = 0.0,
        remap_args: Sequence[tuple[str, str]] | None = None,
        env_args: Sequence[tuple[str, str]] | None = None,
        output: str | None = None,
        cwd: str | None = None,
        launch_prefix: str | None = None,
        required: bool = False,
        filename: str = "<unknown>",
    ) -> None:
        self.package = package
        self.type = node_type
        self.name = name or None
        self.namespace = re.sub("//+", "/", make_global_ns(namespace or "/"))
        self.machine_name = machine_name or None
        self.args = args or ""
        self.respawn = respawn
        self.respawn_delay = respawn_delay
        self.remap_args = list(remap_args or ())
        self.env_args = list(env_args or ())
        self.output = output
        self.cwd = "ROS_HOME" if cwd == "ros_home" else cwd
        self.launch_prefix = launch_prefix or None
        self.required = required
        self.filename = filename
        if respawn and required:
            raise ValueError("respawn and required cannot both be set to true")
        if self.name and SEP in self.name:
            raise ValueError("node name cannot contain a namespace")
        if not package.strip():
            raise ValueError("package must be non-empty")
        if not node_type.strip():
            raise ValueError("type must be non-empty")
        if output not in ("log", "screen", None):
            raise ValueError("output must be one of 'log', 'screen'")
        if self.cwd not in ("ROS_HOME", "node", None):
            raise ValueError("cwd must be one of 'ROS_HOME', 'node'")

    def as_in_launch_file(self) -> model.LaunchNode:
        """Return it as a launch file's <node>; one without a name gets one."""
        if self.name is None:
            self.name = anonymous_name(self.type)
        return model.LaunchNode(
            self.package,
            self.type,
            self.name,
            self.filename,
            line=0,
            namespace=self.namespace.rstrip("/") or "/",
            args=self.args,
            screen=self.output == "screen",
            respawn=self.respawn,
            respawn_delay=self.respawn_delay,
            required=self.required,
            cwd=self.cwd,
            prefix=self.launch_prefix or "",
            remaps=tuple(self.remap_args),
            environment=tuple(self.env_args),
        )


def generate_run_id() -> str:
    """Return a new id of a run."""
    return str(uuid1())


def printlog(msg: str) -> None:
    """Print a text."""
    print(msg)


printlog_bold = printlog


def printerrlog(msg: str) -> None:
    """Print a text to standard error."""
    print(msg, file=sys.stderr)
