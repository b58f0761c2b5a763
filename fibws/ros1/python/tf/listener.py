"""Looking transforms up, and transforming messages."""

from __future__ import annotations

from collections.abc import Sequence
from math import atan2, hypot
from typing import TYPE_CHECKING, Any

import rospy
import tf2_ros
from genpy.classes import message_class

from fibws.tf.transform import Quaternion, Transform, rotated, with_sign_of_matrix

if TYPE_CHECKING:
    import numpy

Found = tuple[list[float], list[float]]
"""A translation, and a rotation as the quaternion x, y, z, w."""


def strip_leading_slash(s: str) -> str:
    """Return a frame's name without a leading ``/``."""
    return s.removeprefix("/")


def xyz_to_mat44(pos: Any) -> numpy.ndarray[Any, Any]:
    """Return the 4x4 matrix of the translation to a Point or Vector3; it needs numpy."""
    from tf import transformations

    return transformations.translation_matrix((pos.x, pos.y, pos.z))


def xyzw_to_mat44(ori: Any) -> numpy.ndarray[Any, Any]:
    """Return the 4x4 matrix of the rotation by a Quaternion; it needs numpy."""
    from tf import transformations

    return transformations.quaternion_matrix((ori.x, ori.y, ori.z, ori.w))


class Transformer:
    """Looks transforms up that are set by hand; `TransformListener` receives them.

    All frames are named in the order target, source: the result is in the target frame. Times are
    Times, and 0 stands for the latest at which the transform is known.

    Args:
        interpolate: ignored; transforms are always interpolated.
        cache_time: how long the transforms of a moving frame are kept; a Duration, 10 s by default.
    """

    def __init__(self, interpolate: bool = True, cache_time: Any = None) -> None:
        self._buffer = tf2_ros.Buffer(cache_time, debug=False)
        self._using_dedicated_thread = False

    def setTransform(self, transform: Any, authority: str = "default_authority") -> None:
        """Add a geometry_msgs/TransformStamped."""
        self._buffer.set_transform(transform, authority)

    def setTransformStatic(self, transform: Any, authority: str = "default_authority") -> None:
        """Add a geometry_msgs/TransformStamped that is valid at all times."""
        self._buffer.set_transform_static(transform, authority)

    def clear(self) -> None:
        """Forget the moving frames."""
        self._buffer.clear()

    def canTransform(self, target_frame: str, source_frame: str, time: Any) -> Any:
        """Return whether `lookupTransform` would succeed, as 1 or 0."""
        return self._buffer.can_transform(
            strip_leading_slash(target_frame), strip_leading_slash(source_frame), time
        )

    def canTransformFull(
        self,
        target_frame: str,
        target_time: Any,
        source_frame: str,
        source_time: Any,
        fixed_frame: str,
    ) -> Any:
        """Return whether `lookupTransformFull` would succeed, as 1 or 0."""
        return self._buffer.can_transform_full(
            strip_leading_slash(target_frame),
            target_time,
            strip_leading_slash(source_frame),
            source_time,
            strip_leading_slash(fixed_frame),
        )

    def waitForTransform(
        self,
        target_frame: str,
        source_frame: str,
        time: Any,
        timeout: Any,
        polling_sleep_duration: Any = None,
    ) -> None:
        """Wait until `lookupTransform` would succeed.

        Args:
            timeout: how long; a Duration.
            polling_sleep_duration: ignored; waiting ends as soon as the transform arrives.

        Raises:
            tf.Exception: it would not in time, or nothing receives transforms.
        """
        self._check_thread()
        found = self._buffer.can_transform(
            strip_leading_slash(target_frame),
            strip_leading_slash(source_frame),
            time,
            timeout,
            return_debug_tuple=True,
        )
        _check_found(found, target_frame, source_frame)

    def waitForTransformFull(
        self,
        target_frame: str,
        target_time: Any,
        source_frame: str,
        source_time: Any,
        fixed_frame: str,
        timeout: Any,
        polling_sleep_duration: Any = None,
    ) -> None:
        """Wait until `lookupTransformFull` would succeed; see `waitForTransform`."""
        self._check_thread()
        found = self._buffer.can_transform_full(
            strip_leading_slash(target_frame),
            target_time,
            strip_leading_slash(source_frame),
            source_time,
            strip_leading_slash(fixed_frame),
            timeout,
            return_debug_tuple=True,
        )
        _check_found(found, target_frame, source_frame)

    def lookupTransform(self, target_frame: str, source_frame: str, time: Any) -> Found:
        """Return the translation and the rotation of one frame in another.

        Raises:
            tf.LookupException: a frame does not exist, or the tree has a loop.
            tf.ConnectivityException: the frames are in different trees.
            tf.ExtrapolationException: the transform is not known at this time.
        """
        return _found(
            self._buffer.lookup_transform(
                strip_leading_slash(target_frame), strip_leading_slash(source_frame), time
            )
        )

    def lookupTransformFull(
        self,
        target_frame: str,
        target_time: Any,
        source_frame: str,
        source_time: Any,
        fixed_frame: str,
    ) -> Found:
        """Return the transform of one frame at one time in another frame at another time.

        Args:
            fixed_frame: a frame that does not move between the two times.

        Raises:
            tf.Exception: as `lookupTransform`.
        """
        return _found(
            self._buffer.lookup_transform_full(
                strip_leading_slash(target_frame),
                target_time,
                strip_leading_slash(source_frame),
                source_time,
                strip_leading_slash(fixed_frame),
            )
        )

    def lookupTwist(
        self, tracking_frame: str, observation_frame: str, time: Any, averaging_interval: Any
    ) -> tuple[tuple[float, float, float], tuple[float, float, float]]:
        """Return the velocity of a frame in another; see `lookupTwistFull`."""
        return self.lookupTwistFull(
            tracking_frame,
            observation_frame,
            observation_frame,
            (0, 0, 0),
            tracking_frame,
            time,
            averaging_interval,
        )

    def lookupTwistFull(
        self,
        tracking_frame: str,
        observation_frame: str,
        reference_frame: str,
        ref_point: Sequence[float],
        reference_point_frame: str,
        time: Any,
        averaging_interval: Any,
    ) -> tuple[tuple[float, float, float], tuple[float, float, float]]:
        """Return the velocity of a frame relative to another.

        Args:
            tracking_frame: the frame that moves.
            observation_frame: the frame that it moves in.
            reference_frame: the frame in whose axes the result is.
            ref_point: the point whose velocity is wanted.
            reference_point_frame: the frame of that point.
            time: the middle of the interval; 0 for the latest.
            averaging_interval: a Duration.

        Returns:
            The linear velocity in m/s and the angular velocity in rad/s.

        Raises:
            tf.Exception: as `lookupTransform`.
        """
        latest = self.getLatestCommonTime(observation_frame, tracking_frame)
        target_time = latest if not time or time.is_zero() else time
        half = rospy.Duration(averaging_interval.to_sec() / 2)
        end_time = min(target_time + half, latest)
        start_time = max(rospy.Time(0, 100_000) + averaging_interval, end_time)
        start_time = start_time - averaging_interval
        seconds = (end_time - start_time).to_sec()
        start = self._transform(observation_frame, tracking_frame, start_time)
        end = self._transform(observation_frame, tracking_frame, end_time)
        (x, y, z), (sx, sy, sz) = end.translation, start.translation
        moved = ((x - sx) / seconds, (y - sy) / seconds, (z - sz) / seconds)
        turned = _turn(start.rotation, end.rotation, seconds)
        reference = self._transform(reference_frame, tracking_frame, target_time)
        in_reference = self._transform(reference_frame, observation_frame, target_time)
        linear = rotated(moved, in_reference.rotation)
        angular = rotated(turned, in_reference.rotation)
        point_frame = self._transform(reference_frame, reference_point_frame, target_time)
        px, py, pz = (point_frame @ Transform(_three(ref_point))).translation
        ox, oy, oz = reference.translation
        vx, vy, vz = _cross(angular, (px - ox, py - oy, pz - oz))
        return (linear[0] + vx, linear[1] + vy, linear[2] + vz), angular

    def chain(
        self,
        target_frame: str,
        target_time: Any,
        source_frame: str,
        source_time: Any,
        fixed_frame: str,
    ) -> list[str]:
        """Return the frames on the way from the source over the fixed frame to the target.

        Raises:
            tf.Exception: as `lookupTransform`.
        """
        return self._buffer._chain(
            target_frame, target_time, source_frame, source_time, fixed_frame
        )

    def getLatestCommonTime(self, source_frame: str, dest_frame: str) -> Any:
        """Return the latest time at which the transform between two frames is known.

        Raises:
            tf.Exception: as `lookupTransform`.
        """
        return self._buffer.get_latest_common_time(
            strip_leading_slash(source_frame), strip_leading_slash(dest_frame)
        )

    def frameExists(self, frame_id: str) -> bool:
        """Return whether a transform has named this frame."""
        return self._buffer._frameExists(strip_leading_slash(frame_id))

    def getFrameStrings(self) -> list[str]:
        """Return all frames."""
        return self._buffer._getFrameStrings()

    def allFramesAsString(self) -> str:
        """Return a line for each frame that has a parent."""
        return self._buffer.all_frames_as_string()

    def allFramesAsDot(self, current_time: Any = None) -> str:
        """Return a graph for graphviz.

        Args:
            current_time: the Time, for the ages of the transforms.
        """
        return self._buffer._allFramesAsDot(current_time)

    def setUsingDedicatedThread(self, value: object) -> None:
        """Say whether something receives transforms, so that waiting for them makes sense."""
        self._using_dedicated_thread = bool(value)

    def getTFPrefix(self) -> str:
        """Return the prefix of frames, which tf2 does not have: an empty text."""
        return ""

    def _transform(self, target: str, source: str, time: Any) -> Transform:
        (x, y, z), (qx, qy, qz, qw) = self.lookupTransform(target, source, time)
        return Transform((x, y, z), (qx, qy, qz, qw))

    def _check_thread(self) -> None:
        if not self._using_dedicated_thread:
            raise tf2_ros.TransformException(
                "cannot wait for transform without a dedicated thread that listens to incoming TF "
                "messages"
            )


