"""An action's messages on their way to the wire and back."""

from __future__ import annotations

import pytest

from fibws.action.tf2_msgs import LookupTransform
from fibws.errors import InterfaceError, InvalidMessage
from fibws.interfaces import Action, Duration
from fibws.msg.actionlib_tutorials import FibonacciFeedback, FibonacciGoal, FibonacciResult
from fibws.msg.geometry_msgs import TransformStamped
from fibws.node.actions.action_type import ActionType
from fibws.node.types import Types

from .conftest import FibonacciType


def test_messages_go_there_and_back(fibonacci: FibonacciType) -> None:
    goal, result, feedback = FibonacciGoal(5), FibonacciResult([0, 1]), FibonacciFeedback([0])
    assert fibonacci.goal.read(fibonacci.goal.write(goal)) == goal
    assert fibonacci.result.read(fibonacci.result.write(result)) == result
    assert fibonacci.feedback.read(fibonacci.feedback.write(feedback)) == feedback


def test_each_may_be_a_dict_whose_fields_may_be_messages(types: Types) -> None:
    look = ActionType(types, LookupTransform)
    assert look.goal.write({"timeout": Duration(1, 5)})["timeout"] == {"secs": 1, "nsecs": 5}
    transform = TransformStamped(child_frame_id="base")
    assert look.result.write({"transform": transform})["transform"]["child_frame_id"] == "base"
    with pytest.raises(InvalidMessage, match="does not have a field odor"):
        look.feedback.write({"odor": 5})


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
