"""The actions of action_tutorials_interfaces, written by fibws.interfaces.generator: do not edit."""

from __future__ import annotations

from typing import TypeAlias

import fibws.interfaces as ros
from fibws.msg import action_tutorials_interfaces

__all__ = [
    "Fibonacci",
]


class Fibonacci(
    ros.Action[
        action_tutorials_interfaces.FibonacciGoal,
        action_tutorials_interfaces.FibonacciResult,
        action_tutorials_interfaces.FibonacciFeedback,
    ]
):
    """action_tutorials_interfaces/Fibonacci"""

    _type = "action_tutorials_interfaces/Fibonacci"
    Goal: TypeAlias = action_tutorials_interfaces.FibonacciGoal
    Result: TypeAlias = action_tutorials_interfaces.FibonacciResult
    Feedback: TypeAlias = action_tutorials_interfaces.FibonacciFeedback
