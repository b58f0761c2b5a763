"""Converting the messages of an action to JSON values and back."""

from __future__ import annotations

import pytest

from fibws.action.tf2_msgs import LookupTransform
from fibws.errors import InterfaceError, InvalidMessage
from fibws.interfaces import Action, Duration
from fibws.msg.actionlib_tutorials import FibonacciFeedback, FibonacciGoal, FibonacciResult
from fibws.msg.geometry_msgs import TransformStamped
from fibws.node.types import NodeActionType, NodeTypes

from .conftest import FibonacciType


def test_messages_are_the_same_after_writing_and_reading(fibonacci: FibonacciType) -> None:
    goal, result, feedback = FibonacciGoal(5), FibonacciResult([0, 1]), FibonacciFeedback([0])
    assert fibonacci.goal.read(fibonacci.goal.write(goal)) == goal
    assert fibonacci.result.read(fibonacci.result.write(result)) == result
    assert fibonacci.feedback.read(fibonacci.feedback.write(feedback)) == feedback


def test_message_may_be_a_dict_whose_fields_are_messages(types: NodeTypes) -> None:
    look = NodeActionType(types, LookupTransform)
    assert look.goal.write({"timeout": Duration(1, 5)})["timeout"] == {"secs": 1, "nsecs": 5}
    transform = TransformStamped(child_frame_id="base")
    assert look.result.write({"transform": transform})["transform"]["child_frame_id"] == "base"
    with pytest.raises(InvalidMessage, match="does not have a field odor"):
        look.feedback.write({"odor": 5})


def test_standard_type_needs_no_definition(fibonacci: FibonacciType) -> None:
    assert fibonacci.definition is None


def test_class_of_unknown_type_is_refused(types: NodeTypes) -> None:
    class Lost(Action[FibonacciGoal, FibonacciResult, FibonacciFeedback]):
        _type = "actionlib_tutorials/Lost"
        Goal = FibonacciGoal
        Result = FibonacciResult
        Feedback = FibonacciFeedback

    with pytest.raises(InterfaceError, match="Lost"):
        NodeActionType(types, Lost)
