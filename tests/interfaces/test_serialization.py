"""Serialized messages are, byte for byte, those of another implementation of ROS 1's format."""

from __future__ import annotations

import contextlib
import re
import tracemalloc
from collections.abc import Callable
from math import nan
from pathlib import Path
from struct import pack
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st
from random_inputs import examples

from fibws.errors import InvalidMessage, UnknownPackage
from fibws.interfaces import Interfaces, Validators
from fibws.interfaces.cbor import CborEncoders
from fibws.interfaces.serialization import Serializer, Serializers, class_codec
from fibws.interfaces.serialization_code import MOST_WITHOUT_BYTES
from fibws.msg import message_class

from .messages import comparable, messages, with_nan
from .oracle import Oracle

STANDARD = Interfaces()
SERIALIZERS = Serializers(STANDARD)
CBOR_ENCODERS = CborEncoders(STANDARD)
ORACLE = Oracle(STANDARD)
TYPES = [name for package in STANDARD.packages() for name in STANDARD.messages(package)]

ALL = """\
bool[] flags
bool[2] pair
byte one
byte[] signed
int8[3] three
char[] letters
uint8[2] two
string[] names
string[2] both
time when
time[] times
duration[2] spans
Flat[] flats
Flat[2] corners
Mixed[] mixed
Nothing nothing
Nothing[2] never
float32[] few
uint64 last
"""


@pytest.fixture(scope="module")
def interfaces(tmp_path_factory: pytest.TempPathFactory) -> Interfaces:
    """The standard types and a package of odd ones."""
    folder = tmp_path_factory.mktemp("interfaces") / "odd_msgs" / "msg"
    folder.mkdir(parents=True)
    for name, text in {
        "All": ALL,
        "Flat": "int16 x\ntime t\nfloat32[2] z\nuint8[4] four",
        "Mixed": "string text\nuint8 number\nbool yes",
        "Nothing": "",
        "Nothings": "Nothing[] nothings",
        "Large": "uint8 x\nNothing[1000000] many",
        "Larges": "Large[] larges",
        "Zero": "float64[0] none\nuint8[0] no_bytes\nNothing[0] never",
        "Zeros": "Zero[] zeros",
        "Marked": "uint8 x\nNothing mark",
        "Markeds": "Marked[] markeds",
        "Bounded": "wstring<=3[<=4] names\nfloat64[<=2] numbers\nuint8[<=2] data",
    }.items():
        (folder / f"{name}.msg").write_text(text, "utf-8")
    return Interfaces([folder.parents[1]])


@pytest.fixture(scope="module")
def oracle(interfaces: Interfaces) -> Oracle:
    return Oracle(interfaces)


def check(oracle: Oracle, serializers: Serializers, type_: str, message: dict[str, Any]) -> None:
    serializer = serializers.of(type_)
    plain = with_nan(message)
    data = serializer.serialize(message)
    assert data == oracle.serialize(type_, plain)
    assert comparable(serializer.deserialize(data)) == comparable(plain)


@examples(5)
@given(st.sampled_from(TYPES), st.data())
@pytest.mark.long
def test_any_message_of_a_standard_type_has_the_right_bytes(
    type_: str, data: st.DataObject
) -> None:
    check(ORACLE, SERIALIZERS, type_, data.draw(messages(STANDARD, type_)))


@given(data=st.data())
def test_any_message_of_an_odd_type_has_the_right_bytes(
    interfaces: Interfaces, oracle: Oracle, data: st.DataObject
) -> None:
    message = data.draw(messages(interfaces, "odd_msgs/All"))
    check(oracle, Serializers(interfaces), "odd_msgs/All", message)


@pytest.mark.long
def test_message_of_defaults_comes_back() -> None:
    validators = Validators(STANDARD, lambda: 5)
    for type_ in TYPES:
        message = validators.of(type_).validate({})
        serializer = SERIALIZERS.of(type_)
        data = serializer.serialize(message)
        assert serializer.deserialize(data) == message, type_
        assert serializer.to_cbor(data) == CBOR_ENCODERS.of(type_).encode(message), type_
        assert data == ORACLE.serialize(type_, message), type_


