"""Hubs that are joined: what a link costs, how late messages are, and how cost grows with hubs."""

from __future__ import annotations

import asyncio
import gc
import logging
import multiprocessing
import os
import signal
import time
from collections.abc import AsyncIterator, Callable, Iterator, Sequence
from contextlib import AsyncExitStack, asynccontextmanager, contextmanager
from importlib.util import find_spec
from multiprocessing.connection import Connection
from statistics import quantiles
from typing import Any

import fibws
from bench.machine import free_port, memory
from bench.measure import HUB, BenchError, Plan
from bench.report import Report
from bench.servers import Server, running
from fibws.hub import Settings
from fibws.hub.federation.connections import Join
from fibws.hub.server import HubServer
from fibws.msg.sensor_msgs import Image
from fibws.msg.std_msgs import Float64, String, UInt8MultiArray

PATIENCE = 60.0
LATENCY_HZ = 200
SMALL_PER_SECOND = 10_000
IMAGE_BYTES, IMAGES_HZ = 921_600, 30
FLOOD_BYTES = 100_000_000
"""Bytes of images a second beside a small topic."""
SMALL_HZ = 10
LATCHED_BYTES = 1000
HUBS, QUICK_HUBS = (2, 5, 10, 20), (2, 5)
ROBOTS, QUICK_ROBOTS = (5, 20, 80), (2, 5)
TOPICS = 50
LIMIT_ADDED_MS = 1.0
LIMIT_IMAGES_PERCENT = 15.0
LIMIT_UNUSED_BYTES = 0.0
LIMIT_KILLED_MS, LIMIT_LATCHED_MS, LIMIT_BESIDE_IMAGES_MS = 1000.0, 100.0, 50.0

processes = multiprocessing.get_context("fork")


def hubs(plan: Plan, report: Report) -> None:
    """Measure a link between two hubs, and hubs around one in the middle."""
    has_zenoh = find_spec("zenoh") is not None and not plan.quick
    for kind in ("websocket", *(("zenoh",) if has_zenoh else ())):
        with _first(kind) as (first, join), running(HUB, pinned=False, options=join) as second:
            rows = asyncio.run(_link(kind, first, second, join, plan, report))
        report.table(f"Two hubs that are joined: {kind}", ("", "value", "limit"), rows)
    growth = []
    for number in QUICK_HUBS if plan.quick else HUBS:
        ours, theirs = processes.Pipe()
        process = processes.Process(target=_grow, args=(number, theirs))
        process.start()
        if not ours.poll(PATIENCE * 3):
            raise BenchError(f"{number} hubs do not find each other")
        facts = ours.recv()
        process.join()
        report.record("hubs growth", hubs=number, **facts)
        growth.append(
            (
                str(number),
                f"{facts['memory'] / number / 1e6:.1f} MB",
                f"{facts['bytes'] / number / 1000:.0f} kB",
                f"{facts['seconds']:.2f} s",
                f"{facts['cpu'] / number:.2f} s",
            )
        )
    report.table(
        f"Hubs around one in the middle, {TOPICS} topics on each, all in one process",
        ("hubs", "memory of a hub", "sent by a hub", "until all see all", "CPU of a hub"),
        growth,
    )
    report.table(
        f"Robots with {TOPICS} topics each, which join one hub below prefixes: its cost per robot",
        (
            "robots",
            "memory",
            "received",
            "CPU to join",
            "CPU when idle",
            "until all are seen",
        ),
        _fleet(plan, report),
    )


@contextmanager
def _first(kind: str) -> Iterator[tuple[Server, list[str]]]:
    """Start a hub; yield it, and the options of a hub that joins it."""
    if kind == "zenoh":
        endpoint = f"tcp/127.0.0.1:{free_port()}"
        with running(HUB, pinned=False, options=["--zenoh-listen", endpoint]) as server:
            yield server, ["--zenoh", endpoint]
    else:
        with running(HUB, pinned=False) as server:
            yield server, ["--join", address(server)]


def address(server: Server) -> str:
    """Return a hub's URL."""
    return f"ws://127.0.0.1:{server.port}"


async def _link(
    kind: str, first: Server, second: Server, join: list[str], plan: Plan, report: Report
) -> list[tuple[str, str, str]]:
    rows: list[tuple[str, str, str]] = []

    def row(what: str, value: float, limit: float | None, unit: str) -> None:
        report.record("hubs", link=kind, what=what, value=value)
        verdict = report.check(HUB, f"{kind}, {what}", value, limit, unit)
        rows.append((what, f"{value:.3g}{unit}", verdict))

    for step in (_latency, _small, _images, _unused, _latched, _beside_images, _killed):
        async with AsyncExitStack() as stack:
            source = await stack.enter_async_context(_node("source", first))
            target = await stack.enter_async_context(_node("target", second))
            await step(Ends(first, second, join, source, target), plan, row)
    return rows


