"""The actions of tf2_msgs, written by fibws.interfaces.generator: do not edit."""

from __future__ import annotations

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
    Goal = tf2_msgs.LookupTransformGoal
    Result = tf2_msgs.LookupTransformResult
    Feedback = tf2_msgs.LookupTransformFeedback
