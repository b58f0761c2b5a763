"""Objects of message classes have the same bytes as dicts, and come back unchanged."""

from __future__ import annotations

import array
import math
import struct
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, ClassVar

import numpy
import pytest
from genpy.classes import message_class as genpy_class
from genpy.classes import service_class as genpy_service
from hypothesis import given
from hypothesis import strategies as st
from random_inputs import examples
from rospy.exceptions import ROSException
from rospy.msg import AnyMsg
from rospy.numpy_msg import numpy_msg

from fibws.errors import InvalidMessage
from fibws.interfaces import Duration, Interfaces, Message, Time, Validators
from fibws.interfaces.serialization import ClassCodec, Serializers, class_codec
from fibws.msg import message_class
from fibws.msg.diagnostic_msgs import DiagnosticArray, DiagnosticStatus, KeyValue
from fibws.msg.geometry_msgs import (
    Point,
    Pose,
    PoseArray,
    PoseWithCovariance,
    Quaternion,
    Twist,
    Vector3,
)
from fibws.msg.nav_msgs import Odometry
from fibws.msg.rosgraph_msgs import Log
from fibws.msg.sensor_msgs import Image, LaserScan
from fibws.msg.std_msgs import (
    Bool,
    Float32,
    Float32MultiArray,
    Float64,
    Header,
    Int8MultiArray,
    Int32,
    String,
)
from fibws.msg.visualization_msgs import Marker, MarkerArray
from fibws.srv.rospy_tutorials import AddTwoInts

from .messages import comparable, messages, with_nan
from .oracle import Oracle

STANDARD = Interfaces()
SERIALIZERS = Serializers(STANDARD)
VALIDATORS = Validators(STANDARD, now=int)
ORACLE = Oracle(STANDARD)
TYPES = [name for package in STANDARD.packages() for name in STANDARD.messages(package)]
NEVER = 2**32 - 1


