"""A goal in its server's hands."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import rospy
from actionlib_msgs.msg import GoalID, GoalStatus

from fibws.node.actions.status import Transition

if TYPE_CHECKING:
    from actionlib.action_server import ActionServer
    from fibws.node.actions.status import Record

_STEPS = {
    Transition.ACCEPT: ("Accepting goal", "an active", "pending or recalling"),
    Transition.REJECT: ("Setting status to rejected on goal", "a rejected", "pending or recalling"),
    Transition.CANCEL: (
        "Setting status to canceled on goal",
        "a cancelled",
        "pending, recalling, active, or preempting",
    ),
    Transition.SUCCEED: (
        "Setting status to succeeded on goal",
        "a succeeded",
        "preempting or active",
    ),
    Transition.ABORT: ("Setting status to aborted on goal", "an aborted", "preempting or active"),
}
"""What each step is called in the log, the state that it leads to, and those that it leads from."""


class ServerGoalHandle:
    """What a server knows of a goal, and by which it says what becomes of it.

    A step that the goal's state does not allow is logged as an error, and changes nothing. Two are
    equal if they are of the same goal.

    Args:
        record: the goal's state; a handle without one stands for no goal.
        action_server: the goal's server.
        goal: the message that brought it, an ``...ActionGoal``.
    """

    def __init__(
        self,
        record: Record | None = None,
        action_server: ActionServer | None = None,
        goal: Any = None,
    ) -> None:
        self.goal = goal
        self._record = record
        self._server = action_server

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, ServerGoalHandle):
            return NotImplemented
        if self._record is None or other._record is None:
            return False
        return self._record.id == other._record.id

    def __hash__(self) -> int:
        return hash("" if self._record is None else self._record.id)

    def get_goal(self) -> Any:
        """The goal itself, such as a ``FibonacciGoal``; None if there is none."""
        return None if self.goal is None else self.goal.goal

    def get_goal_id(self) -> Any:
        """The goal's ``GoalID``."""
        if self._record is None:
            rospy.logerr("Attempt to get a goal id on an uninitialized ServerGoalHandle")
            return GoalID()
        return goal_id(self._record)

    def get_goal_status(self) -> Any:
        """The goal's state, an ``actionlib_msgs/GoalStatus``."""
        if self._record is None or self._server is None:
            rospy.logerr("Attempt to get goal status on an uninitialized ServerGoalHandle")
            return GoalStatus()
        with self._server.lock:
            return goal_status(self._record)

    def get_default_result(self) -> Any:
        """A result whose fields are all empty."""
        return None if self._server is None else self._server.ActionResultType()

    def set_accepted(self, text: str = "") -> None:
        """Begin with the goal: it is ACTIVE, or PREEMPTING if it has been canceled already."""
        self._go(Transition.ACCEPT, text)

    def set_canceled(self, result: Any = None, text: str = "") -> None:
        """End the goal since it is wanted no more: RECALLED, or PREEMPTED if it had begun."""
        self._end(Transition.CANCEL, result, text)

    def set_rejected(self, result: Any = None, text: str = "") -> None:
        """Refuse the goal."""
        self._end(Transition.REJECT, result, text)

    def set_aborted(self, result: Any = None, text: str = "") -> None:
        """Give the goal up."""
        self._end(Transition.ABORT, result, text)

    def set_succeeded(self, result: Any = None, text: str = "") -> None:
        """Tell that the goal was reached."""
        self._end(Transition.SUCCEED, result, text)

    def publish_feedback(self, feedback: Any) -> None:
        """Tell the goal's client how far it has come."""
        if self._record is None or self._server is None:
            rospy.logerr("Attempt to publish feedback on an uninitialized ServerGoalHandle")
            return
        with self._server.lock:
            self._server.publish_feedback(goal_status(self._record), feedback)

    def set_cancel_requested(self) -> bool:
        """Note that the client wants the goal no more; tell whether that is news."""
        if self._record is None or self._server is None:
            return False
        with self._server.lock:
            if not self._record.go(Transition.CANCEL_REQUEST, self._record.text):
                return False
            self._server.publish_status()
            return True

    def _go(self, transition: Transition, text: str) -> bool:
        if self._record is None or self._server is None:
            rospy.logerr("Attempt to set status on an uninitialized ServerGoalHandle")
            return False
        step, state, allowed = _STEPS[transition]
        with self._server.lock:
            record = self._record
            rospy.logdebug("%s, id: %s, stamp: %.2f", step, record.id, record.stamp / 1e9)
            if not record.go(transition, text):
                rospy.logerr(
                    f"To transition to {state} state, the goal must be in a {allowed} state, "
                    f"it is currently in state: {record.status:d}"
                )
                return False
            if transition is Transition.ACCEPT:
                self._server.publish_status()
            return True

    def _end(self, transition: Transition, result: Any, text: str) -> None:
        if self._server is None:
            self._go(transition, text)
            return
        with self._server.lock:
            if self._go(transition, text) and self._record is not None:
                self._server.goal_ended(self._record, result)


def goal_id(record: Record) -> Any:
    """A goal's ``GoalID``."""
    return GoalID(stamp=rospy.Time(*divmod(record.stamp, 1_000_000_000)), id=record.id)


def goal_status(record: Record) -> Any:
    """A goal's state as an ``actionlib_msgs/GoalStatus``."""
    return GoalStatus(goal_id=goal_id(record), status=int(record.status), text=record.text)
