"""The actions of example_interfaces, written by fibws.interfaces.generator: do not edit."""

from __future__ import annotations

from typing import TypeAlias

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
    Goal: TypeAlias = example_interfaces.FibonacciGoal
    Result: TypeAlias = example_interfaces.FibonacciResult
    Feedback: TypeAlias = example_interfaces.FibonacciFeedback
