"""Whether words come by a pipe, from a keyboard, or from nowhere."""

from __future__ import annotations

import io
import sys

import pytest

from fibws.cli.input import is_keyboard, piped


class Keyboard(io.StringIO):
    def isatty(self) -> bool:
        return True


def test_a_pipe_is_read(monkeypatch: pytest.MonkeyPatch) -> None:
    pipe = io.StringIO("5")
    monkeypatch.setattr(sys, "stdin", pipe)
    assert piped() is pipe
    assert not is_keyboard()


def test_a_person_is_not_waited_for(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "stdin", Keyboard())
    assert piped() is None
    assert is_keyboard()


def test_nothing_comes_from_what_is_closed(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "stdin", None)
    assert piped() is None
    assert not is_keyboard()
