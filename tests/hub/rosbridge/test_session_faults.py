"""Sessions with odd requests and failures."""

from __future__ import annotations

from typing import Any

import pytest
from conftest import Faults

from fibws.hub.rosbridge.session import RosbridgeSession
from fibws.hub.server import HubServer

from ..raw_client import CLOSE, connected, frame, publish, until

pytestmark = pytest.mark.both_loops


class TestSession:
    """Faults in one client's session do not reach the others."""

    @pytest.mark.parametrize(
        "fields",
        [
            {"queue_length": 2**63},
            {"queue_length": 2**64},
            {"queue_length": 10**400},
            {"queue_length": -1},
            {"throttle_rate": 1e308},
            {"throttle_rate": 10**400},
            {"throttle_rate": -1},
            {"fragment_size": 10**400},
            {"throttle_rate": 1e300, "queue_length": 2**63 - 1},
        ],
        ids=lambda fields: " ".join(f"{name}={float(str(x)):.0e}" for name, x in fields.items()),
    )
    async def test_huge_numbers_in_a_subscribe_are_accepted(
        self, hub: HubServer, fields: dict[str, Any]
    ) -> None:
        fields = {"throttle_rate": 10, **fields}
        async with connected(hub.port, "/?node=/odd") as client, connected(hub.port) as talker:
            await talker.advertises("/t")
            await client.send_operation("subscribe", topic="/t", type="std_msgs/Int32", **fields)
            await talker.send(publish("/t", 1), publish("/t", 2))
            await talker.is_processed()
            await client.send(frame(CLOSE))
            await client.to_the_end()
        async with connected(hub.port, "/?node=/odd") as again:
            await again.subscribes("/t")
        await until(lambda: not hub._connections)

    async def test_client_whose_leaving_fails_is_forgotten(
        self, hub: HubServer, faults: Faults, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        def fail(*_: Any) -> None:
            raise KeyError("injected")

        async with connected(hub.port) as other:
            with monkeypatch.context() as broken:
                async with connected(hub.port, "/?node=/broken") as client:
                    await client.is_processed()
                    broken.setattr(RosbridgeSession, "leave", fail)
                await until(lambda: len(hub._connections) == 1)
            await other.is_processed()
            hub.graph.nodes.pop("/broken", None)
        faults.seen.clear()

    async def test_newer_client_is_not_harmed_when_replacing_the_older_fails(
        self, hub: HubServer, faults: Faults, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        def fail(*_: Any) -> None:
            raise KeyError("injected")

        async with connected(hub.port, "/?node=/a") as older:
            await older.is_processed()
            with monkeypatch.context() as broken:
                broken.setattr(RosbridgeSession, "replaced", fail)
                async with connected(hub.port, "/?node=/a") as newer:
                    await newer.is_processed()
        faults.seen.clear()
