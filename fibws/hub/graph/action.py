"""Actions: their servers, and their goals until the result.

As in ROS 2 (action_msgs): a goal is accepted, may send feedback, and ends with one result.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from enum import IntEnum
from typing import Any, Protocol

from fibws.hub.errors import NotAllowed
from fibws.hub.graph.body import Body, check_serialized
from fibws.hub.graph.types import ActionType
from fibws.interfaces import base64text
from fibws.interfaces.serialized_values import SerializedValues

GOAL, FEEDBACK, RESULT = 0, 1, 2
"""The messages of an action's type."""
CANCEL_SUFFIX = "/_action/cancel_goal"
"""The suffix of an action's name in the name of the service that cancels its goals."""


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
    """Executes the goals of actions."""

    @property
    def node(self) -> str:
        """The name of its node."""

    def execute(self, goal: Goal) -> None:
        """Begin to execute a goal."""

    def cancel(self, goal: Goal) -> None:
        """Stop executing a goal; it still ends with a result."""

    def forget(self, goal: Goal) -> None:
        """Forget a goal that has ended."""

    def displaced(self, action: Action) -> None:
        """Called when another server has taken the action over."""


class ActionClient(Protocol):
    """Sent a goal."""

    def feedback(self, goal: Goal, feedback: Body) -> None:
        """Take a goal's feedback."""

    def result(self, goal: Goal, status: Ros2GoalStatus, result: Body) -> None:
        """Take a goal's end with its result."""

    def failed(self, goal: Goal, status: Ros2GoalStatus, text: str, code: str) -> None:
        """Take a goal's end without a result, and why."""


class Goals(dict[bytes, "Goal"]):
    """The goals of an action's name that have not ended, by their UUIDs."""

    __slots__ = ("__weakref__",)


@dataclass(slots=True, eq=False)
class Action:
    """One action of the graph, as its server has advertised it."""

    name: str
    type: ActionType
    server: ActionServer
    goals: Goals = field(default_factory=Goals)
    """Its goals that have not ended, and those of earlier advertisements of its name."""

    @property
    def node(self) -> str:
        """The node that serves it."""
        return self.server.node


class Goal:
    """One goal, from its start to its result.

    Args:
        args: the goal's fields: an object, a list in their order, or `SerializedValues`.
        caller: the node that sends it.
        uuid: 16 bytes that no other goal has.
        accepted: when, in nanoseconds since 1970.

    Raises:
        InvalidMessage: the goal does not fit the type.
        NotSerialized: it is serialized by another definition.
    """

    __slots__ = ("_canceling", "_client", "accepted", "action", "caller", "id", "request", "uuid")

    def __init__(
        self,
        action: Action,
        args: object,
        client: ActionClient,
        caller: str,
        uuid: bytes,
        accepted: int,
    ) -> None:
        self.action = action
        self.caller = caller
        self.request = self._body(GOAL, args, action.type.fill_goal)
        """With every field filled."""
        self.uuid = uuid
        self.accepted = accepted
        self.id = ""
        """Its id at the server."""
        self._client = client
        self._canceling = False

    def start(self) -> None:
        """Pass the goal to the server."""
        self.action.goals[self.uuid] = self
        self.action.server.execute(self)
        # The server has it; a large goal need not be kept until it ends.
        self.request = Body(self.action.type, GOAL, values={})

    def feedback(self, values: object) -> None:
        """Pass the server's feedback to the client: an object, or `SerializedValues`.

        Raises:
            InvalidMessage: it does not fit the type.
            NotSerialized: it is serialized by another definition.
        """
        feedback = self._body(FEEDBACK, values, self.action.type.feedback)
        self._client.feedback(self, feedback)

    def finish(self, status: Ros2GoalStatus, values: object) -> None:
        """End with the server's result; if that raises as `feedback`, the goal goes on."""
        result = self._body(RESULT, values, self.action.type.result)
        if self._close():
            self._client.result(self, status, result)

    def fail(
        self,
        text: str,
        code: str = "server_failed",
        status: Ros2GoalStatus = Ros2GoalStatus.ABORTED,
    ) -> None:
        """End without a result; codes are those of `CallFailed`."""
        if self._close():
            self._client.failed(self, status, text, code)

    def cancel(self) -> None:
        """Ask the server to stop, once."""
        if not self._canceling:
            self._canceling = True
            self.action.server.cancel(self)

    def abandon(self) -> None:
        """Cancel the goal of a client that has left."""
        if self.action.goals.pop(self.uuid, None) is not None:
            self.cancel()
            self.action.server.forget(self)

    def withdraw(self) -> None:
        """Cancel the goal of a client that has lost the right to it, and end it at once."""
        error = NotAllowed(self.caller, "call", self.action.name)
        self.cancel()
        self.fail(f"{error}; the goal was cancelled", error.code)

    def _close(self) -> bool:
        """Return whether this is the goal's one end."""
        is_first = self.action.goals.pop(self.uuid, None) is not None
        if is_first:
            self.action.server.forget(self)
        return is_first

    def _body(
        self, message: int, given: object, validate: Callable[[object], dict[str, Any]]
    ) -> Body:
        type_ = self.action.type
        if isinstance(given, SerializedValues):
            return check_serialized(type_, message, given, type_.name, type_.md5sum)
        return Body(type_, message, values=validate(given))


def cancel_service(action: str) -> str:
    """Return the name of the service that cancels an action's goals, as in ROS 2."""
    return action + CANCEL_SUFFIX


def cancel_goals(
    action: Action, request: dict[str, Any], may_cancel: Callable[[Goal], bool]
) -> dict[str, Any]:
    """Respond to a call of action_msgs/CancelGoal, whose definition specifies the meant goals.

    Goals that the caller may not cancel look unknown.
    """
    info = request["goal_info"]
    uuid = base64text.decode(info["goal_id"]["uuid"])
    stamp = info["stamp"]["secs"] * 1_000_000_000 + info["stamp"]["nsecs"]
    chosen = [goal for goal in _chosen(action, uuid, stamp) if may_cancel(goal)]
    for goal in chosen:
        goal.cancel()
    known = bool(chosen) or not any(uuid)
    return {
        "return_code": 0 if known else 2,  # ERROR_NONE, ERROR_UNKNOWN_GOAL_ID
        "goals_canceling": [_info(goal) for goal in chosen],
    }


def _chosen(action: Action, uuid: bytes, stamp: int) -> Iterator[Goal]:
    """Return the goal of the UUID and those accepted up to the stamp; all if neither is given.

    A stamp of 0 means that none is given, even at simulated time 0, as in rcl's
    ``rcl_action_process_cancel_request``.
    """
    everything = not any(uuid) and not stamp
    for goal in action.goals.values():
        if everything or goal.uuid == uuid or (stamp and goal.accepted <= stamp):
            yield goal


def _info(goal: Goal) -> dict[str, Any]:
    secs, nsecs = divmod(goal.accepted, 1_000_000_000)
    return {
        "goal_id": {"uuid": base64text.encode(goal.uuid)},
        "stamp": {"secs": secs, "nsecs": nsecs},
    }
