"""Decoding JSON text, CBOR, and the fields of operations."""

from __future__ import annotations

import json
import math
from struct import pack
from time import process_time
from typing import Any, get_args

import cbor2
import numpy
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fibws.errors import InvalidUtf8, OperationError
from fibws.interfaces import Interfaces, Validators
from fibws.protocol.decoding import (
    DEEPEST,
    REPLIES,
    REQUESTS,
    decode_cbor,
    decode_json,
    parse_reply,
    parse_request,
    quoted,
)
from fibws.protocol.operations import LONGEST_ID, Request, Status, Subscribe, encode

# JSON text

FINITE_JSON = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats(allow_nan=False) | st.text(),
    lambda inner: st.lists(inner) | st.dictionaries(st.text(), inner),
    max_leaves=10,
)
OBJECTS = st.lists(st.dictionaries(st.text(), FINITE_JSON, max_size=3), max_size=4)
SPACE = st.text(" \t\r\n", max_size=3)


@pytest.mark.parametrize(
    ("text", "found"),
    [
        (b'{"op":"x"}', [{"op": "x"}]),
        (b' {"a":1} ', [{"a": 1}]),
        (b'{"a":1}{"b":2}', [{"a": 1}, {"b": 2}]),
        (b'\n{"a":{"b":[]}} \t\r\n {"b":"}{"} ', [{"a": {"b": []}}, {"b": "}{"}]),
        (b"{}{}{}", [{}, {}, {}]),
        ('{"ä":"\N{ROBOT FACE}"}{}'.encode(), [{"ä": "\N{ROBOT FACE}"}, {}]),
        (b'{"a":18446744073709551616}', [{"a": 2**64}]),
    ],
)
def test_text_may_have_several_objects_in_a_row(text: bytes, found: list[dict[str, Any]]) -> None:
    assert list(decode_json(text)) == found


@pytest.mark.parametrize("text", [b"", b" ", b"\r\n\t "])
def test_empty_text_has_no_decode_json(text: bytes) -> None:
    assert list(decode_json(text)) == []


@pytest.mark.parametrize("value", [b"1", b"true", b"null", b'"a"', b'[{"op":"x"}]', b"NaN"])
def test_value_that_is_not_an_object_is_refused(value: bytes) -> None:
    with pytest.raises(OperationError, match=r"Expected a JSON object\. Original message was"):
        list(decode_json(value))


@pytest.mark.parametrize(
    "text",
    [b"{", b'{"a":}', b"x", b"{'a':1}", b"{]", b'{"a":1,}', b"\xef\xbb\xbf{}", b"[" * 100_000],
)
def test_invalid_json_is_refused(text: bytes) -> None:
    with pytest.raises(OperationError, match="Expected JSON objects"):
        list(decode_json(text))


@pytest.mark.parametrize("garbage", [b"x", b'{"c"', b"3", b"[]", b"\x00"])
def test_objects_before_invalid_json_are_returned(garbage: bytes) -> None:
    found = iter(decode_json(b'{"a":1} {"b":2} ' + garbage))
    assert [next(found), next(found)] == [{"a": 1}, {"b": 2}]
    with pytest.raises(OperationError):
        next(found)


@pytest.mark.parametrize("text", [b"\xff", b'{"a":"\xff"}', b"{}\xff", b'{"a":"\xed\xa0\x80"}'])
def test_invalid_utf8_is_reported(text: bytes) -> None:
    with pytest.raises(InvalidUtf8):
        list(decode_json(text))


@pytest.mark.parametrize("text", [rb'{"a":"\ud800"}', rb'{}{"a":"\udc00"}'])
def test_lone_surrogate_is_refused(text: bytes) -> None:
    with pytest.raises(OperationError):
        list(decode_json(text))


def test_surrogate_pair_is_one_character() -> None:
    assert list(decode_json(rb'{"a":"\ud83e\udd16"}')) == [{"a": "\N{ROBOT FACE}"}]


