"""Transforms as messages have them."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fibws.errors import InvalidMessage
from fibws.interfaces.serialization import class_codec
from fibws.msg.geometry_msgs import TransformStamped
from fibws.msg.tf2_msgs import TFMessage
from fibws.tf import serialized
from fibws.tf.history import Sample
from fibws.tf.messages import read, write
from fibws.tf.serialized import read_serialized
from fibws.tf.transform import Transform, link_of

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


SERIALIZER = class_codec(TFMessage)
names = st.text(max_size=20)
samples = st.builds(Sample, st.integers(0, 2**32 * 10**9 - 1), names, transforms)


@given(st.lists(st.tuples(names, samples), max_size=5))
def test_serialized_message_is_read_as_it_was_written(frames: list[tuple[str, Sample]]) -> None:
    data = SERIALIZER.serialize(TFMessage([write(frame, sample) for frame, sample in frames]))
    assert read_serialized(memoryview(data)) == [
        (frame, sample.stamp, link_of(sample.parent, sample.transform)) for frame, sample in frames
    ]


@pytest.mark.parametrize("size", range(0, 160, 3))
def test_truncated_bytes_are_an_error(size: int) -> None:
    message = TFMessage([write("camera", Sample(5, "base_link", Transform()))] * 2)
    data = SERIALIZER.serialize(message)
    with pytest.raises(InvalidMessage, match="invalid bytes for tf2_msgs/TFMessage"):
        read_serialized(data[:size])
    with pytest.raises(InvalidMessage, match="1 bytes too many"):
        read_serialized(data + b"x")


def test_wrong_sizes_are_an_error() -> None:
    for data in (b"\xff\xff\xff\xff", b"\1\0\0\0" + b"\xff" * 200):
        with pytest.raises(InvalidMessage, match="invalid bytes"):
            read_serialized(data)


def test_names_that_are_not_utf8_are_replaced() -> None:
    message = TFMessage([write("camera", Sample(5, "base", Transform()))])
    data = SERIALIZER.serialize(message).replace(b"camera", b"c\xffmera")
    assert read_serialized(data)[0][0] == "c\N{REPLACEMENT CHARACTER}mera"


def test_number_of_kept_names_is_bounded(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(serialized, "_MOST_NAMES", 3)
    for number in range(9):
        message = TFMessage([write(f"f{number}", Sample(5, "base", Transform()))])
        assert read_serialized(SERIALIZER.serialize(message))[0][0] == f"f{number}"
        assert len(serialized._names) <= 3
