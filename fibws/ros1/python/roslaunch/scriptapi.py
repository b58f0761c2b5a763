"""Nodes that scripts start one by one."""

from __future__ import annotations

from roslaunch.core import Node, RLException
from roslaunch.parent import ROSLaunchParent
from roslaunch.pmon import Process

__all__ = ["ROSLaunch"]


class ROSLaunch:
    """Starts nodes one by one, and ends them."""

    def __init__(self) -> None:
        self.parent = ROSLaunchParent(None, [], show_summary=False)
        self.started = False

    def start(self) -> None:
        """Connect to the hub, or start one; raise `RLException` if that is impossible."""
        self.parent.start(auto_terminate=False)
        self.started = True

    def launch(self, node: Node) -> Process:
        """Start a node.

        Raises:
            RLException: this is not started, or the node cannot be started.
            ValueError: it is not a `Node`.
        """
        if not self.started:
            raise RLException("please start ROSLaunch first")
        if not isinstance(node, Node):
            raise ValueError("arg must be of type Node")
        process = self.parent.launch(node.as_in_launch_file())
        if process is None:
            raise RLException(f"failed to launch {node.package}/{node.type}")
        return process

    def spin(self) -> None:
        """Wait for `stop`, for the end of a required node, or for Ctrl-C; then end all nodes."""
        self.parent.spin()

    def spin_once(self) -> None:
        """Do nothing: the nodes are watched by a thread."""

    def stop(self) -> None:
        """End all nodes."""
        self.parent.shutdown()
