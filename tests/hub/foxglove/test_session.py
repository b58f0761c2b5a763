"""Sessions: texts and bytes of all kinds, the connection graph, time, limits and quotas."""

from __future__ import annotations

import json
import struct
import tracemalloc
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fibws.errors import AuthenticationError, InvalidUtf8
from fibws.hub.delivery.send_queue import SendQueue
from fibws.hub.foxglove.messages import (
    MOST_ITEMS,
    ClientMessage,
    parse_binary,
    parse_operation,
)
from fibws.hub.websocket.endpoint import Opening

from ..fakes import ADD, INT32, STRING, finish, number
from .foxglove_client import FoxgloveHub

OPS = (
    *("subscribe", "unsubscribe", "advertise", "unadvertise", "getParameters", "setParameters"),
    *("subscribeParameterUpdates", "unsubscribeParameterUpdates", "fetchAsset"),
    *("subscribeConnectionGraph", "unsubscribeConnectionGraph"),
)
FIELDS = (
    *("subscriptions", "subscriptionIds", "channels", "channelIds", "parameterNames", "id"),
    *("parameters", "uri", "requestId"),
)
NAMES = st.sampled_from(("/fib", "/a/b", "/", "bad name", "/add", INT32, STRING, "ros1", "json"))
SCALARS = st.one_of(
    st.none(), st.booleans(), st.integers(-1, 3), st.integers(), st.floats(), st.text(max_size=3)
)
VALUES = st.recursive(
    SCALARS | NAMES,
    lambda inner: (
        st.lists(inner, max_size=3)
        | st.dictionaries(
            st.sampled_from(
                ("id", "channelId", "topic", "encoding", "schemaName", "name", "value", "type")
            ),
            inner,
        )
    ),
    max_leaves=8,
)


@given(st.lists(st.tuples(st.sampled_from(OPS), st.dictionaries(st.sampled_from(FIELDS), VALUES))))
def test_any_operations_are_answered_and_leave_nothing(
    operations: list[tuple[str, dict[str, Any]]],
) -> None:
    hub = FoxgloveHub()
    client = hub.foxglove_client()
    for op, fields in operations:
        finish(client.session.receive_text(json.dumps({"op": op, **fields}).encode()))
        client.receive()
    client.send("getParameters", parameterNames=["/nothing"], id="alive")
    assert client.receive_one("parameterValues")["id"] == "alive"
    client.disconnect()
    assert hub.empty


@given(st.binary(max_size=40) | st.builds(json.dumps, VALUES).map(str.encode))
def test_any_text_is_answered(text: bytes) -> None:
    client = FoxgloveHub().foxglove_client()
    client.receive()
    try:
        finish(client.session.receive_text(text))
    except InvalidUtf8:
        with pytest.raises(UnicodeDecodeError):
            text.decode()
        return
    [status] = client.receive_statuses()
    assert len(status) < 3000


@given(
    st.lists(
        st.binary(max_size=30)
        | st.builds(
            lambda kind, channel, rest: struct.pack("<BI", kind, channel) + rest,
            st.integers(0, 4),
            st.integers(0, 3),
            st.binary(max_size=30),
        )
    )
)
def test_any_binary_messages_are_taken(messages: list[bytes]) -> None:
    hub = FoxgloveHub()
    hub.client("/server").send("advertise_service", service="/add", type=ADD)
    client = hub.foxglove_client()
    client.advertise("/fib", INT32, 1)
    client.advertise("/text", STRING, 2, encoding="json")
    client.receive()
    for message in messages:
        client.send_binary(message)
    for each in client.receive():
        assert isinstance(each, dict)
        assert each["op"] in ("status", "serviceCallFailure")
    client.advertise("/last", INT32, 3)
    client.receive()
    assert "/last" in client.channels


@given(st.integers(0, 2**32 - 1), st.integers(0, 2**32 - 1), st.text(), st.binary())
def test_binary_messages_are_read(service: int, call: int, encoding: str, data: bytes) -> None:
    message = parse_binary(struct.pack("<BI", 1, service) + data)
    assert message == ClientMessage(service, memoryview(data))
    name = encoding.encode()
    head = struct.pack("<BIII", 2, service, call, len(name))
    assert parse_binary(head + name + data) == (service, call, encoding, memoryview(data))


