"""Texts of clients in the log: printable, and not too long."""

from __future__ import annotations

import pytest

from fibws.hub.log.text import LONGEST_TEXT, is_power_of_ten, printable, shortened


def test_powers_of_ten_are_logged() -> None:
    assert [count for count in range(1, 20_001) if is_power_of_ten(count)] == [
        1,
        10,
        100,
        1000,
        10_000,
    ]


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("a\nb", "a\\nb"),
        ("a\r\tb", "a\\r\\tb"),
        ("\x1b[31mred", "\\x1b[31mred"),
        ("a\u2028b", "a\\u2028b"),
        ("right\u202eleft", "right\\u202eleft"),
        ("lone \ud800", "lone \\ud800"),
        ("\u00e4 \u4e2d \N{ROBOT FACE} 'x' \\", "\u00e4 \u4e2d \N{ROBOT FACE} 'x' \\"),
        ("  around  ", "around"),
    ],
)
def test_line_ends_and_terminal_codes_are_escaped(text: str, expected: str) -> None:
    assert printable(text) == expected


@pytest.mark.parametrize("cut", [printable, shortened])
def test_text_beyond_the_limit_is_cut(cut: type[str]) -> None:
    whole = "x" * LONGEST_TEXT
    assert [cut(whole), cut(whole + "x")] == [whole, whole + "..."]


def test_escapes_may_make_a_text_longer_than_the_limit() -> None:
    assert len(printable("\0" * 10_000)) == 4 * LONGEST_TEXT + 3
