"""The messages of actionlib, written by fibws.interfaces.generator: do not edit."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import ClassVar

import fibws.interfaces as ros
from fibws.msg import actionlib_msgs, std_msgs

__all__ = [
    "TestAction",
    "TestActionFeedback",
    "TestActionGoal",
    "TestActionResult",
    "TestFeedback",
    "TestGoal",
    "TestRequestAction",
    "TestRequestActionFeedback",
    "TestRequestActionGoal",
    "TestRequestActionResult",
    "TestRequestFeedback",
    "TestRequestGoal",
    "TestRequestResult",
    "TestResult",
    "TwoIntsAction",
    "TwoIntsActionFeedback",
    "TwoIntsActionGoal",
    "TwoIntsActionResult",
    "TwoIntsFeedback",
    "TwoIntsGoal",
    "TwoIntsResult",
]


@dataclass(slots=True, eq=False, repr=False)
class TestGoal(ros.Message):
    """actionlib/TestGoal"""

    _type: ClassVar[str] = "actionlib/TestGoal"

    goal: int = 0


@dataclass(slots=True, eq=False, repr=False)
class TestActionGoal(ros.Message):
    """actionlib/TestActionGoal"""

    _type: ClassVar[str] = "actionlib/TestActionGoal"

    header: std_msgs.Header = field(default_factory=lambda: std_msgs.Header())
    goal_id: actionlib_msgs.GoalID = field(default_factory=lambda: actionlib_msgs.GoalID())
    goal: TestGoal = field(default_factory=lambda: TestGoal())


@dataclass(slots=True, eq=False, repr=False)
class TestResult(ros.Message):
    """actionlib/TestResult"""

    _type: ClassVar[str] = "actionlib/TestResult"

    result: int = 0


@dataclass(slots=True, eq=False, repr=False)
class TestActionResult(ros.Message):
    """actionlib/TestActionResult"""

    _type: ClassVar[str] = "actionlib/TestActionResult"

    header: std_msgs.Header = field(default_factory=lambda: std_msgs.Header())
    status: actionlib_msgs.GoalStatus = field(default_factory=lambda: actionlib_msgs.GoalStatus())
    result: TestResult = field(default_factory=lambda: TestResult())


@dataclass(slots=True, eq=False, repr=False)
class TestFeedback(ros.Message):
    """actionlib/TestFeedback"""

    _type: ClassVar[str] = "actionlib/TestFeedback"

    feedback: int = 0


@dataclass(slots=True, eq=False, repr=False)
class TestActionFeedback(ros.Message):
    """actionlib/TestActionFeedback"""

    _type: ClassVar[str] = "actionlib/TestActionFeedback"

    header: std_msgs.Header = field(default_factory=lambda: std_msgs.Header())
    status: actionlib_msgs.GoalStatus = field(default_factory=lambda: actionlib_msgs.GoalStatus())
    feedback: TestFeedback = field(default_factory=lambda: TestFeedback())


@dataclass(slots=True, eq=False, repr=False)
class TestAction(ros.Message):
    """actionlib/TestAction"""

    _type: ClassVar[str] = "actionlib/TestAction"

    action_goal: TestActionGoal = field(default_factory=lambda: TestActionGoal())
    action_result: TestActionResult = field(default_factory=lambda: TestActionResult())
    action_feedback: TestActionFeedback = field(default_factory=lambda: TestActionFeedback())


@dataclass(slots=True, eq=False, repr=False)
class TestRequestGoal(ros.Message):
    """actionlib/TestRequestGoal"""

    _type: ClassVar[str] = "actionlib/TestRequestGoal"
    TERMINATE_SUCCESS: ClassVar[int] = 0
    TERMINATE_ABORTED: ClassVar[int] = 1
    TERMINATE_REJECTED: ClassVar[int] = 2
    TERMINATE_LOSE: ClassVar[int] = 3
    TERMINATE_DROP: ClassVar[int] = 4
    TERMINATE_EXCEPTION: ClassVar[int] = 5

    terminate_status: int = 0
    ignore_cancel: bool = False
    result_text: str = ""
    the_result: int = 0
    is_simple_client: bool = False
    delay_accept: ros.Duration = field(default_factory=ros.Duration)
    delay_terminate: ros.Duration = field(default_factory=ros.Duration)
    pause_status: ros.Duration = field(default_factory=ros.Duration)


@dataclass(slots=True, eq=False, repr=False)
class TestRequestActionGoal(ros.Message):
    """actionlib/TestRequestActionGoal"""

    _type: ClassVar[str] = "actionlib/TestRequestActionGoal"

    header: std_msgs.Header = field(default_factory=lambda: std_msgs.Header())
    goal_id: actionlib_msgs.GoalID = field(default_factory=lambda: actionlib_msgs.GoalID())
    goal: TestRequestGoal = field(default_factory=lambda: TestRequestGoal())


@dataclass(slots=True, eq=False, repr=False)
class TestRequestResult(ros.Message):
    """actionlib/TestRequestResult"""

    _type: ClassVar[str] = "actionlib/TestRequestResult"

    the_result: int = 0
    is_simple_server: bool = False


@dataclass(slots=True, eq=False, repr=False)
class TestRequestActionResult(ros.Message):
    """actionlib/TestRequestActionResult"""

    _type: ClassVar[str] = "actionlib/TestRequestActionResult"

    header: std_msgs.Header = field(default_factory=lambda: std_msgs.Header())
    status: actionlib_msgs.GoalStatus = field(default_factory=lambda: actionlib_msgs.GoalStatus())
    result: TestRequestResult = field(default_factory=lambda: TestRequestResult())


@dataclass(slots=True, eq=False, repr=False)
class TestRequestFeedback(ros.Message):
    """actionlib/TestRequestFeedback"""

    _type: ClassVar[str] = "actionlib/TestRequestFeedback"


@dataclass(slots=True, eq=False, repr=False)
class TestRequestActionFeedback(ros.Message):
    """actionlib/TestRequestActionFeedback"""

    _type: ClassVar[str] = "actionlib/TestRequestActionFeedback"

    header: std_msgs.Header = field(default_factory=lambda: std_msgs.Header())
    status: actionlib_msgs.GoalStatus = field(default_factory=lambda: actionlib_msgs.GoalStatus())
    feedback: TestRequestFeedback = field(default_factory=lambda: TestRequestFeedback())


@dataclass(slots=True, eq=False, repr=False)
class TestRequestAction(ros.Message):
    """actionlib/TestRequestAction"""

    _type: ClassVar[str] = "actionlib/TestRequestAction"

    action_goal: TestRequestActionGoal = field(default_factory=lambda: TestRequestActionGoal())
    action_result: TestRequestActionResult = field(
        default_factory=lambda: TestRequestActionResult()
    )
    action_feedback: TestRequestActionFeedback = field(
        default_factory=lambda: TestRequestActionFeedback()
    )


@dataclass(slots=True, eq=False, repr=False)
class TwoIntsGoal(ros.Message):
    """actionlib/TwoIntsGoal"""

    _type: ClassVar[str] = "actionlib/TwoIntsGoal"

    a: int = 0
    b: int = 0


@dataclass(slots=True, eq=False, repr=False)
class TwoIntsActionGoal(ros.Message):
    """actionlib/TwoIntsActionGoal"""

    _type: ClassVar[str] = "actionlib/TwoIntsActionGoal"

    header: std_msgs.Header = field(default_factory=lambda: std_msgs.Header())
    goal_id: actionlib_msgs.GoalID = field(default_factory=lambda: actionlib_msgs.GoalID())
    goal: TwoIntsGoal = field(default_factory=lambda: TwoIntsGoal())


@dataclass(slots=True, eq=False, repr=False)
class TwoIntsResult(ros.Message):
    """actionlib/TwoIntsResult"""

    _type: ClassVar[str] = "actionlib/TwoIntsResult"

    sum: int = 0


@dataclass(slots=True, eq=False, repr=False)
class TwoIntsActionResult(ros.Message):
    """actionlib/TwoIntsActionResult"""

    _type: ClassVar[str] = "actionlib/TwoIntsActionResult"

    header: std_msgs.Header = field(default_factory=lambda: std_msgs.Header())
    status: actionlib_msgs.GoalStatus = field(default_factory=lambda: actionlib_msgs.GoalStatus())
    result: TwoIntsResult = field(default_factory=lambda: TwoIntsResult())


@dataclass(slots=True, eq=False, repr=False)
class TwoIntsFeedback(ros.Message):
    """actionlib/TwoIntsFeedback"""

    _type: ClassVar[str] = "actionlib/TwoIntsFeedback"


@dataclass(slots=True, eq=False, repr=False)
class TwoIntsActionFeedback(ros.Message):
    """actionlib/TwoIntsActionFeedback"""

    _type: ClassVar[str] = "actionlib/TwoIntsActionFeedback"

    header: std_msgs.Header = field(default_factory=lambda: std_msgs.Header())
    status: actionlib_msgs.GoalStatus = field(default_factory=lambda: actionlib_msgs.GoalStatus())
    feedback: TwoIntsFeedback = field(default_factory=lambda: TwoIntsFeedback())


@dataclass(slots=True, eq=False, repr=False)
class TwoIntsAction(ros.Message):
    """actionlib/TwoIntsAction"""

    _type: ClassVar[str] = "actionlib/TwoIntsAction"

    action_goal: TwoIntsActionGoal = field(default_factory=lambda: TwoIntsActionGoal())
    action_result: TwoIntsActionResult = field(default_factory=lambda: TwoIntsActionResult())
    action_feedback: TwoIntsActionFeedback = field(default_factory=lambda: TwoIntsActionFeedback())
