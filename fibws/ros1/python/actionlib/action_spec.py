"""The message classes of an action, found through its ``...Action`` class."""

from __future__ import annotations

from typing import Any, NamedTuple

from actionlib.exceptions import ActionException


class ActionSpec(NamedTuple):
    """The classes of an action's topics, and of the result in a result message."""

    goal: Any
    result: Any
    feedback: Any
    plain_result: Any


def read_spec(action: Any) -> ActionSpec:
    """Return the classes of an action.

    Args:
        action: its class, such as ``FibonacciAction`` of ``actionlib_tutorials.msg``.

    Raises:
        ActionException: the class is not an action, such as ``FibonacciGoal``.
    """
    try:
        example = action()
        return ActionSpec(
            type(example.action_goal),
            type(example.action_result),
            type(example.action_feedback),
            type(example.action_result.result),
        )
    except (AttributeError, TypeError):
        raise ActionException(
            f"Type is not an action spec: {action}; it should be the class that ends in Action"
        ) from None
