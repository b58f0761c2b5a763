"""Clients that watch the nodes at the other side of a topic."""

from __future__ import annotations

import random
from typing import Any

import pytest
from random_inputs import times

from fibws.hub.graph.peers import MOST_REQUESTS

from ..fakes import INT32, Client, FakeHub, number

SIDES = {"advertise": "subscribe", "subscribe": "advertise"}
"""For each operation, the one whose nodes are its peers."""


def connect_watcher(hub: FakeHub, op: str, node: str = "/asking", **fields: Any) -> Client:
    client = hub.client(node)
    client.send(op, "/a", type=INT32, **{"id": "asked", "peers": True, **fields})
    return client


def connect_node(hub: FakeHub, op: str, node: str, topic: str = "/a") -> Client:
    client = hub.client(node)
    client.send(op, topic, type=INT32)
    return client


def received_peers(client: Client) -> list[list[str]]:
    """Return the peers lists that came since the last call; nothing else may have come."""
    received = client.receive()
    assert all(each.keys() == {"op", "id", "topic", "nodes"} for each in received), received
    return [each["nodes"] for each in received]


@pytest.mark.parametrize(("op", "other"), SIDES.items())
def test_peers_come_at_once_with_the_requests_id_and_spelling(op: str, other: str) -> None:
    hub = FakeHub()
    connect_node(hub, other, "/b")
    client = hub.client()
    client.send(op, "a", type=INT32, id=5, peers=True)
    assert client.receive() == [{"op": "peers", "id": 5, "topic": "a", "nodes": ["/b"]}]
    client.send(op, "/a", type=INT32, peers=True)
    assert client.receive() == [{"op": "peers", "topic": "/a", "nodes": ["/b"]}]


@pytest.mark.parametrize("peers", [None, False])
@pytest.mark.parametrize(("op", "other"), SIDES.items())
def test_peers_are_not_sent_unless_requested(op: str, other: str, peers: bool | None) -> None:
    hub = FakeHub()
    client = connect_watcher(hub, op, peers=peers)
    connect_node(hub, other, "/b").disconnect()
    assert client.receive() == []


@pytest.mark.parametrize(("op", "other"), SIDES.items())
def test_each_change_of_the_peers_is_sent(op: str, other: str) -> None:
    hub = FakeHub()
    client = connect_watcher(hub, op)
    assert received_peers(client) == [[]]
    second = connect_node(hub, other, "/b2")
    assert received_peers(client) == [["/b2"]]
    first = connect_node(hub, other, "/b1")
    assert received_peers(client) == [["/b1", "/b2"]]
    connect_node(hub, op, "/of the same side")
    connect_node(hub, other, "/elsewhere", "/other")
    assert received_peers(client) == []
    first.disconnect()
    assert received_peers(client) == [["/b2"]]
    second.send(f"un{other}", "/a")
    assert received_peers(client) == [[]]


def test_subscriber_knows_a_publisher_before_its_first_message() -> None:
    hub = FakeHub()
    client = connect_watcher(hub, "subscribe")
    connect_node(hub, "advertise", "/b").send("publish", "/a", msg=number(1))
    client.receive()
    connect_node(hub, "advertise", "/c").send("publish", "/a", msg=number(2))
    peers, message = client.receive()
    assert (peers["op"], peers["nodes"]) == ("peers", ["/b", "/c"])
    assert message["msg"] == number(2)


@pytest.mark.parametrize(("op", "other"), SIDES.items())
def test_client_that_supports_changes_receives_them(op: str, other: str) -> None:
    hub = FakeHub()
    third = connect_node(hub, other, "/b3")
    client = connect_watcher(hub, op, peer_changes=True)
    report = {"op": "peers", "id": "asked"}
    assert client.receive() == [{**report, "topic": "/a", "nodes": ["/b3"]}]
    first, _ = connect_node(hub, other, "/b1"), connect_node(hub, other, "/b2")
    assert client.receive() == [{**report, "added": ["/b1", "/b2"]}]
    first.disconnect()
    third.disconnect()
    assert client.receive() == [{**report, "removed": ["/b1", "/b3"]}]
    connect_node(hub, other, "/b2")
    assert client.receive() == [{**report, "removed": ["/b2"], "added": ["/b2"]}]
    client.disconnect()
    client = connect_watcher(hub, op, id=None, peer_changes=True)
    connect_node(hub, other, "/b3")
    assert [(each["topic"], "id" in each) for each in client.receive()] == [("/a", False)] * 2


@pytest.mark.parametrize(("op", "other"), SIDES.items())
def test_changes_of_one_turn_are_one_report(op: str, other: str) -> None:
    hub = FakeHub()
    whole, changes = (
        connect_watcher(hub, op, "/whole"),
        connect_watcher(hub, op, "/changes", peer_changes=True),
    )
    for client in (whole, changes):
        client.receive()
    nodes = [f"/b{number}" for number in range(10)]
    passing = connect_node(hub, other, "/passing")
    for node in nodes:
        connect_node(hub, other, node)
    passing.disconnect()
    assert received_peers(whole) == [nodes]
    assert changes.receive_one("peers")["added"] == nodes