@pytest.fixture
def only_compiled(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let messages fail that the compiled function does not write."""

    def refuse(*_: object) -> None:
        raise AssertionError("validated")

    monkeypatch.setattr(Message, "to_dict", refuse)
    monkeypatch.setattr(genpy_class("std_msgs/Int32").__base__, "to_dict", refuse)


EXACT: list[tuple[str, dict[str, Any]]] = [
    ("std_msgs/Float64", {"data": math.nan}),
    ("std_msgs/Float64", {"data": math.inf}),
    ("std_msgs/Float64", {"data": -math.inf}),
    ("std_msgs/Float64", {"data": -0.0}),
    ("std_msgs/Float64", {"data": 5e-324}),
    ("std_msgs/Float64", {"data": 1.7976931348623157e308}),
    ("std_msgs/Float32", {"data": math.nan}),
    ("std_msgs/Float32", {"data": -math.inf}),
    ("std_msgs/Float32", {"data": -0.0}),
    ("std_msgs/Float32", {"data": 1e-45}),
    ("std_msgs/Float32", {"data": 0.1}),
    ("std_msgs/Float32", {"data": 16777217.0}),
    ("std_msgs/Float32MultiArray", {"data": [0.1, -0.0, math.inf, 1e-45, math.nan]}),
    ("std_msgs/Float32MultiArray", {"data": []}),
    ("std_msgs/Int64", {"data": -(2**63)}),
    ("std_msgs/Int64", {"data": 2**63 - 1}),
    ("std_msgs/UInt64", {"data": 2**64 - 1}),
    ("std_msgs/Int64MultiArray", {"data": [-(2**63), 2**63 - 1, 2**53 + 1]}),
    ("std_msgs/UInt64MultiArray", {"data": [0, 2**64 - 1, 2**53 + 1]}),
    ("std_msgs/Int8MultiArray", {"data": [-128, 0, 127]}),
    ("std_msgs/UInt8MultiArray", {"data": bytes(range(256))}),
    ("std_msgs/ByteMultiArray", {"data": [-128, 127]}),
    ("std_msgs/Byte", {"data": -1}),
    ("std_msgs/Char", {"data": 255}),
    ("std_msgs/Bool", {"data": True}),
    ("std_msgs/Empty", {}),
    ("std_msgs/String", {"data": ""}),
    ("std_msgs/String", {"data": "grüße 🤖\0"}),
    ("std_msgs/Time", {"data": (NEVER, 999_999_999)}),
    ("std_msgs/Time", {"data": (0, 1)}),
    ("std_msgs/Duration", {"data": (-1, 999_999_999)}),
    ("std_msgs/Duration", {"data": (-(2**31), 0)}),
    ("std_msgs/Duration", {"data": (2**31 - 1, 5)}),
    ("rosgraph_msgs/Log", {"topics": ["/a", "", "ä"], "level": 2}),
    ("geometry_msgs/PoseWithCovariance", {"covariance": [i / 3 for i in range(36)]}),
    ("sensor_msgs/CameraInfo", {"D": [0.1] * 5, "K": [-0.0] * 9}),
    ("trajectory_msgs/JointTrajectoryPoint", {"positions": [0.5], "time_from_start": (1, 2)}),
]


def values_of(type_: str, fields: dict[str, Any]) -> dict[str, Any]:
    """The message as a valid dict."""
    given = {
        name: {"secs": value[0], "nsecs": value[1]} if isinstance(value, tuple) else value
        for name, value in fields.items()
    }
    return VALIDATORS.of(type_).validate(given)


@pytest.mark.parametrize("genpy", [False, True])
@pytest.mark.parametrize(("type_", "fields"), EXACT)
@pytest.mark.usefixtures("only_compiled")
def test_values_are_exact(type_: str, fields: dict[str, Any], genpy: bool) -> None:
    serializer, values = SERIALIZERS.of(type_), values_of(type_, fields)
    data = serializer.serialize(values)
    serializer.check(data)
    assert data == ORACLE.serialize(type_, with_nan(values))
    assert repr(serializer.deserialize(data)) == repr(with_nan(values))
    codec: ClassCodec[Any] = class_codec((genpy_class if genpy else message_class)(type_))
    message = codec.message_class.from_dict(values)
    assert codec.serialize(message) == data
    again = codec.deserialize(data)
    assert repr(again) == repr(message)
    assert codec.serialize(again) == data
    assert codec.serialize_after(lambda size: b"%d:" % size, message) == b"%d:%b" % (
        len(data),
        data,
    )


@examples(2)
@given(st.sampled_from(TYPES), st.data())
def test_objects_have_the_bytes_of_dicts(type_: str, data: st.DataObject) -> None:
    values = data.draw(messages(STANDARD, type_, canonical=True))
    expected = SERIALIZERS.of(type_).serialize(values)
    for found in (message_class(type_), genpy_class(type_)):
        codec: ClassCodec[Any] = class_codec(found)
        pieces: list[Any] = []
        codec.write_function(found.from_dict(values), pieces)
        assert b"".join(pieces) == expected
        for kind in (bytes, bytearray, memoryview):
            message = codec.deserialize(kind(expected))
            assert comparable(message.to_dict()) == comparable(with_nan(values))


def test_whole_seconds_in_nsecs_are_carried_over() -> None:
    data = struct.pack("<II", 1, 2 * 10**9)
    assert class_codec(message_class("std_msgs/Time")).deserialize(data).data == Time(3, 0)  # type: ignore[attr-defined]
    data = struct.pack("<ii", -1, -1)
    for found in (message_class("std_msgs/Duration"), genpy_class("std_msgs/Duration")):
        span: Any = class_codec(found).deserialize(data)
        assert (span.data.secs, span.data.nsecs) == (-2, 999_999_999)


def test_invalid_text_is_replaced() -> None:
    data = b"\3\0\0\0a\xffb"
    assert class_codec(String).deserialize(data) == String("a\ufffdb")
    serializer = SERIALIZERS.of("std_msgs/String")
    serializer.check(data)
    with pytest.raises(UnicodeDecodeError):
        serializer.deserialize(data)
    assert serializer.deserialize(data, "replace") == {"data": "a\ufffdb"}


def test_genpy_logs_invalid_text_once(caplog: pytest.LogCaptureFixture) -> None:
    codec: ClassCodec[Any] = class_codec(genpy_class("rosgraph_msgs/TopicStatistics"))
    data = codec.serialize(codec.message_class(topic="abc")).replace(b"abc", b"a\xe4c")
    for _ in range(2):
        assert codec.deserialize(data).topic == "a\ufffdc"
    (record,) = caplog.records
    assert record.name == "rosout"
    assert "rosgraph_msgs/TopicStatistics" in record.getMessage()


ARRAYS: list[tuple[Callable[[list[float]], Any], bool]] = [
    (list, True),
    (tuple, True),
    (lambda values: array.array("f", values), True),
    (lambda values: numpy.array(values, "<f4"), True),
    (lambda values: memoryview(array.array("f", values)), True),
    (lambda values: numpy.array([values, values], "<f4").T[:, 0], True),
    (lambda values: numpy.array(values, ">f4"), False),
    (lambda values: numpy.array(values, "f8"), False),
    (lambda values: array.array("d", values), False),
    (lambda values: numpy.array(values, "i4"), False),
]


@pytest.mark.parametrize(("make", "compiled"), ARRAYS)
def test_arrays_of_numbers_may_be_of_many_types(
    make: Callable[[list[float]], Any], compiled: bool
) -> None:
    values = [1.0, -2.0, 3.0]
    expected = class_codec(Float32MultiArray).serialize(Float32MultiArray(data=values))
    for found in (Float32MultiArray, genpy_class("std_msgs/Float32MultiArray")):
        message: Any = found(data=make(values))
        assert class_codec(found).serialize(message) == expected
        if compiled:
            pieces: list[Any] = []
            class_codec(found).write_function(message, pieces)
            assert b"".join(pieces) == expected


@pytest.mark.parametrize(
    "data",
    [
        bytearray(b"\1\2\3"),
        memoryview(b"\3\2\1")[::-1],
        array.array("B", [1, 2, 3]),
        numpy.array([1, 2, 3], "u1"),
        [1, 2, 3],
    ],
)
def test_bytes_may_be_of_many_types(data: Any) -> None:
    expected = class_codec(Image).serialize(Image(data=b"\1\2\3"))
    assert class_codec(Image).serialize(Image(data=data)) == expected
    picture = genpy_class("sensor_msgs/Image")
    assert class_codec(picture).serialize(picture(data=data)) == expected


def nested(**fields: Any) -> Odometry:
    pose = Pose(**fields)
    return Odometry(pose=PoseWithCovariance(pose=pose))


REFUSED: list[tuple[Message, str]] = [
    (Int32(2**31), "data"),
    (Int32(1.0), "data"),  # type: ignore[arg-type]
    (Int32("5"), "data"),  # type: ignore[arg-type]
    (Float64("5"), "data"),  # type: ignore[arg-type]
    (Float32(1e39), "data"),
    (Bool(1), "data"),  # type: ignore[arg-type]
    (Bool("yes"), "data"),  # type: ignore[arg-type]
    (String(5), "data"),  # type: ignore[arg-type]
    (String(b"abc"), "data"),  # type: ignore[arg-type]
    (String("\ud800"), "data"),
    (Header(stamp=Duration(5)), "stamp"),  # type: ignore[arg-type]
    (Header(stamp=5), "stamp"),  # type: ignore[arg-type]
    (Header(stamp=Time(2**32)), "stamp.secs"),
    (Twist(linear=Quaternion()), "linear.w"),  # type: ignore[arg-type]
    (Twist(linear=None), "linear"),  # type: ignore[arg-type]
    (Twist(linear=Vector3(x="1")), "linear.x"),  # type: ignore[arg-type]
    (nested(position=Point(y=None)), ""),  # type: ignore[arg-type]
    (PoseWithCovariance(covariance=[0.0] * 35), "covariance"),
    (PoseWithCovariance(covariance=array.array("d", bytes(8 * 37))), "covariance"),  # type: ignore[arg-type]
    (Float32MultiArray(data=b"abcd"), "data"),  # type: ignore[arg-type]
    (Float32MultiArray(data="abcd"), "data"),  # type: ignore[arg-type]
    (Float32MultiArray(data=[1.0, "2"]), "data[1]"),  # type: ignore[list-item]
    (Int8MultiArray(data=[0, 128]), "data[1]"),
    (Log(topics="abc"), "topics"),  # type: ignore[arg-type]
    (Log(topics=["a", 5]), "topics[1]"),  # type: ignore[list-item]
    (Image(data="AQID"), "data"),  # type: ignore[arg-type]
    (Image(data=[256]), "data[0]"),  # type: ignore[arg-type]
    (Image(data=array.array("i", [1])), "data"),  # type: ignore[arg-type]
    (PoseArray(poses=[Pose(), 5]), "poses[1]"),  # type: ignore[list-item]
    (MarkerArray(markers=[Marker(points=[Point(), Point(x="a")])]), "markers[0].points[1].x"),  # type: ignore[arg-type]
]


@pytest.mark.parametrize(("message", "path"), REFUSED)
def test_error_of_an_invalid_value_names_its_field(message: Message, path: str) -> None:
    if not path:  # None stands for NaN.
        data = class_codec(type(message)).serialize(message)
        again: Any = class_codec(type(message)).deserialize(data)
        assert math.isnan(again.pose.pose.position.y)
        return
    with pytest.raises(InvalidMessage) as caught:
        class_codec(type(message)).serialize(message)
    assert path in str(caught.value).replace(",", "").split()


@dataclass(slots=True, eq=False, repr=False)
class Odd(Message):
    """odd_msgs/Odd"""

    _type: ClassVar[str] = "odd_msgs/Odd"

    from_: str = ""
    many: list[int] = field(default_factory=list)
    few: list[str] = field(default_factory=list)
    flags: list[bool] = field(default_factory=lambda: [False, False])


@pytest.fixture
def odd(tmp_path: Path) -> ClassCodec[Odd]:
    """The codec of a class with bounds."""
    folder = tmp_path / "odd_msgs" / "msg"
    folder.mkdir(parents=True)
    text = "string<=3 from\nint16[<=2] many\nstring<=4[<=2] few\nbool[2] flags\n"
    (folder / "Odd.msg").write_text(text, "utf-8")
    return class_codec(Odd, Interfaces([tmp_path]))


def test_bounds_are_checked(odd: ClassCodec[Odd]) -> None:
    message = Odd("äöü", [1, 2], ["abcd", ""], [True, False])
    assert odd.deserialize(odd.serialize(message)) == message
    for wrong, path in (
        (Odd(from_="abcd"), "from"),
        (Odd(many=[1, 2, 3]), "many"),
        (Odd(few=["", "", ""]), "few"),
        (Odd(few=["", "abcde"]), "few[1]"),
        (Odd(flags=[True]), "flags"),
        (Odd(flags=[True, 1]), "flags[1]"),  # type: ignore[list-item]
    ):
        with pytest.raises(InvalidMessage) as caught:
            odd.serialize(wrong)
        assert path in str(caught.value).replace(",", "").split()


def test_codec_is_built_once_per_class() -> None:
    assert class_codec(Int32) is class_codec(Int32)
    assert class_codec(Int32) is not class_codec(Int32, STANDARD)
    codec: ClassCodec[Any] = class_codec(genpy_class("std_msgs/Int32"))
    assert codec is not class_codec(Int32)


@pytest.mark.parametrize(
    "service", [AddTwoInts, genpy_service("rospy_tutorials/AddTwoInts")], ids=["fibws", "genpy"]
)
def test_requests_and_responses_have_codecs(service: Any) -> None:
    request = class_codec(service.Request)
    assert request.serialize(service.Request(a=1, b=-2)) == struct.pack("<qq", 1, -2)
    assert request.deserialize(struct.pack("<qq", 1, -2)).b == -2
    response = class_codec(service.Response)
    assert response.serialize(service.Response(sum=3)) == struct.pack("<q", 3)


def test_invalid_bytes_are_refused() -> None:
    with pytest.raises(InvalidMessage, match=r"header\.frame_id"):
        class_codec(LaserScan).deserialize(bytes(12) + b"\5\0\0\0abc")
    status = DiagnosticStatus(values=[KeyValue("a", "b")])
    data = class_codec(DiagnosticArray).serialize(DiagnosticArray(status=[status]))
    with pytest.raises(InvalidMessage, match=r"status\[0\]\.values\[0\]\.value: \D*1\D*0$"):
        class_codec(DiagnosticArray).deserialize(data[:-1])


def test_arrays_of_numbers_are_lists() -> None:
    data = class_codec(LaserScan).serialize(LaserScan(ranges=(1.0, 2.0)))  # type: ignore[arg-type]
    assert class_codec(LaserScan).deserialize(data).ranges == [1.0, 2.0]


def test_arrays_of_numbers_are_tuples_or_numpy_arrays_in_rospy() -> None:
    scan = genpy_class("sensor_msgs/LaserScan")
    data = class_codec(scan).serialize(scan(ranges=[1.0, 2.0]))
    message: Any = class_codec(scan).deserialize(data)
    assert message.ranges == (1.0, 2.0)
    assert message.intensities == ()
    message = class_codec(numpy_msg(scan)).deserialize(data)
    assert type(message) is numpy_msg(scan)
    assert message.ranges.dtype == numpy.float32
    assert message.ranges.tolist() == [1.0, 2.0]
    assert message.intensities.tolist() == []
    assert class_codec(numpy_msg(scan)).serialize(message) == data


def test_numpy_arrays_do_not_change_with_the_buffer() -> None:
    floats = numpy_msg(genpy_class("rospy_tutorials/Floats"))
    buffer = bytearray(class_codec(floats).serialize(floats(data=[1.0])))
    message: Any = class_codec(floats).deserialize(buffer)
    buffer[4:] = bytes(4)
    assert message.data.tolist() == [1.0]


def test_any_message_passes_unchanged() -> None:
    codec = class_codec(AnyMsg)
    with pytest.raises(ROSException):
        codec.serialize(AnyMsg())
    message = codec.deserialize(b"any bytes")
    assert type(message) is AnyMsg
    assert message._buff == b"any bytes"
    assert codec.serialize(message) == b"any bytes"
