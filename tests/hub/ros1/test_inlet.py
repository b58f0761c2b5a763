"""Links by which the hub subscribes at ROS 1 publishers."""

from __future__ import annotations

import asyncio
import hashlib
import math
import random
import socket
import struct
from collections.abc import Mapping
from itertools import repeat
from typing import Any, cast

import pytest

import fibws
from fibws.hub.errors import LimitReached
from fibws.hub.foreign import worklist
from fibws.hub.graph.topic import Source
from fibws.hub.ros1 import inlet
from fibws.hub.ros1.inlet import AHEAD, SCRATCH, InletConnection
from fibws.hub.ros1.tcpros import MOST_HEADER, MOST_MESSAGE, encode_header
from fibws.hub.server import HubServer
from fibws.msg.std_msgs import Int32

from .conftest import StartPeer
from .peer import INT32
from .test_topics import HEADER, VALUES, Observer, int32
from .topic_peers import FakeSource, FakeTransport, feed, framed

ANSWER = encode_header({"type": "std_msgs/Int32", "md5sum": "*"})
ALL = repeat(2**30)


class Link:
    """A connection without a socket, whose publisher has sent its header."""

    def __init__(self, max_size: int = 2**24, *, is_open: bool = True) -> None:
        self.source = FakeSource()
        self.headers: list[Mapping[str, str]] = []
        self.connection = InletConnection(self._open, max_size)
        self.transport = FakeTransport(self.connection)
        self.connection.connection_made(self.transport)
        if is_open:
            self.feed(ANSWER)

    def _open(self, header: Mapping[str, str]) -> Source:
        self.headers.append(header)
        return cast("Source", self.source)

    def feed(self, data: bytes, sizes: Any = ALL) -> None:
        feed(self.connection, data, sizes)

    @property
    def fault(self) -> str:
        """What the publisher did wrong."""
        connection = self.connection
        future = connection.ended if connection.ended.done() else connection.opened
        return str(future.exception())


