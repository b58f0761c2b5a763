"""A server of an action that executes one goal at a time: the latest."""

from __future__ import annotations

import threading
import traceback
from collections.abc import Callable
from typing import Any

import rospy
from actionlib_msgs.msg import GoalStatus

from actionlib.action_server import ActionServer
from actionlib.server_goal_handle import ServerGoalHandle

SUPERSEDED = "This goal was canceled because another goal was received by the simple action server"

INTERVAL = 0.1
"""Seconds between two checks by the thread that executes goals whether the node has ended."""


class SimpleActionServer:
    """Executes the latest goal; a new goal preempts the previous one.

    There are two ways to use it. With ``execute_cb``, this function is called for each goal in a
    thread of its own, and should check `is_preempt_requested` regularly. Without it, the program
    calls `accept_new_goal`, for example in the callback of `register_goal_callback`. Both end a
    goal by `set_succeeded`, `set_aborted` or `set_preempted`.

    Args:
        name: the action's name.
        ActionSpec: the action's type, such as ``FibonacciAction``.
        execute_cb: called with each goal, such as a ``FibonacciGoal``. An exception aborts the goal
            with its text.
        auto_start: start at once. A goal may then arrive before the program is ready.

    Raises:
        ActionException: ``ActionSpec`` is not an action.
    """

    def __init__(
        self,
        name: str,
        ActionSpec: Any,
        execute_cb: Callable[[Any], object] | None = None,
        auto_start: bool = True,
    ) -> None:
        self.new_goal = False
        self.preempt_request = False
        self.new_goal_preempt_request = False
        self.execute_callback = execute_cb
        self.goal_callback: Callable[[], object] | None = None
        self.preempt_callback: Callable[[], object] | None = None
        self.lock = threading.RLock()
        """Always acquired after the action server's lock."""
        self.execute_condition = threading.Condition(self.lock)
        self.current_goal = ServerGoalHandle()
        self.next_goal = ServerGoalHandle()
        self.action_server = ActionServer(
            name,
            ActionSpec,
            self.internal_goal_callback,
            self.internal_preempt_callback,
            auto_start,
        )
        self.execute_thread: threading.Thread | None = None
        if execute_cb is not None:
            self.execute_thread = threading.Thread(target=self.executeLoop, name=f"{name} execute")
            self.execute_thread.start()

    def start(self) -> None:
        """Start to receive goals."""
        self.action_server.start()

    def register_goal_callback(self, cb: Callable[[], object] | None) -> None:
        """Call a function without arguments when a goal can be accepted."""
        if self.execute_callback is not None:
            rospy.logwarn(
                "Cannot call SimpleActionServer.register_goal_callback() because an "
                "executeCallback exists. Not going to register it."
            )
        else:
            self.goal_callback = cb

    def register_preempt_callback(self, cb: Callable[[], object] | None) -> None:
        """Call a function without arguments when the current goal is to be preempted."""
        self.preempt_callback = cb

    # State

    def is_new_goal_available(self) -> bool:
        """Return whether a goal can be accepted."""
        return self.new_goal

    def is_preempt_requested(self) -> bool:
        """Return whether the current goal was canceled, or a newer goal waits for its end."""
        return self.preempt_request

    def is_active(self) -> bool:
        """Return whether the current goal has not ended."""
        if self.current_goal.get_goal() is None:
            return False
        status = self.current_goal.get_goal_status().status
        return status in (GoalStatus.ACTIVE, GoalStatus.PREEMPTING)

    def get_default_result(self) -> Any:
        """Return an empty result."""
        return self.action_server.ActionResultType()

    # Transitions of the current goal

    def accept_new_goal(self) -> Any:
        """Accept the latest goal, and preempt the current one if it has not ended.

        The new goal may have been canceled already: check `is_preempt_requested`.

        Returns:
            The goal; None, after an error in the log, if there is no goal to accept.
        """
        with self.action_server.lock, self.lock:
            if not self.new_goal or self.next_goal.get_goal() is None:
                rospy.logerr("Attempting to accept the next goal when a new goal is not available")
                return None
            if self.is_active() and self.current_goal != self.next_goal:
                self.current_goal.set_canceled(None, SUPERSEDED)
            rospy.logdebug("Accepting a new goal")
            self.current_goal = self.next_goal
            self.new_goal = False
            self.preempt_request = self.new_goal_preempt_request
            self.new_goal_preempt_request = False
            self.current_goal.set_accepted(
                "This goal has been accepted by the simple action server"
            )
            return self.current_goal.get_goal()

    def set_succeeded(self, result: Any = None, text: str = "") -> None:
        """End the current goal successfully."""
        with self.action_server.lock, self.lock:
            self.current_goal.set_succeeded(result, text)

    def set_aborted(self, result: Any = None, text: str = "") -> None:
        """Abort the current goal."""
        with self.action_server.lock, self.lock:
            self.current_goal.set_aborted(result, text)

    def set_preempted(self, result: Any = None, text: str = "") -> None:
        """End the current goal after a request to preempt it."""
        with self.action_server.lock, self.lock:
            rospy.logdebug("Setting the current goal as canceled")
            self.current_goal.set_canceled(result, text)

    def publish_feedback(self, feedback: Any) -> None:
        """Publish feedback about the current goal."""
        self.current_goal.publish_feedback(feedback)

    # Callbacks of the action server, which holds its lock

    def internal_goal_callback(self, goal: ServerGoalHandle) -> None:
        """Keep a goal to be accepted, unless a goal with a later stamp is known."""
        with self.execute_condition:
            rospy.logdebug(
                "A new goal %s has been received by the single goal action server",
                goal.get_goal_id().id,
            )
            try:
                self._add(goal)
            except Exception as error:
                rospy.logerr(f"SimpleActionServer.internal_goal_callback - exception {error}")

    def internal_preempt_callback(self, preempt: ServerGoalHandle) -> None:
        """Note that the current or the next goal was canceled."""
        with self.lock:
            rospy.logdebug("A preempt has been received by the SimpleActionServer")
            if preempt == self.current_goal:
                self._request_preempt()
            elif preempt == self.next_goal:
                rospy.logdebug("Setting preempt request bit for the next goal to TRUE")
                self.new_goal_preempt_request = True

    def _add(self, goal: ServerGoalHandle) -> None:
        if self._is_outdated(goal):
            goal.set_canceled(None, SUPERSEDED)
            return
        if self.next_goal.get_goal() is not None and self.next_goal != self.current_goal:
            self.next_goal.set_canceled(None, SUPERSEDED)
        self.next_goal = goal
        self.new_goal = True
        self.new_goal_preempt_request = False
        if self.is_active():
            self._request_preempt()
        if self.goal_callback is not None:
            self.goal_callback()
        self.execute_condition.notify()

    def _is_outdated(self, goal: ServerGoalHandle) -> bool:
        stamp = goal.get_goal_id().stamp
        return any(
            stamp < other.get_goal_id().stamp
            for other in (self.current_goal, self.next_goal)
            if other.get_goal() is not None
        )

    def _request_preempt(self) -> None:
        rospy.logdebug(
            "Setting preempt_request bit for the current goal to TRUE and invoking callback"
        )
        self.preempt_request = True
        if self.preempt_callback is not None:
            self.preempt_callback()

    # In the thread that executes goals

    def executeLoop(self) -> None:
        """Call ``execute_cb`` for each goal until the node ends."""
        assert self.execute_callback is not None
        while not rospy.is_shutdown():
            if self.is_new_goal_available():
                goal = self.accept_new_goal()
                try:
                    self.execute_callback(goal)
                    self._check_ended()
                except Exception as error:
                    if rospy.core.is_shutdown_requested():
                        return  # Errors during shutdown are not reported.
                    rospy.logerr(
                        f"Exception in your execute callback: {error}\n{traceback.format_exc()}"
                    )
                    self.set_aborted(None, f"Exception in execute callback: {error}")
            with self.execute_condition:
                if not self.new_goal:
                    self.execute_condition.wait(INTERVAL)

    def _check_ended(self) -> None:
        """Abort a goal that ``execute_cb`` has not ended."""
        if self.is_active():
            rospy.logwarn(
                "Your executeCallback did not set the goal to a terminal status.  "
                "This is a bug in your ActionServer implementation. Fix your code!  "
                "For now, the ActionServer will set this goal to aborted"
            )
            self.set_aborted(None, "No terminal state was set.")
