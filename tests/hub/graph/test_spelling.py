"""Names, and how clients spell them."""

from __future__ import annotations

import pytest

from ..fakes import INT32, FakeHub, number, talker_and_listener


@pytest.mark.parametrize(
    ("node", "spelling", "name"),
    [
        ("/talker", "fib", "/fib"),
        ("/talker", "/fib", "/fib"),
        ("/talker", "~fib", "/talker/fib"),
        ("/robot/arm", "~pid/gain", "/robot/arm/pid/gain"),
        (None, "~fib", "/client_1/fib"),
    ],
)
def test_names_resolve_under_the_clients_node(node: str | None, spelling: str, name: str) -> None:
    hub = FakeHub()
    hub.client(node).says("advertise", spelling, type=INT32)
    assert list(hub.graph.topics) == [name]


def test_each_hears_a_topic_under_its_own_spelling() -> None:
    hub = FakeHub()
    talker, listener = talker_and_listener(hub)
    other = hub.client()
    other.says("subscribe", "fib")
    talker.says("publish", "fib", msg=number(1))
    assert listener.hears_numbers("/fib") == [1]
    assert other.hears_numbers("fib") == [1]


def test_a_client_may_use_both_spellings_at_once() -> None:
    hub = FakeHub()
    talker, listener = talker_and_listener(hub)
    listener.says("subscribe", "fib", throttle_rate=1000)
    for each in range(2):
        talker.says("publish", "/fib", msg=number(each))
    heard = [(each["topic"], each["msg"]["data"]) for each in listener.hears()]
    assert sorted(heard) == [("/fib", 0), ("/fib", 1), ("fib", 0)]
    listener.says("unsubscribe", "/fib")
    hub.clock.advance(1)
    talker.says("publish", "/fib", msg=number(2))
    assert listener.hears_numbers("fib") == [2]


def test_a_publisher_has_one_count_under_both_spellings() -> None:
    client = FakeHub().client()
    client.says("subscribe", "/a", type="rospy_tutorials/HeaderString")
    for spelling in ("/a", "a", "/a"):
        client.says("publish", spelling)
    assert [msg["header"]["seq"] for msg in client.hears_messages("/a")] == [1, 2, 3]


@pytest.mark.parametrize("name", ["", "/", "1st", "a b", "a//b", "/a/", "ä"])
@pytest.mark.parametrize("op", ["advertise", "publish", "subscribe"])
def test_a_name_that_is_not_legal_is_refused(op: str, name: str) -> None:
    hub = FakeHub()
    client = hub.client()
    client.says(op, name, type=INT32, id="x")
    [status] = client.hears()
    assert (status["id"], status["level"]) == ("x", "error")
    assert status["msg"].startswith(f"{op}: {name!r} is not a legal name")
    assert hub.graph.topics == {}
