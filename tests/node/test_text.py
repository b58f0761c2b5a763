"""Texts of the program's own that go to the hub."""

from __future__ import annotations

import pytest

from fibws.node.text import sendable


@pytest.mark.parametrize(
    ("text", "sent"), [("grün 🐢", "grün 🐢"), ("file \udcff", "file ?"), ("", "")]
)
def test_halves_of_surrogate_pairs_are_replaced(text: str, sent: str) -> None:
    assert sendable(text) == sent
