"""tf.Transformer and TransformerROS, which are filled by hand, and their errors."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
import rospy
import tf
import tf2_geometry_msgs
import tf2_ros
import tf2_sensor_msgs
from genpy.classes import message_class
from sensor_msgs import point_cloud2
from tf2_py import BufferCore

Time, Duration = rospy.Time, rospy.Duration
HALF = math.sqrt(0.5)


def make(type_: str, frame: str = "camera", at: float = 0, **fields: Any) -> Any:
    message = message_class(type_)(**fields)
    message.header.frame_id = frame
    message.header.stamp = Time.from_sec(at)
    return message


def stamped(parent: str, child: str, at: float, x: float = 0, yaw: float = 0) -> Any:
    message = make("geometry_msgs/TransformStamped", parent, at, child_frame_id=child)
    message.transform.translation.x = x
    message.transform.rotation.z = math.sin(yaw / 2)
    message.transform.rotation.w = math.cos(yaw / 2)
    return message


@pytest.fixture
def robot() -> tf.TransformerROS:
    """map → base, which moves 1 m/s along x, → camera, which looks to the left."""
    robot = tf.TransformerROS()
    for at in (1, 2, 3):
        robot.setTransform(stamped("map", "base", at, x=at))
    robot.setTransformStatic(stamped("base", "camera", 0, x=0.5, yaw=math.pi / 2))
    return robot


def xyz(vector: Any) -> Any:
    return pytest.approx((vector.x, vector.y, vector.z))


# Looking up


def test_lookup(robot: tf.TransformerROS) -> None:
    translation, rotation = robot.lookupTransform("/map", "/camera", Time(2))
    assert translation == [2.5, 0, 0]
    assert rotation == pytest.approx([0, 0, HALF, HALF])
    assert robot.lookupTransform("map", "base", Time(0))[0] == [3, 0, 0]
    assert robot.lookupTransform("map", "base", Time(2, 500_000_000))[0] == [2.5, 0, 0]


def test_lookup_at_two_times(robot: tf.TransformerROS) -> None:
    translation, _ = robot.lookupTransformFull("base", Time(3), "/base", Time(1), "/map")
    assert translation == [-2, 0, 0]
    assert robot.canTransformFull("base", Time(3), "base", Time(1), "/map")
    assert not robot.canTransformFull("base", Time(9), "base", Time(1), "/map")


def test_errors_have_the_names_of_tf(robot: tf.TransformerROS) -> None:
    robot.setTransform(stamped("mars", "rover", 1))
    with pytest.raises(tf.LookupException, match='"moon" passed to lookupTransform argument'):
        robot.lookupTransform("map", "moon", Time())
    with pytest.raises(tf.ConnectivityException, match="not part of the same tree"):
        robot.lookupTransform("map", "rover", Time())
    with pytest.raises(tf.ExtrapolationException, match=r"6\.000000000s into the future"):
        robot.lookupTransform("map", "base", Time(9))
    for error in (tf.LookupException, tf.ConnectivityException, tf.ExtrapolationException):
        assert issubclass(error, tf.Exception)
    with pytest.raises(tf.Exception):
        robot.getLatestCommonTime("MANDALAY", "JUPITER")


def test_can_transform(robot: tf.TransformerROS) -> None:
    assert robot.canTransform("/map", "/camera", Time(2))
    assert not robot.canTransform("/map", "/camera", Time(4))


def test_waiting_needs_a_listener(robot: tf.TransformerROS) -> None:
    with pytest.raises(tf.Exception, match="without a dedicated thread"):
        robot.waitForTransform("map", "base", Time(2), Duration(1))
    with pytest.raises(tf.Exception, match="without a dedicated thread"):
        robot.waitForTransformFull("map", Time(2), "base", Time(2), "map", Duration(1))
    robot.setUsingDedicatedThread(True)
    robot.waitForTransform("/map", "/base", Time(2), Duration(0))
    robot.waitForTransformFull("map", Time(2), "base", Time(2), "/map", Duration(0), 0.1)
    with pytest.raises(tf.Exception, match="into the future"):
        robot.waitForTransform("map", "base", Time(9), Duration(0))
    with pytest.raises(tf.Exception, match="does not exist"):
        robot.waitForTransformFull("map", Time(2), "moon", Time(2), "map", Duration(0))


def test_frames_are_listed(robot: tf.TransformerROS) -> None:
    assert robot.getFrameStrings() == ["base", "map", "camera"]
    assert robot.frameExists("/map")
    assert not robot.frameExists("moon")
    assert "Frame base exists with parent map." in robot.allFramesAsString()
    assert '"map" -> "base"' in robot.allFramesAsDot()
    assert "Recorded at time: 5.000" in robot.allFramesAsDot(Time(5))
    assert robot.chain("map", Time(), "camera", Time(), "base") == ["camera", "base", "map"]
    assert robot.getLatestCommonTime("/camera", "/map") == Time(3)
    assert robot.getTFPrefix() == ""
    robot.clear()
    assert not robot.canTransform("map", "base", Time())
    assert robot.canTransform("base", "camera", Time())


@pytest.mark.parametrize("seconds", [2, 50])
def test_cache_time(seconds: int) -> None:
    transformer = tf.Transformer(True, Duration(seconds))
    for at in range(101):
        transformer.setTransform(stamped("map", "base", at))
    transformer.lookupTransform("map", "base", Time(100 - seconds))
    with pytest.raises(tf.ExtrapolationException, match="into the past"):
        transformer.lookupTransform("map", "base", Time(99 - seconds))
    with pytest.raises(TypeError, match="must have a to_sec method"):
        tf.Transformer(cache_time=10)


def test_velocity() -> None:
    transformer = tf.Transformer()
    for at in range(5):
        transformer.setTransform(stamped("map", "base", at, x=3 * at, yaw=0.5 * at))
    linear, angular = transformer.lookupTwist("base", "map", Time(0), Duration(2))
    assert linear == pytest.approx((3, 0, 0))
    assert angular == pytest.approx((0, 0, 0.5))
    linear, angular = transformer.lookupTwistFull(
        "base", "map", "map", (0, 2, 0), "base", Time(4), Duration(2)
    )
    assert angular == pytest.approx((0, 0, 0.5))
    turned = 2 * 0.5
    assert linear == pytest.approx((3 - turned * math.cos(2), -turned * math.sin(2), 0))
    still = tf.Transformer()
    for at in range(2):
        still.setTransform(stamped("map", "base", at))
    assert still.lookupTwist("base", "map", Time(0), Duration(1)) == ((0, 0, 0), (0, 0, 0))


# Messages


def test_points_and_vectors(robot: tf.TransformerROS) -> None:
    point = make("geometry_msgs/PointStamped", at=2)
    point.point.x, point.point.y, point.point.z = 1, 2, 3
    moved = robot.transformPoint("map", point)
    assert xyz(moved.point) == (0.5, 1, 3)
    assert (moved.header.frame_id, moved.header.stamp) == ("map", Time(2))
    vector = make("geometry_msgs/Vector3Stamped")
    vector.vector.x = 1
    assert xyz(robot.transformVector3("map", vector).vector) == (0, 1, 0)


def test_poses(robot: tf.TransformerROS) -> None:
    pose = make("geometry_msgs/PoseStamped", at=2)
    pose.pose.position.y = 1
    moved = robot.transformPose("map", pose).pose
    assert xyz(moved.position) == (1.5, 0, 0)
    q = moved.orientation  # A pose without an orientation is not turned.
    assert (q.x, q.y, q.z, q.w) == pytest.approx((0, 0, HALF, HALF))
    turned = make("geometry_msgs/QuaternionStamped")
    turned.quaternion.z = turned.quaternion.w = -HALF
    q = robot.transformQuaternion("map", turned).quaternion
    assert (q.x, q.y, abs(q.z), q.w) == pytest.approx((0, 0, 1, 0))


def test_messages_are_turned_as_by_matrices(robot: tf.TransformerROS) -> None:
    t = tf.transformations
    for _ in range(10):
        q = t.random_quaternion()
        pose = make("geometry_msgs/PoseStamped", at=2)
        o = pose.pose.orientation
        o.x, o.y, o.z, o.w = q
        o = robot.transformPose("map", pose).pose.orientation
        matrix = robot.asMatrix("map", pose.header) @ t.quaternion_matrix(q)
        assert np.allclose([o.x, o.y, o.z, o.w], t.quaternion_from_matrix(matrix))


def test_clouds(robot: tf.TransformerROS) -> None:
    cloud = make("sensor_msgs/PointCloud")
    cloud.points = [message_class("geometry_msgs/Point32")(1, 2, 3)]
    moved = robot.transformPointCloud("base", cloud)
    assert [xyz(point) == (-1.5, 1, 3) for point in moved.points] == [True]
    assert moved.header.frame_id == "base"


def test_matrices(robot: tf.TransformerROS) -> None:
    matrix = robot.asMatrix("base", _header())
    expected = np.array([[0, -1, 0, 0.5], [1, 0, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]])
    assert np.allclose(matrix, expected)
    point = message_class("geometry_msgs/Point")(1, 2, 3)
    assert np.allclose(tf.listener.xyz_to_mat44(point)[:3, 3], (1, 2, 3))
    turn = message_class("geometry_msgs/Quaternion")(0, 0, 0, 1)
    assert np.allclose(tf.listener.xyzw_to_mat44(turn), np.identity(4))
    assert np.allclose(robot.fromTranslationRotation((1, 2, 3), (0, 0, 0, 1))[:3, 3], (1, 2, 3))


def _header() -> Any:
    return message_class("std_msgs/Header")(0, Time(), "camera")


# tf2


@pytest.fixture
def buffer() -> tf2_ros.Buffer:
    buffer = tf2_ros.Buffer(debug=False)
    buffer.set_transform_static(stamped("base", "camera", 0, x=0.5, yaw=math.pi / 2), "/me")
    return buffer


def test_registered_types_are_transformed(buffer: tf2_ros.Buffer) -> None:
    pose = make("geometry_msgs/PoseWithCovarianceStamped")
    pose.pose.pose.orientation.w = 1
    pose.pose.covariance = list(np.diag([1.0, 2, 3, 4, 5, 6]).ravel())
    moved = buffer.transform(pose, "base")
    assert xyz(moved.pose.pose.position) == (0.5, 0, 0)
    assert np.allclose(np.diag(np.reshape(moved.pose.covariance, (6, 6))), [2, 1, 3, 5, 4, 6])
    with pytest.raises(tf2_ros.TypeException, match="if not loaded or supported"):
        buffer.transform(make("geometry_msgs/TwistStamped"), "base")


def test_clouds_are_transformed_with_their_other_fields(buffer: tf2_ros.Buffer) -> None:
    field = message_class("sensor_msgs/PointField")
    fields = [field(name, 4 * index, 7, 1) for index, name in enumerate(("x", "y", "z", "i"))]
    cloud = point_cloud2.create_cloud(_header(), fields, [(1, 2, 3, 9), (0, 0, 0, 8)])
    moved = list(point_cloud2.read_points(buffer.transform(cloud, "base")))
    assert moved == [pytest.approx((-1.5, 1, 3, 9)), pytest.approx((0.5, 0, 0, 8))]
    empty = point_cloud2.create_cloud(_header(), fields, [])
    assert buffer.transform(empty, "base").width == 0


def test_clouds_need_no_numpy(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(__import__("sys").modules, "numpy", None)
    cloud = point_cloud2.create_cloud_xyz32(_header(), [(1, 2, 3)])
    moved = tf2_sensor_msgs.do_transform_cloud(cloud, stamped("base", "camera", 0, x=1))
    assert list(point_cloud2.read_points(moved)) == [(2, 2, 3)]


def test_missing_kdl_is_reported() -> None:
    with pytest.raises(ModuleNotFoundError, match="python3-pykdl"):
        tf2_geometry_msgs.transform_to_kdl(stamped("base", "camera", 0))
    import tf_conversions

    with pytest.raises(ModuleNotFoundError, match="PyKDL"):
        tf_conversions.fromMsg  # noqa: B018
    assert tf_conversions.transformations is tf.transformations
    with pytest.raises(AttributeError):
        tf_conversions._nothing  # noqa: B018


def test_conversions() -> None:
    registration = tf2_ros.ConvertRegistration()
    registration.add_to_msg(list, tuple)
    registration.add_from_msg(set, set)
    registration.add_convert((str, int), int)
    assert tf2_ros.convert([1, 2, 2], set) == {1, 2}
    assert tf2_ros.convert("5", int) == 5
    value = {"a": 1}
    assert tf2_ros.convert(value, dict) == value
    with pytest.raises(tf2_ros.TypeException):
        tf2_ros.convert(value, str)
    with pytest.raises(tf2_ros.NotImplementedException):
        tf2_ros.BufferInterface().lookup_transform("a", "b", Time())


def test_ignored_transforms_are_reported_once(
    buffer: tf2_ros.Buffer, capsys: pytest.CaptureFixture[str]
) -> None:
    core: BufferCore = buffer
    for _ in range(3):
        core.set_transform(stamped("a", "a", 1), "/me")
        core.set_transform(stamped("a", "b", 1, x=math.inf), "/me")
        core.set_transform(stamped("a", "c", 1), "/me")
    lines = capsys.readouterr().err.splitlines()
    assert lines[0] == (
        'Error:   TF_SELF_TRANSFORM: Ignoring transform from authority "/me" with frame_id and '
        'child_frame_id  "a" because they are the same'
    )
    assert "expected finite numbers" in lines[1]
    assert lines[2] == (
        "Warning: TF_REPEATED_DATA ignoring data with redundant timestamp for frame c at time "
        "1.000000 according to authority /me"
    )
    assert len(lines) == 3


def test_times_may_be_any_objects_with_seconds(buffer: tf2_ros.Buffer) -> None:
    class Seconds:
        def to_sec(self) -> float:
            return 1.5

    found = buffer.lookup_transform("base", "camera", Seconds())
    assert found.header.stamp == Time(1, 500_000_000)
    with pytest.raises(TypeError, match="must have a to_sec method"):
        buffer.lookup_transform("base", "camera", 0)
