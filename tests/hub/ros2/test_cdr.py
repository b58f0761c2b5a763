"""Conversion between ROS 1's serialization and CDR, compared with rosbags."""

from __future__ import annotations

import struct
from pathlib import Path
from random import Random
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st
from random_inputs import times
from rosbags.typesys import Stores, get_types_from_msg, get_typestore
from work import executed_lines

from fibws.errors import InterfaceError, InvalidMessage
from fibws.interfaces import Interfaces, base64text, builtin
from fibws.interfaces.cdr import Converters
from fibws.interfaces.definition import Field, MessageDefinition
from fibws.interfaces.serialization import Serializers

from .test_type_hashes import OTHER_FIELDS

STANDARD = Interfaces()
CONVERTERS = Converters(STANDARD.message)
SERIALIZERS = Serializers(STANDARD)
STORE: Any = get_typestore(Stores.ROS2_JAZZY)
HEAD = b"\x00\x01\x00\x00"


def common() -> list[str]:
    """Return the messages that are the same in both."""
    found = []
    for name in STORE.fielddefs:
        package, kind, type_ = name.split("/")
        if kind == "msg" and name not in OTHER_FIELDS:
            try:
                found.append(STANDARD.message(f"{package}/{type_}").type)
            except InterfaceError:
                pass
    return found


def random_message(definition: MessageDefinition, random: Random, find: Any) -> dict[str, Any]:
    values = {field.name: random_value(field, random, find) for field in definition.fields}
    if definition.type == builtin.HEADER:
        values["seq"] = 0
    return values


def random_value(field: Field, random: Random, find: Any) -> Any:
    if field.array is None:
        return random_element(field, random, find)
    count = field.array.fixed
    if count is None:
        count = random.choice((0, 0, 1, 2, 3, 7))
    if field.is_bytes:
        return base64text.encode(random.randbytes(count))
    return [random_element(field, random, find) for _ in range(count)]


def random_element(field: Field, random: Random, find: Any) -> Any:
    if field.is_nested:
        return random_message(find(field.type), random, find)
    if field.type in builtin.STRINGS:
        return "".join(random.choices("abcé", k=random.choice((0, 1, 2, 3, 4, 9))))
    if field.type in builtin.TIMES:
        return {"secs": random.randrange(2**31), "nsecs": random.randrange(10**9)}
    if field.type == "bool":
        return random.random() < 0.5
    if field.type in builtin.FLOATS:
        return float(random.randrange(-1000, 1000))
    return random.randint(*builtin.INTEGERS[field.type])


@pytest.mark.parametrize("name", common())
def test_both_directions_are_as_in_rosbags(name: str) -> None:
    random = Random(name)
    definition = STANDARD.message(name)
    converter, ros2_name = CONVERTERS.of(name), name.replace("/", "/msg/")
    for _ in range(times(0.5)):
        ros1 = SERIALIZERS.of(name).serialize(random_message(definition, random, STANDARD.message))
        cdr = converter.to_cdr(ros1)
        assert cdr == bytes(STORE.ros1_to_cdr(ros1, ros2_name))
        assert converter.from_cdr(cdr) == ros1


def test_alignment_in_all_places(tmp_path: Path) -> None:
    inner = "uint8 a\nfloat64 b\nstring c\n"
    flat = "uint8 a\nfloat64 b\nuint16 c\n"
    outer = (
        "uint8 first\nInner one\nInner[2] two\nFlat[3] flat\nInner[] some\nFlat[] more\n"
        "float64[] numbers\nint16[] shorts\nstring[] words\nstring[2] pair\nbool[3] flags\n"
        "uint8[] data\nfloat64 last\n"
    )
    folder = tmp_path / "my_msgs" / "msg"
    folder.mkdir(parents=True)
    store: Any = get_typestore(Stores.EMPTY)
    types = {}
    for name, text in (("Inner", inner), ("Flat", flat), ("Outer", outer)):
        (folder / f"{name}.msg").write_text(text)
        types.update(get_types_from_msg(text, f"my_msgs/msg/{name}"))
    store.register(types)
    interfaces = Interfaces([tmp_path])
    converter = Converters(interfaces.message).of("my_msgs/Outer")
    definition, serializers = interfaces.message("my_msgs/Outer"), Serializers(interfaces)
    random = Random(1)
    for _ in range(times(5)):
        values = random_message(definition, random, interfaces.message)
        ros1 = serializers.of("my_msgs/Outer").serialize(values)
        cdr = converter.to_cdr(ros1)
        assert cdr == bytes(store.ros1_to_cdr(ros1, "my_msgs/msg/Outer"))
        assert converter.from_cdr(cdr) == ros1


