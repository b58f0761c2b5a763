"""The threads between zenoh and the event loop."""

from __future__ import annotations

import asyncio

from fibws.hub.zenoh_session import Inbox


async def test_inbox_drops_the_oldest_messages_and_no_other_calls() -> None:
    inbox = Inbox(asyncio.get_running_loop(), limit=300)
    arrived: list[object] = []
    done = asyncio.Event()
    inbox.put(arrived.append, "token")
    for number in range(5):
        inbox.put(arrived.append, number, size=100)
    inbox.put(arrived.append, "token gone")
    inbox.put(done.set)
    await done.wait()
    assert arrived == ["token", 2, 3, 4, "token gone"]
    assert inbox.dropped == 2


async def test_inbox_keeps_the_newest_message_however_large_it_is() -> None:
    inbox = Inbox(asyncio.get_running_loop(), limit=300)
    arrived: list[object] = []
    done = asyncio.Event()
    for number in range(3):
        inbox.put(arrived.append, number, size=1000)
    inbox.put(done.set)
    await done.wait()
    assert arrived == [2]
    inbox.put(arrived.append, "next", size=300)
    done.clear()
    inbox.put(done.set)
    await done.wait()
    assert arrived == [2, "next"]
