"""The progress line of commands that write bags."""

from __future__ import annotations

import pytest

from fibws.cli import output
from fibws.cli.bag import progress
from fibws.cli.bag.progress import Progress


def test_terminal_shows_what_is_done(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(output, "has_control_sequences", lambda: True)
    monkeypatch.setattr(progress, "_INTERVAL", -1)
    monkeypatch.setenv("COLUMNS", "70")
    name = "a_folder/with_a_long_name/and_another_one/it\x1b.bag"
    with Progress(name) as shown:
        shown.begin(4 * 2**20)
        shown.add(2**20)
        shown.add(2**20)
        shown.finish()
    start, first, second, end = capsys.readouterr().out.strip("\r\n").split("\r")
    assert "   0%   0.0 KB /   4.0 MB --:-- ETA" in start
    assert "  25%   1.0 MB /   4.0 MB 00:0" in first and "..." in first and "it\\x1b.bag" in first
    assert "  50%   2.0 MB /   4.0 MB 00:0" in second
    assert "100%" in end and "4.0 MB" in end


def test_error_has_a_line_of_its_own(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(output, "has_control_sequences", lambda: True)
    with pytest.raises(OSError), Progress("it.bag") as shown:
        shown.begin(100)
        raise OSError
    assert capsys.readouterr().out.endswith("ETA\n")


def test_nothing_is_shown_if_it_is_quiet(capsys: pytest.CaptureFixture[str]) -> None:
    with Progress("it.bag", quiet=True) as shown:
        shown.begin(100)
        shown.add(100)
        shown.finish()
    assert capsys.readouterr().out == ""
