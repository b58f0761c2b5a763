"""An announcement of many records is taken record by record, whatever brings it."""

from __future__ import annotations

import gc
import json
import struct
import tracemalloc
from collections.abc import Callable, Iterator
from typing import Any
from unittest.mock import Mock

import pytest

from fibws.hub.federation import link as links
from fibws.hub.federation.federation import Federation
from fibws.hub.federation.link import Link
from fibws.hub.federation.names import NameView
from fibws.hub.federation.records import HubInfo
from fibws.hub.log.audit import Audit

from ..fakes import ADD, FIBONACCI, INT32, FakeHub
from ..work_clock import WorkClock
from .test_link import HELLO, ID, NODE, record

FEW, MANY = 50, 1000
MD5_OF_INT32 = "da5909fbe378aeaf85e547e830cc1bb7"
LIMIT = 1.2
"""How many times as much work there may be between two steps if there are twenty times as many
records."""
RECORDS: dict[str, dict[str, Any]] = {
    "nodes": NODE,
    "topics": {"type": INT32, "subscribers": ["/there"]},
    "services": {"node": "/there", "type": ADD, "since": 0},
    "actions": {"node": "/there", "type": FIBONACCI, "since": 0},
    "parameters": {"stamp": 1, "hub": ID, "value": "1"},
}


class World:
    """A hub without sockets, and a link to another one."""

    def __init__(self) -> None:
        self.hub = FakeHub(share_params=("/shared",))
        clock, settings = self.hub.clock, self.hub.settings
        this = HubInfo(id="a" * 16, name="this")
        self.federation = Federation(self.hub.graph, this, clock, settings, Audit(clock.time), {})
        self.link = Link(
            "accept",
            Mock(),
            self.federation,
            this,
            view=NameView(hub="this"),
            node="/other",
            principal=None,
            address="",
            clock=clock,
            now=lambda: 1,
            max_size=settings.max_message_size,
            max_queued=settings.max_queued_bytes,
            max_incoming=settings.max_total_incoming_bytes,
        )
        self.receive(record(links.HELLO, HELLO), record(links.PONG, struct.pack("<qq", 1, 1)))

    def receive(self, *records: bytes) -> None:
        for _ in self.link.receive(b"".join(records)):
            pass


def announcement(kind: str, count: int) -> bytes:
    records = {f"/shared/name_{each}": RECORDS[kind] for each in range(count)}
    return json.dumps({kind: records}).encode()


def longest_step(steps: Iterator[None]) -> tuple[int, int]:
    """Take steps; return how many there are, and the most work in one of them."""
    clock, count = WorkClock(), [0]

    def take() -> None:
        for _ in steps:
            count[0] += 1
            clock()

    gc.collect()
    gc.disable()  # What other tests have left must not be freed meanwhile.
    try:
        clock.measure(take)
    finally:
        gc.enable()
    return count[0], clock.longest


Take = Callable[[World, bytes], Iterator[None]]


def by_link(world: World, data: bytes) -> Iterator[None]:
    return world.link.receive(record(links.ANNOUNCE, data))


@pytest.mark.parametrize("kind", RECORDS)
def test_records_of_a_link_are_taken_one_by_one(kind: str) -> None:
    longest = {}
    for count in (FEW, MANY):
        world = World()
        by = [by_link(world, announcement(kind, each)) for each in (1, count)]
        longest_step(by[0])  # It warms caches.
        steps, longest[count] = longest_step(by[1])
        assert steps >= count
    assert longest[MANY] <= LIMIT * longest[FEW], longest


def test_the_rest_of_an_announcement_is_ignored_once_the_hub_is_lost() -> None:
    world = World()
    steps = by_link(world, announcement("nodes", 3))
    next(steps)
    world.link.closed("it is gone")
    for _ in steps:
        pass
    world.hub.clock.turn()
    assert not world.hub.graph.nodes


Changes = list[tuple[str, int, str | None]]


def shared(changes: Changes) -> bytes:
    """Return what is at ``/shared`` after changes that come one by one."""
    world = World()
    for name, stamp, value in changes:
        change = {"stamp": stamp, "hub": ID, "value": value}
        text = json.dumps({"parameters": {name: change}}).encode()
        world.receive(record(links.ANNOUNCE, text))
    return world.hub.graph.parameters.text("/shared")


def test_value_may_come_after_the_end_of_the_namespace_that_it_replaces() -> None:
    changes: Changes = [
        ("/shared/arm", 1, "1"),
        ("/shared/arm", 2, None),
        ("/shared/arm/length", 2, "2"),
        ("/shared/arm/length", 3, None),
        ("/shared/arm", 3, "3"),
    ]
    assert shared(changes) == b'{"arm":3}'


def test_empty_namespace_may_come_before_the_end_of_what_was_in_it() -> None:
    changes: Changes = [
        ("/shared/arm/length", 1, "1"),
        ("/shared/arm", 2, "{}"),
        ("/shared/arm/length", 2, None),
    ]
    assert shared(changes) == b'{"arm":{}}'


def users(publishers: int, subscribers: int) -> Callable[[int], dict[str, Any]]:
    """Return what makes a topic's record with so many users, by the topic's number."""
    return lambda number: {
        "type": INT32,
        "md5sum": MD5_OF_INT32,
        "publishers": [
            {"node": f"/there{each}", "number": 10 * number + each, "origin": each}
            for each in range(publishers)
        ],
        "subscribers": [f"/there{each}" for each in range(subscribers)],
    }


@pytest.mark.parametrize(
    ("kind", "make"),
    [
        ("nodes", lambda number: NODE),
        ("services", lambda number: RECORDS["services"]),
        *(("topics", users(*each)) for each in ((0, 1), (0, 10), (1, 0), (10, 0), (5, 5))),
    ],
)
def test_memory_of_records_is_what_is_counted(
    kind: str, make: Callable[[int], dict[str, Any]]
) -> None:
    world, count = World(), 60

    def take(records: dict[str, Any]) -> None:
        for _ in by_link(world, json.dumps(records).encode()):
            pass
        while world.hub.clock._soon:  # What is attached for the records.
            world.hub.clock.turn()

    def counted() -> int:
        return sum(each.measure() for each in world.federation.records())

    take({"nodes": {f"/there{each}": NODE for each in range(10)}})
    before = counted()
    gc.collect()
    tracemalloc.start()
    try:
        take({kind: {f"/name/of/thing_{each}": make(each) for each in range(count)}})
        gc.collect()
        measured = tracemalloc.get_traced_memory()[0]
    finally:
        tracemalloc.stop()
    assert 0.75 * measured <= counted() - before <= 2 * measured, (measured, counted() - before)
