"""The actions of tf2_msgs, written by fibws.interfaces.generator: do not edit."""

from __future__ import annotations

from typing import TypeAlias

import fibws.interfaces as ros
from fibws.msg import tf2_msgs

__all__ = [
    "LookupTransform",
]


class LookupTransform(
    ros.Action[
        tf2_msgs.LookupTransformGoal,
        tf2_msgs.LookupTransformResult,
        tf2_msgs.LookupTransformFeedback,
    ]
):
    """tf2_msgs/LookupTransform"""

    _type = "tf2_msgs/LookupTransform"
    Goal: TypeAlias = tf2_msgs.LookupTransformGoal
    Result: TypeAlias = tf2_msgs.LookupTransformResult
    Feedback: TypeAlias = tf2_msgs.LookupTransformFeedback
