"""The tutorial's first node."""

from __future__ import annotations

import asyncio
import json
import re
import signal
from collections.abc import AsyncIterator, Awaitable, Callable
from contextlib import asynccontextmanager

import pytest
from click.testing import CliRunner
from running_programs import Start
from websockets.asyncio.client import connect

import fibws
from fibws.hub.server import HubServer
from fibws.msg.rosgraph_msgs import Log
from fibws.msg.std_msgs import Int32, UInt8, UInt16
from fibws.programs.broadcaster import command, next_type

BROADCASTER = "fibws.broadcaster"
INT8 = [0, 1, 1, 2, 3, 5, 8, 13, 21, 34, 55, 89]


@asynccontextmanager
async def receiving(
    hub: HubServer, topic: str
) -> AsyncIterator[Callable[[int], Awaitable[list[int]]]]:
    """Yield a function that returns the numbers on a topic up to a number."""
    async with connect(hub.url) as websocket:
        await websocket.send(json.dumps({"op": "subscribe", "topic": topic}))
        await (await websocket.ping())  # The hub has processed the subscription by then.

        async def numbers(until: int) -> list[int]:
            heard: list[int] = []
            async with asyncio.timeout(60):
                while until not in heard:
                    heard.append(json.loads(await websocket.recv())["msg"]["data"])
            return heard

        yield numbers


FULL = fibws.InvalidMessage("too large")
REFUSED = fibws.OperationRejected("already established")
INT8_, INT16, INT64, UINT64 = (f"std_msgs/{name}" for name in ("Int8", "Int16", "Int64", "UInt64"))


@pytest.mark.parametrize(
    ("error", "now", "on_overflow", "next_"),
    [
        (FULL, INT8_, "restart", INT8_),
        (FULL, INT8_, "stop", None),
        (FULL, INT8_, "widen", INT16),
        (FULL, INT64, "widen", UINT64),
        (FULL, UINT64, "widen", UINT64),
        (REFUSED, INT16, "widen", INT8_),
    ],
)
def test_next_type_after_an_error(
    error: fibws.FibwsError, now: str, on_overflow: str, next_: str | None
) -> None:
    assert next_type(error, now, INT8_, on_overflow) == next_


def test_refusal_of_the_first_type_is_an_error() -> None:
    with pytest.raises(fibws.OperationRejected):
        next_type(REFUSED, INT8_, INT8_, "widen")


async def test_numbers_are_published_and_logged(hub: HubServer, start: Start) -> None:
    async with fibws.Node("test", hub=hub.url) as node:
        numbers = node.subscribe("fibonacci", Int32, queue_size=1000)
        lines = node.subscribe("/rosout", Log)
        program = await start(BROADCASTER, "--rate", "100", FIBWS_HUB=hub.url)
        heard = [(await anext(numbers)).data for _ in range(8)]
        assert heard == [0, 1, 1, 2, 3, 5, 8, 13]
        for number in heard:
            line = await program.line()
            assert re.fullmatch(rf"\[INFO\] \[\d{{10}}\.\d{{6}}\]: {number}\n", line)
        entry = await anext(lines)
        assert re.fullmatch(rf"/fibonacci_broadcaster_{program.pid}_\d{{13}}", entry.name)
        assert entry.topics == ["/fibonacci", "/rosout"]


async def test_names_can_be_chosen(hub: HubServer, start: Start) -> None:
    async with fibws.Node("test", hub=hub.url) as node:
        lines = node.subscribe("/rosout", Log)
        numbers = node.subscribe("/robot/numbers", Int32)
        remappings = ("fibonacci:=numbers", "__ns:=/robot")
        await start(BROADCASTER, "--hub", hub.url, "--node-name", "counter", *remappings)
        assert (await anext(numbers)).data == 0
        assert (await anext(lines)).name == "/robot/counter"


async def test_restart_on_overflow(hub: HubServer, start: Start) -> None:
    async with receiving(hub, "/fibonacci") as numbers:
        program = await start(
            BROADCASTER, "--hub", hub.url, "--rate", "200", "--type", "std_msgs/Int8"
        )
        assert re.fullmatch(
            r"\[WARN\] \[.*\]: 144 does not fit a std_msgs/Int8: .*\n",
            await program.error_line(),
        )
        assert await numbers(89) == INT8
    printed = [int((await program.line()).split()[-1]) for _ in range(14)]
    assert printed == [*INT8, 0, 1]