def test_nan_and_infinity_are_accepted() -> None:
    [found] = decode_json(b'{"a":NaN,"b":Infinity,"c":-Infinity,"d":1e400}')
    assert math.isnan(found["a"])
    assert (found["b"], found["c"], found["d"]) == (math.inf, -math.inf, math.inf)


@pytest.mark.parametrize("deep", [b'{"a":%b1%b}' % (b"[" * 150, b"]" * 150)])
def test_deep_nesting_is_accepted(deep: bytes) -> None:
    assert len(list(decode_json(deep + deep))) == 2


@pytest.mark.parametrize("depth", [300, 5_000, 100_000])
@pytest.mark.parametrize("before", [b"", b"{}"])
def test_too_deep_nesting_is_refused(depth: int, before: bytes) -> None:
    with pytest.raises(OperationError):
        list(decode_json(before + b'{"a":' + b"[" * depth + b"]" * depth + b"}"))


def test_error_quotes_only_the_start_of_a_long_text() -> None:
    with pytest.raises(OperationError) as caught:
        list(decode_json(b"x" * 10_000))
    assert len(str(caught.value)) < 400


@given(OBJECTS, SPACE)
def test_any_objects_with_any_space_between_them_are_read(
    values: list[dict[str, Any]], space: str
) -> None:
    text = space.join(["", *map(json.dumps, values), ""])
    assert list(decode_json(text.encode("utf-8"))) == values


@given(st.binary() | st.text().map(str.encode) | st.text('{}[]":,0e-\\ud8a ').map(str.encode))
def test_any_bytes_are_objects_or_raise_the_documented_errors(text: bytes) -> None:
    try:
        assert all(isinstance(each, dict) for each in decode_json(text))
    except (OperationError, InvalidUtf8):
        pass


# CBOR

CBOR = st.recursive(
    st.none()
    | st.booleans()
    | st.integers(-(2**64), 2**64 - 1)
    | st.floats(allow_nan=False)
    | st.text()
    | st.binary(),
    lambda inner: st.lists(inner) | st.dictionaries(st.text(), inner),
    max_leaves=20,
)


@given(st.dictionaries(st.text(), CBOR))
def test_cbor_map_is_read_as_it_was_written(value: dict[str, Any]) -> None:
    assert decode_cbor(cbor2.dumps(value)) == value


@given(st.binary(max_size=100))
def test_any_bytes_are_a_cbor_map_or_refused(data: bytes) -> None:
    for begin in (b"", b"\xa1\x61a", b"\xa1\x61a\x82", b"\xa1\x61a\xd8", b"\xa1\x61a\xc4"):
        try:
            assert isinstance(decode_cbor(begin + data), dict)
        except OperationError as error:
            assert len(str(error)) < 400


@pytest.mark.parametrize(
    ("tag", "elements"),
    [
        *[(65, ">u2"), (66, ">u4"), (67, ">u8")],
        *[(69, "<u2"), (70, "<u4"), (71, "<u8"), (72, "i1"), (73, ">i2"), (74, ">i4")],
        *[(75, ">i8"), (77, "<i2"), (78, "<i4"), (79, "<i8"), (80, ">f2"), (81, ">f4")],
        *[(82, ">f8"), (84, "<f2"), (85, "<f4"), (86, "<f8")],
    ],
)
def test_typed_array_becomes_a_list(tag: int, elements: str) -> None:
    values = numpy.array([0, 1, 120], elements)
    data = cbor2.dumps({"a": {"b": [cbor2.CBORTag(tag, values.tobytes())]}})
    assert decode_cbor(data) == {"a": {"b": [[0, 1, 120]]}}
    assert decode_cbor(cbor2.dumps({"a": cbor2.CBORTag(tag, b"")})) == {"a": []}


