"""Transforms as messages have them."""

from __future__ import annotations

from hypothesis import given
from hypothesis import strategies as st

from fibws.msg.geometry_msgs import TransformStamped
from fibws.tf.history import Sample
from fibws.tf.messages import read, write

from .oracle import transforms


@given(st.builds(Sample, st.integers(0, 2**32 * 10**9 - 1), st.text(), transforms), st.text())
def test_message_is_read_as_it_was_written(sample: Sample, frame: str) -> None:
    assert read(write(frame, sample)) == (frame, sample)


def test_parent_is_in_the_header() -> None:
    message = TransformStamped(child_frame_id="base")
    message.header.frame_id = "map"
    message.header.stamp.secs, message.header.stamp.nsecs = 3, 4
    message.transform.translation.y = 5.0
    message.transform.rotation.w = 1.0
    frame, sample = read(message)
    assert (frame, sample.parent, sample.stamp) == ("base", "map", 3_000_000_004)
    assert sample.transform.translation == (0.0, 5.0, 0.0)
    assert sample.transform.rotation == (0.0, 0.0, 0.0, 1.0)
