"""Sending transforms to clients without a transform library, as tf2_web_republisher does.

Source: https://github.com/RobotWebTools/tf2_web_republisher, its version for ROS 1; for the ends of
goals over operations, the one for ROS 2.
"""

from __future__ import annotations

import asyncio
from collections.abc import Callable
from itertools import count
from typing import Any, Protocol, TypeAlias

import fibws
from fibws.action import tf2_web_republisher, tf2_web_republisher_interfaces
from fibws.errors import InvalidMessage
from fibws.interfaces.message import F, R
from fibws.msg import tf2_web_republisher as ros1
from fibws.msg import tf2_web_republisher_interfaces as ros2
from fibws.msg.geometry_msgs import TransformStamped
from fibws.msg.tf2_web_republisher import TFArray
from fibws.srv.tf2_web_republisher import RepublishTFs, RepublishTFsRequest, RepublishTFsResponse
from fibws.tf.buffer import Buffer
from fibws.tf.errors import InvalidTransform
from fibws.tf.history import Sample
from fibws.tf.listener import TransformListener
from fibws.tf.messages import write
from fibws.tf.selection import Selection
from fibws.tf.subscribers import Subscribers

MAX_GOALS = 100
"""Maximum number of concurrent goals; more abort the oldest one. A page that is closed does not
cancel its goals over topics."""

MAX_TOPICS = 100
"""Maximum number of open topics; more are refused, as topics close by themselves."""

MAX_RATE = 1000
"""Maximum rate in Hz."""

SHORTEST_PAUSE = 1e-6
"""Seconds to let other tasks run, even if a goal's feedback is late."""


Ros1Goal: TypeAlias = fibws.ServerGoal[
    ros1.TFSubscriptionGoal, ros1.TFSubscriptionResult, ros1.TFSubscriptionFeedback
]
Ros2Goal: TypeAlias = fibws.ServerGoal[
    ros2.TFSubscriptionGoal, ros2.TFSubscriptionResult, ros2.TFSubscriptionFeedback
]


class SubscriptionRequest(Protocol):
    """The fields that goals and service requests have in common."""

    source_frames: list[str]
    target_frame: str
    angular_thres: float
    trans_thres: float
    rate: float


