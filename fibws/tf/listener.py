"""Filling a buffer from /tf and /tf_static, as tf2's TransformListener does."""

from __future__ import annotations

import asyncio

import fibws
from fibws.msg.tf2_msgs import TFMessage
from fibws.tf.buffer import MAX_FRAME_ID, MAX_FRAMES, Buffer
from fibws.tf.errors import InvalidTransform, TransformError
from fibws.tf.history import LATEST, Sample
from fibws.tf.messages import read

QUEUE_SIZE = 100
"""Length of the queues of messages, as in tf2."""


class TransformListener:
    """Subscribes to ``/tf`` and ``/tf_static`` and fills a buffer.

    Invalid transforms are logged, once for each frame.

    Args:
        node: the node.
        buffer: the buffer.
        authorities: note in the buffer which node sent each transform.
    """

    def __init__(self, node: fibws.Node, buffer: Buffer, *, authorities: bool = False) -> None:
        self._moving, self._static = (
            node.subscribe(topic, TFMessage, queue_size=QUEUE_SIZE, headers=authorities)
            for topic in ("/tf", "/tf_static")
        )
        self._buffer = buffer
        self._log = node.log
        self._invalid_frames: set[str] = set()
        self._news = asyncio.Event()

    async def wait(
        self, target: str, source: str, stamp: int = LATEST, timeout: float | None = None
    ) -> Sample:
        """Wait for a transform, and return it as `Buffer.lookup` does.

        Another task must `run` the listener.

        Args:
            target: the target frame.
            source: the source frame.
            stamp: the time in nanoseconds; 0 for the latest at which the transform is known.
            timeout: the most seconds to wait; None for ever.

        Raises:
            InvalidTransform: a frame's id is invalid.
            TransformError: the transform is still not known then; the text says why.
        """
        fault: TransformError | None = None
        try:
            async with asyncio.timeout(timeout):
                while True:
                    try:
                        return self._buffer.lookup(target, source, stamp)
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
        """Fill the buffer until the node ends.

        Raises:
            OperationRejected: the hub refused; most likely a topic has another type.
        """
        try:
            async with asyncio.TaskGroup() as tasks:
                tasks.create_task(self._receive(self._moving, static=False))
                tasks.create_task(self._receive(self._static, static=True))
        except ExceptionGroup as group:
            raise group.exceptions[0] from None

    async def _receive(self, messages: fibws.Subscription[TFMessage], *, static: bool) -> None:
        async for message in messages:
            authority = messages.connection_header.get("callerid", "")
            for transform in message.transforms:
                frame, sample = read(transform)
                try:
                    self._buffer.insert(frame, sample, static=static, authority=authority)
                except InvalidTransform as error:
                    self._warn_once(frame, f"Ignored a transform on {messages.topic}: {error}")

            self._news.set()

    def _warn_once(self, frame: str, text: str) -> None:
        name = frame[:MAX_FRAME_ID]
        if name not in self._invalid_frames and len(self._invalid_frames) < MAX_FRAMES:
            self._invalid_frames.add(name)
            self._log.warning("%s", text)
