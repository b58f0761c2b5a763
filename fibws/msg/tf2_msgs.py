"""The messages of tf2_msgs, written by fibws.interfaces.generator: do not edit."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import ClassVar

import fibws.interfaces as ros
from fibws.msg import actionlib_msgs, geometry_msgs, std_msgs

__all__ = [
    "LookupTransformAction",
    "LookupTransformActionFeedback",
    "LookupTransformActionGoal",
    "LookupTransformActionResult",
    "LookupTransformFeedback",
    "LookupTransformGoal",
    "LookupTransformResult",
    "TF2Error",
    "TFMessage",
]


@dataclass(slots=True, eq=False, repr=False)
class LookupTransformGoal(ros.Message):
    """tf2_msgs/LookupTransformGoal"""

    _type: ClassVar[str] = "tf2_msgs/LookupTransformGoal"

    target_frame: str = ""
    source_frame: str = ""
    source_time: ros.Time = field(default_factory=ros.Time)
    timeout: ros.Duration = field(default_factory=ros.Duration)
    target_time: ros.Time = field(default_factory=ros.Time)
    fixed_frame: str = ""
    advanced: bool = False


@dataclass(slots=True, eq=False, repr=False)
class LookupTransformActionGoal(ros.Message):
    """tf2_msgs/LookupTransformActionGoal"""

    _type: ClassVar[str] = "tf2_msgs/LookupTransformActionGoal"

    header: std_msgs.Header = field(default_factory=lambda: std_msgs.Header())
    goal_id: actionlib_msgs.GoalID = field(default_factory=lambda: actionlib_msgs.GoalID())
    goal: LookupTransformGoal = field(default_factory=lambda: LookupTransformGoal())


@dataclass(slots=True, eq=False, repr=False)
class TF2Error(ros.Message):
    """tf2_msgs/TF2Error"""

    _type: ClassVar[str] = "tf2_msgs/TF2Error"
    NO_ERROR: ClassVar[int] = 0
    LOOKUP_ERROR: ClassVar[int] = 1
    CONNECTIVITY_ERROR: ClassVar[int] = 2
    EXTRAPOLATION_ERROR: ClassVar[int] = 3
    INVALID_ARGUMENT_ERROR: ClassVar[int] = 4
    TIMEOUT_ERROR: ClassVar[int] = 5
    TRANSFORM_ERROR: ClassVar[int] = 6

    error: int = 0
    error_string: str = ""


@dataclass(slots=True, eq=False, repr=False)
class LookupTransformResult(ros.Message):
    """tf2_msgs/LookupTransformResult"""

    _type: ClassVar[str] = "tf2_msgs/LookupTransformResult"

    transform: geometry_msgs.TransformStamped = field(
        default_factory=lambda: geometry_msgs.TransformStamped()
    )
    error: TF2Error = field(default_factory=lambda: TF2Error())


@dataclass(slots=True, eq=False, repr=False)
class LookupTransformActionResult(ros.Message):
    """tf2_msgs/LookupTransformActionResult"""

    _type: ClassVar[str] = "tf2_msgs/LookupTransformActionResult"

    header: std_msgs.Header = field(default_factory=lambda: std_msgs.Header())
    status: actionlib_msgs.GoalStatus = field(default_factory=lambda: actionlib_msgs.GoalStatus())
    result: LookupTransformResult = field(default_factory=lambda: LookupTransformResult())


@dataclass(slots=True, eq=False, repr=False)
class LookupTransformFeedback(ros.Message):
    """tf2_msgs/LookupTransformFeedback"""

    _type: ClassVar[str] = "tf2_msgs/LookupTransformFeedback"


@dataclass(slots=True, eq=False, repr=False)
class LookupTransformActionFeedback(ros.Message):
    """tf2_msgs/LookupTransformActionFeedback"""

    _type: ClassVar[str] = "tf2_msgs/LookupTransformActionFeedback"

    header: std_msgs.Header = field(default_factory=lambda: std_msgs.Header())
    status: actionlib_msgs.GoalStatus = field(default_factory=lambda: actionlib_msgs.GoalStatus())
    feedback: LookupTransformFeedback = field(default_factory=lambda: LookupTransformFeedback())


@dataclass(slots=True, eq=False, repr=False)
class LookupTransformAction(ros.Message):
    """tf2_msgs/LookupTransformAction"""

    _type: ClassVar[str] = "tf2_msgs/LookupTransformAction"

    action_goal: LookupTransformActionGoal = field(
        default_factory=lambda: LookupTransformActionGoal()
    )
    action_result: LookupTransformActionResult = field(
        default_factory=lambda: LookupTransformActionResult()
    )
    action_feedback: LookupTransformActionFeedback = field(
        default_factory=lambda: LookupTransformActionFeedback()
    )


@dataclass(slots=True, eq=False, repr=False)
class TFMessage(ros.Message):
    """tf2_msgs/TFMessage"""

    _type: ClassVar[str] = "tf2_msgs/TFMessage"

    transforms: list[geometry_msgs.TransformStamped] = field(default_factory=list)
