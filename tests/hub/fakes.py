"""A hub without sockets and without a real clock: operations go in, frames come out."""

from __future__ import annotations

import json
from collections import deque
from collections.abc import Callable, Iterator, Sized
from heapq import heappop, heappush
from itertools import count
from typing import Any

import cbor2

from fibws.access.rights import Principal
from fibws.hub.delivery.clock import Workers
from fibws.hub.delivery.deflate import Deflater, DeflatingSendQueue
from fibws.hub.delivery.send_queue import Bytes, Flusher, Frame, LargeFrame, SendQueue
from fibws.hub.graph.graph import Graph
from fibws.hub.graph.policy import Policy
from fibws.hub.rosbridge.session import Rosbridge, RosbridgeSession
from fibws.hub.settings import Settings
from fibws.hub.websocket.endpoint import Opening, Work
from fibws.interfaces import Interfaces
from fibws.protocol.websocket import CloseReason

STANDARD = Interfaces()
"""The standard types, parsed once for all tests."""

NANOSECONDS = 1_700_000_000_000_000_005
"""The time at which the hub receives all messages."""

INT32 = "std_msgs/Int32"
STRING = "std_msgs/String"
ADD = "rospy_tutorials/AddTwoInts"
FIBONACCI = "example_interfaces/Fibonacci"

TEXT, BINARY = 0x81, 0x82
"""The first bytes of frames that hold a whole message."""


class FakeTimer:
    """One of the clock's timers."""

    def __init__(self, callback: Callable[[], Any]) -> None:
        self.callback = callback
        self.cancelled = False

    def cancel(self) -> None:
        self.cancelled = True
        self.callback = lambda: None  # As asyncio's, it keeps nothing.


class FakeClock:
    """A clock and an event loop's turns, advanced by the test."""

    def __init__(self) -> None:
        self.late = 0.0
        """Seconds by which timers are late."""
        self._now = 0.0
        self._timers: list[tuple[float, int, FakeTimer]] = []
        self._number = count()
        self._soon: list[Callable[[], Any]] = []

    def time(self) -> float:
        return self._now

    def call_later(self, delay: float, callback: Callable[[], Any], /) -> FakeTimer:
        timer = FakeTimer(callback)
        heappush(self._timers, (self._now + delay, next(self._number), timer))
        return timer

    def call_soon(self, callback: Callable[[], Any]) -> None:
        self._soon.append(callback)

    def advance_to(self, moment: float) -> None:
        """Advance the clock and call the timers that are due."""
        while self._timers and self._timers[0][0] + self.late <= moment:
            due, _, timer = heappop(self._timers)
            self._now = max(self._now, due + self.late)
            if not timer.cancelled:
                timer.callback()
        self._now = moment

    def advance(self, seconds: float) -> None:
        self.advance_to(self._now + seconds)

    def turn(self) -> None:
        """End the loop's turn."""
        due, self._soon = self._soon, []
        for callback in due:
            callback()

    @property
    def timers(self) -> int:
        """The number of pending timers."""
        return sum(not timer.cancelled for _, _, timer in self._timers)


class InlineWorkers:
    """`Workers` that work at once."""

    def __init__(self) -> None:
        self._jobs: deque[tuple[Callable[[], object], Callable[[], object]]] = deque()
        self._is_busy = False

    def run(self, work: Callable[[], object], done: Callable[[], object], /) -> None:
        """Call ``work`` and then ``done``; if within another job, behind that."""
        self._jobs.append((work, done))
        if not self._is_busy:
            self._is_busy = True
            while self._jobs:
                for each in self._jobs.popleft():
                    each()
            self._is_busy = False


class FakeWorkers:
    """Threads that work when the test calls them."""

    def __init__(self) -> None:
        self.jobs: deque[tuple[Callable[[], object], Callable[[], object]]] = deque()

    def run(self, work: Callable[[], object], done: Callable[[], object], /) -> None:
        self.jobs.append((work, done))

    def finish(self) -> None:
        """Finish the first job."""
        for each in self.jobs.popleft():
            each()

    def finish_all(self) -> None:
        while self.jobs:
            self.finish()


def frames(data: Frame) -> Iterator[tuple[int, bytes]]:
    """Split unmasked WebSocket frames, each a whole message, into first bytes and payloads."""
    if isinstance(data, LargeFrame):
        data = b"".join((data.head, data.body))
    while data:
        start, size = 2, data[1]
        if size == 126:
            start, size = 4, int.from_bytes(data[2:4])
        elif size == 127:
            start, size = 10, int.from_bytes(data[2:10])
        assert len(data) >= start + size
        yield data[0], data[start : start + size]
        data = data[start + size :]


def payloads(data: bytes) -> Iterator[bytes]:
    """Return the texts in some frames, each a whole text."""
    for first, payload in frames(data):
        assert first == TEXT
        yield payload


def finish(work: Work | None) -> None:
    """Do what is left of a message."""
    for _ in work or ():
        pass


