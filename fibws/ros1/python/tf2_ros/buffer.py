"""The buffer of transforms of a node."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from typing import Any

import rospy
from rospy import core
from tf2_py import BufferCore

from fibws.tf.transform import Link
from tf2_ros.buffer_interface import BufferInterface

DEFAULT_CAN_TRANSFORM_POLLING_SCALE = 0.01
"""Unused; waiting ends as soon as the transform arrives."""

JUMP = rospy.Duration(3.0)
"""Waiting ends if simulated time goes back by more: a bag is played again."""


class Buffer(BufferCore, BufferInterface):
    """Looks transforms up, and waits for them.

    Args:
        cache_time: how long the transforms of a moving frame are kept; a Duration, 10 s by default.
        debug: offer the service ``~tf2_frames``, which lists the frames.
    """

    def __init__(self, cache_time: Any = None, debug: bool = True) -> None:
        BufferCore.__init__(self, cache_time)
        BufferInterface.__init__(self)
        self.CAN_TRANSFORM_POLLING_SCALE = DEFAULT_CAN_TRANSFORM_POLLING_SCALE
        self.changes = 0
        """How often the buffer was changed."""
        self._waiting = 0
        if debug:
            self._offer_frames()

    def set_transform(self, transform: Any, authority: str) -> None:
        """Add a transform; see `BufferCore.set_transform`."""
        super().set_transform(transform, authority)
        self._wake()

    def set_transform_static(self, transform: Any, authority: str) -> None:
        """Add a static transform; see `BufferCore.set_transform_static`."""
        super().set_transform_static(transform, authority)
        self._wake()

    def set_all(
        self, samples: Iterable[tuple[str, int, Link]], authority: str, *, static: bool
    ) -> None:
        """Add transforms as `fibws.tf` has them, which takes less time than messages."""
        self._insert_all(samples, authority, static=static)
        self._wake()

    def lookup_transform(
        self, target_frame: str, source_frame: str, time: Any, timeout: Any = rospy.Duration(0.0)
    ) -> Any:
        """Return the transform of one frame in another, as a TransformStamped.

        Args:
            target_frame: the frame to transform into.
            source_frame: the frame to transform from.
            time: a Time; 0 for the latest at which the transform is known.
            timeout: how long to wait for it.

        Raises:
            LookupException: a frame does not exist, or the tree has a loop.
            ConnectivityException: the frames are in different trees.
            ExtrapolationException: the transform is not known at this time.
            InvalidArgumentException: a frame's name is empty or begins with ``/``.
            ROSInterruptException: the node ends, and time is simulated.
        """
        if timeout != rospy.Duration(0.0):
            self.can_transform(target_frame, source_frame, time, timeout)
        return self.lookup_transform_core(target_frame, source_frame, time)

    def lookup_transform_full(
        self,
        target_frame: str,
        target_time: Any,
        source_frame: str,
        source_time: Any,
        fixed_frame: str,
        timeout: Any = rospy.Duration(0.0),
    ) -> Any:
        """Return the transform of one frame at one time in another frame at another time.

        Args:
            fixed_frame: a frame that does not move between the two times.

        Raises:
            TransformException: as `lookup_transform`.
        """
        if timeout != rospy.Duration(0.0):
            self.can_transform_full(
                target_frame, target_time, source_frame, source_time, fixed_frame, timeout
            )
        return self.lookup_transform_full_core(
            target_frame, target_time, source_frame, source_time, fixed_frame
        )

    def can_transform(
        self,
        target_frame: str,
        source_frame: str,
        time: Any,
        timeout: Any = rospy.Duration(0.0),
        return_debug_tuple: bool = False,
    ) -> Any:
        """Return whether `lookup_transform` would succeed, as 1 or 0.

        Args:
            return_debug_tuple: return that, and why not.
        """
        return self._can(
            lambda: self.can_transform_core(target_frame, source_frame, time),
            timeout,
            return_debug_tuple,
        )

    def can_transform_full(
        self,
        target_frame: str,
        target_time: Any,
        source_frame: str,
        source_time: Any,
        fixed_frame: str,
        timeout: Any = rospy.Duration(0.0),
        return_debug_tuple: bool = False,
    ) -> Any:
        """Return whether `lookup_transform_full` would succeed; see `can_transform`."""
        return self._can(
            lambda: self.can_transform_full_core(
                target_frame, target_time, source_frame, source_time, fixed_frame
            ),
            timeout,
            return_debug_tuple,
        )

    def _can(self, check: Callable[[], tuple[int, str]], timeout: Any, whole: bool) -> Any:
        if timeout != rospy.Duration(0.0):
            self._wait(lambda: bool(check()[0]), timeout)
        found = check()
        return found if whole else found[0]

    def _wait(self, condition: Callable[[], bool], timeout: Any) -> None:
        """Wait until a condition holds that depends on the buffer, at most so long.

        It ends with the node as `rospy.sleep` does.
        """
        wall = rospy.rostime.is_wallclock()
        outlasts_node = wall and core.has_noticed_shutdown()
        start = rospy.Time.now()
        end = start + timeout
        checked = -1

        def ends() -> bool:
            nonlocal checked
            if core.is_shutdown() and not outlasts_node:
                return True
            now = rospy.Time.now()
            if now >= end or now + JUMP < start:
                return True
            if checked == self.changes:
                return False
            checked = self.changes
            return condition()

        with self.waiting():
            core.wakeup.wait(ends, timeout.to_sec() if wall else None)
        if core.is_shutdown() and not wall:
            raise rospy.ROSInterruptException("ROS shutdown request")

    @contextmanager
    def waiting(self) -> Iterator[None]:
        """Wake waiting threads at each change of the buffer, meanwhile."""
        with self._lock:
            self._waiting += 1
        try:
            yield
        finally:
            with self._lock:
                self._waiting -= 1

    def _wake(self) -> None:
        self.changes += 1
        if self._waiting:
            core.wakeup.wake_all()

    def _offer_frames(self) -> None:
        from tf2_msgs.srv import FrameGraph, FrameGraphResponse

        def list_frames(request: Any) -> Any:
            return FrameGraphResponse(self.all_frames_as_yaml())

        try:
            self.frame_server = rospy.Service("~tf2_frames", FrameGraph, list_frames)
        except rospy.ServiceException:
            pass  # Another buffer of the node offers it.
