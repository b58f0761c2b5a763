"""Messages are made, compared, copied and packed as genpy's are."""

from __future__ import annotations

import array
import math
import pickle
from collections import deque
from io import BytesIO
from typing import Any

import numpy
import pytest
from genpy import DeserializationError, Duration, Message, SerializationError, Time
from genpy.classes import message_class

import fibws
from fibws.interfaces import Validators
from fibws.msg import default_interfaces

from ..conftest import Define
from .conftest import Agree

TYPES = [
    *("std_msgs/Header", "std_msgs/Empty", "std_msgs/String", "std_msgs/Bool", "std_msgs/Int32"),
    *("std_msgs/UInt8MultiArray", "std_msgs/Float32", "std_msgs/Time", "std_msgs/Float64"),
    *("geometry_msgs/PoseStamped", "geometry_msgs/Point", "geometry_msgs/Vector3"),
    *("sensor_msgs/Image", "sensor_msgs/LaserScan", "nav_msgs/Odometry", "rosgraph_msgs/Log"),
    *("std_msgs/UInt8", "geometry_msgs/Point32", "geometry_msgs/Polygon", "geometry_msgs/Twist"),
    *("std_msgs/Duration", "std_msgs/Int64", "std_msgs/UInt64"),
]
VALIDATORS = Validators(default_interfaces(), now=int)


def make(type_: str, *args: Any, **fields: Any) -> Any:
    return message_class(type_)(*args, **fields)


def sent(message: Message) -> Any:
    """The message as a subscriber gets it."""
    validators = Validators(type(message)._find_interfaces(), now=int)
    return type(message).from_dict(validators.of(message._type).validate(message.to_dict()))


@pytest.mark.parametrize(
    "expression",
    [
        "M('std_msgs/Int32', 5).data",
        "M('std_msgs/Int32', data=5).data",
        "M('std_msgs/Int32', None).data",
        "M('std_msgs/Int32', data=None).data",
        "M('std_msgs/Int32', 1, 2)",
        "M('std_msgs/Int32', 1, data=2)",
        "M('std_msgs/Int32', value=2)",
        "M('std_msgs/Int32', value=2, other=3)",
        "M('std_msgs/Empty', 1)",
        "M('std_msgs/Empty')",
        "M('geometry_msgs/Point', 1, 2)",
        "M('geometry_msgs/Point', 1, 2, 3)",
        "M('geometry_msgs/Point', 1, None, 3)",
        "M('geometry_msgs/Point', x=1)",
        "M('geometry_msgs/PoseStamped', None, None)",
        "M('std_msgs/Header', 1, Time(2), 'map') == M('std_msgs/Header', 1, Time(2), 'map')",
        "M('std_msgs/Header', 1, Time(2), 'map') != M('std_msgs/Header', 1, Time(2), 'odom')",
        "M('geometry_msgs/Point') == M('geometry_msgs/Vector3')",
        "M('sensor_msgs/LaserScan', ranges=[1.0]) == M('sensor_msgs/LaserScan', ranges=(1.0,))",
        "M('std_msgs/Int32') == 0",
        "M('std_msgs/Empty') == M('std_msgs/Empty')",
        "{M('std_msgs/Int32')}",
        "bool(M('std_msgs/Empty'))",
        "M('std_msgs/Header')._get_types()",
        "M('std_msgs/Header')._connection_header",
        "set(M('std_msgs/Header'), _connection_header={'a': 'b'})._connection_header",
        "copied(M('std_msgs/Header', 1, Time(2), 'map'))",
        "M('std_msgs/Header').__getstate__()",
        "M('rosgraph_msgs/Log').INFO",
        "C('std_msgs/String').__name__",
        "M('geometry_msgs/Twist').linear is M('geometry_msgs/Twist').linear",
    ],
)
def test_messages_behave_like_those_of_genpy(agree: Agree, expression: str) -> None:
    agree(expression, *TYPES)


@pytest.mark.parametrize("name", ["dta", "data_", "_data"])
def test_unknown_field_cannot_be_set(name: str) -> None:
    with pytest.raises(AttributeError, match=f"'Int32' object has no attribute '{name}'"):
        setattr(make("std_msgs/Int32"), name, 1)


