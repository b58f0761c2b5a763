"""What clients are told of their errors, and of the rest if they ask for it."""

from __future__ import annotations

import json
from typing import Any

import pytest

from fibws.errors import InvalidUtf8
from fibws.hub.outbox import Flusher, Outbox
from fibws.hub.session.statuses import Statuses
from fibws.protocol.operations import Level
from fibws.protocol.parsing import REQUESTS

from ..fakes import (
    INT32,
    Client,
    FakeClock,
    FakeHub,
    fragment,
    number,
    payloads,
    talker_and_listener,
)


@pytest.mark.parametrize(
    ("text", "msg"),
    [
        (
            "{",
            "Expected JSON objects: EOF while parsing an object at line 1 column 1. "
            'Original message was: "{"',
        ),
        ("5", "Expected a JSON object. Original message was: 5"),
        ('{"op":"fly"}', f"Unknown operation: fly.  Allowed operations: {REQUESTS}"),
        (
            '{"topic":"/a"}',
            "Received a message without an op.  All messages require 'op' field with value "
            f'one of: {REQUESTS}.  Original message was: {{"topic":"/a"}}',
        ),
        ('{"op":"subscribe"}', "subscribe: Expected a topic field but none was found."),
        (
            '{"op":"publish","topic":5}',
            "publish: Expected field topic to be one of str. Invalid value: 5",
        ),
        (
            '{"op":"publish","topic":["/a"]}',
            'publish: Expected field topic to be one of str. Invalid value: ["/a"]',
        ),
    ],
)
def test_what_is_no_operation_is_refused(text: str, msg: str) -> None:
    client = FakeHub().client()
    client.says_text(text)
    assert client.hears_statuses() == [msg]


def test_an_error_ends_neither_the_session_nor_the_operations_around_it() -> None:
    client = FakeHub().client()
    client.says_text(
        '{"op":"advertise","topic":"/a","type":"std_msgs/Int32"}{"op":"fly"}'
        '{"op":"subscribe","topic":"/a"}{"op":"publish","topic":"/a"} garbage'
    )
    client.says("publish", "/a", msg=number(1))
    assert [each["op"] for each in client.hears()] == ["status", "publish", "status", "publish"]


@pytest.mark.parametrize("id_", ["subscribe:/t:1", "", 5, 0, -1.5, 2**70, True, False])
@pytest.mark.parametrize("op", ["fly", "publish", "subscribe"])
def test_a_status_carries_the_id_as_it_was_sent(op: str, id_: object) -> None:
    client = FakeHub().client()
    client.says(op, "not legal", id=id_)
    [status] = client.hears()
    assert (status["id"], type(status["id"])) == (id_, type(id_))


@pytest.mark.parametrize("id_", [None, [], {"a": 1}])
@pytest.mark.parametrize("op", ["fly", "publish", "subscribe"])
def test_a_status_carries_no_id_that_is_none(op: str, id_: object) -> None:
    client = FakeHub().client()
    client.says(op, "not legal", id=id_)
    [status] = client.hears()
    assert "id" not in status


def test_an_id_that_is_none_does_not_matter_to_a_known_publisher() -> None:
    talker, listener = talker_and_listener(FakeHub())
    talker.says("publish", "/fib", msg={"data": "x"}, id=[1])
    [status] = talker.hears()
    assert "id" not in status
    assert listener.hears() == []


@pytest.mark.parametrize(
    ("level", "heard"),
    [
        ("none", []),
        ("error", ["error"]),
        ("warning", ["warning", "error"]),
        ("info", ["warning", "info", "error"]),
    ],
)
def test_a_client_hears_the_level_that_it_set_and_what_is_graver(
    level: str, heard: list[str]
) -> None:
    client = FakeHub().client()
    client.says("set_level", level=level)
    client.says("advertise", "/a", type="my_msgs/Thing")
    client.says("fly")
    assert [each["level"] for each in client.hears()] == heard


def test_nothing_above_errors_is_said_unless_asked_for() -> None:
    client = FakeHub().client()
    client.says("advertise", "/a", type="my_msgs/Thing")
    client.says("subscribe", "/b", compression="zip")
    assert client.hears() == []


def test_a_wrong_level_is_refused_and_the_old_one_stays() -> None:
    client = FakeHub().client()
    client.says("set_level", level="loud", id=1)
    assert [each["id"] for each in client.hears()] == [1]
    client.says("fly")
    assert len(client.hears()) == 1


def informed(hub: FakeHub, node: str = "/talker") -> Client:
    client = hub.client(node)
    client.says("set_level", level="info")
    return client


def test_an_advertisement_is_acknowledged_at_level_info() -> None:
    client = informed(FakeHub())
    client.says("advertise", "fib", type="std_msgs/msg/Int32", id=1)
    assert client.hears() == [
        {
            "op": "status",
            "id": 1,
            "level": "info",
            "msg": "/talker publishes /fib (std_msgs/Int32)",
        }
    ]


def test_who_waits_for_a_publisher_is_told_at_level_info() -> None:
    client = informed(FakeHub())
    client.says("subscribe", "/fib", id="x")
    [status] = client.hears()
    assert (status["id"], status["level"]) == ("x", "info")
    assert status["msg"] == "/fib waits for a publisher to have a type"