class FakeHub:
    """A graph, and clients that have no sockets."""

    def __init__(
        self,
        *,
        policy: Policy | None = None,
        clock: FakeClock | None = None,
        interfaces: Interfaces = STANDARD,
        workers: Workers | None = None,
        **settings: Any,
    ) -> None:
        self.settings = Settings(**settings)
        self.clock = clock or FakeClock()
        self.flusher = Flusher(self.clock.call_soon)
        self.graph = Graph(
            interfaces,
            lambda: NANOSECONDS,
            strict_types=self.settings.strict_types,
            policy=policy,
        )
        workers = workers or InlineWorkers()
        self.deflater = Deflater(workers, self.clock.time)
        self.rosbridge = Rosbridge(self.graph, self.clock, self.settings, workers, self.deflater)

    def client(
        self,
        node: str | None = None,
        *,
        serialized: bool = False,
        principal: Principal | None = None,
        is_page: bool = False,
        deflate: int = 0,
    ) -> Client:
        """Return a new client; one that is ``serialized`` speaks ``fibws.v1``.

        Args:
            deflate: the size of its window, if it has negotiated compression.
        """
        return Client(
            self,
            node,
            serialized=serialized,
            principal=principal,
            is_page=is_page,
            deflate=deflate,
        )

    @property
    def empty(self) -> bool:
        """Whether the graph is empty."""
        graph = self.graph
        is_empty = not (graph.nodes or graph.topics or graph.services or graph.actions)
        return is_empty and not (self.rosbridge.groups or self.rosbridge.servers)


class Client:
    """A client of the hub: sends operations, and receives operations."""

    def __init__(
        self,
        hub: FakeHub,
        node: str | None,
        *,
        serialized: bool,
        principal: Principal | None,
        is_page: bool,
        deflate: int = 0,
    ) -> None:
        self.writes: list[Bytes] = []
        self.closings: list[CloseReason] = []
        most = hub.settings.max_queued_bytes
        write = self.writes.append
        self.queue = (
            DeflatingSendQueue(
                write, self.fail, hub.flusher, hub.deflater, max_bytes=most, bits=deflate
            )
            if deflate
            else SendQueue(write, self.fail, hub.flusher, max_bytes=most)
        )
        self._hub = hub
        session = hub.rosbridge.open(
            Opening(node, self.queue, self._close, principal, is_page=is_page),
            serialized=serialized,
        )
        assert isinstance(session, RosbridgeSession)
        self.session = session

    def send(self, op: str, topic: str | None = None, **fields: Any) -> None:
        """Send an operation."""
        self.send_text(json.dumps({"op": op, "topic": topic, **fields}))

    def send_text(self, text: str) -> None:
        finish(self.session.receive_text(text.encode()))

    def send_binary(self, data: bytes) -> None:
        finish(self.session.receive_binary(data))

    def receive_frames(self) -> list[tuple[int, bytes]]:
        """Return the frames that came since the last call, at the end of the loop's turn."""
        self._hub.clock.turn()
        received = list(frames(b"".join(self.writes)))
        self.writes.clear()
        return received

    def receive(self) -> list[dict[str, Any]]:
        """Return the operations that came; all are JSON text."""
        received = self.receive_frames()
        assert {first for first, _ in received} <= {TEXT}
        return [json.loads(payload) for _, payload in received]

    def receive_one(self, op: str) -> dict[str, Any]:
        """Return the one operation that came."""
        [received] = self.receive()
        assert received["op"] == op, received
        return received

    def receive_cbor(self) -> list[dict[str, Any]]:
        """Return the operations that came; all are CBOR."""
        received = self.receive_frames()
        assert {first for first, _ in received} <= {BINARY}
        return [cbor2.loads(payload) for _, payload in received]

    def receive_messages(self, topic: str) -> list[dict[str, Any]]:
        """Return the messages of one topic, in this spelling; nothing else may have come."""
        received = self.receive()
        assert all((each["op"], each["topic"]) == ("publish", topic) for each in received), received
        return [each["msg"] for each in received]

    def receive_numbers(self, topic: str) -> list[int]:
        """Return the ``data`` of a topic's messages; nothing else may have come."""
        return [msg["data"] for msg in self.receive_messages(topic)]

    def receive_statuses(self, level: str = "error") -> list[str]:
        """Return the texts of the statuses that came, all of one level; nothing else may have."""
        received = self.receive()
        assert all((each["op"], each["level"]) == ("status", level) for each in received), received
        return [each["msg"] for each in received]

    def fail(self) -> None:
        raise AssertionError("a write failed")

    def _close(self, reason: CloseReason) -> None:
        self.closings.append(reason)
        self.disconnect()

    def disconnect(self) -> None:
        finish(self.session.leave())

    @property
    def kept(self) -> dict[str, Sized]:
        """The hub's state of the client, by kind."""
        session = self.session
        quota = session.topics._latch_quota
        return {
            "sources": session.topics.sources,
            "spellings of sources": session.topics._spellings,
            "numbered sources": session.topics._numbered,
            "advertisements": session.topics._advertisements,
            "wills": session.topics._wills or (),
            "subscriptions": session.topics.subscriptions,
            "latched bytes": range(quota.used if quota else 0),
            "services": session.services._served,
            "calls to answer": session.services._calls,
            "calls to answer by service": session.services._calls_of,
            "calls": session.calls._waiting,
            "actions": session.actions._served,
            "goals to execute": session.actions._goals,
            "goals to execute by action": session.actions._goals_of,
            "goals": session.goals._sent,
            "ids of goals": session.goals._by_id,
        }

    @property
    def forgotten(self) -> bool:
        """Whether the hub has no state of the client."""
        return not any(self.kept.values())


def number(data: int) -> dict[str, int]:
    return {"data": data}


def talker_and_listener(hub: FakeHub, **advertise: Any) -> tuple[Client, Client]:
    """Return a client that publishes /fib, and one that subscribes to it."""
    talker, listener = hub.client("/talker"), hub.client("/listener")
    talker.send("advertise", "/fib", type=INT32, **advertise)
    listener.send("subscribe", "/fib")
    return talker, listener


def fragment(client: Client, data: str, num: int, total: int, id_: object = "f") -> None:
    client.send("fragment", data=data, num=num, total=total, id=id_)
