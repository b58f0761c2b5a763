"""The actions of actionlib_tutorials, written by fibws.interfaces.generator: do not edit."""

from __future__ import annotations

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
    Goal = actionlib_tutorials.AveragingGoal
    Result = actionlib_tutorials.AveragingResult
    Feedback = actionlib_tutorials.AveragingFeedback


class Fibonacci(
    ros.Action[
        actionlib_tutorials.FibonacciGoal,
        actionlib_tutorials.FibonacciResult,
        actionlib_tutorials.FibonacciFeedback,
    ]
):
    """actionlib_tutorials/Fibonacci"""

    _type = "actionlib_tutorials/Fibonacci"
    Goal = actionlib_tutorials.FibonacciGoal
    Result = actionlib_tutorials.FibonacciResult
    Feedback = actionlib_tutorials.FibonacciFeedback
