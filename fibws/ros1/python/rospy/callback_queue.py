"""A bounded queue whose items are handled in a thread of its own."""

from __future__ import annotations

import threading
from collections.abc import Callable
from contextlib import suppress
from queue import Empty, SimpleQueue
from typing import Any, Generic, TypeVar

from rospy import core

T = TypeVar("T")


class CallbackQueue(Generic[T]):
    """Handles items one after the other, until the node ends.

    Args:
        name: the thread's name.
        handle: handles an item; it must not raise.
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
        """Queue an item, and drop the oldest ones if more than ``limit`` would wait.

        Call it in one thread only.

        Returns:
            Whether items were dropped.
        """
        dropped = False
        if limit is not None:
            with suppress(Empty):
                while self._items.qsize() >= limit:
                    self._items.get_nowait()
                    dropped = True
        self._items.put(item)
        if self._thread is None:
            # Not before: many programs subscribe to topics that never have a message.
            self._thread = threading.Thread(target=self._run, name=self._name, daemon=True)
            self._thread.start()
        return dropped

    def close(self) -> None:
        """Handle no more items; one that is being handled is finished."""
        self._closed = True
        self._items.put(None)

    def _run(self) -> None:
        while (item := self._items.get()) is not None:
            if self._closed or core.is_shutdown():
                return
            self._handle(item)


def call(function: Callable[..., object], *arguments: Any) -> None:
    """Call a callback of the program; if it raises, log the error with rospy's text."""
    try:
        function(*arguments)
    except Exception:
        if not core.is_shutdown():
            import traceback

            from rospy import logerr

            logerr(f"bad callback: {function}\n{traceback.format_exc()}")