def test_what_a_message_left_out_is_told_at_level_info() -> None:
    hub = FakeHub()
    client = informed(hub)
    client.says("advertise", "/a", type="geometry_msgs/Twist")
    client.hears()
    zeros = {"x": 0, "y": 0, "z": 0}
    client.says("publish", "/a", msg={"linear": {"x": 1, "z": 1}}, id="p")
    client.says("publish", "/a", msg={"linear": zeros, "angular": zeros})
    client.says("publish", "/a")
    statuses = client.hears()
    assert [each["msg"] for each in statuses] == [
        "publish: defaults stand for linear.y, angular",
        "publish: defaults stand for linear, angular",
    ]
    assert statuses[0]["id"] == "p"


def test_a_status_overtakes_the_messages_that_a_slow_client_has_yet_to_read() -> None:
    talker, listener = talker_and_listener(FakeHub())
    listener.outbox.pause()
    talker.says("publish", "/fib", msg=number(1))
    listener.says("fly")
    listener.outbox.resume()
    assert [each["op"] for each in listener.hears()] == ["status", "publish"]


def test_a_client_that_errs_often_does_not_fill_the_log(caplog: pytest.LogCaptureFixture) -> None:
    client = FakeHub().client("/clumsy")
    for _ in range(1000):
        client.says("subscribe", "/")
    fault = "/clumsy: subscribe: '/' is not a legal name"
    assert [record.message.startswith(fault) for record in caplog.records] == [True] * 4
    assert [record.message.partition(" (error ")[2] for record in caplog.records] == [
        f"{count} of this client)" for count in (1, 10, 100, 1000)
    ]
    assert len(client.hears()) == 1000


@pytest.mark.parametrize(
    "fields",
    [
        {"op": "x" * 10_000},
        {"op": "advertise", "topic": "/a", "type": "x" * 10_000},
        {"op": "advertise", "topic": "x" * 10_000, "type": INT32},
        {"op": "publish", "topic": "/fib", "msg": {"x" * 10_000: 1}},
        {"op": "publish", "topic": "/fib", "msg": {"data": "x" * 10_000}},
        {"op": "call_service", "service": ["x" * 10_000]},
        {"op": "service_response", "service": "x" * 10_000, "result": True},
        {"op": "action_result", "action": "x" * 10_000, "result": True},
        {"op": "fragment", "id": "x" * 10_000, "data": "", "num": 0, "total": 2},
    ],
    ids=[
        *("operation", "type", "topic", "field", "value"),
        *("service", "response", "result", "fragment"),
    ],
)
def test_a_status_repeats_only_a_part_of_what_was_wrong(fields: dict[str, Any]) -> None:
    client = informed(FakeHub())
    client.says("advertise", "/fib", type=INT32)
    fragment(client, "", 0, 3, "x" * 10_000)
    client.hears()
    client.says_text(json.dumps(fields))
    [text] = [each["msg"] for each in client.hears()]
    assert len(text) < 2000


def test_bytes_that_are_no_text_are_the_connections_to_judge() -> None:
    client = FakeHub().client()
    with pytest.raises(InvalidUtf8):
        client.session.receive(b"\xff")


# The object by itself.


class Told:
    """Statuses, and what became of them."""

    def __init__(self) -> None:
        clock = FakeClock()
        writes: list[bytes] = []
        outbox = Outbox(writes.append, print, Flusher(clock.call_soon), max_bytes=10**6)
        self._clock, self._writes = clock, writes
        self.statuses = Statuses("/node", outbox)

    def heard(self) -> list[dict[str, Any]]:
        self._clock.turn()
        heard = [json.loads(text) for data in self._writes for text in payloads(data)]
        self._writes.clear()
        return heard


@pytest.mark.parametrize(
    ("level", "heard"),
    [("none", ""), ("error", "e"), ("warning", "ew"), ("info", "ewi"), (None, "e")],
)
def test_the_level_may_be_set_at_any_time(level: Level | None, heard: str) -> None:
    told = Told()
    if level is not None:
        told.statuses.set_level("info")
        told.statuses.set_level(level)
    told.statuses.error(1, "e")
    told.statuses.warning(1, "w")
    told.statuses.info(1, "i")
    assert "".join(each["msg"] for each in told.heard()) == heard
    assert told.statuses.wants_info is (level == "info")


def test_errors_that_nobody_hears_are_logged_and_only_they(
    caplog: pytest.LogCaptureFixture,
) -> None:
    caplog.set_level("DEBUG")
    told = Told()
    told.statuses.set_level("none")
    told.statuses.warning(None, "w")
    told.statuses.info(None, "i")
    told.statuses.error(None, "e")
    assert [record.message for record in caplog.records] == ["/node: e (error 1 of this client)"]


def test_the_log_is_written_no_line_ends_and_a_client_no_long_texts(
    caplog: pytest.LogCaptureFixture,
) -> None:
    told = Told()
    told.statuses.error(None, "a\nb" + "x" * 10_000)
    [heard] = told.heard()
    assert heard["msg"].startswith("a\nbx")
    assert len(heard["msg"]) < 2000
    [record] = caplog.records
    assert record.message.startswith("/node: a\\nbx")
    assert len(record.message) < 2000