def test_serializer_is_built_once() -> None:
    assert SERIALIZERS.of("std_msgs/String") is SERIALIZERS.of("std_msgs/String")
    assert SERIALIZERS.of("std_msgs/msg/String").type == "std_msgs/String"
    with pytest.raises(UnknownPackage):
        SERIALIZERS.of("nobodys_msgs/Mine")


def test_request_of_a_service_is_serialized() -> None:
    request = STANDARD.service("rospy_tutorials/AddTwoInts").request
    serializer = SERIALIZERS.of_definition(request)
    data = serializer.serialize({"a": 1, "b": -2})
    assert data == pack("<qq", 1, -2)
    assert serializer.deserialize(data) == {"a": 1, "b": -2}
    assert serializer.type == "rospy_tutorials/AddTwoIntsRequest"


def test_ros_2_types_are_serialized_as_in_ros_1(interfaces: Interfaces) -> None:
    serializer = Serializers(interfaces).of("odd_msgs/Bounded")
    message = {"names": ["ä"], "numbers": [0.5], "data": "AQ=="}
    data = pack("<II2sId", 1, 2, "ä".encode(), 1, 0.5) + pack("<IB", 1, 1)
    assert serializer.serialize(message) == data
    assert serializer.deserialize(data) == message


def test_bounds_count_characters_and_not_bytes(interfaces: Interfaces) -> None:
    serializer = Serializers(interfaces).of("odd_msgs/Bounded")
    text = "äöü".encode()
    for name in (text, b"\xff\xff\xff"):
        data = pack(f"<II{len(name)}s", 1, len(name), name) + bytes(8)
        serializer.check(data)
        assert len(serializer.deserialize(data, "replace")["names"][0]) == 3
    with pytest.raises(InvalidMessage, match="at most 3 characters, got 4"):
        serializer.check(pack("<II7s", 1, 7, text + b"x") + bytes(8))


def test_fixed_arrays_of_length_0_have_no_bytes(interfaces: Interfaces) -> None:
    serializer = Serializers(interfaces).of("odd_msgs/Zeros")
    message = {"zeros": [{"none": [], "no_bytes": "", "never": []}] * 2}
    data = serializer.serialize(message)
    assert data == pack("<I", 2)
    assert serializer.deserialize(data) == message


def test_none_in_an_array_of_floats_is_nan() -> None:
    serializer = SERIALIZERS.of("std_msgs/Float64MultiArray")
    layout = {"dim": [], "data_offset": 0}
    message = {"layout": layout, "data": [1.0, None]}
    assert serializer.serialize(message) == serializer.serialize({**message, "data": [1.0, nan]})


@pytest.mark.parametrize(
    ("type_", "data", "facts"),
    [
        ("std_msgs/Int32", b"\1\2\3", "data 4 3"),
        ("std_msgs/Int32", b"\1\2\3\4\5\6", "2"),
        ("std_msgs/Empty", b"\0", "1"),
        ("std_msgs/String", b"\1", "data 4 1"),
        ("std_msgs/String", b"\5\0\0\0abc", "data 5 3"),
        ("std_msgs/String", b"\1\0\0\0abc", "2"),
        ("std_msgs/String", b"\2\0\0\0\xe4", "data 2 1"),
        ("std_msgs/String", b"\xff\xff\xff\xffabc", "data 4294967295 3"),
        ("sensor_msgs/Joy", bytes(16) + pack("<I", 2**30), "axes 1073741824 4 0"),
        ("sensor_msgs/Image", bytes(12) + b"\1\0\0\0", "header.frame_id 1 0"),
        (
            "rosgraph_msgs/Log",
            bytes(37) + pack("<I", 4) + pack("<II", 0, 1) + b"\xff",
            "topics 4 4 9",
        ),
        (
            "diagnostic_msgs/DiagnosticArray",
            bytes(16) + pack("<I", 1) + bytes(13) + pack("<IIII", 2, 0, 0, 0) + pack("<I", 9),
            "status[0].values[1].value 9 0",
        ),
        (
            "geometry_msgs/PoseArray",
            bytes(16) + pack("<I", 2**32 - 1) + bytes(56),
            "poses 4294967295 56 56",
        ),
        ("odd_msgs/Bounded", pack("<II4s", 1, 4, b"abcd") + bytes(8), "names[0] 3 4"),
        ("odd_msgs/Bounded", pack("<I", 5) + bytes(28), "names 4 5"),
        ("odd_msgs/Bounded", pack("<II", 0, 3) + bytes(28), "numbers 2 3"),
        ("odd_msgs/Bounded", pack("<III", 0, 0, 3) + bytes(3), "data 2 3"),
        ("odd_msgs/Nothings", pack("<I", MOST_WITHOUT_BYTES + 1), f"nothings {MOST_WITHOUT_BYTES}"),
        ("odd_msgs/Zeros", pack("<I", 2**32 - 1), f"zeros {MOST_WITHOUT_BYTES}"),
        ("odd_msgs/Larges", pack("<I", 5) + bytes(5), f"larges {MOST_WITHOUT_BYTES}"),
    ],
)
@pytest.mark.parametrize("kind", [bytes, bytearray, memoryview])
def test_invalid_bytes_are_refused_and_the_field_is_named(
    interfaces: Interfaces, type_: str, data: bytes, facts: str, kind: Callable[[bytes], Any]
) -> None:
    serializer = Serializers(interfaces).of(type_)
    for function in (serializer.check, serializer.deserialize, serializer.to_cbor):
        with pytest.raises(InvalidMessage) as caught:
            function(kind(data))
        before, _, found = str(caught.value).partition(f"{type_}: ")
        assert before
        path, *numbers = facts.split()
        if path[0].isalpha():
            assert found.startswith(f"{path}: ")
            found = found.removeprefix(f"{path}: ")
        else:
            numbers = [path]
        assert re.findall(r"\d+", found) == numbers


