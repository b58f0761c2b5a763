"""The asking end of an action, whose owner follows each goal by its handle."""

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
"""How many goals or cancels wait for a slow server, unless a parameter says otherwise."""

LOOK_AFTER = 0.05
"""Seconds after which one who waits looks again whether the server is connected."""

_goals = count(1)

Transition = Callable[[ClientGoalHandle], object]
Feedback = Callable[[ClientGoalHandle, Any], object]


class ActionClient:
    """Sends goals to ``<ns>/goal``, as many at once as one likes.

    Callbacks are called in the threads of the topics ``status``, ``result`` and ``feedback``.

    Args:
        ns: the action's name.
        ActionSpec: the action's type, such as ``FibonacciAction``.

    Raises:
        ActionException: ``ActionSpec`` is no action.
    """

    def __init__(self, ns: str, ActionSpec: Any) -> None:
        spec = read_spec(ActionSpec)
        self.ns = ns
        self.ActionSpec = ActionSpec
        self.ActionGoal = spec.goal
        self.ActionResult = spec.result
        self.ActionFeedback = spec.feedback
        self.last_status_msg: Any = None
        self._heard = threading.Condition()
        self._goals: WeakValueDictionary[str, CommStateMachine] = WeakValueDictionary()
        """Those that somebody still has a handle of."""

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
        self.status_sub = self._listen(f"{name}/status", GoalStatusArray, self._status_cb)
        self.result_sub = self._listen(f"{name}/result", self.ActionResult, self._result_cb)
        self.feedback_sub = self._listen(f"{name}/feedback", self.ActionFeedback, self._feedback_cb)

    def stop(self) -> None:
        """Send no more goals, and hear of none."""
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
        """Send a goal, such as a ``FibonacciGoal``, and follow it as long as there is a handle.

        Args:
            transition_cb: is given a handle of the goal each time its state changes.
            feedback_cb: is given a handle of the goal and each feedback.
        """
        handle = self.make_goal(goal, transition_cb, feedback_cb)
        self.pub_goal.publish(handle.comm_state_machine.action_goal)
        return handle

    def make_goal(
        self, goal: Any, transition_cb: Transition | None, feedback_cb: Feedback | None
    ) -> ClientGoalHandle:
        """What `send_goal` returns, for one who has to have it before anything is heard."""
        now = rospy.Time.now()
        name = f"{rospy.get_caller_id()}-{next(_goals)}-{now.to_sec():.3f}"
        message = self.ActionGoal(goal_id=GoalID(id=name, stamp=now), goal=goal)
        message.header.stamp = now
        machine = CommStateMachine(message, transition_cb, feedback_cb, self.pub_cancel.publish)
        self._goals[name] = machine
        return ClientGoalHandle(machine)

    def cancel_all_goals(self) -> None:
        """Tell the server that no goal is wanted any more, of whichever client."""
        self.pub_cancel.publish(GoalID())

    def cancel_goals_at_and_before_time(self, time: Any) -> None:
        """Tell the server that the goals sent up to a time are wanted no more."""
        self.pub_cancel.publish(GoalID(stamp=time))

    def wait_for_server(self, timeout: Any = None) -> bool:
        """Wait until the server is there and hears this client.

        Args:
            timeout: a ``Duration`` to wait at most; zero, or None, for ever.

        Returns:
            Whether it is. It is not if the node ends meanwhile.
        """
        timeout = rospy.Duration() if timeout is None else timeout
        end = rospy.get_rostime() + timeout
        with self._heard:
            while not rospy.is_shutdown():
                if self._is_connected():
                    return True
                if timeout != rospy.Duration() and rospy.get_rostime() >= end:
                    return False
                self._heard.wait(LOOK_AFTER)
        return False

    def wait_for_action_server_to_start(self, timeout: Any = None) -> bool:
        """The old name of `wait_for_server`."""
        return self.wait_for_server(timeout)

    def _is_connected(self) -> bool:
        """Whether the server has spoken, and there is somebody at the other end of each topic.

        A server speaks only after it has begun to listen.
        """
        return self.last_status_msg is not None and all(
            end.get_num_connections() > 0
            for end in (self.pub_goal, self.pub_cancel, self.result_sub, self.feedback_sub)
        )

    def _listen(self, topic: str, type_: Any, callback: Callable[[Any], object]) -> Any:
        return rospy.Subscriber(topic, type_, callback=callback, queue_size=self.sub_queue_size)

    def _status_cb(self, message: Any) -> None:
        with self._heard:
            self.last_status_msg = message
            self._heard.notify_all()
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
