"""Sending the transforms of static frames."""

from __future__ import annotations

import threading
from copy import deepcopy
from typing import Any

import rospy
from genpy.classes import message_class

from fibws.tf.buffer import MAX_FRAMES

TFMessage = message_class("tf2_msgs/TFMessage")

_sent: dict[str, Any] = {}
"""The last transform of each frame that this node sent: /tf_static is latched, and late subscribers
get one message of each node."""
_lock = threading.Lock()


class StaticTransformBroadcaster:
    """Publishes on ``/tf_static``, which is latched.

    As in C++, and unlike in ROS's Python, a message has all the transforms that the node has sent:
    a second `sendTransform` does not hide the first from late subscribers.
    """

    def __init__(self) -> None:
        self.pub_tf = rospy.Publisher("/tf_static", TFMessage, queue_size=100, latch=True)

    def sendTransform(self, transform: Any) -> None:
        """Publish a geometry_msgs/TransformStamped, or a list of them in one message.

        Raises:
            ValueError: these would be too many frames.
        """
        transforms = transform if isinstance(transform, list) else [transform]
        with _lock:
            frames = {**_sent, **{each.child_frame_id: deepcopy(each) for each in transforms}}
            if len(frames) > MAX_FRAMES:
                raise ValueError(f"too many static frames: {len(frames)} (limit {MAX_FRAMES})")
            self.pub_tf.publish(TFMessage(list(frames.values())))
            _sent.update(frames)