class Ends:
    """The two hubs, the options of another one that joins the first one, and a node at each."""

    def __init__(
        self,
        first: Server,
        second: Server,
        join: list[str],
        source: fibws.Node,
        target: fibws.Node,
    ) -> None:
        self.first, self.second, self.join = first, second, join
        self.source, self.target = source, target

    async def traffic(self) -> int:
        """Return the bytes that the first hub has sent by its link."""
        response = await self.source.call("/rosapi/hubs", "fibws_msgs/GetHubs")
        return sum(link.bytes_sent for link in response.links)


Row = Callable[[str, float, "float | None", str], None]


@asynccontextmanager
async def _node(name: str, server: Server) -> AsyncIterator[fibws.Node]:
    async with fibws.Node(name, hub=address(server), rosout=False) as node:
        yield node


async def _subscribed(publisher: fibws.Publisher[Any, ...], number: int = 1) -> None:
    async with asyncio.timeout(PATIENCE):
        async for names in publisher.peers.changes():
            if len(names) >= number:
                return


async def _delays(
    ends: Ends, topic: str, hz: float, seconds: float, node: fibws.Node
) -> list[float]:
    """Publish times at a rate; return the seconds until they arrive at a node."""
    publisher = await ends.source.advertise(topic, Float64, queue_size=1000, peers=True)
    subscription = node.subscribe(topic, Float64, queue_size=None)
    await _subscribed(publisher)
    delays: list[float] = []

    async def read() -> None:
        async for message in subscription:
            delays.append(time.perf_counter() - message.data)

    reader = asyncio.create_task(read())
    number = max(10, round(hz * seconds))
    async for _ in _rate(hz, number):
        await publisher.publish(time.perf_counter())
    await _until(lambda: len(delays) == number, topic)
    reader.cancel()
    subscription.close()
    return delays


async def _until(condition: Callable[[], bool], what: str) -> None:
    deadline = time.monotonic() + PATIENCE
    while not condition():
        if time.monotonic() > deadline:
            raise BenchError(f"messages of {what} have not arrived")
        await asyncio.sleep(0.001)


async def _rate(hz: float, number: int) -> AsyncIterator[int]:
    start = time.perf_counter()
    for each in range(number):
        await asyncio.sleep(max(0.0, start + each / hz - time.perf_counter()))
        yield each


async def _latency(ends: Ends, plan: Plan, row: Row) -> None:
    """Compare messages to a node of the same hub with those to one of the other hub."""
    async with _node("near", ends.first) as near:
        own = await _delays(ends, "near", LATENCY_HZ, plan.seconds * 2, near)
    across = await _delays(ends, "far", LATENCY_HZ, plan.seconds * 2, ends.target)
    for percent, limit in ((50, LIMIT_ADDED_MS), (99, None)):
        at_hub, by_link = (quantiles(each, n=100)[percent - 1] * 1000 for each in (own, across))
        row(f"latency at one hub, p{percent}", at_hub, None, " ms")
        row(f"latency added by the link, p{percent}", by_link - at_hub, limit, " ms")


async def _cost(
    ends: Ends, topic: str, type_: Any, message: Any, hz: float, burst: int, seconds: float
) -> tuple[float, float, float, int]:
    """Publish messages; return the CPU seconds of both hubs, the seconds, and the number."""
    publisher = await ends.source.advertise(topic, type_, queue_size=10_000, peers=True)
    subscription = ends.target.subscribe(topic, type_, queue_size=None)
    await _subscribed(publisher)
    received = 0

    async def read() -> None:
        nonlocal received
        async for _ in subscription:
            received += 1

    reader = asyncio.create_task(read())
    before = ends.first.cpu_seconds, ends.second.cpu_seconds
    start, number = time.perf_counter(), round(hz * seconds / burst)
    async for _ in _rate(hz / burst, number):
        for _ in range(burst):
            await publisher.publish(message)
    took = time.perf_counter() - start
    await _until(lambda: received == number * burst, topic)
    after = ends.first.cpu_seconds, ends.second.cpu_seconds
    reader.cancel()
    subscription.close()
    return after[0] - before[0], after[1] - before[1], took, received


async def _small(ends: Ends, plan: Plan, row: Row) -> None:
    message = String(data="x" * 100)
    first, second, took, number = await _cost(
        ends, "small", String, message, SMALL_PER_SECOND, 20, plan.seconds
    )
    row("small messages across, per second", number / took, None, "")
    row("CPU of the sending hub per small message", first / number * 1e6, None, " µs")
    row("CPU of the receiving hub per small message", second / number * 1e6, None, " µs")


