"""Transforms as messages."""

from __future__ import annotations

from fibws.interfaces import Time
from fibws.msg.geometry_msgs import Quaternion, TransformStamped, Vector3
from fibws.msg.geometry_msgs import Transform as TransformMessage
from fibws.msg.std_msgs import Header
from fibws.tf.history import Sample
from fibws.tf.transform import Transform


def read(message: TransformStamped) -> tuple[str, Sample]:
    """Return a message's frame and sample."""
    translation, rotation = message.transform.translation, message.transform.rotation
    transform = Transform(
        (translation.x, translation.y, translation.z),
        (rotation.x, rotation.y, rotation.z, rotation.w),
    )
    stamp = message.header.stamp.to_nanoseconds()
    return message.child_frame_id, Sample(stamp, message.header.frame_id, transform)


def write(frame: str, sample: Sample) -> TransformStamped:
    """Return the message of a frame and its sample."""
    return TransformStamped(
        header=Header(stamp=Time.from_nanoseconds(sample.stamp), frame_id=sample.parent),
        child_frame_id=frame,
        transform=TransformMessage(
            translation=Vector3(*sample.transform.translation),
            rotation=Quaternion(*sample.transform.rotation),
        ),
    )
