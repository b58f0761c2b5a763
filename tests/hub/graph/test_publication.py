"""Publications: one message in its original form and in all requested forms."""

from __future__ import annotations

import json
from collections.abc import Callable
from struct import pack
from typing import Any, NamedTuple

import cbor2
import pytest

from fibws.errors import OperationError
from fibws.hub.graph import publication as publication_module
from fibws.hub.graph.publication import Publication
from fibws.hub.graph.types import CheckedType, Types
from fibws.interfaces import Interfaces
from fibws.protocol.serialized import publish_head, read_delivery

from ..fakes import BINARY, INT32, NANOSECONDS, STRING, TEXT, Client, FakeHub

TYPES = Types(Interfaces(), lambda: NANOSECONDS, strict=False)
INVALID = b"ok \xff\xfe\xc3("
"""A text that is not UTF-8."""
REPLACED = INVALID.decode("utf-8", "replace")


def of_values(values: dict[str, Any], type_: str = INT32) -> Publication:
    message_type = TYPES.message(type_)
    return Publication(message_type, "/talker", b"{}", NANOSECONDS, message_type.validate(values))


def of_bytes(data: bytes, type_: str = INT32) -> Publication:
    message_type = TYPES.message(type_)
    message_type.check(data)
    return Publication(message_type, "/talker", b"{}", NANOSECONDS, None, data)


def string(data: bytes) -> bytes:
    """A std_msgs/String in ROS 1's serialization."""
    return pack("<I", len(data)) + data


BOTH: list[Callable[[], Publication]] = [
    lambda: of_values({"data": 5}),
    lambda: of_bytes(pack("<i", 5)),
]


# Forms.


@pytest.mark.parametrize("publication", BOTH, ids=["values", "bytes"])
def test_publication_has_every_form(publication: Callable[[], Publication]) -> None:
    assert publication().values() == {"data": 5}
    assert publication().ros1() == pack("<i", 5)
    assert publication().json() == publication().exact_json() == b'{"data":5}'
    assert cbor2.loads(publication().cbor()) == {"data": 5}


@pytest.mark.parametrize("publication", BOTH, ids=["values", "bytes"])
def test_every_form_is_made_once(
    publication: Callable[[], Publication], monkeypatch: pytest.MonkeyPatch
) -> None:
    made: list[str] = []

    def count(owner: Any, name: str) -> None:
        original = getattr(owner, name)

        def counted(*args: Any, **options: Any) -> Any:
            made.append(name)
            return original(*args, **options)

        monkeypatch.setattr(owner, name, counted)

    message = publication()
    type_ = message.type
    type_.serialize, type_.cbor  # noqa: B018 - compiles them, so that they can be replaced.
    for name in ("serialize", "deserialize", "cbor", "cbor_of"):
        count(type_, name)
    count(publication_module, "to_json")

    def make() -> bytes:
        made.append("cached")
        return b"x"

    for _ in range(3):
        assert message.cbor() is message.cbor()
        assert message.ros1() is message.ros1()
        assert message.json() is message.json()
        assert message.exact_json() is message.exact_json()
        assert message.values() is message.values()
        assert message.cached("key", make) == b"x"
    expected = ["cbor", "serialize"] if publication is BOTH[0] else ["cbor_of", "deserialize"]
    assert sorted(made) == sorted([*expected, "to_json", "cached"])


def test_exact_json_is_shared_with_json_where_all_floats_are_finite() -> None:
    finite = of_values({"data": 0.5}, "std_msgs/Float64")
    assert finite.exact_json() is finite.json()
    infinite = of_values({"data": float("inf")}, "std_msgs/Float64")
    assert (infinite.exact_json(), infinite.json()) == (b'{"data":1e999}', b'{"data":null}')


