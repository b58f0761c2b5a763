"""Asking another node's buffer, over an action."""

from __future__ import annotations

from typing import Any

import actionlib
import rospy
import tf2_py as tf2
from actionlib_msgs.msg import GoalStatus
from tf2_msgs.msg import LookupTransformAction, LookupTransformGoal, TF2Error

from tf2_ros.buffer_interface import BufferInterface

_EXCEPTIONS = {
    TF2Error.LOOKUP_ERROR: tf2.LookupException,
    TF2Error.CONNECTIVITY_ERROR: tf2.ConnectivityException,
    TF2Error.EXTRAPOLATION_ERROR: tf2.ExtrapolationException,
    TF2Error.INVALID_ARGUMENT_ERROR: tf2.InvalidArgumentException,
    TF2Error.TIMEOUT_ERROR: tf2.TimeoutException,
}


class BufferClient(BufferInterface):
    """Looks transforms up with a `BufferServer`; the node needs no listener of its own.

    Args:
        ns: the name of the server's action.
        check_frequency: ignored, with a warning.
        timeout_padding: how much longer than the timeout of a lookup to wait for the server.
    """

    def __init__(
        self,
        ns: str,
        check_frequency: float | None = None,
        timeout_padding: Any = rospy.Duration.from_sec(2.0),
    ) -> None:
        super().__init__()
        self.client = actionlib.SimpleActionClient(ns, LookupTransformAction)
        self.timeout_padding = timeout_padding
        if check_frequency is not None:
            rospy.logwarn("Argument check_frequency is deprecated and should not be used.")

    def wait_for_server(self, timeout: Any = rospy.Duration()) -> Any:
        """Wait for the server; return whether it is there."""
        return self.client.wait_for_server(timeout)

    def lookup_transform(
        self, target_frame: str, source_frame: str, time: Any, timeout: Any = rospy.Duration(0.0)
    ) -> Any:
        """Return a transform; see `Buffer.lookup_transform`.

        Raises:
            TransformException: the server's; a TimeoutException if it does not answer.
        """
        return self._ask(
            target_frame=target_frame, source_frame=source_frame, source_time=time, timeout=timeout
        )

    def lookup_transform_full(
        self,
        target_frame: str,
        target_time: Any,
        source_frame: str,
        source_time: Any,
        fixed_frame: str,
        timeout: Any = rospy.Duration(0.0),
    ) -> Any:
        """Return a transform between two times; see `Buffer.lookup_transform_full`."""
        return self._ask(
            target_frame=target_frame,
            source_frame=source_frame,
            source_time=source_time,
            timeout=timeout,
            target_time=target_time,
            fixed_frame=fixed_frame,
            advanced=True,
        )

    def can_transform(
        self, target_frame: str, source_frame: str, time: Any, timeout: Any = rospy.Duration(0.0)
    ) -> bool:
        """Return whether `lookup_transform` succeeds."""
        try:
            self.lookup_transform(target_frame, source_frame, time, timeout)
        except tf2.TransformException:
            return False
        return True

    def can_transform_full(
        self,
        target_frame: str,
        target_time: Any,
        source_frame: str,
        source_time: Any,
        fixed_frame: str,
        timeout: Any = rospy.Duration(0.0),
    ) -> bool:
        """Return whether `lookup_transform_full` succeeds."""
        try:
            self.lookup_transform_full(
                target_frame, target_time, source_frame, source_time, fixed_frame, timeout
            )
        except tf2.TransformException:
            return False
        return True

    def _ask(self, **fields: Any) -> Any:
        goal = LookupTransformGoal(**fields)
        self.client.send_goal(goal)
        sent = "The LookupTransform goal sent to the BufferServer did not come back"
        if not self.client.wait_for_result(goal.timeout + self.timeout_padding):
            raise tf2.TimeoutException(
                f"{sent} in the specified time. Something is likely wrong with the server"
            )
        if self.client.get_state() != GoalStatus.SUCCEEDED:
            raise tf2.TimeoutException(
                f"{sent} with SUCCEEDED status. Something is likely wrong with the server."
            )
        result = self.client.get_result()
        if result.error.error != TF2Error.NO_ERROR:
            kind = _EXCEPTIONS.get(result.error.error, tf2.TransformException)
            raise kind(result.error.error_string)
        return result.transform
