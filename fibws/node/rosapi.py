"""What a node can ask of the hub itself: the services of the ROS package rosapi."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from fibws.interfaces import Service
from fibws.interfaces.bases import Req, Res
from fibws.node.calls import Calls


class Rosapi:
    """Asks the hub.

    Args:
        calls: the node's.
        resolve: gives the global name that a name stands for in the node.
    """

    def __init__(self, calls: Calls, resolve: Callable[[str], str]) -> None:
        self._calls = calls
        self._resolve = resolve

    async def _ask(self, service: str, type_: type[Service[Req, Res]], /, **request: Any) -> Res:
        return await self._calls.call(f"/rosapi/{service}", type_, request)
