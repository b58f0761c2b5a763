"""Serialized messages are, byte for byte, those of another implementation of ROS 1's format."""

from __future__ import annotations

import re
from math import nan
from struct import pack
from typing import Any

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from fibws.errors import InvalidMessage, UnknownPackage
from fibws.interfaces import Interfaces, Validators
from fibws.interfaces.linker import MOST_VALUES
from fibws.interfaces.serialization import Serializers

from .messages import comparable, messages, with_nan
from .oracle import Oracle

STANDARD = Interfaces()
SERIALIZERS = Serializers(STANDARD)
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


@pytest.mark.parametrize("type_", TYPES)
@settings(max_examples=6, deadline=None, suppress_health_check=[HealthCheck.too_slow])
@given(data=st.data())
def test_any_message_of_a_standard_type_has_the_right_bytes(
    type_: str, data: st.DataObject
) -> None:
    check(ORACLE, SERIALIZERS, type_, data.draw(messages(STANDARD, type_)))


@settings(deadline=None)
@given(data=st.data())
def test_any_message_of_an_odd_type_has_the_right_bytes(
    interfaces: Interfaces, oracle: Oracle, data: st.DataObject
) -> None:
    message = data.draw(messages(interfaces, "odd_msgs/All"))
    check(oracle, Serializers(interfaces), "odd_msgs/All", message)


@pytest.mark.parametrize("type_", TYPES)
def test_a_message_of_defaults_comes_back(type_: str) -> None:
    message = Validators(STANDARD, lambda: 5).of(type_).validate({})
    serializer = SERIALIZERS.of(type_)
    assert serializer.deserialize(serializer.serialize(message)) == message


def test_a_serializer_is_built_once() -> None:
    assert SERIALIZERS.of("std_msgs/String") is SERIALIZERS.of("std_msgs/String")
    assert SERIALIZERS.of("std_msgs/msg/String").type == "std_msgs/String"
    with pytest.raises(UnknownPackage):
        SERIALIZERS.of("nobodys_msgs/Mine")


def test_the_request_of_a_service_is_serialized() -> None:
    request = STANDARD.service("rospy_tutorials/AddTwoInts").request
    serializer = SERIALIZERS.of_definition(request)
    data = serializer.serialize({"a": 1, "b": -2})
    assert data == pack("<qq", 1, -2)
    assert serializer.deserialize(data) == {"a": 1, "b": -2}
    assert serializer.type == "rospy_tutorials/AddTwoIntsRequest"


def test_what_ros_2_added_is_serialized_as_if_it_were_ros_1s(interfaces: Interfaces) -> None:
    serializer = Serializers(interfaces).of("odd_msgs/Bounded")
    message = {"names": ["ä"], "numbers": [0.5], "data": "AQ=="}
    data = pack("<II2sId", 1, 2, "ä".encode(), 1, 0.5) + pack("<IB", 1, 1)
    assert serializer.serialize(message) == data
    assert serializer.deserialize(data) == message


def test_arrays_of_no_elements_have_no_bytes(interfaces: Interfaces) -> None:
    serializer = Serializers(interfaces).of("odd_msgs/Zeros")
    message = {"zeros": [{"none": [], "no_bytes": "", "never": []}] * 2}
    data = serializer.serialize(message)
    assert data == pack("<I", 2)
    assert serializer.deserialize(data) == message


def test_none_among_numbers_is_nan() -> None:
    serializer = SERIALIZERS.of("std_msgs/Float64MultiArray")
    layout = {"dim": [], "data_offset": 0}
    message = {"layout": layout, "data": [1.0, None]}
    assert serializer.serialize(message) == serializer.serialize({**message, "data": [1.0, nan]})


@pytest.mark.parametrize(
    ("type_", "data", "fault"),
    [
        ("std_msgs/Int32", b"\1\2\3", "4 bytes are needed, 3 are left"),
        ("std_msgs/Int32", b"\1\2\3\4\5\6", "2 of them are left over"),
        ("std_msgs/Empty", b"\0", "1 of them are left over"),
        ("std_msgs/String", b"\1", "data: 4 bytes are needed, 1 are left"),
        ("std_msgs/String", b"\5\0\0\0abc", "data: 5 bytes are needed, 3 are left"),
        ("std_msgs/String", b"\xff\xff\xff\xffabc", "data: 4294967295 bytes are needed, 3 are"),
        ("std_msgs/String", b"\2\0\0\0a\xe4", "data: unexpected end of data of UTF-8 at byte 1"),
        ("std_msgs/String", b"\2\0\0\0\xe4a", "data: invalid continuation byte of UTF-8 at byte 0"),
        ("sensor_msgs/Joy", bytes(16) + pack("<I", 2**30), "axes: 4294967296 bytes are needed, 0"),
        ("sensor_msgs/Image", bytes(12) + b"\1\0\0\0", "header.frame_id: 1 bytes are needed, 0"),
        (
            "rosgraph_msgs/Log",
            bytes(37) + pack("<I", 4) + pack("<II", 0, 1) + b"\xff",
            "topics: 4 elements need 16 bytes, 9 are left",
        ),
        (
            "diagnostic_msgs/DiagnosticArray",
            bytes(16) + pack("<I", 1) + bytes(13) + pack("<IIII", 2, 0, 0, 0) + pack("<I", 9),
            "status[0].values[1].value: 9 bytes are needed, 0 are left",
        ),
        (
            "geometry_msgs/PoseArray",
            bytes(16) + pack("<I", 2**32 - 1) + bytes(56),
            "poses: 4294967295 elements need 240518168520 bytes, 56 are left",
        ),
    ],
)
def test_what_is_no_message_is_refused_and_the_place_is_named(
    type_: str, data: bytes, fault: str
) -> None:
    with pytest.raises(InvalidMessage, match=re.escape(fault)) as caught:
        SERIALIZERS.of(type_).deserialize(data)
    assert str(caught.value).startswith(f"These bytes are no {type_}: ")


@pytest.mark.parametrize(
    ("type_", "data"),
    [
        ("odd_msgs/Nothings", pack("<I", MOST_VALUES + 1)),
        ("odd_msgs/Zeros", pack("<I", 2**32 - 1)),
        ("odd_msgs/Larges", pack("<I", 5) + bytes(5)),
    ],
)
def test_a_few_bytes_do_not_make_millions_of_values(
    interfaces: Interfaces, type_: str, data: bytes
) -> None:
    with pytest.raises(InvalidMessage, match="more than 4194304 values need no bytes"):
        Serializers(interfaces).of(type_).deserialize(data)


@given(st.binary(max_size=200))
def test_arbitrary_bytes_are_a_message_or_refused(data: bytes) -> None:
    serializer = SERIALIZERS.of("visualization_msgs/MarkerArray")
    try:
        message = serializer.deserialize(data)
    except InvalidMessage:
        return
    Validators(STANDARD, lambda: 5).of(serializer.type).validate(message)


@settings(max_examples=50)
@given(data=st.data())
def test_a_message_that_is_cut_short_is_refused(data: st.DataObject) -> None:
    serializer = SERIALIZERS.of("sensor_msgs/PointCloud2")
    whole = serializer.serialize(data.draw(messages(STANDARD, serializer.type)))
    cut = data.draw(st.integers(0, len(whole) - 1))
    with pytest.raises(InvalidMessage):
        serializer.deserialize(whole[:cut])
