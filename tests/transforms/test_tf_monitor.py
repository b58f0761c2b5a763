"""The program tf_monitor."""

from __future__ import annotations

import asyncio

import pytest
from click.testing import CliRunner
from patience import PATIENCE
from running_programs import Start

from fibws.hub.server import HubServer
from fibws.msg.tf2_msgs import TFMessage
from fibws.programs.tf_monitor import Chain, Monitor, command
from fibws.tf.buffer import Buffer
from fibws.tf.history import Sample
from fibws.tf.messages import write
from fibws.tf.transform import Transform

from .conftest import Publish

MONITOR = "fibws.programs.tf_monitor"
SECOND = 1_000_000_000


def message(*frames: str, at: float) -> TFMessage:
    return TFMessage([write(each, Sample(int(at * SECOND), "map", Transform())) for each in frames])


def test_delays_and_rates_are_reported() -> None:
    monitor = Monitor()
    monitor.add(message("a", "b", at=1), "/one", 1.5)
    monitor.add(message("a", at=2), "/one", 3.5)
    monitor.add(message("c", at=4), "/two", 4)
    assert monitor.report().splitlines() == [
        "",
        "Frames:",
        "Frame: a published by /one Average Delay: 1 Max Delay: 1.5",
        "Frame: b published by /one Average Delay: 0.5 Max Delay: 0.5",
        "Frame: c published by /two Average Delay: 0 Max Delay: 0",
        "",
        "All Broadcasters:",
        "Node: /one 1 Hz, Average Delay: 1 Max Delay: 1.5",
        "Node: /two 1e+08 Hz, Average Delay: 0 Max Delay: 0",
    ]
    assert "Frame: c" not in monitor.report(["a"])


def test_delay_of_a_chain_is_reported() -> None:
    buffer = Buffer()
    chain = Chain(buffer, "map", "base")
    assert not chain.find()
    chain.measure(1)
    buffer.insert("odom", Sample(1 * SECOND, "map", Transform()))
    buffer.insert("base", Sample(1 * SECOND, "odom", Transform()))
    assert chain.find()
    chain.measure(3)
    assert chain.report().splitlines() == [
        "RESULTS: for map to base",
        "Chain is: map -> odom -> base",
        "Net delay     avg = 0.02: max = 2",
    ]


async def test_program_reports_until_it_is_stopped(
    hub: HubServer, start: Start, publish: Publish
) -> None:
    program = await start(MONITOR, "--hub", hub.url)
    seen: set[str] = set()
    async with asyncio.timeout(PATIENCE):
        while not any(line.startswith("Frame: base published by /client") for line in seen):
            await publish(("base", "map", 1.0))
            seen.add(await program.line())
        while not any(line.startswith("Node: /client") for line in seen):
            seen.add(await program.line())


async def test_program_waits_for_a_chain(hub: HubServer, start: Start, publish: Publish) -> None:
    program = await start(MONITOR, "map", "camera", "--hub", hub.url)
    await publish(("camera", "base", 2.0), static=True)
    seen = set()
    async with asyncio.timeout(PATIENCE):
        publishing = asyncio.create_task(_repeat(publish))
        while "Chain is: map -> base -> camera\n" not in seen:
            seen.add(await program.line())
        publishing.cancel()


async def _repeat(publish: Publish) -> None:
    while True:
        await publish(("base", "map", 1.0))
        await asyncio.sleep(0.05)


@pytest.mark.parametrize(
    ("arguments", "fault"),
    [("map", "got 1 arguments"), ("a b c", "got 3 arguments"), ("a /", "a frame's id is empty")],
)
def test_wrong_argument_is_an_error(arguments: str, fault: str) -> None:
    result = CliRunner().invoke(command, arguments.split())
    assert result.exit_code == 2
    assert fault in result.stderr
