"""Hours of mixed traffic in minutes: the hub's memory stays flat, and nothing is lost silently."""

from __future__ import annotations

import asyncio
import json
import multiprocessing
import random
import time
from collections.abc import AsyncIterator, Callable, Iterator, Sequence
from contextlib import AsyncExitStack, asynccontextmanager
from dataclasses import dataclass, field
from itertools import count, pairwise
from multiprocessing.connection import Connection
from typing import Any

import fibws
from bench.client import Client, frame, operation
from bench.handshake import connected
from bench.machine import memory, on_load_cpu
from bench.measure import HUB, BenchError, Plan
from bench.report import Report
from bench.servers import Server, running
from fibws.msg.sensor_msgs import Image
from fibws.msg.std_msgs import Int32

SECONDS, QUICK_SECONDS = 60.0, 4.0
"""The default durations; --minutes 20 is the real proof."""
SETTLE_SECONDS = 300.0
"""The time that memory may grow without limit; half of the duration if that is less."""
INTERVAL_SECONDS = 10.0
LIMIT_GROWTH_PERCENT = 5.0
NUMBERS_HZ, IMAGES_HZ, CALLS_HZ, GOALS_HZ, VISITORS_HZ = 500.0, 10.0, 50.0, 4.0, 20.0
IMAGE_BYTES = 921_600
STUCK = 3
SLOW_SECONDS = 0.05
"""The pause of the slow reader before each read."""
RECEIVE_BUFFER = 16_384
"""Bytes that the system keeps for the slow reader: it could not answer pings behind many more."""
SETTLES = 10
"""The times that the slow reader reads all there is, at the end."""
QUIET_SECONDS = 3.0
"""Seconds without a message after which a subscriber has got them all."""

processes = multiprocessing.get_context("fork")


def soak(plan: Plan, report: Report) -> None:
    """Run nodes, readers that stand still, and visitors that leave amid everything."""
    default = QUICK_SECONDS if plan.quick else SECONDS
    seconds = default if plan.minutes is None else plan.minutes * 60
    with running(HUB) as server:
        ours, theirs = processes.Pipe()
        traffic = processes.Process(target=_run, args=(server.port, seconds, theirs), daemon=True)
        with on_load_cpu():
            traffic.start()
        samples: list[tuple[float, float]] = []
        report.table(
            f"Mixed traffic for {seconds:g} s",
            ("seconds", "memory of the hub, MB"),
            _samples(server, seconds, samples, report),
        )
        if not ours.poll(120):
            raise BenchError("the traffic does not end")
        totals: Totals = ours.recv()
        traffic.join()
    settled = min(SETTLE_SECONDS, seconds / 2)
    before = max(size for elapsed, size in samples if elapsed <= settled)
    after = max(size for elapsed, size in samples if elapsed > settled)
    growth = 100 * (after / before - 1)
    report.record("soak", seconds=seconds, growth_percent=growth, **vars(totals))
    verdict = report.check(HUB, "growth of memory", growth, LIMIT_GROWTH_PERCENT, " %")
    print(f"\nGrowth after the first {settled:g} s: {growth:.1f} % {verdict}")
    report.table("What was sent, and what arrived", ("", "sent", "arrived", "dropped"), totals.rows)
    for fault in totals.faults:
        report.fault(HUB, "soak", fault)


def _samples(
    server: Server, seconds: float, samples: list[tuple[float, float]], report: Report
) -> Iterator[Sequence[str]]:
    interval = min(INTERVAL_SECONDS, seconds / 10)
    start = time.monotonic()
    while (elapsed := time.monotonic() - start) < seconds:
        time.sleep(min(interval, seconds - elapsed))
        elapsed, size = time.monotonic() - start, memory(server.pid)["VmRSS"] / 1e6
        samples.append((elapsed, size))
        report.record("soak memory", seconds=elapsed, rss_mb=size)
        yield f"{elapsed:.0f}", f"{size:.1f}"


@dataclass
class Totals:
    """The numbers of sent and received messages."""

    rows: list[tuple[str, str, str, str]] = field(default_factory=list)
    faults: list[str] = field(default_factory=list)

    def add(self, what: str, sent: int, arrived: int, dropped: int = 0) -> None:
        """Add a row; each that was sent must have arrived, or be counted as dropped."""
        self.rows.append((what, f"{sent:,}", f"{arrived:,}", f"{dropped:,}"))
        if lost := sent - arrived - dropped:
            self.faults.append(f"{what}: {lost} of {sent} lost and not counted")


