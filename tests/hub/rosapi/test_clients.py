"""/client_count and /connected_clients: published on changes, but not too often."""

from __future__ import annotations

from ..fakes import NANOSECONDS, Client
from .rosapi_client import RosapiClient

SECS, NSECS = divmod(NANOSECONDS, 10**9)


def add_watcher(rosapi: RosapiClient) -> Client:
    """Add a subscriber of both topics, a second after they were last published."""
    watcher = rosapi.add_client("/watcher")
    watcher.send("subscribe", "/client_count")
    watcher.send("subscribe", "/connected_clients")
    assert len(watcher.receive()) == 2
    rosapi.hub.clock.advance(1)
    return watcher


def counts(watcher: Client) -> list[int]:
    """The counts that were received, each with a list of that length."""
    received = watcher.receive()
    lists = [len(each["msg"]["clients"]) for each in received if "clients" in each["msg"]]
    numbers: list[int] = [each["msg"]["data"] for each in received if "data" in each["msg"]]
    assert lists == numbers
    return numbers


def test_both_topics_have_a_message_before_the_first_client() -> None:
    watcher = RosapiClient().add_client("/watcher")
    watcher.send("subscribe", "/client_count")
    assert watcher.receive_messages("/client_count") == [{"data": 0}]
    watcher.send("subscribe", "/connected_clients")
    assert watcher.receive_messages("/connected_clients") == [{"clients": []}]


def test_client_is_counted_and_listed_at_once() -> None:
    rosapi = RosapiClient()
    watcher = add_watcher(rosapi)
    rosapi.connect()
    listing, count = watcher.receive()
    assert count["msg"] == {"data": 1}
    time = {"secs": SECS, "nsecs": NSECS}
    assert listing["msg"] == {"clients": [{"ip_address": "10.0.0.1", "connection_time": time}]}


def test_first_client_of_a_new_hub_is_counted_at_once() -> None:
    rosapi = RosapiClient()
    rosapi.connect()
    watcher = rosapi.add_client("/watcher")
    watcher.send("subscribe", "/client_count")
    assert watcher.receive_messages("/client_count") == [{"data": 1}]


def test_late_subscriber_gets_the_present_count() -> None:
    rosapi = RosapiClient()
    watcher = add_watcher(rosapi)
    for _ in range(2):
        rosapi.connect()
        rosapi.hub.clock.advance(1)
    assert counts(watcher) == [1, 2]
    later = rosapi.add_client("/later")
    later.send("subscribe", "/client_count")
    assert later.receive_messages("/client_count") == [{"data": 2}]


def test_client_that_leaves_is_subtracted_once() -> None:
    rosapi = RosapiClient()
    watcher = add_watcher(rosapi)
    one = rosapi.connect()
    rosapi.hub.clock.advance(1)
    rosapi.connect()
    rosapi.hub.clock.advance(1)
    assert counts(watcher) == [1, 2]
    rosapi.own.disconnected(one)
    assert counts(watcher) == [1]
    rosapi.hub.clock.advance(1)
    rosapi.own.disconnected(one)
    rosapi.hub.clock.advance(1)
    assert counts(watcher) == []


def test_thousand_clients_at_once_are_published_twice() -> None:
    rosapi = RosapiClient()
    watcher = add_watcher(rosapi)
    for _ in range(1000):
        rosapi.connect()
    assert counts(watcher) == [1]
    assert rosapi.hub.clock.timers == 1
    rosapi.hub.clock.advance(0.11)
    assert counts(watcher) == [1000]
    rosapi.hub.clock.advance(10)
    assert counts(watcher) == []


def test_publications_are_a_tenth_of_a_second_apart() -> None:
    rosapi = RosapiClient()
    watcher = add_watcher(rosapi)
    clock = rosapi.hub.clock
    received = []
    for _ in range(100):
        rosapi.connect()
        clock.advance(0.01)
        received += counts(watcher)
    assert len(received) in (10, 11)
    clock.advance(0.1)
    assert [*received, *counts(watcher)][-1] == 100


def test_nothing_is_published_after_close() -> None:
    rosapi = RosapiClient()
    watcher = add_watcher(rosapi)
    for _ in range(2):
        rosapi.connect()
    assert counts(watcher) == [1]
    rosapi.own.clients.close()
    assert rosapi.hub.clock.timers == 0
    rosapi.hub.clock.advance(1)
    assert counts(watcher) == []


def test_client_is_found_by_its_node() -> None:
    rosapi = RosapiClient()
    talker, listener = rosapi.connect("/talker"), rosapi.connect("/listener")
    clients = rosapi.own.clients
    assert list(clients) == [(talker, NANOSECONDS), (listener, NANOSECONDS)]
    assert (clients.find("/talker"), clients.find("/listener")) == (talker, listener)
    assert clients.find("/rosapi") is clients.find("/nobody") is None


def test_newest_client_of_a_name_is_found() -> None:
    rosapi = RosapiClient()
    older, newer = rosapi.connect("/talker"), rosapi.connect("/talker")
    assert rosapi.own.clients.find("/talker") is newer
    rosapi.own.disconnected(older)
    assert rosapi.own.clients.find("/talker") is newer