@pytest.mark.parametrize("tag", [64, 68])
def test_typed_array_of_uint8_becomes_bytes(tag: int) -> None:
    assert decode_cbor(cbor2.dumps({"a": cbor2.CBORTag(tag, b"\0\1x")})) == {"a": b"\0\1x"}


def test_typed_array_keeps_signs_and_nan() -> None:
    integers = cbor2.CBORTag(77, pack("<hh", -2, 2))
    floats = cbor2.CBORTag(86, pack("<dd", float("nan"), -0.5))
    decoded = decode_cbor(cbor2.dumps({"integers": integers, "floats": floats}))
    assert decoded["integers"] == [-2, 2]
    assert math.isnan(decoded["floats"][0])
    assert decoded["floats"][1] == -0.5


def test_undefined_becomes_none() -> None:
    assert decode_cbor(bytes.fromhex("a26161f7616282f701")) == {"a": None, "b": [None, 1]}


def test_cbor_of_indefinite_length_is_read() -> None:
    data = bytes.fromhex("bf61617f61626163ff61629f0102ff61635f41004101ffff")
    assert decode_cbor(data) == {"a": "bc", "b": [1, 2], "c": b"\0\1"}


def test_tag_of_self_described_cbor_is_skipped() -> None:
    assert decode_cbor(bytes.fromhex("d9d9f7a161610a")) == {"a": 10}


@pytest.mark.parametrize("payload", ["00", "4100", "820102"])
def test_all_tags_except_typed_arrays_are_refused(payload: str) -> None:
    typed = {*range(64, 88)} - {76, 83, 87}
    for tag in {*range(1000), *(2**bits - 1 for bits in range(10, 65))} - typed:
        head = cbor2.dumps(cbor2.CBORTag(tag, 0))[:-1]
        with pytest.raises(OperationError, match="Expected a map in CBOR"):
            decode_cbor(b"\xa1\x61a" + head + bytes.fromhex(payload))


@pytest.mark.parametrize(
    ("data", "fault"),
    [
        ("", "Expected a map in CBOR: premature end"),
        ("01", "Expected a map in CBOR, got int"),
        ("80", "Expected a map in CBOR, got list"),
        ("a0a0", "Expected one map in CBOR, got 1 more bytes after it"),
        ("a16161", "Expected a map in CBOR: premature end"),
        ("a10102", "map key must be a text string or byte string, not int"),
        ("a1410002", "Expected text as the keys of maps in CBOR, got bytes"),
        ("a16161a1f602", "not NoneType"),
        ("a16161f0", "Expected bytes or values that JSON has in CBOR, got CBORSimpleValue"),
        ("a161618201f0", "got CBORSimpleValue"),
        ("a161ff00", "Expected a map in CBOR: "),
        ("a16161ff", "Expected a map in CBOR: break code"),
        ("a16161d84501", "a typed array must be a byte string"),
        ("a16161d8454101", "a typed array of 1 bytes ends within an element"),
        ("a16161c24101", "unsupported tag 2; only typed arrays (RFC 8746) are supported"),
        ("a16161d853" + "50" + "00" * 16, "unsupported tag 83"),
        ("a16161d81c81d81d00", "unsupported tag 29"),
    ],
)
def test_cbor_other_than_a_map_of_json_values_and_bytes_is_refused(data: str, fault: str) -> None:
    with pytest.raises(OperationError) as caught:
        decode_cbor(bytes.fromhex(data))
    assert fault in str(caught.value)


@pytest.mark.parametrize("length", [2**16, 2**32 - 1, 2**63 - 1, 2**64 - 1])
@pytest.mark.parametrize("major", [0x5B, 0x7B, 0x9B, 0xBB])
def test_announced_length_takes_no_memory(major: int, length: int) -> None:
    begin = process_time()
    with pytest.raises(OperationError):
        decode_cbor(b"\xa1\x61a" + bytes([major]) + pack(">Q", length))
    assert process_time() - begin < 1


