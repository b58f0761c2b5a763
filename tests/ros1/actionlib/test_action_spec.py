"""Which classes belong to an action."""

from __future__ import annotations

import pytest
from actionlib import ActionException
from actionlib.action_spec import read_spec
from actionlib_tutorials.msg import (
    FibonacciAction,
    FibonacciActionFeedback,
    FibonacciActionGoal,
    FibonacciActionResult,
    FibonacciGoal,
    FibonacciResult,
)


def test_an_action_names_its_messages() -> None:
    assert read_spec(FibonacciAction) == (
        FibonacciActionGoal,
        FibonacciActionResult,
        FibonacciActionFeedback,
        FibonacciResult,
    )


@pytest.mark.parametrize("wrong", [FibonacciGoal, FibonacciAction(), "Fibonacci", None])
def test_another_class_is_no_action(wrong: object) -> None:
    with pytest.raises(ActionException, match=r"(?s)Type is not an action spec: .*ends in Action"):
        read_spec(wrong)
