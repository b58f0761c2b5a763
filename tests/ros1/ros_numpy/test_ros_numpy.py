"""Messages as numpy's arrays, and back."""

from __future__ import annotations

import numpy as np
import pytest
import ros_numpy
from geometry_msgs.msg import Point, Pose, Quaternion, Transform, Vector3
from nav_msgs.msg import OccupancyGrid
from ros_numpy import point_cloud2
from sensor_msgs.msg import Image, PointCloud2, PointField
from std_msgs.msg import String


def test_points_and_rotations() -> None:
    assert ros_numpy.numpify(Point(1, 2, 3)).tolist() == [1, 2, 3]
    assert ros_numpy.numpify(Vector3(1, 2, 3), hom=True).tolist() == [1, 2, 3, 1]
    assert ros_numpy.msgify(Point, np.array([2.0, 4.0, 6.0, 2.0])) == Point(1, 2, 3)
    assert ros_numpy.msgify(Vector3, np.array([1.0, 2.0, 3.0, 0.0])) == Vector3(1, 2, 3)
    assert ros_numpy.msgify(Quaternion, np.array([0, 0, 0, 1])) == Quaternion(0, 0, 0, 1)
    with pytest.raises(ValueError, match="3 numbers"):
        ros_numpy.msgify(Vector3, np.array([1.0, 2.0, 3.0, 1.0]))


@pytest.mark.parametrize("class_", [Pose, Transform])
def test_poses_are_matrices(class_: type) -> None:
    half = np.sqrt(0.5)
    message = class_()
    position, rotation = (getattr(message, name) for name in message.__slots__)
    position.x, rotation.z, rotation.w = 5.0, half, half
    matrix = ros_numpy.numpify(message)
    assert matrix @ [1, 0, 0, 1] == pytest.approx([5, 1, 0, 1])
    again = ros_numpy.msgify(class_, matrix)
    position, rotation = (getattr(again, name) for name in message.__slots__)
    assert (position.x, rotation.z, rotation.w) == pytest.approx((5.0, half, half))


def test_images() -> None:
    array = np.arange(24, dtype=np.uint8).reshape(2, 4, 3)
    message = ros_numpy.msgify(Image, array, encoding="rgb8")
    assert (message.height, message.width, message.step) == (2, 4, 12)
    assert (ros_numpy.numpify(message) == array).all()
    with pytest.raises(ValueError, match="incompatible"):
        ros_numpy.msgify(Image, array, encoding="mono8")
    for data in (bytes(23), b""):
        message.data = data
        with pytest.raises(ValueError, match="buffer"):
            ros_numpy.numpify(message)


def test_unknown_cells_of_grids_are_masked() -> None:
    grid = np.ma.array(
        [[0, 100, 5], [1, 2, 3]], mask=[[False, False, True], [False] * 3], dtype=np.int8
    )
    message = ros_numpy.msgify(OccupancyGrid, grid)
    assert (message.info.width, message.info.height) == (3, 2)
    assert list(message.data) == [0, 100, -1, 1, 2, 3]
    again = ros_numpy.numpify(message)
    assert again.mask.tolist() == grid.mask.tolist()
    with pytest.raises(ValueError, match="int8"):
        ros_numpy.msgify(OccupancyGrid, np.zeros((2, 2)))


CLOUD = np.array(
    [(1, 2, 3, 7.5), (np.nan, 5, 6, 8.5)],
    dtype={
        "names": ["x", "y", "z", "intensity"],
        "formats": ["<f4"] * 3 + ["<f8"],
        "offsets": [0, 4, 8, 16],
        "itemsize": 32,
    },
)


def test_clouds() -> None:
    message = ros_numpy.msgify(PointCloud2, CLOUD, frame_id="lidar")
    assert [(each.name, each.offset, each.datatype) for each in message.fields] == [
        ("x", 0, PointField.FLOAT32),
        ("y", 4, PointField.FLOAT32),
        ("z", 8, PointField.FLOAT32),
        ("intensity", 16, PointField.FLOAT64),
    ]
    assert (message.header.frame_id, message.point_step, message.is_dense) == ("lidar", 32, False)
    again = ros_numpy.numpify(message)
    assert again["intensity"].tolist() == [7.5, 8.5]
    assert point_cloud2.pointcloud2_to_xyz_array(message).tolist() == [[1, 2, 3]]
    assert point_cloud2.get_xyz_points(again, remove_nans=False).shape == (2, 3)


def test_rows_of_clouds_may_be_padded() -> None:
    fields = [PointField("x", 0, PointField.UINT16, 1)]
    message = PointCloud2(height=2, width=2, point_step=2, row_step=6, fields=fields)
    message.data = np.array([1, 2, 99, 3, 4, 99], "<u2").tobytes()
    assert ros_numpy.numpify(message)["x"].tolist() == [[1, 2], [3, 4]]
    for data in (message.data[:6], b""):
        message.data = data
        with pytest.raises(ValueError, match="does not fit"):
            ros_numpy.numpify(message)
    message.height = 0
    assert ros_numpy.numpify(message).size == 0


def test_colors_are_split_and_merged() -> None:
    colors = np.array([(1.0, 10, 20, 30)], dtype=[("x", "f4"), *((each, "u1") for each in "rgb")])
    merged = point_cloud2.merge_rgb_fields(colors)
    assert merged.dtype.names == ("x", "rgb")
    assert merged["rgb"].view(np.uint32).tolist() == [10 << 16 | 20 << 8 | 30]
    assert point_cloud2.split_rgb_field(merged).tolist() == colors.tolist()


def test_other_messages_are_errors() -> None:
    with pytest.raises(ValueError, match="String; known are"):
        ros_numpy.numpify(String())
    with pytest.raises(ValueError, match="String; known are"):
        ros_numpy.msgify(String, np.zeros(1))
    with pytest.raises(ValueError, match="empty"):
        ros_numpy.numpify([])
    fields = [PointField("x", 0, 99, 1)]
    with pytest.raises(ValueError, match="unknown datatype 99"):
        ros_numpy.numpify(fields, point_step=4)
