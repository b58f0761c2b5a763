"""Filling a buffer from /tf and /tf_static."""

from __future__ import annotations

import threading
from typing import Any

import rospy
from genpy.classes import message_class
from rospy.impl.tcpros_base import DEFAULT_BUFF_SIZE

TFMessage = message_class("tf2_msgs/TFMessage")


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
                TFMessage,
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
        self._add(data, self.buffer.set_transform)

    def static_callback(self, data: Any) -> None:
        """Add the transforms of a message on /tf_static."""
        self._add(data, self.buffer.set_transform_static)

    def _add(self, data: Any, set_transform: Any) -> None:
        self.check_for_reset()
        authority = data._connection_header.get("callerid", "default_authority")
        for transform in data.transforms:
            set_transform(transform, authority)
