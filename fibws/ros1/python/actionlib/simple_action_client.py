"""The asking end of an action, for one goal at a time."""

from __future__ import annotations

import threading
from collections.abc import Callable
from typing import Any

import rospy
from actionlib_msgs.msg import GoalStatus

from actionlib.action_client import ActionClient
from actionlib.client_goal_handle import ClientGoalHandle
from actionlib.comm_state import CommState, get_name_of_constant

LOOK_AFTER = 0.1
"""Seconds after which one who waits looks whether the node has ended."""


class SimpleGoalState:
    """How far a goal has come, as far as a simple client cares."""

    PENDING = 0
    ACTIVE = 1
    DONE = 2

    to_string = classmethod(get_name_of_constant)


class SimpleActionClient:
    """Sends a goal, and follows it until it sends the next one.

    Callbacks are called in the threads of the topics ``status``, ``result`` and ``feedback``.

    Args:
        ns: the action's name.
        ActionSpec: the action's type, such as ``FibonacciAction``.

    Raises:
        ActionException: ``ActionSpec`` is no action.
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
        """Wait until the server is there and hears this client.

        Args:
            timeout: a ``Duration`` to wait at most; zero, or None, for ever.

        Returns:
            Whether it is. It is not if the node ends meanwhile.
        """
        return self.action_client.wait_for_server(timeout)

    def send_goal(
        self,
        goal: Any,
        done_cb: Callable[[int, Any], object] | None = None,
        active_cb: Callable[[], object] | None = None,
        feedback_cb: Callable[[Any], object] | None = None,
    ) -> None:
        """Send a goal, such as a ``FibonacciGoal``; one before it is followed no more.

        Args:
            done_cb: is given the goal's state at its end, of ``GoalStatus``, and its result.
            active_cb: is called, without arguments, when the server begins.
            feedback_cb: is given each feedback.
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
        """Send a goal and wait for its end; cancel it if that takes too long.

        Args:
            execute_timeout: a ``Duration`` to wait for the end; zero, or None, for ever.
            preempt_timeout: a ``Duration`` to wait for the end after the goal was canceled.

        Returns:
            The goal's state, of ``GoalStatus``.
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
            timeout: a ``Duration`` to wait at most; zero, or None, for ever.

        Returns:
            Whether it has ended. It may not have if the node does.
        """
        if self.gh is None:
            rospy.logerr("Called wait_for_result when no goal exists")
            return False
        timeout = rospy.Duration() if timeout is None else timeout
        end = rospy.get_rostime() + timeout
        with self.done_condition:
            while not rospy.is_shutdown() and self.simple_state != SimpleGoalState.DONE:
                left = LOOK_AFTER
                if timeout > rospy.Duration():
                    left = min(left, (end - rospy.get_rostime()).to_sec())
                    if left <= 0:
                        break
                self.done_condition.wait(left)
        return self.simple_state == SimpleGoalState.DONE

    def get_result(self) -> Any:
        """The goal's result, such as a ``FibonacciResult``; None if it has not come."""
        if self.gh is None:
            rospy.logerr("Called get_result when no goal is running")
            return None
        return self.gh.get_result()

    def get_state(self) -> int:
        """The goal's state, of ``GoalStatus``: LOST if there is none.

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
        """Why the goal is in this state, in the server's words."""
        if self.gh is None:
            rospy.logerr("Called get_goal_status_text when no goal is running")
            return "ERROR: Called get_goal_status_text when no goal is running"
        return self.gh.get_goal_status_text()

    def cancel_all_goals(self) -> None:
        """Tell the server that no goal is wanted any more, of whichever client."""
        self.action_client.cancel_all_goals()

    def cancel_goals_at_and_before_time(self, time: Any) -> None:
        """Tell the server that the goals sent up to a time are wanted no more."""
        self.action_client.cancel_goals_at_and_before_time(time)

    def cancel_goal(self) -> None:
        """Tell the server that the goal is wanted no more; does nothing after its end."""
        if self.gh is not None:
            self.gh.cancel()

    def stop_tracking_goal(self) -> None:
        """Hear no more of the goal, which goes on."""
        self.gh = None

    # What is heard of the goal

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
        """Let the owner know that the goal has ended, and those who wait for it thereafter."""
        try:
            if self.done_cb is not None:
                self.done_cb(gh.get_goal_status(), gh.get_result())
        finally:
            with self.done_condition:
                if gh == self.gh:  # Else the callback has sent another one.
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
