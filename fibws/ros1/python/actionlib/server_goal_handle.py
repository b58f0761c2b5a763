"""A server's handle of a goal."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import rospy
from actionlib_msgs.msg import GoalID, GoalStatus

from fibws.node.actions.status import Transition

if TYPE_CHECKING:
    from actionlib.action_server import ActionServer
    from fibws.node.actions.status import GoalRecord

_TRANSITIONS = {
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
"""For each transition: the text for the log, its new state, and the states that allow it."""


class ServerGoalHandle:
    """A server's handle of a goal, by which it sets the goal's state.

    A transition that the goal's state does not allow is logged as an error, and ignored. Two
    handles of the same goal are equal.

    Args:
        record: the goal's state; None for a handle without a goal.
        action_server: the goal's server.
        goal: the goal's message, an ``...ActionGoal``.
    """

    def __init__(
        self,
        record: GoalRecord | None = None,
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
        """Return the goal, such as a ``FibonacciGoal``; None for a handle without a goal."""
        return None if self.goal is None else self.goal.goal

    def get_goal_id(self) -> Any:
        """Return the goal's ``GoalID``."""
        if self._record is None:
            rospy.logerr("Attempt to get a goal id on an uninitialized ServerGoalHandle")
            return GoalID()
        return goal_id(self._record)

    def get_goal_status(self) -> Any:
        """Return the goal's state, an ``actionlib_msgs/GoalStatus``."""
        if self._record is None or self._server is None:
            rospy.logerr("Attempt to get goal status on an uninitialized ServerGoalHandle")
            return GoalStatus()
        with self._server.lock:
            return goal_status(self._record)

    def get_default_result(self) -> Any:
        """Return an empty result."""
        return None if self._server is None else self._server.ActionResultType()

    def set_accepted(self, text: str = "") -> None:
        """Accept the goal: it becomes ACTIVE, or PREEMPTING if it was canceled before."""
        self._go(Transition.ACCEPT, text)

    def set_canceled(self, result: Any = None, text: str = "") -> None:
        """End a canceled goal: it becomes PREEMPTED, or RECALLED if it was not accepted."""
        self._end(Transition.CANCEL, result, text)

    def set_rejected(self, result: Any = None, text: str = "") -> None:
        """Reject the goal."""
        self._end(Transition.REJECT, result, text)

    def set_aborted(self, result: Any = None, text: str = "") -> None:
        """Abort the goal."""
        self._end(Transition.ABORT, result, text)

    def set_succeeded(self, result: Any = None, text: str = "") -> None:
        """End the goal successfully."""
        self._end(Transition.SUCCEED, result, text)

    def publish_feedback(self, feedback: Any) -> None:
        """Publish feedback for the goal's client."""
        if self._record is None or self._server is None:
            rospy.logerr("Attempt to publish feedback on an uninitialized ServerGoalHandle")
            return
        with self._server.lock:
            self._server.publish_feedback(goal_status(self._record), feedback)

    def set_cancel_requested(self) -> bool:
        """Note that the goal is to be canceled; return False if its state does not allow it."""
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
        description, state, allowed = _TRANSITIONS[transition]
        with self._server.lock:
            record = self._record
            rospy.logdebug("%s, id: %s, stamp: %.2f", description, record.id, record.stamp / 1e9)
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


def goal_id(record: GoalRecord) -> Any:
    """Return a goal's ``GoalID``."""
    return GoalID(stamp=rospy.Time(*divmod(record.stamp, 1_000_000_000)), id=record.id)


def goal_status(record: GoalRecord) -> Any:
    """Return a goal's state as an ``actionlib_msgs/GoalStatus``."""
    return GoalStatus(goal_id=goal_id(record), status=int(record.status), text=record.text)
