"""Statuses: errors, and warnings and infos on request."""

from __future__ import annotations

import json
import re
from typing import Any

import pytest

from fibws.errors import InvalidUtf8
from fibws.hub.delivery.send_queue import Bytes, Flusher, SendQueue
from fibws.hub.log.text import MOST_DIFFERENT
from fibws.hub.rosbridge.statuses import RosbridgeStatuses
from fibws.protocol.decoding import REQUESTS
from fibws.protocol.operations import Level

from ..fakes import (
    INT32,
    Client,
    FakeClock,
    FakeHub,
    finish,
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
def test_texts_that_are_not_operations_are_refused(text: str, msg: str) -> None:
    client = FakeHub().client()
    client.send_text(text)
    assert client.receive_statuses() == [msg]


def test_error_ends_neither_the_session_nor_other_operations() -> None:
    client = FakeHub().client()
    client.send_text(
        '{"op":"advertise","topic":"/a","type":"std_msgs/Int32"}{"op":"fly"}'
        '{"op":"subscribe","topic":"/a"}{"op":"publish","topic":"/a"} garbage'
    )
    client.send("publish", "/a", msg=number(1))
    assert [each["op"] for each in client.receive()] == ["status", "publish", "status", "publish"]


@pytest.mark.parametrize("id_", ["subscribe:/t:1", "", 5, 0, -1.5, 2**70, True, False])
@pytest.mark.parametrize("op", ["fly", "publish", "subscribe"])
def test_status_carries_the_id_as_it_was_sent(op: str, id_: object) -> None:
    client = FakeHub().client()
    client.send(op, "not legal", id=id_)
    [status] = client.receive()
    assert (status["id"], type(status["id"])) == (id_, type(id_))


UUID_ID = "publish:/t:1b9d6bcd-bbfd-4b2d-9b5d-ab8dfbbd4bed"


@pytest.mark.parametrize("id_", ["subscribe:/t:1", "call_service:/a:b:23", UUID_ID])
def test_page_gets_the_status_of_a_roslib_operation_without_its_id(id_: str) -> None:
    client = FakeHub().client(is_page=True)
    client.send("fly", id=id_)
    [status] = client.receive()
    assert "id" not in status
    assert status["operation"] == id_


@pytest.mark.parametrize("id_", ["mine", "subscribe:/t", "publish::1", 5, ""])
def test_page_gets_its_own_ids_in_statuses(id_: object) -> None:
    client = FakeHub().client(is_page=True)
    client.send("fly", id=id_)
    [status] = client.receive()
    assert status["id"] == id_
    assert "operation" not in status


@pytest.mark.parametrize("id_", [None, [], {"a": 1}])
@pytest.mark.parametrize("op", ["fly", "publish", "subscribe"])
def test_invalid_id_is_left_out_of_the_status(op: str, id_: object) -> None:
    client = FakeHub().client()
    client.send(op, "not legal", id=id_)
    [status] = client.receive()
    assert "id" not in status


def test_invalid_id_of_a_publish_is_ignored() -> None:
    talker, listener = talker_and_listener(FakeHub())
    talker.send("publish", "/fib", msg={"data": "x"}, id=[1])
    [status] = talker.receive()
    assert "id" not in status
    assert listener.receive() == []


@pytest.mark.parametrize(
    ("level", "received"),
    [
        ("none", []),
        ("error", ["error"]),
        ("warning", ["warning", "error"]),
        ("info", ["warning", "info", "error"]),
    ],
)
def test_client_gets_statuses_of_its_level_and_above(level: str, received: list[str]) -> None:
    client = FakeHub().client()
    client.send("set_level", level=level)
    client.send("advertise", "/a", type="my_msgs/Thing")
    client.send("fly")
    assert [each["level"] for each in client.receive()] == received


def test_only_errors_are_sent_by_default() -> None:
    client = FakeHub().client()
    client.send("advertise", "/a", type="my_msgs/Thing")
    client.send("subscribe", "/b", compression="zip")
    assert client.receive() == []


def test_invalid_level_is_refused_and_the_old_one_stays() -> None:
    client = FakeHub().client()
    client.send("set_level", level="loud", id=1)
    assert [each["id"] for each in client.receive()] == [1]
    client.send("fly")
    assert len(client.receive()) == 1


def informed(hub: FakeHub, node: str = "/talker") -> Client:
    client = hub.client(node)
    client.send("set_level", level="info")
    return client


def test_advertisement_is_acknowledged_at_level_info() -> None:
    client = informed(FakeHub())
    client.send("advertise", "fib", type="std_msgs/msg/Int32", id=1)
    assert client.receive() == [
        {
            "op": "status",
            "id": 1,
            "level": "info",
            "msg": "/talker publishes /fib (std_msgs/Int32)",
        }
    ]


def test_subscription_that_waits_for_a_type_is_reported_at_level_info() -> None:
    client = informed(FakeHub())
    client.send("subscribe", "/fib", id="x")
    [status] = client.receive()
    assert (status["id"], status["level"]) == ("x", "info")
    assert status["msg"] == "/fib waits for a publisher to have a type"


def test_missing_fields_are_reported_at_level_info() -> None:
    hub = FakeHub()
    client = informed(hub)
    client.send("advertise", "/a", type="geometry_msgs/Twist")
    client.receive()
    zeros = {"x": 0, "y": 0, "z": 0}
    client.send("publish", "/a", msg={"linear": {"x": 1, "z": 1}}, id="p")
    client.send("publish", "/a", msg={"linear": zeros, "angular": zeros})
    client.send("publish", "/a")
    statuses = client.receive()
    assert [each["msg"] for each in statuses] == [
        "publish: defaults used for linear.y, angular",
        "publish: defaults used for linear, angular",
    ]
    assert statuses[0]["id"] == "p"


def test_status_overtakes_the_kept_messages_of_a_slow_client() -> None:
    talker, listener = talker_and_listener(FakeHub())
    listener.queue.pause()
    talker.send("publish", "/fib", msg=number(1))
    listener.send("fly")
    listener.queue.resume()
    assert [each["op"] for each in listener.receive()] == ["status", "publish"]


def test_many_errors_of_one_client_do_not_fill_the_log(caplog: pytest.LogCaptureFixture) -> None:
    client = FakeHub().client("/clumsy")
    for _ in range(1000):
        client.send("subscribe", "/")
    fault = "/clumsy: subscribe: '/' is not a legal name"
    lines = [record.message for record in caplog.records]
    assert [line.startswith(fault) for line in lines] == [True] * 5
    assert [re.findall(r"\(error (\d+) of this client", line) for line in lines] == [
        [str(count)] for count in (1, 2, 10, 100, 1000)
    ]
    assert len(client.receive()) == 1000


def test_each_different_error_of_a_client_is_logged_once(caplog: pytest.LogCaptureFixture) -> None:
    client = FakeHub().client("/clumsy")
    for op in ("fly", "swim", "fly", "run", "swim", "fly"):
        client.send(op)
    lines = [record.message for record in caplog.records]
    operations = [re.findall(r"Unknown operation: (\w+)", line) for line in lines]
    assert operations == [["fly"], ["swim"], ["fly"], ["run"]]
    # The first one that was there before says where the others are.
    assert ["fibws log" in line for line in lines] == [False, False, True, False]


def test_log_counts_different_errors_of_a_client_beyond_a_limit(
    caplog: pytest.LogCaptureFixture,
) -> None:
    client = FakeHub().client("/clumsy")
    for each in range(1, 101):
        client.send(f"fly_{each}")
    lines = [record.message for record in caplog.records]
    limit = MOST_DIFFERENT
    assert [re.findall(r"fly_(\d+)", line)[0] for line in lines] == [
        str(each) for each in (*range(1, limit + 2), 100)
    ]
    assert ["fibws log" in line for line in lines] == [False] * limit + [True, False]


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
def test_status_text_is_shortened(fields: dict[str, Any]) -> None:
    client = informed(FakeHub())
    client.send("advertise", "/fib", type=INT32)
    fragment(client, "", 0, 3, "x" * 10_000)
    client.receive()
    client.send_text(json.dumps(fields))
    [text] = [each["msg"] for each in client.receive()]
    assert len(text) < 2000


def test_text_that_is_not_utf8_raises() -> None:
    client = FakeHub().client()
    with pytest.raises(InvalidUtf8):
        finish(client.session.receive_text(b"\xff"))


# The object by itself.


class RecordedStatuses:
    """Statuses, and the operations that they sent."""

    def __init__(self) -> None:
        self._clock, self._writes = FakeClock(), list[Bytes]()
        flusher = Flusher(self._clock.call_soon)
        queue = SendQueue(self._writes.append, print, flusher, max_bytes=10**6)
        self.statuses = RosbridgeStatuses("/node", queue, codes=False)

    def sent(self) -> list[dict[str, Any]]:
        self._clock.turn()
        sent = [json.loads(text) for text in payloads(b"".join(self._writes))]
        self._writes.clear()
        return sent


@pytest.mark.parametrize(
    ("level", "received"),
    [("none", ""), ("error", "e"), ("warning", "ew"), ("info", "ewi"), (None, "e")],
)
def test_level_can_be_changed(level: Level | None, received: str) -> None:
    recorded = RecordedStatuses()
    if level is not None:
        recorded.statuses.set_level("info")
        recorded.statuses.set_level(level)
    recorded.statuses.error(1, "e")
    recorded.statuses.warning(1, "w")
    recorded.statuses.info(1, "i")
    assert "".join(each["msg"] for each in recorded.sent()) == received
    assert recorded.statuses.wants_info is (level == "info")


def test_errors_are_logged_even_if_the_client_wants_none(
    caplog: pytest.LogCaptureFixture,
) -> None:
    caplog.set_level("DEBUG")
    recorded = RecordedStatuses()
    recorded.statuses.set_level("none")
    recorded.statuses.warning(None, "w")
    recorded.statuses.info(None, "i")
    recorded.statuses.error(None, "e")
    assert [record.message for record in caplog.records] == ["/node: e (error 1 of this client)"]


def test_log_gets_no_line_breaks_and_clients_get_short_texts(
    caplog: pytest.LogCaptureFixture,
) -> None:
    recorded = RecordedStatuses()
    recorded.statuses.error(None, "a\nb" + "x" * 10_000)
    [received] = recorded.sent()
    assert received["msg"].startswith("a\nbx")
    assert len(received["msg"]) < 2000
    [record] = caplog.records
    assert record.message.startswith("/node: a\\nbx")
    assert len(record.message) < 2000
