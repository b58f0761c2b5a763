"""Peers: the nodes at the other end of a topic, read by those that watch them."""

from __future__ import annotations

import json
import random
from collections.abc import Callable

import pytest
from random_inputs import times

from fibws.hub.errors import LimitReached
from fibws.hub.graph.peers import MOST_CHANGES, MOST_REQUESTS, PeerWatch


class Topic:
    """The nodes at one end of a topic, and the watch over them."""

    def __init__(self) -> None:
        self.nodes: dict[str, None] = {}
        self.peers = PeerWatch(self.nodes)

    def join(self, *nodes: str) -> None:
        for node in nodes:
            self.nodes[node] = None
            self.peers.joined(node)

    def leave(self, *nodes: str) -> None:
        for node in nodes:
            del self.nodes[node]
            self.peers.left(node)

    def watched(self, owner: object = "/a", id_: str = "1", *, paused: bool = False) -> Watcher:
        watcher = Watcher(self.peers, paused=paused)
        self.peers.add(owner, id_, watcher)
        return watcher


class Watcher:
    """Records its input: lists of all nodes, or the nodes removed and added."""

    def __init__(self, peers: PeerWatch, *, paused: bool = False) -> None:
        self.paused = paused
        self.announced = 0
        self.received: list[object] = []
        self.nodes: set[str] = set()
        self._peers = peers

    def changed(self) -> None:
        self.announced += 1

    def report(self) -> None:
        news = None if self.paused else self._peers.read(self)
        if news is None:
            return
        nodes = json.loads(news.names)
        assert nodes == sorted(set(nodes))
        if news.changes is None:
            self.received.append(nodes)
            self.nodes = set(nodes)
        else:
            removed, added = map(json.loads, news.changes)
            assert self.nodes >= set(removed)
            self.nodes -= set(removed)
            assert self.nodes.isdisjoint(added)
            between = sorted(set(nodes) - set(removed)) if set(removed) & set(added) else None
            assert between == (news.names_between and json.loads(news.names_between))
            self.nodes |= set(added)
            self.received.append((removed, added))
        assert self.nodes == set(nodes)

    def read(self) -> list[object]:
        """Return the reports since the last call."""
        self.report()
        received, self.received = self.received, []
        return received


def test_watcher_gets_all_names_at_once_and_changes_later() -> None:
    topic = Topic()
    watcher = topic.watched()
    assert watcher.received == [[]]
    topic.join("/b")
    other = topic.watched("/other")
    topic.join("/c")
    assert watcher.read() == [[], ([], ["/b", "/c"])]
    assert other.read() == [["/b"], ([], ["/c"])]
    topic.leave("/b")
    assert watcher.read() == other.read() == [(["/b"], [])]
    assert watcher.read() == other.read() == []


def test_changes_are_announced_once_until_they_are_read() -> None:
    topic = Topic()
    watcher = topic.watched()
    topic.join("/a", "/b")
    topic.leave("/a")
    assert watcher.announced == 1
    watcher.read()
    topic.join("/c")
    assert watcher.announced == 2


def test_names_are_sorted() -> None:
    topic = Topic()
    topic.join("/c", "/a")
    watcher = topic.watched()
    topic.join("/e", "/d")
    topic.leave("/c", "/a")
    assert watcher.read() == [["/a", "/c"], (["/a", "/c"], ["/d", "/e"])]


def test_node_that_came_and_left_meanwhile_is_not_reported() -> None:
    topic = Topic()
    watcher = topic.watched()
    watcher.read()
    topic.join("/b")
    topic.leave("/b")
    assert watcher.read() == []


def test_node_that_left_and_came_back_is_removed_and_added() -> None:
    topic = Topic()
    topic.join("/b")
    watcher = topic.watched()
    topic.leave("/b")
    topic.join("/b")
    assert watcher.read() == [["/b"], (["/b"], ["/b"])]


def test_changes_without_a_watcher_are_not_reported_later() -> None:
    topic = Topic()
    topic.watched("/a")
    topic.peers.forget("/a")
    assert not topic.peers
    topic.join("/b")
    assert topic.watched().read() == [["/b"]]


