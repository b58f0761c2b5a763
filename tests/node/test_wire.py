"""Messages on their way to the wire and back."""

from __future__ import annotations

from typing import Any

import pytest

from fibws.errors import InvalidMessage
from fibws.interfaces import Time
from fibws.msg.geometry_msgs import Point, PointStamped, Vector3
from fibws.msg.std_msgs import Header
from fibws.node.types import Types


@pytest.mark.parametrize(
    "given",
    [
        PointStamped(Header(stamp=Time(1, 2)), Point(1, 2, 3)),
        {"header": Header(stamp=Time(1, 2)), "point": Point(1, 2, 3)},
        {"header": {"stamp": Time(1, 2)}, "point": {"x": 1, "y": 2, "z": 3}},
    ],
)
def test_a_message_may_be_given_by_its_fields_and_they_too(types: Types, given: Any) -> None:
    wire = types.wire(PointStamped)
    written = wire.write(given)
    assert written == {
        "header": {"seq": 0, "stamp": {"secs": 1, "nsecs": 2}, "frame_id": ""},
        "point": {"x": 1.0, "y": 2.0, "z": 3.0},
    }
    assert wire.read(written) == PointStamped(Header(stamp=Time(1, 2)), Point(1, 2, 3))


@pytest.mark.parametrize(("given", "name"), [(Vector3(), "geometry_msgs/Vector3"), (5, "int")])
def test_anything_else_is_no_message(types: Types, given: object, name: str) -> None:
    with pytest.raises(TypeError, match=rf"expected \[geometry_msgs/Point\] but got \[{name}\]"):
        types.wire(Point).write(given)


def test_what_does_not_fit_is_refused_both_ways(types: Types) -> None:
    wire = types.wire(Point)
    with pytest.raises(InvalidMessage, match="field x"):
        wire.write({"x": "1"})
    with pytest.raises(InvalidMessage, match="field x"):
        wire.read({"x": "1"})
