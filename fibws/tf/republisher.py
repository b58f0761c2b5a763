"""Tells those who have no transform library where frames are, as RobotWebTools' node does.

Source: https://github.com/RobotWebTools/tf2_web_republisher, its version for ROS 1; for how goals
over operations end, that for ROS 2.
"""

from __future__ import annotations

import asyncio
from collections.abc import Callable
from itertools import count
from typing import Any, Protocol, TypeAlias

import fibws
from fibws.action import tf2_web_republisher, tf2_web_republisher_interfaces
from fibws.errors import InvalidMessage, InvalidTransform
from fibws.interfaces.message import F, R
from fibws.msg import tf2_web_republisher as ros1
from fibws.msg import tf2_web_republisher_interfaces as ros2
from fibws.msg.geometry_msgs import TransformStamped
from fibws.msg.tf2_web_republisher import TFArray
from fibws.srv.tf2_web_republisher import RepublishTFs, RepublishTFsRequest, RepublishTFsResponse
from fibws.tf.audience import Audience
from fibws.tf.buffer import Buffer
from fibws.tf.history import Sample
from fibws.tf.listener import TransformListener
from fibws.tf.messages import write
from fibws.tf.selection import Selection

MAX_GOALS = 100
"""Goals that are pursued at once. One more makes the oldest end: many are of pages that were
closed, which cancels none over topics."""

MAX_TOPICS = 100
"""Topics that are open at once. One more is refused, since they end by themselves."""

MAX_RATE = 1000
"""Hz."""

SHORTEST_PAUSE = 1e-6
"""Seconds in which others have their turn, however late a goal's feedback is."""


Ros1Goal: TypeAlias = fibws.ServerGoal[
    ros1.TFSubscriptionGoal, ros1.TFSubscriptionResult, ros1.TFSubscriptionFeedback
]
Ros2Goal: TypeAlias = fibws.ServerGoal[
    ros2.TFSubscriptionGoal, ros2.TFSubscriptionResult, ros2.TFSubscriptionFeedback
]


class Wish(Protocol):
    """What goals and requests have in common."""

    source_frames: list[str]
    target_frame: str
    angular_thres: float
    trans_thres: float
    rate: float


