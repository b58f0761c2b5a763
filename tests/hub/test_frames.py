"""WebSocket frames are those that the library would make."""

from __future__ import annotations

import json

import pytest
from hypothesis import given
from hypothesis import strategies as st
from websockets.frames import Frame, Opcode

from fibws.hub.frames import binary_frame, text_frame, text_frames, text_header

from .fakes import payloads

SIZES = [0, 1, 125, 126, 127, 65535, 65536, 100_000]


@pytest.mark.parametrize("size", SIZES)
def test_a_text_frame_is_the_librarys(size: int) -> None:
    data = bytes(range(256)) * (size // 256 + 1)
    assert text_frame(data[:size]) == Frame(Opcode.TEXT, data[:size]).serialize(mask=False)


@pytest.mark.parametrize("size", SIZES)
def test_a_header_is_what_goes_before_the_text(size: int) -> None:
    assert text_frame(b"x" * size) == text_header(size) + b"x" * size


@pytest.mark.parametrize("size", SIZES)
def test_a_binary_frame_is_the_librarys(size: int) -> None:
    data = bytes(size)
    assert binary_frame(data) == Frame(Opcode.BINARY, data).serialize(mask=False)


@given(st.text(), st.integers(1, 50) | st.none())
def test_any_text_is_the_same_however_it_is_cut(text: str, size: int | None) -> None:
    found = [
        payload.decode() for payload in payloads(text_frames(text.encode(), size, lambda: "x"))
    ]
    if size is None or len(text) <= size:
        assert found == [text]
        return
    pieces = [json.loads(each) for each in found]
    assert "".join(piece["data"] for piece in pieces) == text
    assert [piece["num"] for piece in pieces] == list(range(len(pieces)))
    assert all(len(piece["data"]) <= size for piece in pieces)
    assert {(piece["op"], piece["id"], piece["total"]) for piece in pieces} == {
        ("fragment", "x", len(pieces))
    }