@pytest.mark.parametrize(
    "expression",
    [
        "parts(M('std_msgs/String').deserialize(b'\\3\\0\\0\\0a\\xffb'))",
        "parts(M('std_msgs/Time').deserialize(b'\\1\\0\\0\\0' + b'\\xff' * 4))",
        "parts(M('std_msgs/Duration').deserialize(b'\\xff' * 8))",
        "parts(M('std_msgs/Bool').deserialize(b'\\2'))",
        "packed(M('std_msgs/Float64', -0.0))",
        "packed(M('std_msgs/Float64', 5e-324))",
        "packed(M('std_msgs/Float32', 0.1))",
        "packed(M('std_msgs/Float32', 1e-45))",
        "packed(M('std_msgs/Int64', -2**63))",
        "packed(M('std_msgs/UInt64', 2**64 - 1))",
        "packed(M('std_msgs/Duration', Duration(-1, 5)))",
        "packed(M('std_msgs/UInt8MultiArray', data=bytes(range(256))))",
        "packed(M('std_msgs/Int32', True))",
        "packed(M('std_msgs/Int32', 'five'))",
        "packed(M('std_msgs/Int32', 1.0))",
        "packed(M('std_msgs/Int32', 2**31))",
        "packed(M('std_msgs/UInt8', 256))",
        "packed(M('std_msgs/UInt8', -1))",
        "packed(M('std_msgs/Bool', 1))",
        "packed(M('std_msgs/Bool', 256))",
        "packed(M('std_msgs/Bool', -1))",
        "packed(M('std_msgs/Bool', 'yes'))",
        "packed(M('std_msgs/Float64', 1))",
        "packed(M('std_msgs/Float64', True))",
        "packed(M('std_msgs/Float64', 'x'))",
        "packed(set(M('std_msgs/Float64'), data=None))",
        "packed(M('std_msgs/String', 5))",
        "packed(M('std_msgs/String', 'grüße'))",
        "packed(set(M('std_msgs/String'), data=None))",
        "packed(M('geometry_msgs/Point', 1, 2, [3]))",
        "packed(M('geometry_msgs/Twist', linear=M('geometry_msgs/Point', 1, 2, 3)))",
        "packed(M('sensor_msgs/LaserScan', ranges=[1, 2.5, True]))",
        "packed(M('sensor_msgs/LaserScan', ranges=(1, 2)))",
        "packed(M('sensor_msgs/LaserScan', ranges=['a']))",
        "packed(M('sensor_msgs/LaserScan', ranges=[None]))",
        "packed(M('sensor_msgs/LaserScan', ranges=5))",
        "packed(M('sensor_msgs/LaserScan', ranges='abc'))",
        "packed(M('sensor_msgs/LaserScan', ranges=b'abc'))",
        "packed(M('sensor_msgs/LaserScan', ranges={1.5: 2}.keys()))",
        "packed(M('sensor_msgs/LaserScan', ranges=map(float, range(2))))",
        "packed(M('rosgraph_msgs/Log', topics={'/a': 1, '/b': 2}.keys()))",
        "packed(M('rosgraph_msgs/Log', topics={'/a': 1, '/b': 2}))",
        "packed(M('rosgraph_msgs/Log', topics={'/a'}))",
        "packed(M('rosgraph_msgs/Log', topics=map(str, range(2))))",
        "packed(M('sensor_msgs/Image', data=[1, 2, 255]))",
        "packed(M('sensor_msgs/Image', data=(1, 2, 255)))",
        "packed(M('sensor_msgs/Image', data=bytearray(b'abc')))",
        "packed(M('sensor_msgs/Image', data=[1, 2, 256]))",
        "packed(M('sensor_msgs/Image', data=[1, 'a']))",
        "packed(M('geometry_msgs/Polygon', points=(M('geometry_msgs/Point32', 1, 2, 3),)))",
        "packed(M('geometry_msgs/Polygon', points=[M('geometry_msgs/Point', 1, 2, 3)]))",
        "packed(M('nav_msgs/Odometry', child_frame_id='base'))",
        "packed(set(M('std_msgs/Int32'), data='a'))",
        "M('std_msgs/Int32', 'a')._check_types()",
        "M('std_msgs/Int32', 1)._check_types()",
        "M('std_msgs/Int32', 1)._check_types(ValueError('of this'))",
    ],
)
def test_values_are_packed_or_refused_as_in_genpy(agree: Agree, expression: str) -> None:
    agree(expression, *TYPES)


@pytest.mark.parametrize(
    "message",
    [
        make("geometry_msgs/Twist", linear=5),
        make("geometry_msgs/Twist", linear={"x": 1.0}),
        make("std_msgs/Header", stamp=1.5),
        make("std_msgs/Header", stamp="now"),
        make("std_msgs/Header", stamp={"secs": 1, "nsecs": 2}),
        make("sensor_msgs/Image", data="AAAA"),
        make("rosgraph_msgs/Log", topics="abc"),
        make("geometry_msgs/Polygon", points=5),
    ],
)
def test_values_that_json_would_misread_are_refused(message: Message) -> None:
    with pytest.raises(fibws.InvalidMessage):
        sent(message)


BOOLS = [
    *("[True, False, True]", "(True, False, True)", "[1, 0, 1]", "b'\\1\\0\\1'", "range(2)"),
    *("bytearray(b'\\1\\0\\1')", "memoryview(b'\\1\\0\\1')", "{1: 2}.keys()", "[256, 0, 0]"),
    *("['yes', 'no', 'no']", "'yes'", "None", "True", "[None, True, False]"),
]