async def test_messages_arrive_whole_however_they_are_cut() -> None:
    rng = random.Random(1)
    sizes = [0, 1, 3, 4, 5, 100, SCRATCH // 4, SCRATCH // 4 + 1, SCRATCH - 4, SCRATCH, 300_000]
    for piece in (1, 3, 1000, SCRATCH, 2**20, 0):
        link = Link(is_open=False)
        bodies = [
            rng.randbytes(rng.choice(sizes) if piece > 3 or not piece else 7) for _ in range(40)
        ]
        pieces = repeat(piece) if piece else iter(lambda: rng.randrange(1, SCRATCH), None)
        link.feed(ANSWER + framed(*bodies), pieces)
        await link.source.received(len(bodies))  # Others have their turn now and then.
        assert link.source.messages == bodies
        assert link.connection.messages == len(bodies)
        assert len(link.headers) == 1


async def test_large_message_is_read_into_a_buffer_of_its_own() -> None:
    link = Link()
    link.feed(framed(bytes(10**6))[: SCRATCH + 1])
    buffer = link.connection.get_buffer(-1)
    assert len(buffer) == 10**6 + 4 - SCRATCH - 1


async def test_message_that_claims_much_takes_no_memory_before_it_comes() -> None:
    link = Link()
    message = framed(bytes(range(256)) * 2**15)
    link.feed(message[: SCRATCH + 1])
    assert len(link.connection.get_buffer(-1)) <= 4 * SCRATCH + AHEAD
    link.feed(message[SCRATCH + 1 :])
    assert link.source.messages == [message[4:]]


async def test_many_messages_leave_others_their_turn(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(inlet, "TURN", 0.0)
    link = Link()
    bodies = [int32(number) for number in range(100)]
    link.feed(framed(*bodies))
    assert 0 < len(link.source.messages) < 100
    reads = link.transport.reads
    await link.source.received(100)
    assert link.source.messages == bodies
    assert (reads, link.transport.reads) == (False, True)


@pytest.mark.parametrize("size", [1001, 5000, SCRATCH + 7, 500_000])
async def test_message_that_is_too_large_is_left_out(
    size: int, caplog: pytest.LogCaptureFixture
) -> None:
    for piece in (1 if size < 10_000 else 1000, 2**20):
        caplog.clear()
        link = Link(max_size=1000)
        link.feed(framed(b"before", bytes(size), b"after"), repeat(piece))
        assert link.source.messages == [b"before", b"after"]
        assert f"{size} bytes" in caplog.text
        assert "--max-message-size" in caplog.text


@pytest.mark.parametrize("size", [MOST_MESSAGE + 1, 2**32 - 1])
async def test_impossible_length_ends_the_connection(size: int) -> None:
    link = Link()
    link.feed(struct.pack("<I", size) + bytes(1000))
    assert str(size) in link.fault
    assert link.transport.is_aborted
    assert link.source.messages == []


async def test_header_that_is_too_long_ends_the_connection() -> None:
    link = Link(is_open=False)
    link.feed(struct.pack("<I", MOST_HEADER + 1) + bytes(10))
    assert str(MOST_HEADER + 1) in link.fault
    assert link.transport.is_aborted


async def test_random_bytes_are_never_an_exception() -> None:
    rng = random.Random(2)
    for number in range(500):
        link = Link(is_open=number % 2 == 0)
        data = bytearray(framed(*(rng.randbytes(rng.randrange(50)) for _ in range(5))))
        for _ in range(rng.randrange(5)):
            data[rng.randrange(len(data))] = rng.choice((0, 255, rng.randrange(256)))
        pieces = iter(lambda: rng.randrange(1, 50), None)
        while data and not link.transport.is_aborted:
            link.feed(bytes(data[:60]), pieces)
            del data[:60]
        link.connection.connection_lost(None)
        assert link.connection.opened.done()
        assert link.connection.ended.done()


async def test_message_that_is_cut_short_is_not_delivered() -> None:
    for size in (100, 100_000):
        link = Link()
        link.feed(framed(bytes(size))[:-1])
        link.connection.connection_lost(ConnectionResetError())
        assert link.source.messages == []
        assert link.connection.ended.exception() is None


async def test_nothing_is_delivered_once_a_link_is_closed() -> None:
    link = Link()
    link.source._relayed = link.connection.close
    link.feed(framed(b"first", b"second"))
    assert link.source.messages == [b"first"]


async def test_message_that_is_delivered_but_not_latched_is_not_called_dropped(
    caplog: pytest.LogCaptureFixture,
) -> None:
    link = Link()
    link.source.fault = LimitReached("delivered but not latched")
    link.feed(framed(b"large"))
    assert "delivered but not latched" in caplog.text
    assert "dropped" not in caplog.text


# With a hub.


@pytest.fixture(autouse=True)
def quick_retries(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(inlet, "FIRST_RETRY", 0.001)


async def test_link_ends_when_its_publisher_unregisters(
    start_peer: StartPeer, node: fibws.Node
) -> None:
    talker = await start_peer("/talker")
    await talker.advertise("/count")
    node.subscribe("/count", Int32)
    link = await talker.linked()
    await talker.call("unregisterPublisher", "/count", talker.api)
    assert await link.ended() == b""
    await talker.advertise("/other")
    node.subscribe("/other", Int32)
    assert (await talker.linked()).header["topic"] == "/other"


async def test_publisher_may_come_back_with_another_type(
    start_peer: StartPeer, node: fibws.Node, hub: HubServer
) -> None:
    observer = Observer()
    hub.graph.subscribe(hub.graph.topic("/t"), observer)
    talker = await start_peer("/talker")
    await talker.advertise("/t")
    link = await talker.linked()
    link.send(int32(1))
    assert (await observer.next()).values() == {"data": 1}
    for fields, body in ((VALUES, bytes(4)), (HEADER, bytes(16)), (INT32, int32(2))):
        talker.publishes["/t"] |= fields
        link.close()
        link = await talker.linked()
        link.send(body)
        publication = await observer.next()
        assert (publication.type.name, publication.ros1()) == (fields["type"], body)
    assert hub.graph.view("/x").conflicts(hub.graph.topics["/t"]) == []
    hub.graph.unsubscribe(hub.graph.topic("/t"), observer)


async def test_publisher_may_come_back_with_another_definition_of_its_type(
    hub: HubServer, start_peer: StartPeer
) -> None:
    observer = Observer()
    hub.graph.subscribe(hub.graph.topic("/t"), observer)
    talker = await start_peer("/talker")
    await talker.advertise("/t", VALUES)
    link = await talker.linked()
    link.send(bytes(4))
    await observer.next()
    definition = "int8 number\n"
    md5sum = hashlib.md5(definition.strip().encode()).hexdigest()
    talker.publishes["/t"] |= {"message_definition": definition, "md5sum": md5sum}
    link.close()
    (await talker.linked()).send(b"\x05")
    assert (await observer.next()).values() == {"number": 5}
    hub.graph.unsubscribe(hub.graph.topic("/t"), observer)


@pytest.mark.parametrize(
    "fields",
    [
        {**INT32, "md5sum": "*"},
        {"type": "std_msgs/Int32", "md5sum": INT32["md5sum"]},
        {"type": "std_msgs/Int32", "md5sum": INT32["md5sum"], "message_definition": ""},
        {**INT32, "message_definition": "# Temperature in \xb0C\nint32 data"},
    ],
)
async def test_header_may_say_less_than_usual(
    start_peer: StartPeer, node: fibws.Node, fields: dict[str, str]
) -> None:
    talker = await start_peer("/talker")
    await talker.advertise("/count", fields)
    messages = node.subscribe("/count", Int32)
    (await talker.linked()).send(int32(1))
    assert (await anext(messages)).data == 1


async def test_type_without_fields_is_learned(hub: HubServer, start_peer: StartPeer) -> None:
    observer = Observer()
    hub.graph.subscribe(hub.graph.topic("/t"), observer)
    talker = await start_peer("/talker")
    fields = {"type": "my_msgs/Nothing", "md5sum": inlet.MD5_OF_EMPTY, "message_definition": ""}
    await talker.advertise("/t", fields)
    (await talker.linked()).send(b"")
    assert (await observer.next()).values() == {}
    hub.graph.unsubscribe(hub.graph.topic("/t"), observer)


async def test_publisher_without_a_type_is_logged_and_tried_again(
    start_peer: StartPeer, node: fibws.Node, caplog: pytest.LogCaptureFixture
) -> None:
    talker = await start_peer("/talker")
    await talker.advertise("/count", {**INT32, "type": "*"})
    messages = node.subscribe("/count", Int32)
    await talker.linked()
    await talker.linked()
    assert "got *" in caplog.text
    talker.publishes["/count"] |= INT32
    (await talker.linked()).send(int32(3))
    while not talker.links.empty():
        talker.links.get_nowait().send(int32(3))
    assert (await anext(messages)).data == 3


@pytest.mark.parametrize(
    "fields",
    [
        {**VALUES, "message_definition": "this is no definition"},
        {**VALUES, "md5sum": "0" * 32},
        {"type": "no type", "md5sum": "*", "message_definition": ""},
        {**INT32, "md5sum": "0" * 32},
    ],
)
async def test_publisher_whose_type_cannot_be_known_is_a_conflict(
    hub: HubServer, start_peer: StartPeer, fields: dict[str, str]
) -> None:
    observer = Observer()
    hub.graph.subscribe(hub.graph.topic("/t"), observer)
    talker = await start_peer("/talker")
    talker.answers["requestTopic"] = [0, "not yet", 0]
    await talker.advertise("/t", {**INT32, "type": "my_msgs/Values"})
    talker.publishes["/t"] |= fields
    del talker.answers["requestTopic"]
    link = await talker.linked()
    assert await link.ended() == b""
    [conflict] = hub.graph.view("/x").conflicts(hub.graph.topics["/t"])
    assert (conflict.node, conflict.publishes) == ("/talker", True)
    for _ in range(10):
        await asyncio.sleep(0)
    revision = hub.graph.revision
    for _ in range(100):
        await asyncio.sleep(0)
    assert hub.graph.revision == revision
    assert talker.links.empty()
    hub.graph.unsubscribe(hub.graph.topic("/t"), observer)


async def test_messages_of_an_unknown_type_are_dropped_until_it_is_known(
    hub: HubServer, start_peer: StartPeer, caplog: pytest.LogCaptureFixture
) -> None:
    observer = Observer()
    hub.graph.subscribe(hub.graph.topic("/t"), observer)
    talker, other = await start_peer("/talker"), await start_peer("/other")
    await talker.advertise("/t", {"type": VALUES["type"], "md5sum": VALUES["md5sum"]})
    link = await talker.linked()
    link.send(bytes(4))
    await other.advertise("/t", VALUES)
    (await other.linked()).send(bytes(4))
    assert (await observer.next()).node == "/other"
    assert "my_msgs/Values" in caplog.text
    link.send(bytes(4))
    assert (await observer.next()).node == "/talker"
    hub.graph.unsubscribe(hub.graph.topic("/t"), observer)


async def test_publisher_with_another_definition_does_not_disturb_the_first(
    hub: HubServer, start_peer: StartPeer
) -> None:
    observer = Observer()
    hub.graph.subscribe(hub.graph.topic("/t"), observer)
    first, second = await start_peer("/first"), await start_peer("/second")
    await first.advertise("/t", VALUES)
    link = await first.linked()
    definition = "int8 number\n"
    md5sum = hashlib.md5(definition.strip().encode()).hexdigest()
    other = {**VALUES, "message_definition": definition, "md5sum": md5sum}
    await second.advertise("/t", other)
    other_link = await second.linked()
    other_link.send(b"\x07")
    message = await observer.next()
    assert (message.node, message.values()) == ("/second", {"number": 7})
    [conflict] = hub.graph.view("/x").conflicts(hub.graph.topics["/t"])
    assert conflict.node == "/second"
    link.send(bytes(4))
    assert (await observer.next()).node == "/first"
    await first.call("unregisterPublisher", "/t", first.api)
    other_link.send(b"\x08")
    assert (await observer.next()).values() == {"number": 8}
    assert hub.graph.view("/x").conflicts(hub.graph.topics["/t"]) == []
    hub.graph.unsubscribe(hub.graph.topic("/t"), observer)


async def test_latched_message_is_forgotten_with_the_latching(
    start_peer: StartPeer, node: fibws.Node, hub: HubServer
) -> None:
    talker = await start_peer("/talker")
    await talker.advertise("/count", latching=True)
    messages = node.subscribe("/count", Int32)
    link = await talker.linked()
    link.send(int32(1))
    await anext(messages)
    source = hub.graph.topics["/count"].sources["/talker"]
    assert source.recall() is not None
    talker.publishes["/count"]["latching"] = "0"
    link.close()
    (await talker.linked()).send(int32(2))
    await anext(messages)
    assert source.recall() is None


@pytest.fixture
def failures(monkeypatch: pytest.MonkeyPatch) -> asyncio.Queue[int]:
    """How often a link has failed in a row, after each failure."""
    found: asyncio.Queue[int] = asyncio.Queue()
    report = inlet.TcprosInlet._report

    async def recorded(self: inlet.TcprosInlet, error: Exception) -> None:
        await report(self, error)
        found.put_nowait(self._failures)

    monkeypatch.setattr(inlet.TcprosInlet, "_report", recorded)
    return found


async def test_node_that_ends_is_not_logged_but_one_that_stays_away_is(
    start_peer: StartPeer,
    node: fibws.Node,
    failures: asyncio.Queue[int],
    caplog: pytest.LogCaptureFixture,
) -> None:
    talker = await start_peer("/talker")
    topics = ["/a", "/b", "/c"]
    for topic in topics:
        await talker.advertise(topic)
        node.subscribe(topic, Int32)
    for _ in topics:
        await talker.linked()
    talker.die()
    async with asyncio.timeout(60):
        while (count := await failures.get()) < inlet.PATIENCE:
            assert "/talker" not in caplog.text
        while count < 2 * inlet.PATIENCE:
            count = await failures.get()
    assert caplog.text.count("/talker is unreachable") == 1
    assert "no link" not in caplog.text


async def test_node_that_answers_but_takes_no_links_is_logged_for_each_topic(
    start_peer: StartPeer,
    node: fibws.Node,
    failures: asyncio.Queue[int],
    caplog: pytest.LogCaptureFixture,
) -> None:
    with socket.create_server(("127.0.0.1", 0)) as closed:
        port = closed.getsockname()[1]
    talker = await start_peer("/talker")
    talker.answers["requestTopic"] = [1, "", ["TCPROS", "127.0.0.1", port]]
    await talker.advertise("/count")
    node.subscribe("/count", Int32)
    async with asyncio.timeout(60):
        while await failures.get() < 2 * inlet.PATIENCE:
            pass
    assert caplog.text.count("/talker: no link to its topic /count") == 1
    assert "unreachable" not in caplog.text


@pytest.mark.parametrize(
    "answer",
    [
        [0, "no", 0],
        [1, "", []],
        [1, "", ["UDPROS", "127.0.0.1", 1]],
        [1, "", ["TCPROS", "127.0.0.1", 70000]],
        [1, "", ["TCPROS", "127.0.0.1", -1]],
        [1, "", ["TCPROS", "a" * 300, 1]],
        [1, "", ["TCPROS", "", "1"]],
        "nonsense",
    ],
)
async def test_unusable_answer_of_a_publisher_is_asked_for_again(
    start_peer: StartPeer, node: fibws.Node, answer: Any, caplog: pytest.LogCaptureFixture
) -> None:
    talker = await start_peer("/talker")
    talker.answers["requestTopic"] = answer
    await talker.advertise("/count")
    messages = node.subscribe("/count", Int32)
    for _ in range(inlet.PATIENCE + 1):
        await talker.called("requestTopic")
    assert caplog.text.count("no link to its topic /count") == 1
    del talker.answers["requestTopic"]
    (await talker.linked()).send(int32(1))
    assert (await anext(messages)).data == 1


async def test_publisher_that_refuses_is_logged_with_its_reason(
    start_peer: StartPeer, node: fibws.Node, caplog: pytest.LogCaptureFixture
) -> None:
    talker = await start_peer("/talker")
    await talker.advertise("/count")
    talker.publishes["/count"]["error"] = "not\x1b for you"
    node.subscribe("/count", Int32)
    for _ in range(3):
        await talker.linked()
    assert caplog.text.count("not\\x1b for you") == 1


async def test_publisher_that_closes_at_once_is_tried_ever_less_often(
    start_peer: StartPeer, node: fibws.Node, monkeypatch: pytest.MonkeyPatch
) -> None:
    delays = []
    sleep = asyncio.sleep

    async def recorded(seconds: float) -> None:
        delays.append(seconds)
        await sleep(0)

    talker = await start_peer("/talker")
    await talker.advertise("/count")
    monkeypatch.setattr(asyncio, "sleep", recorded)
    node.subscribe("/count", Int32)
    for _ in range(6):
        (await talker.linked()).close()
    link = await talker.linked()
    ours = [each for each in delays if each][:6]
    assert all(0.8 * 2**k < each / 0.001 < 1.2 * 2**k for k, each in enumerate(ours))
    delays.clear()
    link.send(int32(1))
    link.close()
    await talker.linked()
    assert delays[0] < 0.002


async def test_many_links_are_opened_and_closed(
    start_peer: StartPeer, node: fibws.Node, hub: HubServer
) -> None:
    assert hub.ros1 is not None
    talkers = [await start_peer(f"/talker{number}") for number in range(20)]
    topics = [f"/t{number}" for number in range(10)]
    for talker in talkers:
        for topic in topics:
            await talker.advertise(topic)
    subscriptions = [node.subscribe(topic, Int32, queue_size=100) for topic in topics]
    for number, talker in enumerate(talkers):
        for _ in topics:
            (await talker.linked()).send(int32(number))
    for messages in subscriptions:
        received = [(await anext(messages)).data for _ in talkers]
        assert sorted(received) == list(range(20))
    for talker in talkers[1:]:
        for topic in topics:
            await talker.call("unregisterPublisher", topic, talker.api)
    links = hub.ros1._topics._inlets
    assert {topic: list(inlets) for topic, inlets in links.items()} == {
        topic: ["/talker0"] for topic in topics
    }


async def test_hub_that_closes_leaves_no_task(hub: HubServer, start_peer: StartPeer) -> None:
    assert hub.ros1 is not None
    observers = {f"/t{number}": Observer() for number in range(3)}
    silent, sound = await start_peer("/silent"), await start_peer("/sound")
    silent.answers["requestTopic"] = None  # It never answers.
    for topic, observer in observers.items():
        hub.graph.subscribe(hub.graph.topic(topic), observer)
        await silent.advertise(topic)
        await sound.advertise(topic)
        await sound.linked()
    topics = hub.ros1._topics
    tasks = [each._task for inlets in topics._inlets.values() for each in inlets.values()]
    assert len(tasks) == 6
    await topics.close()
    assert all(task.done() for task in tasks)
    for topic, observer in observers.items():
        hub.graph.unsubscribe(hub.graph.topic(topic), observer)


async def test_publisher_that_has_unregistered_gets_no_source(
    hub: HubServer, start_peer: StartPeer
) -> None:
    assert hub.ros1 is not None
    talker = await start_peer("/talker")
    await talker.advertise("/count")
    [publisher] = hub.ros1.nodes.topics.publishers("/count")
    await talker.call("unregisterPublisher", "/count", talker.api)
    # Its header may arrive before the link is closed.
    learned = hub.ros1.nodes.topics.learn(publisher, INT32["type"], None, INT32["md5sum"])
    assert learned is None
    assert "/count" not in hub.graph.topics


async def test_changes_of_many_topics_leave_others_their_turn(
    hub: HubServer, start_peer: StartPeer, node: fibws.Node, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert hub.ros1 is not None
    nodes, turns = hub.ros1.nodes, []
    work = nodes.topics._work
    run = work._run

    def counted() -> None:
        turns.append(len(work))
        run()

    talker, listener = await start_peer("/talker"), await start_peer("/listener")
    topics = [f"/t{number}" for number in range(20)]
    for topic in topics:
        await talker.advertise(topic)
        await listener.subscribe(topic)
    monkeypatch.setattr(work, "_run", counted)
    monkeypatch.setattr(worklist, "TURN", math.inf)  # All is removed in one turn.
    nodes.remove(nodes.by_name["/talker"])
    monkeypatch.setattr(worklist, "TURN", 0.0)
    updates = [await listener.called("publisherUpdate") for _ in topics]
    assert sorted(updates) == sorted([topic, []] for topic in topics)
    assert turns[:20] == list(range(20, 0, -1))