async def test_int32_holds_47_numbers(hub: HubServer, start: Start) -> None:
    program = await start(BROADCASTER, "--hub", hub.url, "--rate", "1000")
    warning = await program.error_line()
    assert ": 2971215073 does not fit a std_msgs/Int32: " in warning
    printed = [int((await program.line()).split()[-1]) for _ in range(48)]
    assert printed[46:] == [1836311903, 0]


async def test_stop_on_overflow(hub: HubServer, start: Start) -> None:
    program = await start(
        *(BROADCASTER, "--hub", hub.url, "--rate", "1000"),
        *("--type", "std_msgs/Int8", "--on-overflow", "stop"),
    )
    code, out, err = await program.end()
    assert code == 0
    assert [int(line.split()[-1]) for line in out.splitlines()] == INT8
    assert re.fullmatch(r"\[WARN\] \[.*\]: 144 does not fit a std_msgs/Int8: .*\n", err)


async def test_widen_on_overflow(hub: HubServer, start: Start) -> None:
    async with receiving(hub, "/fibonacci") as numbers:
        program = await start(
            *(BROADCASTER, "--hub", hub.url, "--rate", "100"),
            *("--type", "std_msgs/UInt8", "--on-overflow", "widen"),
        )
        assert await numbers(377) == [*INT8, 144, 233, 377]
    warning = await program.error_line()
    assert "377 does not fit a std_msgs/UInt8: " in warning and "std_msgs/UInt16" in warning


async def test_listener_of_the_narrower_type_does_not_stop_the_wider_one(
    hub: HubServer, start: Start
) -> None:
    async with fibws.Node("test", hub=hub.url) as node:
        numbers = node.subscribe("fibonacci", UInt8, queue_size=1000)
        program = await start(
            *(BROADCASTER, "--hub", hub.url, "--rate", "20"),
            *("--type", "std_msgs/UInt8", "--on-overflow", "widen"),
        )
        async with asyncio.timeout(60):
            heard = [(await anext(numbers)).data for _ in range(14)]
        assert heard == [*INT8, 144, 233]
        assert "continuing with std_msgs/UInt16" in await program.error_line()
        numbers.close()
        wider = node.subscribe("fibonacci", UInt16)
        async with asyncio.timeout(60):
            assert (await anext(wider)).data >= 377


async def test_topic_of_another_type_is_a_warning(hub: HubServer, start: Start) -> None:
    async with fibws.Node("test", hub=hub.url) as node:
        await node.advertise("fibonacci", UInt8)
        program = await start(BROADCASTER, "--hub", hub.url, "--rate", "100")
        assert "type std_msgs/UInt8 (published by /test)" in await program.error_line()


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
async def test_ctrl_c_ends_it_without_failure(
    hub: HubServer, start: Start, number: signal.Signals
) -> None:
    program = await start(BROADCASTER, "--hub", hub.url)
    await program.line()
    program.send(number)
    assert await program.end() == (0, "", "")


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
async def test_ctrl_c_ends_the_wait_for_a_hub(
    hub: HubServer, start: Start, number: signal.Signals
) -> None:
    url = hub.url
    await hub.close()
    program = await start(BROADCASTER, "--hub", url)
    assert "Waiting for a hub" in await program.error_line()
    program.send(number)
    assert await program.end() == (0, "", "")


async def test_closed_pipe_ends_it_quietly(hub: HubServer, start: Start) -> None:
    program = await start(BROADCASTER, "--hub", hub.url, "--rate", "5")
    await program.line()
    program.stop_reading()
    code, _, err = await program.end()
    assert (code, err) == (0, "")


async def test_second_node_of_the_same_name_ends_the_first(hub: HubServer, start: Start) -> None:
    first = await start(BROADCASTER, "--hub", hub.url, "--node-name", "counter")
    await first.line()
    second = await start(BROADCASTER, "--hub", hub.url, "--node-name", "counter")
    code, _, err = await first.end()
    assert (code, err) == (1, "Error: another node took the name /counter\n")
    await second.line()


def test_unknown_overflow_choice_is_an_error() -> None:
    result = CliRunner().invoke(command, ["--on-overflow", "explode"])
    assert result.exit_code == 2
    assert "'explode' is not one of 'restart', 'stop', 'widen'" in result.stderr
