"""The actions of tf2_web_republisher, written by fibws.interfaces.generator: do not edit."""

from __future__ import annotations

from typing import TypeAlias

import fibws.interfaces as ros
from fibws.msg import tf2_web_republisher

__all__ = [
    "TFSubscription",
]


class TFSubscription(
    ros.Action[
        tf2_web_republisher.TFSubscriptionGoal,
        tf2_web_republisher.TFSubscriptionResult,
        tf2_web_republisher.TFSubscriptionFeedback,
    ]
):
    """tf2_web_republisher/TFSubscription"""

    _type = "tf2_web_republisher/TFSubscription"
    Goal: TypeAlias = tf2_web_republisher.TFSubscriptionGoal
    Result: TypeAlias = tf2_web_republisher.TFSubscriptionResult
    Feedback: TypeAlias = tf2_web_republisher.TFSubscriptionFeedback