@pytest.mark.parametrize(("seconds", "megabytes"), [(0.02, 14), (1, 20)])
@pytest.mark.long
def test_four_hundred_nodes_on_tf_take_less_than_20_megabytes(
    seconds: float, megabytes: int
) -> None:
    hub, size = FakeHub(), 0
    clients: list[Client] = []
    for count in range(400):
        client = hub.client(f"/robot_{count}/robot_state_publisher")
        clients.append(client)
        for op in SIDES:
            client.send(op, "/tf", type=INT32, id=f"{op}:/tf:1", peers=True, peer_changes=True)
            hub.clock.turn()
            hub.clock.advance(seconds / 2)
            hub.clock.turn()
        for each in clients:
            size += sum(map(len, each.writes))
            each.writes.clear()
    assert size < megabytes * 1_000_000


@pytest.mark.parametrize(("op", "other"), SIDES.items())
def test_many_watchers_receive_several_changes_at_once(op: str, other: str) -> None:
    hub = FakeHub()
    watchers = [connect_watcher(hub, op, f"/n{count}", peer_changes=True) for count in range(400)]
    for watcher in watchers:
        watcher.receive()
    for name in ("/b1", "/b2", "/b3"):
        connect_node(hub, other, name)
        hub.clock.turn()
        hub.clock.advance(0.03)
    hub.clock.advance(0.03)
    for watcher in watchers:
        assert watcher.receive_one("peers")["added"] == ["/b1", "/b2", "/b3"]


def test_many_subscribers_learn_of_a_publisher_before_its_messages() -> None:
    hub = FakeHub()
    watchers = [
        connect_watcher(hub, "subscribe", f"/n{count}", peer_changes=True) for count in range(100)
    ]
    for watcher in watchers:
        watcher.receive()
    connect_node(hub, "advertise", "/b").send("publish", "/a", msg=number(1))
    hub.clock.advance(1)
    for watcher in watchers:
        assert [each.get("added") for each in watcher.receive()] == [["/b"], None]


@pytest.mark.parametrize(("op", "other"), SIDES.items())
def test_node_is_listed_once_while_it_has_any_registration(op: str, other: str) -> None:
    hub = FakeHub()
    client = connect_watcher(hub, op)
    node = hub.client("/b")
    registrations = [("/a", 1), ("/a", 2), ("a", 3), ("a", 4)]
    for spelling, id_ in registrations:
        node.send(other, spelling, type=INT32, id=id_)
    for spelling, id_ in registrations:
        assert received_peers(client)[-1:] in ([], [["/b"]])
        node.send(f"un{other}", spelling, id=id_)
    assert received_peers(client) == [[]]


@pytest.mark.parametrize(("op", "other"), SIDES.items())
def test_replaced_node_is_removed_before_the_newer_is_added(op: str, other: str) -> None:
    hub = FakeHub()
    client = connect_watcher(hub, op)
    connect_node(hub, other, "/b")
    assert received_peers(client) == [[], ["/b"]]
    connect_node(hub, other, "/b")
    assert received_peers(client) == [[], ["/b"]]


@pytest.mark.parametrize(("op", "other"), SIDES.items())
def test_node_may_be_its_own_peer(op: str, other: str) -> None:
    hub = FakeHub()
    client = connect_watcher(hub, op)
    client.send(other, "/a", type=INT32, peers=True, id="other")
    assert [(each["id"], each["nodes"]) for each in client.receive()] == [
        ("asked", []),
        ("other", ["/asking"]),
        ("asked", ["/asking"]),
    ]
    client.disconnect()
    assert hub.empty


@pytest.mark.parametrize(("op", "other"), SIDES.items())
def test_requests_end_by_their_ids(op: str, other: str) -> None:
    hub = FakeHub()
    client = connect_watcher(hub, op, id=1)
    for id_ in (2, 3):
        client.send(op, "/a", type=INT32, id=id_, peers=True)
    client.send(op, "/a", type=INT32, id=4)
    client.receive()
    client.send(f"un{op}", "/a", id=1)
    client.send(op, "/a", type=INT32, id=3)  # without peers
    connect_node(hub, other, "/b")
    assert [each["id"] for each in client.receive()] == [2]
    client.send(f"un{op}", "/a")
    connect_node(hub, other, "/c")
    assert client.receive() == []


@pytest.mark.parametrize(("op", "other"), SIDES.items())
def test_clients_that_left_or_were_refused_get_no_peers(op: str, other: str) -> None:
    hub = FakeHub()
    client, refused = connect_watcher(hub, op), hub.client()
    refused.send(op, "/a", type="std_msgs/Strin", peers=True)
    assert len(refused.receive_statuses()) == 1
    client.disconnect()
    client.receive()
    connect_node(hub, other, "/b")
    assert client.receive() == refused.receive() == []


