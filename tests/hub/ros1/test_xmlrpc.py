"""XML-RPC as bytes, checked against the standard library's."""

from __future__ import annotations

import gc
import math
import random
import weakref
import xmlrpc.client
from contextlib import suppress
from datetime import datetime
from typing import Any

import pytest
from random_inputs import times

from fibws.hub.errors import XmlRpcError
from fibws.hub.ros1.xmlrpc import (
    DEEPEST,
    CallParser,
    iter_response,
    write_call,
    write_fault,
    write_value,
)

VALUES: list[Any] = [
    0,
    -(2**31),
    2**31 - 1,
    1.5,
    1e300,
    True,
    False,
    "",
    "ä <&> ]]> \n\t 'x' \"y\" 😀",
    b"",
    b"\x00\xff",
    datetime(2020, 2, 29, 12, 34, 56),
    datetime(1, 1, 1),
    [],
    [1, [2, [3]], "x"],
    {},
    {"a": 1, "ä <b>": {"c": [{"d": False}]}},
]


def parse_call(data: bytes) -> tuple[str, list[Any]]:
    parser = CallParser()
    parser.feed(data)
    return parser.call()


def parse_response(data: bytes) -> Any:
    parser = CallParser()
    parser.feed(data)
    return parser.response()


def write_response(value: object) -> bytes:
    return b"".join(iter_response(value))


@pytest.mark.parametrize("value", VALUES, ids=repr)
def test_values_are_read_and_written_as_by_the_standard_library(value: Any) -> None:
    theirs = xmlrpc.client.dumps(("/a", value), "setParam").encode()
    assert parse_call(theirs) == ("setParam", ["/a", value])
    ours = write_call("setParam", ["/a", value])
    assert xmlrpc.client.loads(ours, use_builtin_types=True) == (("/a", value), "setParam")
    assert parse_response(write_response(value)) == value


@pytest.mark.parametrize("body", [write_call("f", ["text"]), b"<x/>", b"</x>"])
def test_parser_is_freed_once_a_message_was_read(body: bytes) -> None:
    """Its values may be megabytes, and the cyclic garbage collector may come late."""
    gc.disable()
    try:
        parser = CallParser()
        freed = weakref.ref(parser)
        with suppress(XmlRpcError):
            parser.feed(body)
            parser.call()
        del parser
        assert freed() is None
    finally:
        gc.enable()


def test_text_without_a_type_is_a_string() -> None:
    body = (
        b"<methodResponse><params><param><value> a&lt;b </value></param></params></methodResponse>"
    )
    assert parse_response(body) == " a<b "
    assert parse_response(body.replace(b" a&lt;b ", b"")) == ""


def test_whitespace_between_tags_is_ignored() -> None:
    value = {"a": [1, "x"], "b": b"12" * 100}
    body = xmlrpc.client.dumps((value,), "m").replace("><", ">\n\t <")
    assert parse_call(body.encode()) == ("m", [value])


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (2**31, "<value><double>2147483648.0</double></value>"),
        (-(2**40), "<value><double>-1099511627776.0</double></value>"),
        (2**63, "<value><string>9223372036854775808</string></value>"),
    ],
)
def test_integers_beyond_32_bits_are_not_written_as_integers(value: int, text: str) -> None:
    assert write_value(value) == text


def test_special_floats_are_kept() -> None:
    assert math.isnan(parse_response(write_response(math.nan)))
    assert parse_response(write_response(-math.inf)) == -math.inf


def test_characters_that_xml_cannot_hold_are_replaced() -> None:
    assert parse_response(write_response("a\x00b\ud800")) == "a\ufffdb\ufffd"


def test_fault_is_raised() -> None:
    with pytest.raises(XmlRpcError, match="no such method"):
        parse_response(write_fault(1, "no such method"))
    with pytest.raises(XmlRpcError, match="too big"):
        parse_response(xmlrpc.client.dumps(xmlrpc.client.Fault(7, "too big")).encode())


def value_xml(text: str) -> bytes:
    head = "<methodCall><methodName>m</methodName><params><param>"
    return f"{head}<value>{text}</value></param></params></methodCall>".encode()


@pytest.mark.parametrize(
    "body",
    [
        b"",
        b"hello",
        b"<methodCall>",
        b"<methodCall></methodCall>",
        b"<methodCall><methodName></methodName></methodCall>",
        b"<!DOCTYPE x [<!ENTITY a 'b'>]>" + value_xml("&a;"),
        value_xml("<int>x</int>"),
        value_xml("<int></int>"),
        value_xml("<boolean>2</boolean>"),
        value_xml("<double>1,5</double>"),
        value_xml("<base64>%%%=</base64>"),
        value_xml("<dateTime.iso8601>today</dateTime.iso8601>"),
        value_xml("<nil/>"),
        value_xml("<blob>x</blob>"),
        value_xml("<struct><member><name>a</name></member></struct>"),
        value_xml("<struct><member><value>1</value></member></struct>"),
        value_xml("<struct><member><value><int>1</int></value><name>a</name></member></struct>"),
        value_xml("<array><data>" * 200 + "</data></array>" * 200),
        b"\xff\xfe" + value_xml("<int>1</int>"),
    ],
)
def test_invalid_calls_are_refused(body: bytes) -> None:
    with pytest.raises(XmlRpcError):
        parse_call(body)


def test_nesting_is_limited_and_deep_values_are_read() -> None:
    value: Any = 1
    for _ in range(DEEPEST):
        value = [value]
    assert parse_response(write_response(value)) == value
    with pytest.raises(XmlRpcError, match=str(DEEPEST)):
        parse_response(write_response([value]))


def test_call_may_come_in_pieces() -> None:
    body = xmlrpc.client.dumps(("ä" * 10, {"a": 1}), "m").encode()
    parser = CallParser()
    for at in range(len(body)):
        parser.feed(body[at : at + 1])
    assert parser.call() == ("m", ["ä" * 10, {"a": 1}])


@pytest.mark.parametrize("seed", range(times(1)))
def test_random_damage_is_refused_or_read(seed: int) -> None:
    chance = random.Random(seed)
    body = bytearray(xmlrpc.client.dumps((VALUES,), "m").encode())
    for _ in range(200):
        damaged = bytearray(body)
        for _ in range(chance.randrange(1, 4)):
            at = chance.randrange(len(damaged))
            damaged[at : at + chance.randrange(3)] = chance.randbytes(chance.randrange(3))
        try:
            method, params = parse_call(bytes(damaged))
        except XmlRpcError:
            continue
        assert isinstance(method, str)
        assert isinstance(params, list)
