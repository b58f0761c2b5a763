"""Actions over topics, as actionlib has them in ROS 1.

    client ── goal, cancel ─────────────→ server
           ←─ status, feedback, result ──

Source: http://wiki.ros.org/actionlib/DetailedDescription.
"""

from __future__ import annotations

import asyncio
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from itertools import count
from typing import Any

from fibws.errors import MessageTooLarge, NodeError
from fibws.interfaces.message import F, G, R
from fibws.msg import actionlib_msgs
from fibws.node.actions.client import ActionClient, ClientGoal
from fibws.node.actions.server import MOST_GOALS, ActionServer, Execute
from fibws.node.actions.status import GoalRecord, Records
from fibws.node.peers import Peers
from fibws.node.publisher import Publisher
from fibws.node.session import Session, Tasks
from fibws.node.subscription import Subscription
from fibws.node.topics import NodeTopics
from fibws.node.types import MessageCodec, NodeActionType, NodeTypes
from fibws.protocol.goals import (
    CANCEL,
    FEEDBACK,
    GOAL,
    LOST_AFTER,
    RESULT,
    STATUS,
    ActionTopic,
    GoalStatus,
    goal_id,
)

STATUS_PERIOD = 0.2
"""Seconds between two messages on ``status`` (actionlib_status_frequency is 5 Hz)."""

QUEUE_SIZE = 1000
"""Messages of a client's topic that the hub keeps while the connection is slow."""


class GoalIdGenerator:
    """Generates ids for goals over topics, as actionlib does: they are unique on the graph.

    Args:
        node: the node's global name.
        now: returns the time in nanoseconds since 1970.
    """

    def __init__(self, node: str, now: Callable[[], int]) -> None:
        self.now = now
        self._node = node
        self._numbers = count(1)

    def generate(self) -> str:
        """Return a new id."""
        return goal_id(self._node, next(self._numbers), self.now())


class ActionTopics:
    """The publishers and subscriptions of one action's server or client.

    Args:
        topics: the node's topics.
        types: the node's types.
        name: the action's global name.
        type_: the action's type.
        refused: is called if the hub refuses one of the topics.
    """

    def __init__(
        self,
        topics: NodeTopics,
        types: NodeTypes,
        name: str,
        type_: str,
        refused: Callable[[NodeError], None],
    ) -> None:
        self._topics = topics
        self._types = types
        self._name = name
        self._type = type_
        self._refused = refused
        self._publishers: list[ActionPublisher] = []
        self._subscriptions: list[Subscription[Any]] = []

    def advertise(
        self, topic: ActionTopic, *, queue_size: int, latch: bool = False, peers: bool = False
    ) -> ActionPublisher:
        """Return a publisher of one of the topics."""
        name, codec = self._resolve(topic)
        publisher: Publisher[Any, ...] = self._topics.advertise(
            name, codec, queue_size=queue_size, latch=latch, peers=peers, refused=self._refused
        )
        self._publishers.append(ActionPublisher(publisher, codec))
        return self._publishers[-1]

    def subscribe(
        self,
        topic: ActionTopic,
        take: Callable[[Any], None],
        *,
        queue_size: int,
        peers: bool = False,
    ) -> Subscription[Any]:
        """Call ``take`` with each message of one of the topics as it arrives.

        The node queues none, so that the messages of several topics stay in order: a goal's
        feedback comes before its result.
        """
        name, codec = self._resolve(topic)
        subscription: Subscription[Any] = self._topics.subscribe(
            name, codec, queue_size=queue_size, peers=peers, take=take, refused=self._refused
        )
        self._subscriptions.append(subscription)
        return subscription

    def close(self) -> None:
        """Close all publishers and subscriptions."""
        for publisher in self._publishers:
            publisher.close()
        for subscription in self._subscriptions:
            subscription.close()

    def _resolve(self, topic: ActionTopic) -> tuple[str, MessageCodec[Any]]:
        message_class = self._types.message_class(topic.type_of(self._type))
        return f"{self._name}/{topic.name}", self._types.codec(message_class)


class ActionPublisher:
    """Publishes on one of an action's topics. It never waits, not even while the node ends.

    Args:
        publisher: the publisher of the topic.
        codec: the codec of its messages.
    """

    def __init__(self, publisher: Publisher[Any, ...], codec: MessageCodec[Any]) -> None:
        self._publisher = publisher
        self._codec = codec

    @property
    def peers(self) -> Peers:
        """The nodes that subscribe, if they were asked for."""
        return self._publisher.peers

    def publish(self, **fields: Any) -> None:
        """Publish a message of these JSON values; the default stamp of a header is the time."""
        self._publisher._send_while_open(self._publisher._encode(self._codec.read(fields)))

    def close(self) -> None:
        """Stop publishing."""
        self._publisher.close()