def _run(port: int, seconds: float, results: Connection) -> None:
    results.send(asyncio.run(_traffic(port, seconds)))


async def _traffic(port: int, seconds: float) -> Totals:
    """Run everything for some time; return what arrived."""
    totals = Totals()
    hub = f"ws://127.0.0.1:{port}"
    ended = asyncio.Event()
    asyncio.get_running_loop().call_later(seconds, ended.set)
    async with AsyncExitStack() as stack:

        async def node(name: str) -> fibws.Node:
            return await stack.enter_async_context(fibws.Node(name, hub=hub, rosout=False))

        slow = _SlowReader(port)
        await asyncio.gather(
            _topic(await node("numbers"), await node("listener"), ended, totals, slow),
            _images(await node("camera"), await node("viewer"), ended, totals),
            _calls(await node("adder"), await node("caller"), ended, totals),
            _goals(await node("executor"), await node("commander"), ended, totals),
            *(asyncio.to_thread(_subscribe_without_reading, port, n, ended) for n in range(STUCK)),
            asyncio.to_thread(_register_and_drop, port, ended),
        )
    return totals


async def _every(hz: float, ended: asyncio.Event) -> AsyncIterator[int]:
    """Yield numbers at a rate until the end."""
    start = time.monotonic()
    for number in count():
        await asyncio.sleep(max(0.0, start + number / hz - time.monotonic()))
        if ended.is_set():
            return
        yield number


async def _topic(
    node: fibws.Node,
    listener: fibws.Node,
    ended: asyncio.Event,
    totals: Totals,
    slow: _SlowReader,
) -> None:
    """Publish numbers to a node, and to a reader that is too slow."""
    publisher = await node.advertise("numbers", Int32, queue_size=1000, peers=True)
    async with _counted(listener, "numbers", Int32, lambda each: each.data) as numbers:
        reading = asyncio.create_task(asyncio.to_thread(slow.read, ended))
        await _until_subscribed(publisher, {"/listener", "/slow"})
        sent = 0
        async for sent in _every(NUMBERS_HZ, ended):
            await publisher.publish(sent)
        sent += 1
        await _quiet(numbers)
        totals.add("numbers to a node", sent, len(numbers))
        totals.add("numbers to a slow reader", sent, *await reading)


async def _images(
    node: fibws.Node, viewer: fibws.Node, ended: asyncio.Event, totals: Totals
) -> None:
    """Publish images."""
    publisher = await node.advertise("images", Image, queue_size=100, peers=True)
    async with _counted(viewer, "images", Image, lambda each: each.header.seq) as seen:
        await _until_subscribed(publisher, {"/viewer"})
        image, sent = Image(data=bytes(IMAGE_BYTES)), 0
        async for _ in _every(IMAGES_HZ, ended):
            await publisher.publish(image)
            sent += 1
        await _quiet(seen)
        totals.add("images to a node", sent, len(seen))


@asynccontextmanager
async def _counted(
    node: fibws.Node, topic: str, type_: Any, number: Callable[[Any], int]
) -> AsyncIterator[list[int]]:
    """Subscribe to a topic; yield the numbers of the messages, which grow."""
    numbers: list[int] = []

    async def read() -> None:
        async for message in node.subscribe(topic, type_, queue_size=None):
            numbers.append(number(message))

    reader = asyncio.create_task(read())
    try:
        yield numbers
        if any(after != before + 1 for before, after in pairwise(numbers)):
            raise BenchError(f"messages of {topic} are not in order")
    finally:
        reader.cancel()


async def _until_subscribed(publisher: fibws.Publisher[Any, Any], nodes: set[str]) -> None:
    async for names in publisher.peers.changes():
        if nodes <= set(names):
            return


async def _quiet(numbers: list[int]) -> None:
    """Wait until no more messages arrive."""
    before = -1
    while len(numbers) > before:
        before = len(numbers)
        await asyncio.sleep(QUIET_SECONDS)


async def _calls(
    node: fibws.Node, caller: fibws.Node, ended: asyncio.Event, totals: Totals
) -> None:
    """Call a service."""
    await node.service("add", "rospy_tutorials/AddTwoInts", lambda request: request.a + request.b)
    await caller.wait_for_service("add")
    sent = right = 0
    async for sent in _every(CALLS_HZ, ended):
        request = {"a": sent, "b": 1}
        response = await caller.call("add", "rospy_tutorials/AddTwoInts", request)
        right += response.sum == sent + 1
    totals.add("service calls", sent + 1, right)


