"""The program tf2_web_republisher, which sends transforms to web pages."""

from __future__ import annotations

import asyncio
import signal
from math import pi, sqrt
from typing import Any

import pytest
from patience import PATIENCE
from running_programs import Start

import fibws
from fibws.action.tf2_web_republisher import TFSubscription
from fibws.hub.server import HubServer
from fibws.msg.tf2_web_republisher import TFArray, TFSubscriptionGoal
from fibws.srv.tf2_web_republisher import RepublishTFs

REPUBLISHER = "fibws.programs.tf2_web_republisher"


async def test_transforms_are_sent_by_service_and_by_action(hub: HubServer, start: Start) -> None:
    place = ("fibws.programs.static_transform_publisher", "--hub", hub.url)
    await start(*place, "1", "0", "0", str(pi / 2), "0", "0", "base", "arm")
    await start(*place, "0", "2", "0", "0", "0", "0", "1", "arm", "hand")
    await start(REPUBLISHER, "--hub", hub.url)
    async with asyncio.timeout(PATIENCE), fibws.Node("test", hub=hub.url) as node:
        await node.wait_for_service("/republish_tfs")
        wish: Any = {"source_frames": ["hand"], "target_frame": "base", "rate": 10}
        request = RepublishTFs.Request(**wish, timeout=fibws.Duration(PATIENCE))
        topic = (await node.call("/republish_tfs", RepublishTFs, request)).topic_name
        assert topic == "/tf2_web_republisher/tf_repub_0"
        array = await anext(node.subscribe(topic, TFArray))
        actions = node.action_client("/tf2_web_republisher", TFSubscription)
        await actions.wait_for_server()
        goal = await actions.send(TFSubscriptionGoal(**wish))
        feedback = await anext(goal.feedback())
    for (transform,) in (array.transforms, feedback.transforms):
        assert (transform.header.frame_id, transform.child_frame_id) == ("base", "hand")
        translation, rotation = transform.transform.translation, transform.transform.rotation
        assert (translation.x, translation.y, translation.z) == pytest.approx((-1, 0, 0))
        half = sqrt(0.5)
        assert (rotation.x, rotation.y, rotation.z, rotation.w) == pytest.approx((0, 0, half, half))


async def test_action_has_the_name_of_the_node(hub: HubServer, start: Start) -> None:
    await start(REPUBLISHER, "--hub", hub.url, "__ns:=/robot", "__name:=transforms", "/tf:=/moves")
    async with asyncio.timeout(PATIENCE), fibws.Node("test", hub=hub.url) as node:
        await node.wait_for_service("/robot/republish_tfs")
        assert await node.graph.action_servers() == ["/robot/transforms"]
        assert "/moves" in (await node.graph.node("/robot/transforms")).subscribing


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
async def test_ctrl_c_ends_the_republisher(
    hub: HubServer, start: Start, number: signal.Signals
) -> None:
    program = await start(REPUBLISHER, "--hub", hub.url)
    async with asyncio.timeout(PATIENCE), fibws.Node("test", hub=hub.url) as node:
        await node.wait_for_service("/republish_tfs")
    program.send(number)
    assert await program.end() == (0, "", "")


async def test_second_republisher_ends_the_first(hub: HubServer, start: Start) -> None:
    first = await start(REPUBLISHER, "--hub", hub.url)
    async with asyncio.timeout(PATIENCE), fibws.Node("test", hub=hub.url) as node:
        await node.wait_for_service("/republish_tfs")
    await start(REPUBLISHER, "--hub", hub.url)
    code, _, err = await first.end()
    *warnings, last = err.splitlines()  # The last warning may count an unsent status.
    assert (code, last) == (1, "Error: another node took the name /tf2_web_republisher")
    assert all("Messages that were not sent" in warning for warning in warnings)
