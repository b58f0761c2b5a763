"""Time and the rates of loops."""

import asyncio
import logging
import math

import pytest

import fibws
from fibws.node.clock import NodeClock, Rate, Schedule
from fibws.node.session import Session


def test_first_tick_is_due_at_once() -> None:
    assert Schedule(10).delay(1000) == 0


def test_work_between_ticks_does_not_make_them_drift() -> None:
    schedule = Schedule(10)
    schedule.delay(0)
    assert schedule.delay(0.03) == pytest.approx(0.07)
    assert schedule.delay(0.17) == pytest.approx(0.03)


def test_late_tick_is_due_at_once_and_the_next_ones_catch_up() -> None:
    schedule = Schedule(10)
    schedule.delay(0)
    assert schedule.delay(0.25) == 0
    assert schedule.delay(0.25) == 0
    assert schedule.delay(0.25) == pytest.approx(0.05)


def test_ticks_are_skipped_when_more_than_two_periods_late() -> None:
    schedule = Schedule(10)
    schedule.delay(0)
    assert schedule.delay(0.5) == 0
    assert schedule.delay(0.5) == pytest.approx(0.1)


@pytest.mark.parametrize("hz", [0, -1, math.inf, math.nan])
def test_rate_must_be_above_0(hz: float) -> None:
    with pytest.raises(ValueError, match="above 0"):
        Schedule(hz)


async def test_rate_ticks_until_the_node_ends() -> None:
    session = Session(logging.Logger("test"))
    session.begin()
    ticks = 0
    async for _ in Rate(1000, NodeClock(session)):
        ticks += 1
        if ticks == 3:
            session.end()
    assert ticks == 3


async def test_end_of_the_node_ends_a_pending_tick() -> None:
    session = Session(logging.Logger("test"))
    session.begin()
    rate = Rate(0.01, NodeClock(session))
    await anext(rate)
    waiting = asyncio.create_task(anext(rate, "the end"))
    await asyncio.sleep(0)
    session.end()
    assert await waiting == "the end"


async def test_late_loop_lets_other_tasks_run() -> None:
    session = Session(logging.Logger("test"))
    session.begin()

    async def other() -> None:
        session.end()

    task = asyncio.create_task(other())
    async for _ in Rate(1e9, NodeClock(session)):
        pass
    await task


async def test_error_of_the_node_is_raised() -> None:
    session = Session(logging.Logger("test"))
    session.end(fibws.NodeReplaced("by another"))
    with pytest.raises(fibws.NodeReplaced, match="by another"):
        await anext(Rate(1, NodeClock(session)))


async def tick(clock: NodeClock, now: int) -> None:
    await asyncio.sleep(0)  # The waiter begins to wait.
    clock.set(now)
    for _ in range(3):
        await asyncio.sleep(0)


async def test_rate_follows_simulated_time() -> None:
    session = Session(logging.Logger("test"))
    session.begin()
    clock = NodeClock(session)
    clock.set(0)
    rate = Rate(10, clock)
    await anext(rate)
    waiting = asyncio.ensure_future(anext(rate, "the end"))
    await tick(clock, 99_999_999)
    assert not waiting.done()
    await tick(clock, 100_000_000)
    await waiting
    waiting = asyncio.ensure_future(anext(rate, "the end"))
    await tick(clock, 120_000_000)
    assert not waiting.done()
    session.end()
    assert await waiting == "the end"


async def test_rate_begins_again_when_simulated_time_is_set_back() -> None:
    session = Session(logging.Logger("test"))
    session.begin()
    clock = NodeClock(session)
    clock.set(10**12)
    rate = Rate(10, clock)
    await anext(rate)
    waiting = asyncio.ensure_future(anext(rate))
    await tick(clock, 0)
    await waiting
    waiting = asyncio.ensure_future(anext(rate))
    await tick(clock, 100_000_000)
    await waiting
    session.end()
