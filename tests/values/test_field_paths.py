"""Paths to fields of messages; compared with rostopic's in `test_side_by_side`."""

from __future__ import annotations

import re
from typing import Any

import pytest

from fibws.client.hub_client import HubClient
from fibws.errors import InvalidValue, UnknownField
from fibws.values.field_paths import Path, splits
from fibws.values.typedefs import Typedefs

POINTS = [{"x": 1.0, "y": 2.0, "z": 3.0}, {"x": 4.0, "y": 5.0, "z": 6.0}]
POLYGON = {
    "header": {"seq": 1, "stamp": {"secs": 7, "nsecs": 8}, "frame_id": "map"},
    "polygon": {"points": POINTS},
}


@pytest.fixture
def polygon(client: HubClient) -> Typedefs:
    return Typedefs.of_message(client, "geometry_msgs/PolygonStamped")


@pytest.mark.parametrize(
    ("text", "type_", "value"),
    [
        ("", "geometry_msgs/PolygonStamped", POLYGON),
        ("header/frame_id", "string", "map"),
        ("/header/stamp/", "time", {"secs": 7, "nsecs": 8}),
        ("header/stamp/secs", "int32", 7),
        ("polygon/points", "geometry_msgs/Point32[]", POINTS),
        ("polygon/points[1]", "geometry_msgs/Point32", POINTS[1]),
        ("polygon/points[-1]/x", "float32", 4.0),
        ("polygon/points[:]/x", "float32[]", [1.0, 4.0]),
        ("polygon/points[::-1]", "geometry_msgs/Point32[]", POINTS[::-1]),
    ],
)
def test_path_leads_to_a_field(polygon: Typedefs, text: str, type_: str, value: Any) -> None:
    path = Path(text)
    assert path.field(polygon).written_type == type_
    assert path.pick(POLYGON, polygon) == value


def test_bytes_are_elements(client: HubClient) -> None:
    typedefs = Typedefs.of_message(client, "std_msgs/UInt8MultiArray")
    assert Path("data[1]").pick({"data": "AQI="}, typedefs) == 2


@pytest.mark.parametrize(
    ("text", "facts"),
    [
        ("headr", "headr .*geometry_msgs/PolygonStamped: .*header, polygon"),
        ("header/seq/x", "x in uint32"),
        ("header[0]", "header is a std_msgs/Header"),
        ("polygon/points/x", r"points\[0\]"),
    ],
)
def test_unknown_fields_are_named(polygon: Typedefs, text: str, facts: str) -> None:
    with pytest.raises(UnknownField, match=facts):
        Path(text).field(polygon)


def test_array_may_be_too_short(polygon: Typedefs) -> None:
    with pytest.raises(UnknownField, match=r"points.* 2"):
        Path("polygon/points[2]").pick(POLYGON, polygon)


@pytest.mark.parametrize("text", ["a[", "a]", "a[]", "a[x]", "a[1:2:3:4]", "a[1:2:0]", "a-b"])
def test_invalid_paths_are_refused(text: str) -> None:
    with pytest.raises(InvalidValue, match=re.escape(repr(text))):
        Path(text)


@pytest.mark.parametrize("text", ["a", "a/b[1]/c", "a[1:2]", "a[::2]", "a[-1]"])
def test_text_of_a_path_is_what_was_parsed(text: str) -> None:
    assert str(Path(text)) == text
    assert Path(text)
    assert not Path("")


@pytest.mark.parametrize(
    ("name", "found"),
    [
        ("/a", [("/a", "")]),
        ("/a/b/c", [("/a/b", "c"), ("/a", "b/c")]),
        ("/a/b[0]/c", [("/a", "b[0]/c")]),
        ("/ab", []),
        ("/a/", [("/a", "")]),
    ],
)
def test_name_is_a_topic_perhaps_with_a_path(name: str, found: list[tuple[str, str]]) -> None:
    assert list(splits(name, ["/a", "/a/b", "/c"])) == found