class TransformerROS(Transformer):
    """Also transforms messages of geometry_msgs and sensor_msgs.

    A result has the stamp of the message. They raise as `lookupTransform`.
    """

    def asMatrix(self, target_frame: str, hdr: Any) -> numpy.ndarray[Any, Any]:
        """Return the 4x4 matrix that turns coordinates in the frame of a header into the target's.

        It needs numpy.
        """
        translation, rotation = self.lookupTransform(target_frame, hdr.frame_id, hdr.stamp)
        return self.fromTranslationRotation(translation, rotation)

    def fromTranslationRotation(
        self, translation: Sequence[float], rotation: Sequence[float]
    ) -> numpy.ndarray[Any, Any]:
        """Return the 4x4 matrix of a translation x, y, z and a quaternion x, y, z, w."""
        from tf import transformations

        matrix = transformations.quaternion_matrix(rotation)
        matrix[:3, 3] = translation[:3]
        return matrix

    def transformPoint(self, target_frame: str, ps: Any) -> Any:
        """Return a PointStamped in another frame."""
        transform = self._transform(target_frame, ps.header.frame_id, ps.header.stamp)
        result = _stamped(type(ps), target_frame, ps.header.stamp)
        _set(result.point, _moved(transform, ps.point))
        return result

    def transformVector3(self, target_frame: str, v3s: Any) -> Any:
        """Return a Vector3Stamped in another frame; it is only rotated."""
        transform = self._transform(target_frame, v3s.header.frame_id, v3s.header.stamp)
        result = _stamped(type(v3s), target_frame, v3s.header.stamp)
        v = v3s.vector
        _set(result.vector, rotated((v.x, v.y, v.z), transform.rotation))
        return result

    def transformQuaternion(self, target_frame: str, ps: Any) -> Any:
        """Return a QuaternionStamped in another frame."""
        transform = self._transform(target_frame, ps.header.frame_id, ps.header.stamp)
        result = _stamped(type(ps), target_frame, ps.header.stamp)
        moved = transform @ Transform(rotation=_rotation(ps.quaternion))
        _set(result.quaternion, with_sign_of_matrix(moved.rotation))
        return result

    def transformPose(self, target_frame: str, ps: Any) -> Any:
        """Return a PoseStamped in another frame."""
        transform = self._transform(target_frame, ps.header.frame_id, ps.header.stamp)
        result = _stamped(type(ps), target_frame, ps.header.stamp)
        p = ps.pose.position
        moved = transform @ Transform((p.x, p.y, p.z), _rotation(ps.pose.orientation))
        _set(result.pose.position, moved.translation)
        _set(result.pose.orientation, with_sign_of_matrix(moved.rotation))
        return result

    def transformPointCloud(self, target_frame: str, point_cloud: Any) -> Any:
        """Return a sensor_msgs/PointCloud in another frame."""
        header = point_cloud.header
        transform = self._transform(target_frame, header.frame_id, header.stamp)
        result = _stamped(type(point_cloud), target_frame, header.stamp)
        result.channels = point_cloud.channels
        point = message_class("geometry_msgs/Point32")
        result.points = [point(*_moved(transform, each)) for each in point_cloud.points]
        return result


