"""The nodes at the other side of a topic, as programs see them."""

from __future__ import annotations

import asyncio

import pytest

from fibws.node.peers import MOST_CHANGES, Peers


async def rest(peers: Peers) -> list[list[str]]:
    return [names async for names in peers.changes()]


async def reading(peers: Peers) -> asyncio.Task[list[list[str]]]:
    """A reader that has begun."""
    task = asyncio.create_task(rest(peers))
    await asyncio.sleep(0)
    return task


async def test_peers_are_empty_before_the_first_report() -> None:
    peers = Peers()
    assert peers.names == []
    assert repr(peers) == "<Peers >"
    with pytest.raises(TimeoutError):
        async with asyncio.timeout(0):
            await anext(peers.changes())


async def test_changes_begin_with_the_known_names_even_if_empty() -> None:
    for known in ([], ["/a", "/b"]):
        peers = Peers()
        peers._update(known)
        assert peers.names == known
        assert await anext(peers.changes()) == known
    assert repr(peers) == "<Peers /a, /b>"


async def test_slow_reader_gets_every_change() -> None:
    peers = Peers()
    changes = peers.changes()
    steps = [["/a"], [], ["/a"], ["/a", "/b"]]
    peers._update(steps[0])
    first = await anext(changes)
    for names in steps[1:]:
        peers._update(names)
    assert [first, *[await anext(changes) for _ in steps[1:]]] == steps


async def test_oldest_changes_are_dropped_at_the_limit() -> None:
    peers = Peers()
    changes = peers.changes()
    peers._update([])
    assert await anext(changes) == []
    for number in range(MOST_CHANGES + 5):
        peers._update([str(number)])
    assert await anext(changes) == ["5"]


async def test_repeated_report_is_not_a_change() -> None:
    peers = Peers()
    reader = await reading(peers)
    for _ in range(2):
        peers._update(["/a"])
    peers._end()
    assert await reader == [["/a"]]


async def test_all_readers_get_all_changes() -> None:
    peers = Peers()
    readers = [await reading(peers) for _ in range(2)]
    for names in (["/a"], ["/b"]):
        peers._update(names)
        await asyncio.sleep(0)
    peers._end()
    assert [await reader for reader in readers] == 2 * [[["/a"], ["/b"]]]


async def test_readers_get_copies() -> None:
    peers = Peers()
    peers._update(["/a"])
    (await anext(peers.changes())).clear()
    peers.names.clear()
    assert peers.names == ["/a"]


async def test_peers_are_empty_until_reconnected() -> None:
    peers = Peers()
    reader = await reading(peers)
    peers._on_disconnect()
    peers._update(["/a"])
    peers._on_disconnect()
    assert peers.names == []
    peers._on_disconnect()
    peers._update(["/a"])
    peers._end()
    assert await reader == [["/a"], [], ["/a"]]


async def test_ended_peers_have_no_names_and_no_changes() -> None:
    peers = Peers()
    peers._update(["/a"])
    peers._end()
    assert peers.names == []
    assert await rest(peers) == []


async def test_reader_that_timed_out_misses_nothing() -> None:
    peers = Peers()
    reader = await reading(peers)
    reader.cancel()
    await asyncio.wait({reader})
    peers._update(["/a"])
    assert await anext(peers.changes()) == ["/a"]


def test_first_report_makes_peers_known() -> None:
    peers = Peers()
    assert not peers.known
    peers._update([])
    assert peers.known


async def test_changes_are_applied_to_the_known_names() -> None:
    peers = Peers()
    reader = await reading(peers)
    peers._update(["/b", "/d"])
    peers._change([], ["/a", "/c"])
    peers._change(["/b", "/unknown"], [])
    peers._change(["/c"], ["/e"])
    assert peers.names == ["/a", "/d", "/e"]
    peers._end()
    assert await reader == [
        ["/b", "/d"],
        ["/a", "/b", "/c", "/d"],
        ["/a", "/c", "/d"],
        ["/a", "/d", "/e"],
    ]


async def test_leaving_and_returning_peer_is_reported() -> None:
    peers = Peers()
    reader = await reading(peers)
    peers._update(["/a", "/b"])
    peers._change(["/a"], ["/a", "/c"])
    peers._end()
    assert await reader == [["/a", "/b"], ["/b"], ["/a", "/b", "/c"]]