def test_message_without_fields_has_one_byte() -> None:
    converter = CONVERTERS.of("std_msgs/Empty")
    assert converter.to_cdr(b"") == HEAD + b"\0"
    assert converter.from_cdr(HEAD + b"\0") == b""


def test_number_of_a_header_gets_lost() -> None:
    converter = CONVERTERS.of("std_msgs/Header")
    ros1 = struct.pack("<IIII", 7, 1, 2, 3) + b"map"
    assert converter.to_cdr(ros1) == HEAD + struct.pack("<III", 1, 2, 4) + b"map\0"
    assert converter.from_cdr(converter.to_cdr(ros1))[:4] == bytes(4)


def test_empty_string_without_its_nul_is_read() -> None:
    assert CONVERTERS.of("std_msgs/String").from_cdr(HEAD + bytes(4)) == bytes(4)


def test_padding_behind_a_message_is_ignored() -> None:
    assert CONVERTERS.of("std_msgs/Bool").from_cdr(HEAD + b"\1\0\0\0") == b"\1"


@pytest.mark.parametrize(
    ("name", "data"),
    [
        ("std_msgs/String", b""),
        ("std_msgs/String", HEAD),
        ("std_msgs/String", HEAD + b"\xff\xff\xff\xff"),
        ("std_msgs/String", HEAD + struct.pack("<I", 5) + b"abc\0"),
        ("std_msgs/String", HEAD + struct.pack("<I", 4) + b"abcd"),  # No NUL.
        ("std_msgs/String", b"\x00\x00\x00\x00" + struct.pack(">I", 2) + b"a\0"),  # Big endian.
        ("std_msgs/String", b"\x00\x07\x00\x00" + struct.pack("<I", 2) + b"a\0"),
        ("std_msgs/Int32", HEAD + bytes(8)),  # Too long.
        ("std_msgs/Float64MultiArray", HEAD + b"\xff\xff\xff\x7f"),
        ("geometry_msgs/PoseArray", HEAD + bytes(8) + struct.pack("<II", 1, 2**31)),
        ("tf2_msgs/TFMessage", HEAD + b"\xff\xff\xff\x7f" + bytes(100)),
    ],
)
def test_invalid_cdr_is_refused(name: str, data: bytes) -> None:
    with pytest.raises(InvalidMessage, match="invalid CDR"):
        CONVERTERS.of(name).from_cdr(data)


@pytest.mark.parametrize("data", [b"", b"\xff\xff\xff\xff", b"\x01\0\0\0ab"])
def test_invalid_bytes_of_ros_1_are_refused(data: bytes) -> None:
    with pytest.raises(InvalidMessage, match="invalid bytes"):
        CONVERTERS.of("std_msgs/String").to_cdr(data)


@given(
    st.sampled_from(["tf2_msgs/TFMessage", "sensor_msgs/PointCloud2", "nav_msgs/Odometry"]),
    st.binary(max_size=300),
    st.integers(0, 200),
)
def test_any_bytes_are_read_or_refused(name: str, noise: bytes, at: int) -> None:
    converter, serializer = CONVERTERS.of(name), SERIALIZERS.of(name)
    random = Random(at)
    values = random_message(serializer.definition, random, STANDARD.message)
    cdr = bytearray(converter.to_cdr(serializer.serialize(values)))
    cdr[4 + at : 4 + at + len(noise)] = noise
    try:
        ros1 = converter.from_cdr(bytes(cdr))
    except InvalidMessage:
        return
    serializer.check(ros1)


def test_number_of_elements_without_bytes_is_bounded(tmp_path: Path) -> None:
    (tmp_path / "my_msgs" / "msg").mkdir(parents=True)
    (tmp_path / "my_msgs" / "msg" / "Many.msg").write_text("std_msgs/Empty[] all\n")
    converter = Converters(Interfaces([tmp_path]).message).of("my_msgs/Many")
    few, many = 2**16, 2**16 + 1
    assert converter.from_cdr(HEAD + struct.pack("<I", few) + bytes(few)) == struct.pack("<I", few)
    with pytest.raises(InvalidMessage):
        converter.from_cdr(HEAD + struct.pack("<I", many) + bytes(many))
    with pytest.raises(InvalidMessage):
        converter.to_cdr(struct.pack("<I", many))


def test_hostile_lengths_cost_nothing() -> None:
    for name in ("tf2_msgs/TFMessage", "diagnostic_msgs/DiagnosticArray", "nav_msgs/Path"):
        converter = CONVERTERS.of(name)
        for length in (2**16, 2**24, 2**31, 2**32 - 1):
            data = HEAD + struct.pack("<I", length) * 64

            def convert(converter: Any = converter, data: bytes = data) -> None:
                with pytest.raises(InvalidMessage):
                    converter.from_cdr(data)

            assert executed_lines(convert) < 10_000
