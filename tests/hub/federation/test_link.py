"""Links to faulty or hostile hubs: they are closed with a reason, and nothing else suffers."""

from __future__ import annotations

import asyncio
import json
import random
import struct
from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager, suppress
from typing import Any

import pytest
from conftest import StartHub
from patience import PATIENCE
from random_inputs import times
from websockets.asyncio.client import ClientConnection, connect
from websockets.exceptions import ConnectionClosed
from websockets.typing import Subprotocol

import fibws
from fibws.hub.federation import link as links
from fibws.hub.server import HubServer
from fibws.hub.settings import MIB
from fibws.interfaces import Interfaces
from fibws.msg.std_msgs import Int32

from .conftest import until

ID = "0123456789abcdef"
HELLO = {"hub": {"id": ID, "name": "other", "version": "1"}}
PATH = [HELLO["hub"]]


def record(kind: int, body: bytes | str | dict[str, Any] = b"") -> bytes:
    """Return one record."""
    if isinstance(body, dict):
        body = json.dumps(body)
    data = body.encode() if isinstance(body, str) else body
    return struct.pack("<IB", len(data) + 1, kind) + data


def part(lane: int, data: bytes, *, is_last: bool = False) -> bytes:
    return record(links.PART, struct.pack("<QB", lane, is_last) + data)


def request(id_: int, body: bytes = b"", **fields: Any) -> bytes:
    text = json.dumps(fields).encode()
    return record(links.REQUEST, struct.pack("<QI", id_, len(text)) + text + body)


class OtherHub:
    """The other end of a link, which sends whatever a test wants."""

    def __init__(self, websocket: ClientConnection) -> None:
        self.websocket = websocket

    async def send(self, *records: bytes) -> None:
        await self.websocket.send(b"".join(records))

    async def join(self, hello: dict[str, Any] = HELLO) -> None:
        """Send a hello and answer a ping."""
        await self.send(record(links.HELLO, hello))
        async for kind, body in self.records():
            if kind == links.PING:
                await self.send(record(links.PONG, body + body))
                return

    async def records(self) -> AsyncIterator[tuple[int, bytes]]:
        """Yield the records that arrive until the link is closed."""
        with suppress(ConnectionClosed):
            while True:
                data, at = await self.websocket.recv(decode=False), 0
                while at < len(data):
                    size, kind = struct.unpack_from("<IB", data, at)
                    yield kind, data[at + 5 : at + 4 + size]
                    at += 4 + size

    async def reason(self) -> str:
        """Wait until the hub has closed the link; return its reason."""
        async with asyncio.timeout(PATIENCE):
            async for _ in self.records():
                pass
        assert self.websocket.close_code not in (None, 1006, 1011)
        return self.websocket.close_reason or ""


@asynccontextmanager
async def other_hub(hub: HubServer) -> AsyncIterator[OtherHub]:
    protocol = Subprotocol(links.SUBPROTOCOL)
    # Tests that send much do not read the answers: the last of them is the close frame.
    async with connect(
        hub.url, subprotocols=[protocol], compression=None, max_queue=None
    ) as websocket:
        yield OtherHub(websocket)


@asynccontextmanager
async def bystanders(hub: HubServer) -> AsyncIterator[Callable[[], Any]]:
    """Two nodes of a hub; yields a function that fails if a message between them is lost."""
    async with fibws.Node("one", hub=hub.url) as one, fibws.Node("two", hub=hub.url) as two:
        numbers = two.subscribe("numbers", Int32)
        await two.flush()
        publisher = await one.advertise("numbers", Int32)
        sent = 0

        async def exchange() -> None:
            nonlocal sent
            sent += 1
            await publisher.publish(data=sent)
            async with asyncio.timeout(PATIENCE):
                assert (await anext(numbers)).data == sent

        await exchange()
        yield exchange
        await exchange()


NODE = {"path": PATH, "since": 1}
TOPIC = {"type": "std_msgs/Int32", "publishers": [{"node": "/n", "number": 1, "origin": 1}]}

