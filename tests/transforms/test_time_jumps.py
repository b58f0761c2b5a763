"""Transforms while simulated time is set back, as by a bag that is played again."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator, Awaitable, Callable
from typing import Any, TypeAlias

import pytest
from patience import PATIENCE
from running_programs import Start

import fibws
from fibws.hub.server import HubServer
from fibws.msg.rosgraph_msgs import Clock, Log
from fibws.msg.tf2_msgs import TFMessage
from fibws.tf import TransformListener
from fibws.tf.errors import TransformOutOfTime, UnconnectedFrames
from fibws.tf.history import Sample
from fibws.tf.messages import write
from fibws.tf.transform import Transform

Publisher: TypeAlias = fibws.Publisher[Any, ...]

SECOND = 1_000_000_000


class Robot:
    """Publishes a clock and where the robot is, in this order."""

    def __init__(self, node: fibws.Node, clock: Publisher, tf: Publisher) -> None:
        self._node, self._clock, self._tf = node, clock, tf

    async def at(self, seconds: float, x: float, *, frame: str = "base") -> None:
        """Publish a time, and a pose of this time."""
        stamp = round(seconds * SECOND)
        await self._clock.publish(Clock(fibws.Time.from_nanoseconds(stamp)))
        await self._tf.publish(TFMessage([write(frame, Sample(stamp, "odom", pose(x)))]))
        await self._node.flush()


def pose(x: float) -> Transform:
    return Transform((x, 0.0, 0.0))


@pytest.fixture
async def robot(hub: HubServer, node: fibws.Node) -> Robot:
    await node.params.set("/use_sim_time", True)
    clock = await node.advertise("/clock", Clock)
    tf = await node.advertise("/tf", TFMessage, queue_size=100)
    static = await node.advertise("/tf_static", TFMessage, latch=True)
    await static.publish(TFMessage([write("laser", Sample(0, "base", pose(100)))]))
    return Robot(node, clock, tf)


@pytest.fixture
async def listener(hub: HubServer, robot: Robot) -> AsyncIterator[TransformListener]:
    async with (
        fibws.Node("listening", hub=hub.url) as node,
        TransformListener(node) as listener,
    ):
        await node.flush()
        yield listener


async def test_buffer_is_cleared_when_time_goes_back(
    robot: Robot, listener: TransformListener, line: Callable[[str], Awaitable[Log]]
) -> None:
    await robot.at(20, 2)
    await robot.at(20.1, 7, frame="arm")
    assert (await listener.wait("odom", "arm", timeout=PATIENCE)).transform == pose(7)
    await robot.at(0.5, 1)
    warning = await line("jump back in time")
    assert warning.level == Log.WARN
    assert warning.msg == "Detected jump back in time of 19.600000s. Clearing TF buffer."
    sample = await listener.wait("odom", "laser", timeout=PATIENCE)
    assert (sample.stamp, sample.transform) == (SECOND // 2, pose(101)), "static frames stay"
    with pytest.raises(UnconnectedFrames):
        listener.buffer.lookup("odom", "arm")


async def test_jump_is_reported_once_for_each_jump(
    robot: Robot, listener: TransformListener, line: Callable[[str], Awaitable[Log]]
) -> None:
    for _ in range(3):
        for seconds in (1, 2, 3):
            await robot.at(seconds, seconds)
    await robot.at(0.25, 0)
    backs = [(await line("jump back in time")).msg.split()[6] for _ in range(3)]
    assert backs == ["2.000000s.", "2.000000s.", "2.750000s."]


async def test_transforms_from_before_a_jump_do_not_survive_it(
    robot: Robot, listener: TransformListener, node: fibws.Node
) -> None:
    """They may be read in one go with the clock that goes back."""
    for loop in range(20):
        for seconds in (1, 2, 3, 4):
            await robot.at(seconds, loop * 10 + seconds)
        await robot.at(0.5, loop)
        sample = await latest(listener, SECOND // 2)
        assert (sample.stamp, sample.transform) == (SECOND // 2, pose(loop))
        with pytest.raises(TransformOutOfTime):
            listener.buffer.lookup("odom", "base", 4 * SECOND)


async def latest(listener: TransformListener, stamp: int) -> Sample:
    """The latest transform, once there is one with a stamp."""
    await listener.wait("odom", "base", stamp, timeout=PATIENCE)
    return listener.buffer.lookup("odom", "base")


async def test_jump_forward_and_a_pause_keep_the_transforms(
    robot: Robot, listener: TransformListener
) -> None:
    await robot.at(1, 1, frame="arm")
    await robot.at(1, 1)
    await robot.at(3601, 5)
    assert (await latest(listener, 3601 * SECOND)).transform == pose(5)
    assert listener.buffer.lookup("odom", "arm").transform == pose(1)


async def test_time_without_a_clock_is_0_and_transforms_are_kept(
    hub: HubServer, robot: Robot, listener: TransformListener
) -> None:
    sample = await listener.wait("base", "laser", timeout=PATIENCE)
    assert (sample.stamp, sample.transform) == (0, pose(100))


async def test_tf_echo_follows_a_loop(hub: HubServer, robot: Robot, start: Start) -> None:
    program = await start("fibws.programs.tf_echo", "odom", "base", "1000", "--hub", hub.url)

    async def prints(text: str) -> None:
        async with asyncio.timeout(PATIENCE):
            while await program.line() != text:
                pass

    async def move(*times: float) -> None:
        while True:  # Its rate is of simulated time.
            for seconds in times:
                await robot.at(seconds, seconds)

    moving = asyncio.create_task(move(4.0, 4.1, 4.2))
    await prints("At time 4.200\n")
    moving.cancel()
    moving = asyncio.create_task(move(0.5, 0.6))
    await prints("At time 0.600\n")
    moving.cancel()
