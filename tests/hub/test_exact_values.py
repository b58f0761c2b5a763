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

from fibws.protocol.serialized import publish_head, read_delivery

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

PLAN = "nav_msgs/GetPlan"
GRIPPER = "control_msgs/GripperCommand"
ENDS = [(True, True), (True, False), (False, True), (False, False)]
"""Whether the client and the server speak ``fibws.v1``."""


def received_text(client: Client) -> bytes:
    """Return the one operation that came, as it came."""
    [(first, payload)] = client.receive_frames()
    assert first == TEXT
    return payload


def infinities(text: bytes, is_exact: bool) -> None:
    """Check the numbers in the text of an operation."""
    expected = [1, 1, 1] if is_exact else [0, 0, 3]
    found = [text.count(b":1e999"), text.count(b":-1e999"), text.count(b":null")]
    assert found == expected, text


def send(client: Client, op: str, **fields: object) -> None:
    """Send an operation in which infinity is a number that no float can hold."""
    text = json.dumps({"op": op, **fields})
    client.send_text(text.replace("Infinity", "1e999").replace("NaN", "null"))


@pytest.mark.parametrize(("is_client", "is_server"), ENDS)
def test_call_and_response_arrive_as_they_were_sent(is_client: bool, is_server: bool) -> None:
    hub = FakeHub()
    server = hub.client("/server", serialized=is_server)
    client = hub.client("/client", serialized=is_client)
    server.send("advertise_service", service="/plan", type=PLAN)
    pose = {"pose": {"position": {"x": math.inf, "y": -math.inf, "z": math.nan}}}
    send(client, "call_service", id="c", service="/plan", args={"goal": pose})
    text = received_text(server)
    infinities(text, is_server)
    values = {"plan": {"poses": [pose]}}
    id_ = json.loads(text)["id"]
    send(server, "service_response", id=id_, service="/plan", result=True, values=values)
    infinities(received_text(client), is_client)


@pytest.mark.parametrize(("is_client", "is_server"), ENDS)
def test_goal_feedback_and_result_arrive_as_they_were_sent(
    is_client: bool, is_server: bool
) -> None:
    hub = FakeHub()
    server = hub.client("/server", serialized=is_server)
    client = hub.client("/client", serialized=is_client)
    server.send("advertise_action", action="/grip", type=GRIPPER)
    goal = {"action": "/grip", "action_type": GRIPPER, "feedback": True}
    command = {"position": math.inf, "max_effort": -math.inf}
    send(client, "send_action_goal", id="g", args={"command": command}, **goal)
    text = received_text(server)
    assert (b'"max_effort":-1e999' if is_server else b'"max_effort":null') in text
    end = {"id": json.loads(text)["id"], "action": "/grip", "result": True, "status": 4}
    values = {"position": -math.inf, "effort": math.nan}
    for op in ("action_feedback", "action_result"):
        send(server, op, values=values, **end)
        text = received_text(client)
        assert (b'"position":-1e999' if is_client else b'"position":null') in text
        assert b'"effort":null' in text
