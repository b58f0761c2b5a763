"""The actions of example_interfaces, written by fibws.interfaces.generator: do not edit."""

from __future__ import annotations

import fibws.interfaces as ros
from fibws.msg import example_interfaces

__all__ = [
    "Fibonacci",
]


class Fibonacci(
    ros.Action[
        example_interfaces.FibonacciGoal,
        example_interfaces.FibonacciResult,
        example_interfaces.FibonacciFeedback,
    ]
):
    """example_interfaces/Fibonacci"""

    _type = "example_interfaces/Fibonacci"
    Goal = example_interfaces.FibonacciGoal
    Result = example_interfaces.FibonacciResult
    Feedback = example_interfaces.FibonacciFeedback
