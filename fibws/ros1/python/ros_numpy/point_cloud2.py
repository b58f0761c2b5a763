"""Point clouds: a record array with a field for each of the cloud's."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np
from sensor_msgs.msg import PointCloud2, PointField

from fibws.values.message_sizes import check_cloud
from ros_numpy.registry import converts_from_numpy, converts_to_numpy

_TYPES = {
    PointField.INT8: "i1",
    PointField.UINT8: "u1",
    PointField.INT16: "i2",
    PointField.UINT16: "u2",
    PointField.INT32: "i4",
    PointField.UINT32: "u4",
    PointField.FLOAT32: "f4",
    PointField.FLOAT64: "f8",
}
_NUMBERS = {np.dtype(code): number for number, code in _TYPES.items()}


@converts_to_numpy(PointField, plural=True)
def fields_to_dtype(
    fields: Iterable[PointField], point_step: int, is_bigendian: bool = False
) -> Any:
    """Return the type of a point.

    Args:
        fields: the cloud's fields.
        point_step: the bytes of a point, with those that no field has.

    Raises:
        ValueError: a field is outside of the point, or of an unknown type.
    """
    names, formats, offsets = [], [], []
    for field in fields:
        code = _TYPES.get(field.datatype)
        if code is None:
            raise ValueError(f"field {field.name} has the unknown datatype {field.datatype}")
        kind = np.dtype(code).newbyteorder(">" if is_bigendian else "<")
        names.append(field.name)
        formats.append(kind if field.count <= 1 else np.dtype((kind, field.count)))
        offsets.append(field.offset)
    return np.dtype(
        {"names": names, "formats": formats, "offsets": offsets, "itemsize": point_step}
    )


@converts_from_numpy(PointField, plural=True)
def dtype_to_fields(dtype: Any) -> list[PointField]:
    """Return the fields of a record type.

    Raises:
        ValueError: a field has a type that PointField lacks.
    """
    fields = []
    for name, (kind, offset, *_) in sorted(dtype.fields.items(), key=lambda each: each[1][1]):
        base, count = kind, 1
        if kind.subdtype is not None:
            base, count = kind.subdtype[0], int(np.prod(kind.shape))
        number = _NUMBERS.get(base.newbyteorder("="))
        if number is None:
            raise ValueError(f"field {name} has the type {base}, which no PointField has")
        fields.append(PointField(name, offset, number, count))
    return fields


@converts_to_numpy(PointCloud2)
def pointcloud2_to_array(cloud_msg: PointCloud2, squeeze: bool = True) -> Any:
    """Return the points: an array of height x width, or of width if the height is 1.

    Args:
        squeeze: whether an array of one row has one dimension.

    Raises:
        ValueError: the data has fewer bytes than the size says, or a field is invalid.
    """
    kind = fields_to_dtype(cloud_msg.fields, cloud_msg.point_step, bool(cloud_msg.is_bigendian))
    shape = (cloud_msg.height, cloud_msg.width)
    row_step = cloud_msg.row_step or cloud_msg.point_step * cloud_msg.width
    data = bytes(cloud_msg.data)
    if not data:  # numpy takes no bytes for any number.
        shape = (0, 0)
    try:
        check_cloud(cloud_msg.width, cloud_msg.height, row_step, cloud_msg.point_step, len(data))
        found = np.ndarray(shape, kind, data, strides=(row_step, cloud_msg.point_step))
    except (TypeError, ValueError) as error:
        raise ValueError(f"the cloud's size does not fit its data: {error}") from None
    return found.reshape(-1) if squeeze and cloud_msg.height == 1 else found


@converts_from_numpy(PointCloud2)
def array_to_pointcloud2(
    cloud_arr: Any, stamp: Any = None, frame_id: str | None = None
) -> PointCloud2:
    """Return the cloud of a record array of one or two dimensions."""
    array = np.atleast_2d(cloud_arr)
    message = PointCloud2()
    if stamp is not None:
        message.header.stamp = stamp
    if frame_id is not None:
        message.header.frame_id = frame_id
    message.height, message.width = array.shape
    message.fields = dtype_to_fields(array.dtype)
    message.point_step = array.dtype.itemsize
    message.row_step = message.point_step * message.width
    message.is_dense = all(
        np.isfinite(array[name]).all()
        for name in array.dtype.names or ()
        if np.issubdtype(array[name].dtype, np.floating)
    )
    message.data = array.tobytes()
    return message


def get_xyz_points(cloud_array: Any, remove_nans: bool = True, dtype: Any = float) -> Any:
    """Return x, y and z of each point, in a last dimension of 3.

    Args:
        remove_nans: whether points with a number that is not finite are left out; the others are
            then in one dimension.
    """
    if remove_nans:
        is_finite = np.isfinite(cloud_array["x"])
        is_finite = is_finite & np.isfinite(cloud_array["y"]) & np.isfinite(cloud_array["z"])
        cloud_array = cloud_array[is_finite]
    return np.stack([cloud_array[name] for name in "xyz"], axis=-1).astype(dtype)


def pointcloud2_to_xyz_array(cloud_msg: PointCloud2, remove_nans: bool = True) -> Any:
    """Return x, y and z of each point of a cloud; see `get_xyz_points`."""
    return get_xyz_points(pointcloud2_to_array(cloud_msg), remove_nans=remove_nans)


def split_rgb_field(cloud_arr: Any) -> Any:
    """Return a record array with ``r``, ``g`` and ``b`` for its field ``rgb``, which is packed."""
    packed = np.ascontiguousarray(cloud_arr["rgb"]).view(np.uint32)
    others = [name for name in cloud_arr.dtype.names if name != "rgb"]
    kind = [(name, cloud_arr.dtype[name]) for name in others]
    found = np.zeros(cloud_arr.shape, [*kind, *((name, np.uint8) for name in "rgb")])
    for name in others:
        found[name] = cloud_arr[name]
    for name, shift in zip("rgb", (16, 8, 0), strict=True):
        found[name] = (packed >> shift) & 255
    return found


def merge_rgb_fields(cloud_arr: Any) -> Any:
    """Return a record array with a packed field ``rgb`` for ``r``, ``g`` and ``b``."""
    r, g, b = (cloud_arr[name].astype(np.uint32) for name in "rgb")
    others = [name for name in cloud_arr.dtype.names if name not in ("r", "g", "b")]
    kind = [(name, cloud_arr.dtype[name]) for name in others]
    found = np.zeros(cloud_arr.shape, [*kind, ("rgb", np.float32)])
    for name in others:
        found[name] = cloud_arr[name]
    found["rgb"] = (r << 16 | g << 8 | b).view(np.float32)
    return found
