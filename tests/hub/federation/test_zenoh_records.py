"""What a hub on a zenoh network announces: an invalid record costs that record alone."""

from __future__ import annotations

import asyncio
import json
import struct
from typing import Any
from unittest.mock import Mock

import pytest

from fibws.hub.federation.records import HubInfo
from fibws.hub.federation.zenoh_backplane import ZenohBackplane
from fibws.hub.federation.zenoh_state import MOST_AHEAD, KnownHub

from .test_link import ID, NODE

RECORDS = {"/good": NODE, "/bad": {**NODE, "since": "yesterday"}, "/worse": 7}


class World:
    """A backplane without a session, which a hub has answered."""

    def __init__(self) -> None:
        self.network = Mock()
        self.backplane = ZenohBackplane(
            self.network,
            HubInfo(id="a" * 16, name="this"),
            asyncio.get_running_loop(),
            principal=None,
            domain="test",
            listen=(),
            connect=(),
            config=None,
            max_queued=2**20,
        )
        self.backplane._is_attached = True
        self.known = self.backplane._known[ID] = KnownHub()

    def join(self, announcement: Any, **fields: Any) -> None:
        hub = {"id": ID, "name": "other"}
        state = {"hub": hub, "time": 1, "counter": 1, "announcement": announcement, **fields}
        self.backplane._told(ID, self.known, [json.dumps(state).encode()], [0, 1])

    def change(self, counter: int, announcement: Any) -> None:
        self.backplane._changed(ID, json.dumps(announcement).encode(), struct.pack("<Q", counter))

    def is_asked(self) -> bool:
        """Whether the other hub was asked for what was missed."""
        return self.known.is_asked

    def taken(self) -> list[str]:
        """Return the nodes that were announced since the last call."""
        calls, self.network.announced.call_args_list = self.network.announced.call_args_list, []
        return [name for call in calls for name in call.args[1].nodes]

    def nodes(self) -> dict[str, Any]:
        announcement = self.network.announced.call_args.args[1]
        return dict(announcement.nodes)


async def test_invalid_record_is_left_out_of_a_state_and_logged_once(
    caplog: pytest.LogCaptureFixture,
) -> None:
    world = World()
    world.join({"nodes": RECORDS})
    found = world.nodes()
    assert found["/good"] is not None
    assert found["/bad"] is None and found["/worse"] is None
    logged = [each.message for each in caplog.records]
    assert len(logged) == 2
    assert "/bad" in logged[0] and "since" in logged[0] and ID in logged[0]
    world.change(2, {"nodes": RECORDS})
    assert world.nodes()["/good"] is not None
    assert len(caplog.records) == 2


async def test_invalid_record_is_left_out_of_a_change(caplog: pytest.LogCaptureFixture) -> None:
    world = World()
    world.join({})
    world.change(2, {"nodes": RECORDS})
    assert world.nodes()["/good"] is not None
    assert len(caplog.records) == 2


@pytest.mark.parametrize("answer", [b"", b"7", b"{", b'{"hub": 7}', b"[]"])
async def test_hub_that_answers_with_no_state_is_not_joined(
    caplog: pytest.LogCaptureFixture, answer: bytes
) -> None:
    world = World()
    world.backplane._told(ID, world.known, [answer], [0, 1])
    assert not world.backplane.peers
    assert "invalid state" in caplog.text


def nodes_of(*names: str) -> dict[str, Any]:
    return {"nodes": dict.fromkeys(names, NODE)}


async def test_announcements_that_were_missed_are_asked_for() -> None:
    world = World()
    world.join({})
    assert world.backplane.peers and not world.is_asked()
    for counter in (3, 5, 4):
        world.change(counter, nodes_of(f"/node_{counter}"))
    assert world.is_asked()
    assert world.taken() == []
    world.join(nodes_of("/node_2"), since=1, counter=2)
    assert world.taken() == ["/node_2", "/node_3", "/node_4", "/node_5"]
    assert not world.is_asked()
    world.change(5, nodes_of("/twice"))
    world.change(6, nodes_of("/node_6"))
    assert world.taken() == ["/node_6"]
    world.network.lost.assert_not_called()


async def test_what_a_hub_has_is_asked_for_piece_by_piece() -> None:
    world = World()
    world.join(nodes_of("/one"), more=True, counter=4)
    assert world.is_asked()
    world.change(6, nodes_of("/three"))
    world.join(nodes_of("/two"), since=4, counter=5)
    assert world.taken() == ["/one", "/two", "/three"]
    assert not world.is_asked()
    world.network.joined.assert_called_once()


async def test_an_announcement_without_a_later_one_is_missed_at_the_second_ping() -> None:
    world = World()
    world.join({})
    for asked in (False, True):
        world.backplane._promised(ID, 2)  # It may still be on its way at the first one.
        assert world.is_asked() is asked


async def test_hub_that_cannot_tell_what_was_missed_joins_anew() -> None:
    world = World()
    world.join(nodes_of("/old"))
    world.change(3, nodes_of("/new"))
    world.join(nodes_of("/new"), counter=3)
    world.network.lost.assert_called_once()
    world.known = world.backplane._known[ID]
    world.join(nodes_of("/new"), counter=3)
    assert world.network.joined.call_count == 2
    assert world.taken() == ["/old", "/new"]


async def test_announcements_that_are_kept_until_others_come_are_bounded() -> None:
    world = World()
    world.join({})
    large = nodes_of(*(f"/node_{'x' * 100}_{each}" for each in range(1000)))
    for counter in range(3, 103):
        world.change(counter, large)
    assert world.known._ahead_bytes <= MOST_AHEAD
    world.join({}, since=1, counter=102)
    assert not world.known.has_gap and world.known._ahead_bytes == 0


async def test_hub_that_has_announced_too_much_is_left_for_a_while() -> None:
    world = World()
    world.join(nodes_of("/one"))
    world.backplane.leave(world.backplane.peers[0])
    world.network.lost.assert_called_once()
    world.change(2, nodes_of("/two"))
    assert world.taken() == ["/one"]
    assert not world.backplane.peers
