"""What launch files set for rosbridge_websocket, whose place the hub takes.

Launch files start it as a node, mostly by including rosbridge_server's rosbridge_websocket.launch.
Web pages then look for it at the port in the launch file. Its parameters and options are in
http://wiki.ros.org/rosbridge_suite/Tutorials/RunningRosbridge.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from fibws.hub_address import LOOPBACK
from fibws.ros1.errors import LaunchError
from fibws.ros1.launch.environment import split
from fibws.ros1.launch.model import Launch, LaunchNode
from fibws.ros1.launch.node_command import is_built_in
from fibws.ros1.workspace.packages import Packages

TYPE = "rosbridge_websocket"
LARGEST_PORT = 65535


@dataclass(frozen=True)
class RosbridgeNode:
    """A rosbridge_websocket in a launch file.

    Attributes:
        port: the port that the file gives it; 0 for a free one, None without one.
        ignored: the settings that the hub ignores, each with what to do instead.
    """

    node: LaunchNode
    port: int | None
    ignored: tuple[str, ...]

    @property
    def place(self) -> str:
        """Its file, line and name, for warnings."""
        return f"{self.node.file}:{self.node.line}: {self.node.name}"


def rosbridges(launch: Launch, packages: Packages) -> Iterator[RosbridgeNode]:
    """Yield each rosbridge_websocket of a launch that the hub replaces.

    Raises:
        LaunchError: a port is invalid.
    """
    for node in launch.nodes.values():
        is_websocket = node.type.removesuffix(".py") == TYPE and not node.is_test
        if is_websocket and node.package == "rosbridge_server" and is_built_in(node, packages):
            port = _port(node, launch)
            yield RosbridgeNode(node, port, tuple(_ignored(node, launch, port)))


def _port(node: LaunchNode, launch: Launch) -> int | None:
    """Return the port in ``--port`` of its arguments, or else in its parameter ``port``."""
    given = launch.parameters.get(f"{node.resolved}/port")
    try:
        words = split(node.args)
    except ValueError:
        words = []  # It is not started, so that its arguments need not be valid.
    if "--port" in words[:-1]:
        given = words[words.index("--port") + 1]
    if given is None or given == "":
        return None
    text = str(given)
    if not (text.isascii() and text.isdigit() and int(text) <= LARGEST_PORT):
        fault = f"<node {node.name}>: port must be between 0 and {LARGEST_PORT}, got {text!r}"
        raise LaunchError(node.file, node.line, fault)
    return int(text)


def _ignored(node: LaunchNode, launch: Launch, port: int | None) -> Iterator[str]:
    address = launch.parameters.get(f"{node.resolved}/address")
    if address and address not in LOOPBACK:
        hub = f"fibws hub --host {address}{f' --port {port}' if port else ''}"
        yield f"address {address} is ignored; for other machines, start {hub} before this launch"
    if certificate := launch.parameters.get(f"{node.resolved}/certfile"):
        yield f"certfile {certificate} is ignored; for TLS, use a proxy (docs/operations.md)"
    if launch.parameters.get(f"{node.resolved}/authenticate"):
        yield "authenticate is ignored; the hub does not ask for passwords"
