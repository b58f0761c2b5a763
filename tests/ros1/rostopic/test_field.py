"""Fields of messages."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import pytest
from rostopic import has_field, msgevalgen

POINTS = [SimpleNamespace(x=number, y=[number] * 3) for number in range(5)]
MESSAGE = SimpleNamespace(points=POINTS, header=SimpleNamespace(seq=8))


@pytest.mark.parametrize(
    ("pattern", "value"),
    [
        ("/header/seq", 8),
        ("/points[2]/x", 2),
        ("/points[-1]/y[0]", 4),
        ("/points[1:3]/x", [1, 2]),
        ("/points[::2]/y[1]", [0, 2, 4]),
        ("/points[3:]", POINTS[3:]),
        ("/points[:]/x", [0, 1, 2, 3, 4]),
    ],
)
def test_field_of_a_message_is_returned(pattern: str, value: object) -> None:
    evaluate = msgevalgen(pattern)
    assert evaluate is not None
    assert evaluate(MESSAGE) == value


def test_pattern_of_the_whole_message_gives_none() -> None:
    assert msgevalgen("") is msgevalgen("/") is None


@pytest.mark.parametrize(
    ("pattern", "fault"),
    [
        ("/header/colour", "no field named colour in /header/colour\n"),
        ("/points[9]/x", "list index out of range: /points[9]/x\n"),
    ],
)
def test_missing_field_is_reported(
    pattern: str, fault: str, capsys: pytest.CaptureFixture[str]
) -> None:
    evaluate: Any = msgevalgen(pattern)
    assert evaluate(MESSAGE) is None
    assert capsys.readouterr().err == fault


@pytest.mark.parametrize("pattern", ["/points[", "/points[]", "/points[x]", "/points[1:2:3:4]"])
def test_invalid_path_is_reported(pattern: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert msgevalgen(pattern) is None
    assert "points[" in capsys.readouterr().err


def test_has_field_checks_the_path() -> None:
    assert has_field(MESSAGE, "/header/seq")
    assert has_field(MESSAGE, "/points[7]/anything")
    assert not has_field(MESSAGE, "/header/colour")