@pytest.mark.parametrize("array_type", ["bool[]", "bool[3]"])
def test_arrays_of_bools_are_packed_as_in_genpy(
    define: Define, agree: Agree, array_type: str
) -> None:
    type_ = f"flags/Flags{3 if '3' in array_type else ''}"
    define(type_, f"{array_type} flags")
    agree(f"M({type_!r}).flags", type_)
    assert agree(f"packed(M({type_!r}, flags={BOOLS[0]}))").endswith("x01\\x00\\x01'")
    for value in BOOLS:
        agree(f"packed(set(M({type_!r}), flags={value}))")


@pytest.mark.parametrize(
    "value",
    [
        *([1, 0, 1], b"\1\0\1", array.array("i", [1, 0, 1]), numpy.array([True, False, True])),
        *(list(numpy.array([True, False, True])), numpy.array([1, 0, 1]), deque([1, 0, 1])),
    ],
    ids=repr,
)
@pytest.mark.parametrize("array_type", ["bool[]", "bool[3]"])
def test_arrays_of_bools_are_sent(define: Define, array_type: str, value: Any) -> None:
    define("flags/Flags", f"{array_type} flags")
    buffer = BytesIO()
    message = make("flags/Flags", flags=value)
    message.serialize(buffer)
    for received in (sent(message), make("flags/Flags").deserialize(buffer.getvalue())):
        assert received.flags == [True, False, True]
        assert sent(received) == received


@pytest.mark.parametrize("value", [[1.0, 0.0], numpy.array([1.0, 0.0]), [True]], ids=repr)
def test_other_values_of_bools_are_refused(define: Define, value: Any) -> None:
    define("flags/Flags", "bool[2] flags")
    with pytest.raises(SerializationError, match="flags"):
        make("flags/Flags", flags=value).serialize(BytesIO())


def test_error_names_the_field_of_a_wrong_class() -> None:
    with pytest.raises(Exception, match=r"field header.stamp must be of type Time"):
        message = make("geometry_msgs/PoseStamped")
        message.header.stamp = 1.5
        message.serialize(BytesIO())


@pytest.mark.parametrize(
    ("type_", "given", "heard"),
    [
        ("sensor_msgs/LaserScan", {"ranges": [1, 2.5]}, {"ranges": (1.0, 2.5)}),
        ("sensor_msgs/LaserScan", {"ranges": array.array("f", [1, 2])}, {"ranges": (1.0, 2.0)}),
        ("sensor_msgs/LaserScan", {"ranges": range(2)}, {"ranges": (0.0, 1.0)}),
        ("sensor_msgs/Image", {"data": [1, 2]}, {"data": b"\1\2"}),
        ("sensor_msgs/Image", {"data": array.array("B", [1, 2])}, {"data": b"\1\2"}),
        ("sensor_msgs/Image", {"data": memoryview(b"ab")}, {"data": b"ab"}),
        ("std_msgs/Time", {"data": Time(5, 6)}, {"data": Time(5, 6)}),
        ("std_msgs/Duration", {"data": Duration(-5, 6)}, {"data": Duration(-5, 6)}),
        ("rosgraph_msgs/Log", {"topics": ("/a", "/b")}, {"topics": ["/a", "/b"]}),
    ],
)
def test_received_messages_are_like_those_unpacked_by_genpy(
    type_: str, given: dict[str, Any], heard: dict[str, Any]
) -> None:
    message = sent(make(type_, **given))
    for name, value in heard.items():
        assert getattr(message, name) == value
        assert type(getattr(message, name)) is type(value)


def test_null_is_received_as_nan() -> None:
    type_ = message_class("sensor_msgs/LaserScan")
    given = {"ranges": [1, None], "scan_time": None}
    message: Any = type_.from_dict(VALIDATORS.of(type_._type).validate(given))
    assert message.ranges[0] == 1
    assert math.isnan(message.ranges[1])
    assert math.isnan(message.scan_time)


def test_nanoseconds_of_received_times_are_carried_over() -> None:
    header = message_class("std_msgs/Header")
    message = header.from_dict({"seq": 0, "stamp": {"secs": 1, "nsecs": 2 * 10**9}, "frame_id": ""})
    assert message.stamp == Time(3, 0)


def test_messages_can_be_pickled() -> None:
    message = make("geometry_msgs/PoseStamped")
    message.header.frame_id, message.header.stamp = "map", Time(1, 2)
    again = pickle.loads(pickle.dumps(message))
    assert again == message
    assert type(again) is type(message)


def test_invalid_bytes_are_refused() -> None:
    with pytest.raises(DeserializationError, match=r"std_msgs/Int32: data: \D*4 bytes"):
        make("std_msgs/Int32").deserialize(b"\0\0\0")


def test_deserialize_changes_the_message_itself() -> None:
    message = make("std_msgs/Int32")
    assert message.deserialize(b"\5\0\0\0") is message
    assert message.data == 5
