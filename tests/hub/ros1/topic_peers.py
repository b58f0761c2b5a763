"""Ends of TCPROS connections without sockets."""

from __future__ import annotations

import asyncio
from typing import Any

from fibws.hub.graph.types import Buffer

HIGH_WATER = 64 * 1024


class FakeTransport(asyncio.Transport):
    """A transport whose peer reads only when the test says so.

    Args:
        protocol: is told that the peer reads slowly once more than a socket takes is written.
    """

    def __init__(self, protocol: Any = None) -> None:
        super().__init__()
        self.written: list[Buffer] = []
        self.is_reading = True
        self.is_closing_down = False
        self.is_aborted = False
        self._protocol = protocol
        self._unread = 0

    def get_extra_info(self, name: str, default: Any = None) -> Any:
        return {"peername": ("10.0.0.2", 4), "sockname": ("10.0.0.1", 5)}.get(name, default)

    def write(self, data: Buffer) -> None:
        self.written.append(data)
        before, self._unread = self._unread, self._unread + len(data)
        if before <= HIGH_WATER < self._unread:
            self._protocol.pause_writing()

    def read(self) -> None:
        """Let the peer read all that was written."""
        is_full, self._unread = self._unread > HIGH_WATER, 0
        if is_full:
            self._protocol.resume_writing()

    @property
    def bytes(self) -> int:
        return sum(len(each) for each in self.written)

    def pause_reading(self) -> None:
        self.is_reading = False

    def resume_reading(self) -> None:
        self.is_reading = True

    def close(self) -> None:
        self.is_closing_down = True

    def abort(self) -> None:
        self.is_aborted = True
