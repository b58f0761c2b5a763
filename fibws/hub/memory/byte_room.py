"""A bound for the bytes of files that are held for all clients together."""

from __future__ import annotations

from collections.abc import Callable
from threading import Lock


class ByteRoom:
    """The room for files on their way to clients: taken before a file is read, until it is sent.

    Args:
        size: bytes that may be held at once.
    """

    def __init__(self, size: int) -> None:
        self.size = size
        self._left = size
        self._lock = Lock()
        self._waiting: dict[Callable[[], object], None] = {}

    @property
    def held(self) -> int:
        """Bytes that are held now."""
        return self.size - self._left

    def take(self, size: int) -> bool:
        """Take room, in any thread; return whether there is enough."""
        with self._lock:
            if size > self._left:
                return False
            self._left -= size
            return True

    def give_back(self, size: int) -> None:
        """Return room that was taken, and call those that wait for it, first come first."""
        with self._lock:
            self._left += size
        waiting, self._waiting = self._waiting, {}
        for retry in waiting:
            retry()

    def wait(self, retry: Callable[[], object]) -> None:
        """Have a function called once when there is more room; in the event loop."""
        self._waiting[retry] = None

    def forget(self, retry: Callable[[], object]) -> None:
        """Do not call a function that waits."""
        self._waiting.pop(retry, None)


class Reservation:
    """The room of one file on its way to a client."""

    def __init__(self, room: ByteRoom) -> None:
        self._room = room
        self._size = 0
        self._has_ended = False
        self._lock = Lock()

    def reserve(self, size: int) -> bool:
        """Take room, in any thread; return whether there is enough, and somebody waits for it."""
        with self._lock:
            if self._has_ended or not self._room.take(size):
                return False
            self._size = size
            return True

    def end(self) -> None:
        """Return the room: the file is sent, or not wanted any more."""
        with self._lock:
            self._has_ended = True
            self._room.give_back(self._size)
            self._size = 0
