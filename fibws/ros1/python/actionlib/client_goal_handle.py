"""A client's handle of a goal, and the state of the goal."""

from __future__ import annotations

import threading
from collections.abc import Callable
from typing import Any

import rospy
from actionlib_msgs.msg import GoalID, GoalStatus

from actionlib.comm_state import FINAL, CommState, following


class CommStateMachine:
    """The state of one goal, as far as its client knows it.

    Args:
        action_goal: the goal's message, an ``...ActionGoal``.
        transition_cb: called with a handle of the goal each time its state changes.
        feedback_cb: called with a handle of the goal and each feedback.
        send_cancel_fn: sends a ``GoalID`` to the server to cancel the goal.
    """

    def __init__(
        self,
        action_goal: Any,
        transition_cb: Callable[[ClientGoalHandle], object] | None,
        feedback_cb: Callable[[ClientGoalHandle, Any], object] | None,
        send_cancel_fn: Callable[[Any], object],
    ) -> None:
        self.action_goal = action_goal
        self.transition_cb = transition_cb
        self.feedback_cb = feedback_cb
        self.send_cancel_fn = send_cancel_fn
        self.state = CommState.WAITING_FOR_GOAL_ACK
        self.mutex = threading.RLock()
        self.latest_goal_status = GoalStatus(status=GoalStatus.PENDING)
        self.latest_result: Any = None

    @property
    def id(self) -> str:
        """The goal's id."""
        return str(self.action_goal.goal_id.id)

    def update_status(self, status: Any) -> None:
        """Process the goal's status in the server's list, or None if it is not in the list.

        A goal that was listed before and has no result is lost then.
        """
        with self.mutex:
            if self.state == CommState.DONE:
                return
            if status is not None:
                self._follow(status)
            elif self.state not in (
                CommState.WAITING_FOR_GOAL_ACK,
                CommState.WAITING_FOR_RESULT,
            ):
                self.latest_goal_status = GoalStatus(
                    goal_id=self.action_goal.goal_id, status=GoalStatus.LOST
                )
                self.transition_to(CommState.DONE)

    def update_result(self, action_result: Any) -> None:
        """Process the goal's result, an ``...ActionResult``."""
        with self.mutex:
            if self.state == CommState.DONE:
                rospy.logerr("Got a result when we were already in the DONE state")
                return
            self.latest_result = action_result
            self._follow(action_result.status)
            self.transition_to(CommState.DONE)

    def update_feedback(self, action_feedback: Any) -> None:
        """Process feedback, an ``...ActionFeedback``."""
        if self.feedback_cb is not None and self.state != CommState.DONE:
            self.feedback_cb(ClientGoalHandle(self), action_feedback.feedback)

    def transition_to(self, state: int) -> None:
        """Change the state."""
        rospy.logdebug(
            "Transitioning to %s (from %s, goal: %s)",
            CommState.to_string(state),
            CommState.to_string(self.state),
            self.id,
        )
        self.state = state
        if self.transition_cb is not None:
            self.transition_cb(ClientGoalHandle(self))

    def _follow(self, status: Any) -> None:
        self.latest_goal_status = status
        try:
            route = following(self.state, status.status)
        except KeyError:
            rospy.logerr(f"Got an unknown status from the ActionServer: {status.status}")
            return
        if route is None:
            rospy.logerr(
                f"Invalid goal status transition from {CommState.to_string(self.state)} "
                f"to {GoalStatus.to_string(status.status)}"
            )
            return
        for state in route:
            self.transition_to(state)


class ClientGoalHandle:
    """A client's handle of a goal; two handles of the same goal are equal.

    The client follows the goal while a handle of it exists.
    """

    def __init__(self, comm_state_machine: CommStateMachine) -> None:
        self.comm_state_machine = comm_state_machine

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, ClientGoalHandle):
            return False
        return self.comm_state_machine.id == other.comm_state_machine.id

    def __hash__(self) -> int:
        return hash(self.comm_state_machine.id)

    def cancel(self) -> None:
        """Cancel the goal, unless it has ended."""
        machine = self.comm_state_machine
        with machine.mutex:
            if machine.state != CommState.DONE:
                machine.send_cancel_fn(GoalID(stamp=rospy.Time(0), id=machine.id))
                machine.transition_to(CommState.WAITING_FOR_CANCEL_ACK)

    def get_comm_state(self) -> int:
        """Return the state of the communication with the server, one of `CommState`."""
        return self.comm_state_machine.state

    def get_goal_status(self) -> int:
        """Return the latest status from the server, one of ``actionlib_msgs/GoalStatus``."""
        return int(self.comm_state_machine.latest_goal_status.status)

    def get_goal_status_text(self) -> str:
        """Return the server's text about the status."""
        return str(self.comm_state_machine.latest_goal_status.text)

    def get_result(self) -> Any:
        """Return the goal's result, such as a ``FibonacciResult``; None before the result."""
        result = self.comm_state_machine.latest_result
        return None if result is None else result.result

    def get_terminal_state(self) -> int:
        """Return the goal's final status, one of `TerminalState`; log a warning before its end."""
        machine = self.comm_state_machine
        with machine.mutex:
            if machine.state != CommState.DONE:
                rospy.logwarn(
                    "Asking for the terminal state when we're in "
                    f"[{CommState.to_string(machine.state)}]"
                )
            status = self.get_goal_status()
            if status in FINAL:
                return status
            rospy.logerr(f"Asking for a terminal state, but the goal status is {status}")
            return int(GoalStatus.LOST)
