"""What of clients' doings goes to the log."""

from __future__ import annotations

import pytest

from fibws.hub.logtext import LONGEST_TEXT, is_power_of_ten, printable, shortened


def test_powers_of_ten_are_logged() -> None:
    assert [count for count in range(1, 20_001) if is_power_of_ten(count)] == [
        1,
        10,
        100,
        1000,
        10_000,
    ]


@pytest.mark.parametrize(
    ("text", "written"),
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
def test_the_log_is_written_no_line_ends_and_no_terminal_codes(text: str, written: str) -> None:
    assert printable(text) == written


@pytest.mark.parametrize("cut", [printable, shortened])
def test_a_text_is_cut_when_it_is_longer_than_may_be(cut: type[str]) -> None:
    whole = "x" * LONGEST_TEXT
    assert [cut(whole), cut(whole + "x")] == [whole, whole + "..."]


def test_a_long_text_may_grow_by_what_is_not_printable() -> None:
    assert len(printable("\0" * 10_000)) == 4 * LONGEST_TEXT + 3
