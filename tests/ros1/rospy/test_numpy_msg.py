"""Arrays of numbers are numpy's where a script asks for that, and may be so anywhere."""

from __future__ import annotations

from io import BytesIO
from typing import Any

import numpy
import pytest
from genpy.classes import message_class
from rospy.numpy_msg import numpy_msg

import fibws
from fibws.interfaces import Validators
from fibws.msg import default_interfaces

VALIDATORS = Validators(default_interfaces(), now=int)


def sent(message: Any) -> Any:
    """The message as a subscriber gets it."""
    return type(message).from_dict(VALIDATORS.of(message._type).validate(message.to_dict()))


def packed(message: Any) -> bytes:
    buffer = BytesIO()
    message.serialize(buffer)
    return buffer.getvalue()


def test_received_arrays_are_numpy_arrays() -> None:
    floats = numpy_msg(message_class("rospy_tutorials/Floats"))
    given = numpy.array([1.0, 2.1, numpy.nan], dtype=numpy.float32)
    heard = sent(floats(given))
    assert heard.data.dtype == numpy.float32
    numpy.testing.assert_array_equal(heard.data, given)
    numpy.testing.assert_array_equal(floats().deserialize(packed(heard)).data, given)


def test_arrays_in_nested_messages_are_numpy_arrays() -> None:
    odometry = numpy_msg(message_class("nav_msgs/Odometry"))
    heard = sent(odometry())
    assert isinstance(heard.pose.covariance, numpy.ndarray)
    assert heard.pose.covariance.dtype == numpy.float64
    assert heard.header.frame_id == ""


def test_byte_arrays_are_bytes() -> None:
    image = numpy_msg(message_class("sensor_msgs/Image"))
    assert sent(image(data=b"abc")).data == b"abc"


def test_class_is_a_subclass_of_its_type() -> None:
    floats = message_class("rospy_tutorials/Floats")
    made = numpy_msg(floats)
    assert numpy_msg(floats) is made
    assert issubclass(made, floats)
    assert made.__name__ == "Numpy_rospy_tutorials__Floats"
    assert (made._type, made._md5sum, made.__slots__) == (
        floats._type,
        floats._md5sum,
        floats.__slots__,
    )


@pytest.mark.parametrize(
    ("type_", "field", "value", "heard"),
    [
        ("std_msgs/Int32", "data", numpy.int64(5), 5),
        ("std_msgs/Int32", "data", numpy.uint8(5), 5),
        ("std_msgs/Float64", "data", numpy.float32(1.5), 1.5),
        ("std_msgs/Float64", "data", numpy.float64(1.5), 1.5),
        ("std_msgs/Float64", "data", numpy.int32(2), 2.0),
        ("std_msgs/Bool", "data", numpy.bool_(True), True),
        ("std_msgs/String", "data", numpy.str_("text"), "text"),
        ("std_msgs/Int32MultiArray", "data", numpy.array([1, 2]), (1, 2)),
        ("std_msgs/Int32MultiArray", "data", [numpy.int8(1), numpy.int64(2)], (1, 2)),
        ("std_msgs/Float64MultiArray", "data", numpy.array([1.5, 2]), (1.5, 2.0)),
        ("std_msgs/Float64MultiArray", "data", numpy.array([1, 2]), (1.0, 2.0)),
        ("std_msgs/Float64MultiArray", "data", [numpy.float32(1.5)], (1.5,)),
        ("std_msgs/UInt8MultiArray", "data", numpy.array([1, 2], dtype="u1"), b"\1\2"),
        ("sensor_msgs/JointState", "name", numpy.array(["a", "b"]), ["a", "b"]),
        ("nav_msgs/OccupancyGrid", "data", numpy.array([-1, 100], dtype="i1"), (-1, 100)),
    ],
)
def test_numpy_values_can_be_sent(type_: str, field: str, value: Any, heard: Any) -> None:
    message = sent(message_class(type_)(**{field: value}))
    assert getattr(message, field) == heard
    assert type(getattr(message, field)) is type(heard)


@pytest.mark.parametrize(
    ("type_", "value"),
    [
        ("std_msgs/Int32", numpy.float64(1.0)),
        ("std_msgs/Int32", numpy.int64(2**31)),
        ("std_msgs/Int32MultiArray", numpy.array([1.5])),
        ("std_msgs/Float64MultiArray", numpy.array(["a"])),
        ("std_msgs/Float64MultiArray", numpy.array([[1.0], [2.0]])),
        ("std_msgs/UInt8MultiArray", numpy.array([1, 2], dtype="i8")),
    ],
)
def test_numpy_values_that_do_not_fit_are_refused(type_: str, value: Any) -> None:
    with pytest.raises(fibws.InvalidMessage):
        sent(message_class(type_)(data=value))
