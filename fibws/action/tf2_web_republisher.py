"""The actions of tf2_web_republisher, written by fibws.interfaces.generator: do not edit."""

from __future__ import annotations

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
    Goal = tf2_web_republisher.TFSubscriptionGoal
    Result = tf2_web_republisher.TFSubscriptionResult
    Feedback = tf2_web_republisher.TFSubscriptionFeedback
