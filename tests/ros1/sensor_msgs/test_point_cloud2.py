"""Point clouds are made and read as by sensor_msgs' own module."""

from __future__ import annotations

import importlib
import math
from struct import pack
from typing import Any

import numpy
import pytest
from genpy.classes import message_class
from sensor_msgs import point_cloud2

Header: Any = message_class("std_msgs/Header")
Image: Any = message_class("sensor_msgs/Image")
PointField: Any = message_class("sensor_msgs/PointField")

POINTS = [(1.0, 2.0, 3.0), (math.nan, 5.0, 6.0), (7.0, 8.0, 9.0)]


def coloured(*, is_bigendian: bool = False) -> Any:
    """Two rows of two points, each with a gap before its colour, and a few bytes after each row."""
    order = ">" if is_bigendian else "<"
    rows = [b"".join(pack(f"{order}fxxI", x + y, x) for x in (0, 1)) + b"--" for y in (0.5, 1.5)]
    return point_cloud2.PointCloud2(
        height=2,
        width=2,
        fields=[PointField("rgb", 6, 6, 1), PointField("x", 0, 7, 1)],
        is_bigendian=is_bigendian,
        point_step=10,
        row_step=22,
        data=b"".join(rows),
    )


def test_cloud_is_created() -> None:
    cloud: Any = point_cloud2.create_cloud_xyz32(Header(frame_id="map"), POINTS)
    assert cloud.header.frame_id == "map"
    assert (cloud.height, cloud.width) == (1, 3)
    assert (cloud.point_step, cloud.row_step) == (12, 36)
    assert (cloud.is_dense, cloud.is_bigendian) == (False, False)
    assert [(field.name, field.offset) for field in cloud.fields] == [("x", 0), ("y", 4), ("z", 8)]
    assert cloud.data == pack("<9f", *(number for point in POINTS for number in point))


def test_points_are_read_as_written() -> None:
    cloud = point_cloud2.create_cloud_xyz32(Header(), POINTS)
    points = list(point_cloud2.read_points(cloud))
    assert points[0] == POINTS[0]
    assert math.isnan(points[1][0])
    assert list(point_cloud2.read_points(cloud, skip_nans=True)) == [POINTS[0], POINTS[2]]
    yz = point_cloud2.read_points(cloud, ("y", "z"), skip_nans=True)
    assert list(yz) == [(2.0, 3.0), (5.0, 6.0), (8.0, 9.0)]
    assert list(point_cloud2.read_points(cloud, uvs=[(2, 0), (0, 0)])) == [POINTS[2], POINTS[0]]


def test_points_have_names() -> None:
    cloud = point_cloud2.create_cloud_xyz32(Header(), POINTS)
    assert point_cloud2.read_points_list(cloud)[2].z == 9.0
    [point, *_] = point_cloud2.read_points_list(cloud, ["z", "x"])
    assert (point.x, point.z) == (1.0, 3.0)


def test_points_can_be_a_numpy_array() -> None:
    points = numpy.arange(6, dtype=numpy.float32).reshape(2, 3)
    cloud = point_cloud2.create_cloud_xyz32(Header(), points)  # type: ignore[arg-type]
    assert numpy.array_equal(list(point_cloud2.read_points(cloud)), points)


@pytest.mark.parametrize("is_bigendian", [False, True])
def test_gaps_and_row_padding_are_skipped(is_bigendian: bool) -> None:
    cloud = coloured(is_bigendian=is_bigendian)
    assert list(point_cloud2.read_points(cloud)) == [(0.5, 0), (1.5, 1), (1.5, 0), (2.5, 1)]
    assert list(point_cloud2.read_points(cloud, ["rgb"], uvs=[(1, 1)])) == [(1,)]


def test_fields_can_have_several_numbers() -> None:
    fields = [PointField("xyz", 0, 7, 3), PointField("ring", 12, 4, 1)]
    cloud = point_cloud2.create_cloud(Header(), fields, [(1, 2, 3, 4)])
    assert cloud.point_step == 14
    assert list(point_cloud2.read_points(cloud)) == [(1.0, 2.0, 3.0, 4)]


def test_field_of_unknown_type_is_skipped(capsys: pytest.CaptureFixture[str]) -> None:
    cloud = coloured()
    cloud.fields[0].datatype = 99
    assert next(point_cloud2.read_points(cloud)) == (0.5,)
    assert capsys.readouterr().err == "Skipping unknown PointField datatype [99]\n"


def test_other_messages_are_refused() -> None:
    with pytest.raises(AssertionError, match=r"cloud is not a sensor_msgs.msg.PointCloud2"):
        next(point_cloud2.read_points(Image()))


def test_module_can_be_imported_beside_the_messages() -> None:
    messages = importlib.import_module("sensor_msgs.msg")
    assert messages.PointCloud2 is point_cloud2.PointCloud2
