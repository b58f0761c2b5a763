"""Numbers and bytes arrive as they were sent, from each kind of publisher to each subscriber.

JSON has no infinity and no NaN: rosbridge writes null for both, the hub's own clients get infinity
as a number that no float can hold.
"""

from __future__ import annotations

import json
import math
import struct
from base64 import b64encode
from collections.abc import Callable
from typing import Any

import cbor2
import pytest

from fibws.protocol.serialized import (
    operation_head,
    publish_head,
    read_delivery,
    read_operation,
)

from .fakes import BINARY, TEXT, Client, FakeHub
from .foxglove.foxglove_client import FoxgloveHub

DEFINITION = """float64[] numbers
float32 small
float64 zero
int64 low
uint64 high
uint8[] bytes
string text
"""
TYPE = "test_msgs/Exact"
NUMBERS = [math.inf, -math.inf, math.nan, -0.0, 5e-324, 0.1]
LOW, HIGH = -(2**63), 2**64 - 1
BYTES = bytes(range(256))
TEXT_VALUE = 'null 1e999 Infinity " \\ \0 ü'
DATA = (
    struct.pack("<I6dfdqQI", 6, *NUMBERS, -math.inf, -0.0, LOW, HIGH, len(BYTES))
    + BYTES
    + struct.pack("<I", len(TEXT_VALUE.encode()))
    + TEXT_VALUE.encode()
)
VALUES = {
    "numbers": NUMBERS,
    "small": -math.inf,
    "zero": -0.0,
    "low": LOW,
    "high": HIGH,
    "bytes": b64encode(BYTES).decode(),
    "text": TEXT_VALUE,
}
ROSBRIDGE = {**VALUES, "numbers": [None, None, None, -0.0, 5e-324, 0.1], "small": None}
"""What JSON of rosbridge has."""
EXACT = {**VALUES, "numbers": [math.inf, -math.inf, None, -0.0, 5e-324, 0.1]}
"""What JSON with infinity has."""


def same(found: object, expected: object) -> bool:
    """Return whether values are equal, the sign of zero and NaN included."""
    return repr(found) == repr(expected)


def exact_json(value: object) -> str:
    """Return JSON in which infinity is a number that no float can hold, and NaN is null."""
    text = json.dumps(value, ensure_ascii=False)
    text = text.replace("[Infinity, -Infinity, NaN", "[1e999, -1e999, null")
    return text.replace('"small": -Infinity', '"small": -1e999')


Publish = Callable[[], None]
Receive = Callable[[], object]


def json_publisher(hub: FoxgloveHub) -> Publish:
    client = hub.client("/talker")
    client.send("advertise", "/t", type=TYPE, definition=DEFINITION)
    text = exact_json(VALUES)
    return lambda: client.send_text(f'{{"op":"publish","topic":"/t","msg":{text}}}')


def json_publisher_with_names(hub: FoxgloveHub) -> Publish:
    """Write numbers that JavaScript lacks as strings."""
    client = hub.client("/talker")
    client.send("advertise", "/t", type=TYPE, definition=DEFINITION)
    names = ["Infinity", "-Infinity", "NaN", -0.0, 5e-324, 0.1]
    values = {"numbers": names, "small": "-Infinity", "low": str(LOW), "high": str(HIGH)}
    return lambda: client.send("publish", "/t", msg={**VALUES, **values})


def cbor_publisher(hub: FoxgloveHub) -> Publish:
    client = hub.client("/talker")
    client.send("advertise", "/t", type=TYPE, definition=DEFINITION)
    message = {**VALUES, "bytes": BYTES}
    return lambda: client.send_binary(cbor2.dumps({"op": "publish", "topic": "/t", "msg": message}))


def serialized_publisher(hub: FoxgloveHub) -> Publish:
    client = hub.client("/talker", serialized=True)
    client.send("advertise", "/t", type=TYPE, definition=DEFINITION, publisher=1)
    return lambda: client.send_binary(publish_head(1) + DATA)


