"""Filling a buffer from /tf and /tf_static, as tf2's TransformListener does."""

from __future__ import annotations

import asyncio
from contextlib import suppress
from functools import partial
from typing import Self

import fibws
from fibws.msg.tf2_msgs import TFMessage
from fibws.public_classes import AsyncContext
from fibws.tf.buffer import MAX_FRAME_ID, MAX_FRAMES, Buffer
from fibws.tf.errors import InvalidTransform, TransformError
from fibws.tf.history import LATEST, Sample
from fibws.tf.messages import read

QUEUE_SIZE = 100
"""Length of the queues of messages, as in tf2."""


class TransformListener(AsyncContext):
    """Subscribes to ``/tf`` and ``/tf_static`` and fills a buffer: ``async with`` it.

    Invalid transforms are logged, once for each frame. As in tf2, all moving transforms are removed
    when simulated time has gone back, which is logged, too.

    Args:
        node: the node.
        buffer: the buffer; by default one of its own.
        authorities: note in the buffer which node sent each transform.

    Attributes:
        buffer: the buffer.
    """

    def __init__(
        self, node: fibws.Node, buffer: Buffer | None = None, *, authorities: bool = False
    ) -> None:
        self.buffer = Buffer() if buffer is None else buffer
        self._node = node
        self._moving, self._static = (
            node.subscribe(topic, TFMessage, queue_size=QUEUE_SIZE, headers=authorities)
            for topic in ("/tf", "/tf_static")
        )
        # Transforms are added while the socket is read, so that each is of the time of its arrival:
        # one that waited while time went back would outlast the removal of the others.
        self._moving._hand_to(partial(self._add, self._moving, static=False))
        self._static._hand_to(partial(self._add, self._static, static=True))
        self._updated = fibws.Time()
        self._invalid_frames: set[str] = set()
        self._news = asyncio.Event()
        self._running: asyncio.Task[None] | None = None

    async def wait(
        self,
        target: str,
        source: str,
        stamp: fibws.Time | int = LATEST,
        timeout: float | None = None,
    ) -> Sample:
        """Wait for a transform, and return it as `Buffer.lookup` does.

        Args:
            target: the target frame.
            source: the source frame.
            stamp: the time, such as that of a message, or nanoseconds; 0 for the latest at which
                the transform is known.
            timeout: the most seconds to wait; None for ever. These are never simulated.

        Raises:
            InvalidTransform: a frame's id is invalid.
            TransformError: the transform is still not known then; the text says why.
            OperationRejected: as `run`.
            NodeClosed: the node has ended.
        """
        fault: TransformError | None = None
        try:
            async with asyncio.timeout(timeout):
                while True:
                    self.check()
                    try:
                        return self.buffer.lookup(target, source, stamp)
                    except InvalidTransform:
                        raise
                    except TransformError as error:
                        fault = error
                    self._news.clear()
                    await self._news.wait()
        except TimeoutError:
            assert fault is not None
            raise fault from None

    async def run(self) -> None:
        """Wait for the node's end, which ends the listener.

        Raises:
            OperationRejected: the hub refused; most likely a topic has another type.
        """
        try:
            async with asyncio.TaskGroup() as tasks:
                tasks.create_task(_until_end(self._moving))
                tasks.create_task(_until_end(self._static))
        except ExceptionGroup as group:
            raise group.exceptions[0] from None
        finally:
            self._news.set()

    def check(self) -> None:
        """Raise what has ended the listener: as `run` does, or NodeClosed."""
        if self._running is not None and self._running.done():
            self._running.result()
            raise fibws.NodeClosed("the node of the TransformListener has ended")

    async def __aenter__(self) -> Self:
        self._running = asyncio.create_task(self.run())
        return self

    async def __aexit__(self, kind: object, error: object, traceback: object) -> None:
        assert self._running is not None
        self._moving.close()
        self._static.close()
        if error is None:
            await self._running
        else:
            self._running.cancel()
            with suppress(asyncio.CancelledError, fibws.FibwsError):
                await self._running

    def _add(
        self, messages: fibws.Subscription[TFMessage], message: TFMessage, *, static: bool
    ) -> None:
        """Add the transforms of a message."""
        self._check_for_reset()
        authority = messages.connection_header.get("callerid", "")
        for transform in message.transforms:
            frame, sample = read(transform)
            try:
                self.buffer.insert(frame, sample, static=static, authority=authority)
            except InvalidTransform as error:
                self._warn_once(frame, f"Ignored a transform on {messages.topic}: {error}")
        self._news.set()

    def _check_for_reset(self) -> None:
        """Clear the buffer if time went back since the last message."""
        now, updated = self._node.now(), self._updated
        self._updated = now
        if now < updated:
            self._node.log.warning(
                "Detected jump back in time of %fs. Clearing TF buffer.", (updated - now).to_sec()
            )
            self.buffer.clear()

    def _warn_once(self, frame: str, text: str) -> None:
        name = frame[:MAX_FRAME_ID]
        if name not in self._invalid_frames and len(self._invalid_frames) < MAX_FRAMES:
            self._invalid_frames.add(name)
            self._node.log.warning("%s", text)


async def _until_end(messages: fibws.Subscription[TFMessage]) -> None:
    async for _ in messages:
        pass
