"""The messages on their way from the program's threads to the node's event loop."""

from __future__ import annotations

from collections import deque
from contextlib import suppress
from typing import TYPE_CHECKING, Any

from rospy import core
from rospy.wakeup import Wakeup

if TYPE_CHECKING:
    import asyncio

    import fibws

LIMIT = 500
"""Most messages in the queue; then `OutgoingQueue.put` waits for the loop."""

PATIENCE = 0.1
"""Seconds without room for a message after which the network counts as slow."""


class OutgoingQueue:
    """Sends one publisher's messages in order: at once while the loop sleeps, else in the loop.

    No message is lost because the program's own threads are slow: `put` waits then. While the
    network is slow, the newest messages of the publisher's queue are kept, as in ROS.

    Args:
        publisher: sends the messages.
        lossless: wait for a slow network, too, as ROS does for a publisher without a queue.
    """

    def __init__(self, publisher: fibws.Publisher[Any, ...], *, lossless: bool) -> None:
        self.use(publisher, lossless=lossless)
        self._frames: deque[bytes] = deque()
        self._scheduled = False
        """Whether the loop is sending the frames, or is about to."""
        self._slow = False
        self._task: asyncio.Task[None] | None = None
        self._drained = Wakeup()

    def use(self, publisher: fibws.Publisher[Any, ...], *, lossless: bool) -> None:
        """Send the remaining messages by another publisher of the topic; call it in the loop."""
        self._publisher = publisher
        self._lossless = lossless

    def put(self, frame: bytes) -> None:
        """Send or queue a frame that the publisher encoded.

        Call it in one thread at a time, but never in the loop's.
        """
        if not self._scheduled and self._send_at_once(frame):
            return
        self._frames.append(frame)
        if not self._scheduled:
            self._scheduled = True
            if not core.background.soon(self._start):
                self._frames.clear()
                self._scheduled = False
        if len(self._frames) > LIMIT:
            self._drained.wait(lambda: len(self._frames) <= LIMIT or core.is_shutdown())

    async def flush(self) -> None:
        """Wait, in the loop, until the publisher has been given all frames."""
        self._start()
        if self._task is not None:
            await self._task

    def _send_at_once(self, frame: bytes) -> bool:
        """Send a frame in this thread if the queue is empty and the loop sleeps.

        Returns:
            Whether it was sent.
        """
        background = core.background
        if not background.loop_lock.try_acquire():
            return False
        try:
            if self._frames or not self._publisher._has_room:
                return False
            self._send(frame)
            is_sent = self._publisher._is_idle
        finally:
            background.loop_lock.release()
        if not is_sent:
            background.soon(_wake)
        return True

    def _start(self) -> None:
        """Send as many messages as there is room for; start a task for the rest."""
        if self._task is None or self._task.done():
            self._send_some()
            if self._frames:
                import asyncio

                self._task = asyncio.create_task(self._drain(), name=f"drain {self._publisher}")
                core.background.finish_before_end(self._task)

    async def _drain(self) -> None:
        while self._frames:
            await self._room()
            if self._frames:
                self._send(self._frames.popleft())
            self._send_some()

    async def _room(self) -> None:
        import asyncio

        if self._lossless:
            await self._publisher._room()
        elif self._slow:
            await asyncio.sleep(0)
        else:
            try:
                async with asyncio.timeout(PATIENCE):
                    await self._publisher._room()
            except TimeoutError:
                self._slow = True

    def _send_some(self) -> None:
        while self._frames and self._publisher._has_room:
            self._slow = False
            self._send(self._frames.popleft())
        if not self._frames:
            self._scheduled = False
            # A frame that was put just before this did not schedule anything.
            self._scheduled = bool(self._frames)
        self._drained.wake_all()

    def _send(self, frame: bytes) -> None:
        from fibws.errors import NodeError

        with suppress(NodeError):  # The topic was refused, or the node has ended.
            self._publisher._send(frame)


def _wake() -> None:
    """Do nothing: a call in the loop wakes it, and it runs what was scheduled before."""
