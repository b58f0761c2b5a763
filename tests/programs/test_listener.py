"""The tutorial's second node."""

from __future__ import annotations

import re
import signal

from running_programs import Start

import fibws
from fibws.hub.server import HubServer
from fibws.msg.rosgraph_msgs import Log
from fibws.msg.std_msgs import Float64, Int32

LISTENER = "fibws.listener"


async def test_numbers_are_logged(hub: HubServer, start: Start) -> None:
    async with fibws.Node("test", hub=hub.url) as node:
        numbers = await node.advertise("fibonacci", Int32, latch=True)
        lines = node.subscribe("/rosout", Log)
        await numbers.publish(8)
        program = await start(LISTENER, FIBWS_HUB=hub.url)
        assert re.fullmatch(r"\[INFO\] \[\d{10}\.\d{6}\]: I heard 8\n", await program.line())
        await numbers.publish(13)
        assert (await program.line()).endswith(": I heard 13\n")
        line = await anext(lines)
        assert re.fullmatch(rf"/fibonacci_listener_{program.pid}_\d{{13}}", line.name)


async def test_names_and_type_can_be_chosen(hub: HubServer, start: Start) -> None:
    async with fibws.Node("test", hub=hub.url) as node:
        numbers = await node.advertise("numbers", Float64, latch=True)
        lines = node.subscribe("/rosout", Log)
        await numbers.publish(0.5)
        program = await start(
            *(LISTENER, "--hub", hub.url, "--node-name", "ear"),
            *("--type", "std_msgs/Float64", "fibonacci:=numbers"),
        )
        assert (await program.line()).endswith(": I heard 0.5\n")
        assert (await anext(lines)).name == "/ear"


async def test_numbers_of_a_broadcaster_are_logged(hub: HubServer, start: Start) -> None:
    listener = await start(LISTENER, "--hub", hub.url, "--node-name", "ear")
    await start("fibws.broadcaster", "--hub", hub.url, "--rate", "50")
    first = int((await listener.line()).split()[-1])
    second = int((await listener.line()).split()[-1])
    assert second >= first
    listener.send(signal.SIGINT)
    code, _, err = await listener.end()
    assert (code, err) == (0, "")


async def test_topic_of_another_type_is_a_warning(hub: HubServer, start: Start) -> None:
    async with fibws.Node("test", hub=hub.url) as node:
        await node.advertise("fibonacci", Float64)
        program = await start(LISTENER, "--hub", hub.url)
        assert "type std_msgs/Float64 (published by /test)" in await program.error_line()
        await start("fibws.broadcaster", "--hub", hub.url, "--rate", "50")
        assert await program.line()
