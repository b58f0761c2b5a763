"""Reading and creating point clouds."""

from __future__ import annotations

import math
import sys
from collections import namedtuple
from collections.abc import Iterable, Iterator, Sequence
from struct import Struct
from typing import Any

from genpy.classes import message_class

from fibws.values.message_sizes import check_cloud

PointCloud2 = message_class("sensor_msgs/PointCloud2")
PointField = message_class("sensor_msgs/PointField")

_LETTERS = {1: "b", 2: "B", 3: "h", 4: "H", 5: "i", 6: "I", 7: "f", 8: "d"}
"""The format characters of `struct` for the types of a PointField."""


def read_points(
    cloud: Any,
    field_names: Sequence[str] | None = None,
    skip_nans: bool = False,
    uvs: Iterable[tuple[int, int]] = (),
) -> Iterator[tuple[Any, ...]]:
    """Yield the points of a cloud, each with its fields in the order of their bytes.

    Args:
        cloud: a sensor_msgs/PointCloud2.
        field_names: the fields to read; None for all.
        skip_nans: skip points with NaN in one of these fields.
        uvs: columns and rows of the points to read; empty for all.

    Raises:
        ValueError: there are fewer bytes than the cloud's size says.
    """
    assert getattr(cloud, "_type", None) == "sensor_msgs/PointCloud2", (
        "cloud is not a sensor_msgs.msg.PointCloud2"
    )
    fields = _in_order(cloud.fields, field_names)
    unpack = _layout(cloud.is_bigendian, fields).unpack_from
    data = cloud.data if isinstance(cloud.data, bytes) else bytes(cloud.data)
    if not uvs:
        check_cloud(cloud.width, cloud.height, cloud.row_step, cloud.point_step, len(data))
    columns = range(cloud.width)
    rows = range(cloud.height if columns else 0)
    for u, v in uvs or ((column, row) for row in rows for column in columns):
        point = unpack(data, cloud.row_step * v + cloud.point_step * u)
        if not (skip_nans and any(map(math.isnan, point))):
            yield point


def read_points_list(
    cloud: Any,
    field_names: Sequence[str] | None = None,
    skip_nans: bool = False,
    uvs: Iterable[tuple[int, int]] = (),
) -> list[Any]:
    """Return the points of a cloud as named tuples; the arguments are those of `read_points`."""
    points = list(read_points(cloud, field_names, skip_nans, uvs))
    names = [field.name for field in _in_order(cloud.fields, field_names)]
    make: Any = namedtuple  # Type checkers require literal names.
    return list(map(make("Point", names)._make, points))


def create_cloud(header: Any, fields: Sequence[Any], points: Sequence[Sequence[float]]) -> Any:
    """Create a cloud of one row.

    Args:
        header: its std_msgs/Header.
        fields: a sensor_msgs/PointField for each number of a point.
        points: the numbers of each point, in the order of their bytes.

    Returns:
        The sensor_msgs/PointCloud2.
    """
    layout = _layout(False, _in_order(fields, None))
    size = layout.size
    data = b"".join(layout.pack(*point) for point in points)
    return PointCloud2(
        header=header,
        height=1,
        width=len(points),
        is_dense=False,
        is_bigendian=False,
        fields=fields,
        point_step=size,
        row_step=size * len(points),
        data=data,
    )


def create_cloud_xyz32(header: Any, points: Sequence[Sequence[float]]) -> Any:
    """Create a cloud of one row whose points are x, y and z as float32; see `create_cloud`."""
    fields = [PointField(name, 4 * index, 7, 1) for index, name in enumerate("xyz")]
    return create_cloud(header, fields, points)


def _in_order(fields: Iterable[Any], names: Sequence[str] | None) -> list[Any]:
    """Return the fields with these names, or all, in the order of their bytes."""
    wanted = [field for field in fields if names is None or field.name in names]
    return sorted(wanted, key=lambda field: field.offset)


def _layout(is_bigendian: bool, fields: Iterable[Any]) -> Struct:
    """Return the struct of one point; bytes between its fields are skipped."""
    pieces, offset = [">" if is_bigendian else "<"], 0
    for field in fields:
        if field.datatype not in _LETTERS:
            print(f"Skipping unknown PointField datatype [{field.datatype}]", file=sys.stderr)
            continue
        gap, number = max(field.offset - offset, 0), Struct(f"<{_LETTERS[field.datatype]}")
        pieces.append(f"{gap}x{field.count}{_LETTERS[field.datatype]}")
        offset += gap + field.count * number.size
    return Struct("".join(pieces))