async def _goals(
    node: fibws.Node, commander: fibws.Node, ended: asyncio.Event, totals: Totals
) -> None:
    """Send goals, every other one over topics."""

    async def execute(goal: Any) -> Any:
        await goal.publish_feedback({"sequence": [0, 1]})
        return {"sequence": [0, 1, 1]}

    clients = []
    types: dict[fibws.Over, str] = {
        "topics": "actionlib_tutorials/Fibonacci",
        "operations": "example_interfaces/Fibonacci",
    }
    for over, type_ in types.items():
        await node.action_server(f"fibonacci_{over}", type_, execute, over=over)
        client = commander.action_client(f"fibonacci_{over}", type_, over=over)
        await client.wait_for_server()
        clients.append(client)
    sent = right = 0
    async for sent in _every(GOALS_HZ, ended):
        goal = await clients[sent % 2].send({"order": 3})
        right += list((await goal.result()).sequence) == [0, 1, 1]
    totals.add("goals", sent + 1, right)


class _SlowReader:
    """A rosbridge client that reads more slowly than the numbers come."""

    def __init__(self, port: int) -> None:
        self._port = port

    def read(self, ended: asyncio.Event) -> tuple[int, int]:
        """Read until the end; return how many messages arrived, and how many the hub dropped."""
        read = 0
        with Client(self._port, "/slow", RECEIVE_BUFFER) as reader:
            reader.send(
                operation("subscribe", topic="/numbers", type="std_msgs/Int32", queue_length=50)
            )
            while not ended.is_set():
                time.sleep(SLOW_SECONDS)
                read += len(reader.read(500))
            for _ in range(SETTLES):  # A pong overtakes messages that the hub keeps.
                read += len(reader.settle())
                time.sleep(QUIET_SECONDS / SETTLES)
            with Client(self._port, "/accountant") as accountant:
                accountant.send(operation("call_service", service="/rosapi/statistics", args={}))
                (answer,) = accountant.receive()
        topics = json.loads(answer)["values"]["topics"]
        (numbers,) = (each for each in topics if each["topic"] == "/numbers")
        (mine,) = (each for each in numbers["subscriptions"] if each["node"] == "/slow")
        return read, mine["dropped"]


def _subscribe_without_reading(port: int, number: int, ended: asyncio.Event) -> None:
    """Subscribe to the images without reading; reconnect when the hub has closed the connection."""
    while not ended.is_set():
        viewer = connected(port, f"/?node=/stuck_{number}")
        with viewer:
            viewer.sendall(operation("subscribe", topic="/images", type="sensor_msgs/Image"))
            for _ in range(random.randint(5, 60)):
                if not ended.is_set():
                    time.sleep(1)


def _register_and_drop(port: int, ended: asyncio.Event) -> None:
    """Connect, register topics and services, and disconnect within a frame, again and again."""
    service, type_ = "rospy_tutorials/AddTwoInts", "std_msgs/String"
    for number in count():
        if ended.is_set():
            return
        topic = f"/visit/t{number}"
        name = f"visits/v{number}"
        definition = f"int32 a\nfloat64[] b\nint32 c{number}\n"
        operations = [
            operation("advertise", topic=topic, type="visit_msgs/New", definition=definition),
            operation("publish", topic=topic, msg={"a": number, "b": [0.5] * 10}),
            operation("advertise", topic=f"{topic}/latched", type=type_, latch=True),
            operation("publish", topic=f"{topic}/latched", msg={"data": "x" * 1000}),
            operation("subscribe", topic="/numbers", type="std_msgs/Int32", throttle_rate=100),
            operation("subscribe", topic="/images", compression="cbor", throttle_rate=1000),
            operation("subscribe", topic="/rosout", type="rosgraph_msgs/Log"),
            operation("advertise_service", service=f"{topic}/add", type=service),
            operation("call_service", service=f"{topic}/add", args={"a": 1, "b": 2}, timeout=1),
            operation(
                "call_service",
                service="/rosapi/set_param",
                args={"name": name, "value": json.dumps("y" * 100)},
            ),
            operation("call_service", service="/rosapi/delete_param", args={"name": name}),
            operation("call_service", service="/rosapi/topics", args={}),
            operation("fragment", id=f"f{number}", num=0, total=2, data="z" * 10_000),
        ]
        with connected(port, f"/?node=/visitor_{number}") as visitor:
            visitor.sendall(b"".join(operations))
            time.sleep(1 / VISITORS_HZ)
            visitor.sendall(frame(b"w" * 1_000_000)[: random.randint(1, 1_000_000)])
