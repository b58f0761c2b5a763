"""An action server that processes each goal by its handle."""

from __future__ import annotations

import threading
from collections.abc import Callable
from time import monotonic
from typing import Any

import rospy
from actionlib_msgs.msg import GoalID, GoalStatusArray

from actionlib.action_spec import read_spec
from actionlib.goal_id_generator import GoalIDGenerator
from actionlib.server_goal_handle import ServerGoalHandle, goal_id, goal_status
from fibws.node.actions.status import KEPT, GoalRecord, Records

QUEUE_SIZE = 50
"""Default number of messages of a topic to queue for slow clients."""

STATUS_FREQUENCY = 5.0
"""Default rate in Hz at which the status of all goals is published."""


def nop_cb(goal_handle: ServerGoalHandle) -> None:
    """Do nothing when a goal is canceled."""


class ActionServer:
    """Receives goals from ``<ns>/goal``, and passes them to callbacks.

    Callbacks are called while ``lock`` is held, one at a time.

    Args:
        ns: the action's name.
        ActionSpec: the action's type, such as ``FibonacciAction``.
        goal_cb: called with the handle of each new goal.
        cancel_cb: called with the handle of each goal to cancel.
        auto_start: start at once. A goal may then arrive before the program is ready.

    Raises:
        ActionException: ``ActionSpec`` is not an action.
    """

    def __init__(
        self,
        ns: str,
        ActionSpec: Any,
        goal_cb: Callable[[ServerGoalHandle], object],
        cancel_cb: Callable[[ServerGoalHandle], object] = nop_cb,
        auto_start: bool = True,
    ) -> None:
        spec = read_spec(ActionSpec)
        self.ns = ns
        self.ActionSpec = ActionSpec
        self.ActionGoal = spec.goal
        self.ActionResult = spec.result
        self.ActionResultType = spec.plain_result
        self.ActionFeedback = spec.feedback
        self.lock = threading.RLock()
        self.goal_callback = goal_cb
        self.cancel_callback = cancel_cb
        self.auto_start = auto_start
        self.started = False
        self.id_generator = GoalIDGenerator()
        self.status_timer: Any = None
        self._records = Records()
        self._handles: dict[str, ServerGoalHandle] = {}
        """The handles of the goals that have not ended, by their ids."""
        if auto_start:
            rospy.logwarn(
                "You've passed in true for auto_start to the python action server, you should "
                "always pass in false to avoid race conditions."
            )
            self.start()

    def register_goal_callback(self, cb: Callable[[ServerGoalHandle], object]) -> None:
        """Replace the callback for new goals."""
        self.goal_callback = cb

    def register_cancel_callback(self, cancel_cb: Callable[[ServerGoalHandle], object]) -> None:
        """Replace the callback for goals to cancel."""
        self.cancel_callback = cancel_cb

    def start(self) -> None:
        """Start to receive goals."""
        with self.lock:
            self.initialize()
            self.started = True
            self.publish_status()

    def stop(self) -> None:
        """Unregister all topics; clients learn no more about unfinished goals."""
        with self.lock:
            self.started = False
            if self.status_timer is not None:
                self.status_timer.shutdown()
            self.goal_sub.unregister()
            self.cancel_sub.unregister()
            self.status_pub.unregister()
            self.feedback_pub.unregister()
            self.result_pub.unregister()

    def initialize(self) -> None:
        """Register the action's topics, with the settings in the parameters."""
        name = rospy.remap_name(self.ns)
        self.pub_queue_size = rospy.get_param("actionlib_server_pub_queue_size", QUEUE_SIZE)
        if self.pub_queue_size < 0:
            self.pub_queue_size = QUEUE_SIZE
        self.sub_queue_size = rospy.get_param("actionlib_server_sub_queue_size", -1)
        if self.sub_queue_size < 0:
            self.sub_queue_size = None
        self._records.kept = rospy.get_param(f"{name}/status_list_timeout", KEPT)
        self.status_frequency = self._status_frequency(name)

        self.status_pub = rospy.Publisher(
            f"{name}/status", GoalStatusArray, latch=True, queue_size=self.pub_queue_size
        )
        self.result_pub = rospy.Publisher(
            f"{name}/result", self.ActionResult, queue_size=self.pub_queue_size
        )
        self.feedback_pub = rospy.Publisher(
            f"{name}/feedback", self.ActionFeedback, queue_size=self.pub_queue_size
        )
        self.goal_sub = rospy.Subscriber(
            f"{name}/goal",
            self.ActionGoal,
            callback=self.internal_goal_callback,
            queue_size=self.sub_queue_size,
        )
        self.cancel_sub = rospy.Subscriber(
            f"{name}/cancel",
            GoalID,
            callback=self.internal_cancel_callback,
            queue_size=self.sub_queue_size,
        )
        if self.status_frequency > 0.0:
            period = rospy.Duration(1.0 / self.status_frequency)
            self.status_timer = rospy.Timer(period, self.publish_status_async)

    # Messages of clients

    def internal_goal_callback(self, goal: Any) -> None:
        """Process an ``...ActionGoal``; a missing id or time is generated.

        A goal that is known already is ignored; one that was canceled before ends at once.
        """
        with self.lock:
            if not self.started:
                return
            rospy.logdebug("The action server has received a new goal request")
            new_id = goal.goal_id if goal.goal_id.id else self.id_generator.generate_ID()
            stamp = new_id.stamp.to_nsec() or rospy.Time.now().to_nsec()
            record = self._records.add(new_id.id, stamp, monotonic())
            if record is None:
                rospy.logdebug("Goal %s was already in the status list", new_id.id)
                return
            if record.status.is_final:
                self.goal_ended(record, None)
                return
            goal.goal_id = goal_id(record)
            handle = ServerGoalHandle(record, self, goal)
            self._handles[record.id] = handle
            self.goal_callback(handle)

    def internal_cancel_callback(self, goal_id: Any) -> None:
        """Process a ``GoalID`` to cancel: one goal, those up to a time, or all."""
        with self.lock:
            if not self.started:
                return
            rospy.logdebug("The action server has received a new cancel request")
            for record in self._records.cancel(goal_id.id, goal_id.stamp.to_nsec(), monotonic()):
                handle = self._handles.get(record.id)
                if handle is not None and handle.set_cancel_requested():
                    self.cancel_callback(handle)

    # Messages to clients

    def goal_ended(self, record: GoalRecord, result: Any) -> None:
        """Publish the result of a goal that has just ended; None for an empty result."""
        self._handles.pop(record.id, None)
        self._records.ended(record, monotonic())
        self.publish_result(
            goal_status(record), self.ActionResultType() if result is None else result
        )

    def publish_result(self, status: Any, result: Any) -> None:
        """Publish a goal's result, and then the status of all goals."""
        with self.lock:
            if not rospy.is_shutdown():
                message = self.ActionResult(status=status, result=result)
                message.header.stamp = rospy.Time.now()
                self.result_pub.publish(message)
            self.publish_status()

    def publish_feedback(self, status: Any, feedback: Any) -> None:
        """Publish feedback about a goal."""
        with self.lock:
            if not rospy.is_shutdown():
                message = self.ActionFeedback(status=status, feedback=feedback)
                message.header.stamp = rospy.Time.now()
                self.feedback_pub.publish(message)

    def publish_status(self) -> None:
        """Publish the status of all goals, including those that ended a short time ago."""
        with self.lock:
            listed = self._records.listed(monotonic())
            if not rospy.is_shutdown():
                message = GoalStatusArray(status_list=[goal_status(record) for record in listed])
                message.header.stamp = rospy.Time.now()
                self.status_pub.publish(message)

    def publish_status_async(self, event: Any) -> None:
        """Publish the status of all goals, unless the server has stopped."""
        with self.lock:
            if self.started:
                self.publish_status()

    def _status_frequency(self, name: str) -> float:
        """Return the rate in Hz at which statuses are published; 0 or less for never."""
        own = f"{name}/status_frequency"
        if rospy.has_param(own):
            rospy.logwarn(
                "You're using the deprecated status_frequency parameter, please switch to "
                "actionlib_status_frequency."
            )
            return float(rospy.get_param(own))
        searched = rospy.search_param("actionlib_status_frequency")
        return STATUS_FREQUENCY if searched is None else float(rospy.get_param(searched))