BROKEN = {
    "cut off": (b"\x01\x02", "cut off"),
    "size of nothing": (struct.pack("<IB", 0, links.PING), "size 0"),
    "size beyond the message": (struct.pack("<IB", 2**32 - 1, links.PING), "not all is there"),
    "part without bytes": (part(1, b""), "part without bytes"),
    "short part": (record(links.PART, b"123"), "part without bytes"),
    "part of a part": (part(1, part(1, b"x"), is_last=True), "part of parts"),
    "short record in parts": (part(1, b"\x01", is_last=True), "cut off"),
    "many records at once": (record(99) * (links.MOST_AT_ONCE + 1), str(links.MOST_AT_ONCE)),
}


@pytest.mark.parametrize(("data", "fault"), BROKEN.values(), ids=BROKEN)
async def test_broken_framing_closes_the_link_with_the_reason(
    start_hub: StartHub, data: bytes, fault: str
) -> None:
    hub = await start_hub()
    async with bystanders(hub), other_hub(hub) as other:
        await other.join()
        await other.send(data)
        assert fault in await other.reason()
        await until(lambda: not hub.federation.peers, hub)


INVALID = {
    "short ping": (record(links.PING, b"123"), "kind 8"),
    "short pong": (record(links.PONG, b"123"), "kind 9"),
    "short interest": (record(links.INTEREST, b"123"), "kind 2"),
    "short flowing": (record(links.FLOWING, b"123"), "kind 3"),
    "short message": (record(links.MESSAGE, b"123"), "kind 4"),
    "short request": (record(links.REQUEST, b"1"), "kind 5"),
    "short reply": (record(links.REPLY, b"1"), "kind 6"),
    "short cancel": (record(links.CANCEL, b"1"), "kind 7"),
    "announcement of no JSON": (record(links.ANNOUNCE, "{"), "announcement"),
    "announcement of a list": (record(links.ANNOUNCE, "[]"), "announcement"),
    "announcement that is nested deeply": (record(links.ANNOUNCE, "[" * 100_000), "announcement"),
    "announcement of faults": (
        record(links.ANNOUNCE, {"nodes": {f"/n{number}": 1 for number in range(2000)}}),
        "invalid record",
    ),
    "large announcement": (
        record(links.ANNOUNCE, " " * (links.MOST_ANNOUNCED + 1)),
        str(links.MOST_ANNOUNCED),
    ),
    "record of a later version": (record(99, b"?"), ""),
    "request without JSON": (record(links.REQUEST, struct.pack("<QI", 1, 1) + b"{"), "fields"),
    "large fields": (request(1, op="x" * (links.MOST_FIELDS + 1)), str(links.MOST_FIELDS)),
}
GOOD = record(links.ANNOUNCE, {"nodes": {"/good": NODE}})


@pytest.mark.parametrize(("data", "fault"), INVALID.values(), ids=INVALID)
async def test_invalid_record_is_left_out_and_logged_once(
    start_hub: StartHub, caplog: pytest.LogCaptureFixture, data: bytes, fault: str
) -> None:
    hub = await start_hub()
    async with bystanders(hub), other_hub(hub) as other:
        await other.join()
        await other.send(data, GOOD)
        await other.send(data)
        await other.send(record(links.ANNOUNCE, {"nodes": {"/last": NODE}}))
        await until(lambda: {"/good", "/last"} <= {*hub.graph.nodes}, hub)
        logged = [each.message for each in caplog.records if each.levelname == "WARNING"]
        assert len(logged) == len({*logged})
        assert bool(logged) == bool(fault)
        assert all(fault in each and "other" in each for each in logged)


async def test_request_that_cannot_be_read_is_answered_with_an_error(start_hub: StartHub) -> None:
    hub = await start_hub(max_message_size=100_000)
    large = request(3, bytes(200_000), op="call")
    async with other_hub(hub) as other:
        await other.join()
        await other.send(record(links.REQUEST, struct.pack("<QI", 1, 1) + b"{"))
        await other.send(request(2, op="x" * (links.MOST_FIELDS + 1)))
        for at in range(0, len(large), 50_000):
            await other.send(part(1, large[at : at + 50_000], is_last=at + 50_000 >= len(large)))
        codes: dict[int, str] = {}
        async with asyncio.timeout(PATIENCE):
            async for kind, body in other.records():
                if kind == links.REPLY:
                    id_, is_final, size = struct.unpack_from("<QBI", body)
                    assert is_final
                    codes[id_] = json.loads(body[13 : 13 + size])["code"]
                    if len(codes) == 3:
                        break
        assert codes == {1: "invalid_operation", 2: "invalid_operation", 3: "limit"}


