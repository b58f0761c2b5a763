"""A node's actions on a session without a socket."""

from __future__ import annotations

import pytest

from fibws.action.actionlib_tutorials import Fibonacci
from fibws.msg.actionlib_tutorials import FibonacciFeedback, FibonacciGoal, FibonacciResult
from fibws.node.actions.actions import NodeActions
from fibws.node.topics import NodeTopics
from fibws.node.types import NodeActionType, NodeTypes

from ..conftest import FakeSession

NOW = 1_700_000_000_500_000_000
"""The time of the tests in nanoseconds since 1970."""

FibonacciType = NodeActionType[FibonacciGoal, FibonacciResult, FibonacciFeedback]


async def no_services(name: str, timeout: float | None) -> None:
    raise AssertionError(f"unexpected wait for {name}")


@pytest.fixture
def actions(session: FakeSession, types: NodeTypes) -> NodeActions:
    return NodeActions("/node", session, NodeTopics(session), types, no_services, lambda: NOW)


@pytest.fixture
def fibonacci(types: NodeTypes) -> FibonacciType:
    return NodeActionType(types, Fibonacci)
