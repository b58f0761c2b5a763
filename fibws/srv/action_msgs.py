"""The services of action_msgs, written by fibws.interfaces.generator: do not edit."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import ClassVar, TypeAlias

import fibws.interfaces as ros
from fibws.msg import action_msgs

__all__ = [
    "CancelGoal",
    "CancelGoalRequest",
    "CancelGoalResponse",
]


@dataclass(slots=True, eq=False, repr=False)
class CancelGoalRequest(ros.Message):
    """action_msgs/CancelGoalRequest"""

    _type: ClassVar[str] = "action_msgs/CancelGoalRequest"

    goal_info: action_msgs.GoalInfo = field(default_factory=lambda: action_msgs.GoalInfo())


@dataclass(slots=True, eq=False, repr=False)
class CancelGoalResponse(ros.Message):
    """action_msgs/CancelGoalResponse"""

    _type: ClassVar[str] = "action_msgs/CancelGoalResponse"
    ERROR_NONE: ClassVar[int] = 0
    ERROR_REJECTED: ClassVar[int] = 1
    ERROR_UNKNOWN_GOAL_ID: ClassVar[int] = 2
    ERROR_GOAL_TERMINATED: ClassVar[int] = 3

    return_code: int = 0
    goals_canceling: list[action_msgs.GoalInfo] = field(default_factory=list)


class CancelGoal(ros.Service[CancelGoalRequest, CancelGoalResponse]):
    """action_msgs/CancelGoal"""

    _type = "action_msgs/CancelGoal"
    Request: TypeAlias = CancelGoalRequest
    Response: TypeAlias = CancelGoalResponse
