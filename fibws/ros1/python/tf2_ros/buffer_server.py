"""Answering lookups of other nodes, over an action; also the program ``tf2_ros buffer_server``."""

from __future__ import annotations

import threading
from typing import Any, NamedTuple

import actionlib
import rospy
import tf2_py as tf2
from rospy import core
from tf2_msgs.msg import LookupTransformAction, LookupTransformResult, TF2Error

MAX_GOALS = 1000
"""Most lookups that wait for their transforms; more are rejected."""

_CODES: list[tuple[type[tf2.TransformException], int]] = [
    (tf2.LookupException, TF2Error.LOOKUP_ERROR),
    (tf2.ConnectivityException, TF2Error.CONNECTIVITY_ERROR),
    (tf2.ExtrapolationException, TF2Error.EXTRAPOLATION_ERROR),
    (tf2.InvalidArgumentException, TF2Error.INVALID_ARGUMENT_ERROR),
    (tf2.TimeoutException, TF2Error.TIMEOUT_ERROR),
    (tf2.TransformException, TF2Error.TRANSFORM_ERROR),
]


class _Goal(NamedTuple):
    handle: Any
    end: Any


class BufferServer:
    """Serves the lookups of `BufferClient`; a goal waits for its transform until its timeout.

    Args:
        buffer: a `tf2_ros.Buffer`.
        ns: the name of the action.
        auto_start: start at once, or with `start`.
        check_period: ignored; goals end as soon as their transforms arrive.
    """

    def __init__(
        self, buffer: Any, ns: str, auto_start: bool = True, check_period: Any = None
    ) -> None:
        self._buffer = buffer
        self._goals: list[_Goal] = []
        self._lock = threading.Lock()
        self._news = False
        self._thread: threading.Thread | None = None
        self._server = actionlib.ActionServer(
            ns, LookupTransformAction, self._accept, self._cancel, auto_start=False
        )
        if auto_start:
            self.start()

    def start(self) -> None:
        """Accept goals."""
        self._server.start()

    def _accept(self, handle: Any) -> None:
        goal = _Goal(handle, rospy.Time.now() + handle.get_goal().timeout)
        with self._lock:
            if len(self._goals) >= MAX_GOALS:
                handle.set_rejected(text=f"too many lookups wait (limit {MAX_GOALS})")
                return
        handle.set_accepted()
        if self._finish(goal):
            return
        with self._lock:
            self._goals.append(goal)
            self._news = True
            if self._thread is None:
                self._thread = threading.Thread(target=self._run, name="lookups", daemon=True)
                self._thread.start()
        core.wakeup.wake_all()

    def _cancel(self, handle: Any) -> None:
        with self._lock:
            found = [goal for goal in self._goals if goal.handle == handle]
            self._goals = [goal for goal in self._goals if goal.handle != handle]
        for goal in found:
            goal.handle.set_canceled()

    def _run(self) -> None:
        while not core.is_shutdown():
            with self._lock:
                goals, self._news = list(self._goals), False
            checked = self._buffer.changes
            ended = [goal for goal in goals if self._finish(goal)]
            with self._lock:
                self._goals = [goal for goal in self._goals if goal not in ended]
                ends = [goal.end for goal in self._goals]
            self._wait(checked, min(ends, default=None))

    def _wait(self, checked: int, end: Any) -> None:
        """Wait for a goal or a transform, or until the first goal's time is over."""

        def has_news() -> bool:
            return (
                core.is_shutdown()
                or self._news
                or (
                    end is not None and (self._buffer.changes != checked or rospy.Time.now() >= end)
                )
            )

        left = None if end is None else max((end - rospy.Time.now()).to_sec(), 0)
        with self._buffer.waiting():
            core.wakeup.wait(has_news, left if rospy.rostime.is_wallclock() else None)

    def _finish(self, goal: _Goal) -> bool:
        """End a goal whose transform is known or whose time is over; return whether it ended."""
        wanted = goal.handle.get_goal()
        full: tuple[Any, ...]
        if wanted.advanced:
            can, lookup = (
                self._buffer.can_transform_full_core,
                self._buffer.lookup_transform_full_core,
            )
            full = (
                *(wanted.target_frame, wanted.target_time),
                *(wanted.source_frame, wanted.source_time, wanted.fixed_frame),
            )
        else:
            can, lookup = self._buffer.can_transform_core, self._buffer.lookup_transform_core
            full = (wanted.target_frame, wanted.source_frame, wanted.source_time)
        if not can(*full)[0] and rospy.Time.now() < goal.end:
            return False
        result = LookupTransformResult()
        try:
            result.transform = lookup(*full)
        except tf2.TransformException as error:
            result.error.error = next(code for kind, code in _CODES if isinstance(error, kind))
            result.error.error_string = str(error)
        goal.handle.set_succeeded(result)
        return True


def main() -> None:
    """Serve the lookups of other nodes with a listener, as ROS's buffer_server."""
    import tf2_ros

    rospy.init_node("tf_buffer")
    seconds = rospy.get_param("~buffer_size", 120.0)
    buffer = tf2_ros.Buffer(
        rospy.Duration(seconds), rospy.get_param("~publish_frame_service", False)
    )
    tf2_ros.TransformListener(buffer)
    own = rospy.get_param("~use_node_namespace", False)
    BufferServer(buffer, rospy.get_name() if own else "tf2_buffer_server")
    rospy.spin()


if __name__ == "__main__":
    main()
