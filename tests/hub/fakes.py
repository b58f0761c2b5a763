"""A hub without sockets and without time: what is said goes in, what is heard comes out."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator, Sized
from heapq import heappop, heappush
from itertools import count
from typing import Any

import cbor2

from fibws.hub.graph.graph import Graph
from fibws.hub.outbox import Flusher, Outbox
from fibws.hub.session.session import Session
from fibws.hub.settings import Settings
from fibws.interfaces import Interfaces
from fibws.protocol.closing import Closing

NANOSECONDS = 1_700_000_000_000_000_005
"""When the tests take place."""

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


class FakeClock:
    """A clock whose time passes when the test says so; it has an event loop's turns as well."""

    def __init__(self) -> None:
        self.late = 0.0
        """By how much timers go off too late."""
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
        """Let time pass, and what is due happen when it is due."""
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
        """How many timers are to go off."""
        return sum(not timer.cancelled for _, _, timer in self._timers)


def frames(data: bytes) -> Iterator[tuple[int, bytes]]:
    """The first bytes and payloads of a row of unmasked WebSocket frames, each a whole message."""
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
    """What is in a row of frames, each a whole text."""
    for first, payload in frames(data):
        assert first == TEXT
        yield payload


class FakeHub:
    """A graph, and clients that have no sockets."""

    def __init__(self, **settings: Any) -> None:
        self.settings = Settings(**settings)
        self.clock = FakeClock()
        self.flusher = Flusher(self.clock.call_soon)
        self.graph = Graph(
            Interfaces(), lambda: NANOSECONDS, strict_types=self.settings.strict_types
        )

    def client(self, node: str | None = None) -> Client:
        return Client(self, node)

    @property
    def empty(self) -> bool:
        """Whether nothing is left in the graph."""
        graph = self.graph
        return not (graph.nodes or graph.topics or graph.services or graph.actions)


class Client:
    """A client of the hub: says operations, hears operations."""

    def __init__(self, hub: FakeHub, node: str | None) -> None:
        self.writes: list[bytes] = []
        self.closings: list[Closing] = []
        self.outbox = Outbox(
            self.writes.append, self.fail, hub.flusher, max_bytes=hub.settings.max_queued_bytes
        )
        self._hub = hub
        self.session = Session(
            node, hub.graph, self.outbox, hub.clock, hub.settings, self.closings.append
        )

    def says(self, op: str, topic: str | None = None, **fields: Any) -> None:
        """Send an operation."""
        self.says_text(json.dumps({"op": op, "topic": topic, **fields}))

    def says_text(self, text: str) -> None:
        self.session.receive(text.encode())

    def says_binary(self, data: bytes) -> None:
        self.session.receive_binary(data)

    def hears_frames(self) -> list[tuple[int, bytes]]:
        """What has come since this was last asked, at the end of the loop's turn."""
        self._hub.clock.turn()
        heard = [frame for data in self.writes for frame in frames(data)]
        self.writes.clear()
        return heard

    def hears(self) -> list[dict[str, Any]]:
        """The operations that have come; all are JSON text."""
        heard = self.hears_frames()
        assert {first for first, _ in heard} <= {TEXT}
        return [json.loads(payload) for _, payload in heard]

    def hears_one(self, op: str) -> dict[str, Any]:
        """The one operation that has come."""
        [heard] = self.hears()
        assert heard["op"] == op, heard
        return heard

    def hears_cbor(self) -> list[dict[str, Any]]:
        """The operations that have come; all are CBOR."""
        heard = self.hears_frames()
        assert {first for first, _ in heard} <= {BINARY}
        return [cbor2.loads(payload) for _, payload in heard]

    def hears_messages(self, topic: str) -> list[dict[str, Any]]:
        """The messages of one topic, spelled so; nothing else may have come."""
        heard = self.hears()
        assert all((each["op"], each["topic"]) == ("publish", topic) for each in heard), heard
        return [each["msg"] for each in heard]

    def hears_numbers(self, topic: str) -> list[int]:
        """What is in a topic's ``data``; nothing else may have come."""
        return [msg["data"] for msg in self.hears_messages(topic)]

    def hears_statuses(self, level: str = "error") -> list[str]:
        """The texts of the statuses that have come, all of one level; nothing else may have."""
        heard = self.hears()
        assert all((each["op"], each["level"]) == ("status", level) for each in heard), heard
        return [each["msg"] for each in heard]

    def fail(self) -> None:
        raise AssertionError("nothing breaks here")

    def leaves(self) -> None:
        self.session.leave()

    @property
    def kept(self) -> dict[str, Sized]:
        """What the hub keeps for the client, by what it is."""
        session = self.session
        return {
            "publishers": session.topics.publishers,
            "subscriptions": session.topics.subscriptions,
            "latched bytes": range(session.topics._latches.used if session.topics._latches else 0),
            "services": session.services._provided,
            "calls to answer": session.services._due,
            "calls": session.calls._calls,
            "actions": session.actions._served,
            "goals to pursue": session.actions._pursued,
            "goals": session.goals._sent,
            "ids of goals": session.goals._by_id,
        }

    @property
    def forgotten(self) -> bool:
        """Whether the hub keeps nothing for the client."""
        return not any(self.kept.values())


def number(data: int) -> dict[str, int]:
    return {"data": data}


def talker_and_listener(hub: FakeHub, **advertise: Any) -> tuple[Client, Client]:
    """Two clients, of which one publishes /fib and the other hears it."""
    talker, listener = hub.client("/talker"), hub.client("/listener")
    talker.says("advertise", "/fib", type=INT32, **advertise)
    listener.says("subscribe", "/fib")
    return talker, listener


def fragment(client: Client, data: str, num: int, total: int, id_: object = "f") -> None:
    client.says("fragment", data=data, num=num, total=total, id=id_)