@examples(2)
@given(st.sampled_from(TYPES), st.data())
@pytest.mark.long
def test_check_accepts_what_can_be_deserialized(type_: str, data: st.DataObject) -> None:
    """Random bytes, and bytes of messages that are changed, cut or extended."""
    serializer = SERIALIZERS.of(type_)
    fuzzed = bytearray(serializer.serialize(data.draw(messages(STANDARD, type_))))
    for _ in range(data.draw(st.integers(0, 3))):
        begin = data.draw(st.integers(0, len(fuzzed)))
        end = data.draw(st.integers(begin, min(begin + 8, len(fuzzed))))
        fuzzed[begin:end] = data.draw(st.binary(max_size=8))
    accepts_alike(serializer, data.draw(st.just(bytes(fuzzed)) | st.binary(max_size=300)))


@given(data=st.binary(max_size=100))
def test_check_accepts_what_can_be_deserialized_of_odd_types(
    interfaces: Interfaces, data: bytes
) -> None:
    serializers = Serializers(interfaces)
    for type_ in ("All", "Nothings", "Zeros", "Bounded"):
        accepts_alike(serializers.of(f"odd_msgs/{type_}"), data)


def accepts_alike(serializer: Serializer, data: bytes) -> None:
    """Check that all functions accept the bytes or refuse them with the same error."""
    codec = class_codec(message_class(serializer.type)) if serializer.type in TYPES else None
    found = []
    for function in (
        serializer.check,
        lambda data: serializer.deserialize(data, "replace"),
        lambda data: serializer.to_cbor(data, "replace"),
        codec.deserialize if codec else serializer.check,
    ):
        try:
            function(data)
            found.append("")
        except InvalidMessage as error:
            found.append(str(error))
    assert len(set(found)) == 1, found


def test_impossible_array_length_allocates_nothing() -> None:
    tracemalloc.start()
    try:
        for type_, before in (
            ("sensor_msgs/LaserScan", 44),
            ("tf2_msgs/TFMessage", 0),
            ("geometry_msgs/PoseArray", 16),
            ("sensor_msgs/Image", 29),
            ("rosgraph_msgs/Log", 37),
        ):
            data = bytes(before) + b"\xff\xff\xff\x7f" + bytes(1000)
            serializer, codec = SERIALIZERS.of(type_), class_codec(message_class(type_))
            for function in (serializer.check, serializer.deserialize, codec.deserialize):
                with contextlib.suppress(InvalidMessage):
                    function(data)
                tracemalloc.reset_peak()
                with pytest.raises(InvalidMessage):
                    function(data)
                assert tracemalloc.get_traced_memory()[1] < 2**22
    finally:
        tracemalloc.stop()


