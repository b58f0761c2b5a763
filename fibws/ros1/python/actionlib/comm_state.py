"""What a client knows of its goal, and how the server's word changes that.

Source: http://wiki.ros.org/actionlib/DetailedDescription, the client's state machine.
"""

from __future__ import annotations

from typing import Any

from actionlib_msgs.msg import GoalStatus


def get_name_of_constant(C: Any, n: int) -> str:
    """The name that a class has for a number."""
    name: str
    for name, value in vars(C).items():
        if type(value) is int and value == n:  # ``_has_header``, of messages, is a bool.
            return name
    return f"NO_SUCH_STATE_{n}"


class CommState:
    """How far a goal has come between its client and its server."""

    WAITING_FOR_GOAL_ACK = 0
    PENDING = 1
    ACTIVE = 2
    WAITING_FOR_RESULT = 3
    WAITING_FOR_CANCEL_ACK = 4
    RECALLING = 5
    PREEMPTING = 6
    DONE = 7
    LOST = 8

    to_string = classmethod(get_name_of_constant)


class TerminalState:
    """How a goal can have ended."""

    RECALLED = GoalStatus.RECALLED
    REJECTED = GoalStatus.REJECTED
    PREEMPTED = GoalStatus.PREEMPTED
    ABORTED = GoalStatus.ABORTED
    SUCCEEDED = GoalStatus.SUCCEEDED
    LOST = GoalStatus.LOST

    to_string = classmethod(get_name_of_constant)


GoalStatus.to_string = classmethod(get_name_of_constant)

FINAL = frozenset(
    {
        GoalStatus.PREEMPTED,
        GoalStatus.SUCCEEDED,
        GoalStatus.ABORTED,
        GoalStatus.REJECTED,
        GoalStatus.RECALLED,
        GoalStatus.LOST,
    }
)
"""The states of a goal that no other can follow."""

_STATUSES = (
    GoalStatus.PENDING,
    GoalStatus.ACTIVE,
    GoalStatus.PREEMPTED,
    GoalStatus.SUCCEEDED,
    GoalStatus.ABORTED,
    GoalStatus.REJECTED,
    GoalStatus.PREEMPTING,
    GoalStatus.RECALLING,
    GoalStatus.RECALLED,
)

_STEPS = {
    "p": CommState.PENDING,
    "a": CommState.ACTIVE,
    "w": CommState.WAITING_FOR_RESULT,
    "r": CommState.RECALLING,
    "x": CommState.PREEMPTING,
}

# The columns are of _STATUSES: pending active preempted succeeded aborted rejected preempting
# recalling recalled. A "-" stays where it is; a "!" cannot be.
_ROUTES = {
    CommState.WAITING_FOR_GOAL_ACK: "p a axw aw aw pw ax pr pw",
    CommState.PENDING: "- a axw aw aw w ax r rw",
    CommState.ACTIVE: "! - xw w w ! x ! !",
    CommState.WAITING_FOR_RESULT: "! - - - - - ! ! -",
    CommState.WAITING_FOR_CANCEL_ACK: "- - xw xw xw w x r rw",
    CommState.RECALLING: "! ! xw xw xw w x - w",
    CommState.PREEMPTING: "! ! w w w ! - ! !",
    CommState.DONE: "! ! - - - - ! ! -",
}


def _read(route: str) -> tuple[int, ...] | None:
    return None if route == "!" else tuple(_STEPS[step] for step in route if step != "-")


_FOLLOWING: dict[int, dict[int, tuple[int, ...] | None]] = {
    state: dict(zip(_STATUSES, map(_read, routes.split()), strict=True))
    for state, routes in _ROUTES.items()
}


def following(state: int, status: int) -> tuple[int, ...] | None:
    """The states through which the server's word leads; none if it is no news.

    Args:
        state: of `CommState`, but for LOST.
        status: of ``actionlib_msgs/GoalStatus``, but for LOST.

    Returns:
        None if the server cannot rightly say that now.

    Raises:
        KeyError: there is no such status.
    """
    return _FOLLOWING[state][status]
