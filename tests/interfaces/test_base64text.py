"""base64 is read as strictly as Python reads it, and faster."""

from __future__ import annotations

from binascii import Error, a2b_base64
from contextlib import suppress

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fibws.interfaces import base64text


@given(st.binary())
def test_what_is_encoded_is_read_again(data: bytes) -> None:
    text = base64text.encode(data)
    assert base64text.decode(text) == data
    assert base64text.read(text) == (data, text)


@given(st.text(alphabet='AQgw+/=-_\\"u01 \n', max_size=12))
def test_a_text_is_read_as_binascii_reads_it_strictly(text: str) -> None:
    expected = None
    with suppress(Error):
        if len(text) % 4:
            raise Error("binascii lets a = too many pass")
        expected = a2b_base64(text, strict_mode=True)
    if expected is None:
        with pytest.raises(ValueError, match=r"\w"):
            base64text.read(text)
    else:
        assert base64text.read(text) == (expected, base64text.encode(expected))


@pytest.mark.parametrize(
    "text", ["Y", "YQ", "YQ=", "YQ==YQ==", "Y-==", "é===", "YWJj\n", '"YQ"', "\\u0059Q=="]
)
def test_other_spellings_are_refused(text: str) -> None:
    with pytest.raises(ValueError, match=r"\w"):
        base64text.read(text)


def test_spare_bits_are_zero() -> None:
    assert base64text.read("YR==") == (b"a", "YQ==")
