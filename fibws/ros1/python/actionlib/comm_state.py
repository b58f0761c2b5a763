"""The states of a goal for its client, and their changes by the server's statuses.

Source: http://wiki.ros.org/actionlib/DetailedDescription, the client's state machine.
"""

from __future__ import annotations

from typing import Any

from actionlib_msgs.msg import GoalStatus


def get_name_of_constant(C: Any, n: int) -> str:
    """Return the name of a class's constant that has this value."""
    name: str
    for name, value in vars(C).items():
        if type(value) is int and value == n:  # Not ``_has_header`` of messages, which is a bool.
            return name
    return f"NO_SUCH_STATE_{n}"


class CommState:
    """The state of the communication about a goal between its client and its server."""

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
    """The final statuses of a goal."""

    RECALLED = GoalStatus.RECALLED
    REJECTED = GoalStatus.REJECTED
    PREEMPTED = GoalStatus.PREEMPTED
    ABORTED = GoalStatus.ABORTED
    SUCCEEDED = GoalStatus.SUCCEEDED
    LOST = GoalStatus.LOST

    to_string = classmethod(get_name_of_constant)


GoalStatus.to_string = classmethod(get_name_of_constant)

FINAL = frozenset(value for name, value in vars(TerminalState).items() if name.isupper())
"""The statuses that no other status can follow."""

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

# The columns are those of _STATUSES: pending active preempted succeeded aborted rejected preempting
# recalling recalled. "-" keeps the state; "!" is invalid.
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
    """Return the states to go through when the server reports a status; empty for no change.

    Args:
        state: one of `CommState`, except LOST.
        status: one of ``actionlib_msgs/GoalStatus``, except LOST.

    Returns:
        None if the status is invalid in this state.

    Raises:
        KeyError: the status is unknown.
    """
    return _FOLLOWING[state][status]
