"""What waits to be handled in a thread of its own."""

from __future__ import annotations

import threading
from collections.abc import Callable
from contextlib import suppress
from queue import Empty, SimpleQueue
from typing import Any, Generic, TypeVar

from rospy import core

T = TypeVar("T")


class Inbox(Generic[T]):
    """Handles one item after the other, in its own thread, until the node ends.

    Args:
        name: of the thread.
        handle: what is done with each item; it sees to its own errors.
    """

    def __init__(self, name: str, handle: Callable[[T], None]) -> None:
        self._name = name
        self._handle = handle
        self._items: SimpleQueue[T | None] = SimpleQueue()
        self._thread: threading.Thread | None = None
        self._closed = False

    def __len__(self) -> int:
        return self._items.qsize()

    def put(self, item: T, limit: int | None = None) -> bool:
        """Take an item; if more than ``limit`` wait then, let go of the oldest ones.

        It is to be called in one thread.

        Returns:
            Whether there were any to let go of.
        """
        dropped = False
        if limit is not None:
            with suppress(Empty):
                while self._items.qsize() >= limit:
                    self._items.get_nowait()
                    dropped = True
        self._items.put(item)
        if self._thread is None:
            # Not before: many topics are subscribed to on which nobody ever says anything.
            self._thread = threading.Thread(target=self._run, name=self._name, daemon=True)
            self._thread.start()
        return dropped

    def close(self) -> None:
        """Handle no more; an item that is being handled still is."""
        self._closed = True
        self._items.put(None)

    def _run(self) -> None:
        while (item := self._items.get()) is not None:
            if self._closed or core.is_shutdown():
                return
            self._handle(item)


def call(function: Callable[..., object], *arguments: Any) -> None:
    """Call a function of the program's; what it raises goes to the log, with rospy's text."""
    try:
        function(*arguments)
    except Exception:
        if not core.is_shutdown():
            import traceback

            from rospy import logerr

            logerr(f"bad callback: {function}\n{traceback.format_exc()}")
