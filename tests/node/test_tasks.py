"""What a node has under way."""

from __future__ import annotations

import asyncio

from fibws.node.tasks import Tasks


async def forever() -> None:
    await asyncio.Event().wait()


async def test_tasks_are_forgotten_once_they_are_done() -> None:
    tasks = Tasks()
    done = asyncio.Event()

    async def wait() -> None:
        await done.wait()

    task = tasks.start(wait(), "waiting")
    assert (task.get_name(), len(tasks)) == ("waiting", 1)
    done.set()
    await tasks.finished()
    assert task.done()
    assert len(tasks) == 0


async def test_they_can_be_cancelled_part_by_part() -> None:
    tasks = Tasks()
    part, other = Tasks(tasks), Tasks(tasks)
    first, second = part.start(forever(), "first"), other.start(forever(), "second")
    assert len(tasks) == 2
    part.cancel()
    await part.finished()
    assert (first.cancelled(), second.done(), len(tasks)) == (True, False, 1)
    tasks.cancel()
    await tasks.finished()
    assert second.cancelled()


async def test_who_ends_them_does_not_wait_for_itself() -> None:
    tasks = Tasks()

    async def end() -> None:
        tasks.cancel()
        await tasks.finished()

    other = tasks.start(forever(), "other")
    last = tasks.start(end(), "last")
    async with asyncio.timeout(60):
        await asyncio.wait({last})
    assert other.cancelled()
    assert not last.cancelled()


def test_without_any_there_is_nothing_to_end() -> None:
    Tasks().cancel()


async def test_those_that_will_not_end_at_once_are_waited_for() -> None:
    tasks = Tasks()
    asked, may = asyncio.Event(), asyncio.Event()

    async def slow() -> None:
        try:
            await forever()
        finally:
            asked.set()
            await may.wait()

    task = tasks.start(slow(), "slow")
    await asyncio.sleep(0)
    tasks.cancel()
    ending = asyncio.create_task(tasks.finished())
    await asked.wait()
    assert not ending.done()
    may.set()
    await ending
    assert task.done()
