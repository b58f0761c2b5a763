"""base64 is read as strictly as Python reads it, and faster."""

from __future__ import annotations

import tracemalloc
from binascii import Error, a2b_base64
from contextlib import suppress

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fibws.interfaces import base64text


@given(st.binary())
def test_encoded_bytes_are_decoded_unchanged(data: bytes) -> None:
    text = base64text.encode(data)
    assert base64text.decode(text) == data
    assert base64text.canonical(text) == (text, len(data))


@given(st.text(alphabet='AQgw+/=-_\\"u01 \n', max_size=12))
def test_decoding_agrees_with_strict_binascii(text: str) -> None:
    expected = None
    with suppress(Error):
        if len(text) % 4:
            raise Error("binascii lets a = too many pass")
        expected = a2b_base64(text, strict_mode=True)
    if expected is None:
        with pytest.raises(ValueError, match=r"\w"):
            base64text.canonical(text)
    else:
        assert base64text.canonical(text) == (base64text.encode(expected), len(expected))


@pytest.mark.parametrize(
    "text",
    [
        "Y",
        "YQ",
        "YQ=",
        "YQ==YQ==",
        "Y-==",
        "ab-_",
        "-_-_" * 2**15,
        "é===",
        "YWJj\n",
        '"YQ"',
        "\\u0059Q==",
    ],
)
def test_other_spellings_are_refused(text: str) -> None:
    with pytest.raises(ValueError, match=r"\w"):
        base64text.canonical(text)


def test_spare_bits_are_zero() -> None:
    assert base64text.canonical("YR==") == ("YQ==", 1)


@pytest.mark.parametrize("size", [2**16, 3 * 2**15 - 1, 3 * 2**15, 300_001])
def test_long_text_is_decoded_like_a_short_one(size: int) -> None:
    data = bytes(range(256)) * (size // 256) + b"x" * (size % 256)
    text = base64text.encode(data)
    assert base64text.decode(text) == data
    assert base64text.canonical(text) == (text, size)
    for wrong in (f"{text[:65532]}YQ=={text[65536:]}", f"{text[:70_000]}*{text[70_001:]}"):
        with pytest.raises(ValueError, match=r"\w"):
            base64text.canonical(wrong)


def test_checking_a_long_text_takes_little_memory() -> None:
    text = base64text.encode(bytes(3_000_000))
    tracemalloc.start()
    try:
        assert base64text.canonical(text) == (text, 3_000_000)
        assert tracemalloc.get_traced_memory()[1] < len(text) / 4
    finally:
        tracemalloc.stop()


def test_padding_is_found_wherever_it_is() -> None:
    half = base64text.encode(bytes(3 * 2**17 - 1))
    for text in (half + half, half + "AAAA", "QQ==" + half):
        with pytest.raises(ValueError):
            base64text.canonical(text)