def test_values_without_bytes_are_not_limited_next_to_others(interfaces: Interfaces) -> None:
    count = MOST_WITHOUT_BYTES + 1
    serializer = Serializers(interfaces).of("odd_msgs/Markeds")
    data = pack("<I", count) + bytes(count)
    serializer.check(data)
    assert len(serializer.deserialize(data)["markeds"]) == count


def test_many_values_without_bytes_are_refused_at_once(interfaces: Interfaces) -> None:
    data = pack("<I", 5) + bytes(5)
    with pytest.raises(InvalidMessage):
        Serializers(interfaces).of("odd_msgs/Larges").check(data)


def test_diagnosis_of_many_elements_is_bounded() -> None:
    data = bytes(37) + pack("<I", 10**6) + bytes(4 * 10**6 - 4) + b"\1\0\0\0"
    with pytest.raises(InvalidMessage, match=r"rosgraph_msgs/Log: topics\[\d+\]"):
        SERIALIZERS.of("rosgraph_msgs/Log").check(data)


@examples(2)
@given(st.sampled_from(TYPES), st.data())
def test_cbor_is_that_of_dicts(type_: str, data: st.DataObject) -> None:
    serializer = SERIALIZERS.of(type_)
    serialized = serializer.serialize(data.draw(messages(STANDARD, type_)))
    message = serializer.deserialize(serialized)
    assert serializer.to_cbor(serialized) == CBOR_ENCODERS.of(type_).encode(message)


WEIGHED = {
    "points": ("geometry_msgs/Polygon", pack("<3f", 0.5, 1.5, 2.5), True, True),
    "numbers": ("std_msgs/Float64MultiArray", pack("<d", 0.5), True, False),
    "cells": ("std_msgs/Int8MultiArray", b"\1", True, False),
    "bytes": ("std_msgs/UInt8MultiArray", b"\1", False, False),
    "markers": ("visualization_msgs/MarkerArray", None, True, True),
}
"""A type, an element of its array, and whether many of them weigh too much as JSON, and as CBOR."""


@pytest.mark.parametrize("name", WEIGHED)
def test_size_is_estimated_before_decoding(name: str) -> None:
    type_, element, *heavy = WEIGHED[name]
    serializer = SERIALIZERS.of(type_)
    empty = serializer.serialize(Validators(STANDARD, lambda: 0).of(type_).validate({}))
    if element is None:
        marker = SERIALIZERS.of("visualization_msgs/Marker")
        values = Validators(STANDARD, lambda: 0).of(marker.type).validate({"text": "a"})
        element = marker.serialize(values)
    assert isinstance(element, bytes)
    many = {1: 17_000_000, 8: 3_000_000}.get(len(element), 700_000)
    for count, weighs in ((1000, False), (many, True)):
        data = empty[:-4] + pack("<I", count) + element * count
        serializer.check(data)
        found = [serializer.is_heavy(data, numbers=numbers) for numbers in (True, False)]
        assert found == [weighs and each for each in heavy]


def test_sizes_are_known() -> None:
    assert SERIALIZERS.of("std_msgs/Empty").size == 0
    assert SERIALIZERS.of("geometry_msgs/PoseWithCovariance").size == 43 * 8
    assert SERIALIZERS.of("std_msgs/Header").size is None


def test_large_types_can_be_compiled(tmp_path: Path) -> None:
    folder = tmp_path / "large_msgs" / "msg"
    folder.mkdir(parents=True)
    (folder / "Wide.msg").write_text("".join(f"float64 f{i}\n" for i in range(3000)), "utf-8")
    (folder / "Deep0.msg").write_text("string text\n", "utf-8")
    for depth in range(1, 40):
        (folder / f"Deep{depth}.msg").write_text(f"Deep{depth - 1}[] inner\n", "utf-8")
    interfaces = Interfaces([tmp_path])
    wide, deep = (Serializers(interfaces).of(f"large_msgs/{name}") for name in ("Wide", "Deep39"))
    assert wide.size == 24000
    values = wide.deserialize(bytes(24000))
    assert wide.serialize(values) == bytes(24000)
    data = b"\1\0\0\0" * 39 + b"\2\0\0\0ab"
    deep.check(data)
    assert deep.serialize(deep.deserialize(data)) == data
