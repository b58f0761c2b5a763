"""tf2's buffer of transforms, on top of `fibws.tf`: http://wiki.ros.org/tf2_py.

BufferCore ── fibws.tf.Buffer ── interpolation, time travel, limits
TransformException
├── LookupException             a frame does not exist, or the tree has a loop
├── ConnectivityException       the frames are in different trees
├── ExtrapolationException      the transform is not known at this time
├── InvalidArgumentException    a frame's name is empty or begins with /
└── TimeoutException            a BufferServer did not answer
"""

from __future__ import annotations

import sys
import threading
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from math import isnan
from typing import Any

import rospy
from genpy.classes import message_class

from fibws.tf import listing
from fibws.tf.buffer import MAX_FRAMES, TOLERANCE, Buffer
from fibws.tf.errors import (
    FrameLoop,
    InvalidTransform,
    OldData,
    RepeatedData,
    TransformError,
    TransformOutOfTime,
    UnconnectedFrames,
    UnknownFrame,
)
from fibws.tf.history import CACHE_TIME, Sample
from fibws.tf.transform import Link, Transform, transform_of

__all__ = [
    "BufferCore",
    "ConnectivityException",
    "ExtrapolationException",
    "InvalidArgumentException",
    "LookupException",
    "TimeoutException",
    "TransformException",
]

_TransformStamped = message_class("geometry_msgs/TransformStamped")
_TransformMessage = message_class("geometry_msgs/Transform")
_Vector3 = message_class("geometry_msgs/Vector3")
_Quaternion = message_class("geometry_msgs/Quaternion")
_Header = message_class("std_msgs/Header")

SECOND = 1_000_000_000


class TransformException(Exception):
    """The base of tf2's errors."""

    __module__ = "tf2"


class ConnectivityException(TransformException):
    """The frames are in different trees."""

    __module__ = "tf2"


class LookupException(TransformException):
    """A frame does not exist, or the tree has a loop."""

    __module__ = "tf2"


class ExtrapolationException(TransformException):
    """The transform is not known at this time."""

    __module__ = "tf2"


class InvalidArgumentException(TransformException):
    """A frame's name is empty or begins with ``/``."""

    __module__ = "tf2"


class TimeoutException(TransformException):
    """A `tf2_ros.BufferServer` did not answer."""

    __module__ = "tf2"


_EXCEPTIONS: dict[type[TransformError], type[TransformException]] = {
    UnknownFrame: LookupException,
    FrameLoop: LookupException,
    UnconnectedFrames: ConnectivityException,
    TransformOutOfTime: ExtrapolationException,
    InvalidTransform: InvalidArgumentException,
}


