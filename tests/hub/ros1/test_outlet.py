"""Links by which ROS 1 subscribers take the messages of the hub's clients."""

from __future__ import annotations

import asyncio
import struct
from itertools import count

import pytest

import fibws
from fibws.errors import InvalidMessage
from fibws.hub.graph.graph import Graph
from fibws.hub.graph.publication import Publication
from fibws.hub.graph.topic import Source
from fibws.hub.graph.types import Buffer
from fibws.hub.ros1.connection import TcprosConnection
from fibws.hub.ros1.outlet import JOINED, OutletLink, TcprosOutlet
from fibws.hub.ros1.tcpros import decode_header
from fibws.hub.ros1.topic_registrations import Ros1Subscriber
from fibws.hub.server import HubServer
from fibws.msg.geometry_msgs import Point, PointStamped
from fibws.msg.std_msgs import Int32

from ..fakes import INT32, NANOSECONDS, STANDARD, FakeClock
from .conftest import StartPeer
from .service_peers import new_node, new_nodes
from .test_topics import Observer, int32, listening, until_linked
from .topic_peers import EVERY_BODY, EVERYTHING, HIGH, HIGH_WATER, LOW, FakeTransport, framed

BYTES = "std_msgs/UInt8MultiArray"


def sized(size: int, mark: int) -> dict[str, object]:
    """Return a message whose data have this many bytes, all the same."""
    return {"data": [mark] * size}


def mark_of(message: Buffer) -> int:
    return bytes(message)[-1]


class Topic:
    """A topic with publishers of ours, and links to ROS 1 subscribers."""

    def __init__(self, type_: str = BYTES, max_queued: int = 2**20) -> None:
        self.graph = Graph(STANDARD, lambda: NANOSECONDS)
        self.nodes = new_nodes(self.graph)
        self.nodes.topics.links = self
        self.type = type_
        self._outlet = TcprosOutlet("/t", self.graph, self.nodes, max_queued, count(1))

    def outlet(self, topic: str) -> TcprosOutlet:
        return self._outlet

    def changed(self, topic: object) -> None:
        """Do nothing: the links are those of the test."""

    def publisher(
        self, node: str = "/client", *, queue_size: int = 3, latch: bool = False
    ) -> Source:
        topic = self.graph.topic("/t")
        return self.graph.advertise(topic, node, self.type, queue_size=queue_size, latch=latch)

    def subscriber(self, name: str = "/listener") -> Ros1Subscriber:
        node = new_node(self.nodes, name)
        subscriber = Ros1Subscriber(node, "/t", "*", self._outlet)
        node.subscribed["/t"] = subscriber
        self.graph.subscribe(self.graph.topic("/t"), subscriber, receiver=lambda _: self._outlet)
        return subscriber

    def link(self, subscriber: Ros1Subscriber) -> tuple[OutletLink, FakeTransport]:
        connection = TcprosConnection({}, FakeClock(), 10.0, lambda _: None)
        transport = FakeTransport(connection)
        connection.connection_made(transport)
        header = {"topic": "/t", "md5sum": "*", "callerid": subscriber.node}
        link = self._outlet.accept(header, subscriber, connection)
        connection._handler = link
        self.header = decode_header(bytes(transport.written[0])[4:])
        del transport.written[0]
        return link, transport


async def test_nothing_is_serialized_while_no_link_is_open() -> None:
    topic = Topic()
    source, subscriber = topic.publisher(), topic.subscriber()

    class Unserializable(Publication):
        def ros1(self) -> Buffer:
            raise AssertionError

    topic.outlet("/t").receive(Unserializable(source.type, "/client", b"", 0, {}))
    topic.link(subscriber)
    with pytest.raises(AssertionError):
        topic.outlet("/t").receive(Unserializable(source.type, "/client", b"", 0, {}))


async def test_message_is_made_once_for_all_links() -> None:
    topic = Topic()
    source = topic.publisher()
    links = [topic.link(topic.subscriber(f"/listener{number}")) for number in range(3)]
    for size in (5, JOINED):
        source.publish(sized(size, 7))
        newest = [transport.written[-1] for _, transport in links]
        assert newest[0] is newest[1] is newest[2]
        assert mark_of(newest[0]) == 7
    [first, *_] = links[0][1].written
    body = struct.pack("<III", 0, 0, 5) + b"\x07" * 5
    assert first == framed(body)


async def test_slow_subscriber_keeps_as_many_messages_as_queue_size() -> None:
    topic = Topic()
    source = topic.publisher(queue_size=3)
    subscriber = topic.subscriber()
    _, slow = topic.link(subscriber)
    _, quick = topic.link(topic.subscriber("/quick"))
    source.publish(sized(HIGH_WATER + 1, 0))
    quick.read()
    for number in range(1, 8):
        source.publish(sized(10, number))
    assert [mark_of(each) for each in quick.written[-7:]] == [1, 2, 3, 4, 5, 6, 7]
    slow.read()
    assert [mark_of(each) for each in slow.written[-4:]] == [0, 5, 6, 7]
    assert subscriber.report() == (3, 0.0, "none", 8, 4, 0)


