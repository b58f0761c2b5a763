"""The actions of nav_msgs, written by fibws.interfaces.generator: do not edit."""

from __future__ import annotations

from typing import TypeAlias

import fibws.interfaces as ros
from fibws.msg import nav_msgs

__all__ = [
    "GetMap",
]


class GetMap(ros.Action[nav_msgs.GetMapGoal, nav_msgs.GetMapResult, nav_msgs.GetMapFeedback]):
    """nav_msgs/GetMap"""

    _type = "nav_msgs/GetMap"
    Goal: TypeAlias = nav_msgs.GetMapGoal
    Result: TypeAlias = nav_msgs.GetMapResult
    Feedback: TypeAlias = nav_msgs.GetMapFeedback
