"""Sending the transforms of moving frames."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import tf2_ros
from genpy.classes import message_class

TransformStamped = message_class("geometry_msgs/TransformStamped")


class TransformBroadcaster:
    """Publishes on ``/tf``.

    Args:
        queue_size: ignored.
    """

    def __init__(self, queue_size: int = 100) -> None:
        self.tf2_broadcaster = tf2_ros.TransformBroadcaster()

    @property
    def pub_tf(self) -> Any:
        """The publisher."""
        return self.tf2_broadcaster.pub_tf

    def sendTransform(
        self,
        translation: Sequence[float],
        rotation: Sequence[float],
        time: Any,
        child: str,
        parent: str,
    ) -> None:
        """Publish the transform of a frame in its parent.

        Args:
            translation: x, y and z in metres.
            rotation: the quaternion x, y, z, w.
            time: the Time for which it holds.
            child: the frame.
            parent: its parent.
        """
        message = TransformStamped()
        message.header.frame_id = parent
        message.header.stamp = time
        message.child_frame_id = child
        target, turn = message.transform.translation, message.transform.rotation
        target.x, target.y, target.z = translation[0], translation[1], translation[2]
        turn.x, turn.y, turn.z, turn.w = rotation[0], rotation[1], rotation[2], rotation[3]
        self.sendTransformMessage(message)

    def sendTransformMessage(self, transform: Any) -> None:
        """Publish a geometry_msgs/TransformStamped."""
        self.tf2_broadcaster.sendTransform([transform])