async def test_queue_is_shortened_if_the_memory_is_full() -> None:
    topic = Topic()
    source = topic.publisher(queue_size=10)
    link, transport = topic.link(topic.subscriber())
    source.publish(sized(HIGH_WATER + 1, 0))
    written = transport.get_write_buffer_size()
    for number in range(1, 6):
        source.publish(sized(88, number))
    assert link.connection.waiting_bytes == written + 500
    link.connection.shorten(250, 1)
    assert (link.connection.waiting_bytes, link.report().dropped) == (written + 200, 3)
    link.connection.shorten(0, 1)
    assert link.connection.waiting_bytes == written + 100
    transport.read()
    assert [mark_of(each) for each in transport.written[-2:]] == [0, 5]


async def test_publishers_of_one_topic_share_the_queue_of_all() -> None:
    topic = Topic()
    sources = [topic.publisher(f"/client{size}", queue_size=size) for size in (1, 2)]
    link, transport = topic.link(topic.subscriber())
    sources[0].publish(sized(HIGH_WATER + 1, 0))
    for number in range(1, 6):
        sources[number % 2].publish(sized(10, number))
    transport.read()
    assert [mark_of(each) for each in transport.written[-4:]] == [0, 3, 4, 5]
    assert link.report().queue_length == 3


@pytest.mark.parametrize("queue_size", [0, -1])
async def test_queue_without_a_length_is_bounded_in_bytes(queue_size: int) -> None:
    topic = Topic(max_queued=1000)
    source = topic.publisher(queue_size=queue_size)
    link, transport = topic.link(topic.subscriber())
    source.publish(sized(HIGH_WATER + 1, 0))
    for number in range(1, 51):
        source.publish(sized(88, number))
    transport.read()
    assert [mark_of(each) for each in transport.written[-11:]] == [0, *range(41, 51)]
    assert link.report().dropped == 40


async def test_newest_message_is_kept_however_large() -> None:
    topic = Topic(max_queued=1000)
    source = topic.publisher()
    _, transport = topic.link(topic.subscriber())
    for number in range(3):
        source.publish(sized(HIGH_WATER + 1, number))
    transport.read()
    assert mark_of(transport.written[-1]) == 2


async def test_latched_messages_do_not_pile_up_for_a_subscriber_that_never_reads() -> None:
    topic = Topic(max_queued=3 * HIGH_WATER)
    for number in range(10):
        topic.publisher(f"/client{number}", latch=True).publish(sized(HIGH_WATER + 1, number))
    link, transport = topic.link(topic.subscriber())
    assert topic.header["latching"] == "1"
    assert transport.bytes < 2 * HIGH_WATER
    assert link.report().dropped == 7


async def test_totals_of_a_subscriber_outlive_its_links() -> None:
    topic = Topic()
    source, subscriber = topic.publisher(queue_size=1), topic.subscriber()
    for _ in range(2):
        link, _ = topic.link(subscriber)
        source.publish(sized(HIGH_WATER + 1, 0))
        for number in range(3):
            source.publish(sized(1, number))
        link.connection_lost()
    assert subscriber.report()[3:5] == (8, 6)


async def test_older_link_of_a_subscriber_ends_without_harm_to_the_newer_one() -> None:
    topic = Topic()
    source, subscriber = topic.publisher(), topic.subscriber()
    (older, _), (newer, transport) = topic.link(subscriber), topic.link(subscriber)
    older.connection_lost()
    links = [subscriber.link]
    source.publish(sized(1, 9), to="/listener")
    assert mark_of(transport.written[-1]) == 9
    newer.connection_lost()
    assert [*links, subscriber.link] == [newer, None]
    assert topic.outlet("/t").links == {}


async def test_closed_link_gets_nothing_more() -> None:
    topic = Topic()
    source = topic.publisher()
    link, transport = topic.link(topic.subscriber())
    link.close()
    source.publish(sized(1, 9))
    assert transport.written == []
    assert transport.closes


async def test_latched_message_that_cannot_be_sent_is_logged(
    caplog: pytest.LogCaptureFixture,
) -> None:
    topic = Topic(INT32)
    source = topic.publisher()

    def fail() -> dict[str, object]:
        raise InvalidMessage("no value")

    source.make_latest = fail
    topic.link(topic.subscriber())
    assert "no value" in caplog.text


# With a hub.


