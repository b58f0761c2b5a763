"""Fixtures of the hub's tests."""

from __future__ import annotations

import pytest
from conftest import StartHub

from fibws.hub.server import HubServer
from fibws.hub.settings import MIB


@pytest.fixture(params=[True, False], ids=["fast", "slow"])
async def any_hub(request: pytest.FixtureRequest, start_hub: StartHub) -> HubServer:
    """A hub with fast framing, and one without it, which must behave alike."""
    return await start_hub(fast_framing=request.param, max_message_size=8 * MIB)
