"""Connections to the hub for scenarios, and queues to wait for messages."""

from __future__ import annotations

import json
import queue
import threading
from collections.abc import Callable
from typing import Any

import roslibpy
from patience import PATIENCE


class World:
    """Connections to one hub."""

    def __init__(self, url: str) -> None:
        self.url = url
        self._printing = threading.Lock()

    def connect(self, *, node: str | None = None) -> Any:
        """A connection that is open, by the name of ``node`` if one is given."""
        ros = roslibpy.Ros(f"{self.url}/?node={node}" if node else self.url)
        ros.run()
        return ros

    def settled(self, ros: Any) -> None:
        """Wait until the hub has processed all earlier operations of this connection."""
        ros.get_time()

    def report(self, line: dict[str, Any]) -> None:
        with self._printing:
            print(json.dumps(line, default=dict), flush=True)


class Collected(queue.SimpleQueue[Any]):
    """Values that callbacks put, to be waited for."""

    def many(self, count: int) -> list[Any]:
        return [self.get(timeout=PATIENCE) for _ in range(count)]


def eventually(condition: Callable[[], bool]) -> None:
    """Poll for a change in roslibpy that has no event."""
    pause = threading.Event()
    while not condition():
        pause.wait(0.05)