class BufferCore:
    """A tree of frames over time; all methods may be called in any thread.

    Args:
        cache_time: how long the transforms of a moving frame are kept; a Duration, 10 s by default.

    Raises:
        TypeError: ``cache_time`` is not a Duration.
    """

    def __init__(self, cache_time: Any = None) -> None:
        nanoseconds = CACHE_TIME if cache_time is None else _nanoseconds(cache_time)
        self._buffer = Buffer(nanoseconds / 1e9, strict=True)
        self._lock = threading.Lock()
        self._reported: set[tuple[str, str]] = set()

    def set_transform(self, transform: Any, authority: str) -> None:
        """Add a geometry_msgs/TransformStamped of a moving frame.

        One that tf2 ignores is ignored here, too: its reason is printed on standard error, once for
        each frame.

        Args:
            authority: the node that sent it.
        """
        self._insert(transform, authority, static=False)

    def set_transform_static(self, transform: Any, authority: str) -> None:
        """Add a geometry_msgs/TransformStamped that is valid at all times; see `set_transform`."""
        self._insert(transform, authority, static=True)

    def clear(self) -> None:
        """Forget the moving frames; static ones stay."""
        with self._lock:
            self._buffer.clear()

    def lookup_transform_core(self, target_frame: str, source_frame: str, time: Any) -> Any:
        """Return the transform of one frame in another, as a geometry_msgs/TransformStamped.

        Args:
            target_frame: the frame to transform into.
            source_frame: the frame to transform from.
            time: a Time; 0 for the latest at which the transform is known.

        Raises:
            LookupException: a frame does not exist, or the tree has a loop.
            ConnectivityException: the frames are in different trees.
            ExtrapolationException: the transform is not known at this time.
            InvalidArgumentException: a frame's name is empty or begins with ``/``.
        """
        stamp = _nanoseconds(time)
        if target_frame != source_frame:
            _check_frame("lookupTransform argument target_frame", target_frame)
            _check_frame("lookupTransform argument source_frame", source_frame)
        elif not source_frame.removeprefix("/"):
            return _message(Sample(stamp, target_frame, Transform()), source_frame)
        with _translated(), self._lock:
            sample = self._buffer.lookup(target_frame, source_frame, stamp)
        return _message(sample, source_frame)

    def lookup_transform_full_core(
        self,
        target_frame: str,
        target_time: Any,
        source_frame: str,
        source_time: Any,
        fixed_frame: str,
    ) -> Any:
        """Return the transform of one frame at one time in another frame at another time.

        Args:
            fixed_frame: a frame that does not move between the two times.

        Raises:
            TransformException: as `lookup_transform_core`.
        """
        target_stamp, source_stamp = _nanoseconds(target_time), _nanoseconds(source_time)
        names = {"target_frame": target_frame, "source_frame": source_frame}
        for argument, frame in {**names, "fixed_frame": fixed_frame}.items():
            _check_frame(f"lookupTransform argument {argument}", frame)
            with self._lock:
                if not self._buffer.exists(frame):
                    raise LookupException(str(UnknownFrame(frame, argument)))
        with _translated(), self._lock:
            sample = self._buffer.lookup_full(
                target_frame, target_stamp, source_frame, source_stamp, fixed_frame
            )
        return _message(sample, source_frame)

    def can_transform_core(
        self, target_frame: str, source_frame: str, time: Any
    ) -> tuple[int, str]:
        """Return 1 or 0 for whether `lookup_transform_core` would succeed, and why not."""
        stamp = _nanoseconds(time)
        if target_frame == source_frame:
            return (1, "")
        for argument, frame in (("target", target_frame), ("source", source_frame)):
            if fault := _frame_fault(f"canTransform argument {argument}_frame", frame):
                _print("Warning: ", fault)
                return (0, "")
        with self._lock:
            exists = self._buffer.exists
            missing = [
                f"canTransform: {argument}_frame {frame} does not exist."
                for argument, frame in (("target", target_frame), ("source", source_frame))
                if not exists(frame)
            ]
            if missing:
                return (0, " ".join(missing))
            return self._check(target_frame, source_frame, stamp)

    def can_transform_full_core(
        self,
        target_frame: str,
        target_time: Any,
        source_frame: str,
        source_time: Any,
        fixed_frame: str,
    ) -> tuple[int, str]:
        """Return 1 or 0 for whether `lookup_transform_full_core` would succeed, and why not."""
        target_stamp, source_stamp = _nanoseconds(target_time), _nanoseconds(source_time)
        frames = {"target": target_frame, "source": source_frame, "fixed": fixed_frame}
        for argument, frame in frames.items():
            if fault := _frame_fault(f"canTransform argument {argument}_frame", frame):
                _print("Warning: ", fault)
                return (0, "")
        with self._lock:
            missing = [
                f"canTransform: {argument}_frame {frame} does not exist."
                for argument, frame in frames.items()
                if not self._buffer.exists(frame)
            ]
            if missing:
                return (0, " ".join(missing))
            found = self._check(target_frame, fixed_frame, target_stamp)
            return self._check(fixed_frame, source_frame, source_stamp) if found[0] else found

    def get_latest_common_time(self, source_frame: str, dest_frame: str) -> Any:
        """Return the latest time at which the transform between two frames is known.

        Raises:
            LookupException: a frame does not exist.
            TransformException: the frames are in different trees, or the tree has a loop.
            InvalidArgumentException: a frame's name is empty or begins with ``/``.
        """
        for frame in (source_frame, dest_frame):
            _check_frame("get_latest_common_time", frame)
            with self._lock:
                if not self._buffer.exists(frame):
                    text = f'"{frame}" passed to get_latest_common_time does not exist. '
                    raise LookupException(text)
        try:
            with self._lock:
                stamp = self._buffer.latest_common_time(source_frame, dest_frame)
        except TransformError as error:
            raise TransformException(str(error)) from None
        return rospy.Time(*divmod(stamp, SECOND))

    def all_frames_as_string(self) -> str:
        """Return a line for each frame that has a parent."""
        with self._lock:
            return self._buffer.listing()

    def all_frames_as_yaml(self) -> str:
        """Return the frames with their parents, broadcasters and rates."""
        with self._lock:
            return listing.as_yaml(self._buffer)

    def _allFramesAsDot(self, time: Any = None) -> str:
        with self._lock:
            now = 0.0 if time is None else _nanoseconds(time) / SECOND
            return listing.as_dot(self._buffer, now)

    def _chain(
        self,
        target_frame: str,
        target_time: Any,
        source_frame: str,
        source_time: Any,
        fixed_frame: str,
    ) -> list[str]:
        with _translated(), self._lock:
            return self._buffer.chain(
                target_frame,
                _nanoseconds(target_time),
                source_frame,
                _nanoseconds(source_time),
                fixed_frame,
            )

    def _frameExists(self, frame: str) -> bool:
        with self._lock:
            return self._buffer.exists(frame)

    def _getFrameStrings(self) -> list[str]:
        with self._lock:
            return self._buffer.frames()

    def _check(self, target: str, source: str, stamp: int) -> tuple[int, str]:
        try:
            self._buffer.check(target, source, stamp)
        except TransformError as error:
            return (0, str(error))
        return (1, "")

    def _insert_all(
        self, samples: Iterable[tuple[str, int, Link]], authority: str, *, static: bool
    ) -> None:
        """Add transforms that are not messages; see `set_transform`."""
        refused = []
        insert = self._buffer.insert_link
        with self._lock:
            for frame, stamp, link in samples:
                try:
                    insert(frame, stamp, link, static=static, authority=authority)
                except InvalidTransform as error:
                    sample = Sample(stamp, link[0], transform_of(link))
                    refused.append((frame, sample, error))
        for frame, sample, fault in refused:
            self._report(frame, sample, authority, fault)

    def _insert(self, message: Any, authority: str, *, static: bool) -> None:
        header = message.header
        translation, rotation = message.transform.translation, message.transform.rotation
        transform = Transform(
            (translation.x, translation.y, translation.z),
            (rotation.x, rotation.y, rotation.z, rotation.w),
        )
        sample = Sample(_nanoseconds(header.stamp), header.frame_id, transform)
        frame = message.child_frame_id
        try:
            with self._lock:
                self._buffer.insert(frame, sample, static=static, authority=authority)
        except InvalidTransform as error:
            self._report(frame, sample, authority, error)

    def _report(self, frame: str, sample: Sample, authority: str, error: InvalidTransform) -> None:
        """Print why a transform is ignored, once for each frame and reason."""
        if isinstance(error, RepeatedData | OldData):
            name = frame.removeprefix("/")
            known = f"{error} for frame {name} at time {sample.stamp / SECOND:.6f} according to "
            lines = [("Warning: ", f"{known}authority {authority}")]
        else:
            lines = [("Error:   ", text) for text in _faults(frame, sample, authority)]
        for severity, text in lines or [("Error:   ", f"Ignoring transform: {error}")]:
            key = (frame, text.partition(" ")[0])
            if key not in self._reported and len(self._reported) < MAX_FRAMES:
                self._reported.add(key)
                _print(severity, text)


