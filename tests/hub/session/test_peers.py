"""Clients that ask who is at the other side of a topic."""

from __future__ import annotations

import random
from typing import Any

import pytest

from fibws.hub.graph.peers import MOST_REQUESTS

from ..fakes import INT32, STRING, Client, FakeHub, number

SIDES = {"advertise": "subscribe", "subscribe": "advertise"}
"""What an operation asks after, if it asks for peers."""


def asks(hub: FakeHub, op: str, node: str = "/asking", **fields: Any) -> Client:
    client = hub.client(node)
    client.says(op, "/a", type=INT32, **{"id": "asked", "peers": True, **fields})
    return client


def joins(hub: FakeHub, op: str, node: str, topic: str = "/a") -> Client:
    client = hub.client(node)
    client.says(op, topic, type=INT32)
    return client


def told(client: Client) -> list[list[str]]:
    """The nodes that a client was told of since this was last asked; nothing else has come."""
    heard = client.hears()
    assert all(each.keys() == {"op", "id", "topic", "nodes"} for each in heard), heard
    return [each["nodes"] for each in heard]


@pytest.mark.parametrize(("op", "other"), SIDES.items())
def test_who_asks_is_told_at_once_by_the_id_and_the_name_that_it_used(op: str, other: str) -> None:
    hub = FakeHub()
    joins(hub, other, "/b")
    client = hub.client()
    client.says(op, "a", type=INT32, id=5, peers=True)
    assert client.hears() == [{"op": "peers", "id": 5, "topic": "a", "nodes": ["/b"]}]
    client.says(op, "/a", type=INT32, peers=True)
    assert client.hears() == [{"op": "peers", "topic": "/a", "nodes": ["/b"]}]


@pytest.mark.parametrize("peers", [None, False])
@pytest.mark.parametrize(("op", "other"), SIDES.items())
def test_who_does_not_ask_is_told_nothing(op: str, other: str, peers: bool | None) -> None:
    hub = FakeHub()
    client = asks(hub, op, peers=peers)
    joins(hub, other, "/b").leaves()
    assert client.hears() == []


@pytest.mark.parametrize(("op", "other"), SIDES.items())
def test_who_asks_is_told_of_each_change(op: str, other: str) -> None:
    hub = FakeHub()
    client = asks(hub, op)
    assert told(client) == [[]]
    second = joins(hub, other, "/b2")
    first = joins(hub, other, "/b1")
    joins(hub, op, "/of the same side")
    joins(hub, other, "/elsewhere", "/other")
    first.leaves()
    second.says(f"un{other}", "/a")
    assert told(client) == [["/b2"], ["/b1", "/b2"], ["/b2"], []]


@pytest.mark.parametrize(("op", "other"), SIDES.items())
def test_a_node_is_there_once_and_while_anything_of_it_is(op: str, other: str) -> None:
    hub = FakeHub()
    client = asks(hub, op)
    node = hub.client("/b")
    registrations = [("/a", 1), ("/a", 2), ("a", 3), ("a", 4)]
    for spelling, id_ in registrations:
        node.says(other, spelling, type=INT32, id=id_)
    for spelling, id_ in registrations:
        assert told(client)[-1:] in ([], [["/b"]])
        node.says(f"un{other}", spelling, id=id_)
    assert told(client) == [[]]


@pytest.mark.parametrize(("op", "other"), SIDES.items())
def test_a_node_whose_name_is_taken_goes_before_the_newer_comes(op: str, other: str) -> None:
    hub = FakeHub()
    client = asks(hub, op)
    joins(hub, other, "/b")
    joins(hub, other, "/b")
    assert told(client) == [[], ["/b"], [], ["/b"]]


@pytest.mark.parametrize(("op", "other"), SIDES.items())
def test_a_node_may_be_its_own_peer(op: str, other: str) -> None:
    hub = FakeHub()
    client = asks(hub, op)
    client.says(other, "/a", type=INT32, peers=True, id="other")
    assert [(each["id"], each["nodes"]) for each in client.hears()] == [
        ("asked", []),
        ("asked", ["/asking"]),
        ("other", ["/asking"]),
    ]
    client.leaves()
    assert hub.empty


@pytest.mark.parametrize(("op", "other"), SIDES.items())
def test_requests_end_by_their_ids(op: str, other: str) -> None:
    hub = FakeHub()
    client = asks(hub, op, id=1)
    for id_ in (2, 3):
        client.says(op, "/a", type=INT32, id=id_, peers=True)
    client.says(op, "/a", type=INT32, id=4)
    client.hears()
    client.says(f"un{op}", "/a", id=1)
    client.says(op, "/a", type=INT32, id=3)  # which asks no more
    joins(hub, other, "/b")
    assert [each["id"] for each in client.hears()] == [2]
    client.says(f"un{op}", "/a")
    joins(hub, other, "/c")
    assert client.hears() == []


