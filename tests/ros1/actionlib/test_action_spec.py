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


def test_action_class_has_all_message_classes() -> None:
    assert read_spec(FibonacciAction) == (
        FibonacciActionGoal,
        FibonacciActionResult,
        FibonacciActionFeedback,
        FibonacciResult,
    )


@pytest.mark.parametrize("wrong", [FibonacciGoal, FibonacciAction(), "Fibonacci", None])
def test_other_classes_are_refused(wrong: object) -> None:
    with pytest.raises(ActionException, match=r"(?s)Type is not an action spec: .*ends in Action"):
        read_spec(wrong)