def test_publisher_learns_of_a_subscriber_that_gets_its_messages() -> None:
    hub = FakeHub()
    talker = connect_watcher(hub, "advertise", "/talker")
    received_peers(talker)
    listener = connect_node(hub, "subscribe", "/listener")
    [nodes] = received_peers(talker)
    talker.send("publish", "/a", msg=number(1), to=nodes[0])
    assert listener.receive_numbers("/a") == [1]


def test_subscriber_learns_of_a_publisher_before_its_messages() -> None:
    hub = FakeHub()
    talker = hub.client("/talker")
    talker.send("advertise", "/a", type=INT32, latch=True)
    talker.send("publish", "/a", msg=number(1))
    late, early = (
        connect_watcher(hub, "subscribe", "/late"),
        connect_watcher(hub, "subscribe", "/early", id="early"),
    )
    other = connect_node(hub, "advertise", "/other")
    other.send("publish", "/a", msg=number(2))
    for client in (late, early):
        assert [each["op"] for each in client.receive()] == ["peers", "publish", "peers", "publish"]


def test_publisher_without_advertise_is_a_peer() -> None:
    hub = FakeHub()
    client = connect_watcher(hub, "subscribe")
    hub.client("/b").send("publish", "/a", msg=number(1))
    assert [each.get("nodes") for each in client.receive()] == [[], ["/b"], None]


def test_subscriber_learns_of_a_publisher_before_its_message_for_one_node() -> None:
    hub = FakeHub()
    client = connect_watcher(hub, "subscribe", peer_changes=True)
    talker = hub.client("/talker")
    talker.send("advertise", "/a", type=INT32)
    talker.send("publish", "/a", msg=number(1), to="/asking")
    assert [each.get("added") for each in client.receive()] == [None, ["/talker"], None]


def test_slow_client_gets_one_change_or_only_the_newest_peers() -> None:
    hub = FakeHub(max_queued_bytes=1000)
    client = connect_watcher(hub, "advertise", peer_changes=True)
    client.receive()
    for many in (False, True):
        client.queue.pause()
        others = [
            connect_node(hub, "subscribe", f"/b{name % 7}") for name in range(500 if many else 10)
        ]
        assert client.queue.kept_bytes == 0
        client.queue.resume()
        nodes = [f"/b{name}" for name in range(7)]
        report = client.receive_one("peers")
        assert report.get("nodes" if many else "added") == nodes
        for other in others:
            other.disconnect()
        assert client.receive_one("peers")["removed"] == nodes


def test_slow_client_gets_only_the_newest_peers() -> None:
    hub = FakeHub(max_queued_bytes=1000)
    client = connect_watcher(hub, "advertise")
    client.send("advertise", "/a", type=INT32, peers=True, id="again")
    client.receive()
    client.queue.pause()
    for name in range(100):
        connect_node(hub, "subscribe", f"/b{name % 7}")
    assert not client.queue.overfull
    client.queue.resume()
    assert [(each["id"], len(each["nodes"])) for each in client.receive()] == [
        ("asked", 7),
        ("again", 7),
    ]


@pytest.mark.parametrize("seed", range(times(0.1)))
def test_peers_are_right_after_random_changes(seed: int) -> None:
    chance = random.Random(seed)
    hub = FakeHub()
    publisher, subscriber = (
        connect_watcher(hub, "advertise", "/p"),
        connect_watcher(hub, "subscribe", "/s"),
    )
    others: dict[str, Client] = {}
    reported: dict[Client, list[str]] = {}
    for _ in range(300):
        name = f"/n{chance.randrange(4)}"
        spelling = chance.choice(["/a", "a", "/other"])
        if name not in others or chance.random() < 0.1:
            others[name] = hub.client(name)
        other = others[name]
        match chance.randrange(6):
            case 0:
                other.disconnect()
                del others[name]
            case 1 | 2:
                op = chance.choice(["advertise", "subscribe"])
                other.send(op, spelling, type=INT32, id=chance.randrange(2))
            case _:
                op = chance.choice(["unadvertise", "unsubscribe"])
                other.send(op, spelling, id=chance.choice([0, 1, None]))
        topic = hub.graph.topics["/a"]
        for client in (publisher, subscriber):
            for nodes in received_peers(client):
                assert nodes != reported.get(client)
                reported[client] = nodes
        assert reported[publisher] == sorted(topic.subscribers())
        assert reported[subscriber] == sorted(topic.sources)


@pytest.mark.parametrize("op", SIDES)
def test_number_of_peers_requests_is_limited(op: str) -> None:
    hub = FakeHub()
    client = hub.client("/asking")
    for count in range(MOST_REQUESTS):
        client.send(op, "/a", type=INT32, id=count, peers=True)
    assert len(received_peers(client)) == MOST_REQUESTS
    client.send(op, "/a", type=INT32, id="too many", peers=True)
    (refused,) = client.receive()
    assert (refused["op"], refused["level"], refused["id"]) == ("status", "error", "too many")
    assert f"limit {MOST_REQUESTS}" in refused["msg"]
    client.send(op, "/a", type=INT32, id=3, peers=True)
    client.send(op, "/a", type=INT32, id="does not ask")
    assert received_peers(client) == [[]], "the limit does not count a renewed or unwatched request"