async def test_message_that_is_too_large_is_left_out(
    start_hub: StartHub, caplog: pytest.LogCaptureFixture
) -> None:
    hub = await start_hub(max_message_size=100_000)
    large = record(links.MESSAGE, struct.pack("<QQq", 1, 1, 1) + bytes(300_000))
    async with bystanders(hub), other_hub(hub) as other:
        await other.join()
        for at in range(0, len(large), 50_000):
            await other.send(part(1, large[at : at + 50_000], is_last=at + 50_000 >= len(large)))
        await other.send(part(1, GOOD, is_last=True))
        await until(lambda: "/good" in hub.graph.nodes, hub)
        (endpoint,) = hub.federation.backplanes
        assert isinstance(endpoint, links.Link)
        assert endpoint.incomplete_bytes == 0
    assert "100000 bytes (--max-message-size)" in caplog.text


@pytest.mark.parametrize(
    ("data", "fault"),
    [
        (record(links.PING, b"12345678"), "hello"),
        (record(links.HELLO, "{}"), "hub"),
        (record(links.HELLO, {"hub": {"id": "x", "name": "other"}}), "id"),
        (record(links.HELLO, {**HELLO, "prefix": "robot"}), "prefix"),
        (record(links.HELLO, {**HELLO, "prefix": "/röbot"}), "prefix"),
    ],
)
async def test_invalid_hello_closes_the_link_with_the_reason(
    start_hub: StartHub, data: bytes, fault: str
) -> None:
    hub = await start_hub()
    async with bystanders(hub), other_hub(hub) as other:
        await other.send(data)
        assert fault in await other.reason()
        assert not hub.federation.peers


async def test_text_closes_the_link(start_hub: StartHub) -> None:
    hub = await start_hub()
    async with bystanders(hub), other_hub(hub) as other:
        await other.websocket.send("hello")
        assert "binary" in await other.reason()


async def test_unfinished_records_in_parts_are_bounded(start_hub: StartHub) -> None:
    hub = await start_hub(max_total_incoming_bytes=100_000)
    async with bystanders(hub), other_hub(hub) as other:
        await other.join()
        with suppress(ConnectionClosed):
            for lane in range(2_000):
                await other.send(part(lane, b"x"))
        assert "in part" in await other.reason()


async def test_requests_of_a_hub_that_never_reads_are_bounded(start_hub: StartHub) -> None:
    hub = await start_hub(max_queued_bytes=100_000)
    asked = request(1, op="describe", kind="msg", type="sensor_msgs/PointCloud2")
    async with bystanders(hub), other_hub(hub) as other:
        await other.join()
        other.websocket.transport.pause_reading()
        closed = asyncio.ensure_future(until(lambda: not hub.federation.peers, hub))
        with suppress(ConnectionClosed):
            while not closed.done():
                await other.send(*[asked] * 100)
        await closed
        other.websocket.transport.abort()


async def test_only_the_newest_ping_is_answered(start_hub: StartHub) -> None:
    hub = await start_hub()
    count = 2000
    async with bystanders(hub), other_hub(hub) as other:
        await other.join()
        await other.send(*(record(links.PING, struct.pack("<q", each)) for each in range(count)))
        answered = []
        async with asyncio.timeout(PATIENCE):
            async for kind, body in other.records():
                if kind == links.PONG:
                    answered.append(struct.unpack_from("<q", body)[0])
                    if answered[-1] == count - 1:
                        break
        assert len(answered) < count / 2


async def test_names_that_a_hub_may_not_use_are_ignored(start_hub: StartHub) -> None:
    hub = await start_hub()
    nodes = {"/rosapi": NODE, "/a b": NODE, "//": NODE, "/own": {**NODE, "path": [*PATH, *PATH]}}
    own = {"id": hub.federation.hub.id, "name": "mine"}
    nodes["/cycle"] = {**NODE, "path": [own, *PATH]}
    async with bystanders(hub), other_hub(hub) as other:
        await other.join()
        await other.send(
            record(links.ANNOUNCE, {"nodes": {**nodes, "/n": NODE}, "topics": {"/t": TOPIC}}),
            record(links.INTEREST, struct.pack("<QB", 12345, 1)),
            record(links.FLOWING, struct.pack("<Q", 12345)),
            record(links.MESSAGE, struct.pack("<QQq", 12345, 1, 1) + b"data"),
            record(links.REPLY, struct.pack("<QBI", 12345, 1, 2) + b"{}"),
            record(links.CANCEL, struct.pack("<Q", 12345)),
        )
        await until(lambda: "/n" in hub.graph.nodes, hub)
        assert not {"/a b", "//", "/cycle"} & {*hub.graph.nodes}
        assert hub.federation.peers