class TransformListener(TransformerROS):
    """Looks transforms up that it receives on ``/tf`` and ``/tf_static``.

    Args:
        args: the arguments of `Transformer`.
    """

    def __init__(self, *args: Any, **kwargs: Any) -> None:
        super().__init__(*args, **kwargs)
        self._listener = tf2_ros.TransformListener(self._buffer)
        self.setUsingDedicatedThread(True)


def _found(message: Any) -> Found:
    t, r = message.transform.translation, message.transform.rotation
    return [t.x, t.y, t.z], [r.x, r.y, r.z, r.w]


def _check_found(found: tuple[int, str], target_frame: str, source_frame: str) -> None:
    if not found[0]:
        text = f'no such transformation: "{source_frame}" -> "{target_frame}"'
        raise tf2_ros.TransformException(found[1] or text)


def _stamped(kind: Any, frame: str, stamp: Any) -> Any:
    message = kind()
    message.header.stamp = stamp
    message.header.frame_id = frame
    return message


def _set(message: Any, values: Sequence[float]) -> None:
    for name, value in zip("xyzw", values, strict=False):
        setattr(message, name, value)


def _moved(transform: Transform, point: Any) -> tuple[float, float, float]:
    return (transform @ Transform((point.x, point.y, point.z))).translation


def _rotation(message: Any) -> Quaternion:
    """Return a Quaternion; the identity for zeros, as `tf.transformations.quaternion_matrix`."""
    rotation = (message.x, message.y, message.z, message.w)
    return rotation if any(rotation) else (0.0, 0.0, 0.0, 1.0)


def _turn(start: Quaternion, end: Quaternion, seconds: float) -> tuple[float, float, float]:
    """Return the angular velocity from one rotation to another, in the axes of both."""
    x, y, z, w = (Transform(rotation=end) @ Transform(rotation=start).inverse()).rotation
    length = hypot(x, y, z)
    if length == 0:
        return (0.0, 0.0, 0.0)
    angle = 2 * (atan2(length, w) if w >= 0 else -atan2(length, -w))
    factor = angle / length / seconds
    return (x * factor, y * factor, z * factor)


def _cross(
    a: tuple[float, float, float], b: tuple[float, float, float]
) -> tuple[float, float, float]:
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def _three(values: Sequence[float]) -> tuple[float, float, float]:
    x, y, z = values
    return (float(x), float(y), float(z))
