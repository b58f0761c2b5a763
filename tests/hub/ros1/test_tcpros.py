"""Connection headers of TCPROS."""

from __future__ import annotations

import random
import struct

import pytest

from fibws.hub.errors import TcprosError
from fibws.hub.ros1.tcpros import (
    MOST_FIELDS,
    check_header_size,
    decode_header,
    encode_header,
    require,
)

FIELDS = {
    "callerid": "/talker",
    "md5sum": "*",
    "message_definition": "int32 A=5\nstring ä\n",
    "empty": "",
}


def field(text: bytes) -> bytes:
    return struct.pack("<I", len(text)) + text


def test_header_holds_each_field_with_its_length() -> None:
    assert encode_header({"a": "b=c", "d": ""}) == struct.pack("<I", 15) + field(b"a=b=c") + field(
        b"d="
    )


def test_header_is_read_as_it_was_written() -> None:
    assert decode_header(encode_header(FIELDS)[4:]) == FIELDS
    assert decode_header(b"") == {}


def test_text_that_is_not_utf8_is_replaced() -> None:
    assert decode_header(field(b"a=\xb0C")) == {"a": "\ufffdC"}


@pytest.mark.parametrize(
    ("data", "fact"),
    [
        (b"\x01", "longer than the header"),
        (struct.pack("<I", 5) + b"a=b", "longer than the header"),
        (struct.pack("<I", 2**32 - 1) + b"a=b", "longer than the header"),
        (field(b"a=b") + b"\0\0", "longer than the header"),
        (field(b"no equals sign"), "no ="),
        (field(b""), "no ="),
        (b"".join(field(b"k%d=" % number) for number in range(MOST_FIELDS + 1)), "fields"),
    ],
)
def test_invalid_header_is_refused(data: bytes, fact: str) -> None:
    with pytest.raises(TcprosError, match=fact):
        decode_header(data)


def test_random_bytes_are_a_header_or_refused() -> None:
    rng = random.Random(5)
    sound = encode_header(FIELDS)[4:]
    refused = 0
    for _ in range(3000):
        data = bytearray(sound if rng.random() < 0.8 else rng.randbytes(rng.randrange(60)))
        for _ in range(rng.randrange(4)):
            if data:
                data[rng.randrange(len(data))] = rng.choice((0, 1, 4, 61, 255, rng.randrange(256)))
        try:
            fields = decode_header(bytes(data[: rng.randrange(len(data) + 1)]))
        except TcprosError:
            refused += 1
        else:
            assert all(isinstance(each, str) for pair in fields.items() for each in pair)
    assert 1000 < refused < 3000


def test_length_of_a_header_is_limited() -> None:
    assert check_header_size(2**20) == 2**20
    with pytest.raises(TcprosError, match="1048577"):
        check_header_size(2**20 + 1)


def test_missing_field_is_named() -> None:
    require({"topic": "/a", "md5sum": "*"}, "topic", "md5sum")
    with pytest.raises(TcprosError, match="'md5sum'"):
        require({"topic": "/a"}, "topic", "md5sum")
