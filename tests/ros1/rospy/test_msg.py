"""Messages of any type are taken as they are."""

from __future__ import annotations

from io import BytesIO
from typing import Any

import pytest
from genpy.message import get_message_class
from rospy.exceptions import ROSException
from rospy.msg import AnyMsg, args_kwds_to_message, serialized
from std_msgs.msg import Empty, Int32, String

Point: Any = get_message_class("geometry_msgs/Point")
Pose: Any = get_message_class("geometry_msgs/Pose")
Quaternion: Any = get_message_class("geometry_msgs/Quaternion")


def test_a_message_of_any_type_holds_the_bytes() -> None:
    message = AnyMsg().deserialize(b"abc")
    assert message._buff == b"abc"
    buffer = BytesIO()
    message.serialize(buffer)
    assert buffer.getvalue() == b"abc"
    assert (AnyMsg._type, AnyMsg._md5sum, AnyMsg.__slots__) == ("*", "*", ["_buff"])


def test_it_takes_no_fields() -> None:
    with pytest.raises(ROSException, match="AnyMsg does not accept arguments"):
        AnyMsg(b"abc")


def test_it_cannot_be_sent_before_it_has_bytes() -> None:
    with pytest.raises(ROSException, match="AnyMsg is not initialized"):
        AnyMsg().serialize(BytesIO())


@pytest.mark.parametrize(
    ("args", "kwds"),
    [(("hello",), {}), ((), {"data": "hello"}), ((String("hello"),), {})],
)
def test_a_message_is_made(args: tuple[Any, ...], kwds: dict[str, Any]) -> None:
    assert args_kwds_to_message(String, args, kwds) == String("hello")


def test_what_is_whole_is_passed_on() -> None:
    for message in (String("hello"), AnyMsg()):
        assert args_kwds_to_message(String, (message,), {}) is message


def test_no_fields_have_their_defaults() -> None:
    assert args_kwds_to_message(String, (), {}) == String("")


def test_a_message_may_be_a_field() -> None:
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
def test_what_is_none_is_refused(
    data_class: Any, args: tuple[Any, ...], kwds: dict[str, Any], fault: str
) -> None:
    with pytest.raises(TypeError) as raised:
        args_kwds_to_message(data_class, args, kwds)
    assert str(raised.value) == fault


def test_a_message_has_bytes() -> None:
    assert serialized(String("hi")) == b"\x02\0\0\0hi"
