"""The nodes at the other side of a topic, as a program hears of them."""

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


async def test_there_are_none_before_the_first_word() -> None:
    peers = Peers()
    assert peers.names == []
    assert repr(peers) == "<Peers >"
    with pytest.raises(TimeoutError):
        async with asyncio.timeout(0):
            await anext(peers.changes())


async def test_what_is_known_comes_first_even_if_that_is_nobody() -> None:
    for known in ([], ["/a", "/b"]):
        peers = Peers()
        peers.update(known)
        assert peers.names == known
        assert await anext(peers.changes()) == known
    assert repr(peers) == "<Peers /a, /b>"


async def test_each_change_comes_however_slow_the_reader() -> None:
    peers = Peers()
    changes = peers.changes()
    steps = [["/a"], [], ["/a"], ["/a", "/b"]]
    peers.update(steps[0])
    first = await anext(changes)
    for names in steps[1:]:
        peers.update(names)
    assert [first, *[await anext(changes) for _ in steps[1:]]] == steps


async def test_of_very_many_changes_the_newest_come() -> None:
    peers = Peers()
    changes = peers.changes()
    peers.update([])
    assert await anext(changes) == []
    for number in range(MOST_CHANGES + 5):
        peers.update([str(number)])
    assert await anext(changes) == ["5"]


async def test_the_same_word_again_is_no_change() -> None:
    peers = Peers()
    reader = await reading(peers)
    for _ in range(2):
        peers.update(["/a"])
    peers.end()
    assert await reader == [["/a"]]


async def test_all_readers_hear_all() -> None:
    peers = Peers()
    readers = [await reading(peers) for _ in range(2)]
    for names in (["/a"], ["/b"]):
        peers.update(names)
        await asyncio.sleep(0)
    peers.end()
    assert [await reader for reader in readers] == 2 * [[["/a"], ["/b"]]]


async def test_what_a_reader_is_given_is_its_own() -> None:
    peers = Peers()
    peers.update(["/a"])
    (await anext(peers.changes())).clear()
    peers.names.clear()
    assert peers.names == ["/a"]


async def test_without_a_hub_there_are_none_until_it_is_back() -> None:
    peers = Peers()
    reader = await reading(peers)
    peers.on_disconnect()
    peers.update(["/a"])
    peers.on_disconnect()
    assert peers.names == []
    peers.on_disconnect()
    peers.update(["/a"])
    peers.end()
    assert await reader == [["/a"], [], ["/a"]]


async def test_what_has_ended_has_no_peers_and_no_changes() -> None:
    peers = Peers()
    peers.update(["/a"])
    peers.end()
    assert peers.names == []
    assert await rest(peers) == []


async def test_a_reader_who_stops_waiting_misses_nothing() -> None:
    peers = Peers()
    reader = await reading(peers)
    reader.cancel()
    await asyncio.wait({reader})
    peers.update(["/a"])
    assert await anext(peers.changes()) == ["/a"]


def test_it_knows_whether_the_hub_has_told() -> None:
    peers = Peers()
    assert not peers.told
    peers.update([])
    assert peers.told


async def test_changes_are_made_to_the_names_that_are_known() -> None:
    peers = Peers()
    reader = await reading(peers)
    peers.update(["/b", "/d"])
    peers.change([], ["/a", "/c"])
    peers.change(["/b", "/unknown"], [])
    peers.change(["/c"], ["/e"])
    assert peers.names == ["/a", "/d", "/e"]
    peers.end()
    assert await reader == [
        ["/b", "/d"],
        ["/a", "/b", "/c", "/d"],
        ["/a", "/c", "/d"],
        ["/a", "/d", "/e"],
    ]


async def test_peer_that_left_and_came_back_is_seen_to_do_so() -> None:
    peers = Peers()
    reader = await reading(peers)
    peers.update(["/a", "/b"])
    peers.change(["/a"], ["/a", "/c"])
    peers.end()
    assert await reader == [["/a", "/b"], ["/b"], ["/a", "/b", "/c"]]