def test_request_replaces_an_older_one_of_the_same_id() -> None:
    topic = Topic()
    older, newer = topic.watched(), topic.watched()
    topic.join("/b")
    topic.peers.report()
    assert (older.received, newer.received) == ([[]], [[], ([], ["/b"])])


def test_all_watchers_may_be_made_to_report() -> None:
    topic = Topic()
    slow, quick = topic.watched("/slow", paused=True), topic.watched("/quick")
    topic.join("/b")
    topic.peers.report()
    assert (slow.received, quick.received) == ([], [[], ([], ["/b"])])
    slow.paused = False
    topic.peers.report()
    assert slow.received == [["/b"]]
    assert len(quick.received) == 2


def test_slow_watcher_reads_all_changes_at_once_or_all_names() -> None:
    topic = Topic()
    topic.join("/gone")
    slow, quick = topic.watched("/slow"), topic.watched("/quick")
    slow.read()
    topic.leave("/gone")
    for number in range(10):
        topic.join(f"/n{number}")
        quick.read()
    assert slow.read() == [(["/gone"], [f"/n{number}" for number in range(10)])]
    for _ in range(1000):
        topic.join("/restless")
        topic.leave("/restless")
        quick.read()
        assert len(topic.peers._changes) <= MOST_CHANGES
    assert slow.read() == [[f"/n{number}" for number in range(10)]]
    assert not topic.peers._changes


def test_requests_end_one_by_one_or_with_their_owner() -> None:
    steps: list[tuple[Callable[[PeerWatch], None], list[bool]]] = [
        (lambda peers: peers.cancel("/a", "2"), [True, False, True]),
        (lambda peers: peers.forget("/a"), [False, False, True]),
        (lambda peers: peers.cancel("/b", "1"), [False, False, False]),
    ]
    topic = Topic()
    watchers = [topic.watched(), topic.watched(id_="2"), topic.watched("/b")]
    for number, (step, expected) in enumerate(steps):
        topic.join(f"/before{number}")
        step(topic.peers)
        for watcher in watchers:
            watcher.received.clear()
        topic.join(f"/n{number}")
        topic.peers.report()
        assert [bool(watcher.received) for watcher in watchers] == expected
    assert not topic.peers
    assert not topic.peers._changes


def test_unknown_requests_and_owners_can_be_removed() -> None:
    topic = Topic()
    watcher = topic.watched()
    topic.peers.cancel("/b", "1")
    topic.peers.cancel("/a", "never")
    topic.peers.forget("/b")
    topic.join("/c")
    assert watcher.read() == [[], ([], ["/c"])]


def test_node_is_reported_only_while_it_is_linked() -> None:
    topic = Topic()
    topic.peers.unlinked("/a")
    topic.join("/a", "/b")
    watcher = topic.watched()
    assert watcher.received == [["/b"]]
    topic.peers.linked("/a")
    watcher.report()
    topic.peers.unlinked("/a")
    watcher.report()
    topic.leave("/a")
    watcher.report()
    topic.join("/a")
    watcher.report()
    assert watcher.received[1:] == [([], ["/a"]), (["/a"], []), ([], ["/a"])]


def test_requests_of_one_owner_are_limited() -> None:
    topic = Topic()
    for id_ in range(MOST_REQUESTS):
        topic.peers.check_room("/a", str(id_))
        topic.watched(id_=str(id_))
    with pytest.raises(LimitReached, match=str(MOST_REQUESTS)):
        topic.peers.check_room("/a", "another")
    topic.peers.check_room("/a", "1")
    topic.peers.check_room("/b", "another")


@pytest.mark.parametrize("seed", range(times(0.1)))
def test_watchers_know_the_nodes_whenever_they_read(seed: int) -> None:
    chance = random.Random(seed)
    topic = Topic()
    watchers: dict[str, Watcher] = {}
    for _ in range(1000):
        name = f"/n{chance.randrange(8)}"
        match chance.randrange(8):
            case 0:
                watchers[name] = topic.watched(name, paused=chance.random() < 0.3)
            case 1:
                topic.peers.forget(name)
                watchers.pop(name, None)
            case 2 if watchers:
                watcher = chance.choice([*watchers.values()])
                watcher.paused = False
                watcher.read()
                assert watcher.nodes == set(topic.nodes)
            case _ if name in topic.nodes:
                topic.leave(name)
            case _:
                topic.join(name)
