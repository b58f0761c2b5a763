"""An action: who pursues its goals, and what becomes of each.

As in ROS 2 (action_msgs): a goal is accepted, may be heard of, and ends with one result.
"""

from __future__ import annotations

from base64 import b64decode, b64encode
from collections.abc import Iterator
from dataclasses import dataclass, field
from enum import IntEnum
from typing import Any, Protocol

from fibws.hub.graph.types import ActionType
from fibws.protocol.operations import json_of


class Ros2GoalStatus(IntEnum):
    """The states of a goal, as action_msgs/GoalStatus numbers them."""

    UNKNOWN = 0
    ACCEPTED = 1
    EXECUTING = 2
    CANCELING = 3
    SUCCEEDED = 4
    CANCELED = 5
    ABORTED = 6


class ActionServer(Protocol):
    """Whoever pursues the goals of an action."""

    @property
    def node(self) -> str:
        """The name of its node."""

    def pursue(self, goal: Goal) -> None:
        """Begin with a goal."""

    def cancel(self, goal: Goal) -> None:
        """A goal is wanted no more; it still has a result."""

    def forget(self, goal: Goal) -> None:
        """A goal has ended."""

    def displaced(self, action: Action) -> None:
        """Another server has taken the action over."""


class ActionClient(Protocol):
    """Whoever sent a goal."""

    def hear(self, goal: Goal, feedback: bytes) -> None:
        """The goal has come as far as the JSON text says."""

    def end(self, goal: Goal, status: Ros2GoalStatus, result: bytes, *, ok: bool) -> None:
        """The goal has ended; the JSON text is its result, or what went wrong if not ``ok``."""


@dataclass(slots=True, eq=False)
class Action:
    """One action of the graph."""

    name: str
    type: ActionType
    server: ActionServer
    goals: dict[bytes, Goal] = field(default_factory=dict)
    """Those that have not ended, by their UUIDs."""

    @property
    def node(self) -> str:
        """The node that pursues the goals."""
        return self.server.node


class Goal:
    """One goal, from its sending to its result.

    Args:
        request: valid, with every field filled.
        uuid: 16 bytes that no other goal has.
        accepted: when, in nanoseconds since 1970.
    """

    __slots__ = ("_canceling", "_client", "accepted", "action", "id", "request", "uuid")

    def __init__(
        self,
        action: Action,
        request: dict[str, Any],
        client: ActionClient,
        uuid: bytes,
        accepted: int,
    ) -> None:
        self.action = action
        self.request = request
        self.uuid = uuid
        self.accepted = accepted
        self.id = ""
        """What its server knows it by."""
        self._client = client
        self._canceling = False

    def start(self) -> None:
        """Have the server begin."""
        self.action.goals[self.uuid] = self
        self.action.server.pursue(self)
        # It has been told; what may be large need not be kept until the goal ends.
        self.request = {}

    def feedback(self, values: object) -> None:
        """Tell the client how far the server has come; raises `InvalidMessage`."""
        valid = self.action.type.feedback(values)
        self._client.hear(self, json_of(valid))

    def finish(self, status: Ros2GoalStatus, values: object) -> None:
        """End with the server's result; raises `InvalidMessage`, upon which it has not ended."""
        result = json_of(self.action.type.result(values))
        self._end(status, result, ok=True)

    def fail(self, text: str, status: Ros2GoalStatus = Ros2GoalStatus.ABORTED) -> None:
        """End without a result."""
        self._end(status, json_of(text), ok=False)

    def cancel(self) -> None:
        """Ask the server to stop; to ask once is enough."""
        if not self._canceling:
            self._canceling = True
            self.action.server.cancel(self)

    def abandon(self) -> None:
        """The client has left: the server may stop, and nobody waits for the result."""
        if self.action.goals.pop(self.uuid, None) is not None:
            self.cancel()
            self.action.server.forget(self)

    def _end(self, status: Ros2GoalStatus, result: bytes, *, ok: bool) -> None:
        if self.action.goals.pop(self.uuid, None) is not None:
            self.action.server.forget(self)
            self._client.end(self, status, result, ok=ok)


def cancel_service(action: str) -> str:
    """The name of the service beside an action by which its goals can be cancelled, as in ROS 2."""
    return f"{action}/_action/cancel_goal"


def cancel_goals(action: Action, request: dict[str, Any]) -> dict[str, Any]:
    """Answer a call of action_msgs/CancelGoal, whose definition says which goals that means."""
    info = request["goal_info"]
    uuid = b64decode(info["goal_id"]["uuid"])
    stamp = info["stamp"]["secs"] * 1_000_000_000 + info["stamp"]["nsecs"]
    chosen = list(_chosen(action, uuid, stamp))
    for goal in chosen:
        goal.cancel()
    known = bool(chosen) or not any(uuid)
    return {
        "return_code": 0 if known else 2,  # ERROR_NONE, ERROR_UNKNOWN_GOAL_ID
        "goals_canceling": [_info(goal) for goal in chosen],
    }


def _chosen(action: Action, uuid: bytes, stamp: int) -> Iterator[Goal]:
    """The goal of the UUID and those accepted up to the stamp; all if neither is given."""
    everything = not any(uuid) and not stamp
    for goal in action.goals.values():
        if everything or goal.uuid == uuid or goal.accepted <= stamp:
            yield goal


def _info(goal: Goal) -> dict[str, Any]:
    secs, nsecs = divmod(goal.accepted, 1_000_000_000)
    return {
        "goal_id": {"uuid": b64encode(goal.uuid).decode()},
        "stamp": {"secs": secs, "nsecs": nsecs},
    }
