"""The programs of rostest that test nodes."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator
from contextlib import suppress

import pytest
from running_programs import Program

import fibws
from fibws.hub.server import HubServer
from fibws.msg.std_msgs import Int32
from fibws.ros1.shell import ros_programs
from fibws.srv.rospy_tutorials import AddTwoInts

SOON = "timeout: 0.2"


@pytest.fixture
async def graph(hub: HubServer) -> AsyncIterator[None]:
    """A node that publishes /number at 50 Hz, subscribes to /other, and adds at /add."""

    async def publish() -> None:
        publisher = await node.advertise("number", Int32)
        async for _ in node.rate(50):
            await publisher.publish(data=8)

    async def listen() -> None:
        async for _ in node.subscribe("other", Int32):
            pass

    async def add(request: AddTwoInts.Request) -> AddTwoInts.Response:
        return AddTwoInts.Response(sum=request.a + request.b)

    async with fibws.Node("robot", hub=hub.url) as node:
        await node.service("add", AddTwoInts, add)
        tasks = [asyncio.create_task(each()) for each in (publish, listen)]
        yield
        for task in tasks:
            task.cancel()
            with suppress(asyncio.CancelledError):
                await task


@pytest.mark.parametrize(
    ("program", "parameters", "faults"),
    [
        ("hztest", ["topic:=number", "hz:=50", "hzerror:=30", "test_duration:=0.5"], []),
        (
            "hztest",
            ["topic:=number", "hz:=5", "hzerror:=1", "test_duration:=0.5", "wall_clock:=true"],
            ["is too high"],
        ),
        ("hztest", ["topic:=nothing", "hz:=0", "test_duration:=0.1", "wait_time:=0.1"], []),
        ("hztest", ["topic:=number", "hz:=0", "test_duration:=0.1"], ["a message was published"]),
        ("hztest", ["topic:=number", "test_duration:=0.1"], ["/hztest/hz] is not set"]),
        (
            "publishtest",
            [f"topics:=[{{name: number}}, {{name: quiet, negative: true, {SOON}}}]"],
            [],
        ),
        ("publishtest", [f"topics:=[{{name: quiet, {SOON}}}]"], ["[quiet] is not published"]),
        ("publishtest", ["topics:=[{name: number, negative: true}]"], ["[number] is published"]),
        ("publishtest", ["topics:=[{timeout: 1}]"], ["an entry of topics has no name"]),
        (
            "advertisetest",
            ["topics:=[{name: /number, type: std_msgs/Int32}]", "services:=[{name: /add}]"],
            [],
        ),
        (
            "advertisetest",
            [
                "topics:=[{name: /number, type: std_msgs/Int64}]",
                f"services:=[{{name: /quiet, {SOON}}}]",
            ],
            ["type of [/number]", "[/quiet] is not advertised"],
        ),
        ("subscribetest", [f"topics:=[{{name: other}}, {{name: n, negative: 1, {SOON}}}]"], []),
        ("subscribetest", ["topics:=[{name: other, negative: true}]"], ["[other] is subscribed"]),
        ("subscribetest", [], ["/subscribetest/topics] is not set"]),
        ("servicetest", ["calls:=[{name: /add, input: {a: 1, b: 2}, output: {sum: 3}}]"], []),
        (
            "servicetest",
            ["calls:=[{name: /add, input: None, output: {sum: 3}}]"],
            ["{'sum': 0} != {'sum': 3}"],
        ),
        ("paramtest", ["param_name_target:=/rosdistro", "test_duration:=1"], []),
        (
            "paramtest",
            ["param_name_target:=/no", "wait_time:=0.1"],
            ["Parameter [/no] is not set"],
        ),
        (
            "paramtest",
            ["param_name_target:=/rosdistro", "param_value_target:=foxy"],
            ["!= 'foxy'"],
        ),
    ],
)
@pytest.mark.long
async def test_node_is_tested(
    hub: HubServer, graph: None, program: str, parameters: list[str], faults: list[str]
) -> None:
    line = ros_programs.command_line("rostest", program, [f"_{each}" for each in parameters])
    assert line is not None
    started = await Program.start(*line[3:], FIBWS_HUB=hub.url)
    code, out, err = await started.end()
    assert err == ""
    assert code == (1 if faults else 0), out
    for fault in faults:
        assert fault in out
    assert ("SUCCESS" in out) is not bool(faults)