def test_too_deep_nesting_in_cbor_is_refused() -> None:
    fits = b"\xa1\x61a" + b"\x81" * (DEEPEST - 1) + b"\x00"
    assert decode_cbor(fits)
    for inner in (b"\x81", b"\x9f", b"\xa1\x61a", b"\xbf\x61a", b"\xd8\x45", b"\xc6"):
        with pytest.raises(OperationError):
            decode_cbor(b"\xa1\x61a" + inner * 100_000 + b"\x00")


def test_message_in_cbor_is_valid() -> None:
    message = {
        "header": {"stamp": {"secs": 1, "nsecs": 2}},
        "width": 2,
        "data": b"\0\1\2\3",
    }
    decoded = decode_cbor(cbor2.dumps({"op": "publish", "topic": "/t", "msg": message}))
    valid = Validators(Interfaces(), lambda: 0).of("sensor_msgs/Image").validate(decoded["msg"])
    assert valid["data"] == "AAECAw=="


@pytest.mark.parametrize(
    ("type_", "tag", "data"),
    [
        ("std_msgs/Float64MultiArray", 86, pack("<d", 1)),
        ("std_msgs/Int16MultiArray", 73, pack(">h", 1)),
        ("std_msgs/UInt8MultiArray", 64, b"\1"),
    ],
)
def test_typed_array_is_valid_in_a_message(type_: str, tag: int, data: bytes) -> None:
    decoded = decode_cbor(cbor2.dumps({"msg": {"data": cbor2.CBORTag(tag, data)}}))
    valid = Validators(Interfaces(), lambda: 0).of(type_).validate(decoded["msg"])
    assert valid["data"] == ("AQ==" if tag == 64 else [1])


# From fields to operations

JSON = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(), inner, max_size=3),
    max_leaves=6,
)
FIELDS = {name for model in get_args(Request) for name in model.model_fields}


def test_absent_field_has_its_default() -> None:
    read = parse_request({"op": "subscribe", "topic": "/a"})
    assert read == Subscribe(
        id=None,
        topic="/a",
        type=None,
        throttle_rate=0,
        queue_length=0,
        fragment_size=None,
        compression="none",
    )


@pytest.mark.parametrize("field", sorted(Subscribe.model_fields.keys() - {"op", "topic"}))
def test_null_counts_as_absent(field: str) -> None:
    absent = {"op": "subscribe", "topic": "/a"}
    assert parse_request({**absent, field: None}) == parse_request(absent)


def test_required_field_that_is_null_is_missing() -> None:
    with pytest.raises(OperationError, match="Expected a topic field but none was"):
        parse_request({"op": "subscribe", "topic": None})


def test_unknown_fields_are_ignored() -> None:
    known = {"op": "publish", "topic": "/a", "msg": {}}
    assert parse_request({**known, "type": "a/B", "queue_size": "many"}) == parse_request(known)


@pytest.mark.parametrize("id_", ["subscribe:/t:1", "", "5", 5, 0, -1, 2**70, 1.5, True, False])
def test_id_is_returned_as_it_was_sent(id_: object) -> None:
    request = parse_request({"op": "unsubscribe", "topic": "/a", "id": id_})
    returned = json.loads(encode(Status(id=request.id, level="info", msg="")))["id"]
    assert (returned, type(returned)) == (id_, type(id_))


def test_length_of_an_id_is_limited() -> None:
    fields = {"op": "unsubscribe", "topic": "/a"}
    assert parse_request({**fields, "id": "x" * LONGEST_ID}).id == "x" * LONGEST_ID
    with pytest.raises(OperationError, match="Expected field id to be one of") as caught:
        parse_request({**fields, "id": "x" * (LONGEST_ID + 1)})
    assert str(LONGEST_ID) in str(caught.value)


NO_OP = (
    "Received a message without an op.  "
    f"All messages require 'op' field with value one of: {REQUESTS}.  "
    "Original message was: "
)


