"""Who is told of the nodes at the other side of a topic."""

from __future__ import annotations

import json
from collections.abc import Callable

from fibws.hub.graph.peers import Peers


class Ear:
    """Somebody who asks, and what is told."""

    def __init__(self) -> None:
        self.heard: list[list[str]] = []

    def tell(self, nodes: bytes) -> None:
        self.heard.append(json.loads(nodes))


def asking(peers: Peers, *nodes: str, owner: object = "/a", id_: str = "1") -> Ear:
    ear = Ear()
    peers.ask(owner, id_, ear.tell, nodes)
    return ear


def test_who_asks_is_told_at_once_and_of_each_change() -> None:
    peers = Peers()
    ear = asking(peers)
    peers.changed(["/b"])
    other = asking(peers, "/b", owner="/other")
    peers.changed(["/c", "/b"])
    assert ear.heard == [[], ["/b"], ["/b", "/c"]]
    assert other.heard == [["/b"], ["/b", "/c"]]


def test_names_are_sorted_and_each_there_once() -> None:
    peers = Peers()
    ear = asking(peers, "/c", "/a", "/c")
    peers.changed(["/b", "/c", "/b", "/a"])
    assert ear.heard == [["/a", "/c"], ["/a", "/b", "/c"]]


def test_the_same_nodes_are_no_news() -> None:
    peers = Peers()
    ear = asking(peers, "/a", "/b")
    peers.changed(["/b", "/a", "/b"])
    assert ear.heard == [["/a", "/b"]]


def test_what_changed_while_nobody_asked_is_not_taken_for_news() -> None:
    peers = Peers()
    asking(peers, "/a")
    peers.forget("/a")
    # Whoever reports passes it by then: it is false.
    assert not peers
    ear = asking(peers, "/b")
    peers.changed(["/b"])
    assert ear.heard == [["/b"]]


def test_a_request_of_the_same_id_replaces_the_older() -> None:
    peers = Peers()
    older, newer = asking(peers), asking(peers)
    peers.changed(["/b"])
    assert (older.heard, newer.heard) == ([[]], [[], ["/b"]])


def test_requests_end_one_by_one_or_with_their_owner() -> None:
    steps: list[tuple[Callable[[Peers], None], list[bool]]] = [
        (lambda peers: peers.cancel("/a", "2"), [True, False, True]),
        (lambda peers: peers.forget("/a"), [False, False, True]),
        (lambda peers: peers.cancel("/b", "1"), [False, False, False]),
    ]
    peers = Peers()
    ears = [
        asking(peers),
        asking(peers, id_="2"),
        asking(peers, owner="/b"),
    ]
    for number, (step, told) in enumerate(steps):
        step(peers)
        before = [len(ear.heard) for ear in ears]
        peers.changed([str(number)])
        assert [len(ear.heard) > size for ear, size in zip(ears, before, strict=True)] == told
    assert not peers


def test_who_never_asked_may_be_forgotten() -> None:
    peers = Peers()
    ear = asking(peers)
    peers.cancel("/b", "1")
    peers.cancel("/a", "never")
    peers.forget("/b")
    peers.changed(["/c"])
    assert ear.heard == [[], ["/c"]]
