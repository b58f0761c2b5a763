"""The actions of actionlib_tutorials, written by fibws.interfaces.generator: do not edit."""

from __future__ import annotations

from typing import TypeAlias

import fibws.interfaces as ros
from fibws.msg import actionlib_tutorials

__all__ = [
    "Averaging",
    "Fibonacci",
]


class Averaging(
    ros.Action[
        actionlib_tutorials.AveragingGoal,
        actionlib_tutorials.AveragingResult,
        actionlib_tutorials.AveragingFeedback,
    ]
):
    """actionlib_tutorials/Averaging"""

    _type = "actionlib_tutorials/Averaging"
    Goal: TypeAlias = actionlib_tutorials.AveragingGoal
    Result: TypeAlias = actionlib_tutorials.AveragingResult
    Feedback: TypeAlias = actionlib_tutorials.AveragingFeedback


class Fibonacci(
    ros.Action[
        actionlib_tutorials.FibonacciGoal,
        actionlib_tutorials.FibonacciResult,
        actionlib_tutorials.FibonacciFeedback,
    ]
):
    """actionlib_tutorials/Fibonacci"""

    _type = "actionlib_tutorials/Fibonacci"
    Goal: TypeAlias = actionlib_tutorials.FibonacciGoal
    Result: TypeAlias = actionlib_tutorials.FibonacciResult
    Feedback: TypeAlias = actionlib_tutorials.FibonacciFeedback