async def test_values_of_all_sorts_pass_bit_by_bit(hub: HubServer, start_peer: StartPeer) -> None:
    talker, listener = await start_peer("/talker"), await start_peer("/listener")
    await talker.advertise("/in", EVERYTHING)
    observer = Observer()
    hub.graph.subscribe(hub.graph.topic("/in"), observer)
    (await talker.linked()).send(EVERY_BODY)
    publication = await observer.next()
    assert publication.ros1() == EVERY_BODY
    values = publication.values()
    assert (values["low"], values["high"]) == (LOW, HIGH)
    assert values["stamp"] == {"secs": 2**32 - 1, "nsecs": 999_999_999}
    assert values["inner"][0]["ints"] == [1, LOW]
    assert values["words"] == ["", "ä!"]

    topic, type_ = hub.graph.topic("/out"), EVERYTHING["type"]
    source = hub.graph.advertise(topic, "/page", type_, EVERYTHING["message_definition"])
    link = await listening(listener, "/out", type=type_, md5sum=EVERYTHING["md5sum"])
    source.publish(values)
    assert await link.receive() == EVERY_BODY
    source.publish_serialized(EVERY_BODY)
    assert await link.receive() == EVERY_BODY
    hub.graph.remove_source(source)
    hub.graph.unsubscribe(hub.graph.topic("/in"), observer)


async def test_header_of_messages_is_numbered_for_each_publisher(
    hub: HubServer, start_peer: StartPeer, node: fibws.Node
) -> None:
    async with fibws.Node("second", hub=hub.url) as second:
        publishers = [
            await each.advertise("/p", PointStamped, peers=True) for each in (node, second)
        ]
        link = await listening(await start_peer("/listener"), "/p")
        for publisher in publishers:
            await until_linked(publisher, "/listener")
        for publisher in publishers:
            for number in (1, 2):
                await publisher.publish(point=Point(x=float(number)))
                assert (await link.receive())[:4] == struct.pack("<I", number)


async def test_link_ends_when_its_subscriber_unregisters(
    start_peer: StartPeer, node: fibws.Node
) -> None:
    await node.advertise("/count", Int32)
    listener = await start_peer("/listener")
    link = await listening(listener, "/count")
    await listener.call("unregisterSubscriber", "/count", listener.api)
    assert await link.ended() == b""


async def test_name_without_a_slash_is_that_of_the_registered_node(
    start_peer: StartPeer, node: fibws.Node
) -> None:
    publisher = await node.advertise("/count", Int32, peers=True)
    listener = await start_peer("/listener")
    await listener.subscribe("/count")
    link = await listener.connect("/count", callerid="listener")
    await until_linked(publisher, "/listener")
    await publisher.publish(4)
    assert await link.receive() == int32(4)


async def test_aggregated_log_holds_what_ros1_nodes_log(start_peer: StartPeer) -> None:
    log = {
        "type": "rosgraph_msgs/Log",
        "md5sum": "acffd30cd6b6de30f120938c17c593fb",
        "message_definition": "",
    }
    talker, listener = await start_peer("/talker"), await start_peer("/listener")
    await talker.advertise("/rosout", log)
    link = await listening(listener, "/rosout_agg")
    body = struct.pack("<IIIIB4III", 1, 2, 3, 0, 2, 0, 0, 0, 0, 5, 0)
    (await talker.linked()).send(body)
    assert await link.receive() == body


async def test_subscriber_of_an_unknown_type_leaves_the_hub_idle(
    hub: HubServer, start_peer: StartPeer
) -> None:
    listener = await start_peer("/listener")
    await listener.subscribe("/t", "std_msgs/Nonsense")
    for _ in range(10):
        await asyncio.sleep(0)
    revision = hub.graph.revision
    for _ in range(100):
        await asyncio.sleep(0)
    assert hub.graph.revision == revision


async def test_bus_info_is_what_rosnode_parses(start_peer: StartPeer, node: fibws.Node) -> None:
    publisher = await node.advertise("/count", Int32, peers=True)
    listener = await start_peer("/listener")
    link = await listening(listener, "/count")
    await until_linked(publisher, "/listener")
    await publisher.publish(1)
    await link.receive()
    [[number, other, way, *_, text]] = await listener.call("getBusInfo")
    assert (other, way) == ("/listener", "o")
    assert text.startswith("TCPROS connection on port ")
    assert text.endswith("]")
    [published, _, _] = await listener.call("getBusStats")
    assert published == [["/count", 4, [[number, 4, 1, True]]]]


async def test_bus_info_of_a_client_lists_its_own_links_alone(
    hub: HubServer, start_peer: StartPeer, node: fibws.Node
) -> None:
    peer = await start_peer("/peer")
    await peer.advertise("/in")
    await peer.advertise("/other")
    await node.advertise("/out", Int32)
    async with fibws.Node("second", hub=hub.url) as second:
        await second.advertise("/elsewhere", Int32)
        messages = [node.subscribe("/in", Int32), second.subscribe("/other", Int32)]
        for _ in messages:
            (await peer.linked()).send(int32(1))
        for each in messages:
            await anext(each)
        for topic in ("/out", "/elsewhere"):
            await listening(peer, topic)
        uri = f"{peer.master}node"
        found = {
            name: sorted(link[4] for link in await peer.call("getBusInfo", uri=f"{uri}{name}"))
            for name in ("/client", "/second")
        }
        assert found == {"/client": ["/in", "/out"], "/second": ["/elsewhere", "/other"]}
        published, subscribed, _ = await peer.call("getBusStats", uri=f"{uri}/second")
        assert [each[0] for each in published + subscribed] == ["/elsewhere", "/other"]
