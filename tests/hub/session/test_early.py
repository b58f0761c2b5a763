"""Messages of a client that has just come, before their topic has a type."""

from __future__ import annotations

from typing import Any

import pytest

from fibws.hub.session.early import GRACE, MOST_BYTES, EarlyMessages
from fibws.protocol.operations import Publish, encode

from ..fakes import INT32, STRING, FakeClock, FakeHub, number, talker_and_listener

CANNOT = "publish: Cannot infer topic type for topic /fib as it is not yet advertised"


def test_a_message_of_who_has_just_come_waits_for_its_advertisement() -> None:
    hub = FakeHub()
    talker, listener = hub.client(), hub.client()
    listener.says("subscribe", "/fib")
    for each in range(3):
        talker.says("publish", "/fib", msg=number(each))
        hub.clock.advance(GRACE / 4)
    assert listener.hears() == talker.hears() == []
    talker.says("advertise", "/fib", type=INT32)
    talker.says("publish", "/fib", msg=number(3))
    assert listener.hears_numbers("/fib") == [0, 1, 2, 3]
    hub.clock.advance(10)
    assert listener.hears() == talker.hears() == []


def test_what_has_waited_until_the_grace_is_over_is_refused() -> None:
    hub = FakeHub()
    hub.clock.advance(5)
    client = hub.client()
    for id_ in "ab":
        client.says("publish", "/fib", msg=number(1), id=id_)
        hub.clock.advance(GRACE / 3)
    assert client.hears() == []
    hub.clock.advance(GRACE / 2)
    assert [(each["id"], each["msg"]) for each in client.hears()] == [("a", CANNOT), ("b", CANNOT)]
    client.says("advertise", "/fib", type=INT32)
    assert client.hears() == []
    client.leaves()
    assert hub.empty
    assert hub.clock.timers == 0


def test_who_has_been_there_for_a_while_is_told_at_once() -> None:
    hub = FakeHub()
    client = hub.client()
    hub.clock.advance(GRACE)
    client.says("publish", "/fib", msg=number(1))
    assert client.hears_statuses() == [CANNOT]
    assert hub.clock.timers == 0


@pytest.mark.parametrize("how", ["advertise", "subscribe", "publish"])
def test_it_does_not_matter_who_gives_the_topic_its_type(how: str) -> None:
    hub = FakeHub()
    talker, listener = hub.client("/talker"), hub.client()
    talker.says("publish", "/fib", msg=number(1))
    other = hub.client("/other")
    other.says("subscribe" if how == "subscribe" else "advertise", "/fib", type=INT32)
    listener.says("subscribe", "/fib")
    if how == "publish":
        talker.says("publish", "/fib", msg=number(2))
        assert listener.hears_numbers("/fib") == [1, 2]
    else:
        hub.clock.advance(GRACE)
        assert listener.hears_numbers("/fib") == [1]
    assert "/talker" in hub.graph.topics["/fib"].publishers
    assert talker.hears() == []


def test_either_spelling_is_the_same_topic() -> None:
    hub = FakeHub()
    talker, listener = hub.client("/talker"), hub.client()
    listener.says("subscribe", "/talker/fib")
    talker.says("publish", "~fib", msg=number(1))
    talker.says("publish", "/talker/fib", msg=number(2))
    talker.says("advertise", "/talker/fib", type=INT32)
    assert listener.hears_numbers("/talker/fib") == [1, 2]


def test_other_topics_wait_on() -> None:
    client = FakeHub().client()
    for topic in ("/a", "/b", "/a"):
        client.says("subscribe", topic)
        client.says("publish", topic, msg=number(1))
    client.says("advertise", "/a", type=INT32)
    assert client.hears_numbers("/a") == [1, 1]
    client.says("advertise", "/b", type=INT32)
    assert client.hears_numbers("/b") == [1]


def test_what_does_not_fit_in_the_end_is_refused_then() -> None:
    hub = FakeHub()
    talker, listener = hub.client(), hub.client()
    listener.says("subscribe", "/fib")
    for id_, data in (("a", 1), ("b", "text")):
        talker.says("publish", "/fib", msg={"data": data}, id=id_)
    talker.says("advertise", "/fib", type=STRING)
    [status] = talker.hears()
    assert status["id"] == "a"
    assert "requires a string for field data, but got a int" in status["msg"]
    assert listener.hears_messages("/fib") == [{"data": "text"}]


def test_what_waits_does_not_outlive_its_client() -> None:
    hub = FakeHub()
    client, other = hub.client(), hub.client()
    client.says("publish", "/fib", msg=number(1))
    client.leaves()
    assert hub.clock.timers == 0
    other.says("subscribe", "/fib")
    other.says("advertise", "/fib", type=INT32)
    hub.clock.advance(GRACE)
    assert client.hears() == other.hears() == []


def test_a_message_whose_topic_is_known_does_not_wait() -> None:
    talker, listener = talker_and_listener(FakeHub())
    talker.says("publish", "/fib", msg=number(1))
    assert listener.hears_numbers("/fib") == [1]


@pytest.mark.parametrize("name", ["", "no name", "/a/"])
def test_what_is_no_name_is_refused_at_once(name: str) -> None:
    hub = FakeHub()
    client = hub.client()
    client.says("publish", name, msg={})
    assert "is not a legal name" in client.hears_statuses()[0]
    assert hub.clock.timers == 0


def test_there_is_room_for_so_much_and_nothing_is_refused_twice() -> None:
    hub = FakeHub()
    client = hub.client()
    half = {"data": "x" * (MOST_BYTES // 2)}
    for id_ in range(5):
        client.says("publish", "/fib", msg=half, id=id_)
    hub.clock.advance(GRACE)
    statuses = client.hears()
    assert sorted(each["id"] for each in statuses) == [0, 1, 2, 3, 4]
    assert {each["msg"] for each in statuses} == {CANNOT}


@pytest.mark.parametrize(
    "fields",
    [{}, {"msg": {}}, {"id": "x" * 1000}, {"topic": f"/{'x' * 1000}"}],
    ids=["no message", "empty message", "long id", "long topic"],
)
def test_small_messages_take_room_as_well(fields: dict[str, Any]) -> None:
    """What is kept of a message is more than the text of its ``msg``."""
    clock = FakeClock()
    late: list[Publish] = []
    early = EarlyMessages(clock, GRACE, late.append)
    request = Publish(**{"topic": "/fib", **fields})
    kept = 0
    while kept < 100_000 and early.put(request.topic, request):
        kept += 1
    bytes_kept = kept * (100 + len(encode(request)))
    assert bytes_kept <= 2 * MOST_BYTES
    clock.advance(GRACE)
    assert len(late) == kept
    assert clock.timers == 0


def test_nothing_waits_any_more_once_all_is_over() -> None:
    clock = FakeClock()
    late: list[Publish] = []
    early = EarlyMessages(clock, GRACE, late.append)
    first, second = (Publish(topic="/a", id=each) for each in (1, 2))
    for each in (first, second):
        assert early.put("/a", each)
    assert early.put("/b", first)
    assert early.take("/c") == []
    assert early.take("/a") == [first, second]
    assert early.take("/a") == []
    early.close()
    clock.advance(GRACE)
    assert (late, clock.timers) == ([], 0)
    assert not early.put("/a", first)
