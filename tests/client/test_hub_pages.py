"""What clients learn from the hub by HTTP."""

from __future__ import annotations

import asyncio

import pytest
from conftest import StartHub

from fibws.client.hub_pages import get, master_variables, ros1_port
from fibws.hub.server import HubServer


async def test_page_of_the_hub_is_read(hub: HubServer) -> None:
    status, headers, body = await asyncio.to_thread(get, hub.url, "healthz")
    assert (status, headers["content-type"].partition(";")[0]) == (200, "application/json")
    assert b"uptime_seconds" in body


async def test_programs_of_ros_1_find_the_hubs_master(start_hub: StartHub) -> None:
    hub = await start_hub(ros1=0)
    assert hub.ros1 is not None
    uri = f"http://localhost:{hub.ros1.port}"
    assert await asyncio.to_thread(master_variables, hub.url, {}) == {"ROS_MASTER_URI": uri}
    other = {"ROS_MASTER_URI": "http://localhost:1"}
    assert await asyncio.to_thread(master_variables, hub.url, other) == {"ROS_MASTER_URI": uri}
    same = {"ROS_MASTER_URI": f"http://robot:{hub.ros1.port}/"}
    assert await asyncio.to_thread(master_variables, hub.url, same) == {}


async def test_nothing_is_set_without_a_master(hub: HubServer) -> None:
    assert await asyncio.to_thread(master_variables, hub.url, {}) == {}


@pytest.mark.parametrize("url", ["ws://127.0.0.1:1", "wss://127.0.0.1:1"])
def test_hub_that_does_not_answer_has_no_port(url: str) -> None:
    assert ros1_port(url) is None
