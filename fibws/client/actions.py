"""One goal, from its sending to its end, by either of the ways in which goals travel."""

from __future__ import annotations

import time
from abc import ABC, abstractmethod
from collections.abc import Iterator
from typing import Any, NamedTuple, TypeAlias

from fibws.client.hub_client import HubClient, Operation, check

LOST_AFTER = 5.0
"""Seconds without a word of a goal, or of its server, after which it counts as lost."""

STATUSES = tuple(
    "PENDING ACTIVE PREEMPTED SUCCEEDED ABORTED REJECTED PREEMPTING RECALLING RECALLED LOST".split()
)
"""The words of actionlib_msgs/GoalStatus, by their numbers."""

_OF_ROS2 = ("LOST", "PENDING", "ACTIVE", "PREEMPTING", "SUCCEEDED", "PREEMPTED", "ABORTED")
"""The same words by the numbers of action_msgs/GoalStatus."""

_ERRORS = {"op": "status", "level": "error"}


class Status(NamedTuple):
    """What the server says of the goal: one of `STATUSES`."""

    status: str


class Feedback(NamedTuple):
    """How far the goal is."""

    values: dict[str, Any]


class End(NamedTuple):
    """What became of the goal: one of `STATUSES`, the server's reason, the result if it said it."""

    status: str
    text: str
    result: dict[str, Any] | None


News: TypeAlias = Status | Feedback | End


class Goal(ABC):
    """A goal that is sent by being made.

    Args:
        action: the action's global name.
        type_: the action's type.
        values: the goal's fields.
    """

    def __init__(self, client: HubClient, action: str, type_: str, values: dict[str, Any]) -> None:
        self._client = client
        self._action = action
        self._status = "PENDING"
        self._send(type_, values)

    def news(self, timeout: float | None = None) -> Iterator[News]:
        """What is heard of the goal, as it comes; its `End` is the last.

        Args:
            timeout: seconds after which there is no more news, even without an end.

        Raises:
            OperationRejected: the hub has refused something.
            HubLost: there is no hub any more.
        """
        end = None if timeout is None else time.monotonic() + timeout
        while True:
            waits = [each for each in (end, self._deadline()) if each is not None]
            rest = max(0.0, min(waits) - time.monotonic()) if waits else None
            operation = self._client.receive(rest)
            if operation is not None:
                for news in self._news(operation):
                    yield news
                    if isinstance(news, End):
                        return
            elif end is not None and time.monotonic() >= end:
                return
            elif self._deadline() is not None:
                yield End("LOST", f"nothing was heard of it for {LOST_AFTER:g} s", None)
                return

    @abstractmethod
    def cancel(self) -> None:
        """Want it no more; what becomes of it is news."""

    @abstractmethod
    def _send(self, type_: str, values: dict[str, Any]) -> None:
        """Tell the server."""

    @abstractmethod
    def _news(self, operation: Operation) -> Iterator[News]:
        """What an operation says of the goal."""

    def _deadline(self) -> float | None:
        """When the goal counts as lost, if it can be."""
        return None

    def _told(self, status: str) -> Iterator[Status]:
        if status != self._status:
            self._status = status
            yield Status(status)


class TopicGoal(Goal):
    """A goal on ``<action>/goal``, as actionlib's clients send it."""

    def _send(self, type_: str, values: dict[str, Any]) -> None:
        self._heard = time.monotonic()
        self._known = False
        secs, nsecs = divmod(time.time_ns(), 10**9)
        self._id = f"{self._client.node}-1-{secs}.{nsecs:09d}"
        for topic, of in (
            ("status", "actionlib_msgs/GoalStatusArray"),
            ("feedback", f"{type_}ActionFeedback"),
            ("result", f"{type_}ActionResult"),
        ):
            self._say({"op": "subscribe", "type": of}, topic)
        self._say({"op": "advertise", "type": "actionlib_msgs/GoalID"}, "cancel")
        self._say({"op": "advertise", "type": f"{type_}ActionGoal"}, "goal")
        stamp = {"secs": secs, "nsecs": nsecs}
        goal = {"goal_id": {"stamp": stamp, "id": self._id}, "goal": values}
        self._say({"op": "publish", "msg": goal}, "goal")

    def cancel(self) -> None:
        self._heard = time.monotonic()
        never = {"secs": 0, "nsecs": 0}  # With a time, all goals before it would be cancelled.
        self._say({"op": "publish", "msg": {"stamp": never, "id": self._id}}, "cancel")

    def _say(self, operation: Operation, topic: str) -> None:
        self._client.send({**operation, "topic": f"{self._action}/{topic}"})

    def _deadline(self) -> float:
        return self._heard + LOST_AFTER

    def _news(self, operation: Operation) -> Iterator[News]:
        check(operation)
        if operation.get("op") != "publish":
            return
        topic, message = str(operation["topic"]).rpartition("/")[2], operation["msg"]
        if topic == "status":
            told = {each["goal_id"]["id"]: each for each in message["status_list"]}
            if self._id in told:
                yield from self._sign(told[self._id])
            elif not self._known:
                self._heard = time.monotonic()  # The server is there and will get to it.
        elif message["status"]["goal_id"]["id"] != self._id:
            return  # Somebody else's.
        elif topic == "feedback":
            yield from self._sign(message["status"])
            yield Feedback(message["feedback"])
        else:
            status = message["status"]
            yield End(_word(STATUSES, status["status"]), status["text"], message["result"])

    def _sign(self, status: dict[str, Any]) -> Iterator[Status]:
        """Note a sign of life of the goal."""
        self._known, self._heard = True, time.monotonic()
        yield from self._told(_word(STATUSES, status["status"]))


class OperationGoal(Goal):
    """A goal that the hub hands on, as rosbridge does for ROS 2."""

    def _send(self, type_: str, values: dict[str, Any]) -> None:
        self._id = f"send_action_goal:{self._action}:1"
        self._say("send_action_goal", action_type=type_, args=values, feedback=True)

    def cancel(self) -> None:
        self._say("cancel_action_goal")

    def _say(self, op: str, **fields: Any) -> None:
        self._client.send({"op": op, "id": self._id, "action": self._action, **fields})

    def _news(self, operation: Operation) -> Iterator[News]:
        if operation.get("id") != self._id:
            return
        op, values = operation.get("op"), operation.get("values")
        if op == "action_feedback":
            yield from self._told("ACTIVE")
            yield Feedback(values if isinstance(values, dict) else {})
        elif op == "action_result":
            status = _word(_OF_ROS2, operation.get("status", 0))
            if operation.get("result"):
                yield End(status, "", values if isinstance(values, dict) else {})
            else:
                yield End(status, str(values or ""), None)
        elif operation.items() >= _ERRORS.items():
            yield End("REJECTED", str(operation.get("msg")), None)


def _word(words: tuple[str, ...], number: int) -> str:
    return words[number] if 0 <= number < len(words) else "LOST"
