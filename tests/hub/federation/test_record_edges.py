"""Values at the edges, in every field of every record: they cost that record alone."""

from __future__ import annotations

import json
import struct
from collections.abc import Iterator
from typing import Any

import pytest
from conftest import StartHub
from hypothesis import given
from hypothesis import strategies as st
from websockets.asyncio.client import connect

from fibws.hub.errors import FederationError
from fibws.hub.federation import link as links
from fibws.hub.federation import records
from fibws.interfaces import Interfaces

from .conftest import Join, until
from .test_link import HELLO, ID, NODE, bystanders, other_hub, record, request

MISSING: Any = object()
NUMBERS = [0, -1, 2**31 - 1, 2**31, 2**32, 2**63 - 1, 2**63, 2**64 - 1, 2**64, 10**300, 0.5, 1e308]
OTHERS = ["", "x", "/x", "x" * 1025, "x" * 100_000, "/" + "x" * 5000, "\0", "😀", "-1"]
EDGES = [MISSING, None, True, *NUMBERS, *(-number for number in NUMBERS), *OTHERS]
EDGES += [[], [[]], [None], {}, {"x": 1}, [1] * 1000, [{}]]

RECORDS: dict[str, Any] = {
    "nodes": {"path": [HELLO["hub"]], "since": 1, "replaces": ID},
    "topics": {
        "type": "std_msgs/Int32",
        "md5sum": Interfaces().md5("std_msgs/Int32"),
        "publishers": [{"node": "/good", "number": 1, "origin": 1, "latch": True, "queue_size": 1}],
        "subscribers": ["/good"],
    },
    "services": {
        "node": "/good",
        "type": "std_srvs/Empty",
        "md5sum": Interfaces().service_md5("std_srvs/Empty"),
        "since": 1,
        "replaces": ID,
    },
    "actions": {
        "node": "/good",
        "type": "a_msgs/Do",
        "md5sums": ["0" * 32] * 3,
        "since": 1,
        "replaces": ID,
    },
    "parameters": {"stamp": 1, "hub": ID, "value": "1"},
}


def changed(value: Any) -> Iterator[Any]:
    """Yield a record with each of its fields, and itself, replaced by each edge."""
    yield from (edge for edge in EDGES if edge is not MISSING)
    if isinstance(value, dict):
        for key, old in value.items():
            for new in (MISSING, *changed(old)):
                copy = {name: each for name, each in value.items() if name != key}
                yield copy if new is MISSING else {**copy, key: new}
    elif isinstance(value, list):
        for index, old in enumerate(value):
            for new in changed(old):
                yield [*value[:index], new, *value[index + 1 :]]


@pytest.mark.parametrize("kind", RECORDS)
async def test_edges_in_every_field_leave_the_link_and_other_records_alone(
    start_hub: StartHub, join: Join, caplog: pytest.LogCaptureFixture, kind: str
) -> None:
    third = await start_hub(hub_name="third", share_params=("/shared",))
    hub = await join("hub", third, share_params=("/shared",))
    announced = [*changed(RECORDS[kind])]
    assert len(announced) > 100
    async with bystanders(hub), other_hub(hub) as other:
        await other.join()
        for number, bad in enumerate(announced):
            own = {f"/shared/edge{number}": bad, f"/shared/other{number}": None}
            announcement: dict[str, Any] = {"nodes": {"/good": NODE}}
            announcement.setdefault(kind, {}).update(own)
            await other.send(record(links.ANNOUNCE, announcement))
        for name in ("", "edge", "/" + "x" * 5000, "/ö", "//", "/a b"):
            await other.send(record(links.ANNOUNCE, {kind: {name: RECORDS[kind]}}))
        others: list[Any] = [*OTHERS, 1, None, [], {"/n": 1}]
        for wrong in others:
            await other.send(record(links.ANNOUNCE, {kind: wrong}))
        good = {kind: {"/shared/last": RECORDS[kind]}, "nodes": {"/good": NODE, "/final": NODE}}
        await other.send(record(links.ANNOUNCE, good))
        await until(lambda: "/final" in hub.graph.nodes, hub)
        await until(lambda: "/final" in third.graph.nodes, third)  # It takes what it is told, too.
        await until(lambda: is_there(hub, kind), hub)  # Each kind is attached in turns of its own.
        assert len(hub.federation.peers) == 2
        assert "is lost" not in caplog.text


def is_there(hub: Any, kind: str) -> bool:
    """Return whether the last record of a test is there."""
    match kind:
        case "nodes":
            return "/final" in hub.graph.nodes
        case "parameters":
            return bool(hub.graph.parameters.has("/shared/last"))
        case "topics":
            topic = hub.graph.topics.get("/shared/last")
            return topic is not None and "/good" in topic.sources
        case "services":
            return "/shared/last" in hub.graph.services
    return True  # Its definition is asked for.