def test_bytes_are_not_decoded_without_a_json_subscriber(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    hub = FakeHub()
    talker = hub.client("/talker", serialized=True)
    talker.send("advertise", "/a", type=STRING, publisher=1, latch=True)
    listener, cbor, raw = hub.client(serialized=True), hub.client(), hub.client()
    listener.send("subscribe", "/a", type=STRING, compression="ros1")
    cbor.send("subscribe", "/a", compression="cbor")
    raw.send("subscribe", "/a", compression="cbor-raw")
    assert listener.receive_one("subscribed")
    monkeypatch.setattr(CheckedType, "deserialize", _fail)
    talker.send_binary(publish_head(1) + string(b"hello"))
    late = hub.client(serialized=True)
    late.send("subscribe", "/a", type=STRING, compression="ros1")
    assert talker.receive() == []
    assert messages(listener) == [string(b"hello")]
    assert [each["msg"] for each in cbor.receive_cbor()] == [{"data": "hello"}]
    assert [each["msg"]["bytes"] for each in raw.receive_cbor()] == [string(b"hello")]
    [(first, _), (second, payload)] = late.receive_frames()
    assert (first, second) == (TEXT, BINARY)
    assert bytes(read_delivery(payload).message) == string(b"hello")


def test_values_are_not_serialized_without_a_serialized_subscriber(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    hub = FakeHub()
    talker, listener = hub.client("/talker"), hub.client()
    talker.send("advertise", "/a", type=STRING)
    listener.send("subscribe", "/a")
    monkeypatch.setattr(CheckedType, "_serializer", None)
    talker.send("publish", "/a", msg={"data": "hello"})
    assert listener.receive_messages("/a") == [{"data": "hello"}]


@pytest.mark.parametrize("serialized", [False, True])
def test_compact_keeps_only_the_serialized_bytes(serialized: bool) -> None:
    data = string(b"hello")
    message = of_bytes(data, STRING) if serialized else of_values({"data": "hello"}, STRING)
    forms = (message.json(), message.exact_json(), message.cbor(), message.values())
    assert message.compact() == len(data)
    assert (message._values, message._json, message._cache) == (None, None, None)
    assert message.ros1() == data
    assert (message.json(), message.exact_json(), message.cbor(), message.values()) == forms


def test_compact_copies_bytes_out_of_a_larger_buffer() -> None:
    buffer = bytearray(b"head" + string(b"hello"))
    type_ = TYPES.message(STRING)
    message = Publication(type_, "/t", b"{}", NANOSECONDS, None, memoryview(buffer)[4:])
    message.compact()
    buffer[4:] = bytes(9)
    assert message.ros1() == string(b"hello")


def test_compact_keeps_json_of_an_unknown_type() -> None:
    message = of_values({"any": [1, float("-inf"), None]}, "my_msgs/Thing")
    assert message.compact() == len(b'{"any":[1,-1e999,null]}')
    assert message._values is None
    assert message.values() == {"any": [1, float("-inf"), None]}
    assert message.json() == b'{"any":[1,null,null]}'
    assert cbor2.loads(message.cbor()) == {"any": [1, float("-inf"), None]}


def test_message_of_an_unknown_type_cannot_be_serialized() -> None:
    message = of_values({"any": 1}, "my_msgs/Thing")
    with pytest.raises(OperationError, match="definition of my_msgs/Thing"):
        message.ros1()
    assert message.json() == b'{"any":1}'


# Text that is not UTF-8.


def test_invalid_utf8_is_relayed_unchanged_to_serialized_subscribers() -> None:
    message = of_bytes(string(INVALID), STRING)
    assert message.ros1() == string(INVALID)
    assert not message.has_invalid_text


@pytest.mark.parametrize("form", ["json", "exact_json", "values", "cbor"])
def test_invalid_utf8_is_replaced_in_text(form: str) -> None:
    message = of_bytes(string(INVALID), STRING)
    found: Any = getattr(message, form)()
    if form in ("json", "exact_json"):
        found = json.loads(found)
    elif form == "cbor":
        found = cbor2.loads(found)
    assert found == {"data": REPLACED}
    assert "\ufffd" in found["data"]
    assert message.has_invalid_text
    assert message.ros1() == string(INVALID)


def test_valid_text_is_not_marked_as_invalid() -> None:
    message = of_bytes(string("ok \ufffd".encode()), STRING)
    message.json()
    message.cbor()
    assert not message.has_invalid_text


def test_latched_message_with_invalid_utf8_keeps_its_bytes() -> None:
    message = of_bytes(string(INVALID), STRING)
    message.json()
    message.compact()
    assert message.ros1() == string(INVALID)
    assert message.values() == {"data": REPLACED}


@pytest.mark.parametrize("compression", ["none", "cbor"])
@pytest.mark.parametrize("to", [None, "/listener"])
def test_subscriber_is_warned_once_that_text_was_replaced(compression: str, to: str | None) -> None:
    hub = FakeHub()
    talker, listener = hub.client(serialized=True), hub.client("/listener")
    talker.send("advertise", "/a", type=STRING, publisher=1)
    listener.send("set_level", level="warning")
    listener.send("subscribe", "/a", compression=compression)
    for text in (b"fine", INVALID, INVALID):
        talker.send_binary(publish_head(1, to) + string(text))
    statuses = [
        json.loads(data)
        for _, data in listener.receive_frames()
        if data[:7] == b'{"op":"' and b'"status"' in data
    ]
    assert [each["level"] for each in statuses] == ["warning"]
    assert "/a" in statuses[0]["msg"]


# JSON and serialized clients understand each other.


class Row(NamedTuple):
    """A field's value in each form.

    ``published`` is what a JSON publisher writes; ``json`` and ``exact`` are what JSON subscribers
    get without and with headers.
    """

    field: str
    published: str
    ros1: bytes
    json: str
    exact: str


def row(field: str, published: str, ros1: bytes, json_: str = "", exact: str = "") -> Row:
    return Row(field, published, ros1, json_ or published, exact or json_ or published)


NAN, INFINITY = pack("<d", float("nan")), pack("<d", float("inf"))
NON_ASCII = "\u00e4 \u4e2d \N{ROBOT FACE}"
POINT = '{"x":%s,"y":0.0,"z":-0.0}'
ROWS = [
    row("float64", "NaN", NAN, "null"),
    row("float64", "null", NAN),
    row("float64", "1e999", INFINITY, "null", "1e999"),
    row("float64", "-1e999", pack("<d", float("-inf")), "null", "-1e999"),
    row("float32", "1e999", pack("<f", float("inf")), "null", "1e999"),
    row("float64", "-0.0", pack("<d", -0.0)),
    row("float64", "5e-324", pack("<d", 5e-324)),
    row("float64", "0.1", pack("<d", 0.1)),
    row("float64", "3", pack("<d", 3), "3.0"),
    row("float32", "0.1", pack("<f", 0.1), "0.10000000149011612"),
    row("float32", "-0.0", pack("<f", -0.0)),
    row("float32[2]", "[0.1,-0.0]", pack("<2f", 0.1, -0.0), "[0.10000000149011612,-0.0]"),
    row(
        "float64[]",
        "[NaN,1e999,-1e999,-0.0]",
        pack("<I", 4) + NAN + INFINITY + pack("<2d", float("-inf"), -0.0),
        "[null,null,null,-0.0]",
        "[null,1e999,-1e999,-0.0]",
    ),
    row("float64[]", "[]", pack("<I", 0)),
    row("int8", "-128", b"\x80"),
    row("uint8", "255", b"\xff"),
    row("byte", "-3", b"\xfd"),
    row("char", "200", b"\xc8"),
    row("bool", "true", b"\1"),
    row("bool[]", "[true,false]", pack("<I", 2) + b"\1\0"),
    row("int64", str(-(2**63)), pack("<q", -(2**63))),
    row("int64", str(2**63 - 1), pack("<q", 2**63 - 1)),
    row("uint64", str(2**64 - 1), pack("<Q", 2**64 - 1)),
    row("int64[]", f"[{-(2**63)},{2**63 - 1}]", pack("<Iqq", 2, -(2**63), 2**63 - 1)),
    row("time", '{"secs":4294967295,"nsecs":999999999}', pack("<II", 2**32 - 1, 999_999_999)),
    row("time[1]", '[{"secs":1,"nsecs":2}]', pack("<II", 1, 2)),
    row("duration", '{"secs":-2,"nsecs":500000000}', pack("<ii", -2, 500_000_000)),
    row("duration", '{"secs":-1,"nsecs":-500000000}', pack("<ii", -1, -500_000_000)),
    row("int32[3]", "[1,-2,3]", pack("<3i", 1, -2, 3)),
    row("uint8[]", '"/wAB"', pack("<I", 3) + b"\xff\0\1"),
    row("uint8[]", "[255,0,1]", pack("<I", 3) + b"\xff\0\1", '"/wAB"'),
    row("uint8[4]", '"/wABAg=="', b"\xff\0\1\2"),
    row("int8[]", "[-1,0,1]", pack("<I", 3) + b"\xff\0\1"),
    row("string", '"a\\u0000\\"b\\\\\\n"', string(b'a\0"b\\\n')),
    row("string", f'"{NON_ASCII}"', string(NON_ASCII.encode())),
    row("string[]", '["a","\u00e4"]', pack("<I", 2) + string(b"a") + string(b"\xc3\xa4")),
    row("string[2]", '["a",""]', string(b"a") + string(b"")),
    row(
        "geometry_msgs/Point[]",
        f"[{POINT % '1.5'},{POINT % 'null'}]",
        pack("<I", 2) + pack("<3d", 1.5, 0, -0.0) + NAN + pack("<2d", 0, -0.0),
    ),
    row(
        "diagnostic_msgs/KeyValue[2]",
        '[{"key":"a","value":""},{"key":"","value":"b"}]',
        string(b"a") + string(b"") + string(b"") + string(b"b"),
    ),
]  # fmt: skip


class Clients:
    """A JSON and a serialized publisher on one topic, and a subscriber for each form."""

    def __init__(self, field: str) -> None:
        hub = FakeHub()
        self.json_talker = hub.client("/json")
        self.talker = hub.client("/serialized", serialized=True)
        for client in (self.json_talker, self.talker):
            client.send(
                "advertise", "/a", type="my_msgs/Row", definition=f"{field} value\n", publisher=1
            )
        self.plain, self.exact, self.raw = hub.client(), hub.client(), hub.client()
        self.serialized = hub.client(serialized=True)
        self.plain.send("subscribe", "/a")
        self.exact.send("subscribe", "/a", headers=True)
        self.raw.send("subscribe", "/a", compression="cbor-raw")
        self.serialized.send("subscribe", "/a", compression="ros1")
        self.serialized.receive_one("subscribed")

    def check(self, expected: Row) -> None:
        """Check that every subscriber got the one message."""
        assert (self.json_talker.receive(), self.talker.receive()) == ([], [])
        assert messages(self.serialized) == [expected.ros1]
        assert [each["msg"]["bytes"] for each in self.raw.receive_cbor()] == [expected.ros1]
        assert value(self.plain) == expected.json
        assert value(self.exact) == expected.exact


def messages(client: Client) -> list[bytes]:
    """The messages of the binary frames that a client got; nothing else may have come."""
    found = client.receive_frames()
    assert {first for first, _ in found} <= {BINARY}
    return [bytes(read_delivery(payload).message) for _, payload in found]


def value(client: Client) -> str:
    """The field's JSON in the one message that a client got."""
    [(first, payload)] = client.receive_frames()
    assert first == TEXT
    text = payload.decode().partition('"value":')[2].partition(',"header":')[0]
    return text.rstrip("}") + "}" * (text.rstrip("}").count("{") - text.rstrip("}").count("}"))


@pytest.mark.parametrize("case", ROWS, ids=lambda case: f"{case.field} {case.published}"[:40])
def test_json_message_reaches_serialized_subscribers_exactly(case: Row) -> None:
    clients = Clients(case.field)
    text = f'{{"op":"publish","topic":"/a","msg":{{"value":{case.published}}}}}'
    clients.json_talker.send_text(text)
    clients.check(case)


@pytest.mark.parametrize("case", ROWS, ids=lambda case: f"{case.field} {case.published}"[:40])
def test_serialized_message_reaches_json_subscribers_exactly(case: Row) -> None:
    clients = Clients(case.field)
    clients.talker.send_binary(publish_head(1) + case.ros1)
    clients.check(case)


def test_any_nan_reaches_serialized_subscribers_unchanged() -> None:
    payload = bytes.fromhex("010000000000f47f")
    clients = Clients("float64")
    clients.talker.send_binary(publish_head(1) + payload)
    assert messages(clients.serialized) == [payload]
    assert value(clients.plain) == "null"


def _fail(*args: object) -> None:
    raise AssertionError("must not be called")