class Republisher:
    """Answers goals of the action that is named like the node, and calls of ``republish_tfs``.

    A goal lasts until it is canceled. One that came over topics rests while nobody listens to the
    action's feedback; one that came over operations is canceled when its client is lost. A call
    opens a topic, which lasts until nobody has listened to it for the call's timeout.
    """

    def __init__(self, node: fibws.Node) -> None:
        self._node = node
        self._buffer = Buffer()
        self._listener = TransformListener(node, self._buffer)
        self._feedback = Audience(node, f"{node.resolve(node.name)}/feedback")
        self._over_topics = 0
        self._watch: asyncio.Task[None] | None = None
        """Looks who hears the feedback, while there are goals over topics."""
        self._goals: list[fibws.ServerGoal[Any, Any, Any]] = []
        self._open_topics = 0
        self._numbers = count()
        self._tasks = asyncio.TaskGroup()

    async def run(self) -> None:
        """Serve until the node ends.

        Raises:
            NodeError: it ended for this reason.
        """
        node = self._node
        try:
            async with self._tasks:
                self._tasks.create_task(self._listener.run())
                await node.action_server(
                    node.name,
                    tf2_web_republisher.TFSubscription,
                    self._pursue_ros1,
                    over="topics",
                    concurrent=True,
                )
                await node.action_server(
                    node.name,
                    tf2_web_republisher_interfaces.TFSubscription,
                    self._pursue_ros2,
                    over="operations",
                    concurrent=True,
                )
                await node.service("republish_tfs", RepublishTFs, self._open)
                await node.spin()
        except ExceptionGroup as group:
            raise group.exceptions[0] from None

    async def _pursue_ros1(self, goal: Ros1Goal) -> ros1.TFSubscriptionResult:
        self._over_topics += 1
        if self._watch is None:
            self._watch = self._tasks.create_task(self._feedback.watch())
        try:
            return await self._pursue(
                goal, ros1.TFSubscriptionFeedback, goal.canceled, audience=self._feedback
            )
        finally:
            self._over_topics -= 1
            if not self._over_topics:
                self._watch.cancel()
                self._watch = None

    async def _pursue_ros2(self, goal: Ros2Goal) -> ros2.TFSubscriptionResult:
        # A goal that is canceled succeeds, as the original has it: roslib, which cancels a goal
        # for each frame more, would print any other end as an error.
        return await self._pursue(goal, ros2.TFSubscriptionFeedback, ros2.TFSubscriptionResult)

    async def _pursue(
        self,
        goal: fibws.ServerGoal[Any, R, F],
        feedback: Callable[[list[TransformStamped]], F],
        result: Callable[[], R],
        audience: Audience | None = None,
    ) -> R:
        """Give feedback until the goal is canceled, but only to this audience if there is one."""
        try:
            selection, rate = self._selection(goal.request), _rate(goal.request)
        except (InvalidMessage, InvalidTransform) as error:
            self._node.log.warning("Goal %s makes no sense: %s", goal.id, error)
            return goal.aborted(text=str(error))
        if len(self._goals) == MAX_GOALS:
            self._goals.pop(0).request_cancel()
        self._goals.append(goal)
        try:
            await self._give_feedback(goal, feedback, selection, 1 / rate, audience)
        finally:
            made_way = goal not in self._goals
            if not made_way:
                self._goals.remove(goal)
        if made_way:
            return goal.aborted(text=f"it made way for one of {MAX_GOALS} newer goals")
        return result()

    async def _give_feedback(
        self,
        goal: fibws.ServerGoal[Any, R, F],
        feedback: Callable[[list[TransformStamped]], F],
        selection: Selection,
        period: float,
        audience: Audience | None,
    ) -> None:
        if audience is not None:
            await audience.look()
        clock = asyncio.get_running_loop().time
        due = clock()
        while not await goal.cancellation(timeout=max(SHORTEST_PAUSE, due - clock())):
            due = max(due + period, clock())
            if audience is not None and audience.is_empty:
                selection.renew()
            elif transforms := self._changes(selection):
                await goal.publish_feedback(feedback(transforms))

    async def _open(self, request: RepublishTFsRequest) -> RepublishTFsResponse:
        """Answer a call: open a topic."""
        selection, rate = self._selection(request), _rate(request)
        timeout = request.timeout.to_sec()
        if timeout <= 0:
            raise InvalidMessage(f"timeout is {timeout:g} s: write a time above 0, such as 2 s")
        if self._open_topics == MAX_TOPICS:
            raise RuntimeError(f"{MAX_TOPICS} topics are open already: try again later")
        self._open_topics += 1
        topic = await self._node.advertise(f"~tf_repub_{next(self._numbers)}", TFArray, latch=True)
        self._tasks.create_task(self._keep_open(topic, selection, rate, timeout))
        self._node.log.info("Publishing requested TFs on topic %s", topic.topic)
        return RepublishTFsResponse(topic.topic)

    async def _keep_open(
        self, topic: fibws.Publisher[TFArray], selection: Selection, rate: float, patience: float
    ) -> None:
        audience = Audience(self._node, topic.topic)
        publishing = self._tasks.create_task(self._publish(topic, selection, rate, audience))
        watching = self._tasks.create_task(audience.watch(patience))
        await asyncio.wait((publishing, watching), return_when=asyncio.FIRST_COMPLETED)
        publishing.cancel()
        watching.cancel()
        topic.close()
        self._open_topics -= 1
        if not publishing.done():
            self._node.log.info("Nobody listened to %s for %g s", topic.topic, patience)

    async def _publish(
        self,
        topic: fibws.Publisher[TFArray],
        selection: Selection,
        rate: float,
        audience: Audience,
    ) -> None:
        """Publish what changes until the hub will not have it, or the node ends.

        The topic is latched, and who comes to it hears its last message alone: so while nobody is
        there, each message says all that is known.
        """
        known: frozenset[str] = frozenset()
        try:
            async for _ in self._node.rate(rate):
                listeners = audience.listeners or frozenset()
                if known and (not listeners or listeners - known):
                    selection.renew()
                known = listeners
                if transforms := self._changes(selection, whole=not known):
                    await topic.publish(TFArray(transforms))
        except fibws.OperationRejected as error:
            self._node.log.error("%s", error)

    def _selection(self, wish: Wish) -> Selection:
        return Selection(
            wish.target_frame,
            wish.source_frames,
            wish.angular_thres,
            wish.trans_thres,
            self._node.log,
        )

    def _changes(self, selection: Selection, *, whole: bool = False) -> list[TransformStamped]:
        """What is to be told; its stamp is the time of that, as with the original."""
        now = self._node.now().to_nanoseconds()
        return [
            write(frame, Sample(now, selection.target, transform))
            for frame, transform in selection.changes(self._buffer, whole=whole).items()
        ]


def _rate(wish: Wish) -> float:
    if not 0 < wish.rate <= MAX_RATE:
        raise InvalidMessage(
            f"rate is {wish.rate:g}: write how many times a second, up to {MAX_RATE}"
        )
    return wish.rate
