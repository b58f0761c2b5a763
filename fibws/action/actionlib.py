"""The actions of actionlib, written by fibws.interfaces.generator: do not edit."""

from __future__ import annotations

import fibws.interfaces as ros
from fibws.msg import actionlib

__all__ = [
    "Test",
    "TestRequest",
    "TwoInts",
]


class Test(ros.Action[actionlib.TestGoal, actionlib.TestResult, actionlib.TestFeedback]):
    """actionlib/Test"""

    _type = "actionlib/Test"
    Goal = actionlib.TestGoal
    Result = actionlib.TestResult
    Feedback = actionlib.TestFeedback


class TestRequest(
    ros.Action[
        actionlib.TestRequestGoal,
        actionlib.TestRequestResult,
        actionlib.TestRequestFeedback,
    ]
):
    """actionlib/TestRequest"""

    _type = "actionlib/TestRequest"
    Goal = actionlib.TestRequestGoal
    Result = actionlib.TestRequestResult
    Feedback = actionlib.TestRequestFeedback


class TwoInts(
    ros.Action[actionlib.TwoIntsGoal, actionlib.TwoIntsResult, actionlib.TwoIntsFeedback]
):
    """actionlib/TwoInts"""

    _type = "actionlib/TwoInts"
    Goal = actionlib.TwoIntsGoal
    Result = actionlib.TwoIntsResult
    Feedback = actionlib.TwoIntsFeedback
