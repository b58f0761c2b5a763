"""A client of an action that follows one goal at a time."""

from __future__ import annotations

import threading
from collections.abc import Callable
from typing import Any

import rospy
from actionlib_msgs.msg import GoalStatus

from actionlib.action_client import ActionClient
from actionlib.client_goal_handle import ClientGoalHandle
from actionlib.comm_state import CommState, get_name_of_constant

INTERVAL = 0.1
"""Seconds between two checks whether the node has ended."""


class SimpleGoalState:
    """The state of a goal for a simple client."""

    PENDING = 0
    ACTIVE = 1
    DONE = 2

    to_string = classmethod(get_name_of_constant)


class SimpleActionClient:
    """Sends goals, and follows the latest one.

    Callbacks are called in the threads of the topics ``status``, ``result`` and ``feedback``.

    Args:
        ns: the action's name.
        ActionSpec: the action's type, such as ``FibonacciAction``.

    Raises:
        ActionException: ``ActionSpec`` is not an action.
    """

    def __init__(self, ns: str, ActionSpec: Any) -> None:
        self.action_client = ActionClient(ns, ActionSpec)
        self.simple_state = SimpleGoalState.DONE
        self.gh: ClientGoalHandle | None = None
        self.done_condition = threading.Condition()
        self.done_cb: Callable[[int, Any], object] | None = None
        self.active_cb: Callable[[], object] | None = None
        self.feedback_cb: Callable[[Any], object] | None = None

    def wait_for_server(self, timeout: Any = None) -> bool:
        """Wait until the server is connected with this client.

        Args:
            timeout: maximum ``Duration`` to wait; zero or None for no limit.

        Returns:
            Whether it is connected; False if the node ends.
        """
        return self.action_client.wait_for_server(timeout)

    def send_goal(
        self,
        goal: Any,
        done_cb: Callable[[int, Any], object] | None = None,
        active_cb: Callable[[], object] | None = None,
        feedback_cb: Callable[[Any], object] | None = None,
    ) -> None:
        """Send a goal, such as a ``FibonacciGoal``, and stop following the previous one.

        Args:
            done_cb: called at the goal's end with its final ``GoalStatus`` and its result.
            active_cb: called without arguments when the server accepts the goal.
            feedback_cb: called with each feedback.
        """
        self.stop_tracking_goal()
        self.done_cb = done_cb
        self.active_cb = active_cb
        self.feedback_cb = feedback_cb
        self.simple_state = SimpleGoalState.PENDING
        self.gh = self.action_client.make_goal(goal, self._handle_transition, self._handle_feedback)
        self.action_client.pub_goal.publish(self.gh.comm_state_machine.action_goal)

    def send_goal_and_wait(
        self, goal: Any, execute_timeout: Any = None, preempt_timeout: Any = None
    ) -> int:
        """Send a goal and wait for its end; cancel it after a timeout.

        Args:
            execute_timeout: maximum ``Duration`` to wait; zero or None for no limit.
            preempt_timeout: maximum ``Duration`` to wait after the goal was canceled.

        Returns:
            The goal's state, see `get_state`.
        """
        self.send_goal(goal)
        if not self.wait_for_result(execute_timeout):
            rospy.logdebug("Canceling goal")
            self.cancel_goal()
            limit = 0.0 if preempt_timeout is None else preempt_timeout.to_sec()
            if self.wait_for_result(preempt_timeout):
                rospy.logdebug("Preempt finished within specified preempt_timeout [%.2f]", limit)
            else:
                rospy.logdebug("Preempt didn't finish specified preempt_timeout [%.2f]", limit)
        return self.get_state()

    def wait_for_result(self, timeout: Any = None) -> bool:
        """Wait until the goal ends.

        Args:
            timeout: maximum ``Duration`` to wait; zero or None for no limit.

        Returns:
            Whether it has ended; False if the node ends before.
        """
        if self.gh is None:
            rospy.logerr("Called wait_for_result when no goal exists")
            return False
        timeout = rospy.Duration() if timeout is None else timeout
        end = rospy.get_rostime() + timeout
        with self.done_condition:
            while not rospy.is_shutdown() and self.simple_state != SimpleGoalState.DONE:
                left = INTERVAL
                if timeout > rospy.Duration():
                    left = min(left, (end - rospy.get_rostime()).to_sec())
                    if left <= 0:
                        break
                self.done_condition.wait(left)
        return self.simple_state == SimpleGoalState.DONE

    def get_result(self) -> Any:
        """Return the goal's result, such as a ``FibonacciResult``; None before the result."""
        if self.gh is None:
            rospy.logerr("Called get_result when no goal is running")
            return None
        return self.gh.get_result()

    def get_state(self) -> int:
        """Return the goal's ``GoalStatus``, or LOST without a goal.

        RECALLING counts as PENDING, and PREEMPTING as ACTIVE.
        """
        if self.gh is None:
            return int(GoalStatus.LOST)
        status = self.gh.get_goal_status()
        if status == GoalStatus.RECALLING:
            return int(GoalStatus.PENDING)
        if status == GoalStatus.PREEMPTING:
            return int(GoalStatus.ACTIVE)
        return status

    def get_goal_status_text(self) -> str:
        """Return the server's text about the goal's status."""
        if self.gh is None:
            rospy.logerr("Called get_goal_status_text when no goal is running")
            return "ERROR: Called get_goal_status_text when no goal is running"
        return self.gh.get_goal_status_text()

    def cancel_all_goals(self) -> None:
        """Cancel the goals of all clients."""
        self.action_client.cancel_all_goals()

    def cancel_goals_at_and_before_time(self, time: Any) -> None:
        """Cancel the goals sent up to a time."""
        self.action_client.cancel_goals_at_and_before_time(time)

    def cancel_goal(self) -> None:
        """Cancel the goal, unless it has ended."""
        if self.gh is not None:
            self.gh.cancel()

    def stop_tracking_goal(self) -> None:
        """Stop following the goal, which is not canceled."""
        self.gh = None

    # Messages about the goal

    def _handle_transition(self, gh: ClientGoalHandle) -> None:
        if gh != self.gh:
            rospy.logerr("Got a transition callback on a goal handle that we're not tracking")
            return
        match gh.get_comm_state():
            case CommState.ACTIVE | CommState.PREEMPTING if (
                self.simple_state == SimpleGoalState.PENDING
            ):
                self.simple_state = SimpleGoalState.ACTIVE
                if self.active_cb is not None:
                    self.active_cb()
            case CommState.DONE:
                self._finish(gh)

    def _finish(self, gh: ClientGoalHandle) -> None:
        """Call ``done_cb``, and then wake the threads that wait for the goal's end."""
        try:
            if self.done_cb is not None:
                self.done_cb(gh.get_goal_status(), gh.get_result())
        finally:
            with self.done_condition:
                if gh == self.gh:  # Otherwise the callback has sent another goal.
                    self.simple_state = SimpleGoalState.DONE
                    self.done_condition.notify_all()

    def _handle_feedback(self, gh: ClientGoalHandle, feedback: Any) -> None:
        if self.gh is None:
            return
        if gh != self.gh:
            rospy.logerr(
                "Got a feedback callback on a goal handle that we're not tracking. "
                f"{self.gh.comm_state_machine.id} vs {gh.comm_state_machine.id}"
            )
            return
        if self.feedback_cb is not None:
            self.feedback_cb(feedback)
