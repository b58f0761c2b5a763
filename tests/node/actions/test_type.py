"""An action's messages on their way to the wire and back."""

from __future__ import annotations

from typing import Any

import pytest

from fibws.errors import InterfaceError, InvalidMessage
from fibws.interfaces import Action
from fibws.msg.actionlib_tutorials import FibonacciFeedback, FibonacciGoal, FibonacciResult
from fibws.msg.std_msgs import Int32
from fibws.node.actions.type import ActionType
from fibws.node.types import Types

from .conftest import FibonacciType


def test_messages_go_there_and_back(fibonacci: FibonacciType) -> None:
    goal, result, feedback = FibonacciGoal(5), FibonacciResult([0, 1]), FibonacciFeedback([0])
    assert fibonacci.read_goal(fibonacci.write_goal(goal)) == goal
    assert fibonacci.read_result(fibonacci.write_result(result)) == result
    assert fibonacci.read_feedback(fibonacci.write_feedback(feedback)) == feedback


def test_a_goal_may_be_a_dict_of_its_fields(fibonacci: FibonacciType) -> None:
    assert fibonacci.write_goal({"order": 5}) == {"order": 5}
    assert fibonacci.write_goal({}) == {"order": 0}
    with pytest.raises(InvalidMessage, match="does not have a field odor"):
        fibonacci.write_goal({"odor": 5})


def test_what_does_not_fit_is_named(fibonacci: FibonacciType) -> None:
    with pytest.raises(InvalidMessage, match="order"):
        fibonacci.write_goal(FibonacciGoal(2**31))
    with pytest.raises(InvalidMessage, match=r"sequence\[1\]"):
        fibonacci.read_result({"sequence": [0, "one"]})


def test_a_message_of_another_class_is_none_of_the_actions(fibonacci: FibonacciType) -> None:
    other: Any = Int32(5)
    with pytest.raises(
        TypeError,
        match=r"expected \[actionlib_tutorials/FibonacciGoal\] but got \[std_msgs/Int32\]",
    ):
        fibonacci.write_goal(other)
    nothing: Any = None
    with pytest.raises(TypeError, match=r"FibonacciResult\] but got \[NoneType\]"):
        fibonacci.write_result(nothing)


def test_standard_types_need_no_definition(fibonacci: FibonacciType) -> None:
    assert fibonacci.definition is None


def test_a_class_of_a_type_that_is_not_there(types: Types) -> None:
    class Lost(Action[FibonacciGoal, FibonacciResult, FibonacciFeedback]):
        _type = "actionlib_tutorials/Lost"
        Goal = FibonacciGoal
        Result = FibonacciResult
        Feedback = FibonacciFeedback

    with pytest.raises(InterfaceError, match="Lost"):
        ActionType(types, Lost)
