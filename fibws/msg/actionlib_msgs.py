"""The messages of actionlib_msgs, written by fibws.interfaces.generator: do not edit."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import ClassVar

import fibws.interfaces as ros
from fibws.msg import std_msgs

__all__ = [
    "GoalID",
    "GoalStatus",
    "GoalStatusArray",
]


@dataclass(slots=True, eq=False, repr=False)
class GoalID(ros.Message):
    """actionlib_msgs/GoalID"""

    _type: ClassVar[str] = "actionlib_msgs/GoalID"

    stamp: ros.Time = field(default_factory=ros.Time)
    id: str = ""


@dataclass(slots=True, eq=False, repr=False)
class GoalStatus(ros.Message):
    """actionlib_msgs/GoalStatus"""

    _type: ClassVar[str] = "actionlib_msgs/GoalStatus"
    PENDING: ClassVar[int] = 0
    ACTIVE: ClassVar[int] = 1
    PREEMPTED: ClassVar[int] = 2
    SUCCEEDED: ClassVar[int] = 3
    ABORTED: ClassVar[int] = 4
    REJECTED: ClassVar[int] = 5
    PREEMPTING: ClassVar[int] = 6
    RECALLING: ClassVar[int] = 7
    RECALLED: ClassVar[int] = 8
    LOST: ClassVar[int] = 9

    goal_id: GoalID = field(default_factory=lambda: GoalID())
    status: int = 0
    text: str = ""


@dataclass(slots=True, eq=False, repr=False)
class GoalStatusArray(ros.Message):
    """actionlib_msgs/GoalStatusArray"""

    _type: ClassVar[str] = "actionlib_msgs/GoalStatusArray"

    header: std_msgs.Header = field(default_factory=lambda: std_msgs.Header())
    status_list: list[GoalStatus] = field(default_factory=list)