def _faults(frame: str, sample: Sample, authority: str) -> list[str]:
    """Return tf2's texts for a transform that it ignores."""
    frame, parent = frame.removeprefix("/"), sample.parent.removeprefix("/")
    (x, y, z), (qx, qy, qz, qw) = sample.transform
    by, child = f'from authority "{authority}"', f'child_frame_id "{frame}"'
    rotation = f"({qx:f} {qy:f} {qz:f} {qw:f})"
    found = []
    if frame == parent:
        found.append(
            f"TF_SELF_TRANSFORM: Ignoring transform {by} with frame_id and child_frame_id  "
            f'"{frame}" because they are the same'
        )
    if not frame:
        found.append(
            f"TF_NO_CHILD_FRAME_ID: Ignoring transform {by} because child_frame_id not set "
        )
    if not parent:
        found.append(
            f"TF_NO_FRAME_ID: Ignoring transform with {child}  {by} because frame_id not set"
        )
    if any(map(isnan, (x, y, z, qx, qy, qz, qw))):
        found.append(
            f"TF_NAN_INPUT: Ignoring transform for {child} {by} because of a nan value in the "
            f"transform ({x:f} {y:f} {z:f}) {rotation}"
        )
    if not abs(qx * qx + qy * qy + qz * qz + qw * qw - 1) <= TOLERANCE:
        found.append(
            f"TF_DENORMALIZED_QUATERNION: Ignoring transform for {child} {by} because of an "
            f"invalid quaternion in the transform {rotation}"
        )
    return found


