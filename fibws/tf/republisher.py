"""Tells those who have no transform library where frames are, as RobotWebTools' node does.

Source: https://github.com/RobotWebTools/tf2_web_republisher, its version for ROS 1.
"""

from __future__ import annotations

import asyncio
from itertools import count
from typing import Protocol, TypeAlias

import fibws
from fibws.action.tf2_web_republisher import TFSubscription
from fibws.errors import InvalidMessage
from fibws.msg.geometry_msgs import TransformStamped
from fibws.msg.tf2_web_republisher import (
    TFArray,
    TFSubscriptionFeedback,
    TFSubscriptionGoal,
    TFSubscriptionResult,
)
from fibws.srv.tf2_web_republisher import RepublishTFs, RepublishTFsRequest, RepublishTFsResponse
from fibws.tf.audience import Audience
from fibws.tf.buffer import Buffer
from fibws.tf.history import Sample
from fibws.tf.listener import Listener
from fibws.tf.messages import write
from fibws.tf.selection import Selection

MAX_GOALS = 100
"""Goals that are pursued at once. One more makes the oldest end: many are of pages that were
closed, which cancels nothing."""

MAX_TOPICS = 100
"""Topics that are open at once. One more is refused, since they end by themselves."""

MAX_RATE = 1000
"""Hz."""


Goal: TypeAlias = (
    "fibws.ServerGoal[TFSubscriptionGoal, TFSubscriptionResult, TFSubscriptionFeedback]"
)


class Wish(Protocol):
    """What goals and requests have in common."""

    source_frames: list[str]
    target_frame: str
    angular_thres: float
    trans_thres: float
    rate: float


class Republisher:
    """Answers goals of the action that is named like the node, and calls of ``republish_tfs``.

    A goal lasts until it is canceled; it rests while nobody listens to the action's feedback. A
    call opens a topic, which lasts until nobody has listened to it for the call's timeout.
    """

    def __init__(self, node: fibws.Node) -> None:
        self._node = node
        self._buffer = Buffer()
        self._listener = Listener(node, self._buffer)
        self._feedback = Audience(node, f"{node.name}/feedback")
        self._goals: dict[str, Goal] = {}
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
                self._tasks.create_task(self._listener.hear_moving())
                self._tasks.create_task(self._listener.hear_static())
                self._tasks.create_task(self._feedback.watch())
                await node.action_server(
                    node.name, TFSubscription, self._pursue, over="topics", concurrent=True
                )
                await node.service("republish_tfs", RepublishTFs, self._open)
                await node.spin()
        except ExceptionGroup as group:
            raise group.exceptions[0] from None

    async def _pursue(self, goal: Goal) -> TFSubscriptionResult:
        """Give feedback until the goal is canceled."""
        selection, rate = self._selection(goal.request), _rate(goal.request)
        if len(self._goals) == MAX_GOALS:
            self._goals.pop(next(iter(self._goals))).want_no_more()
        self._goals[goal.id] = goal
        try:
            await self._give_feedback(goal, selection, 1 / rate)
        finally:
            made_way = self._goals.pop(goal.id, None) is None
        if made_way:
            return goal.aborted(text=f"it made way for one of {MAX_GOALS} newer goals")
        return goal.canceled()

    async def _give_feedback(self, goal: Goal, selection: Selection, period: float) -> None:
        await self._feedback.look()
        clock = asyncio.get_running_loop().time
        due = clock()
        while not await goal.cancellation(within=max(0, due - clock())):
            due = max(due + period, clock())
            if self._feedback.is_empty:
                selection.renew()
            elif transforms := self._changes(selection):
                await goal.feedback(TFSubscriptionFeedback(transforms))

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
