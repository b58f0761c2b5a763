"""Message classes are called as rospy's are, and become JSON and come from it unchanged."""

from array import array
from dataclasses import dataclass, field
from math import isnan
from typing import Any, ClassVar

import pytest

from fibws.errors import InvalidMessage
from fibws.interfaces import Duration, Interfaces, Message, Time, Validators
from fibws.interfaces.python_names import python_name, ros_name
from fibws.msg import message_class
from fibws.msg.geometry_msgs import Point, Polygon, PoseStamped
from fibws.msg.sensor_msgs import Image, LaserScan, PointCloud
from fibws.msg.std_msgs import Header, Int32, UInt8MultiArray
from fibws.msg.visualization_msgs import Marker


@dataclass(slots=True, eq=False, repr=False)
class Odd(Message):
    """odd_msgs/Odd"""

    _type: ClassVar[str] = "odd_msgs/Odd"

    from_: str = ""
    place: Point = field(default_factory=Point)
    times: list[Time] = field(default_factory=list)
    blobs: list[int] = field(default_factory=list)


def kind(value: object) -> str:
    return type(value).__name__


def validate(message: Message) -> dict[str, Any]:
    return Validators(Interfaces(), lambda: 0).of(message._type).validate(message.to_dict())


def test_fields_are_given_by_position_or_by_name() -> None:
    assert Int32(5) == Int32(data=5)
    assert Int32().data == 0
    assert Int32(5) != Int32(6)
    assert Int32() != Point()
    assert Int32._type == "std_msgs/Int32"


def test_repr_shows_the_fields() -> None:
    assert repr(Point(1.0, z=2.0)) == "Point(x=1.0, y=0.0, z=2.0)"


def test_misspelled_field_is_an_error() -> None:
    with pytest.raises(AttributeError):
        Int32().dada = 5  # type: ignore[attr-defined]


def test_defaults_of_each_standard_class_are_those_of_the_validator() -> None:
    interfaces = Interfaces()
    validators = Validators(interfaces, lambda: 0)
    types = [name for package in interfaces.packages() for name in interfaces.messages(package)]
    for name in types:
        default = validators.of(name).validate({})
        message = message_class(name)
        assert message._type == name
        assert message().to_dict() == default, name
        assert message.from_dict(default) == message(), name


def test_nested_messages_times_and_bytes_become_json() -> None:
    pose = PoseStamped()
    pose.header.stamp = Time(5, 7)
    pose.pose.position.x = 1.5
    values = pose.to_dict()
    assert values["header"]["stamp"] == {"secs": 5, "nsecs": 7}
    assert values["pose"]["position"] == {"x": 1.5, "y": 0.0, "z": 0.0}
    assert PoseStamped.from_dict(values) == pose
    assert UInt8MultiArray(data=b"\1\2\3").to_dict()["data"] == "AQID"
    assert Image.from_dict(Image(data=b"\1\2\3").to_dict()).data == b"\1\2\3"


def test_lists_of_messages_become_json() -> None:
    cloud = PointCloud()
    cloud.points.append(message_class("geometry_msgs/Point32")(1.0, 2.0, 3.0))  # type: ignore[arg-type,call-arg]
    assert cloud.to_dict()["points"] == [{"x": 1.0, "y": 2.0, "z": 3.0}]
    assert PointCloud.from_dict(cloud.to_dict()) == cloud


def test_null_is_nan() -> None:
    values = LaserScan(ranges=[1.0]).to_dict() | {"ranges": [1.0, None], "angle_min": None}
    scan = LaserScan.from_dict(values)
    assert isnan(scan.angle_min)
    assert scan.ranges[0] == 1.0
    assert isnan(scan.ranges[1])


def test_values_of_wrong_types_are_left_to_the_validator() -> None:
    polygon = Polygon(points=5)  # type: ignore[arg-type]
    assert polygon.to_dict() == {"points": 5}
    image = Image(header=None, data=[1])  # type: ignore[arg-type]
    assert image.to_dict()["header"] is None
    assert image.to_dict()["data"] == [1]
    image = Image()
    image.header.stamp = 5  # type: ignore[assignment]
    assert image.to_dict()["header"]["stamp"] == 5


@pytest.mark.parametrize(
    "data", [bytearray(b"\1\2\3"), memoryview(b"\3\2\1")[::-1], array("B", [1, 2, 3])]
)
def test_bytes_like_objects_are_converted_to_bytes(data: Any) -> None:
    assert Image(data=data).to_dict()["data"] == "AQID"


@pytest.mark.parametrize("data", ["", "AQID", array("i", [1, 2, 3])])
def test_other_objects_are_refused_as_bytes(data: Any) -> None:
    with pytest.raises(
        InvalidMessage, match=rf"a uint8\[\] for field data, but got an? {kind(data)}$"
    ):
        validate(Image(data=data))


def test_time_is_not_a_duration() -> None:
    with pytest.raises(InvalidMessage, match=r"a time for field stamp, but got a Duration$"):
        validate(Header(stamp=Duration(5)))  # type: ignore[arg-type]
    with pytest.raises(InvalidMessage, match=r"a duration for field lifetime, but got a Time$"):
        validate(Marker(lifetime=Time(5)))  # type: ignore[arg-type]
    validate(Header(stamp=Time(5)))
    validate(Marker(lifetime=Duration(-5)))


def test_field_may_have_the_name_of_a_keyword() -> None:
    odd = Odd("here", Point(2.0), [Time(3)], [4])
    values = {
        "from": "here",
        "place": {"x": 2.0, "y": 0.0, "z": 0.0},
        "times": [{"secs": 3, "nsecs": 0}],
        "blobs": [4],
    }
    assert odd.to_dict() == values
    assert Odd.from_dict(values) == odd


@pytest.mark.parametrize(
    ("name", "attribute"),
    [
        ("data", "data"),
        ("data_", "data_"),
        ("from", "from_"),
        ("from_", "from__"),
        ("bytes", "bytes_"),
        ("to_dict", "to_dict_"),
    ],
)
def test_reserved_names_get_an_underscore(name: str, attribute: str) -> None:
    assert python_name(name) == attribute
    assert ros_name(attribute) == name
