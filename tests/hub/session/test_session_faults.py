"""Sessions that are asked for odd things, or fail."""

from __future__ import annotations

from typing import Any

import pytest
from conftest import Faults

from fibws.hub import Hub
from fibws.hub.session.session import Session

from ..wire import CLOSE, connected, frame, publish, until

pytestmark = pytest.mark.both_loops


class TestSession:
    """What goes wrong in one client's session stays there."""

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
    async def test_no_number_is_too_much_for_a_subscription(
        self, hub: Hub, fields: dict[str, Any]
    ) -> None:
        fields = {"throttle_rate": 10, **fields}
        async with connected(hub.port, "/?node=/odd") as client, connected(hub.port) as talker:
            await talker.advertises("/t")
            await client.says("subscribe", topic="/t", type="std_msgs/Int32", **fields)
            await talker.send(publish("/t", 1), publish("/t", 2))
            await talker.is_heard()
            await client.send(frame(CLOSE))
            await client.to_the_end()
        async with connected(hub.port, "/?node=/odd") as again:
            await again.subscribes("/t")
        await until(lambda: not hub._connections)

    async def test_one_that_cannot_leave_is_forgotten_all_the_same(
        self, hub: Hub, faults: Faults, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        def fail(*_: Any) -> None:
            raise KeyError("injected")

        async with connected(hub.port) as other:
            with monkeypatch.context() as broken:
                async with connected(hub.port, "/?node=/broken") as client:
                    await client.is_heard()
                    broken.setattr(Session, "leave", fail)
                await until(lambda: len(hub._connections) == 1)
            await other.is_heard()
            hub.graph.nodes.pop("/broken", None)
        faults.seen.clear()

    async def test_a_newcomer_is_not_harmed_by_the_older_one_of_its_name(
        self, hub: Hub, faults: Faults, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        def fail(*_: Any) -> None:
            raise KeyError("injected")

        async with connected(hub.port, "/?node=/a") as older:
            await older.is_heard()
            with monkeypatch.context() as broken:
                broken.setattr(Session, "replaced", fail)
                async with connected(hub.port, "/?node=/a") as newer:
                    await newer.is_heard()
        faults.seen.clear()