@pytest.mark.parametrize(("op", "other"), SIDES.items())
def test_who_has_left_or_is_refused_is_told_nothing(op: str, other: str) -> None:
    hub = FakeHub()
    client, refused = asks(hub, op), hub.client()
    refused.says(op, "/a", type=STRING, peers=True)
    assert len(refused.hears_statuses()) == 1
    client.leaves()
    client.hears()
    joins(hub, other, "/b")
    assert client.hears() == refused.hears() == []


def test_a_publisher_hears_of_a_subscriber_that_hears_it() -> None:
    hub = FakeHub()
    talker = asks(hub, "advertise", "/talker")
    told(talker)
    listener = joins(hub, "subscribe", "/listener")
    [nodes] = told(talker)
    talker.says("publish", "/a", msg=number(1), to=nodes[0])
    assert listener.hears_numbers("/a") == [1]


def test_a_subscriber_hears_of_a_publisher_before_its_messages() -> None:
    hub = FakeHub()
    talker = hub.client("/talker")
    talker.says("advertise", "/a", type=INT32, latch=True)
    talker.says("publish", "/a", msg=number(1))
    late, early = asks(hub, "subscribe", "/late"), asks(hub, "subscribe", "/early", id="early")
    other = joins(hub, "advertise", "/other")
    other.says("publish", "/a", msg=number(2))
    for client in (late, early):
        assert [each["op"] for each in client.hears()] == ["peers", "publish", "peers", "publish"]


def test_a_publisher_that_only_publishes_is_a_peer_as_well() -> None:
    hub = FakeHub()
    client = asks(hub, "subscribe")
    hub.client("/b").says("publish", "/a", msg=number(1))
    assert [each.get("nodes") for each in client.hears()] == [[], ["/b"], None]


def test_a_slow_client_is_told_of_the_newest_alone() -> None:
    hub = FakeHub(max_queued_bytes=1000)
    client = asks(hub, "advertise")
    client.says("advertise", "/a", type=INT32, peers=True, id="again")
    client.hears()
    client.outbox.pause()
    for name in range(100):
        joins(hub, "subscribe", f"/b{name % 7}")
    assert not client.outbox.overfull
    client.outbox.resume()
    assert [(each["id"], len(each["nodes"])) for each in client.hears()] == [
        ("asked", 7),
        ("again", 7),
    ]


@pytest.mark.parametrize("seed", range(20))
def test_whatever_happens_who_asks_knows_who_is_there(seed: int) -> None:
    chance = random.Random(seed)
    hub = FakeHub()
    publisher, subscriber = asks(hub, "advertise", "/p"), asks(hub, "subscribe", "/s")
    others: dict[str, Client] = {}
    heard: dict[Client, list[str]] = {}
    for _ in range(300):
        name = f"/n{chance.randrange(4)}"
        spelling = chance.choice(["/a", "a", "/other"])
        if name not in others or chance.random() < 0.1:
            others[name] = hub.client(name)
        other = others[name]
        match chance.randrange(6):
            case 0:
                other.leaves()
                del others[name]
            case 1 | 2:
                op = chance.choice(["advertise", "subscribe"])
                other.says(op, spelling, type=INT32, id=chance.randrange(2))
            case _:
                op = chance.choice(["unadvertise", "unsubscribe"])
                other.says(op, spelling, id=chance.choice([0, 1, None]))
        topic = hub.graph.topics["/a"]
        for client in (publisher, subscriber):
            for nodes in told(client):
                assert nodes != heard.get(client)
                heard[client] = nodes
        assert heard[publisher] == sorted({each.node for each in topic.subscriptions()})
        assert heard[subscriber] == sorted(topic.publishers)


@pytest.mark.parametrize("op", SIDES)
def test_one_topic_is_asked_after_by_so_many_requests_and_no_more(op: str) -> None:
    hub = FakeHub()
    client = hub.client("/asking")
    for count in range(MOST_REQUESTS):
        client.says(op, "/a", type=INT32, id=count, peers=True)
    assert len(told(client)) == MOST_REQUESTS
    client.says(op, "/a", type=INT32, id="too many", peers=True)
    (refused,) = client.hears()
    assert (refused["op"], refused["level"], refused["id"]) == ("status", "error", "too many")
    assert "10 requests for the peers of one topic are enough" in refused["msg"]
    client.says(op, "/a", type=INT32, id=3, peers=True)
    client.says(op, "/a", type=INT32, id="does not ask")
    assert told(client) == [[]], "the same one may ask again, others need not ask"
