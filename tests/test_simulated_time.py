"""Time that has not begun, stands still, jumps, loops or runs fast, for all that keeps time.

The table of docs/bags.md: each of `CASES` is tried with each kind of program.
"""

from __future__ import annotations

import asyncio
import json
import os
import sys
from collections.abc import AsyncIterator, Awaitable, Callable
from contextlib import asynccontextmanager
from pathlib import Path
from typing import Any, TypeAlias

import pytest
from hub.raw_client import connected
from patience import PATIENCE
from ros1.rospy.programs import running_hub

import fibws
from fibws.bag_recorder import RecordingOptions
from fibws.bags import open_reader, open_writer
from fibws.cli.bag.record import RecordingNode, Topics
from fibws.hub import Settings
from fibws.hub.server import HubServer
from fibws.interfaces import Interfaces
from fibws.msg.geometry_msgs import PointStamped
from fibws.msg.rosgraph_msgs import Clock
from fibws.msg.std_msgs import Header, Int32, String
from fibws.msg.tf2_msgs import TFMessage
from fibws.programs.tf_echo import echo
from fibws.tf import Buffer, TransformListener
from fibws.tf.history import Sample
from fibws.tf.messages import write
from fibws.tf.transform import Transform

SECOND = 1_000_000_000
ROOT = Path(__file__).parents[1]
Received: TypeAlias = Callable[[float, int], Awaitable[object]]
Publisher: TypeAlias = fibws.Publisher[Any, ...]

CASES: dict[str, list[float]] = {
    "no clock yet": [],
    "paused": [10, 10, 10],
    "an hour forward": [10, 3610],
    "back to the beginning": [20, 21, 0.5],
    "looping": [1, 2, 3, 1, 2, 3, 1, 2, 3],
    "rate 10": [10 * each for each in range(1, 20)],
    "another publisher": [5, 6, 7],
}
"""The times of /clock, in seconds."""

each_case = pytest.mark.parametrize("case", CASES)


class World:
    """Publishes /clock, and beside it everything with stamps of this time."""

    def __init__(self, hub: HubServer, case: str) -> None:
        self.hub = hub
        self.times = CASES[case]
        self.now = 0.0
        self._changes = case == "another publisher"
        self._node = fibws.Node("world", hub=hub.url, use_sim_time=False)
        self._clock: Publisher
        self._numbers: Publisher
        self._topics: dict[str, Publisher] = {}

    @asynccontextmanager
    async def running(self) -> AsyncIterator[World]:
        """Publish until the end of the block."""
        async with self._node as node:
            await node.params.set("/use_sim_time", True)
            latched = await node.advertise("/map", Int32, latch=True)
            await latched.publish(7)
            static = await node.advertise("/tf_static", TFMessage, latch=True)
            await static.publish(TFMessage([write("laser", Sample(0, "base", pose(100)))]))
            self._clock = await node.advertise("/clock", Clock)
            self._numbers = await node.advertise("/n", Int32, queue_size=100)
            self._topics = {
                topic: await node.advertise(topic, PointStamped, queue_size=100)
                for topic in ("/a", "/b")
            }
            self._tf = await node.advertise("/tf", TFMessage, queue_size=100)
            yield self

    async def play(self, *readers: fibws.Node, received: Received | None = None) -> None:
        """Publish all times of the case.

        Args:
            readers: have received each time before the next one.
            received: waits for others, after each message.
        """
        for index, seconds in enumerate(self.times):
            if index == 1 and self._changes:
                self._clock.close()
                other = fibws.Node("other", hub=self.hub.url, use_sim_time=False)
                async with other:
                    self._clock = await other.advertise("/clock", Clock)
                    await self.at(seconds, index)
                    await other.flush()
                    self._clock.close()
                self._clock = await self._node.advertise("/clock", Clock)
            else:
                await self.at(seconds, index)
            for reader in readers:
                await reader.flush()
            if received is not None:
                await received(seconds, index)

    async def at(self, seconds: float, number: int) -> None:
        """Publish a time, a pose and two messages with this stamp, and a number."""
        self.now = seconds
        stamp = fibws.Time.from_sec(seconds)
        await self._clock.publish(Clock(stamp))
        await self._node.flush()
        sample = Sample(stamp.to_nanoseconds(), "odom", pose(number))
        await self._tf.publish(TFMessage([write("base", sample)]))
        for topic in self._topics.values():
            await topic.publish(PointStamped(Header(stamp=stamp)))
        await self._numbers.publish(number)
        await self._node.flush()


def pose(x: float) -> Transform:
    return Transform((x, 0.0, 0.0))


@pytest.fixture
async def world(case: str, tmp_path: Path) -> AsyncIterator[World]:
    settings = Settings(port=0, close_timeout=0.1, record=tmp_path / "hub", record_min_space=0)
    async with HubServer(settings) as hub, World(hub, case).running() as world:
        yield world


@asynccontextmanager
async def subject(world: World) -> AsyncIterator[fibws.Node]:
    async with fibws.Node("subject", hub=world.hub.url) as node, asyncio.timeout(PATIENCE):
        yield node


