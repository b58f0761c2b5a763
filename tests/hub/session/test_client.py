"""What the parts of a session know of their client."""

from __future__ import annotations

import json

import pytest

from fibws.errors import InvalidName, OperationError
from fibws.hub.graph.graph import Graph
from fibws.hub.outbox import Flusher, Outbox
from fibws.hub.session.client import Client, check_room
from fibws.hub.session.statuses import Statuses
from fibws.hub.settings import Settings
from fibws.interfaces import Interfaces

from ..fakes import NANOSECONDS, FakeClock, payloads


class Told:
    """A client of a given name, and what it is told."""

    def __init__(self, node: str = "/talker", max_bytes: int = 10**6) -> None:
        self.clock = FakeClock()
        self.writes: list[bytes] = []
        self.outbox = Outbox(
            self.writes.append, print, Flusher(self.clock.call_soon), max_bytes=max_bytes
        )
        self.client = Client(
            node,
            Graph(Interfaces(), lambda: NANOSECONDS),
            self.outbox,
            self.clock,
            Settings(),
            Statuses(node, self.outbox),
        )

    def hears(self) -> list[bytes]:
        """What has come since this was last asked, once the client reads."""
        self.outbox.resume()
        self.clock.turn()
        heard = [text for data in self.writes for text in payloads(data)]
        self.writes.clear()
        return heard


@pytest.mark.parametrize(
    ("spelling", "name"),
    [("/a/b", "/a/b"), ("a/b", "/a/b"), ("~a/b", "/robot/arm/a/b")],
)
def test_names_resolve_under_the_clients_node(spelling: str, name: str) -> None:
    assert Told("/robot/arm").client.resolve(spelling) == name


@pytest.mark.parametrize("spelling", ["", "/", "~", "a b", "1st"])
def test_what_is_no_name_does_not_resolve(spelling: str) -> None:
    with pytest.raises(InvalidName):
        Told().client.resolve(spelling)


def test_a_client_has_room_for_so_much_and_is_told_what_to_set_for_more() -> None:
    for taken in range(3):
        check_room(taken, 3, "calls")
    for taken in (3, 4):
        with pytest.raises(OperationError) as caught:
            check_room(taken, 3, "calls")
        assert str(caught.value) == "One client may have 3 calls, not more (--max-calls of the hub)"


@pytest.mark.parametrize("what", ["advertisements", "subscriptions", "calls", "goals"])
def test_what_is_to_be_set_for_more_is_a_setting(what: str) -> None:
    assert getattr(Settings(), f"max_{what}") > 0


def test_a_reply_is_never_dropped() -> None:
    told = Told()
    told.outbox.pause()
    for number in range(1000):
        told.client.reply(b"%d" % number)
    assert told.hears() == [b"%d" % number for number in range(1000)]


def test_a_reply_comes_in_pieces_of_different_ids_if_it_is_longer_than_they_may_be() -> None:
    told = Told()
    for _ in range(2):
        told.client.reply(b'"a text"', 5)
        told.client.reply(b'"short"', 10)
    first, *rest = told.hears()
    pieces = [json.loads(text) for text in (first, *rest) if b"fragment" in text]
    assert [each["data"] for each in pieces] == ['"a te', 'xt"'] * 2
    assert len({each["id"] for each in pieces}) == 2
    assert rest.count(b'"short"') == 2


def test_a_client_that_is_slow_is_asked_only_what_leaves_room_for_its_own_replies() -> None:
    """Others may take half of the room, so that what it asks for itself can still be answered."""
    told = Told(max_bytes=200)
    assert told.client.ask(b"x" * 1000)
    told.hears()
    told.outbox.pause()
    assert [told.client.ask(b"x" * 40) for _ in range(4)] == [True, True, False, False]
    assert not told.outbox.overfull
    assert told.hears() == [b"x" * 40] * 2
