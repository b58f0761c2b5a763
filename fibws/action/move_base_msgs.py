"""The actions of move_base_msgs, written by fibws.interfaces.generator: do not edit."""

from __future__ import annotations

from typing import TypeAlias

import fibws.interfaces as ros
from fibws.msg import move_base_msgs

__all__ = [
    "MoveBase",
]


class MoveBase(
    ros.Action[
        move_base_msgs.MoveBaseGoal,
        move_base_msgs.MoveBaseResult,
        move_base_msgs.MoveBaseFeedback,
    ]
):
    """move_base_msgs/MoveBase"""

    _type = "move_base_msgs/MoveBase"
    Goal: TypeAlias = move_base_msgs.MoveBaseGoal
    Result: TypeAlias = move_base_msgs.MoveBaseResult
    Feedback: TypeAlias = move_base_msgs.MoveBaseFeedback
