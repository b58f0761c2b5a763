"""A goal in its client's hands."""

from __future__ import annotations

import asyncio

import pytest

from fibws.errors import ActionError, WaitTimeout
from fibws.msg.actionlib_tutorials import FibonacciFeedback, FibonacciResult
from fibws.node.actions.client_goal import ClientGoal
from fibws.node.actions.status import GoalStatus

FibonacciClientGoal = ClientGoal[FibonacciResult, FibonacciFeedback]


@pytest.fixture
def cancels() -> list[str]:
    return []


@pytest.fixture
def goal(cancels: list[str]) -> FibonacciClientGoal:
    return ClientGoal("a", 2, cancels.append)


async def test_it_may_be_canceled_until_it_ends(
    goal: FibonacciClientGoal, cancels: list[str]
) -> None:
    assert (goal.id, goal.status) == ("a", GoalStatus.PENDING)
    assert repr(goal) == "<ClientGoal a PENDING>"
    await goal.cancel()
    goal.succeed(FibonacciResult([1]))
    await goal.cancel()
    assert cancels == ["a"]


async def test_its_result_is_there_for_all_who_wait_and_who_ask_later(
    goal: FibonacciClientGoal,
) -> None:
    async with asyncio.timeout(60), asyncio.TaskGroup() as tasks:
        results = [tasks.create_task(goal.result()) for _ in range(2)]
        await asyncio.sleep(0)
        goal.succeed(FibonacciResult([1]))
    assert [each.result() for each in results] == [FibonacciResult([1])] * 2
    assert await goal.result(timeout=1) == FibonacciResult([1])
    assert goal.status is GoalStatus.SUCCEEDED


async def test_what_became_of_it_is_told_as_often_as_it_is_asked(
    goal: FibonacciClientGoal,
) -> None:
    goal.fail(GoalStatus.ABORTED, ActionError("/fibonacci", GoalStatus.ABORTED, "no more"))
    for _ in range(2):
        with pytest.raises(ActionError, match="/fibonacci: ABORTED: no more"):
            await goal.result()
    assert goal.status is GoalStatus.ABORTED


async def test_it_goes_on_when_nobody_waits_for_it_any_more(goal: FibonacciClientGoal) -> None:
    with pytest.raises(WaitTimeout, match="while waiting for the result of goal a"):
        await goal.result(timeout=0.001)
    waiting = asyncio.create_task(goal.result())
    await asyncio.sleep(0)
    waiting.cancel()
    with pytest.raises(asyncio.CancelledError):
        await waiting
    with pytest.raises(ValueError, match="a timeout is a number of seconds above 0"):
        await goal.result(timeout=-1)
    goal.succeed(FibonacciResult([1]))
    assert await goal.result() == FibonacciResult([1])


async def test_feedback_is_heard_until_it_ends(goal: FibonacciClientGoal) -> None:
    heard: list[list[int]] = []

    async def listen() -> None:
        async for feedback in goal.feedback():
            heard.append(feedback.sequence)

    async with asyncio.timeout(60), asyncio.TaskGroup() as tasks:
        tasks.create_task(listen())
        for number in range(3):
            await asyncio.sleep(0)
            goal.offer(FibonacciFeedback([number]))
        goal.succeed(FibonacciResult())
    assert heard == [[0], [1], [2]]


async def test_who_reads_feedback_too_slowly_gets_the_newest(goal: FibonacciClientGoal) -> None:
    for number in range(5):
        goal.offer(FibonacciFeedback([number]))
    goal.succeed(FibonacciResult())
    assert [feedback.sequence async for feedback in goal.feedback()] == [[3], [4]]
    assert goal.dropped == 3
