"""The serving end of an action over topics, as actionlib's."""

from __future__ import annotations

import asyncio
from contextlib import suppress
from typing import Any

from fibws.interfaces.message import F, G, R
from fibws.msg.actionlib_msgs import GoalID
from fibws.node.actions.action_topics import CANCEL, FEEDBACK, GOAL, RESULT, STATUS, ActionTopics
from fibws.node.actions.action_type import ActionType
from fibws.node.actions.actions import Actions
from fibws.node.actions.record import Record, Records
from fibws.node.actions.server import MOST_GOALS, ActionServer, Execute
from fibws.node.tasks import Tasks

STATUS_PERIOD = 0.2
"""Seconds between two messages on ``status`` (actionlib_status_frequency is 5 Hz)."""


class TopicActionServer(ActionServer[G, R, F]):
    """Takes goals from ``<action>/goal``."""

    def __init__(
        self,
        actions: Actions,
        name: str,
        type_: ActionType[G, R, F],
        execute: Execute[G, R, F],
        *,
        concurrent: bool,
    ) -> None:
        super().__init__(actions, name, type_, execute, concurrent=concurrent)
        self._records = Records()
        self._topics = topics = ActionTopics(actions, name, type_.name, self._refuse)
        self._status = topics.sender(STATUS, queue_size=1, latch=True)
        self._result = topics.sender(RESULT, queue_size=MOST_GOALS)
        self._feedbacks = topics.sender(FEEDBACK, queue_size=MOST_GOALS)
        topics.receiver(GOAL, self._take_goal, queue_size=MOST_GOALS)
        topics.receiver(CANCEL, self._take_cancel, queue_size=MOST_GOALS)
        self._changed = asyncio.Event()
        self._telling = Tasks(actions.session.tasks)
        self._telling.start(self._keep_telling(), f"status of {name}")

    def _take_goal(self, message: Any) -> None:
        """Take an ``ActionGoal``: of the goal's name and time, what is missing is made up."""
        goal_id: GoalID = message.goal_id
        stamp = goal_id.stamp.to_nanoseconds() or self._actions.now()
        record = self._records.add(goal_id.id or self._actions.goal_id(), stamp, _seconds())
        if record is None:
            return
        if record.status.is_final:
            self._tell_result(record, None)
        else:
            self._receive(record, message.goal)

    def _take_cancel(self, message: GoalID) -> None:
        stamp = message.stamp.to_nanoseconds()
        for record in self._records.cancel(message.id, stamp, _seconds()):
            self._cancel(record.id)

    def _tell_status(self) -> None:
        self._changed.set()

    def _tell_feedback(self, record: Record, feedback: dict[str, Any]) -> None:
        self._feedbacks.put(status=_status(record), feedback=feedback)

    def _tell_result(self, record: Record, result: dict[str, Any] | None) -> None:
        self._records.ended(record, _seconds())
        self._result.put(status=_status(record), result=result or {})
        self._tell_status()

    def _unadvertise(self) -> None:
        self._telling.cancel()
        self._topics.close()

    async def _keep_telling(self) -> None:
        """Tell the status of all goals again and again, and soon after it has changed."""
        while not self._ended.is_set():
            self._changed.clear()
            if self._session.outbox.connected:
                listed = self._records.listed(_seconds())
                self._status.put(status_list=[_status(record) for record in listed])
            with suppress(TimeoutError):
                async with asyncio.timeout(STATUS_PERIOD):
                    await self._changed.wait()


def _status(record: Record) -> dict[str, Any]:
    secs, nsecs = divmod(record.stamp, 1_000_000_000)
    return {
        "goal_id": {"stamp": {"secs": secs, "nsecs": nsecs}, "id": record.id},
        "status": record.status,
        "text": record.text,
    }


def _seconds() -> float:
    return asyncio.get_running_loop().time()
