"""Messages of a client that has just come, and has yet to advertise: they wait a little for that.

roslibpy that has lost its hub and found it again publishes for a second before it advertises again.
"""

from __future__ import annotations

from collections.abc import Callable

from fibws.hub.clock import Clock, Timer
from fibws.protocol.operations import Publish, encode

GRACE = 3.0
"""Seconds from the client's coming."""
MOST_BYTES = 2**20
"""Bytes of JSON that may wait for one client's advertisements."""
MESSAGE_COST = 300
"""What keeping a message costs beside its text, in bytes; it bounds floods of small ones."""


class EarlyMessages:
    """One client's messages that wait, in order, until the grace since its coming is over.

    Args:
        end: when the grace is over.
        late: takes the messages for which nobody came.
    """

    def __init__(self, clock: Clock, end: float, late: Callable[[Publish], None]) -> None:
        self._clock = clock
        self._end = end
        self._late = late
        self._messages: list[tuple[str, Publish]] = []
        self._size = 0
        self._timer: Timer | None = None

    def put(self, topic: str, message: Publish) -> bool:
        """Let a message wait for the type of its topic; tell whether it may."""
        now = self._clock.time()
        size = _size(message)
        if now >= self._end or self._size + size > MOST_BYTES:
            return False
        self._messages.append((topic, message))
        self._size += size
        if self._timer is None:
            self._timer = self._clock.call_later(self._end - now, self._give_up)
        return True

    def take(self, topic: str) -> list[Publish]:
        """The messages of a topic, which wait no more."""
        taken = [message for name, message in self._messages if name == topic]
        if taken:
            self._messages = [each for each in self._messages if each[0] != topic]
            self._size -= sum(map(_size, taken))
        return taken

    def close(self) -> None:
        """Let nothing wait any more."""
        self._messages.clear()
        if self._timer is not None:
            self._timer.cancel()

    def _give_up(self) -> None:
        late, self._messages = self._messages, []
        for _, message in late:
            self._late(message)


def _size(message: Publish) -> int:
    return len(encode(message)) + MESSAGE_COST