async def _images(ends: Ends, plan: Plan, row: Row) -> None:
    image = Image(data=bytes(IMAGE_BYTES))
    first, second, took, _ = await _cost(ends, "images", Image, image, IMAGES_HZ, 1, plan.seconds)
    what = f"CPU of the {{}} hub for images of {IMAGE_BYTES / 1000:.0f} kB at {IMAGES_HZ} Hz"
    row(what.format("sending"), 100 * first / took, LIMIT_IMAGES_PERCENT, " %")
    row(what.format("receiving"), 100 * second / took, LIMIT_IMAGES_PERCENT, " %")


async def _unused(ends: Ends, plan: Plan, row: Row) -> None:
    """Compare the link's bytes while a topic without remote subscribers is silent, and is not."""
    async with _node("near", ends.first) as near:
        publisher = await ends.source.advertise("unused", String, peers=True)
        subscription = near.subscribe("unused", String)
        await _subscribed(publisher)
        pause = 0.5 if plan.quick else 2.0
        await asyncio.sleep(pause)  # Until it is announced.
        sent = []
        for number in (0, 1000):
            before = await ends.traffic()
            for _ in range(number):
                await publisher.publish("x" * 1000)
            await asyncio.sleep(pause)
            sent.append(await ends.traffic() - before)
        subscription.close()
    pings = 2 * (13 + 21)  # Two more pings and answers than without messages.
    unused = max(0, sent[1] - sent[0] - pings)
    row("bytes sent of an unused topic", unused, LIMIT_UNUSED_BYTES, "")


async def _latched(ends: Ends, plan: Plan, row: Row) -> None:
    took = []
    publisher = await ends.source.advertise("latched", UInt8MultiArray, latch=True)
    await publisher.publish(UInt8MultiArray(data=bytes(LATCHED_BYTES)))
    await asyncio.sleep(0.5)
    for number in range(10):
        async with _node(f"late{number}", ends.second) as late:
            began = time.perf_counter()
            async with asyncio.timeout(PATIENCE):
                await late.wait_for_message("latched", UInt8MultiArray)
            took.append(time.perf_counter() - began)
    row("latched message at a late subscriber", max(took) * 1000, LIMIT_LATCHED_MS, " ms")


def _flood(end: str, first: str, second: str) -> None:
    """Publish many images at the first hub, or take them at the second one."""

    async def run() -> None:
        hub = first if end == "source" else second
        async with fibws.Node(f"flood_{end}", hub=hub, rosout=False) as node:
            if end == "source":
                publisher = await node.advertise("flood", Image, queue_size=5)
                image = Image(data=bytes(IMAGE_BYTES))
                async for _ in _rate(FLOOD_BYTES / IMAGE_BYTES, 1_000_000):
                    await publisher.publish(image)
            async for _ in node.subscribe("flood", Image, queue_size=5):
                pass

    asyncio.run(run())


async def _beside_images(ends: Ends, plan: Plan, row: Row) -> None:
    urls = address(ends.first), address(ends.second)
    floods = [
        processes.Process(target=_flood, args=(end, *urls), daemon=True)
        for end in ("target", "source")
    ]
    for flood in floods:
        flood.start()
    try:
        await ends.target.wait_for_message("flood", Image, timeout=PATIENCE)
        before, began = await ends.traffic(), time.perf_counter()
        seconds = 1.0 if plan.quick else plan.seconds * 2
        delays = await _delays(ends, "beside", SMALL_HZ, seconds, ends.target)
        rate = (await ends.traffic() - before) / (time.perf_counter() - began)
    finally:
        for flood in floods:
            flood.terminate()
            flood.join()
    row("images across, MB/s", rate / 1e6, None, "")
    delay = quantiles(delays, n=100)
    row(f"delay of a {SMALL_HZ} Hz topic beside them, p50", delay[49] * 1000, None, " ms")
    row(
        f"delay of a {SMALL_HZ} Hz topic beside them, most",
        max(delays) * 1000,
        LIMIT_BESIDE_IMAGES_MS,
        " ms",
    )


async def _killed(ends: Ends, plan: Plan, row: Row) -> None:
    """Kill a hub that has joined the first one; see its node vanish at the second one."""
    try:
        with running(HUB, pinned=False, options=ends.join) as third:
            async with _node("victim", third) as victim:
                await victim.advertise("victims", String)
                seen = ends.target.subscribe("victims", String, peers=True)
                async with asyncio.timeout(PATIENCE):
                    async for names in seen.peers.changes():
                        if names:
                            os.kill(third.pid, signal.SIGKILL)
                            began = time.perf_counter()
                            break
                    async for names in seen.peers.changes():
                        if not names:
                            break
                took = (time.perf_counter() - began) * 1000
                row("kill -9 of a hub seen", took, LIMIT_KILLED_MS, " ms")
    except BenchError as error:
        if "exited" not in str(error):
            raise


