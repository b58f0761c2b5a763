"""The messages of action_msgs, written by fibws.interfaces.generator: do not edit."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import ClassVar

import fibws.interfaces as ros
from fibws.msg import unique_identifier_msgs

__all__ = [
    "GoalInfo",
    "GoalStatus",
    "GoalStatusArray",
]


@dataclass(slots=True, eq=False, repr=False)
class GoalInfo(ros.Message):
    """action_msgs/GoalInfo"""

    _type: ClassVar[str] = "action_msgs/GoalInfo"

    goal_id: unique_identifier_msgs.UUID = field(
        default_factory=lambda: unique_identifier_msgs.UUID()
    )
    stamp: ros.Time = field(default_factory=ros.Time)


@dataclass(slots=True, eq=False, repr=False)
class GoalStatus(ros.Message):
    """action_msgs/GoalStatus"""

    _type: ClassVar[str] = "action_msgs/GoalStatus"
    STATUS_UNKNOWN: ClassVar[int] = 0
    STATUS_ACCEPTED: ClassVar[int] = 1
    STATUS_EXECUTING: ClassVar[int] = 2
    STATUS_CANCELING: ClassVar[int] = 3
    STATUS_SUCCEEDED: ClassVar[int] = 4
    STATUS_CANCELED: ClassVar[int] = 5
    STATUS_ABORTED: ClassVar[int] = 6

    goal_info: GoalInfo = field(default_factory=lambda: GoalInfo())
    status: int = 0


@dataclass(slots=True, eq=False, repr=False)
class GoalStatusArray(ros.Message):
    """action_msgs/GoalStatusArray"""

    _type: ClassVar[str] = "action_msgs/GoalStatusArray"

    status_list: list[GoalStatus] = field(default_factory=list)
