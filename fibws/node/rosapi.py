"""What a node can ask of the hub itself: the services of the ROS package rosapi."""

from __future__ import annotations

from typing import Any

from fibws.interfaces import Service
from fibws.interfaces.message import Req, Res
from fibws.node.calls import Calls


class Rosapi:
    """Asks the hub.

    Args:
        calls: the node's.
    """

    def __init__(self, calls: Calls) -> None:
        self._calls = calls

    async def ask(self, service: str, type_: type[Service[Req, Res]], /, **request: Any) -> Res:
        """Call ``/rosapi/<service>`` with a request of these fields; see `Node.call`."""
        return await self._calls.call(f"/rosapi/{service}", type_, request)