class Republisher:
    """Serves the action with the node's name, and the service ``republish_tfs``.

    A goal lasts until it is canceled. A goal over topics pauses while the feedback has no
    subscribers; a goal over operations is canceled when its client is lost. A call opens a topic,
    which is closed after the call's timeout without subscribers.
    """

    def __init__(self, node: fibws.Node) -> None:
        self._node = node
        self._buffer = Buffer()
        self._listener = TransformListener(node, self._buffer)
        self._feedback = Subscribers(node, f"{node.resolve(node.name)}/feedback")
        self._over_topics = 0
        self._watch: asyncio.Task[None] | None = None
        """Updates the subscribers of the feedback while there are goals over topics."""
        self._goals: list[fibws.ServerGoal[Any, Any, Any]] = []
        self._open_topics = 0
        self._numbers = count()
        self._tasks = asyncio.TaskGroup()

    async def run(self) -> None:
        """Serve until the node ends.

        Raises:
            NodeError: the node ended for this reason.
        """
        node = self._node
        try:
            async with self._tasks:
                self._tasks.create_task(self._listener.run())
                await node.action_server(
                    node.name,
                    tf2_web_republisher.TFSubscription,
                    self._execute_ros1,
                    over="topics",
                    concurrent=True,
                )
                await node.action_server(
                    node.name,
                    tf2_web_republisher_interfaces.TFSubscription,
                    self._execute_ros2,
                    over="operations",
                    concurrent=True,
                )
                await node.service("republish_tfs", RepublishTFs, self._open)
                await node.spin()
        except ExceptionGroup as group:
            raise group.exceptions[0] from None

    async def _execute_ros1(self, goal: Ros1Goal) -> ros1.TFSubscriptionResult:
        self._over_topics += 1
        if self._watch is None:
            self._watch = self._tasks.create_task(self._feedback.watch())
        try:
            return await self._execute(
                goal, ros1.TFSubscriptionFeedback, goal.canceled, subscribers=self._feedback
            )
        finally:
            self._over_topics -= 1
            if not self._over_topics:
                self._watch.cancel()
                self._watch = None

    async def _execute_ros2(self, goal: Ros2Goal) -> ros2.TFSubscriptionResult:
        # A canceled goal succeeds, as in the original: roslib, which cancels a goal for each
        # additional frame, would print any other end as an error.
        return await self._execute(goal, ros2.TFSubscriptionFeedback, ros2.TFSubscriptionResult)

    async def _execute(
        self,
        goal: fibws.ServerGoal[Any, R, F],
        feedback: Callable[[list[TransformStamped]], F],
        result: Callable[[], R],
        subscribers: Subscribers | None = None,
    ) -> R:
        """Publish feedback until the goal is canceled, while there are subscribers if given."""
        try:
            selection, rate = self._selection(goal.request), _rate(goal.request)
        except (InvalidMessage, InvalidTransform) as error:
            self._node.log.warning("Invalid goal %s: %s", goal.id, error)
            return goal.aborted(text=str(error))
        if len(self._goals) == MAX_GOALS:
            self._goals.pop(0)._request_cancel()
        self._goals.append(goal)
        try:
            await self._publish_feedback(goal, feedback, selection, 1 / rate, subscribers)
        finally:
            is_replaced = goal not in self._goals
            if not is_replaced:
                self._goals.remove(goal)
        if is_replaced:
            return goal.aborted(text=f"aborted for a newer goal (limit {MAX_GOALS})")
        return result()

    async def _publish_feedback(
        self,
        goal: fibws.ServerGoal[Any, R, F],
        feedback: Callable[[list[TransformStamped]], F],
        selection: Selection,
        period: float,
        subscribers: Subscribers | None,
    ) -> None:
        if subscribers is not None:
            await subscribers.update()
        clock = asyncio.get_running_loop().time
        due = clock()
        while not await goal.cancellation(timeout=max(SHORTEST_PAUSE, due - clock())):
            due = max(due + period, clock())
            if subscribers is not None and subscribers.is_empty:
                selection.renew()
            elif transforms := self._changes(selection):
                await goal.publish_feedback(feedback(transforms))

    async def _open(self, request: RepublishTFsRequest) -> RepublishTFsResponse:
        """Open a topic for a call."""
        selection, rate = self._selection(request), _rate(request)
        timeout = request.timeout.to_sec()
        if timeout <= 0:
            raise InvalidMessage(f"timeout must be above 0, got {timeout:g} s")
        if self._open_topics == MAX_TOPICS:
            raise RuntimeError(f"too many open topics (limit {MAX_TOPICS}); try again later")
        self._open_topics += 1
        name = f"~tf_repub_{next(self._numbers)}"
        try:
            topic = await self._node.advertise(name, TFArray, latch=True)
        except BaseException:
            self._open_topics -= 1
            raise
        self._tasks.create_task(self._keep_open(topic, selection, rate, timeout))
        self._node.log.info("Publishing requested TFs on topic %s", topic.topic)
        return RepublishTFsResponse(topic.topic)

    async def _keep_open(
        self, topic: fibws.Publisher[TFArray], selection: Selection, rate: float, patience: float
    ) -> None:
        subscribers = Subscribers(self._node, topic.topic)
        publishing = self._tasks.create_task(self._publish(topic, selection, rate, subscribers))
        watching = self._tasks.create_task(subscribers.watch(patience))
        await asyncio.wait((publishing, watching), return_when=asyncio.FIRST_COMPLETED)
        publishing.cancel()
        watching.cancel()
        topic.close()
        self._open_topics -= 1
        if not publishing.done():
            self._node.log.info(
                "Closed %s, which had no subscribers for %g s", topic.topic, patience
            )

    async def _publish(
        self,
        topic: fibws.Publisher[TFArray],
        selection: Selection,
        rate: float,
        subscribers: Subscribers,
    ) -> None:
        """Publish changes until the hub refuses them or the node ends.

        A new subscriber of the latched topic receives only the last message. So while there are no
        subscribers, each message has all known transforms.
        """
        known: frozenset[str] = frozenset()
        try:
            async for _ in self._node.rate(rate):
                names = subscribers.names or frozenset()
                if known and (not names or names - known):
                    selection.renew()
                known = names
                if transforms := self._changes(selection, whole=not known):
                    await topic.publish(TFArray(transforms))
        except fibws.OperationRejected as error:
            self._node.log.error("%s", error)

    def _selection(self, request: SubscriptionRequest) -> Selection:
        return Selection(
            request.target_frame,
            request.source_frames,
            request.angular_thres,
            request.trans_thres,
            self._node.log,
        )

    def _changes(self, selection: Selection, *, whole: bool = False) -> list[TransformStamped]:
        """Return the changes with the current time as their stamp, as in the original."""
        now = self._node.now().to_nanoseconds()
        return [
            write(frame, Sample(now, selection.target, transform))
            for frame, transform in selection.changes(self._buffer, whole=whole).items()
        ]


def _rate(request: SubscriptionRequest) -> float:
    if not 0 < request.rate <= MAX_RATE:
        raise InvalidMessage(f"rate must be above 0 and at most {MAX_RATE}, got {request.rate:g}")
    return request.rate
