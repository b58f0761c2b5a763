"""Sending one goal and following it to its end, over topics or over rosbridge's operations."""

from __future__ import annotations

import time
from abc import ABC, abstractmethod
from collections.abc import Iterator
from typing import Any, NamedTuple, TypeAlias

from fibws.client.hub_client import HubClient, Operation, check
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
    status_from_ros2,
)

_ERROR = {"op": "status", "level": "error"}


class StatusChange(NamedTuple):
    """The goal has another status."""

    status: GoalStatus


class Feedback(NamedTuple):
    """The server published feedback."""

    values: dict[str, Any]


class End(NamedTuple):
    """The goal ended: its last status, the server's text, and the result if there is one."""

    status: GoalStatus
    text: str
    result: dict[str, Any] | None


Update: TypeAlias = StatusChange | Feedback | End


class OpenGoal(ABC):
    """A goal, which is sent when it is created.

    Args:
        action: the action's global name.
        type_: the action's type.
        values: the goal's fields.
    """

    def __init__(self, client: HubClient, action: str, type_: str, values: dict[str, Any]) -> None:
        self._client = client
        self._action = action
        self._status = GoalStatus.PENDING
        self._send(type_, values)

    def updates(self, timeout: float | None = None) -> Iterator[Update]:
        """Iterate over the goal's updates as they arrive; its `End` is the last one.

        Args:
            timeout: seconds after which the iteration ends, even if the goal has not.

        Raises:
            OperationRejected: the hub refused an operation.
            HubLost: the connection is lost.
        """
        end = None if timeout is None else time.monotonic() + timeout
        while True:
            waits = [each for each in (end, self._deadline()) if each is not None]
            rest = max(0.0, min(waits) - time.monotonic()) if waits else None
            operation = self._client.receive(rest)
            if operation is not None:
                for update in self._updates(operation):
                    yield update
                    if isinstance(update, End):
                        return
            elif end is not None and time.monotonic() >= end:
                return
            elif self._deadline() is not None:
                yield End(GoalStatus.LOST, f"no message about the goal for {LOST_AFTER:g} s", None)
                return

    @abstractmethod
    def cancel(self) -> None:
        """Ask the server to cancel the goal; `updates` reports what comes of it."""

    @abstractmethod
    def _send(self, type_: str, values: dict[str, Any]) -> None:
        """Send the goal to its server."""

    @abstractmethod
    def _updates(self, operation: Operation) -> Iterator[Update]:
        """Yield the updates in an operation of the hub."""

    def _deadline(self) -> float | None:
        """Return when the goal counts as lost, if it can be lost."""
        return None

    def _change(self, status: GoalStatus) -> Iterator[StatusChange]:
        if status != self._status:
            self._status = status
            yield StatusChange(status)


class TopicGoal(OpenGoal):
    """A goal on ``<action>/goal``, as actionlib's clients send it."""

    def _send(self, type_: str, values: dict[str, Any]) -> None:
        self._last_heard = time.monotonic()
        self._is_confirmed = False
        now = time.time_ns()
        self._id = goal_id(self._client.node, 1, now)
        for topic in (STATUS, FEEDBACK, RESULT):
            self._send_topic(topic, op="subscribe", type=topic.type_of(type_), headers=True)
        for topic in (CANCEL, GOAL):
            self._send_topic(topic, op="advertise", type=topic.type_of(type_))
        secs, nsecs = divmod(now, 10**9)
        id_ = {"stamp": {"secs": secs, "nsecs": nsecs}, "id": self._id}
        self._send_topic(GOAL, op="publish", msg={"goal_id": id_, "goal": values})

    def cancel(self) -> None:
        self._last_heard = time.monotonic()
        # With a stamp, all goals before it would be canceled.
        id_ = {"stamp": {"secs": 0, "nsecs": 0}, "id": self._id}
        self._send_topic(CANCEL, op="publish", msg=id_)

    def _send_topic(self, topic: ActionTopic, **operation: Any) -> None:
        self._client.send({**operation, "topic": f"{self._action}/{topic.name}"})

    def _deadline(self) -> float:
        return self._last_heard + LOST_AFTER

    def _updates(self, operation: Operation) -> Iterator[Update]:
        check(operation)
        if operation.get("op") != "publish":
            return
        topic, message = str(operation["topic"]).rpartition("/")[2], operation["msg"]
        if topic == STATUS.name:
            statuses = {each["goal_id"]["id"]: each for each in message["status_list"]}
            if self._id in statuses:
                yield from self._confirm(statuses[self._id])
            elif not self._is_confirmed:
                self._last_heard = time.monotonic()  # The goal may wait in the server's queue.
        elif message["status"]["goal_id"]["id"] != self._id:
            return  # Another client's goal.
        elif topic == FEEDBACK.name:
            yield from self._confirm(message["status"])
            yield Feedback(message["feedback"])
        else:
            status = message["status"]
            yield End(_status(status["status"]), status["text"], message["result"])

    def _confirm(self, status: dict[str, Any]) -> Iterator[StatusChange]:
        """Note that the server has mentioned the goal."""
        self._is_confirmed, self._last_heard = True, time.monotonic()
        yield from self._change(_status(status["status"]))


class OperationGoal(OpenGoal):
    """A goal that the hub passes to the server, as rosbridge does for ROS 2."""

    def _send(self, type_: str, values: dict[str, Any]) -> None:
        self._id = f"send_action_goal:{self._action}:1"
        self._send_op("send_action_goal", action_type=type_, args=values, feedback=True)

    def cancel(self) -> None:
        self._send_op("cancel_action_goal")

    def _send_op(self, op: str, **fields: Any) -> None:
        self._client.send({"op": op, "id": self._id, "action": self._action, **fields})

    def _updates(self, operation: Operation) -> Iterator[Update]:
        if operation.get("id") != self._id:
            return
        op, values = operation.get("op"), operation.get("values")
        if op == "action_feedback":
            yield from self._change(GoalStatus.ACTIVE)
            yield Feedback(values if isinstance(values, dict) else {})
        elif op == "action_result":
            status = _status(operation.get("status", 0), ros2=True)
            if operation.get("result"):
                yield End(status, "", values if isinstance(values, dict) else {})
            else:
                yield End(status, str(values or ""), None)
        elif operation.items() >= _ERROR.items():
            yield End(GoalStatus.REJECTED, str(operation.get("msg")), None)


def _status(number: int, *, ros2: bool = False) -> GoalStatus:
    """Return the status of a number; LOST for numbers that ROS does not define."""
    try:
        return status_from_ros2(number) if ros2 else GoalStatus(number)
    except (ValueError, IndexError):
        return GoalStatus.LOST
