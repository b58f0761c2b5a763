"""Topics between ROS 1 nodes and clients of the hub."""

from __future__ import annotations

import asyncio
import hashlib
import math
import struct
from collections.abc import AsyncIterator, Callable
from contextlib import ExitStack
from typing import Any

import pytest
from conftest import StartHub

import fibws
from fibws.hub.graph.publication import Publication
from fibws.hub.ros1 import inlet, topics
from fibws.hub.server import HubServer
from fibws.msg.actionlib_msgs import GoalStatusArray
from fibws.msg.sensor_msgs import Image
from fibws.msg.std_msgs import Int32, String

from ..foxglove.real_client import foxglove
from ..graph.recorder import Recorder
from ..raw_client import until
from .conftest import StartPeer
from .peer import MD5_OF_INT32, Link, Peer

pytestmark = pytest.mark.both_loops

HEADER = {
    "type": "std_msgs/Header",
    "md5sum": "2176decaecbce78abc3b96ef049fabed",
    "message_definition": "uint32 seq\ntime stamp\nstring frame_id\n",
}
VALUES = {
    "type": "my_msgs/Values",
    "md5sum": hashlib.md5(b"float64[] values").hexdigest(),
    "message_definition": "float64[] values\n",
}


def int32(number: int) -> bytes:
    return struct.pack("<i", number)


async def until_linked(publisher: Any, *names: str) -> None:
    """Wait until these nodes, and no others, get a publisher's messages."""
    async with asyncio.timeout(60):
        async for peers in publisher.peers.changes():
            if peers == sorted(names):
                return


# From ROS 1 nodes.


async def test_message_reaches_a_client(start_peer: StartPeer, node: fibws.Node) -> None:
    talker = await start_peer("/talker")
    await talker.advertise("/count")
    messages = node.subscribe("/count", Int32)
    link = await talker.linked()
    assert (link.header["topic"], link.header["md5sum"]) == ("/count", "*")
    link.send(int32(1), int32(2))
    assert [(await anext(messages)).data for _ in range(2)] == [1, 2]


async def test_no_link_is_opened_for_a_topic_that_no_client_subscribes_to(
    hub: HubServer, start_peer: StartPeer, node: fibws.Node
) -> None:
    talker, listener = await start_peer("/talker"), await start_peer("/listener")
    await talker.advertise("/count")
    assert await listener.subscribe("/count") == [talker.api]
    await talker.advertise("/other")
    node.subscribe("/other", Int32)
    assert (await talker.linked()).header["topic"] == "/other"
    assert talker.links.empty()


async def test_foxglove_is_offered_a_type_that_only_the_publisher_knows(
    hub: HubServer, start_peer: StartPeer
) -> None:
    talker = await start_peer("/talker")
    await talker.advertise("/mine", VALUES)
    async with foxglove(hub) as studio:
        await talker.linked()
        await studio.channel("/mine")
        assert studio.channels["/mine"]["schema"] == VALUES["message_definition"]
        await until(lambda: not hub.graph.topics["/mine"].sinks())


