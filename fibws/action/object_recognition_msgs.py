"""The actions of object_recognition_msgs, written by fibws.interfaces.generator: do not edit."""

from __future__ import annotations

from typing import TypeAlias

import fibws.interfaces as ros
from fibws.msg import object_recognition_msgs

__all__ = [
    "ObjectRecognition",
]


class ObjectRecognition(
    ros.Action[
        object_recognition_msgs.ObjectRecognitionGoal,
        object_recognition_msgs.ObjectRecognitionResult,
        object_recognition_msgs.ObjectRecognitionFeedback,
    ]
):
    """object_recognition_msgs/ObjectRecognition"""

    _type = "object_recognition_msgs/ObjectRecognition"
    Goal: TypeAlias = object_recognition_msgs.ObjectRecognitionGoal
    Result: TypeAlias = object_recognition_msgs.ObjectRecognitionResult
    Feedback: TypeAlias = object_recognition_msgs.ObjectRecognitionFeedback
