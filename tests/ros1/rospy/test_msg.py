"""`AnyMsg`, and messages from arguments."""

from __future__ import annotations

from io import BytesIO
from typing import Any

import pytest
from genpy.dynamic import generate_dynamic
from genpy.message import DeserializationError, get_message_class
from rospy.exceptions import ROSException
from rospy.msg import (
    AnyMsg,
    args_kwds_to_message,
    deserialize_messages,
    serialize_message,
    serialized,
)
from std_msgs.msg import Empty, Int32, String

Point: Any = get_message_class("geometry_msgs/Point")
PointStamped: Any = get_message_class("geometry_msgs/PointStamped")
Pose: Any = get_message_class("geometry_msgs/Pose")
ROS2_POINT_STAMPED = f"""std_msgs/Header header
float64 x
{"=" * 80}
MSG: std_msgs/Header
time stamp
string frame_id
"""
Quaternion: Any = get_message_class("geometry_msgs/Quaternion")


def test_any_msg_keeps_the_bytes() -> None:
    message = AnyMsg().deserialize(b"abc")
    assert message._buff == b"abc"
    buffer = BytesIO()
    message.serialize(buffer)
    assert buffer.getvalue() == b"abc"
    assert (AnyMsg._type, AnyMsg._md5sum, AnyMsg.__slots__) == ("*", "*", ["_buff"])


def test_any_msg_has_no_fields() -> None:
    with pytest.raises(ROSException, match="AnyMsg does not accept arguments"):
        AnyMsg(b"abc")


def test_any_msg_without_bytes_cannot_be_serialized() -> None:
    with pytest.raises(ROSException, match="AnyMsg is not initialized"):
        AnyMsg().serialize(BytesIO())


@pytest.mark.parametrize(
    ("args", "kwds"),
    [(("hello",), {}), ((), {"data": "hello"}), ((String("hello"),), {})],
)
def test_message_is_created_from_fields_or_returned(
    args: tuple[Any, ...], kwds: dict[str, Any]
) -> None:
    assert args_kwds_to_message(String, args, kwds) == String("hello")


def test_given_message_is_returned() -> None:
    for message in (String("hello"), AnyMsg()):
        assert args_kwds_to_message(String, (message,), {}) is message


def test_omitted_fields_have_defaults() -> None:
    assert args_kwds_to_message(String, (), {}) == String("")


def test_message_can_be_the_value_of_a_field() -> None:
    point = Point(1, 2, 3)
    assert args_kwds_to_message(Pose, (point, Quaternion()), {}).position is point


@pytest.mark.parametrize(
    ("data_class", "args", "kwds", "fault"),
    [
        (
            String,
            ("a",),
            {"data": "b"},
            "publish() can be called with arguments or keywords, but not both.",
        ),
        (String, (Int32(5),), {}, "expected [string] but got [std_msgs/Int32]"),
        (Pose, (Int32(5),), {}, "expected [geometry_msgs/Point] but got [std_msgs/Int32]"),
        (Empty, (Int32(5),), {}, "expected [] but got [std_msgs/Int32]"),
    ],
)
def test_invalid_arguments_are_refused(
    data_class: Any, args: tuple[Any, ...], kwds: dict[str, Any], fault: str
) -> None:
    with pytest.raises(TypeError) as raised:
        args_kwds_to_message(data_class, args, kwds)
    assert str(raised.value) == fault


def test_message_is_serialized() -> None:
    assert serialized(String("hi")) == b"\x02\0\0\0hi"


def test_messages_follow_their_lengths() -> None:
    buffer = BytesIO()
    for number in range(4):
        message = PointStamped()
        message.header.frame_id = None
        serialize_message(buffer, number, message)
    buffer.write(b"\x07\0\0\0ab")
    found: list[Any] = []
    deserialize_messages(buffer, found, PointStamped, max_msgs=2)
    assert [(each.header.seq, each.header.frame_id) for each in found] == [(0, "0"), (1, "0")]
    deserialize_messages(buffer, found, PointStamped, queue_size=1)
    assert [each.header.seq for each in found] == [3]
    assert buffer.getvalue() == b"\x07\0\0\0ab"
    buffer.write(b"cdefg")
    with pytest.raises(DeserializationError):
        deserialize_messages(buffer, found, PointStamped)
    deserialize_messages(BytesIO(), found, PointStamped)
    assert len(found) == 1


def test_header_without_seq_is_not_numbered() -> None:
    stamped = generate_dynamic("own/Stamped", ROS2_POINT_STAMPED)["own/Stamped"]
    assert stamped._has_header
    message = stamped()
    message.header.frame_id = None
    buffer = BytesIO()
    serialize_message(buffer, 7, message)
    assert buffer.getvalue() == b"\x15\0\0\0" + bytes(8) + b"\x01\0\0\x000" + bytes(8)
