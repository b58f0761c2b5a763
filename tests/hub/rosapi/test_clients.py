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
    asking.own.clients.connected("one", "10.0.0.1", NANOSECONDS)
    listing, count = watcher.hears()
    assert count["msg"] == {"data": 1}
    time = {"secs": SECS, "nsecs": NSECS}
    assert listing["msg"] == {"clients": [{"ip_address": "10.0.0.1", "connection_time": time}]}


def test_the_first_client_is_counted_at_once_however_new_the_hub_is() -> None:
    asking = Asking()
    asking.own.clients.connected("one", "10.0.0.1", NANOSECONDS)
    watcher = asking.joins("/watcher")
    watcher.says("subscribe", "/client_count")
    assert watcher.hears_messages("/client_count") == [{"data": 1}]


def test_who_comes_later_hears_of_those_who_are_there() -> None:
    asking = Asking()
    watcher = watching(asking)
    for client in ("one", "two"):
        asking.own.clients.connected(client, "10.0.0.1", NANOSECONDS)
        asking.hub.clock.advance(1)
    assert counts(watcher) == [1, 2]
    later = asking.joins("/later")
    later.says("subscribe", "/client_count")
    assert later.hears_messages("/client_count") == [{"data": 2}]


def test_who_leaves_is_counted_out_and_only_once() -> None:
    asking = Asking()
    watcher = watching(asking)
    clients = asking.own.clients
    for client in ("one", "two"):
        clients.connected(client, "10.0.0.1", NANOSECONDS)
        asking.hub.clock.advance(1)
    assert counts(watcher) == [1, 2]
    clients.disconnected("one")
    assert counts(watcher) == [1]
    asking.hub.clock.advance(1)
    clients.disconnected("one")
    clients.disconnected("nobody")
    asking.hub.clock.advance(1)
    assert counts(watcher) == []


def test_a_thousand_that_come_at_once_are_published_twice() -> None:
    asking = Asking()
    watcher = watching(asking)
    clients = asking.own.clients
    for client in range(1000):
        clients.connected(client, "10.0.0.1", NANOSECONDS)
    assert counts(watcher) == [1]
    assert asking.hub.clock.timers == 1
    asking.hub.clock.advance(0.11)
    assert counts(watcher) == [1000]
    asking.hub.clock.advance(10)
    assert counts(watcher) == []


def test_there_is_a_tenth_of_a_second_between_publications() -> None:
    asking = Asking()
    watcher = watching(asking)
    clients, clock = asking.own.clients, asking.hub.clock
    heard = []
    for client in range(100):
        clients.connected(client, "10.0.0.1", NANOSECONDS)
        clock.advance(0.01)
        heard += counts(watcher)
    assert len(heard) in (10, 11)
    clock.advance(0.1)
    assert [*heard, *counts(watcher)][-1] == 100


def test_when_it_closes_nothing_is_to_come() -> None:
    asking = Asking()
    watcher = watching(asking)
    for client in range(2):
        asking.own.clients.connected(client, "10.0.0.1", NANOSECONDS)
    assert counts(watcher) == [1]
    asking.own.clients.close()
    assert asking.hub.clock.timers == 0
    asking.hub.clock.advance(1)
    assert counts(watcher) == []
