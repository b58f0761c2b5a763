"""Hubs whose links go up and down: nothing is doubled or out of order, and memory stays flat."""

from __future__ import annotations

import asyncio
import random
import time
from collections.abc import AsyncIterator, Awaitable, Callable, Sequence
from contextlib import AsyncExitStack, asynccontextmanager, suppress
from dataclasses import dataclass, field
from importlib.util import find_spec
from typing import Any

import fibws
from bench.machine import free_port, memory
from bench.measure import HUB, BenchError, Plan
from bench.report import Report
from bench.servers import Server, running
from bench.soak import LIMIT_GROWTH_PERCENT, SETTLE_SECONDS
from fibws.msg.std_msgs import Int32

SECONDS, QUICK_SECONDS = 60.0, 2.0
HZ = 100.0
"""Messages a second of each publisher; each of three hubs has one."""
UP_SECONDS, DOWN_SECONDS, STALLED_SECONDS = (0.2, 4.0), (0.05, 2.0), (4.5, 6.0)
STALLS = 0.2
"""The share of the faults in which a link stands still until both hubs give it up."""
PATIENCE = 60.0
INTERVAL_SECONDS = 10.0


def soak_hubs(plan: Plan, report: Report) -> None:
    """Cut and stall the links between three hubs, each of which publishes to all of them."""
    default = QUICK_SECONDS if plan.quick else SECONDS
    seconds = default if plan.minutes is None else plan.minutes * 60
    rows = []
    for kind in ("websocket", *(("zenoh",) if find_spec("zenoh") else ())):
        facts = asyncio.run(_soak(kind, seconds, report))
        rows.append(
            (
                *(kind, str(facts.faults), f"{facts.received:,}", f"{facts.gaps:,}"),
                *(f"{facts.counted:,}", str(facts.repeated), f"{facts.growth:.1f} %"),
                report.check(HUB, f"{kind}, memory", facts.growth, LIMIT_GROWTH_PERCENT, " %"),
            )
        )
        report.record("soak hubs", link=kind, seconds=seconds, **vars(facts))
        if facts.repeated:
            text = f"{facts.repeated} messages were doubled or out of order"
            report.fault(HUB, f"soak-hubs, {kind}", text)
        if facts.gaps != facts.counted:
            text = f"{facts.gaps} messages were lost, of which {facts.counted} are counted"
            report.fault(HUB, f"soak-hubs, {kind}", text)
    report.table(
        f"Three hubs whose links go up and down, for {seconds:g} s",
        (
            *("links", "faults", "received", "lost", "counted", "doubled or out of order"),
            *("growth of memory", "limit"),
        ),
        rows,
    )


@dataclass
class Facts:
    """The results.

    Attributes:
        faults: how often a link was cut or stood still.
        gaps: messages that are missing between others.
        counted: those that the hubs have counted as lost.
        repeated: messages that were doubled or out of order.
        growth: percent by which the hubs' memory grew in the second half, or after 5 minutes.
    """

    faults: int = 0
    received: int = 0
    gaps: int = 0
    counted: int = 0
    repeated: int = 0
    growth: float = 0.0


