"""The messages of tf2_web_republisher_interfaces, written by fibws.interfaces.generator: do not edit."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import ClassVar

import fibws.interfaces as ros
from fibws.msg import actionlib_msgs, geometry_msgs, std_msgs

__all__ = [
    "TFArray",
    "TFSubscriptionAction",
    "TFSubscriptionActionFeedback",
    "TFSubscriptionActionGoal",
    "TFSubscriptionActionResult",
    "TFSubscriptionFeedback",
    "TFSubscriptionGoal",
    "TFSubscriptionResult",
]


@dataclass(slots=True, eq=False, repr=False)
class TFArray(ros.Message):
    """tf2_web_republisher_interfaces/TFArray"""

    _type: ClassVar[str] = "tf2_web_republisher_interfaces/TFArray"

    transforms: list[geometry_msgs.TransformStamped] = field(default_factory=list)


@dataclass(slots=True, eq=False, repr=False)
class TFSubscriptionGoal(ros.Message):
    """tf2_web_republisher_interfaces/TFSubscriptionGoal"""

    _type: ClassVar[str] = "tf2_web_republisher_interfaces/TFSubscriptionGoal"

    source_frames: list[str] = field(default_factory=list)
    target_frame: str = ""
    angular_thres: float = 0.0
    trans_thres: float = 0.0
    rate: float = 0.0


@dataclass(slots=True, eq=False, repr=False)
class TFSubscriptionActionGoal(ros.Message):
    """tf2_web_republisher_interfaces/TFSubscriptionActionGoal"""

    _type: ClassVar[str] = "tf2_web_republisher_interfaces/TFSubscriptionActionGoal"

    header: std_msgs.Header = field(default_factory=lambda: std_msgs.Header())
    goal_id: actionlib_msgs.GoalID = field(default_factory=lambda: actionlib_msgs.GoalID())
    goal: TFSubscriptionGoal = field(default_factory=lambda: TFSubscriptionGoal())


@dataclass(slots=True, eq=False, repr=False)
class TFSubscriptionResult(ros.Message):
    """tf2_web_republisher_interfaces/TFSubscriptionResult"""

    _type: ClassVar[str] = "tf2_web_republisher_interfaces/TFSubscriptionResult"


@dataclass(slots=True, eq=False, repr=False)
class TFSubscriptionActionResult(ros.Message):
    """tf2_web_republisher_interfaces/TFSubscriptionActionResult"""

    _type: ClassVar[str] = "tf2_web_republisher_interfaces/TFSubscriptionActionResult"

    header: std_msgs.Header = field(default_factory=lambda: std_msgs.Header())
    status: actionlib_msgs.GoalStatus = field(default_factory=lambda: actionlib_msgs.GoalStatus())
    result: TFSubscriptionResult = field(default_factory=lambda: TFSubscriptionResult())


@dataclass(slots=True, eq=False, repr=False)
class TFSubscriptionFeedback(ros.Message):
    """tf2_web_republisher_interfaces/TFSubscriptionFeedback"""

    _type: ClassVar[str] = "tf2_web_republisher_interfaces/TFSubscriptionFeedback"

    transforms: list[geometry_msgs.TransformStamped] = field(default_factory=list)


@dataclass(slots=True, eq=False, repr=False)
class TFSubscriptionActionFeedback(ros.Message):
    """tf2_web_republisher_interfaces/TFSubscriptionActionFeedback"""

    _type: ClassVar[str] = "tf2_web_republisher_interfaces/TFSubscriptionActionFeedback"

    header: std_msgs.Header = field(default_factory=lambda: std_msgs.Header())
    status: actionlib_msgs.GoalStatus = field(default_factory=lambda: actionlib_msgs.GoalStatus())
    feedback: TFSubscriptionFeedback = field(default_factory=lambda: TFSubscriptionFeedback())


@dataclass(slots=True, eq=False, repr=False)
class TFSubscriptionAction(ros.Message):
    """tf2_web_republisher_interfaces/TFSubscriptionAction"""

    _type: ClassVar[str] = "tf2_web_republisher_interfaces/TFSubscriptionAction"

    action_goal: TFSubscriptionActionGoal = field(
        default_factory=lambda: TFSubscriptionActionGoal()
    )
    action_result: TFSubscriptionActionResult = field(
        default_factory=lambda: TFSubscriptionActionResult()
    )
    action_feedback: TFSubscriptionActionFeedback = field(
        default_factory=lambda: TFSubscriptionActionFeedback()
    )
