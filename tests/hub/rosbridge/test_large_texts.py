"""Limits on texts with many values."""

from __future__ import annotations

import gc
import json
import tracemalloc
from collections.abc import Callable

import cbor2
import pytest

from fibws.protocol.value_limits import MOST_CONTAINERS, MOST_VALUES

from ..fakes import STRING, Client, FakeHub, finish, fragment

MANY = 2**19


def dense(unit: str = "[],", count: int = MANY, front: str = "") -> str:
    msg = f'{{"data":[{unit * count}0]}}'
    return f'{front}{{"op":"publish","topic":"/t","msg":{msg}}}'


def peak_of(action: Callable[[], object]) -> int:
    """Return the most bytes that something allocates."""
    gc.collect()
    tracemalloc.start()
    try:
        action()
        return tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()


def talker() -> Client:
    client = FakeHub().client()
    client.send("advertise", "/t", type=STRING)
    return client


@pytest.mark.parametrize("front", ["", "{}", '{"op":"fly"}', "{}x"])
def test_dense_text_is_refused_before_it_is_decoded(front: str) -> None:
    client = talker()
    data = dense(front=front).encode()
    assert peak_of(lambda: finish(client.session.receive_text(data))) < len(data) / 4
    [msg] = client.receive_statuses()
    assert f"too many arrays and objects in one operation (limit is {MOST_CONTAINERS})" in msg


def test_dense_text_in_fragments_is_refused_before_it_is_decoded() -> None:
    client = talker()
    text = dense()
    fragment(client, text[:1000], 0, 2)
    data = json.dumps({"op": "fragment", "id": "f", "num": 1, "total": 2, "data": text[1000:]})
    assert peak_of(lambda: client.send_text(data)) < 8 * len(data)
    [msg] = client.receive_statuses()
    assert "too many arrays and objects" in msg


def test_dense_cbor_is_refused_before_it_is_decoded() -> None:
    client = talker()
    message = {"op": "publish", "topic": "/t", "msg": {"data": [[]] * MANY}}
    data = cbor2.dumps(message)
    assert peak_of(lambda: client.send_binary(data)) < 2 * len(data)
    [msg] = client.receive_statuses()
    assert "too many arrays and objects" in msg


def test_client_goes_on_after_a_dense_text() -> None:
    hub = FakeHub()
    client, listener = hub.client(), hub.client()
    client.send("advertise", "/t", type=STRING)
    listener.send("subscribe", "/t")
    client.send_text(dense())
    client.send("publish", "/t", msg={"data": "still here"})
    assert listener.receive_messages("/t") == [{"data": "still here"}]


def test_objects_of_one_text_are_not_in_memory_together() -> None:
    client = talker()
    one = dense(count=50_000)
    single = peak_of(lambda: client.send_text(one))
    several = peak_of(lambda: client.send_text(one * 5))
    assert several < 1.6 * single


def test_text_that_is_not_an_object_is_in_memory_once() -> None:
    client = talker()
    data = f"[{'[],' * 100_000}0]"
    valid = peak_of(lambda: json.loads(data))
    assert peak_of(lambda: client.send_text(data)) < 1.5 * valid


@pytest.mark.parametrize("cells", [2**20, MOST_VALUES - 100])
def test_map_of_a_million_cells_is_relayed(cells: int) -> None:
    hub = FakeHub()
    client, listener = hub.client(), hub.client()
    client.send("advertise", "/map", type="nav_msgs/OccupancyGrid")
    listener.send("subscribe", "/map")
    client.send_text(f'{{"op":"publish","topic":"/map","msg":{{"data":[{"0," * cells}100]}}}}')
    [msg] = listener.receive_messages("/map")
    assert len(msg["data"]) == cells + 1


def test_string_full_of_json_is_relayed() -> None:
    hub = FakeHub()
    client, listener = hub.client(), hub.client()
    client.send("advertise", "/t", type=STRING)
    listener.send("subscribe", "/t")
    inner = json.dumps([{"a": []}] * MOST_CONTAINERS)
    client.send("publish", "/t", msg={"data": inner})
    assert listener.receive_messages("/t") == [{"data": inner}]