def foxglove_publisher(hub: FoxgloveHub) -> Publish:
    client = hub.foxglove_client("/talker")
    client.advertise("/t", TYPE, schema=DEFINITION, schemaEncoding="ros1msg")
    return lambda: client.publish(1, DATA)


def subscriber(hub: FoxgloveHub, **fields: Any) -> Client:
    client = hub.client("/listener", serialized=fields.get("compression") == "ros1")
    client.send("subscribe", "/t", type=TYPE, **fields)
    return client


def json_subscriber(hub: FoxgloveHub) -> Receive:
    client = subscriber(hub)
    return lambda: client.receive_one("publish")["msg"]


def json_subscriber_with_headers(hub: FoxgloveHub) -> Receive:
    client = subscriber(hub, headers=True)
    return lambda: client.receive_one("publish")["msg"]


def json_subscriber_with_strings(hub: FoxgloveHub) -> Receive:
    client = subscriber(hub, int64="string")
    return lambda: client.receive_one("publish")["msg"]


def json_subscriber_with_strings_and_headers(hub: FoxgloveHub) -> Receive:
    client = subscriber(hub, int64="string", headers=True)
    return lambda: client.receive_one("publish")["msg"]


def cbor_subscriber(hub: FoxgloveHub) -> Receive:
    client = subscriber(hub, compression="cbor")

    def receive() -> object:
        message = client.receive_cbor()[0]["msg"]
        floats = message["numbers"].value
        return {**message, "numbers": list(struct.unpack("<6d", floats))}

    return receive


def cbor_raw_subscriber(hub: FoxgloveHub) -> Receive:
    client = subscriber(hub, compression="cbor-raw")
    return lambda: client.receive_cbor()[0]["msg"]["bytes"]


def serialized_subscriber(hub: FoxgloveHub) -> Receive:
    client = subscriber(hub, compression="ros1")
    client.receive_frames()

    def receive() -> bytes:
        [(first, payload)] = [each for each in client.receive_frames() if each[0] != TEXT]
        assert first == BINARY
        return bytes(read_delivery(payload).message)

    return receive


def foxglove_subscriber(hub: FoxgloveHub) -> Receive:
    client = hub.foxglove_client("/foxglove_listener")
    client.subscribe("/t")
    return lambda: client.receive_messages()[0][2]


AS_STRINGS = {"low": str(LOW), "high": str(HIGH)}


@pytest.mark.parametrize(
    ("subscribe", "expected"),
    [
        (json_subscriber, ROSBRIDGE),
        (json_subscriber_with_headers, EXACT),
        (json_subscriber_with_strings, {**ROSBRIDGE, **AS_STRINGS}),
        (json_subscriber_with_strings_and_headers, {**EXACT, **AS_STRINGS}),
        (cbor_subscriber, {**VALUES, "bytes": BYTES}),
        (cbor_raw_subscriber, DATA),
        (serialized_subscriber, DATA),
        (foxglove_subscriber, DATA),
    ],
)
@pytest.mark.parametrize(
    "publisher",
    [
        json_publisher,
        json_publisher_with_names,
        cbor_publisher,
        serialized_publisher,
        foxglove_publisher,
    ],
)
def test_message_arrives_as_it_was_sent(
    publisher: Callable[[FoxgloveHub], Publish],
    subscribe: Callable[[FoxgloveHub], Receive],
    expected: object,
) -> None:
    hub = FoxgloveHub()
    publish = publisher(hub)
    receive = subscribe(hub)
    publish()
    assert same(receive(), expected)


# Services and actions.

SERVICE = f"{DEFINITION}---\n{DEFINITION}"
ACTION = f"{DEFINITION}---\n{DEFINITION}---\n{DEFINITION}"
SERVICE_TYPE, ACTION_TYPE = "test_msgs/ExactCall", "test_msgs/ExactGoal"
ODD_NAN = struct.pack("<Q", 0xFFF0000000000123)
ODD = DATA[:20] + ODD_NAN + DATA[28:-3] + b"\xff" + DATA[-2:]
"""Another NaN, and a string that is not UTF-8: only bytes have them."""


