"""The messages of action_tutorials_interfaces, written by fibws.interfaces.generator: do not edit."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import ClassVar

import fibws.interfaces as ros
from fibws.msg import actionlib_msgs, std_msgs

__all__ = [
    "FibonacciAction",
    "FibonacciActionFeedback",
    "FibonacciActionGoal",
    "FibonacciActionResult",
    "FibonacciFeedback",
    "FibonacciGoal",
    "FibonacciResult",
]


@dataclass(slots=True, eq=False, repr=False)
class FibonacciGoal(ros.Message):
    """action_tutorials_interfaces/FibonacciGoal"""

    _type: ClassVar[str] = "action_tutorials_interfaces/FibonacciGoal"

    order: int = 0


@dataclass(slots=True, eq=False, repr=False)
class FibonacciActionGoal(ros.Message):
    """action_tutorials_interfaces/FibonacciActionGoal"""

    _type: ClassVar[str] = "action_tutorials_interfaces/FibonacciActionGoal"

    header: std_msgs.Header = field(default_factory=lambda: std_msgs.Header())
    goal_id: actionlib_msgs.GoalID = field(default_factory=lambda: actionlib_msgs.GoalID())
    goal: FibonacciGoal = field(default_factory=lambda: FibonacciGoal())


@dataclass(slots=True, eq=False, repr=False)
class FibonacciResult(ros.Message):
    """action_tutorials_interfaces/FibonacciResult"""

    _type: ClassVar[str] = "action_tutorials_interfaces/FibonacciResult"

    sequence: list[int] = field(default_factory=list)


@dataclass(slots=True, eq=False, repr=False)
class FibonacciActionResult(ros.Message):
    """action_tutorials_interfaces/FibonacciActionResult"""

    _type: ClassVar[str] = "action_tutorials_interfaces/FibonacciActionResult"

    header: std_msgs.Header = field(default_factory=lambda: std_msgs.Header())
    status: actionlib_msgs.GoalStatus = field(default_factory=lambda: actionlib_msgs.GoalStatus())
    result: FibonacciResult = field(default_factory=lambda: FibonacciResult())


@dataclass(slots=True, eq=False, repr=False)
class FibonacciFeedback(ros.Message):
    """action_tutorials_interfaces/FibonacciFeedback"""

    _type: ClassVar[str] = "action_tutorials_interfaces/FibonacciFeedback"

    partial_sequence: list[int] = field(default_factory=list)


@dataclass(slots=True, eq=False, repr=False)
class FibonacciActionFeedback(ros.Message):
    """action_tutorials_interfaces/FibonacciActionFeedback"""

    _type: ClassVar[str] = "action_tutorials_interfaces/FibonacciActionFeedback"

    header: std_msgs.Header = field(default_factory=lambda: std_msgs.Header())
    status: actionlib_msgs.GoalStatus = field(default_factory=lambda: actionlib_msgs.GoalStatus())
    feedback: FibonacciFeedback = field(default_factory=lambda: FibonacciFeedback())


@dataclass(slots=True, eq=False, repr=False)
class FibonacciAction(ros.Message):
    """action_tutorials_interfaces/FibonacciAction"""

    _type: ClassVar[str] = "action_tutorials_interfaces/FibonacciAction"

    action_goal: FibonacciActionGoal = field(default_factory=lambda: FibonacciActionGoal())
    action_result: FibonacciActionResult = field(default_factory=lambda: FibonacciActionResult())
    action_feedback: FibonacciActionFeedback = field(
        default_factory=lambda: FibonacciActionFeedback()
    )
