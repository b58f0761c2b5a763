"""Services between ROS 1 nodes and the hub's clients."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from fibws.errors import TcprosError
from fibws.hub.ros1.connection import TcprosConnection
from fibws.hub.ros1.nodes import Ros1Node


class ServiceLinks:
    """All links for services."""

    def __init__(self, *parts: Any) -> None:
        pass

    def register(self, node: Ros1Node, service: str, uri: str) -> None:
        """Add a service of a ROS 1 node to the graph."""

    def unregister(self, node: Ros1Node, service: str) -> None:
        """Remove it."""

    def accept(self, header: Mapping[str, str], connection: TcprosConnection) -> None:
        """Refuse a caller; raises `TcprosError`."""
        raise TcprosError(f"service [{header['service']}] is not provided by the hub")

    async def close(self) -> None:
        """Close all links."""
