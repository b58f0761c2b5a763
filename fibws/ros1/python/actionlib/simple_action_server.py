"""The serving end of an action that pursues one goal at a time: the latest."""

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

LOOK_AFTER = 0.1
"""Seconds after which the thread that executes goals looks whether the node has ended."""


class SimpleActionServer:
    """Pursues the latest goal; one that comes meanwhile has the one before it preempted.

    It is used in one of two ways. Either ``execute_cb`` is called in a thread of its own for each
    goal, and looks at `is_preempt_requested` now and then. Or the owner takes goals by
    `accept_new_goal` when it likes, for instance in the callback of `register_goal_callback`. Both
    say what became of a goal by `set_succeeded`, `set_aborted` or `set_preempted`.

    Args:
        name: the action's name.
        ActionSpec: the action's type, such as ``FibonacciAction``.
        execute_cb: is given each goal, such as a ``FibonacciGoal``. An exception in it aborts the
            goal, with its text.
        auto_start: whether to begin at once. A goal may then come before the owner is ready.

    Raises:
        ActionException: ``ActionSpec`` is no action.
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
        """Is taken after the action server's own, never before it."""
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
        """Begin to take goals."""
        self.action_server.start()

    def register_goal_callback(self, cb: Callable[[], object] | None) -> None:
        """Have a function called, without arguments, when a goal can be accepted."""
        if self.execute_callback is not None:
            rospy.logwarn(
                "Cannot call SimpleActionServer.register_goal_callback() because an "
                "executeCallback exists. Not going to register it."
            )
        else:
            self.goal_callback = cb

    def register_preempt_callback(self, cb: Callable[[], object] | None) -> None:
        """Have a function called, without arguments, when the current goal is to be preempted."""
        self.preempt_callback = cb

    # What the owner asks

    def is_new_goal_available(self) -> bool:
        """Whether there is a goal to accept."""
        return self.new_goal

    def is_preempt_requested(self) -> bool:
        """Whether the current goal is wanted no more, or a later one waits for its end."""
        return self.preempt_request

    def is_active(self) -> bool:
        """Whether there is a current goal that has not ended."""
        if self.current_goal.get_goal() is None:
            return False
        status = self.current_goal.get_goal_status().status
        return status in (GoalStatus.ACTIVE, GoalStatus.PREEMPTING)

    def get_default_result(self) -> Any:
        """A result whose fields are all empty."""
        return self.action_server.ActionResultType()

    # What the owner decides

    def accept_new_goal(self) -> Any:
        """Begin with the latest goal, and preempt the current one if it has not ended.

        The new goal may be wanted no more already, which `is_preempt_requested` tells.

        Returns:
            The goal, or None, with an error in the log, if there is none to accept.
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
        """Tell that the current goal was reached."""
        with self.action_server.lock, self.lock:
            self.current_goal.set_succeeded(result, text)

    def set_aborted(self, result: Any = None, text: str = "") -> None:
        """Give the current goal up."""
        with self.action_server.lock, self.lock:
            self.current_goal.set_aborted(result, text)

    def set_preempted(self, result: Any = None, text: str = "") -> None:
        """End the current goal since it is wanted no more."""
        with self.action_server.lock, self.lock:
            rospy.logdebug("Setting the current goal as canceled")
            self.current_goal.set_canceled(result, text)

    def publish_feedback(self, feedback: Any) -> None:
        """Tell the client of the current goal how far it has come."""
        self.current_goal.publish_feedback(feedback)

    # What comes from the action server, which holds its lock

    def internal_goal_callback(self, goal: ServerGoalHandle) -> None:
        """Have a goal wait to be accepted, unless one that was sent later came before it."""
        with self.execute_condition:
            rospy.logdebug(
                "A new goal %s has been received by the single goal action server",
                goal.get_goal_id().id,
            )
            try:
                self._line_up(goal)
            except Exception as error:
                rospy.logerr(f"SimpleActionServer.internal_goal_callback - exception {error}")

    def internal_preempt_callback(self, preempt: ServerGoalHandle) -> None:
        """Note that a goal is wanted no more: the current one, or the one that waits."""
        with self.lock:
            rospy.logdebug("A preempt has been received by the SimpleActionServer")
            if preempt == self.current_goal:
                self._request_preempt()
            elif preempt == self.next_goal:
                rospy.logdebug("Setting preempt request bit for the next goal to TRUE")
                self.new_goal_preempt_request = True

    def _line_up(self, goal: ServerGoalHandle) -> None:
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

    # What the thread does that executes goals

    def executeLoop(self) -> None:
        """Call ``execute_cb`` for one goal after the other until the node ends."""
        assert self.execute_callback is not None
        while not rospy.is_shutdown():
            if self.is_new_goal_available():
                goal = self.accept_new_goal()
                try:
                    self.execute_callback(goal)
                    self._check_ended()
                except Exception as error:
                    if rospy.core.is_shutdown_requested():
                        return  # What it raises then is of no interest to anybody.
                    rospy.logerr(
                        f"Exception in your execute callback: {error}\n{traceback.format_exc()}"
                    )
                    self.set_aborted(None, f"Exception in execute callback: {error}")
            with self.execute_condition:
                if not self.new_goal:
                    self.execute_condition.wait(LOOK_AFTER)

    def _check_ended(self) -> None:
        """Abort a goal that ``execute_cb`` has said nothing about."""
        if self.is_active():
            rospy.logwarn(
                "Your executeCallback did not set the goal to a terminal status.  "
                "This is a bug in your ActionServer implementation. Fix your code!  "
                "For now, the ActionServer will set this goal to aborted"
            )
            self.set_aborted(None, "No terminal state was set.")
