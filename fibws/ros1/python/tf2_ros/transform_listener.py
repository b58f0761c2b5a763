"""Filling a buffer from /tf and /tf_static."""

from __future__ import annotations

import threading
from functools import cache
from typing import Any

import rospy
from genpy.classes import message_class
from genpy.message import Message
from rospy.impl.tcpros_base import DEFAULT_BUFF_SIZE

from fibws.interfaces.catalogue import Definitions
from fibws.interfaces.message import ObjectStyle
from fibws.interfaces.serialization import ClassCodec
from fibws.tf.serialized import read_serialized
from fibws.tf.transform import Link
from tf2_ros.buffer import Buffer

TFMessage = message_class("tf2_msgs/TFMessage")


class _Received(Message):
    """A TFMessage whose transforms are decoded to messages only if they are used.

    Attributes:
        samples: its frames, stamps and transforms; None if it did not arrive as ROS 1's bytes.
    """

    samples: list[tuple[str, int, Link]] | None = None
    _data: Any = None
    _decoded: list[Any] | None = None

    @property
    def transforms(self) -> list[Any]:
        """The TransformStamped of all frames."""
        if self._decoded is None:
            self._decoded = TFMessage().deserialize(bytes(self._data)).transforms
        return self._decoded

    @transforms.setter
    def transforms(self, value: list[Any]) -> None:
        self.samples, self._decoded = None, value

    @classmethod
    def _make_codec(cls, interfaces: Definitions, style: ObjectStyle) -> ClassCodec[Any]:
        if not interfaces.has_sequenced_header(
            interfaces.message("geometry_msgs/TransformStamped")
        ):
            return super()._make_codec(interfaces, style)
        return _SamplesCodec(cls, interfaces, style)


class _SamplesCodec(ClassCodec[Any]):
    def deserialize(self, data: Any) -> Any:
        kind: Any = self.message_class
        message = kind.__new__(kind)
        message.samples = read_serialized(data)
        message._data = data
        return message


_ReceivedTFMessage: type[Message] = type(
    "TFMessage", (_Received, TFMessage), {"__module__": TFMessage.__module__}
)


class TransformListener:
    """Subscribes to ``/tf`` and ``/tf_static``, and fills a buffer.

    Args:
        buffer: the buffer; its ``set_transform``, ``set_transform_static`` and ``clear`` are used.
        queue_size: most messages that wait; None for the default of rospy.
        buff_size: ignored.
        tcp_nodelay: ignored.
    """

    def __init__(
        self,
        buffer: Any,
        queue_size: int | None = None,
        buff_size: int = DEFAULT_BUFF_SIZE,
        tcp_nodelay: bool = False,
    ) -> None:
        self.buffer = buffer
        self.last_update = rospy.Time.now()
        self.last_update_lock = threading.Lock()
        self.tf_sub, self.tf_static_sub = (
            rospy.Subscriber(
                topic,
                _ReceivedTFMessage,
                callback,
                queue_size=queue_size,
                buff_size=buff_size,
                tcp_nodelay=tcp_nodelay,
            )
            for topic, callback in (("/tf", self.callback), ("/tf_static", self.static_callback))
        )

    def __del__(self) -> None:
        if hasattr(self, "tf_static_sub"):  # Creating them may have failed.
            self.unregister()

    def unregister(self) -> None:
        """Stop filling the buffer."""
        self.tf_sub.unregister()
        self.tf_static_sub.unregister()

    def check_for_reset(self) -> None:
        """Clear the buffer if time went back since the last message."""
        with self.last_update_lock:
            now = rospy.Time.now()
            if now < self.last_update:
                back = (self.last_update - now).to_sec()
                rospy.logwarn(f"Detected jump back in time of {back:f}s. Clearing TF buffer.")
                self.buffer.clear()
            self.last_update = now

    def callback(self, data: Any) -> None:
        """Add the transforms of a message on /tf."""
        self._add(data, static=False)

    def static_callback(self, data: Any) -> None:
        """Add the transforms of a message on /tf_static."""
        self._add(data, static=True)

    def _add(self, data: Any, *, static: bool) -> None:
        self.check_for_reset()
        authority = data._connection_header.get("callerid", "default_authority")
        buffer = self.buffer
        samples = getattr(data, "samples", None)
        kind: Any = type(buffer)
        if samples is not None and _takes_samples(kind):
            buffer.set_all(samples, authority, static=static)
            return
        set_transform = buffer.set_transform_static if static else buffer.set_transform
        for transform in data.transforms:
            set_transform(transform, authority)


@cache
def _takes_samples(kind: Any) -> bool:
    """Return whether a class is a `Buffer` that treats transforms as that does."""
    return issubclass(kind, Buffer) and all(
        getattr(kind, name) is getattr(Buffer, name)
        for name in ("set_transform", "set_transform_static")
    )
