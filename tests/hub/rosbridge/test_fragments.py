"""Operations that come in fragments."""

from __future__ import annotations

import json
from typing import Any

import pytest

from fibws.hub.rosbridge.session import MAX_OBJECTS

from ..fakes import INT32, FakeHub, fragment, number


def test_operation_may_come_in_fragments() -> None:
    hub = FakeHub()
    client = hub.client()
    text = json.dumps({"op": "advertise", "topic": "/fib", "type": INT32})
    fragment(client, text[20:], 1, 2)
    assert hub.graph.topics == {}
    fragment(client, text[:20], 0, 2)
    assert list(hub.graph.topics) == ["/fib"]
    client.send("subscribe", "/fib")
    client.send("publish", "/fib", msg=number(2))
    assert client.receive_numbers("/fib") == [2]


def test_fragments_of_two_clients_do_not_mix() -> None:
    hub = FakeHub()
    first, second = hub.client(), hub.client()
    fragment(first, '{"op":', 0, 2)
    fragment(second, '"fly"}', 1, 2)
    assert first.receive() == second.receive() == []


@pytest.mark.parametrize(
    ("fields", "msg"),
    [
        (
            {"data": "", "num": 2, "total": 2},
            "fragment: num must be from 0 to total - 1, got num 2 and total 2",
        ),
        ({"data": "", "num": 0}, "fragment: Expected a total field but none was found."),
        (
            {"data": 5, "num": 0, "total": 1},
            "fragment: Expected field data to be one of str. Invalid value: 5",
        ),
    ],
)
def test_invalid_fragment_is_refused(fields: dict[str, Any], msg: str) -> None:
    client = FakeHub().client()
    client.send("fragment", id="f", **fields)
    [status] = client.receive()
    assert (status["id"], status["msg"]) == ("f", msg)


def test_invalid_reassembled_text_is_refused() -> None:
    client = FakeHub().client()
    fragment(client, "no JSON", 0, 1)
    fragment(client, '{"op":"fly","id":7}', 0, 1)
    assert [each.get("id") for each in client.receive()][1:] == [7]


def test_reassembled_text_has_a_limit_of_operations() -> None:
    client = FakeHub().client()
    client.send("set_level", level="none")
    text = '{"op":"fly"}' * MAX_OBJECTS + '{"op":"subscribe","topic":"/a"}'
    fragment(client, text[:50], 0, 2)
    fragment(client, text[50:], 1, 2)
    assert not client.session.topics.subscriptions
    client.send("set_level", level="error")
    fragment(client, "{}" * (MAX_OBJECTS + 1), 0, 1)
    assert "Expected at most 1000 operations in one text" in client.receive_statuses()[-1]


def test_unfinished_fragments_are_bounded_and_expire() -> None:
    hub = FakeHub(max_fragment_bytes=1000)
    client = hub.client()
    fragment(client, "x" * 800, 0, 2)
    fragment(client, "x" * 800, 0, 2, "other")
    assert client.receive_statuses() == [
        "fragment: too many bytes in unfinished messages (limit 1000, "
        "--max-fragment-bytes of the hub)"
    ]
    hub.clock.advance(601)
    fragment(client, "x" * 800, 0, 2, "other")
    assert client.receive() == []


def test_fragments_within_fragments_do_not_exhaust_the_stack() -> None:
    client = FakeHub().client()
    text = '{"op":"fly"}'
    waiting: list[str] = []
    # Each text finishes the next one, whose beginning came with an earlier one.
    for number_ in range(400):
        piece = {"op": "fragment", "id": number_, "total": 2}
        begin = json.dumps({**piece, "num": 0, "data": text})
        waiting.append(begin)
        text = json.dumps({**piece, "num": 1, "data": ""})
        if len(waiting) == 60:
            text = "".join(waiting) + text
            waiting.clear()
    client.send_text("".join(waiting) + text)
    assert client.receive_statuses() != []
