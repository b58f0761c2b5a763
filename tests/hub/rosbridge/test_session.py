"""Clients come and go, and leave nothing behind."""

from __future__ import annotations

import json
from typing import Any

from hypothesis import given
from hypothesis import strategies as st

from fibws.protocol.websocket import REPLACED

from ..fakes import INT32, STRING, FakeHub, fragment, number, talker_and_listener


def test_leaving_removes_everything_of_a_client() -> None:
    hub = FakeHub()
    client = hub.client("/busy")
    client.send("advertise", "/a", type=INT32, latch=True)
    client.send("advertise", "a", type=INT32)
    client.send("publish", "/a", msg=number(1))
    client.send("subscribe", "/a")
    client.send("subscribe", "a", type=INT32, throttle_rate=100, queue_length=5)
    client.send("subscribe", "/nothing_yet")
    client.send("publish", "/a", msg=number(2))
    client.send("publish", "/a", msg=number(3))
    fragment(client, "", 0, 2)
    client.disconnect()
    assert hub.empty
    assert hub.clock.timers == 0
    assert not client.session.topics.sources
    assert not client.session.topics.subscriptions


def test_leaving_twice_is_harmless() -> None:
    hub = FakeHub()
    client = hub.client("/a")
    client.disconnect()
    newer = hub.client("/a")
    client.disconnect()
    assert list(hub.graph.nodes) == ["/a"]
    assert newer.closings == []


def test_thousands_of_names_are_forgotten() -> None:
    hub = FakeHub()
    client = hub.client()
    for each in range(1000):
        client.send("advertise", f"/a{each}", type=INT32)
        client.send("unadvertise", f"/a{each}")
        client.send("subscribe", f"/b{each}")
        client.send("unsubscribe", f"/b{each}")
        client.send("publish", f"/c{each}")
        client.send("advertise", f"/d{each}", type="std_msgs/None")
        client.send("subscribe", f"/e{each}", type="nonsense")
    assert hub.graph.topics == {}


def test_refused_subscription_does_not_change_the_others() -> None:
    hub = FakeHub()
    talker, listener = talker_and_listener(hub)
    listener.send("subscribe", "/fib", id="wrong", type="std_msgs/Strin")
    assert len(listener.receive_statuses()) == 1
    talker.send("publish", "/fib", msg=number(1))
    assert listener.receive_numbers("/fib") == [1]
    listener.disconnect()
    talker.disconnect()
    assert hub.empty


def test_clients_without_a_name_get_different_names() -> None:
    hub = FakeHub()
    assert len({hub.client().session.node for _ in range(3)}) == 3


def test_newer_node_of_the_same_name_closes_the_older() -> None:
    hub = FakeHub()
    older, listener = talker_and_listener(hub)
    newer = hub.client("/talker")
    assert (older.closings, newer.closings, listener.closings) == ([REPLACED], [], [])
    assert list(hub.graph.nodes) == ["/listener", "/talker"]
    assert hub.graph.topics["/fib"].sources == {}


def test_newer_node_keeps_its_registrations_when_the_older_leaves() -> None:
    hub = FakeHub()
    older, listener = talker_and_listener(hub)
    newer = hub.client("/talker")
    newer.send("advertise", "/fib", type=INT32)
    older.disconnect()
    newer.send("publish", "/fib", msg=number(1))
    assert listener.receive_numbers("/fib") == [1]
    newer.disconnect()
    listener.disconnect()
    assert hub.empty


def test_auth_is_ignored_with_a_warning() -> None:
    client = FakeHub().client()
    fields: dict[str, Any] = {
        "mac": "5e",
        "client": "a",
        "dest": "b",
        "rand": "c",
        "t": 1,
        "end": 2,
    }
    client.send("auth", **fields, level="admin")
    assert client.receive() == []
    client.send("set_level", level="warning")
    client.send("auth", **fields, id=1)
    [text] = client.receive_statuses("warning")
    assert text.startswith("auth: ")


TOPICS = st.sampled_from(["/a", "a", "~a", "/b", "b", "/", "", 5, None])
IDS: st.SearchStrategy[object] = st.sampled_from([None, "x", 1, True, 1.5, [], {}])
TYPES = st.sampled_from([INT32, STRING, "my_msgs/Thing", "std_msgs/Sting", "nonsense", 5, None])
SIZES = st.sampled_from([0, 1, 5, -1, 100, 2.5, 2**70, "1", None])
FIELDS = st.fixed_dictionaries(
    {
        "op": st.sampled_from(
            ["advertise", "publish", "subscribe", "unadvertise", "unsubscribe", "set_level", "fly"]
        ),
        "topic": TOPICS,
    },
    optional={
        "id": IDS,
        "type": TYPES,
        "latch": st.booleans(),
        "msg": st.sampled_from([{}, {"data": 1}, {"data": "x"}, {"data": [None]}, [], "x", None]),
        "throttle_rate": SIZES,
        "queue_length": SIZES,
        "compression": st.sampled_from(["none", "png", "cbor", "cbor-raw", 5]),
        "fragment_size": SIZES,
        "level": st.sampled_from(["info", "warning", "error", "none", "loud"]),
        "definition": st.sampled_from([None, "int32 data", "int8 a\nint8 b", "int33 c"]),
    },
)
TEXTS = st.lists(FIELDS.map(json.dumps), min_size=1, max_size=4).map("".join)
"""Several operations may come in one text."""
MOMENTS = st.sampled_from(["pause", "resume", "time", "turn"])
PIECES = st.builds(
    lambda text, cut, id_, order, total: [
        json.dumps({"op": "fragment", "id": id_, "num": num, "total": total, "data": data})
        for num, data in list(enumerate((text[:cut], text[cut:])))[::order]
    ],
    TEXTS,
    st.integers(0, 100),
    IDS,
    st.sampled_from([1, -1]),
    st.sampled_from([2, 2, 2, 1, 3]),
)
"""A text in two fragments; some are wrong, or never completed."""
STEPS = st.lists(
    st.tuples(st.integers(0, 1), TEXTS.map(lambda text: [text]) | PIECES | MOMENTS),
    max_size=20,
)


@given(STEPS)
def test_random_operations_raise_nothing_and_leave_nothing(
    steps: list[tuple[int, list[str] | str]],
) -> None:
    hub = FakeHub(max_latched_bytes=30, max_fragment_bytes=500, max_subscriptions=3)
    clients = [hub.client("/robot"), hub.client()]
    for number_, step in steps:
        client = clients[number_]
        match step:
            case "pause":
                client.queue.pause()
            case "resume":
                client.queue.resume()
            case "time":
                hub.clock.advance(0.25)
            case "turn":
                client.receive_frames()
            case list():
                for text in step:
                    client.send_text(text)
    for client in clients:
        client.disconnect()
    assert hub.empty
    assert hub.clock.timers == 0
    assert all(client.forgotten for client in clients)
    assert all(client.queue.kept_bytes == 0 or client.queue.paused for client in clients)