@each_case
async def test_time_and_rate_of_nodes(world: World) -> None:
    """A rate ticks when its time has passed, and at once after a jump back."""
    async with subject(world) as node:
        assert node.now() == fibws.Time(), "before the first message of /clock"
        rate = node.rate(1)
        await anext(rate)
        ticks = 0

        async def loop() -> None:
            nonlocal ticks
            async for _ in rate:
                ticks += 1

        looping = asyncio.create_task(loop())
        await node.flush()
        assert ticks == 0
        await world.play(node)
        assert node.now() == fibws.Time.from_sec(world.now)
        assert (ticks > 0) == bool(world.times)
        for later in range(3):
            before = ticks
            await world.at(world.now + 3, later)
            await node.flush()
            await node.flush()
            assert ticks > before, "it goes on, from wherever the time is now"
        before = ticks
        await world.at(world.now, 9)
        await node.flush()
        assert ticks == before, "a clock that stands still"
        looping.cancel()


@each_case
async def test_transforms_of_nodes(world: World) -> None:
    async with subject(world) as node, TransformListener(node) as transforms:
        laser = await transforms.wait("base", "laser")
        assert laser.transform == pose(100), "static frames need no clock, and stay"
        await world.play(node)
        if world.times:
            last = Sample(round(world.now * SECOND), "odom", pose(99 + len(world.times)))
            assert transforms.buffer.lookup("odom", "laser") == last


@each_case
@pytest.mark.long
async def test_tf_echo(world: World) -> None:
    async with subject(world) as node:
        texts: list[str] = []
        news = asyncio.Event()

        def report(text: str) -> None:
            texts.append(text)
            news.set()

        echoing = asyncio.create_task(echo(node, Buffer(), "base", "laser", 10, report))
        await news.wait()
        assert texts[0].startswith("At time 0.000\n")
        echoing.cancel()
        await asyncio.wait([echoing])
        texts.clear()
        news.clear()
        echoing = asyncio.create_task(echo(node, Buffer(), "odom", "base", 10, report))
        await news.wait()  # A failure, as there is no transform.
        await world.play(node)
        shown: tuple[str, ...] = ("never",)
        while not texts[-1].startswith(shown):
            news.clear()
            # It ticks when it receives the time, which comes before the pose of that time.
            shown = (f"At time {world.now:.3f}\n", f"At time {world.now + 1:.3f}\n")
            await world.at(world.now + 1, 1)
            await news.wait()
        echoing.cancel()


@each_case
async def test_timeouts_are_never_simulated(world: World) -> None:
    async with subject(world) as node, fibws.Node("server", hub=world.hub.url) as server:
        await server.service("/slow", "std_srvs/Empty", lambda request: asyncio.sleep(PATIENCE))
        await world.play(node)
        with pytest.raises(TimeoutError):
            await node.call("/slow", "std_srvs/Empty", timeout=0.01)
        with pytest.raises(TimeoutError):
            await node.wait_for_service("/missing", timeout=0.01)
        with pytest.raises(TimeoutError):
            await node.wait_for_message("/nothing", Int32, timeout=0.01)
        client = node.action_client("/missing", "actionlib_tutorials/Fibonacci")
        with pytest.raises(TimeoutError):
            await client.wait_for_server(timeout=0.01)


@each_case
async def test_wills_are_published_at_once(world: World) -> None:
    async with subject(world) as node:
        wills = node.subscribe("/will", Int32)
        async with connected(world.hub.port) as client:
            await client.advertises("/will")
            await client.send_operation("set_will", id="will", topic="/will", msg={"data": 3})
            await client.is_processed()
            await world.play(node)
            client.reset()
        assert (await anext(wills)).data == 3


@each_case
async def test_throttles_are_never_simulated(world: World) -> None:
    """Messages that a throttle has held back arrive while the clock stands still."""
    async with subject(world) as node, connected(world.hub.port) as client:
        await client.subscribes("/m", throttle_rate=10, queue_length=9)
        await world.play(node)
        numbers = await node.advertise("/m", Int32)
        for number in range(3):
            await numbers.publish(number)
        assert await client.receive_data(3) == [0, 1, 2]


@each_case
async def test_recordings_have_no_message_from_before_time(world: World, tmp_path: Path) -> None:
    """Of the hub and of ``fibws bag record``: the times are those of the clock."""
    path = tmp_path / "a.bag"
    options = RecordingOptions(path=str(path), dated=False, min_space=0)
    async with subject(world) as node:
        recording = RecordingNode(node, Topics(names=(), all=True), options, announces=False)
        running = asyncio.create_task(recording.run())
        while not {"/n", "/map"} <= set((await node.graph.node(node.name)).subscribing):
            await node.flush()
        await world.play(node)
        running.cancel()
        await asyncio.wait([running])
    await world.hub.close()
    [hubs] = (tmp_path / "hub").iterdir() if world.times else [None]
    expected = [round(seconds * SECOND) for seconds in world.times]
    for each in (path, hubs):
        found = times(each) if each else {}
        assert found.get("/n", []) == sorted(expected), each
        assert found.get("/map", []) == expected[:1], "what was latched has the first time"


