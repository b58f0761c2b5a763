"""Fills a buffer with the transforms that are published, as tf2's TransformListener does."""

from __future__ import annotations

import asyncio

import fibws
from fibws.errors import InvalidTransform
from fibws.msg.tf2_msgs import TFMessage
from fibws.tf.buffer import MAX_FRAME_ID, MAX_FRAMES, Buffer
from fibws.tf.messages import read

QUEUE_SIZE = 100
"""Messages that wait for their turn, as in tf2."""


class TransformListener:
    """Listens to ``/tf`` and ``/tf_static`` for a buffer, from the moment that it is made.

    What the buffer refuses is logged, once for each frame, so that a publisher that sends nothing
    else does not fill the log.
    """

    def __init__(self, node: fibws.Node, buffer: Buffer) -> None:
        self._moving, self._static = (
            node.subscribe(topic, TFMessage, queue_size=QUEUE_SIZE)
            for topic in ("/tf", "/tf_static")
        )
        self._buffer = buffer
        self._log = node.log
        self._refused: set[str] = set()

    async def run(self) -> None:
        """Fill the buffer until the node ends.

        Raises:
            OperationRejected: the hub refused, most likely since a topic has another type.
        """
        try:
            async with asyncio.TaskGroup() as tasks:
                tasks.create_task(self._hear(self._moving, static=False))
                tasks.create_task(self._hear(self._static, static=True))
        except ExceptionGroup as group:
            raise group.exceptions[0] from None

    async def _hear(self, messages: fibws.Subscription[TFMessage], *, static: bool) -> None:
        async for message in messages:
            for transform in message.transforms:
                frame, sample = read(transform)
                try:
                    self._buffer.insert(frame, sample, static=static)
                except InvalidTransform as error:
                    self._complain(frame, f"Ignored a transform on {messages.topic}: {error}")

    def _complain(self, frame: str, text: str) -> None:
        name = frame[:MAX_FRAME_ID]
        if name not in self._refused and len(self._refused) < MAX_FRAMES:
            self._refused.add(name)
            self._log.warning("%s", text)
