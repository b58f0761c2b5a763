"""The way of messages from the program's threads to the node's loop."""

from __future__ import annotations

from collections import deque
from contextlib import suppress
from typing import TYPE_CHECKING, Any

from rospy import core
from rospy.bell import Bell

if TYPE_CHECKING:
    import asyncio

    import fibws

LIMIT = 500
"""Messages that may be under way before whoever publishes waits for the loop."""

PATIENCE = 0.1
"""Seconds without room for a message after which the network counts as slow."""


class Handover:
    """Hands one publisher's messages to the loop, in order.

    That the program's own threads are slow loses no message: `put` waits a moment then. While the
    network is slow the newest messages of the publisher's queue are kept, as in ROS.

    Args:
        publisher: what sends them.
        lossless: wait for a slow network, too, as a publisher of ROS does that has no queue.
    """

    def __init__(self, publisher: fibws.Publisher[Any, ...], *, lossless: bool) -> None:
        self.use(publisher, lossless=lossless)
        self._texts: deque[bytes] = deque()
        self._begun = False
        self._slow = False
        self._task: asyncio.Task[None] | None = None
        self._drained = Bell()

    def use(self, publisher: fibws.Publisher[Any, ...], *, lossless: bool) -> None:
        """Have another publisher of the same topic send what is not sent yet; in the loop."""
        self._publisher = publisher
        self._lossless = lossless

    def put(self, text: bytes) -> None:
        """Take what the publisher has encoded, from any thread but the loop's.

        It is to be called in one thread at a time.
        """
        if not self._begun and self._send_at_once(text):
            return
        self._texts.append(text)
        if not self._begun:
            self._begun = True
            if not core.background.soon(self._begin):
                self._texts.clear()
                self._begun = False
        if len(self._texts) > LIMIT:
            self._drained.wait(lambda: len(self._texts) <= LIMIT or core.is_shutdown())

    async def finish(self) -> None:
        """Wait, in the loop, until all that was put is handed over."""
        self._begin()
        if self._task is not None:
            await self._task

    def _send_at_once(self, text: bytes) -> bool:
        """Send a message if none is under way and the loop sleeps; tell whether it is sent."""
        background = core.background
        if not background.gate.enter():
            return False
        try:
            if self._texts or not self._publisher.has_room:
                return False
            self._send(text)
            is_sent = self._publisher.is_idle
        finally:
            background.gate.leave()
        if not is_sent:
            background.soon(_wake)
        return True

    def _begin(self) -> None:
        """Send what there is room for at once, for the sake of speed; a task sees to the rest."""
        if self._task is None or self._task.done():
            self._send_some()
            if self._texts:
                import asyncio

                self._task = asyncio.create_task(self._drain(), name=f"drain {self._publisher}")

    async def _drain(self) -> None:
        while self._texts:
            await self._room()
            if self._texts:
                self._send(self._texts.popleft())
            self._send_some()

    async def _room(self) -> None:
        import asyncio

        if self._lossless:
            await self._publisher.room()
        elif self._slow:
            await asyncio.sleep(0)
        else:
            try:
                async with asyncio.timeout(PATIENCE):
                    await self._publisher.room()
            except TimeoutError:
                self._slow = True

    def _send_some(self) -> None:
        while self._texts and self._publisher.has_room:
            self._slow = False
            self._send(self._texts.popleft())
        if not self._texts:
            self._begun = False
            # What was put just before this believed that it need not begin.
            self._begun = bool(self._texts)
        self._drained.ring()

    def _send(self, text: bytes) -> None:
        from fibws.errors import NodeError

        with suppress(NodeError):  # Nobody can hear this publisher any more.
            self._publisher.send(text)


def _wake() -> None:
    """What there is to do once the loop is awake has been scheduled before."""
