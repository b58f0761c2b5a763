"""Texts about types are made once, and bounded."""

from __future__ import annotations

import pytest

from fibws.hub.rosapi.texts import Texts


class Making:
    """Makes texts of ten bytes, and takes note of each."""

    def __init__(self) -> None:
        self.made: list[str] = []

    def __call__(self, name: str) -> bytes:
        self.made.append(name)
        if name == "wrong":
            raise LookupError(name)
        return name.encode().ljust(10)


def test_a_text_is_made_once() -> None:
    making = Making()
    texts = Texts(making)
    assert [texts.of(name) for name in "aba"] == [b"a         ", b"b         ", b"a         "]
    assert making.made == ["a", "b"]


def test_what_cannot_be_made_is_tried_again() -> None:
    making = Making()
    texts = Texts(making)
    for _ in range(2):
        with pytest.raises(LookupError):
            texts.of("wrong")
    assert making.made == ["wrong", "wrong"]


def test_when_there_are_too_many_bytes_all_are_made_anew() -> None:
    making = Making()
    texts = Texts(making, max_bytes=30)
    for name in "abcabc":
        texts.of(name)
    assert making.made == ["a", "b", "c"]
    for name in "dad":
        texts.of(name)
    assert making.made == ["a", "b", "c", "d", "a"]
