"""Who is connected is published when it changes, but not too often."""

from __future__ import annotations

from ..fakes import NANOSECONDS, Client
from .asking import Asking

SECS, NSECS = divmod(NANOSECONDS, 10**9)


def watching(asking: Asking) -> Client:
    """A client that hears both topics, long after they were last published."""
    watcher = asking.joins("/watcher")
    watcher.says("subscribe", "/client_count")
    watcher.says("subscribe", "/connected_clients")
    assert len(watcher.hears()) == 2
    asking.hub.clock.advance(1)
    return watcher


def counts(watcher: Client) -> list[int]:
    """The counts that were heard, each of which is that of a list."""
    heard = watcher.hears()
    lists = [len(each["msg"]["clients"]) for each in heard if "clients" in each["msg"]]
    numbers: list[int] = [each["msg"]["data"] for each in heard if "data" in each["msg"]]
    assert lists == numbers
    return numbers


def test_both_topics_are_there_before_anybody_comes() -> None:
    watcher = Asking().joins("/watcher")
    watcher.says("subscribe", "/client_count")
    assert watcher.hears_messages("/client_count") == [{"data": 0}]
    watcher.says("subscribe", "/connected_clients")
    assert watcher.hears_messages("/connected_clients") == [{"clients": []}]


def test_a_client_is_counted_and_listed_at_once() -> None:
    asking = Asking()
    watcher = watching(asking)
    asking.connects()
    listing, count = watcher.hears()
    assert count["msg"] == {"data": 1}
    time = {"secs": SECS, "nsecs": NSECS}
    assert listing["msg"] == {"clients": [{"ip_address": "10.0.0.1", "connection_time": time}]}


def test_the_first_client_is_counted_at_once_however_new_the_hub_is() -> None:
    asking = Asking()
    asking.connects()
    watcher = asking.joins("/watcher")
    watcher.says("subscribe", "/client_count")
    assert watcher.hears_messages("/client_count") == [{"data": 1}]


def test_who_comes_later_hears_of_those_who_are_there() -> None:
    asking = Asking()
    watcher = watching(asking)
    for _ in range(2):
        asking.connects()
        asking.hub.clock.advance(1)
    assert counts(watcher) == [1, 2]
    later = asking.joins("/later")
    later.says("subscribe", "/client_count")
    assert later.hears_messages("/client_count") == [{"data": 2}]


def test_who_leaves_is_counted_out_and_only_once() -> None:
    asking = Asking()
    watcher = watching(asking)
    one = asking.connects()
    asking.hub.clock.advance(1)
    asking.connects()
    asking.hub.clock.advance(1)
    assert counts(watcher) == [1, 2]
    asking.own.disconnected(one)
    assert counts(watcher) == [1]
    asking.hub.clock.advance(1)
    asking.own.disconnected(one)
    asking.hub.clock.advance(1)
    assert counts(watcher) == []


def test_a_thousand_that_come_at_once_are_published_twice() -> None:
    asking = Asking()
    watcher = watching(asking)
    for _ in range(1000):
        asking.connects()
    assert counts(watcher) == [1]
    assert asking.hub.clock.timers == 1
    asking.hub.clock.advance(0.11)
    assert counts(watcher) == [1000]
    asking.hub.clock.advance(10)
    assert counts(watcher) == []


def test_there_is_a_tenth_of_a_second_between_publications() -> None:
    asking = Asking()
    watcher = watching(asking)
    clock = asking.hub.clock
    heard = []
    for _ in range(100):
        asking.connects()
        clock.advance(0.01)
        heard += counts(watcher)
    assert len(heard) in (10, 11)
    clock.advance(0.1)
    assert [*heard, *counts(watcher)][-1] == 100


def test_when_it_closes_nothing_is_to_come() -> None:
    asking = Asking()
    watcher = watching(asking)
    for _ in range(2):
        asking.connects()
    assert counts(watcher) == [1]
    asking.own.clients.close()
    assert asking.hub.clock.timers == 0
    asking.hub.clock.advance(1)
    assert counts(watcher) == []


def test_clients_are_found_by_their_nodes() -> None:
    asking = Asking()
    talker, listener = asking.connects("/talker"), asking.connects("/listener")
    clients = asking.own.clients
    assert list(clients) == [(talker, NANOSECONDS), (listener, NANOSECONDS)]
    assert (clients.of("/talker"), clients.of("/listener")) == (talker, listener)
    assert clients.of("/rosapi") is clients.of("/nobody") is None


def test_the_newest_has_the_name_while_the_older_still_leaves() -> None:
    asking = Asking()
    older, newer = asking.connects("/talker"), asking.connects("/talker")
    assert asking.own.clients.of("/talker") is newer
    asking.own.disconnected(older)
    assert asking.own.clients.of("/talker") is newer
