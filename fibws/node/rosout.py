"""A node's log on /rosout, where the whole graph can read it."""

from __future__ import annotations

import asyncio
import logging
from contextlib import suppress
from typing import Any

from fibws.node.text import sendable
from fibws.node.topics import Topics
from fibws.protocol.levels import severity
from fibws.protocol.operations import Advertise, Publish, encode

TOPIC = "/rosout"
QUEUE_SIZE = 100

_TEXT = logging.Formatter()


class Rosout(logging.Handler):
    """Publishes each record as a rosgraph_msgs/Log, from any thread, and waits for nothing."""

    def __init__(self, node: str, topics: Topics) -> None:
        super().__init__()
        self._node = node
        self._topics = topics
        self._advertisement = topics.advertise(
            Advertise(
                id=f"advertise:{TOPIC}",
                topic=TOPIC,
                type="rosgraph_msgs/Log",
                queue_size=QUEUE_SIZE,
            )
        )
        self.loop: asyncio.AbstractEventLoop | None = None
        """The node's loop, once it has one."""

    def emit(self, record: logging.LogRecord) -> None:
        """Publish the record."""
        try:
            message = self._message(record)
        except Exception:
            self.handleError(record)
            return
        if self.loop is None or self.loop is _running_loop():
            self._publish(message)
            return
        with suppress(RuntimeError):  # The loop is closed: nobody hears this node any more.
            self.loop.call_soon_threadsafe(self._publish, message)

    def _message(self, record: logging.LogRecord) -> dict[str, Any]:
        secs, nsecs = divmod(round(record.created * 1e9), 1_000_000_000)
        return {
            "header": {"seq": 0, "stamp": {"secs": secs, "nsecs": nsecs}, "frame_id": ""},
            "level": severity(record.levelno).ros,
            "name": self._node,
            "msg": sendable(_TEXT.format(record)),
            "file": sendable(record.pathname),
            "function": record.funcName or "",
            "line": record.lineno,
        }

    def _publish(self, message: dict[str, Any]) -> None:
        if not self._topics.over and not self._advertisement.closed:
            message["topics"] = self._topics.names()  # Here, where nothing changes them meanwhile.
            text = encode(Publish(topic=TOPIC, msg=message))
            self._topics.publish(self._advertisement, text)


def _running_loop() -> asyncio.AbstractEventLoop | None:
    try:
        return asyncio.get_running_loop()
    except RuntimeError:
        return None