class TopicActionServer(ActionServer[G, R, F]):
    """Executes the goals that are published on ``<action>/goal``.

    Args:
        topics: the node's topics.
        types: the node's types.
        goal_ids: generates ids for goals that come without one.
    """

    def __init__(
        self,
        session: Session,
        name: str,
        type_: NodeActionType[G, R, F],
        execute: Execute[G, R, F],
        *,
        concurrent: bool,
        topics: NodeTopics,
        types: NodeTypes,
        goal_ids: GoalIdGenerator,
    ) -> None:
        super().__init__(session, name, type_, execute, concurrent=concurrent)
        self._goal_ids = goal_ids
        self._records = Records()
        self._topics = ActionTopics(topics, types, name, type_.name, self._refuse)
        self._status = self._topics.advertise(STATUS, queue_size=1, latch=True)
        self._results = self._topics.advertise(RESULT, queue_size=MOST_GOALS)
        self._feedback = self._topics.advertise(FEEDBACK, queue_size=MOST_GOALS)
        self._topics.subscribe(GOAL, self._on_goal, queue_size=MOST_GOALS)
        self._topics.subscribe(CANCEL, self._on_cancel, queue_size=MOST_GOALS)
        self._changed = asyncio.Event()
        self._status_tasks = Tasks(session.tasks)
        self._status_tasks.start(self._publish_status(), f"status of {name}")

    def _on_goal(self, message: Any) -> None:
        """Handle an ``ActionGoal``; its goal gets an id and a stamp if it has none."""
        goal_id: actionlib_msgs.GoalID = message.goal_id
        stamp = goal_id.stamp.to_nanoseconds() or self._goal_ids.now()
        record = self._records.add(goal_id.id or self._goal_ids.generate(), stamp, _now())
        if record is None:
            return
        if record.status.is_final:
            self._send_result(record, None)
        else:
            self._receive(record, message.goal)

    def _on_cancel(self, message: actionlib_msgs.GoalID) -> None:
        stamp = message.stamp.to_nanoseconds()
        for record in self._records.cancel(message.id, stamp, _now()):
            self._cancel(record.id)

    # Called by the base class

    def _send_status(self) -> None:
        self._changed.set()

    def _send_feedback(self, record: GoalRecord, feedback: dict[str, Any]) -> None:
        self._feedback.publish(status=_status(record), feedback=feedback)

    def _send_result(self, record: GoalRecord, result: dict[str, Any] | None) -> None:
        self._records.ended(record, _now())
        try:
            self._results.publish(status=_status(record), result=result or {})
        except MessageTooLarge as error:
            self._session.log.error("The result of goal %s is lost: %s", record.id, error)
            lost = {"status": GoalStatus.ABORTED, "text": str(error)}
            self._results.publish(status=_status(record) | lost, result={})
        self._send_status()

    def _unadvertise(self) -> None:
        self._status_tasks.cancel()
        self._topics.close()

    async def _publish_status(self) -> None:
        """Publish the status of all goals periodically, and when it has changed."""
        while not self._ended.is_set():
            self._changed.clear()
            if self._session.outgoing.connected:
                listed = self._records.listed(_now())
                self._status.publish(status_list=[_status(record) for record in listed])
            with suppress(TimeoutError):
                async with asyncio.timeout(STATUS_PERIOD):
                    await self._changed.wait()


def _status(record: GoalRecord) -> dict[str, Any]:
    """Return an ``actionlib_msgs/GoalStatus`` as JSON values."""
    secs, nsecs = divmod(record.stamp, 1_000_000_000)
    return {
        "goal_id": {"stamp": {"secs": secs, "nsecs": nsecs}, "id": record.id},
        "status": record.status,
        "text": record.text,
    }


@dataclass(slots=True)
class _Watchdog:
    """Detects goals that the server no longer reports."""

    last_heard: float
    """When the goal last showed a sign of life, in seconds."""
    timer: asyncio.TimerHandle
    confirmed: bool = False
    """Whether the server has mentioned the goal. Before that any message of the server counts as a
    sign of life: the goal may wait in its queue."""


