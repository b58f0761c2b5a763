"""The asking end of an action over topics, as actionlib's."""

from __future__ import annotations

import asyncio
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from typing import Any

from fibws.interfaces.message import F, G, R
from fibws.msg import actionlib_msgs
from fibws.node.actions.action_topics import CANCEL, FEEDBACK, GOAL, RESULT, STATUS, ActionTopics
from fibws.node.actions.action_type import ActionType
from fibws.node.actions.actions import Actions
from fibws.node.actions.client import ActionClient
from fibws.node.actions.client_goal import ClientGoal
from fibws.node.actions.status import GoalStatus

LOST_AFTER = 5.0
"""Seconds without a word of a goal, or of its server, after which it counts as lost."""

QUEUE_SIZE = 1000
"""How many messages of a topic the hub keeps while the connection is slow."""


@dataclass(slots=True)
class _Watch:
    """When a sign of life came for a goal, in seconds; from whom tells what counts as one."""

    heard: float
    timer: asyncio.TimerHandle
    known: bool = False
    """Whether the server has said that it has the goal."""


class TopicActionClient(ActionClient[G, R, F]):
    """Sends goals to ``<action>/goal``.

    A goal counts as lost if its server, which speaks five times a second or so, says nothing for a
    while; or nothing of this goal, if it did before.
    """

    def __init__(self, actions: Actions, name: str, type_: ActionType[G, R, F]) -> None:
        super().__init__(actions, name, type_)
        self._watches: dict[str, _Watch] = {}
        self._server_heard: float | None = None
        self._news = asyncio.Event()
        self._topics = topics = ActionTopics(actions, name, type_.name, self._refuse)
        topics.receiver(STATUS, self._take_status, queue_size=1)
        topics.receiver(FEEDBACK, self._take_feedback, queue_size=QUEUE_SIZE)
        topics.receiver(RESULT, self._take_result, queue_size=QUEUE_SIZE)
        self._goal_topic = topics.sender(GOAL, queue_size=QUEUE_SIZE)
        self._cancel_topic = topics.sender(CANCEL, queue_size=QUEUE_SIZE)

    def lose(self) -> None:
        """The hub is gone, and with it all servers."""
        super().lose()
        self._server_heard = None

    async def _served(self) -> None:
        while self._server_heard is None or _now() - self._server_heard >= LOST_AFTER:
            self._news.clear()
            await self._news.wait()

    # What is heard of goals

    def _take_status(self, message: actionlib_msgs.GoalStatusArray) -> None:
        self._server_heard = now = _now()
        self._news.set()
        told = {status.goal_id.id: status for status in message.status_list}
        for id_, watch in self._watches.items():
            if id_ in told:
                self._sign(id_, told[id_])
            elif not watch.known:
                watch.heard = now

    def _take_feedback(self, message: Any) -> None:
        """Take an ``ActionFeedback``."""
        goal = self._sign(message.status.goal_id.id, message.status)
        if goal is not None:
            goal.offer(message.feedback)

    def _take_result(self, message: Any) -> None:
        """Take an ``ActionResult``."""
        goal = self._sign(message.status.goal_id.id, message.status)
        if goal is None:
            return
        if goal.status is GoalStatus.SUCCEEDED:
            self._succeed(goal, message.result)
        else:
            self._fail(goal, goal.status, message.status.text, message.result)

    def _sign(self, id_: str, status: actionlib_msgs.GoalStatus) -> ClientGoal[R, F] | None:
        """Note what the server says of a goal, if it is one of this client's."""
        watch = self._watches.get(id_)
        if watch is None:
            return None
        watch.known, watch.heard = True, _now()
        goal = self._goals[id_]
        with suppress(ValueError):  # A number that actionlib does not know tells nothing.
            goal.told(GoalStatus(status.status))
        return goal

    def _look(self, id_: str) -> None:
        """Give a goal up, or look again when it will be time to."""
        watch = self._watches[id_]
        silent = _now() - watch.heard
        if silent < LOST_AFTER:
            watch.timer = _later(LOST_AFTER - silent, self._look, id_)
        else:
            text = f"nothing was heard of it for {LOST_AFTER:g} s"
            self._fail(self._goals[id_], GoalStatus.LOST, text)

    def _forget(self, goal: ClientGoal[R, F]) -> None:
        super()._forget(goal)
        self._watches.pop(goal.id).timer.cancel()

    # What the graph is told

    def _new_id(self) -> str:
        return self._actions.goal_id()

    def _tell_goal(self, id_: str, goal: dict[str, Any]) -> None:
        self._watches[id_] = _Watch(_now(), _later(LOST_AFTER, self._look, id_))
        self._goal_topic.put(goal_id={"stamp": "now", "id": id_}, goal=goal)

    def _tell_cancel(self, id_: str) -> None:
        self._cancel_topic.put(id=id_)

    def _unadvertise(self) -> None:
        self._topics.close()


def _now() -> float:
    return asyncio.get_running_loop().time()


def _later(seconds: float, look: Callable[[str], None], id_: str) -> asyncio.TimerHandle:
    return asyncio.get_running_loop().call_later(seconds, look, id_)