@dataclass
class Cable:
    """A TCP connection between two hubs that can be cut, or stand still."""

    target: int
    port: int = 0
    is_cut: bool = False
    _flows: asyncio.Event = field(default_factory=asyncio.Event)
    _writers: set[asyncio.StreamWriter] = field(default_factory=set)

    @asynccontextmanager
    async def open(self) -> AsyncIterator[Cable]:
        """Listen until the end."""
        self._flows.set()
        server = await asyncio.start_server(self._forward, "127.0.0.1", 0)
        self.port = server.sockets[0].getsockname()[1]
        try:
            yield self
        finally:
            server.close()
            self.cut()

    def cut(self) -> None:
        """End all connections, and accept no more."""
        self.is_cut = True
        for writer in self._writers:
            writer.transport.abort()

    def stall(self) -> None:
        """Forward nothing more."""
        self._flows.clear()

    def mend(self) -> None:
        """Forward again."""
        self.is_cut = False
        self._flows.set()

    async def _forward(self, near: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        if self.is_cut:
            writer.transport.abort()
            return
        far, other = await asyncio.open_connection("127.0.0.1", self.target)
        writers = {writer, other}
        self._writers |= writers
        tasks = [asyncio.create_task(self._copy(*ends)) for ends in ((near, other), (far, writer))]
        await asyncio.wait(tasks, return_when=asyncio.FIRST_COMPLETED)
        self._writers -= writers
        for each in writers:
            each.transport.abort()
        for task in tasks:
            task.cancel()

    async def _copy(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        with suppress(OSError):
            while data := await reader.read(1 << 16):
                await self._flows.wait()
                writer.write(data)
                await writer.drain()


@dataclass
class Reader:
    """Checks the numbers that a node hears from one publisher."""

    received: int = 0
    gaps: int = 0
    repeated: int = 0
    last: int | None = None

    async def read(self, numbers: fibws.Subscription[Int32]) -> None:
        """Take numbers until the end."""
        async for message in numbers:
            number = message.data
            if self.last is not None and number <= self.last:
                self.repeated += 1
                continue
            self.gaps += number - self.last - 1 if self.last is not None else 0
            self.received += 1
            self.last = number


@dataclass
class Writer:
    """Publishes numbers at a rate."""

    publisher: fibws.Publisher[Any, ...]
    last: int = 0

    async def write(self, ended: asyncio.Event) -> None:
        """Publish until the end."""
        start = time.monotonic()
        while not ended.is_set():
            self.last += 1
            await self.publisher.publish(self.last)
            await asyncio.sleep(max(0.0, start + self.last / HZ - time.monotonic()))


async def _soak(kind: str, seconds: float, report: Report) -> Facts:
    facts = Facts()
    async with AsyncExitStack() as stack:
        servers, cables = await _triangle(kind, stack)
        nodes = [
            await stack.enter_async_context(
                fibws.Node(f"node{n}", hub=f"ws://127.0.0.1:{server.port}", rosout=False)
            )
            for n, server in enumerate(servers)
        ]
        writers = [
            Writer(await node.advertise(f"numbers{n}", Int32, queue_size=1000))
            for n, node in enumerate(nodes)
        ]
        readers: list[tuple[Reader, Writer]] = []
        tasks = []
        for node in nodes:
            for n, writer in enumerate(writers):
                reader = Reader()
                numbers = node.subscribe(f"numbers{n}", Int32, queue_size=None)
                tasks.append(asyncio.create_task(reader.read(numbers)))
                readers.append((reader, writer))
        ended, whole = asyncio.Event(), asyncio.Event()
        writing = [asyncio.create_task(writer.write(ended)) for writer in writers]
        await _all_hear(readers)
        breaking = asyncio.create_task(_break(cables, facts, whole))
        facts.growth = await _growth(kind, servers, seconds, report)
        whole.set()
        await breaking
        await _until(lambda: _have_links(nodes), "links")
        await _all_hear(readers)
        ended.set()
        await asyncio.gather(*writing)
        await _until(lambda: _is(all(r.last == w.last for r, w in readers)), "last numbers")
        for task in tasks:
            task.cancel()
        for reader, _ in readers:
            facts.received += reader.received
            facts.gaps += reader.gaps
            facts.repeated += reader.repeated
        for links in [await _links(node) for node in nodes]:
            facts.counted += sum(link.lost for link in links)
    return facts


async def _triangle(kind: str, stack: AsyncExitStack) -> tuple[list[Server], list[Cable]]:
    """Start three hubs, each of which joins those before it by cables."""
    servers: list[Server] = []
    ends: list[int] = []
    cables: list[Cable] = []
    for n in range(3):
        options = ["--hub-name", f"hub{n}"]
        if kind == "zenoh":
            ends.append(free_port())
            options += ["--zenoh-listen", f"tcp/127.0.0.1:{ends[n]}"]
        for end in ends[:n]:
            cable = await stack.enter_async_context(Cable(end).open())
            cables.append(cable)
            if kind == "zenoh":
                options += ["--zenoh", f"tcp/127.0.0.1:{cable.port}"]
            else:
                options += ["--join", f"ws://127.0.0.1:{cable.port}"]
        starting = running(HUB, pinned=False, options=options)
        # Its handshakes block, so that the cables need another thread meanwhile.
        server = await asyncio.to_thread(starting.__enter__)
        stack.push_async_exit(_left(starting))
        servers.append(server)
        if kind != "zenoh":
            ends.append(server.port)
    return servers, cables


def _left(starting: Any) -> Callable[..., Awaitable[None]]:
    async def leave(*error: Any) -> None:
        await asyncio.to_thread(starting.__exit__, *error)

    return leave


async def _break(cables: Sequence[Cable], facts: Facts, whole: asyncio.Event) -> None:
    """Cut a link or let it stand still, again and again; in the end all are whole."""
    chance = random.Random(16)
    while not whole.is_set():
        cable = chance.choice(cables)
        is_stall = chance.random() < STALLS
        (cable.stall if is_stall else cable.cut)()
        facts.faults += 1
        await _wait(whole, chance.uniform(*(STALLED_SECONDS if is_stall else DOWN_SECONDS)))
        cable.mend()
        await _wait(whole, chance.uniform(*UP_SECONDS))


async def _wait(event: asyncio.Event, seconds: float) -> None:
    with suppress(TimeoutError):
        await asyncio.wait_for(event.wait(), seconds)


async def _growth(kind: str, servers: Sequence[Server], seconds: float, report: Report) -> float:
    """Return by how many percent the memory of all hubs has grown after a time to settle."""
    start, settled = time.monotonic(), min(SETTLE_SECONDS, seconds / 2)
    before = after = 0.0
    while (elapsed := time.monotonic() - start) < seconds:
        await asyncio.sleep(min(INTERVAL_SECONDS, seconds / 10))
        size = sum(memory(server.pid)["VmRSS"] for server in servers) / 1e6
        report.record("soak hubs memory", link=kind, seconds=elapsed, rss_mb=size)
        if elapsed <= settled:
            before = max(before, size)
        else:
            after = max(after, size)
    return 100 * (after / before - 1)


async def _all_hear(readers: Sequence[tuple[Reader, Writer]]) -> None:
    """Wait until each reader has heard a number that was not published yet."""
    due = [(reader, writer.last + 1) for reader, writer in readers]
    await _until(
        lambda: _is(all(reader.last is not None and reader.last >= n for reader, n in due)),
        "numbers",
    )


async def _links(node: fibws.Node) -> list[Any]:
    response = await node.call("/rosapi/hubs", "fibws_msgs/GetHubs")
    return [link for link in response.links if not link.fault]


async def _have_links(nodes: Sequence[fibws.Node]) -> bool:
    return all([len(await _links(node)) == len(nodes) - 1 for node in nodes])


async def _is(condition: bool) -> bool:
    return condition


async def _until(condition: Callable[[], Awaitable[bool]], what: str) -> None:
    deadline = time.monotonic() + PATIENCE
    while not await condition():
        if time.monotonic() > deadline:
            raise BenchError(f"{what} have not come")
        await asyncio.sleep(0.01)
