"""Messages on their way to the wire and back."""

from __future__ import annotations

from typing import Any, Self

import pytest

from fibws.errors import InvalidMessage
from fibws.interfaces import Message, Time
from fibws.msg.geometry_msgs import Point, Point32, PointStamped, Polygon, Vector3
from fibws.msg.std_msgs import Header
from fibws.node.types import NodeTypes


@pytest.mark.parametrize(
    "given",
    [
        PointStamped(Header(stamp=Time(1, 2)), Point(1, 2, 3)),
        {"header": Header(stamp=Time(1, 2)), "point": Point(1, 2, 3)},
        {"header": {"stamp": Time(1, 2)}, "point": {"x": 1, "y": 2, "z": 3}},
    ],
)
def test_message_and_nested_messages_may_be_dicts(types: NodeTypes, given: Any) -> None:
    codec = types.codec(PointStamped)
    written = codec.write(given)
    assert written == {
        "header": {"seq": 0, "stamp": {"secs": 1, "nsecs": 2}, "frame_id": ""},
        "point": {"x": 1.0, "y": 2.0, "z": 3.0},
    }
    assert codec.read(written) == PointStamped(Header(stamp=Time(1, 2)), Point(1, 2, 3))


@pytest.mark.parametrize(("given", "name"), [(Vector3(), "geometry_msgs/Vector3"), (5, "int")])
def test_other_objects_are_refused(types: NodeTypes, given: object, name: str) -> None:
    with pytest.raises(TypeError, match=rf"expected \[geometry_msgs/Point\] but got \[{name}\]"):
        types.codec(Point).write(given)


def test_two_classes_of_one_type_are_told_apart(types: NodeTypes) -> None:
    with pytest.raises(
        TypeError, match=r"test_message_codec\.Handmade is not fibws\.msg\.geometry_"
    ):
        types.codec(Point32).write(Handmade())


def test_invalid_values_are_refused_in_both_directions(types: NodeTypes) -> None:
    codec = types.codec(Point)
    with pytest.raises(InvalidMessage, match="field x"):
        codec.write({"x": "1"})
    with pytest.raises(InvalidMessage, match="field x"):
        codec.read({"x": "1"})


class Handmade(Message):
    """A message class as rospy has them: no dataclass, and with all that it does made by hand."""

    __slots__ = ("_x", "_y", "connection")
    _type = "geometry_msgs/Point32"

    def __init__(self, *args: float) -> None:
        self._x, self._y, *_ = (*args, 0.0, 0.0)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Handmade) and (self._x, self._y) == (other._x, other._y)

    def __repr__(self) -> str:
        return f"x: {self._x}"

    def to_dict(self) -> dict[str, Any]:
        return {"x": self._x, "y": self._y}

    @classmethod
    def from_dict(cls, values: dict[str, Any]) -> Self:
        return cls(values["x"], values["y"])


class HandmadeHeir(Handmade):
    """A subclass of one, such as numpy_msg makes."""


@pytest.mark.parametrize("given", [Handmade(1, 2), HandmadeHeir(1, 2), {"x": 1, "y": 2.0}])
@pytest.mark.parametrize("class_", [Handmade, HandmadeHeir])
def test_handwritten_class_is_accepted(
    types: NodeTypes, class_: type[Handmade], given: Any
) -> None:
    assert types.message_class(class_) is class_
    if isinstance(given, Message) and not isinstance(given, class_):
        with pytest.raises(TypeError, match=r"expected \[geometry_msgs/Point32\]"):
            types.codec(class_).write(given)
        return
    written = types.codec(class_).write(given)
    assert written == {"x": 1.0, "y": 2.0, "z": 0.0}
    read = types.codec(class_).read(written)
    assert type(read) is class_
    assert read == Handmade(1, 2)


def test_invalid_values_of_a_handwritten_class_are_refused(types: NodeTypes) -> None:
    with pytest.raises(InvalidMessage, match="field y"):
        types.codec(Handmade).write(Handmade(1, "2"))  # type: ignore[arg-type]


def test_handwritten_classes_may_be_nested(types: NodeTypes) -> None:
    written = types.codec(Polygon).write({"points": [Handmade(1, 2), {"z": 3}]})
    assert written == {"points": [{"x": 1.0, "y": 2.0, "z": 0.0}, {"x": 0.0, "y": 0.0, "z": 3.0}]}


@pytest.mark.parametrize(
    ("class_", "has_floats"), [(Point, True), (PointStamped, True), (Header, False)]
)
def test_codec_knows_whether_json_may_contain_infinity(
    types: NodeTypes, class_: type[Message], has_floats: bool
) -> None:
    assert types.codec(class_).has_floats == has_floats
