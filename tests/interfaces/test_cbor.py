"""Messages are encoded as rosbridge's ``cbor`` compression has them, fixed arrays included."""

from __future__ import annotations

from base64 import b64decode, b64encode
from math import nan
from pathlib import Path
from typing import Any

import cbor2
import numpy
import pytest
from hypothesis import given
from hypothesis import strategies as st
from random_inputs import examples

from fibws.errors import UnknownPackage
from fibws.interfaces import Interfaces
from fibws.interfaces.cbor import CborEncoders
from fibws.interfaces.definition import Field

from .messages import comparable, messages, with_nan

STANDARD = Interfaces()
ENCODERS = CborEncoders(STANDARD)
TYPES = [name for package in STANDARD.packages() for name in STANDARD.messages(package)]

TAGS = {
    "uint16": (69, "<u2"),
    "uint32": (70, "<u4"),
    "uint64": (71, "<u8"),
    "int8": (72, "i1"),
    "byte": (72, "i1"),
    "int16": (77, "<i2"),
    "int32": (78, "<i4"),
    "int64": (79, "<i8"),
    "float32": (85, "<f4"),
    "float64": (86, "<f8"),
}
"""The tags of RFC 8746, and numpy's names for the elements."""


def expected(interfaces: Interfaces, type_: str, message: dict[str, Any]) -> dict[str, Any]:
    """Return a message encoded in CBOR."""
    fields = interfaces.message(type_).fields
    return {field.name: _expected(interfaces, field, message[field.name]) for field in fields}


def _expected(interfaces: Interfaces, field: Field, value: Any) -> Any:
    if field.is_bytes:
        return b64decode(value)
    if field.array is not None and field.type in TAGS:
        tag, elements = TAGS[field.type]
        return cbor2.CBORTag(tag, numpy.array(value, elements).tobytes())
    if not field.is_nested:
        return value
    if field.array is None:
        return expected(interfaces, field.type, value)
    return [expected(interfaces, field.type, element) for element in value]


@examples(5)
@given(st.sampled_from(TYPES), st.data())
def test_any_message_of_a_standard_type_is_encoded(type_: str, data: st.DataObject) -> None:
    message = data.draw(messages(STANDARD, type_))
    decoded = cbor2.loads(ENCODERS.of(type_).encode(message))
    wanted = expected(STANDARD, type_, with_nan(message))
    assert comparable(decoded) == comparable(wanted)
    assert list(decoded) == list(message)


@pytest.mark.parametrize(
    ("type_", "values", "encoded"),
    [
        ("uint8", "AQI=", "420102"),
        ("char", "AQI=", "420102"),
        ("int8", [-1, 1], "d84842ff01"),
        ("byte", [-1, 1], "d84842ff01"),
        ("uint16", [1, 256], "d8454401000001"),
        ("int16", [-2], "d84d42feff"),
        ("uint32", [1], "d8464401000000"),
        ("int32", [-2], "d84e44feffffff"),
        ("uint64", [2**64 - 1], "d84748" + "ff" * 8),
        ("int64", [-2], "d84f48fe" + "ff" * 7),
        ("float32", [1.5, None], "d855480000c03f0000c07f"),
        ("float64", [1.5], "d85648000000000000f83f"),
        ("bool", [True, False], "82f5f4"),
        ("string", ["a", ""], "82616160"),
        ("time", [{"secs": 1, "nsecs": 2}], "81a2647365637301656e7365637302"),
    ],
)
@pytest.mark.parametrize("size", ["", "{count}", "<={count}"])
def test_arrays_are_typed_whether_their_size_is_fixed_or_not(
    tmp_path: Path, type_: str, values: Any, encoded: str, size: str
) -> None:
    count = len(b64decode(values) if isinstance(values, str) else values)
    (tmp_path / "my_msgs" / "msg").mkdir(parents=True)
    definition = f"{type_}[{size.format(count=count)}] data"
    (tmp_path / "my_msgs" / "msg" / "Mine.msg").write_text(definition)
    encoder = CborEncoders(Interfaces([tmp_path])).of("my_msgs/Mine")
    assert encoder.encode({"data": values}).hex() == "a16464617461" + encoded


@pytest.mark.parametrize(
    ("type_", "encoded"), [("float64", "d85640"), ("uint8", "40"), ("bool", "80"), ("string", "80")]
)
def test_empty_array_is_typed(tmp_path: Path, type_: str, encoded: str) -> None:
    (tmp_path / "my_msgs" / "msg").mkdir(parents=True)
    (tmp_path / "my_msgs" / "msg" / "Mine.msg").write_text(f"{type_}[] data")
    encoder = CborEncoders(Interfaces([tmp_path])).of("my_msgs/Mine")
    empty: Any = "" if type_ == "uint8" else []
    assert encoder.encode({"data": empty}).hex() == "a16464617461" + encoded


def test_none_is_nan_in_all_numbers() -> None:
    point = {"x": None, "y": 0.0, "z": nan}
    encoder = ENCODERS.of("geometry_msgs/Polygon")
    decoded = cbor2.loads(encoder.encode({"points": [point]}))
    assert comparable(decoded) == {"points": [{"x": "NaN", "y": 0.0, "z": "NaN"}]}
    assert point["x"] is None


def test_encoding_does_not_change_the_message() -> None:
    cloud = b64encode(bytes(8)).decode()
    header = {"seq": 0, "stamp": {"secs": 0, "nsecs": 0}, "frame_id": "map"}
    message = {"header": header, "format": "png", "data": cloud}
    decoded = cbor2.loads(ENCODERS.of("sensor_msgs/CompressedImage").encode(message))
    assert decoded == {"header": header, "format": "png", "data": bytes(8)}
    assert message["data"] is cloud


def test_encoder_is_built_once() -> None:
    assert ENCODERS.of("std_msgs/String") is ENCODERS.of("std_msgs/String")
    assert ENCODERS.of("std_msgs/msg/String").type == "std_msgs/String"
    with pytest.raises(UnknownPackage):
        ENCODERS.of("nobodys_msgs/Mine")
