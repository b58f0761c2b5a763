"""An action client that follows each goal by its handle."""

from __future__ import annotations

import threading
from collections.abc import Callable
from itertools import count
from typing import Any
from weakref import WeakValueDictionary

import rospy
from actionlib_msgs.msg import GoalID, GoalStatus, GoalStatusArray

from actionlib.action_spec import read_spec
from actionlib.client_goal_handle import ClientGoalHandle, CommStateMachine
from actionlib.comm_state import CommState, TerminalState, get_name_of_constant
from actionlib.exceptions import ActionException

__all__ = [
    "ActionClient",
    "ActionException",
    "ClientGoalHandle",
    "CommState",
    "CommStateMachine",
    "GoalID",
    "GoalStatus",
    "GoalStatusArray",
    "TerminalState",
    "get_name_of_constant",
]

QUEUE_SIZE = 10
"""Default number of goals and cancel requests to queue for a slow server."""

INTERVAL = 0.05
"""Seconds between two checks whether the server is connected."""

_goals = count(1)

Transition = Callable[[ClientGoalHandle], object]
Feedback = Callable[[ClientGoalHandle, Any], object]


class ActionClient:
    """Sends goals to ``<ns>/goal``, any number at a time.

    Callbacks are called in the threads of the topics ``status``, ``result`` and ``feedback``.

    Args:
        ns: the action's name.
        ActionSpec: the action's type, such as ``FibonacciAction``.

    Raises:
        ActionException: ``ActionSpec`` is not an action.
    """

    def __init__(self, ns: str, ActionSpec: Any) -> None:
        spec = read_spec(ActionSpec)
        self.ns = ns
        self.ActionSpec = ActionSpec
        self.ActionGoal = spec.goal
        self.ActionResult = spec.result
        self.ActionFeedback = spec.feedback
        self.last_status_msg: Any = None
        self._status_received = threading.Condition()
        self._goals: WeakValueDictionary[str, CommStateMachine] = WeakValueDictionary()
        """The goals that still have handles, by id."""

        name = rospy.remap_name(ns)
        self.pub_queue_size = rospy.get_param("actionlib_client_pub_queue_size", QUEUE_SIZE)
        if self.pub_queue_size < 0:
            self.pub_queue_size = QUEUE_SIZE
        self.sub_queue_size = rospy.get_param("actionlib_client_sub_queue_size", -1)
        if self.sub_queue_size < 0:
            self.sub_queue_size = None
        self.pub_goal = rospy.Publisher(
            f"{name}/goal", self.ActionGoal, queue_size=self.pub_queue_size
        )
        self.pub_cancel = rospy.Publisher(f"{name}/cancel", GoalID, queue_size=self.pub_queue_size)
        self.status_sub = self._subscribe(f"{name}/status", GoalStatusArray, self._status_cb)
        self.result_sub = self._subscribe(f"{name}/result", self.ActionResult, self._result_cb)
        self.feedback_sub = self._subscribe(
            f"{name}/feedback", self.ActionFeedback, self._feedback_cb
        )

    def stop(self) -> None:
        """Unregister all topics."""
        self.pub_goal.unregister()
        self.pub_cancel.unregister()
        self.status_sub.unregister()
        self.result_sub.unregister()
        self.feedback_sub.unregister()

    def send_goal(
        self,
        goal: Any,
        transition_cb: Transition | None = None,
        feedback_cb: Feedback | None = None,
    ) -> ClientGoalHandle:
        """Send a goal, such as a ``FibonacciGoal``, and follow it while a handle of it exists.

        Args:
            transition_cb: called with a handle of the goal each time its state changes.
            feedback_cb: called with a handle of the goal and each feedback.
        """
        handle = self.make_goal(goal, transition_cb, feedback_cb)
        self.pub_goal.publish(handle.comm_state_machine.action_goal)
        return handle

    def make_goal(
        self, goal: Any, transition_cb: Transition | None, feedback_cb: Feedback | None
    ) -> ClientGoalHandle:
        """Create a goal's handle as `send_goal` does, without sending the goal."""
        now = rospy.Time.now()
        name = f"{rospy.get_caller_id()}-{next(_goals)}-{now.to_sec():.3f}"
        message = self.ActionGoal(goal_id=GoalID(id=name, stamp=now), goal=goal)
        message.header.stamp = now
        machine = CommStateMachine(message, transition_cb, feedback_cb, self.pub_cancel.publish)
        self._goals[name] = machine
        return ClientGoalHandle(machine)

    def cancel_all_goals(self) -> None:
        """Cancel the goals of all clients."""
        self.pub_cancel.publish(GoalID())

    def cancel_goals_at_and_before_time(self, time: Any) -> None:
        """Cancel the goals sent up to a time."""
        self.pub_cancel.publish(GoalID(stamp=time))

    def wait_for_server(self, timeout: Any = None) -> bool:
        """Wait until the server is connected with this client.

        Args:
            timeout: maximum ``Duration`` to wait; zero or None for no limit.

        Returns:
            Whether it is connected; False if the node ends.
        """
        timeout = rospy.Duration() if timeout is None else timeout
        end = rospy.get_rostime() + timeout
        with self._status_received:
            while not rospy.is_shutdown():
                if self._is_connected():
                    return True
                if timeout != rospy.Duration() and rospy.get_rostime() >= end:
                    return False
                self._status_received.wait(INTERVAL)
        return False

    def wait_for_action_server_to_start(self, timeout: Any = None) -> bool:
        """Call `wait_for_server`; its former name."""
        return self.wait_for_server(timeout)

    def _is_connected(self) -> bool:
        """Return whether a status was received, and each topic has a publisher or a subscriber.

        A server publishes statuses only after it has subscribed to goals.
        """
        return self.last_status_msg is not None and all(
            topic.get_num_connections() > 0
            for topic in (self.pub_goal, self.pub_cancel, self.result_sub, self.feedback_sub)
        )

    def _subscribe(self, topic: str, type_: Any, callback: Callable[[Any], object]) -> Any:
        return rospy.Subscriber(topic, type_, callback=callback, queue_size=self.sub_queue_size)

    def _status_cb(self, message: Any) -> None:
        with self._status_received:
            self.last_status_msg = message
            self._status_received.notify_all()
        listed = {status.goal_id.id: status for status in message.status_list}
        for name, machine in list(self._goals.items()):
            machine.update_status(listed.get(name))

    def _result_cb(self, message: Any) -> None:
        machine = self._goals.get(message.status.goal_id.id)
        if machine is not None:
            machine.update_result(message)

    def _feedback_cb(self, message: Any) -> None:
        machine = self._goals.get(message.status.goal_id.id)
        if machine is not None:
            machine.update_feedback(message)
