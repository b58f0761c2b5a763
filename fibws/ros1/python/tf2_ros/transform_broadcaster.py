"""Sending the transforms of moving frames."""

from __future__ import annotations

from typing import Any

import rospy
from genpy.classes import message_class

TFMessage = message_class("tf2_msgs/TFMessage")


class TransformBroadcaster:
    """Publishes on ``/tf``."""

    def __init__(self) -> None:
        self.pub_tf = rospy.Publisher("/tf", TFMessage, queue_size=100)

    def sendTransform(self, transform: Any) -> None:
        """Publish a geometry_msgs/TransformStamped, or a list of them in one message."""
        transforms = transform if isinstance(transform, list) else [transform]
        self.pub_tf.publish(TFMessage(transforms))