class End:
    """A client or a server: its connection, and the form of its values."""

    def __init__(self, client: Client, *, exact: bool, serialized: bool) -> None:
        self.client = client
        self.exact = exact
        self.serialized = serialized

    @property
    def expected(self) -> object:
        """What arrives here of the values that the other end has sent."""
        return DATA if self.serialized else EXACT if self.exact else ROSBRIDGE

    def send(self, op: str, field: str, data: bytes = DATA, **fields: Any) -> None:
        text = json.dumps({"op": op, **fields})
        if self.serialized:
            self.client.send_binary(operation_head(text.encode()) + data)
        else:
            self.client.send_text(f'{text[:-1]}, "{field}": {exact_json(VALUES)}}}')

    def receive(self) -> dict[str, Any]:
        """Return the one operation that came; ``"body"`` has its values."""
        [(first, payload)] = self.client.receive_frames()
        assert first == (BINARY if self.serialized else TEXT), payload
        text, data = read_operation(payload) if self.serialized else (payload, b"")
        fields: dict[str, Any] = json.loads(text)
        name = fields.keys() & {"args", "values"}
        fields["body"] = data if self.serialized else fields[name.pop()]
        assert not name
        return fields


END_KINDS = {
    "rosbridge": {"exact": False, "serialized": False},
    "fibws.v1 in JSON": {"exact": True, "serialized": False},
    "fibws.v1": {"exact": True, "serialized": True},
}


def end(hub: FakeHub, node: str, kind: str) -> End:
    kinds = END_KINDS[kind]
    return End(hub.client(node, serialized=kinds["exact"]), **kinds)


def md5sums(hub: FakeHub) -> tuple[str, str]:
    """Return the md5s that clients of the service and of the action name."""
    action = hub.graph.actions["/a"].type.md5sum if "/a" in hub.graph.actions else ""
    service = hub.graph.services["/s"].type.md5sum if "/s" in hub.graph.services else ""
    return service or "", action or ""


def serve(hub: FakeHub, kind: str) -> End:
    """Return the server of a service and of an action."""
    server = end(hub, "/server", kind)
    for _ in range(2):  # The second time, the md5s are known.
        service, action = md5sums(hub)
        fields = {"compression": "ros1"} if server.serialized else {}
        more = {"type": SERVICE_TYPE, "definition": SERVICE, "md5sum": service}
        server.client.send("advertise_service", service="/s", **more, **fields)
        more = {"type": ACTION_TYPE, "definition": ACTION, "md5sum": action}
        server.client.send("advertise_action", action="/a", **more, **fields)
    assert server.client.receive() == []
    return server


@pytest.mark.parametrize("server_kind", END_KINDS)
@pytest.mark.parametrize("client_kind", END_KINDS)
def test_call_and_response_arrive_as_they_were_sent(client_kind: str, server_kind: str) -> None:
    hub = FakeHub()
    server = serve(hub, server_kind)
    client = end(hub, "/client", client_kind)
    client.send("call_service", "args", id="c", service="/s", md5sum=md5sums(hub)[0])
    call = server.receive()
    assert same(call["body"], server.expected)
    server.send("service_response", "values", id=call["id"], service="/s", result=True)
    response = client.receive()
    assert (response["id"], response["result"]) == ("c", True)
    assert same(response["body"], client.expected)


@pytest.mark.parametrize("server_kind", END_KINDS)
@pytest.mark.parametrize("encoding", ["ros1", "json"])
def test_calls_of_foxglove_arrive_as_they_were_sent(encoding: str, server_kind: str) -> None:
    hub = FoxgloveHub()
    server = serve(hub, server_kind)
    client = hub.foxglove_client("/foxglove")
    client.receive()
    is_json = encoding == "json"
    data = exact_json(VALUES).encode() if is_json else DATA
    client.call(client.services["/s"]["id"], data, encoding=encoding)
    call = server.receive()
    assert same(call["body"], server.expected)
    server.send("service_response", "values", id=call["id"], service="/s", result=True)
    *_, response = client.receive_response()
    assert same(json.loads(response) if is_json else response, ROSBRIDGE if is_json else DATA)