def _fleet(plan: Plan, report: Report) -> Iterator[Sequence[str]]:
    """Let robots join a hub, each below its prefix; yield what they cost it."""
    for number in QUICK_ROBOTS if plan.quick else ROBOTS:
        with running(HUB, pinned=False) as cloud:
            ours, theirs = processes.Pipe()
            before, cpu = memory(cloud.pid)["VmRSS"], cloud.cpu_seconds
            robots = processes.Process(target=_robots, args=(number, address(cloud), theirs))
            robots.start()
            if not ours.poll(PATIENCE * 3):
                raise BenchError(f"{number} robots do not join")
            seconds, received = ours.recv()
            size = memory(cloud.pid)["VmRSS"] - before
            cpu = cloud.cpu_seconds - cpu
            idle, idle_seconds = cloud.cpu_seconds, 0.5 if plan.quick else 5.0
            time.sleep(idle_seconds)
            idle = (cloud.cpu_seconds - idle) / idle_seconds
            ours.send(None)
            robots.join()
        report.record(
            "hubs fleet", robots=number, memory=size, bytes=received, cpu=cpu, seconds=seconds
        )
        yield (
            str(number),
            f"{size / number / 1000:.0f} kB",
            f"{received / number / 1000:.0f} kB",
            f"{cpu / number * 1000:.1f} ms",
            f"{100 * idle / number:.3f} %",
            f"{seconds:.2f} s",
        )


def _robots(number: int, cloud: str, results: Connection) -> None:
    asyncio.run(_join_robots(number, cloud, results))


async def _join_robots(number: int, cloud: str, results: Connection) -> None:
    """Start hubs of robots with topics; report when a viewer sees all of them."""
    logging.getLogger("fibws.hub").setLevel(logging.ERROR)
    async with AsyncExitStack() as stack:
        viewer = await stack.enter_async_context(fibws.Node("viewer", hub=cloud, rosout=False))
        names = [f"robot{n}" for n in range(number)]
        hubs = {
            name: await stack.enter_async_context(HubServer(Settings(port=0, hub_name=name)))
            for name in names
        }
        for hub in hubs.values():
            node = await stack.enter_async_context(fibws.Node("driver", hub=hub.url, rosout=False))
            for each in range(TOPICS):
                await node.advertise(f"topic_{each}", String)
        started = time.perf_counter()
        joins = [
            Join(cloud, hub.federation, Settings(port=0, join_prefix=f"/{name}"))
            for name, hub in hubs.items()
        ]
        for join in joins:
            join.start()
        expected, seen = number * TOPICS, 0
        while seen < expected:
            await asyncio.sleep(0.05)
            topics = await viewer.call("/rosapi/topics", "rosapi/Topics")
            seen = sum("/topic_" in name for name in topics.topics)
        seconds = time.perf_counter() - started
        links = (await viewer.call("/rosapi/hubs", "fibws_msgs/GetHubs")).links
        results.send((seconds, sum(link.bytes_received for link in links)))
        await asyncio.to_thread(results.recv)
        for join in joins:
            await join.close()


def _grow(number: int, results: Connection) -> None:
    logging.getLogger("fibws.hub").setLevel(logging.ERROR)  # Each hub reports that others left.
    results.send(asyncio.run(_growth(number)))


async def _growth(number: int) -> dict[str, float]:
    """Start hubs with topics, then let all join the first one; return what that took."""
    async with AsyncExitStack() as stack:
        gc.collect()
        before = _rss()
        settings = Settings(port=0)
        middle = await stack.enter_async_context(HubServer(settings))
        others = [
            await stack.enter_async_context(HubServer(Settings(port=0, join=(middle.url,))))
            for _ in range(number - 1)
        ]
        hubs = [middle, *others]
        clients = [
            await stack.enter_async_context(fibws.Node(f"node{n}", hub=hub.url, rosout=False))
            for n, hub in enumerate(hubs)
        ]
        await _until(lambda: all(hub.federation.peers for hub in hubs), "links")
        started, cpu = time.perf_counter(), time.process_time()
        for n, client in enumerate(clients):
            for each in range(TOPICS):
                await client.advertise(f"topic_{n}_{each}", String)
        expected = number * TOPICS
        await _until(lambda: all(_topics(hub) >= expected for hub in hubs), "topics")
        seconds, cpu = time.perf_counter() - started, time.process_time() - cpu
        sent = sum(peer.traffic.bytes_sent for hub in hubs for peer in hub.federation.peers)
        return {"memory": _rss() - before, "bytes": sent, "seconds": seconds, "cpu": cpu}


def _topics(hub: HubServer) -> int:
    return sum(name.startswith("/topic_") for name in hub.graph.topics)


def _rss() -> int:
    return memory(os.getpid())["VmRSS"]
