"""What a hub on a zenoh network announces: an invalid record costs that record alone."""

from __future__ import annotations

import asyncio
import json
from typing import Any
from unittest.mock import Mock

import pytest

from fibws.hub.federation.records import HubInfo
from fibws.hub.federation.zenoh_backplane import ZenohBackplane

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
        self.backplane._alive.add(ID)

    def join(self, announcement: Any) -> None:
        hub = {"id": ID, "name": "other"}
        state = {"hub": hub, "time": 1, "counter": 1, "announcement": announcement}
        self.backplane._join(ID, [json.dumps(state).encode()], [0, 1])

    def change(self, counter: int, announcement: Any) -> None:
        self.backplane._change(ID, counter, json.dumps(announcement).encode())

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
    world.backplane._join(ID, [answer], [0, 1])
    assert not world.backplane.peers
    assert "invalid state" in caplog.text
