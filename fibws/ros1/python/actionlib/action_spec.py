"""The message classes of an action, read off its ``...Action`` class."""

from __future__ import annotations

from typing import Any, NamedTuple

from actionlib.exceptions import ActionException


class ActionSpec(NamedTuple):
    """What is said on an action's topics, and the result that a result message holds."""

    goal: Any
    result: Any
    feedback: Any
    plain_result: Any


def read_spec(action: Any) -> ActionSpec:
    """The classes that belong to an action.

    Args:
        action: such as ``FibonacciAction`` of ``actionlib_tutorials.msg``.

    Raises:
        ActionException: it is another class, such as ``FibonacciGoal``.
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
