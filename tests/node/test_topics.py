"""A node's publishers and subscriptions, as its hub knows them: without a socket."""

from __future__ import annotations

from typing import Any

import pytest

from fibws.errors import NodeClosed, NodeError, OperationRejected
from fibws.msg.std_msgs import Int32
from fibws.node.publisher import Publisher
from fibws.node.subscription import ReportedType, Subscription
from fibws.node.topics import NodeTopics
from fibws.node.types import ANY_TYPE, NodeTypes
from fibws.protocol.serialized import deliver_head

from .conftest import FakeSession, Lines, deliver, reconnected, sent_operations


@pytest.fixture
def topics(session: FakeSession) -> NodeTopics:
    return NodeTopics(session)


def advertise(topics: NodeTopics, topic: str, **options: Any) -> Publisher[Int32]:
    codec = NodeTypes(lambda: 0).codec(Int32)
    return topics.advertise(topic, codec, **{"queue_size": 10, **options})


def subscribe(topics: NodeTopics, topic: str, **options: Any) -> Subscription[Int32]:
    codec = NodeTypes(lambda: 0).codec(Int32)
    return topics.subscribe(topic, codec, **{"queue_size": 10, **options})


def names(operations: list[dict[str, Any]]) -> list[tuple[str, str]]:
    return [(each["op"], each["topic"]) for each in operations]


async def read(subscription: Subscription[Int32]) -> list[int]:
    return [message.data async for message in subscription]


def delivers(
    session: FakeSession, subscription: Subscription[Int32], number: int, header: bytes = b""
) -> None:
    """Let the session receive a serialized message."""
    if session.serialized:
        head = deliver_head(7, 0, header)
        session.receive_binary(head + number.to_bytes(4, "little"))
    else:
        deliver(session, "publish", topic=subscription.topic, msg={"data": number})


def subscribed(session: FakeSession, subscription: Subscription[Int32], topic_id: int = 7) -> None:
    """Connect the session with `fibws.v1` and deliver a topic's number."""
    session.serialized = True
    deliver(
        session,
        "subscribed",
        id=subscription._id,
        topic=subscription.topic,
        topic_id=topic_id,
        type="std_msgs/Int32",
        md5sum="da5909fbe378aeaf85e547e830cc1bb7",
    )


async def test_registrations_are_sent_and_taken_back(
    session: FakeSession, topics: NodeTopics
) -> None:
    publisher = advertise(topics, "/a")
    subscription = subscribe(topics, "/s")
    for _ in range(2):
        publisher.close()
        subscription.close()
    assert names(sent_operations(session)) == [
        ("advertise", "/a"),
        ("subscribe", "/s"),
        ("unadvertise", "/a"),
        ("unsubscribe", "/s"),
    ]
    assert topics.names() == []


async def test_registrations_made_without_a_hub_are_sent_to_the_next(
    session: FakeSession, topics: NodeTopics
) -> None:
    session.on_disconnect()
    advertise(topics, "/a")
    subscribe(topics, "/s")
    advertise(topics, "/gone").close()
    assert names(sent_operations(session)) == []
    session.reconnect()
    assert names(sent_operations(session)) == [("advertise", "/a"), ("subscribe", "/s")]


async def test_latched_messages_follow_registrations_unless_newer_ones_wait(
    session: FakeSession, topics: NodeTopics
) -> None:
    sent = advertise(topics, "/sent", latch=True)
    waiting = advertise(topics, "/waiting", latch=True)
    unlatched = advertise(topics, "/unlatched")
    advertise(topics, "/silent", latch=True)
    for each in (sent, waiting, unlatched):
        each._send(each._encode(1))
    sent_operations(session)
    session.on_disconnect()
    waiting._send(waiting._encode(2))
    session.connect(session.frames, serialized=False, hold=True)
    operations = session.frames.operations
    first = [operations.get_nowait() for _ in range(operations.qsize())]
    assert names(first)[4:] == [("publish", "/sent")]
    assert [(each["topic"], each["msg"]) for each in sent_operations(session)] == [
        ("/waiting", {"data": 2})
    ]


async def test_latched_message_is_sent_again_though_one_for_another_node_waits(
    session: FakeSession, topics: NodeTopics
) -> None:
    publisher = advertise(topics, "/a", latch=True)
    publisher._send(publisher._encode(1))
    sent_operations(session)
    session.on_disconnect()
    publisher._send(publisher._encode_to("/b", 2))
    session.reconnect()
    assert [each.get("to") for each in sent_operations(session)[1:]] == [None, "/b"]


@pytest.mark.parametrize("serialized", [True, False])
async def test_messages_reach_the_readers_of_their_topic(
    session: FakeSession, topics: NodeTopics, lines: Lines, serialized: bool
) -> None:
    first, second, other = (subscribe(topics, topic) for topic in ("/s", "/s", "/o"))
    if serialized:
        subscribed(session, first)
        subscribed(session, second)
        subscribed(session, other, 8)
        session.receive_binary(deliver_head(9, 0) + bytes(4))
    delivers(session, first, 1)
    deliver(session, "publish", topic="/late", msg=2)
    session.end()
    assert [await read(each) for each in (first, second, other)] == [[1], [1], []]
    assert lines.seen() == []


