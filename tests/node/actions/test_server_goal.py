"""A goal in its server's hands."""

from __future__ import annotations

import asyncio

import pytest

from fibws.msg.actionlib_tutorials import FibonacciFeedback, FibonacciGoal, FibonacciResult
from fibws.node.actions.record import Record
from fibws.node.actions.server_goal import ServerGoal
from fibws.node.actions.status import GoalStatus, Transition

FibonacciServerGoal = ServerGoal[FibonacciGoal, FibonacciResult, FibonacciFeedback]


async def publish(goal: FibonacciServerGoal, feedback: object) -> None:
    raise AssertionError(feedback)


@pytest.fixture
def goal() -> FibonacciServerGoal:
    return ServerGoal(Record("a"), FibonacciGoal(5), FibonacciResult, publish)


def test_it_says_what_is_wanted(goal: FibonacciServerGoal) -> None:
    assert (goal.id, goal.request, goal.status) == ("a", FibonacciGoal(5), GoalStatus.PENDING)
    assert repr(goal) == "<ServerGoal a PENDING>"


def test_it_succeeds_unless_it_was_told_otherwise(goal: FibonacciServerGoal) -> None:
    assert goal.ending == (Transition.SUCCEED, "")


def test_it_can_end_otherwise_with_a_result_or_without(goal: FibonacciServerGoal) -> None:
    assert goal.canceled(FibonacciResult([0])) == FibonacciResult([0])
    assert goal.ending == (Transition.CANCEL, "")
    assert goal.aborted(text="no more numbers") == FibonacciResult()
    assert goal.ending == (Transition.ABORT, "no more numbers")


async def test_who_waits_for_its_cancellation_is_woken(goal: FibonacciServerGoal) -> None:
    async with asyncio.timeout(60), asyncio.TaskGroup() as tasks:
        waiting = tasks.create_task(goal.cancellation())
        long = tasks.create_task(goal.cancellation(timeout=60))
        await asyncio.sleep(0)
        goal.want_no_more()
    assert waiting.result() and long.result()
    assert goal.cancel_requested


async def test_who_waits_for_its_cancellation_goes_on_in_time(goal: FibonacciServerGoal) -> None:
    assert not await goal.cancellation(timeout=0.001)
    assert not goal.cancel_requested
    with pytest.raises(ValueError, match="a timeout is a number of seconds above 0"):
        await goal.cancellation(timeout=0)
