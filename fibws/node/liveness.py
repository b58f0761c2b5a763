"""Whether the hub is still there: pings, and what counts as a sign of life."""

from __future__ import annotations

from typing import Literal

LOOK_INTERVAL = 4.0
"""Seconds between two looks."""
PING_LOOKS, SILENT_LOOKS = 5, 10
"""Looks between two pings, and looks without a sign of life after which the hub is lost."""


class HubLiveness:
    """Counts looks at a connection. Call `look` every `LOOK_INTERVAL` seconds.

    Whatever the hub sends is a sign of life, not its pongs alone: a pong waits behind the messages
    that the hub has sent before, and a ping behind those of the node. Looks are counted, not
    seconds, as a busy or suspended process reads between two of them what has come meanwhile.
    """

    __slots__ = ("_looks", "_silent")

    def __init__(self) -> None:
        self._looks = self._silent = 0

    def alive(self) -> None:
        """Called at a sign of life: the hub has sent something, or reads again."""
        self._silent = 0

    def look(self) -> Literal["ping", "lost"] | None:
        """Return what is due."""
        self._looks += 1
        self._silent += 1
        if self._silent >= SILENT_LOOKS:
            return "lost"
        return "ping" if self._looks % PING_LOOKS == 0 else None