@pytest.mark.parametrize(
    ("text", "fault"),
    [
        ("{", "JSON"),
        ("[]", "op"),
        ("{}", "op"),
        ('{"op": 1}', "op"),
        ('{"op": "nothing"}', "unknown op 'nothing'"),
        ('{"op": "subscribe"}', "subscribe: subscriptions"),
        ('{"op": "subscribe", "subscriptions": [{"id": -1, "channelId": 1}]}', "got -1"),
        ('{"op": "unsubscribe", "subscriptionIds": [4294967296]}', "4294967296"),
    ],
)
def test_error_names_what_is_wrong(text: str, fault: str) -> None:
    hub = FoxgloveHub()
    client = hub.foxglove_client()
    finish(client.session.receive_text(text.encode()))
    [status] = client.receive_statuses()
    assert fault in status
    assert hub.reported == [("/foxglove", status)]


def test_text_with_too_many_values_is_refused_unread() -> None:
    client = FoxgloveHub().foxglove_client()
    text = '{"op": "unsubscribe", "subscriptionIds": [' + "[]," * 300_000 + "1]}"
    finish(client.session.receive_text(text.encode()))
    [status] = client.receive_statuses()
    assert "too many" in status


def test_operation_with_many_invalid_parts_takes_little_memory() -> None:
    client = FoxgloveHub().foxglove_client()
    ids = b",".join([b'""'] * 50_000)
    text = b'{"op": "unsubscribe", "subscriptionIds": [%b]}' % ids
    tracemalloc.start()
    try:
        finish(client.session.receive_text(text))
        most = tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()
    [status] = client.receive_statuses()
    assert "subscriptionIds: 0: " in status
    assert most < 2**20


def test_operation_with_too_many_parts_is_refused_as_a_whole() -> None:
    client = FoxgloveHub().foxglove_client()
    many = [{"id": number, "channelId": 99} for number in range(MOST_ITEMS + 1)]
    client.send("subscribe", subscriptions=many)
    [status] = client.receive_statuses()
    assert str(MOST_ITEMS) in status