@pytest.mark.parametrize("server_kind", END_KINDS)
@pytest.mark.parametrize("client_kind", END_KINDS)
def test_goal_feedback_and_result_arrive_as_they_were_sent(
    client_kind: str, server_kind: str
) -> None:
    hub = FakeHub()
    server = serve(hub, server_kind)
    client = end(hub, "/client", client_kind)
    fields: dict[str, Any] = {"action": "/a", "action_type": ACTION_TYPE, "feedback": True}
    client.send("send_action_goal", "args", id="g", md5sum=md5sums(hub)[1], **fields)
    goal = server.receive()
    assert same(goal["body"], server.expected)
    end_ = {"id": goal["id"], "action": "/a", "result": True, "status": 4}
    for op in ("action_feedback", "action_result"):
        server.send(op, "values", **end_)
        received = client.receive()
        assert (received["op"], received["id"]) == (op, "g")
        assert same(received["body"], client.expected)


def test_bytes_that_json_cannot_express_arrive_unchanged() -> None:
    hub = FakeHub()
    server, client = serve(hub, "fibws.v1"), end(hub, "/client", "fibws.v1")
    service, action = md5sums(hub)
    client.send("call_service", "args", ODD, id="c", service="/s", md5sum=service)
    call = server.receive()
    assert call["body"] == ODD
    server.send("service_response", "values", ODD, id=call["id"], service="/s", result=True)
    assert client.receive()["body"] == ODD
    fields: dict[str, Any] = {"action": "/a", "action_type": ACTION_TYPE, "md5sum": action}
    client.send("send_action_goal", "args", ODD, id="g", **fields)
    goal = server.receive()
    assert goal["body"] == ODD
    server.send("action_result", "values", ODD, id=goal["id"], action="/a", result=True)
    assert client.receive()["body"] == ODD


@pytest.mark.parametrize("md5sum", ["0" * 32, "", None])
def test_bytes_of_another_definition_are_refused_before_the_server_gets_them(
    md5sum: str | None,
) -> None:
    hub = FakeHub()
    server, client = serve(hub, "fibws.v1"), end(hub, "/client", "fibws.v1")
    fields: dict[str, Any] = {} if md5sum is None else {"md5sum": md5sum}
    client.send("call_service", "args", id="c", service="/s", **fields)
    response = client.client.receive_one("service_response")
    assert (response["id"], response["code"]) == ("c", "not_serialized")
    goal = {"action": "/a", "action_type": ACTION_TYPE, **fields}
    client.send("send_action_goal", "args", id="g", **goal)
    result = client.client.receive_one("action_result")
    assert (result["id"], result["code"]) == ("g", "not_serialized")
    assert server.client.receive() == []


def test_server_of_another_definition_gets_json() -> None:
    hub = FakeHub()
    server, client = serve(hub, "fibws.v1"), end(hub, "/client", "fibws.v1")
    fields = {"type": SERVICE_TYPE, "definition": SERVICE, "compression": "ros1"}
    server.client.send("advertise_service", service="/s", md5sum="0" * 32, **fields)
    client.send("call_service", "args", id="c", service="/s", md5sum=md5sums(hub)[0])
    assert same(server.client.receive_one("call_service")["args"], EXACT)


