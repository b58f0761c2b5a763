"""A frame of CBOR is one map of what JSON has and bytes; whatever else it holds is refused."""

from __future__ import annotations

from math import isnan
from struct import pack
from time import process_time
from typing import Any

import cbor2
import numpy
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fibws.errors import OperationError
from fibws.interfaces import Interfaces, Validators
from fibws.protocol.cbor import DEEPEST, object_of_cbor

plain = st.recursive(
    st.none()
    | st.booleans()
    | st.integers(-(2**64), 2**64 - 1)
    | st.floats(allow_nan=False)
    | st.text()
    | st.binary(),
    lambda inner: st.lists(inner) | st.dictionaries(st.text(), inner),
    max_leaves=20,
)


@given(st.dictionaries(st.text(), plain))
def test_a_map_comes_back(value: dict[str, Any]) -> None:
    assert object_of_cbor(cbor2.dumps(value)) == value


@given(st.binary(max_size=100))
def test_arbitrary_bytes_are_a_map_or_refused(data: bytes) -> None:
    for begin in (b"", b"\xa1\x61a", b"\xa1\x61a\x82", b"\xa1\x61a\xd8", b"\xa1\x61a\xc4"):
        try:
            assert isinstance(object_of_cbor(begin + data), dict)
        except OperationError as error:
            assert len(str(error)) < 400


@pytest.mark.parametrize(
    ("tag", "elements"),
    [
        *[(64, "u1"), (65, ">u2"), (66, ">u4"), (67, ">u8"), (68, "u1")],
        *[(69, "<u2"), (70, "<u4"), (71, "<u8"), (72, "i1"), (73, ">i2"), (74, ">i4")],
        *[(75, ">i8"), (77, "<i2"), (78, "<i4"), (79, "<i8"), (80, ">f2"), (81, ">f4")],
        *[(82, ">f8"), (84, "<f2"), (85, "<f4"), (86, "<f8")],
    ],
)
def test_a_typed_array_is_a_list(tag: int, elements: str) -> None:
    values = numpy.array([0, 1, 120], elements)
    data = cbor2.dumps({"a": {"b": [cbor2.CBORTag(tag, values.tobytes())]}})
    assert object_of_cbor(data) == {"a": {"b": [[0, 1, 120]]}}
    assert object_of_cbor(cbor2.dumps({"a": cbor2.CBORTag(tag, b"")})) == {"a": []}


def test_numbers_in_a_typed_array_keep_their_sign_and_their_nan() -> None:
    integers = cbor2.CBORTag(77, pack("<hh", -2, 2))
    floats = cbor2.CBORTag(86, pack("<dd", float("nan"), -0.5))
    decoded = object_of_cbor(cbor2.dumps({"integers": integers, "floats": floats}))
    assert decoded["integers"] == [-2, 2]
    assert isnan(decoded["floats"][0])
    assert decoded["floats"][1] == -0.5


def test_undefined_is_none() -> None:
    assert object_of_cbor(bytes.fromhex("a26161f7616282f701")) == {"a": None, "b": [None, 1]}


def test_strings_and_lists_may_come_in_parts() -> None:
    data = bytes.fromhex("bf61617f61626163ff61629f0102ff61635f41004101ffff")
    assert object_of_cbor(data) == {"a": "bc", "b": [1, 2], "c": b"\0\1"}


def test_the_map_may_say_that_it_is_cbor() -> None:
    assert object_of_cbor(bytes.fromhex("d9d9f7a161610a")) == {"a": 10}


@pytest.mark.parametrize("payload", ["00", "4100", "820102"])
def test_every_other_tag_is_refused(payload: str) -> None:
    typed = {*range(64, 88)} - {76, 83, 87}
    for tag in {*range(2**16), 2**32, 2**64 - 1} - typed:
        head = cbor2.dumps(cbor2.CBORTag(tag, 0))[:-1]
        with pytest.raises(OperationError, match="Expected a map in CBOR"):
            object_of_cbor(b"\xa1\x61a" + head + bytes.fromhex(payload))


@pytest.mark.parametrize(
    ("data", "fault"),
    [
        ("", "Expected a map in CBOR: premature end"),
        ("01", "Expected a map in CBOR, but got a int"),
        ("80", "Expected a map in CBOR, but got a list"),
        ("a0a0", "Expected one map in CBOR, but 1 bytes follow it"),
        ("a16161", "Expected a map in CBOR: premature end"),
        ("a10102", "map key must be a text string or byte string, not int"),
        ("a1410002", "Expected text as the keys of maps in CBOR, but got bytes"),
        ("a16161a1f602", "not NoneType"),
        ("a16161f0", "Expected what JSON has, or bytes, in CBOR, but got CBORSimpleValue"),
        ("a161618201f0", "but got CBORSimpleValue"),
        ("a161ff00", "Expected a map in CBOR: "),
        ("a16161ff", "Expected a map in CBOR: break code"),
        ("a16161d84501", "a typed array is made of bytes"),
        ("a16161d8454101", "the 1 bytes of a typed array end within an element"),
        ("a16161c24101", "the tag 2 is not understood, only those of typed arrays are"),
        ("a16161d853" + "50" + "00" * 16, "the tag 83 is not understood"),
        ("a16161d81c81d81d00", "the tag 29 is not understood"),
    ],
)
def test_what_is_no_map_of_plain_values_is_refused(data: str, fault: str) -> None:
    with pytest.raises(OperationError) as caught:
        object_of_cbor(bytes.fromhex(data))
    assert fault in str(caught.value)


@pytest.mark.parametrize("length", [2**16, 2**32 - 1, 2**63 - 1, 2**64 - 1])
@pytest.mark.parametrize("major", [0x5B, 0x7B, 0x9B, 0xBB])
def test_an_announced_length_takes_no_memory(major: int, length: int) -> None:
    begin = process_time()
    with pytest.raises(OperationError):
        object_of_cbor(b"\xa1\x61a" + bytes([major]) + pack(">Q", length))
    assert process_time() - begin < 1


def test_what_is_nested_too_deep_is_refused() -> None:
    fits = b"\xa1\x61a" + b"\x81" * (DEEPEST - 1) + b"\x00"
    assert object_of_cbor(fits)
    for inner in (b"\x81", b"\x9f", b"\xa1\x61a", b"\xbf\x61a", b"\xd8\x45", b"\xc6"):
        with pytest.raises(OperationError):
            object_of_cbor(b"\xa1\x61a" + inner * 100_000 + b"\x00")


def test_a_message_in_cbor_is_valid() -> None:
    message = {
        "header": {"stamp": {"secs": 1, "nsecs": 2}},
        "width": 2,
        "data": b"\0\1\2\3",
    }
    decoded = object_of_cbor(cbor2.dumps({"op": "publish", "topic": "/t", "msg": message}))
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
def test_a_typed_array_is_valid_in_a_message(type_: str, tag: int, data: bytes) -> None:
    decoded = object_of_cbor(cbor2.dumps({"msg": {"data": cbor2.CBORTag(tag, data)}}))
    valid = Validators(Interfaces(), lambda: 0).of(type_).validate(decoded["msg"])
    assert valid["data"] == ("AQ==" if tag == 64 else [1])