async def test_messages_that_do_not_fit_their_type_are_left_out(start_hub: StartHub) -> None:
    hub = await start_hub()
    md5sum = Interfaces().md5("std_msgs/Int32")
    topic = {**TOPIC, "md5sum": md5sum}
    async with fibws.Node("viewer", hub=hub.url) as viewer, other_hub(hub) as other:
        numbers = viewer.subscribe("t", Int32)
        await viewer.flush()
        await other.join()
        await other.send(record(links.ANNOUNCE, {"nodes": {"/n": NODE}, "topics": {"/t": topic}}))
        async with asyncio.timeout(PATIENCE):
            async for kind, _ in other.records():
                if kind == links.INTEREST:
                    break
            for sequence, data in enumerate((b"", b"12345", b"\x07\0\0\0"), 1):
                head = struct.pack("<QQq", 1, sequence, 2**63 - 1)
                await other.send(record(links.MESSAGE, head + data))
            assert (await anext(numbers)).data == 7


VALID = [
    record(links.ANNOUNCE, {"nodes": {"/n": NODE}, "topics": {"/t": TOPIC}}),
    record(links.ANNOUNCE, {"services": {"/s": {"node": "/n", "type": "a/B", "since": 1}}}),
    record(links.INTEREST, struct.pack("<QB", 1, 1)),
    record(links.FLOWING, struct.pack("<Q", 1)),
    record(links.MESSAGE, struct.pack("<QQq", 1, 1, 1) + b"\x07\0\0\0"),
    record(links.REPLY, struct.pack("<QBI", 1, 1, 2) + b"{}"),
    record(links.CANCEL, struct.pack("<Q", 1)),
    record(links.PING, bytes(8)),
    record(links.PONG, bytes(16)),
    request(1, op="call", service="/numbers", caller="/n"),
    request(2, op="describe", kind="msg", type="std_msgs/Int32"),
    request(3, op="ping_node", node="/one"),
    part(1, b"\0\0\0"),
]


async def test_random_changes_of_records_harm_nobody(start_hub: StartHub) -> None:
    hub = await start_hub()
    chance = random.Random(4)
    async with bystanders(hub) as exchange:
        for _ in range(times(0.3)):
            async with other_hub(hub) as other:
                await other.join()
                data = bytearray(b"".join(chance.choices(VALID, k=chance.randrange(1, 6))))
                for _ in range(chance.randrange(3)):
                    data[chance.randrange(len(data))] = chance.randrange(256)
                try:
                    await other.send(bytes(data[: chance.randrange(len(data)) + 1]))
                    await other.send(record(links.ANNOUNCE, {}))
                except ConnectionClosed:
                    assert other.websocket.close_code != 1011
                await exchange()
        await until(lambda: not hub.federation.peers, hub)


async def test_hub_that_announces_the_most_is_left_when_the_memory_is_full(
    start_hub: StartHub,
) -> None:
    hub = await start_hub(max_memory=16 * MIB)
    async with other_hub(hub) as small, other_hub(hub) as large:
        for each, letter in ((small, "a"), (large, "b")):
            own = {"id": 16 * letter, "name": letter}
            await each.join({"hub": own})
            nodes = {f"/node_{letter}": {**NODE, "path": [own]}}
            await each.send(record(links.ANNOUNCE, {"nodes": nodes}))
        await until(lambda: {"/node_a", "/node_b"} <= hub.graph.nodes.keys(), hub)
        before = hub._account.held()["hubs"]
        assert 2000 < before < 10_000
        for number in range(10):
            nodes = {f"/node_{number}_{each}": {**NODE, "path": [own]} for each in range(1000)}
            await large.send(record(links.ANNOUNCE, {"nodes": nodes}))
        assert await large.reason() == links.TOO_MUCH.reason
        await until(lambda: "/node_b" not in hub.graph.nodes, hub)
        assert 0 < hub._account.held()["hubs"] < before
        assert "/node_a" in hub.graph.nodes