IDS = [0, 1, 2**31, 2**63 - 1, 2**63, 2**64 - 1]
TIMES = [0, 1, -1, 2**31, 2**63 - 1, -(2**63)]


def binary_records() -> Iterator[bytes]:
    """Yield the records that are not JSON, with each edge in each field."""
    for id_ in IDS:
        for flag in (0, 1, 255):
            yield record(links.INTEREST, struct.pack("<QB", id_, flag))
            for fields in (b"", b"{}", b"[]", b"1", b'{"error":1,"status":[]}'):
                yield record(links.REPLY, struct.pack("<QBI", id_, flag, len(fields)) + fields)
        yield record(links.FLOWING, struct.pack("<Q", id_))
        yield record(links.CANCEL, struct.pack("<Q", id_))
        for size in (0, 1, 2**31, 2**32 - 1):
            yield record(links.REPLY, struct.pack("<QBI", id_, 1, size))
            yield record(links.REQUEST, struct.pack("<QI", id_, size))
        for sequence in IDS:
            for stamp in TIMES:
                yield record(links.MESSAGE, struct.pack("<QQq", id_, sequence, stamp) + bytes(4))
    for time in TIMES:
        yield record(links.PING, struct.pack("<q", time))
        for other in TIMES:
            yield record(links.PONG, struct.pack("<qq", time, other))


def requests() -> Iterator[bytes]:
    """Yield requests with each edge in each field."""
    ops: dict[str, tuple[str, ...]] = {
        "call": ("service", "caller", "md5sum"),
        "goal": ("action", "caller", "type", "goal"),
        "cancel_goal": ("goal",),
        "describe": ("kind", "type"),
        "ping_node": ("node", "caller"),
        "kill_node": ("node", "caller"),
        "older_node": ("node", "closed_at"),
    }
    edges = [edge for edge in EDGES if edge is not MISSING and len(str(edge)) < 10_000]
    number = 10_000
    for op, fields in ops.items():
        for field in fields:
            for edge in edges:
                number += 1
                yield request(number, **{"op": op, field: edge})
    for edge in edges:
        number += 1
        yield request(number, op=edge)


@pytest.mark.parametrize("make", [binary_records, requests])
async def test_edges_in_records_that_are_not_announced_leave_the_link_alone(
    start_hub: StartHub, make: Any
) -> None:
    hub = await start_hub()
    async with bystanders(hub), other_hub(hub) as other:
        await other.join()
        topic = RECORDS["topics"]
        await other.send(
            record(links.ANNOUNCE, {"nodes": {"/good": NODE}, "topics": {"/t": topic}})
        )
        await until(lambda: "/t" in hub.graph.topics, hub)
        for data in make():
            await other.send(data)
        await other.send(record(links.ANNOUNCE, {"nodes": {"/final": NODE}}))
        await until(lambda: "/final" in hub.graph.nodes, hub)


JSON = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=5),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=5), inner),
    max_leaves=10,
)


@given(
    st.dictionaries(
        st.sampled_from([*records.KINDS, "later"]),
        st.dictionaries(
            st.sampled_from(["/a", "/b", "c"]),
            JSON | st.sampled_from([*RECORDS.values()]),
            max_size=3,
        )
        | JSON,
        max_size=4,
    )
)
def test_whatever_is_valid_of_an_announcement_is_taken(value: Any) -> None:
    skipped: list[str] = []
    data = json.dumps(value).encode()
    try:
        found = records.decode_announcement(data, lambda kind, what: skipped.append(what))
    except FederationError as error:
        assert "JSON" in str(error) or "invalid" in str(error)
        return
    for kind in records.KINDS:
        sent = value.get(kind)
        for name, each in sent.items() if isinstance(sent, dict) else ():
            if name.startswith("/") and each == RECORDS[kind]:
                assert found.of(kind)[name] is not None
    assert records.decode_announcement(records.encode_announcement(found)) == found


async def test_page_with_a_huge_queue_size_does_not_part_hubs(
    start_hub: StartHub, join: Join
) -> None:
    cloud = await start_hub(hub_name="cloud")
    robot = await join("robot", cloud)
    async with connect(robot.url) as page:
        for topic, size in (("/x", 2**31), ("/y", 10**100), ("/z", -(10**100))):
            advertise = {"op": "advertise", "topic": topic, "type": "std_msgs/Int32"}
            await page.send(json.dumps({**advertise, "queue_size": size}))
        await until(lambda: {"/x", "/y", "/z"} <= {*cloud.graph.topics}, cloud)
        sizes = [
            source.queue_size
            for topic in ("/x", "/y", "/z")
            for source in cloud.graph.topics[topic].sources.values()
        ]
        assert sizes == [2**31 - 1, 2**31 - 1, 0]
        assert len(robot.federation.peers) == 1
