"""The actions of tf2_web_republisher_interfaces, written by fibws.interfaces.generator: do not edit."""

from __future__ import annotations

from typing import TypeAlias

import fibws.interfaces as ros
from fibws.msg import tf2_web_republisher_interfaces

__all__ = [
    "TFSubscription",
]


class TFSubscription(
    ros.Action[
        tf2_web_republisher_interfaces.TFSubscriptionGoal,
        tf2_web_republisher_interfaces.TFSubscriptionResult,
        tf2_web_republisher_interfaces.TFSubscriptionFeedback,
    ]
):
    """tf2_web_republisher_interfaces/TFSubscription"""

    _type = "tf2_web_republisher_interfaces/TFSubscription"
    Goal: TypeAlias = tf2_web_republisher_interfaces.TFSubscriptionGoal
    Result: TypeAlias = tf2_web_republisher_interfaces.TFSubscriptionResult
    Feedback: TypeAlias = tf2_web_republisher_interfaces.TFSubscriptionFeedback
