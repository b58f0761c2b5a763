"""Notifications of ROS 1 nodes: a node gets the newest of each kind, whatever happens meanwhile."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator, Iterable
from typing import Any

import pytest
from patience import PATIENCE

from fibws.hub.errors import XmlRpcError
from fibws.hub.ros1.http import NodeCalls

NODE = "http://127.0.0.1:1/"


class Calls(NodeCalls):
    """Calls of nodes, which the test answers."""

    def __init__(self) -> None:
        super().__init__()
        self.sent: asyncio.Queue[tuple[str, asyncio.Future[None]]] = asyncio.Queue()

    async def _call(self, uri: str, method: str, params: Iterable[object], timeout: float) -> Any:
        answer = asyncio.get_running_loop().create_future()
        self.sent.put_nowait((method, answer))
        return await answer

    async def next(self) -> tuple[str, asyncio.Future[None]]:
        """Wait for a call; return its method, and what answers it."""
        async with asyncio.timeout(PATIENCE):
            return await self.sent.get()

    async def is_done(self) -> bool:
        """Wait until the calls that were answered have ended; return whether nothing is left."""
        async with asyncio.timeout(PATIENCE):
            await asyncio.gather(*self._tasks.values())
        return not self._notes and not self._tasks and self.sent.empty()


@pytest.fixture
async def calls() -> AsyncIterator[Calls]:
    calls = Calls()
    yield calls
    await calls.close()


async def test_only_the_newest_notification_of_a_kind_is_sent(calls: Calls) -> None:
    for number in range(3):
        calls.notify(NODE, "a", f"update{number}")
    method, answer = await calls.next()
    assert method == "update2"
    calls.notify(NODE, "a", "update3")
    answer.set_result(None)
    method, answer = await calls.next()
    assert method == "update3"
    answer.set_result(None)
    assert await calls.is_done()


async def test_node_that_registers_again_at_once_is_notified(calls: Calls) -> None:
    calls.notify(NODE, "a", "first")
    _, first = await calls.next()
    calls.forget(NODE)
    calls.notify(NODE, "b", "second")
    method, second = await calls.next()
    assert method == "second"
    assert first.cancelled()
    second.set_result(None)
    assert await calls.is_done()


async def test_node_that_was_never_called_registers_again(calls: Calls) -> None:
    calls.notify(NODE, "a", "first")
    calls.forget(NODE)
    calls.notify(NODE, "b", "second")
    method, second = await calls.next()
    assert method == "second"
    second.set_result(None)
    assert await calls.is_done()


@pytest.mark.parametrize("error", [None, XmlRpcError("refused")])
async def test_notification_in_the_turn_after_the_last_one_is_sent(
    calls: Calls, error: Exception | None
) -> None:
    calls.notify(NODE, "a", "first")
    _, answer = await calls.next()
    if error is None:
        answer.set_result(None)
    else:
        answer.set_exception(error)
    # The task of the first one ends in the next turn, and this comes right after that.
    asyncio.get_running_loop().call_soon(calls.notify, NODE, "b", "second")
    method, answer = await calls.next()
    assert method == "second"
    answer.set_result(None)
    assert await calls.is_done()