def test_invalid_bytes_of_a_response_fail_the_call() -> None:
    hub = FakeHub()
    server, client = serve(hub, "fibws.v1"), end(hub, "/client", "fibws.v1")
    service, action = md5sums(hub)
    client.send("call_service", "args", id="c", service="/s", md5sum=service)
    id_ = server.receive()["id"]
    server.send("service_response", "values", DATA[:-1], id=id_, service="/s", result=True)
    assert client.client.receive_one("service_response")["code"] == "invalid_message"
    fields: dict[str, Any] = {"action": "/a", "action_type": ACTION_TYPE, "md5sum": action}
    client.send("send_action_goal", "args", id="g", **fields)
    assert len(server.client.receive_frames()) == 2  # a status, and the goal
    [goal] = hub.graph.actions["/a"].goals.values()
    server.send("action_result", "values", b"", id=goal.id, action="/a", result=True)
    assert client.client.receive_one("action_result")["code"] == "invalid_message"


def test_bytes_with_too_many_values_for_json_fail_the_call_or_the_goal(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    hub = FakeHub()
    server, client = serve(hub, "rosbridge"), end(hub, "/client", "fibws.v1")
    service, action = md5sums(hub)
    monkeypatch.setattr("fibws.hub.graph.types.FEWEST_BYTES", 0)
    monkeypatch.setattr("fibws.interfaces.serialization.MOST_WEIGHT", 0)
    client.send("call_service", "args", id="c", service="/s", md5sum=service)
    assert "too many values" in client.client.receive_one("service_response")["values"]
    fields: dict[str, Any] = {"action": "/a", "action_type": ACTION_TYPE, "md5sum": action}
    client.send("send_action_goal", "args", id="g", **fields)
    assert "too many values" in client.client.receive_one("action_result")["values"]
    assert server.client.receive() == []
    assert hub.graph.actions["/a"].goals == {}


def test_bytes_with_too_many_values_for_json_fail_the_response_or_the_result(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    hub = FakeHub()
    server, client = serve(hub, "fibws.v1"), end(hub, "/client", "rosbridge")
    monkeypatch.setattr("fibws.hub.graph.types.FEWEST_BYTES", 0)
    monkeypatch.setattr("fibws.interfaces.serialization.MOST_WEIGHT", 0)
    client.send("call_service", "args", id="c", service="/s")
    id_ = server.receive()["id"]
    server.send("service_response", "values", id=id_, service="/s", result=True)
    assert "too many values" in client.client.receive_one("service_response")["values"]
    client.send("send_action_goal", "args", id="g", action="/a", action_type=ACTION_TYPE)
    id_ = server.receive()["id"]
    server.send("action_feedback", "values", id=id_, action="/a")
    assert client.client.receive() == [], "it has not asked for feedback"
    server.send("action_result", "values", id=id_, action="/a", result=True)
    assert "too many values" in client.client.receive_one("action_result")["values"]


def test_response_with_too_many_values_for_json_fails_a_call_of_foxglove(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    hub = FoxgloveHub()
    server = serve(hub, "fibws.v1")
    client = hub.foxglove_client("/foxglove")
    client.receive()
    client.call(client.services["/s"]["id"], exact_json(VALUES).encode(), encoding="json")
    id_ = server.receive()["id"]
    monkeypatch.setattr("fibws.hub.graph.types.FEWEST_BYTES", 0)
    monkeypatch.setattr("fibws.interfaces.serialization.MOST_WEIGHT", 0)
    server.send("service_response", "values", id=id_, service="/s", result=True)
    assert "too many values" in client.receive_one("serviceCallFailure")["message"]


@pytest.mark.parametrize(
    "frame",
    [
        b"\x03\xff\xff\xff\xff{}",
        b"\x03\x02\x00",
        operation_head(b"{"),
        operation_head(b"\xff"),
        operation_head(b"[]"),
        operation_head(b"{}{}"),
        operation_head(b'{"op":"publish"}'),
        operation_head(b'{"op":["call_service"]}'),
        operation_head(b'{"op":"call_service","service":"/s","id":"c","md5sum":1}'),
    ],
)
def test_invalid_frame_gets_a_status(frame: bytes) -> None:
    client = FakeHub().client(serialized=True)
    client.send_binary(frame)
    [status] = client.receive()
    assert (status["op"], status["level"]) == ("status", "error")