class TopicActionClient(ActionClient[G, R, F]):
    """Publishes goals on ``<action>/goal``.

    A goal is lost if no message about it arrives for `LOST_AFTER` seconds: a server publishes the
    status of its goals about five times a second.

    Args:
        topics: the node's topics.
        types: the node's types.
        goal_ids: generates the goals' ids.
    """

    def __init__(
        self,
        session: Session,
        name: str,
        type_: NodeActionType[G, R, F],
        *,
        topics: NodeTopics,
        types: NodeTypes,
        goal_ids: GoalIdGenerator,
    ) -> None:
        super().__init__(session, name, type_)
        self._goal_ids = goal_ids
        self._watchdogs: dict[str, _Watchdog] = {}
        """One for each goal that has not ended, by the goals' ids."""
        self._last_status: float | None = None
        """When the server last published a status, in seconds; None if this hub brought none."""
        self._status_received = asyncio.Event()
        self._topics = ActionTopics(topics, types, name, type_.name, self._refuse)
        self._status = self._topics.subscribe(STATUS, self._on_status, queue_size=1, peers=True)
        self._topics.subscribe(FEEDBACK, self._on_feedback, queue_size=QUEUE_SIZE)
        self._topics.subscribe(RESULT, self._on_result, queue_size=QUEUE_SIZE)
        self._goal_publisher = self._topics.advertise(GOAL, queue_size=QUEUE_SIZE, peers=True)
        self._cancel_publisher = self._topics.advertise(CANCEL, queue_size=QUEUE_SIZE, peers=True)

    def _on_disconnect(self) -> None:
        """Fail all goals, and forget the server."""
        super()._on_disconnect()
        self._last_status = None

    def _on_status(self, message: actionlib_msgs.GoalStatusArray) -> None:
        self._last_status = now = _now()
        self._status_received.set()
        statuses = {status.goal_id.id: status for status in message.status_list}
        for id_, watchdog in self._watchdogs.items():
            if id_ in statuses:
                self._update(id_, statuses[id_])
            elif not watchdog.confirmed:
                watchdog.last_heard = now

    def _on_feedback(self, message: Any) -> None:
        """Handle an ``ActionFeedback``."""
        goal = self._update(message.status.goal_id.id, message.status)
        if goal is not None:
            goal._offer(message.feedback)

    def _on_result(self, message: Any) -> None:
        """Handle an ``ActionResult``."""
        goal = self._update(message.status.goal_id.id, message.status)
        if goal is None:
            return
        if goal.status is GoalStatus.SUCCEEDED:
            self._succeed(goal, message.result)
        else:
            self._fail(goal, goal.status, message.status.text, message.result)

    def _update(self, id_: str, status: actionlib_msgs.GoalStatus) -> ClientGoal[R, F] | None:
        """Update a goal's status, and return it; None if it is not a goal of this client."""
        watchdog = self._watchdogs.get(id_)
        if watchdog is None:
            return None
        watchdog.confirmed, watchdog.last_heard = True, _now()
        goal = self._goals[id_]
        with suppress(ValueError):  # Numbers that actionlib does not define are ignored.
            goal._update(GoalStatus(status.status))
        return goal

    def _check_silence(self, id_: str) -> None:
        """Fail a goal that was silent for too long, or else check again when it may have been."""
        watchdog = self._watchdogs[id_]
        silence = _now() - watchdog.last_heard
        if silence < LOST_AFTER:
            watchdog.timer = _later(LOST_AFTER - silence, self._check_silence, id_)
        else:
            text = f"no message about the goal for {LOST_AFTER:g} s"
            if not self._has_server():
                text += "; the action has no server"
            self._fail(self._goals[id_], GoalStatus.LOST, text)

    # Called by the base class

    async def _server_available(self) -> None:
        while not self._has_server():  # A server publishes its status about five times a second.
            self._status_received.clear()
            await self._status_received.wait()

    def _has_server(self) -> bool:
        """Return whether goals and cancellations reach the node that publishes the status."""
        if self._last_status is None or _now() - self._last_status >= LOST_AFTER:
            return False
        servers = self._status.peers
        if not servers.known:  # A rosbridge_suite server never reports them.
            return True
        reached = {*self._goal_publisher.peers.names} & {*self._cancel_publisher.peers.names}
        return not reached.isdisjoint(servers.names)

    def _forget(self, goal: ClientGoal[R, F]) -> None:
        super()._forget(goal)
        self._watchdogs.pop(goal.id).timer.cancel()

    def _new_id(self) -> str:
        return self._goal_ids.generate()

    def _send_goal(self, id_: str, goal: dict[str, Any]) -> None:
        timer = _later(LOST_AFTER, self._check_silence, id_)
        self._watchdogs[id_] = _Watchdog(_now(), timer)
        self._goal_publisher.publish(goal_id={"stamp": "now", "id": id_}, goal=goal)

    def _send_cancel(self, id_: str) -> None:
        self._cancel_publisher.publish(id=id_)

    def _unadvertise(self) -> None:
        self._topics.close()


def _now() -> float:
    return asyncio.get_running_loop().time()


def _later(seconds: float, check: Callable[[str], None], id_: str) -> asyncio.TimerHandle:
    return asyncio.get_running_loop().call_later(seconds, check, id_)
