"""What actions need of a node, on a session without a socket."""

from __future__ import annotations

import pytest

from fibws.action.actionlib_tutorials import Fibonacci
from fibws.msg.actionlib_tutorials import FibonacciFeedback, FibonacciGoal, FibonacciResult
from fibws.node.actions.action_type import ActionType
from fibws.node.actions.actions import Actions
from fibws.node.session import Session
from fibws.node.topics import Topics
from fibws.node.types import Types

NOW = 1_700_000_000_500_000_000
"""The nanoseconds since 1970 at which the tests take place."""

FibonacciType = ActionType[FibonacciGoal, FibonacciResult, FibonacciFeedback]


async def no_services(name: str, within: float | None) -> None:
    raise AssertionError(f"nobody should wait for {name}")


@pytest.fixture
def actions(session: Session, types: Types) -> Actions:
    return Actions("/node", session, Topics(session), types, no_services, lambda: NOW)


@pytest.fixture
def fibonacci(types: Types) -> FibonacciType:
    return ActionType(types, Fibonacci)