def times(path: Path) -> dict[str, list[int]]:
    """Return the times of the messages of each topic."""
    found: dict[str, list[int]] = {}
    with open_reader(path) as bag:
        for connection, time, _ in bag.messages():
            found.setdefault(connection.topic, []).append(time)
    return found


@each_case
@pytest.mark.long
async def test_player_follows_no_other_clock(world: World, tmp_path: Path) -> None:
    """It plays at the speed of the machine's time, whatever the simulated time does."""
    path = tmp_path / "a.bag"
    bag_of_numbers(path)
    async with subject(world) as node:
        played = node.subscribe("/played", Int32)
        await node.flush()
        player = await asyncio.create_subprocess_exec(
            *(sys.executable, "-m", "fibws", "bag", "play", str(path), "-q", "-d", "0"),
            "--wait-for-subscribers",
            env={**os.environ, "FIBWS_HUB": world.hub.url},
            cwd=ROOT,
        )
        await world.play(node)
        assert [(await anext(played)).data for _ in range(3)] == [0, 1, 2]
        assert await player.wait() == 0


def bag_of_numbers(path: Path) -> None:
    interfaces = Interfaces()
    with open_writer(path, "none") as bag:
        connection = bag.connection(
            "/played",
            "std_msgs/Int32",
            interfaces.md5("std_msgs/Int32"),
            interfaces.full_text("std_msgs/Int32"),
        )
        for number in range(3):
            bag.write(connection, (100 + number) * SECOND // 100, number.to_bytes(4, "little"))


ROSPY = """
    import json, threading
    import message_filters, rospy, tf2_ros
    from geometry_msgs.msg import PointStamped
    from std_msgs.msg import String
    import std_srvs.srv

    rospy.init_node("rospy_subject")
    seen = {"rate": 0, "timer": 0, "sleep": 0, "pair": None}
    buffer = tf2_ros.Buffer()
    listener = tf2_ros.TransformListener(buffer)

    def count(name):
        seen[name] += 1

    def pair(a, b):
        seen["pair"] = [a.header.stamp.to_sec(), b.header.stamp.to_sec()]

    filters = [message_filters.Subscriber(topic, PointStamped) for topic in ("/a", "/b")]
    message_filters.TimeSynchronizer(filters, 10, reset=True).registerCallback(pair)
    rospy.Timer(rospy.Duration(1), lambda event: count("timer"), reset=True)

    def repeat(name, wait):
        while not rospy.is_shutdown():
            try:
                wait()
                count(name)
            except rospy.exceptions.ROSTimeMovedBackwardsException:
                pass

    rate = rospy.Rate(1, reset=True)
    for name, wait in (("rate", rate.sleep), ("sleep", lambda: rospy.sleep(1))):
        threading.Thread(target=repeat, args=(name, wait), daemon=True).start()

    def state(asked):
        try:
            transform = buffer.lookup_transform("odom", "laser", rospy.Time())
            where = [transform.header.stamp.to_sec(), transform.transform.translation.x]
        except tf2_ros.TransformException:
            where = None
        try:
            rospy.wait_for_service("/missing", timeout=0.01)
            timed_out = False
        except rospy.ROSException:
            timed_out = True
        print(json.dumps({**seen, "now": rospy.get_time(), "tf": where, "timeout": timed_out}))

    rospy.Subscriber("/ask", String, state)
    print("ready")
    try:
        rospy.spin()
    except rospy.ROSInterruptException:
        pass
"""


@each_case
async def test_rospy(case: str) -> None:
    """Rate, Timer, sleep, tf2, message_filters and time-outs of rospy."""
    async with (
        running_hub() as programs,
        World(programs.hub, case).running() as world,
        subject(world) as node,
    ):
        ask = await node.advertise("/ask", String)
        program = await programs.start(ROSPY)
        assert await program.read_line() == "ready"
        while not {"/clock", "/tf", "/a", "/b", "/ask"} <= set(
            (await node.graph.node("/rospy_subject")).subscribing
        ):
            await node.flush()

        async def state() -> dict[str, Any]:
            await ask.publish("")
            found: dict[str, Any] = json.loads(await program.read_line())
            return found

        async def received(now: float, number: int) -> None:
            # As tf2, this ignores a second pose of the same time.
            x = 100.0 + (number if case != "paused" else 0)
            expected = {"now": now, "tf": [now, x], "pair": [now, now], "timeout": True}
            while (found := await state()) | expected != found:
                pass

        await world.play(received=received)
        found = await state()
        if not world.times:
            assert (found["now"], found["tf"], found["timeout"]) == (0, None, True)
            assert (found["rate"], found["timer"], found["sleep"]) == (0, 0, 0)
            return
        for name in ("rate", "timer", "sleep"):  # They go on, from wherever the time is now.
            before = found[name]
            while found[name] == before:
                await world.at(world.now + 1, 1)
                found = await state()