def test_fault_of_the_hub_is_one_status_and_the_session_goes_on(
    monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    client = FoxgloveHub().foxglove_client()

    def fail(*_: object) -> None:
        raise ZeroDivisionError

    with monkeypatch.context() as patch:
        patch.setattr("fibws.hub.foxglove.parameters.ParameterAccess.get", fail)
        patch.setattr("fibws.hub.foxglove.topics.Publications.publish", fail)
        client.send("getParameters", parameterNames=[])
        client.publish(1, b"")
    for status in client.receive_statuses():
        assert "log" in status
    assert "ZeroDivisionError" in caplog.text
    caplog.clear()
    client.send("getParameters", parameterNames=[])
    assert client.receive_one("parameterValues")["parameters"] == []


# The connection graph.


def test_connection_graph_is_sent_and_then_its_changes() -> None:
    hub = FoxgloveHub()
    talker, listener = hub.client("/talker"), hub.client("/listener")
    talker.send("advertise", "/fib", type=INT32)
    listener.send("subscribe", "/fib")
    listener.send("advertise_service", service="/add", type=ADD)
    client = hub.foxglove_client()
    client.receive()
    client.send("subscribeConnectionGraph")
    client.send("subscribeConnectionGraph")
    assert client.receive_one("connectionGraphUpdate") == {
        "op": "connectionGraphUpdate",
        "publishedTopics": [{"name": "/fib", "publisherIds": ["/talker"]}],
        "subscribedTopics": [{"name": "/fib", "subscriberIds": ["/listener"]}],
        "advertisedServices": [{"name": "/add", "providerIds": ["/listener"]}],
        "removedTopics": [],
        "removedServices": [],
    }
    client.subscribe("/fib")
    update = client.receive_one("connectionGraphUpdate")
    assert update["publishedTopics"] == []
    assert update["subscribedTopics"] == [
        {"name": "/fib", "subscriberIds": ["/foxglove", "/listener"]}
    ]
    talker.disconnect()
    update = client.receive_one("connectionGraphUpdate")
    assert update["publishedTopics"] == [{"name": "/fib", "publisherIds": []}]
    assert update["removedTopics"] == []
    listener.disconnect()
    update = client.receive_one("connectionGraphUpdate")
    assert (update["removedTopics"], update["removedServices"]) == (["/fib"], ["/add"])
    client.send("unsubscribeConnectionGraph")
    hub.client("/talker").send("advertise", "/fib", type=INT32)
    assert client.receive() == []
    client.send("subscribeConnectionGraph")
    update = client.receive_one("connectionGraphUpdate")
    assert update["publishedTopics"] == [{"name": "/fib", "publisherIds": ["/talker"]}]


# Time.


def test_simulated_time_is_sent_while_it_lasts() -> None:
    hub = FoxgloveHub()
    client = hub.foxglove_client()
    client.receive()
    assert "time" not in client.info["capabilities"]
    hub.graph.clock.simulated = 5
    hub.graph.clock.simulated = 2**40
    assert client.receive() == [struct.pack("<BQ", 2, 5), struct.pack("<BQ", 2, 2**40)]
    assert "time" in client.info["capabilities"]
    newer = hub.foxglove_client("/newer")
    assert newer.receive() == [struct.pack("<BQ", 2, 2**40)]
    client.pause()
    for time in range(100):
        hub.graph.clock.simulated = time
    client.queue.resume()
    assert client.receive() == [struct.pack("<BQ", 2, 99)]
    hub.graph.clock.simulated = None
    assert client.receive() == []
    assert "time" not in client.info["capabilities"]


# Limits.


def test_excess_is_dropped_and_counted_and_calls_fail() -> None:
    hub = FoxgloveHub()
    client = hub.foxglove_client()
    client.advertise("/fib", INT32)
    listener = hub.client("/listener")
    listener.send("subscribe", "/fib")
    message = struct.pack("<BI", 1, 1) + struct.pack("<i", 1)
    for _ in range(20):
        client.session.refuse(message, "too much", is_text=False)
    first, second = client.receive_statuses()
    assert "too much" in first
    assert second.endswith("10")
    assert listener.receive() == []
    call = struct.pack("<BIII", 2, 3, 4, 4) + b"ros1"
    client.session.refuse(call, "too much", is_text=False)
    failure = client.receive_one("serviceCallFailure")
    assert (failure["serviceId"], failure["callId"]) == (3, 4)
    client.session.refuse(b'{"op":"subscribeConnectionGraph"}', "too much", is_text=True)
    client.session.refuse(b"{", "too much", is_text=True)
    client.session.refuse(b"\7", "too much", is_text=False)
    assert len(client.receive_statuses()) == 3
    with pytest.raises(InvalidUtf8):
        client.session.refuse(b"\xff", "too much", is_text=True)


def test_client_that_reads_no_answers_becomes_overfull() -> None:
    hub = FoxgloveHub(max_queued_bytes=10_000)
    hub.client("/server").send("advertise_service", service="/add", type=ADD)
    client = hub.foxglove_client()
    client.pause()
    while not client.queue.overfull:
        client.send("nothing")
    kept = client.queue.kept_bytes
    for _ in range(10):
        client.send("getParameters", parameterNames=[])
        client.call(client.services["/add"]["id"], bytes(16))
        client.send("nothing")
    assert client.queue.kept_bytes == kept


def test_client_must_bring_its_token_with_its_handshake() -> None:
    hub = FoxgloveHub()
    queue = SendQueue(lambda data: None, lambda: None, hub.flusher, max_bytes=1000)

    def log_in(token: str) -> Any:
        raise AssertionError

    with pytest.raises(AuthenticationError, match="token"):
        hub.foxglove.open(Opening(None, queue, lambda reason: None, log_in=log_in), "x")


def test_operations_are_models() -> None:
    operation = parse_operation(b'{"op":"fetchAsset","uri":"package://a/b","requestId":1,"x":2}')
    assert operation.op == "fetchAsset"


def test_messages_are_received_by_a_client_without_a_name() -> None:
    hub = FoxgloveHub()
    talker, client = hub.client("/talker"), hub.foxglove_client(None)
    talker.send("advertise", "/fib", type=INT32)
    client.subscribe("/fib")
    talker.send("publish", "/fib", msg=number(1))
    assert len(client.receive_messages()) == 1
    assert client.session.node.startswith("/client_")
    assert list(client.session.providing()) == []
