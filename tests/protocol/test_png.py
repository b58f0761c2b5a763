"""The png encoding."""

from __future__ import annotations

import json
from base64 import b64decode
from math import ceil, floor, sqrt

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fibws.protocol.png import encode_png

from .png_reader import read_png, read_text


@pytest.mark.parametrize("size", [1, 2, 3, 4, 11, 12, 13, 300, 1000, 100_000])
def test_pixels_are_the_bytes_of_the_text(size: int) -> None:
    text = (b"The quick brown fox. " * size)[:size]
    width, height, pixels = read_png(b64decode(encode_png(text), validate=True))
    assert len(pixels) == width * height * 3
    assert pixels.rstrip(b"\n") == text.rstrip(b"\n")


@pytest.mark.parametrize("size", [3, 12, 13, 27, 100, 1000, 99_999])
def test_image_has_the_size_that_rosbridge_suite_gives_it(size: int) -> None:
    """https://github.com/RobotWebTools/rosbridge_suite, rosbridge_library's pngcompression.py."""
    width, height, _ = read_png(b64decode(encode_png(b"x" * size)))
    assert width == floor(sqrt(size / 3))
    assert height == ceil((size / 3) / width)


def test_padding_does_not_change_json() -> None:
    operation = {"op": "publish", "topic": "/a", "msg": {"data": "ä\n\N{ROBOT FACE}"}}
    for size in range(10):
        text = json.dumps({**operation, "id": "x" * size}).encode()
        _, _, pixels = read_png(b64decode(encode_png(text)))
        assert json.loads(pixels) == {**operation, "id": "x" * size}


def test_repetitive_text_is_compressed() -> None:
    text = b'{"x":0.0,"y":0.0,"z":0.0}' * 1000
    assert len(encode_png(text)) < len(text) / 10


@given(st.recursive(st.text(), lambda inner: st.lists(inner) | st.dictionaries(st.text(), inner)))
@pytest.mark.long
def test_any_text_is_restored_from_ascii(value: object) -> None:
    """Clients decode each byte as one character."""
    text = json.dumps(value, ensure_ascii=False)
    read = read_text(encode_png(text.encode()))
    assert read.isascii()
    assert json.loads(read) == value
    if text.isascii():
        assert read.decode() == text
