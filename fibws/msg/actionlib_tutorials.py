"""The messages of actionlib_tutorials, written by fibws.interfaces.generator: do not edit."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import ClassVar

import fibws.interfaces as ros
from fibws.msg import actionlib_msgs, std_msgs

__all__ = [
    "AveragingAction",
    "AveragingActionFeedback",
    "AveragingActionGoal",
    "AveragingActionResult",
    "AveragingFeedback",
    "AveragingGoal",
    "AveragingResult",
    "FibonacciAction",
    "FibonacciActionFeedback",
    "FibonacciActionGoal",
    "FibonacciActionResult",
    "FibonacciFeedback",
    "FibonacciGoal",
    "FibonacciResult",
]


@dataclass(slots=True, eq=False, repr=False)
class AveragingGoal(ros.Message):
    """actionlib_tutorials/AveragingGoal"""

    _type: ClassVar[str] = "actionlib_tutorials/AveragingGoal"

    samples: int = 0


@dataclass(slots=True, eq=False, repr=False)
class AveragingActionGoal(ros.Message):
    """actionlib_tutorials/AveragingActionGoal"""

    _type: ClassVar[str] = "actionlib_tutorials/AveragingActionGoal"

    header: std_msgs.Header = field(default_factory=lambda: std_msgs.Header())
    goal_id: actionlib_msgs.GoalID = field(default_factory=lambda: actionlib_msgs.GoalID())
    goal: AveragingGoal = field(default_factory=lambda: AveragingGoal())


@dataclass(slots=True, eq=False, repr=False)
class AveragingResult(ros.Message):
    """actionlib_tutorials/AveragingResult"""

    _type: ClassVar[str] = "actionlib_tutorials/AveragingResult"

    mean: float = 0.0
    std_dev: float = 0.0


@dataclass(slots=True, eq=False, repr=False)
class AveragingActionResult(ros.Message):
    """actionlib_tutorials/AveragingActionResult"""

    _type: ClassVar[str] = "actionlib_tutorials/AveragingActionResult"

    header: std_msgs.Header = field(default_factory=lambda: std_msgs.Header())
    status: actionlib_msgs.GoalStatus = field(default_factory=lambda: actionlib_msgs.GoalStatus())
    result: AveragingResult = field(default_factory=lambda: AveragingResult())


@dataclass(slots=True, eq=False, repr=False)
class AveragingFeedback(ros.Message):
    """actionlib_tutorials/AveragingFeedback"""

    _type: ClassVar[str] = "actionlib_tutorials/AveragingFeedback"

    sample: int = 0
    data: float = 0.0
    mean: float = 0.0
    std_dev: float = 0.0


@dataclass(slots=True, eq=False, repr=False)
class AveragingActionFeedback(ros.Message):
    """actionlib_tutorials/AveragingActionFeedback"""

    _type: ClassVar[str] = "actionlib_tutorials/AveragingActionFeedback"

    header: std_msgs.Header = field(default_factory=lambda: std_msgs.Header())
    status: actionlib_msgs.GoalStatus = field(default_factory=lambda: actionlib_msgs.GoalStatus())
    feedback: AveragingFeedback = field(default_factory=lambda: AveragingFeedback())


@dataclass(slots=True, eq=False, repr=False)
class AveragingAction(ros.Message):
    """actionlib_tutorials/AveragingAction"""

    _type: ClassVar[str] = "actionlib_tutorials/AveragingAction"

    action_goal: AveragingActionGoal = field(default_factory=lambda: AveragingActionGoal())
    action_result: AveragingActionResult = field(default_factory=lambda: AveragingActionResult())
    action_feedback: AveragingActionFeedback = field(
        default_factory=lambda: AveragingActionFeedback()
    )


@dataclass(slots=True, eq=False, repr=False)
class FibonacciGoal(ros.Message):
    """actionlib_tutorials/FibonacciGoal"""

    _type: ClassVar[str] = "actionlib_tutorials/FibonacciGoal"

    order: int = 0


@dataclass(slots=True, eq=False, repr=False)
class FibonacciActionGoal(ros.Message):
    """actionlib_tutorials/FibonacciActionGoal"""

    _type: ClassVar[str] = "actionlib_tutorials/FibonacciActionGoal"

    header: std_msgs.Header = field(default_factory=lambda: std_msgs.Header())
    goal_id: actionlib_msgs.GoalID = field(default_factory=lambda: actionlib_msgs.GoalID())
    goal: FibonacciGoal = field(default_factory=lambda: FibonacciGoal())


@dataclass(slots=True, eq=False, repr=False)
class FibonacciResult(ros.Message):
    """actionlib_tutorials/FibonacciResult"""

    _type: ClassVar[str] = "actionlib_tutorials/FibonacciResult"

    sequence: list[int] = field(default_factory=list)


@dataclass(slots=True, eq=False, repr=False)
class FibonacciActionResult(ros.Message):
    """actionlib_tutorials/FibonacciActionResult"""

    _type: ClassVar[str] = "actionlib_tutorials/FibonacciActionResult"

    header: std_msgs.Header = field(default_factory=lambda: std_msgs.Header())
    status: actionlib_msgs.GoalStatus = field(default_factory=lambda: actionlib_msgs.GoalStatus())
    result: FibonacciResult = field(default_factory=lambda: FibonacciResult())


@dataclass(slots=True, eq=False, repr=False)
class FibonacciFeedback(ros.Message):
    """actionlib_tutorials/FibonacciFeedback"""

    _type: ClassVar[str] = "actionlib_tutorials/FibonacciFeedback"

    sequence: list[int] = field(default_factory=list)


@dataclass(slots=True, eq=False, repr=False)
class FibonacciActionFeedback(ros.Message):
    """actionlib_tutorials/FibonacciActionFeedback"""

    _type: ClassVar[str] = "actionlib_tutorials/FibonacciActionFeedback"

    header: std_msgs.Header = field(default_factory=lambda: std_msgs.Header())
    status: actionlib_msgs.GoalStatus = field(default_factory=lambda: actionlib_msgs.GoalStatus())
    feedback: FibonacciFeedback = field(default_factory=lambda: FibonacciFeedback())


@dataclass(slots=True, eq=False, repr=False)
class FibonacciAction(ros.Message):
    """actionlib_tutorials/FibonacciAction"""

    _type: ClassVar[str] = "actionlib_tutorials/FibonacciAction"

    action_goal: FibonacciActionGoal = field(default_factory=lambda: FibonacciActionGoal())
    action_result: FibonacciActionResult = field(default_factory=lambda: FibonacciActionResult())
    action_feedback: FibonacciActionFeedback = field(
        default_factory=lambda: FibonacciActionFeedback()
    )
