"""The actions of actionlib, written by fibws.interfaces.generator: do not edit."""

from __future__ import annotations

from typing import TypeAlias

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
    Goal: TypeAlias = actionlib.TestGoal
    Result: TypeAlias = actionlib.TestResult
    Feedback: TypeAlias = actionlib.TestFeedback


class TestRequest(
    ros.Action[
        actionlib.TestRequestGoal,
        actionlib.TestRequestResult,
        actionlib.TestRequestFeedback,
    ]
):
    """actionlib/TestRequest"""

    _type = "actionlib/TestRequest"
    Goal: TypeAlias = actionlib.TestRequestGoal
    Result: TypeAlias = actionlib.TestRequestResult
    Feedback: TypeAlias = actionlib.TestRequestFeedback


class TwoInts(
    ros.Action[actionlib.TwoIntsGoal, actionlib.TwoIntsResult, actionlib.TwoIntsFeedback]
):
    """actionlib/TwoInts"""

    _type = "actionlib/TwoInts"
    Goal: TypeAlias = actionlib.TwoIntsGoal
    Result: TypeAlias = actionlib.TwoIntsResult
    Feedback: TypeAlias = actionlib.TwoIntsFeedback