def _print(severity: str, text: str) -> None:
    print(f"{severity}{text}", file=sys.stderr, flush=True)


def _frame_fault(argument: str, frame: str) -> str:
    if not frame:
        return f"Invalid argument passed to {argument} in tf2 frame_ids cannot be empty"
    if frame.startswith("/"):
        return (
            f'Invalid argument "{frame}" passed to {argument} in tf2 frame_ids cannot start with '
            "a '/' like: "
        )
    return ""


def _check_frame(argument: str, frame: str) -> None:
    if not frame or frame[0] == "/":
        raise InvalidArgumentException(_frame_fault(argument, frame))


@contextmanager
def _translated() -> Iterator[None]:
    """Raise tf2's exception for an error of `fibws.tf`."""
    try:
        yield
    except TransformError as error:
        kind = next(kind for kind in type(error).__mro__ if kind in _EXCEPTIONS)
        raise _EXCEPTIONS[kind](str(error)) from None


def _nanoseconds(time: Any) -> int:
    """Return a Time or Duration in nanoseconds.

    Raises:
        TypeError: it is neither.
    """
    try:
        nanoseconds: int = time.secs * SECOND + time.nsecs
        return nanoseconds
    except AttributeError:
        pass
    try:
        nanoseconds = round(time.to_sec() * SECOND)
        return nanoseconds
    except AttributeError:
        text = "time must have a to_sec method, e.g. rospy.Time or rospy.Duration"
        raise TypeError(text) from None


def _message(sample: Sample, child: str) -> Any:
    # Without the defaults, which would take longer than the lookup.
    translation, rotation, header = (
        kind.__new__(kind) for kind in (_Vector3, _Quaternion, _Header)
    )
    transform, message = (kind.__new__(kind) for kind in (_TransformMessage, _TransformStamped))
    translation.x, translation.y, translation.z = sample.transform.translation
    rotation.x, rotation.y, rotation.z, rotation.w = sample.transform.rotation
    transform.translation, transform.rotation = translation, rotation
    header.seq, header.stamp = 0, rospy.Time(*divmod(sample.stamp, SECOND))
    header.frame_id = sample.parent
    message.header, message.child_frame_id, message.transform = header, child, transform
    return message