async def test_header_comes_with_its_message(session: FakeSession, topics: NodeTopics) -> None:
    subscription = subscribe(topics, "/s", headers=True)
    deliver(session, "publish", topic="/s", msg={"data": 1}, header={"callerid": "/a"})
    deliver(session, "publish", topic="/s", msg={"data": 2}, header="none")
    subscribed(session, subscription)
    delivers(session, subscription, 3, b'{"callerid":"/b"}')
    headers = []
    for _ in range(3):
        await anext(subscription)
        headers.append(subscription.connection_header)
    assert headers == [{"callerid": "/a"}, {}, {"callerid": "/b"}]


async def test_numbers_of_topics_are_forgotten_with_the_hub(
    session: FakeSession, topics: NodeTopics
) -> None:
    subscription = subscribe(topics, "/s")
    subscribed(session, subscription)
    session.on_disconnect()
    delivers(session, subscription, 1)
    session.end()
    assert await read(subscription) == []


@pytest.mark.parametrize("frame", [b"", b"\x01\x00", b"\x09" + bytes(20)])
async def test_invalid_frame_is_logged(
    session: FakeSession, topics: NodeTopics, lines: Lines, frame: bytes
) -> None:
    session.receive_binary(frame)
    (line,) = lines.seen()
    assert line.startswith("The hub sent an invalid binary frame: ")


async def test_subscription_may_be_closed_while_a_message_is_delivered(
    session: FakeSession, topics: NodeTopics
) -> None:
    received: list[tuple[str, int]] = []

    def take(message: Int32) -> None:
        received.append(("first", message.data))
        first.close()
        third.close()

    first = subscribe(topics, "/s", take=take)
    second = subscribe(topics, "/s", take=lambda message: received.append(("second", message.data)))
    third = subscribe(topics, "/s", take=lambda message: received.append(("third", message.data)))
    for number in (1, 2):
        deliver(session, "publish", topic="/s", msg={"data": number})
    assert received == [("first", 1), ("second", 1), ("second", 2)]
    second.close()
    assert topics.names() == []


async def test_refusal_ends_its_publisher_alone(session: FakeSession, topics: NodeTopics) -> None:
    refusals: list[NodeError] = []
    refused = advertise(topics, "/a", refused=refusals.append)
    other = advertise(topics, "/b", refused=refusals.append)
    deliver(session, "status", level="error", id=refused._id, msg="no")
    with pytest.raises(OperationRejected, match="no"):
        refused._send(refused._encode())
    other._send(other._encode())
    assert topics.names() == ["/b"]
    assert refusals == [refused.fault]


async def test_refusal_of_a_publisher_is_logged_unless_its_owner_is_called(
    session: FakeSession, topics: NodeTopics, lines: Lines
) -> None:
    refusals: list[NodeError] = []
    for refused in (None, refusals.append):
        publisher = advertise(topics, "/a", refused=refused)
        deliver(session, "status", level="error", id=publisher._id, msg="no room")
    assert lines.seen() == ["The hub refused the publisher of /a: no room"]


async def test_refusal_ends_its_subscription_alone(
    session: FakeSession, topics: NodeTopics
) -> None:
    refusals: list[OperationRejected] = []
    refused = subscribe(topics, "/a", refused=refusals.append)
    other = subscribe(topics, "/b")
    deliver(session, "status", level="error", id=refused._id, msg="no")
    deliver(session, "publish", topic="/b", msg={"data": 1})
    with pytest.raises(OperationRejected, match="no"):
        await anext(refused)
    assert await anext(other) == Int32(1)
    assert len(refusals) == 1


async def test_warning_about_a_registration_does_not_end_it(
    session: FakeSession, topics: NodeTopics
) -> None:
    publisher = advertise(topics, "/a")
    deliver(session, "status", level="warning", id=publisher._id, msg="hm")
    publisher._send(publisher._encode())


async def test_names_are_those_of_all_registrations(
    session: FakeSession, topics: NodeTopics
) -> None:
    refused = advertise(topics, "/b")
    closed = advertise(topics, "/c")
    subscription = subscribe(topics, "/a")
    assert topics.names() == ["/a", "/b", "/c"]
    deliver(session, "status", level="error", id=refused._id, msg="no")
    closed.close()
    assert topics.names() == ["/a"]
    subscription.close()
    assert topics.names() == []


async def test_nothing_is_registered_after_the_end(
    session: FakeSession, topics: NodeTopics
) -> None:
    session.end()
    assert topics.over
    for register in (advertise, subscribe):
        with pytest.raises(NodeClosed, match="the node has ended"):
            register(topics, "/a")


