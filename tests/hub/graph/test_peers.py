"""Peer lists: the nodes at the other end of a topic, sent to those that watch it."""

from __future__ import annotations

import json
from collections.abc import Callable

import pytest

from fibws.errors import LimitReached
from fibws.hub.graph.peers import MOST_REQUESTS, PeerWatch


class Watcher:
    """Records the peer lists that it is sent."""

    def __init__(self) -> None:
        self.lists: list[list[str]] = []

    def tell(self, nodes: bytes) -> None:
        self.lists.append(json.loads(nodes))


def watching(peers: PeerWatch, *nodes: str, owner: object = "/a", id_: str = "1") -> Watcher:
    watcher = Watcher()
    peers.add(owner, id_, watcher.tell, nodes)
    return watcher


def test_a_watcher_gets_the_list_at_once_and_after_each_change() -> None:
    peers = PeerWatch()
    watcher = watching(peers)
    peers.changed(["/b"])
    other = watching(peers, "/b", owner="/other")
    peers.changed(["/c", "/b"])
    assert watcher.lists == [[], ["/b"], ["/b", "/c"]]
    assert other.lists == [["/b"], ["/b", "/c"]]


def test_names_are_sorted() -> None:
    peers = PeerWatch()
    watcher = watching(peers, "/c", "/a")
    peers.changed(["/b", "/c", "/a"])
    assert watcher.lists == [["/a", "/c"], ["/a", "/b", "/c"]]


def test_an_unchanged_list_is_not_sent_again() -> None:
    peers = PeerWatch()
    watcher = watching(peers, "/a", "/b")
    peers.changed(["/b", "/a"])
    assert watcher.lists == [["/a", "/b"]]


def test_changes_without_a_watcher_are_not_reported_later() -> None:
    peers = PeerWatch()
    watching(peers, "/a")
    peers.forget("/a")
    assert not peers
    watcher = watching(peers, "/b")
    peers.changed(["/b"])
    assert watcher.lists == [["/b"]]


def test_a_request_replaces_an_older_one_of_the_same_id() -> None:
    peers = PeerWatch()
    older, newer = watching(peers), watching(peers)
    peers.changed(["/b"])
    assert (older.lists, newer.lists) == ([[]], [[], ["/b"]])


def test_requests_end_one_by_one_or_with_their_owner() -> None:
    steps: list[tuple[Callable[[PeerWatch], None], list[bool]]] = [
        (lambda peers: peers.cancel("/a", "2"), [True, False, True]),
        (lambda peers: peers.forget("/a"), [False, False, True]),
        (lambda peers: peers.cancel("/b", "1"), [False, False, False]),
    ]
    peers = PeerWatch()
    watchers = [
        watching(peers),
        watching(peers, id_="2"),
        watching(peers, owner="/b"),
    ]
    for number, (step, expected) in enumerate(steps):
        step(peers)
        before = [len(watcher.lists) for watcher in watchers]
        peers.changed([str(number)])
        assert [
            len(watcher.lists) > size for watcher, size in zip(watchers, before, strict=True)
        ] == expected
    assert not peers


def test_unknown_requests_and_owners_can_be_removed() -> None:
    peers = PeerWatch()
    watcher = watching(peers)
    peers.cancel("/b", "1")
    peers.cancel("/a", "never")
    peers.forget("/b")
    peers.changed(["/c"])
    assert watcher.lists == [[], ["/c"]]


def test_requests_of_one_owner_are_limited() -> None:
    peers = PeerWatch()
    for id_ in range(MOST_REQUESTS):
        peers.check_room("/a", str(id_))
        watching(peers, id_=str(id_))
    with pytest.raises(LimitReached, match=str(MOST_REQUESTS)):
        peers.check_room("/a", "another")
    peers.check_room("/a", "1")
    peers.check_room("/b", "another")


def test_a_watcher_may_end_requests_while_it_gets_a_list() -> None:
    peers = PeerWatch()
    lists: list[bytes] = []

    def end_all(nodes: bytes) -> None:
        if nodes != b"[]":
            for owner in ("/a", "/b"):
                peers.forget(owner)

    peers.add("/c", "1", lists.append, [])
    peers.add("/a", "1", end_all, [])
    peers.add("/b", "1", lists.append, [])
    peers.changed(["/x"])
    peers.changed(["/y"])
    assert lists[-1] == b'["/y"]'
    assert lists.count(b'["/y"]') == 1