async def test_link_is_closed_some_time_after_the_last_client_has_left(
    start_peer: StartPeer, node: fibws.Node, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(topics, "LINGER", 0.01)
    talker = await start_peer("/talker")
    await talker.advertise("/count")
    first, second = node.subscribe("/count", Int32), node.subscribe("/count", Int32)
    link = await talker.linked()
    first.close()
    link.send(int32(1))
    await anext(second)
    second.close()
    assert await link.ended() == b""


async def test_link_is_named_after_the_only_subscriber(
    start_peer: StartPeer, node: fibws.Node
) -> None:
    talker = await start_peer("/talker")
    await talker.advertise("/count")
    node.subscribe("/count", Int32)
    assert (await talker.linked()).header["callerid"] == "/client"


async def test_link_for_goals_is_named_after_the_actions_server(
    hub: HubServer, start_peer: StartPeer, node: fibws.Node
) -> None:
    caller = await start_peer("/caller")
    await caller.advertise("/act/goal")
    async with fibws.Node("page", hub=hub.url) as page:
        page.subscribe("/act/goal", Int32)
        assert (await caller.linked()).header["callerid"] == "/page"
        node.subscribe("/act/goal", Int32)
        await node.flush()
        await node.advertise("/act/status", GoalStatusArray)
        assert (await caller.linked()).header["callerid"] == "/client"


async def test_publisher_is_among_the_peers_while_it_is_linked(
    start_peer: StartPeer, node: fibws.Node
) -> None:
    talker = await start_peer("/talker")
    talker.answers["requestTopic"] = [0, "not yet", 0]
    await talker.advertise("/count")
    messages = node.subscribe("/count", Int32, peers=True)
    peers = messages.peers.changes()
    await talker.called("requestTopic")
    assert await anext(peers) == []
    del talker.answers["requestTopic"]
    link = await talker.linked()
    assert await anext(peers) == ["/talker"]
    link.close()
    assert await anext(peers) == []
    await talker.linked()
    assert await anext(peers) == ["/talker"]


class Observer(Recorder):
    """A subscriber within the hub, which waits for messages."""

    def __init__(self) -> None:
        super().__init__()
        self._came: asyncio.Queue[Publication] = asyncio.Queue()

    def receive(self, publication: Publication) -> None:
        self._came.put_nowait(publication)

    async def next(self) -> Publication:
        async with asyncio.timeout(60):
            return await self._came.get()


@pytest.fixture
async def observe(hub: HubServer) -> AsyncIterator[Callable[[str], Observer]]:
    """Let an observer subscribe to a topic."""
    with ExitStack() as stack:

        def start(name: str) -> Observer:
            observer, topic = Observer(), hub.graph.topic(name)
            hub.graph.subscribe(topic, observer)
            stack.callback(hub.graph.unsubscribe, topic, observer)
            return observer

        yield start


async def test_bytes_and_the_number_of_a_header_are_not_changed(
    start_peer: StartPeer, observe: Callable[[str], Observer]
) -> None:
    observer = observe("/h")
    talker = await start_peer("/talker")
    await talker.advertise("/h", HEADER)
    link = await talker.linked()
    body = struct.pack("<III", 77, 4_000_000_000, 999_999_999) + struct.pack("<I", 2) + b"\xc3\x28"
    link.send(body)
    assert (await observer.next()).ros1() == body


async def test_definition_is_learned_from_the_publisher(
    start_peer: StartPeer, observe: Callable[[str], Observer]
) -> None:
    observer = observe("/mine")
    talker = await start_peer("/talker")
    await talker.advertise("/mine", VALUES)
    link = await talker.linked()
    body = struct.pack("<Iddd", 3, math.nan, math.inf, 0.1)
    link.send(body)
    publication = await observer.next()
    assert publication.values()["values"][1:] == [math.inf, 0.1]
    assert publication.ros1() == body
    assert publication.type.md5sum == VALUES["md5sum"]


async def test_latched_message_of_a_ros1_node_reaches_late_clients(
    start_peer: StartPeer, node: fibws.Node
) -> None:
    talker = await start_peer("/talker")
    await talker.advertise("/count", latching=True)
    first = node.subscribe("/count", Int32)
    (await talker.linked()).send(int32(7))
    assert (await anext(first)).data == 7
    assert (await anext(node.subscribe("/count", Int32))).data == 7


async def test_lost_link_is_opened_again(
    start_peer: StartPeer, node: fibws.Node, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(inlet, "FIRST_RETRY", 0.001)
    talker = await start_peer("/talker")
    await talker.advertise("/count")
    messages = node.subscribe("/count", Int32)
    for number in range(3):
        link = await talker.linked()
        link.send(int32(number))
        assert (await anext(messages)).data == number
        link.close()


async def test_invalid_messages_end_the_link_alone(
    start_peer: StartPeer,
    node: fibws.Node,
    monkeypatch: pytest.MonkeyPatch,
    caplog: pytest.LogCaptureFixture,
) -> None:
    monkeypatch.setattr(inlet, "FIRST_RETRY", 0.001)
    talker, other = await start_peer("/talker"), await start_peer("/other")
    await talker.advertise("/count")
    await other.advertise("/count")
    messages = node.subscribe("/count", Int32)
    sound = await other.linked()
    (await talker.linked()).write(struct.pack("<I", 2**32 - 1) + b"x")
    await talker.linked()
    sound.send(int32(5))
    assert (await anext(messages)).data == 5
    assert "4294967295" in caplog.text


async def test_publisher_of_another_type_is_listed_as_a_conflict(
    hub: HubServer, start_peer: StartPeer, node: fibws.Node
) -> None:
    publisher = await node.advertise("/count", String, peers=True)
    talker = await start_peer("/talker")
    await talker.advertise("/count")
    [conflict] = hub.graph.view("/x").conflicts(hub.graph.topics["/count"])
    assert (conflict.node, conflict.type, conflict.publishes) == ("/talker", "std_msgs/Int32", True)
    publisher.close()
    await node.flush()
    messages = node.subscribe("/count", Int32)
    (await talker.linked()).send(int32(3))
    assert (await anext(messages)).data == 3
    assert hub.graph.view("/x").conflicts(hub.graph.topics["/count"]) == []


async def test_conflict_is_logged_once(
    start_hub: StartHub, caplog: pytest.LogCaptureFixture
) -> None:
    hub = await start_hub(ros1=0, strict_types=True)
    assert hub.ros1 is not None
    async with Peer("/talker", hub.ros1.uri) as talker, Peer("/other", hub.ros1.uri) as other:
        await talker.advertise("/values", VALUES)
        for type_ in ("*", "my_msgs/Values"):
            await other.subscribe("/values", type_)
            await other.call("getPid")
        conflicts = [
            each.node for each in hub.graph.view("/x").conflicts(hub.graph.topics["/values"])
        ]
        assert sorted(conflicts) == ["/other", "/talker"]
    assert caplog.text.count("/talker exchanges no messages on /values") == 1


# To ROS 1 nodes.


async def listening(peer: Peer, topic: str, **fields: str) -> Link:
    await peer.subscribe(topic, fields.get("type", "*"))
    return await peer.connect(topic, **fields)


async def test_message_of_a_client_reaches_a_ros1_node(
    start_peer: StartPeer, node: fibws.Node
) -> None:
    publisher = await node.advertise("/count", Int32, peers=True)
    listener = await start_peer("/listener")
    link = await listening(listener, "/count", type="std_msgs/Int32", md5sum=MD5_OF_INT32)
    fields = {key: link.header[key] for key in ("type", "md5sum", "callerid", "latching")}
    assert fields == {
        "type": "std_msgs/Int32",
        "md5sum": MD5_OF_INT32,
        "callerid": "/client",
        "latching": "0",
    }
    await until_linked(publisher, "/listener")
    await publisher.publish(5)
    assert await link.receive() == int32(5)


async def test_subscriber_is_told_of_publishers_once_for_all_clients(
    hub: HubServer, start_peer: StartPeer, node: fibws.Node
) -> None:
    listener = await start_peer("/listener")
    assert await listener.subscribe("/count") == []
    await node.advertise("/count", Int32)
    topic, apis = await listener.called("publisherUpdate")
    assert topic == "/count"
    async with fibws.Node("second", hub=hub.url) as second:
        await second.advertise("/count", Int32)
        talker = await start_peer("/talker")
        await talker.advertise("/count")
        _, both = await listener.called("publisherUpdate")
        assert sorted(both) == sorted([*apis, talker.api])


async def test_latched_messages_of_all_clients_are_sent_first(
    hub: HubServer, start_peer: StartPeer, node: fibws.Node
) -> None:
    async with fibws.Node("second", hub=hub.url) as second:
        for number, each in enumerate((node, second)):
            await (await each.advertise("/count", Int32, latch=True)).publish(number)
            await each.flush()
        link = await listening(await start_peer("/listener"), "/count")
        assert link.header["latching"] == "1"
        assert link.header["callerid"] not in ("/client", "/second")
        assert [await link.receive(), await link.receive()] == [int32(0), int32(1)]


async def test_messages_of_ros1_nodes_are_not_sent_back_to_ros1_nodes(
    start_peer: StartPeer, node: fibws.Node
) -> None:
    publisher = await node.advertise("/count", Int32, peers=True)
    messages = node.subscribe("/count", Int32)
    talker, listener = await start_peer("/talker"), await start_peer("/listener")
    await talker.advertise("/count")
    link = await listening(listener, "/count")
    (await talker.linked()).send(int32(1))
    assert (await anext(messages)).data == 1
    await until_linked(publisher, "/client", "/listener")
    await publisher.publish(2)
    assert await link.receive() == int32(2)


@pytest.mark.parametrize(
    ("fields", "facts"),
    [
        (
            {"type": "std_msgs/Float64", "md5sum": "fdb28210bfa9d7c91146260178d9a584"},
            ["std_msgs/Float64", "std_msgs/Int32"],
        ),
        ({"type": "std_msgs/Int32", "md5sum": "0" * 32}, ["datatype/md5sum", "0" * 32]),
        ({"md5sum": ""}, ["do not match"]),
    ],
)
async def test_subscriber_of_another_type_is_told_so(
    start_peer: StartPeer, node: fibws.Node, fields: dict[str, str], facts: list[str]
) -> None:
    await node.advertise("/count", Int32)
    listener = await start_peer("/listener")
    await listener.subscribe("/count", "*")
    link = await listener.connect("/count", **fields)
    assert all(fact in link.header["error"] for fact in facts)
    assert await link.ended() == b""


async def test_unknown_topic_and_other_transports_are_refused(
    start_peer: StartPeer, node: fibws.Node
) -> None:
    await node.advertise("/count", Int32)
    listener = await start_peer("/listener")
    udp = ["UDPROS", b"", "localhost", 1, 1500]
    assert (await listener.ask("requestTopic", "/none", [["TCPROS"]]))[0] == -1
    assert (await listener.ask("requestTopic", "/count", [udp]))[::2] == [0, []]
    assert (await listener.ask("requestTopic", "/count", [udp, ["TCPROS"]]))[0] == 1


async def test_message_for_one_node_reaches_only_its_link(
    start_peer: StartPeer, node: fibws.Node
) -> None:
    publisher = await node.advertise("/count", Int32, peers=True)
    links = [await listening(await start_peer(name), "/count") for name in ("/a", "/b")]
    await until_linked(publisher, "/a", "/b")
    publisher._send(publisher._encode_to("/b", 1))
    await publisher.publish(2)
    assert await links[1].receive() == int32(1)
    assert [await link.receive() for link in links] == [int32(2), int32(2)]


async def test_slow_subscriber_loses_its_oldest_messages_and_nobody_elses(
    hub: HubServer, start_peer: StartPeer, node: fibws.Node
) -> None:
    publisher = await node.advertise("/image", Image, peers=True)
    slow, quick = await start_peer("/slow"), await start_peer("/quick")
    slow_link, link = await listening(slow, "/image"), await listening(quick, "/image")
    await until_linked(publisher, "/quick", "/slow")
    data = bytes(1_000_000)
    for number in range(150):
        await publisher.publish(height=number, data=data)
        assert (await link.receive())[16:20] == struct.pack("<I", number)
    received = [await slow_link.receive()]
    while received[-1][16:20] != struct.pack("<I", 149):
        received.append(await slow_link.receive())
    assert len(received) < 150


async def test_links_end_with_the_publishers(start_peer: StartPeer, node: fibws.Node) -> None:
    publisher = await node.advertise("/count", Int32)
    listener = await start_peer("/listener")
    link = await listening(listener, "/count")
    publisher.close()
    assert await link.ended() == b""
    topic, apis = await listener.called("publisherUpdate")
    assert (topic, apis) == ("/count", [])


async def test_bus_info_names_both_directions(start_peer: StartPeer, node: fibws.Node) -> None:
    await node.advertise("/out", Int32)
    peer = await start_peer("/peer")
    await listening(peer, "/out")
    await peer.advertise("/in")
    messages = node.subscribe("/in", Int32)
    (await peer.linked()).send(int32(1))
    await anext(messages)
    links = await peer.call("getBusInfo")
    assert sorted((other, way, topic) for _, other, way, _, topic, *_ in links) == [
        ("/peer", "o", "/out"),
        (peer.api, "i", "/in"),
    ]