async def test_peers_are_reported_by_the_registrations_id(
    session: FakeSession, topics: NodeTopics
) -> None:
    first, second = advertise(topics, "/a", peers=True), advertise(topics, "/b", peers=True)
    subscription = subscribe(topics, "/a", peers=True)
    deliver(session, "peers", id=first._id, topic="/a", nodes=["/listener"])
    deliver(session, "peers", id=subscription._id, topic="/a", nodes=["/talker"])
    deliver(session, "peers", id="unknown", topic="/a", nodes=["/nobody"])
    deliver(session, "peers", id="unknown", added=["/nobody"])
    assert [each.peers.names for each in (first, second)] == [["/listener"], []]
    assert subscription.peers.names == ["/talker"]
    deliver(session, "peers", id=first._id, added=["/ear"])
    assert first.peers.names == ["/ear", "/listener"]
    deliver(session, "peers", id=first._id, removed=["/listener"])
    assert first.peers.names == ["/ear"]


@pytest.mark.parametrize("end", ["disconnect", "close", "refuse", "end"])
async def test_peers_are_forgotten(session: FakeSession, topics: NodeTopics, end: str) -> None:
    publisher, subscription = advertise(topics, "/a", peers=True), subscribe(topics, "/a")
    for id_ in (publisher._id, subscription._id):
        deliver(session, "peers", id=id_, topic="/a", nodes=["/b"])
    match end:
        case "disconnect":
            session.on_disconnect()
        case "close":
            publisher.close()
            subscription.close()
        case "refuse":
            for id_ in (publisher._id, subscription._id):
                deliver(session, "status", level="error", id=id_, msg="no")
        case "end":
            session.end()
    assert publisher.peers.names == subscription.peers.names == []


async def test_readers_get_a_turn_when_a_queue_is_full(
    session: FakeSession, topics: NodeTopics
) -> None:
    turns: list[int] = []
    session.connect(session.frames, serialized=False, end_turn=lambda: turns.append(len(sent)))
    subscription = subscribe(topics, "/a", queue_size=3)
    sent: list[int] = []
    for number in range(3):
        sent.append(number)
        delivers(session, subscription, number)
    assert turns == [3]
    subscribed(session, subscription)
    sent.append(3)
    delivers(session, subscription, 3)
    assert turns == [3, 4]


async def test_queue_size_is_sent_to_the_hub(session: FakeSession, topics: NodeTopics) -> None:
    subscribe(topics, "/a", queue_size=3)
    subscribe(topics, "/b", queue_size=None)
    assert [each["queue_length"] for each in sent_operations(session)] == [3, 10_000]


async def test_reconnection_repeats_registrations_with_their_ids(
    session: FakeSession, topics: NodeTopics
) -> None:
    ids = [advertise(topics, "/a")._id, subscribe(topics, "/s")._id]
    assert [each["id"] for each in reconnected(session)] == ids


async def test_subscription_gets_nothing_before_the_hub_has_answered_it(
    session: FakeSession, topics: NodeTopics
) -> None:
    """Another one of the node may hear the topic already: with no headers, or of no known type."""
    taken: list[tuple[int, bytes, str]] = []

    def take(message: memoryview, header: bytes, received: int, type_: ReportedType) -> None:
        taken.append((message[0], header, type_.name))

    first = subscribe(topics, "/s")
    subscribed(session, first)
    typed = subscribe(topics, "/s", headers=True)
    codec = NodeTypes(lambda: 0).serialized(ANY_TYPE, None, None)
    any_ = topics.subscribe("/s", codec, queue_size=None, headers=True, take_serialized=take)
    header = b'{"callerid":"/b"}'
    delivers(session, first, 1)
    delivers(session, first, 2, header)
    for each in (typed, any_):
        subscribed(session, each)
    delivers(session, first, 3)  # It waited in the hub when it was asked for headers.
    delivers(session, first, 4, header)
    session.end()
    assert await read(first) == [1, 2, 3, 4]
    assert await read(typed) == [4]
    assert taken == [(4, header, "std_msgs/Int32")]


async def test_messages_have_the_type_that_their_topic_had(
    session: FakeSession, topics: NodeTopics
) -> None:
    """A topic whose type has changed has another number; older messages may still arrive."""
    taken: list[str] = []
    codec = NodeTypes(lambda: 0).serialized(ANY_TYPE, None, None)
    any_ = topics.subscribe(
        "/s",
        codec,
        queue_size=None,
        headers=True,
        take_serialized=lambda message, header, received, type_: taken.append(type_.name),
    )
    subscribed(session, any_)
    fields = {"id": any_._id, "topic": "/s", "md5sum": "0" * 32}
    deliver(session, "subscribed", **fields, topic_id=8, type="std_msgs/UInt32")
    for number in (7, 8):
        session.receive_binary(deliver_head(number, 0, b"{}") + bytes(4))
    assert taken == ["std_msgs/Int32", "std_msgs/UInt32"]
    any_.close()
    session.receive_binary(deliver_head(7, 0, b"{}") + bytes(4))
    assert len(taken) == 2


async def test_number_that_went_to_another_topic_reaches_that_one_alone(
    session: FakeSession, topics: NodeTopics
) -> None:
    first, second = subscribe(topics, "/first"), subscribe(topics, "/second")
    subscribed(session, first)
    subscribed(session, second)
    first.close()
    delivers(session, second, 1)
    session.end()
    assert await read(second) == [1]