@pytest.mark.parametrize(
    ("fields", "text"),
    [
        ({}, NO_OP + "{}"),
        ({"a": 1, "op": None}, NO_OP + '{"a":1}'),
        ({"op": 5}, NO_OP + '{"op":5}'),
        ({"op": ["publish"]}, NO_OP + '{"op":["publish"]}'),
        ({"op": "fly"}, f"Unknown operation: fly.  Allowed operations: {REQUESTS}"),
        ({"op": "status"}, f"Unknown operation: status.  Allowed operations: {REQUESTS}"),
        ({"op": "publish"}, "Expected a topic field but none was found."),
        (
            {"op": "advertise", "topic": "/a"},
            "Expected a type field but none was found.",
        ),
        (
            {"op": "publish", "topic": 5},
            "Expected field topic to be one of str. Invalid value: 5",
        ),
        (
            {"op": "advertise", "topic": "/a", "type": "a/B", "latch": "yes"},
            'Expected field latch to be one of bool. Invalid value: "yes"',
        ),
        (
            {"op": "subscribe", "topic": "/a", "queue_length": 1.5},
            "Expected field queue_length to be one of int. Invalid value: 1.5",
        ),
        (
            {"op": "subscribe", "topic": "/a", "queue_length": "1"},
            'Expected field queue_length to be one of int. Invalid value: "1"',
        ),
        (
            {"op": "subscribe", "topic": "/a", "throttle_rate": "1"},
            'Expected field throttle_rate to be one of int, float. Invalid value: "1"',
        ),
        (
            {"op": "subscribe", "topic": "/a", "throttle_rate": float("nan")},
            "Expected field throttle_rate to be one of a finite number. Invalid value: NaN",
        ),
        (
            {"op": "unsubscribe", "topic": "/a", "id": [1]},
            "Expected field id to be one of str, int. Invalid value: [1]",
        ),
        (
            {"op": "fragment", "id": {}, "data": "", "num": 0, "total": 1},
            "Expected field id to be one of str, int. Invalid value: {}",
        ),
        (
            {"op": "set_level", "level": "loud"},
            "Expected field level to be one of "
            "'error', 'warning', 'info' or 'none'. Invalid value: \"loud\"",
        ),
    ],
)
def test_invalid_operation_has_the_error_text_of_rosbridge_suite(
    fields: dict[str, Any], text: str
) -> None:
    with pytest.raises(OperationError) as caught:
        parse_request(fields)
    assert str(caught.value) == text


def test_invalid_reply_is_refused() -> None:
    with pytest.raises(OperationError) as caught:
        parse_reply({"op": "subscribe", "topic": "/a"})
    assert str(caught.value) == f"Unknown operation: subscribe.  Allowed operations: {REPLIES}"


@pytest.mark.parametrize(
    "fields",
    [
        {"a": "x" * 10_000},
        {"op": "publish", "topic": ["x"] * 10_000},
    ],
    ids=["no operation", "field"],
)
def test_error_quotes_only_the_start_of_a_long_value(fields: dict[str, Any]) -> None:
    with pytest.raises(OperationError) as caught:
        parse_request(fields)
    assert len(str(caught.value)) < 700


def test_only_long_values_are_truncated_in_quotes() -> None:
    assert quoted(["ä", 1]) == '["ä",1]'
    assert quoted("x" * 300) == '"' + "x" * 199 + "..."


@given(
    st.dictionaries(st.sampled_from(sorted(FIELDS)) | st.text(max_size=3), JSON, max_size=6),
    st.sampled_from([*REQUESTS, "fly"]) | JSON,
)
def test_any_fields_are_an_operation_or_raise_operation_error(
    fields: dict[str, Any], op: object
) -> None:
    try:
        request = parse_request({**fields, "op": op})
    except OperationError:
        return
    assert request.op == op
