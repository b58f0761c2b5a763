"""Texts are written as PyYAML writes them."""

from __future__ import annotations

import pytest
import yaml

from fibws.values.yaml_text import listed, quoted

TEXTS = [
    *("hello", "two words", "  spaces ", 'a "quoted" word', "back\\slash", "it's", "yes", "12"),
    *("line\nbreak", "tab\there", "\x1b[31mred", "\0", "\x85\xa0", "grüße", "€", "🤖", "\u2028"),
    *("- item", "x" * 100, "long " * 40, "ü" * 50, "/base_link", "joint_1", "~", ""),
]


@pytest.mark.parametrize("text", TEXTS)
def test_a_text_is_quoted(text: str) -> None:
    expected = yaml.safe_dump(text, default_style='"').rstrip("\n") if text else "''"
    assert quoted(text) == expected


def test_texts_are_listed() -> None:
    assert listed(["a", "b_1"], "  ") == "\n  - a\n  - b_1"
    assert listed(TEXTS, "").lstrip("\n") == yaml.safe_dump(TEXTS).rstrip("\n")
    assert listed(["yes"], " ") == "\n - 'yes'"
