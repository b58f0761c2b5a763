"""A node's log on the console."""

from __future__ import annotations

import io
import logging
import re
import sys
from collections.abc import Iterator
from pathlib import Path

import genpy
import pytest
from rospy import console, rostime

from fibws.node.log import FORMAT


@pytest.fixture
def simulated() -> Iterator[None]:
    """Time is simulated, and is 5 seconds."""
    rostime.set_rostime_initialized(True)
    rostime.set_rostime(genpy.Time(5))
    yield
    rostime.switch_to_wallclock()
    rostime.set_rostime_initialized(False)


class Terminal(io.StringIO):
    """A stream that is a terminal."""

    encoding = "ascii"

    def isatty(self) -> bool:
        return True


def record(level: int = logging.INFO, text: str = "hello %s", *args: object) -> logging.LogRecord:
    return logging.LogRecord("rosout", level, "/a/talker.py", 12, text, args, None, "Talker.run")


@pytest.mark.parametrize(
    ("template", "line"),
    [
        ("[${severity}]: ${message}", "[INFO]: hello you"),
        ("${node} ${logger}", "/unnamed rosout"),
        ("${file}:${line} ${function}", "/a/talker.py:12 Talker.run"),
        ("${unknown} ${message:x} $", "${unknown} ${message:x} $"),
        ("${time:then} ${walltime:now}", "then now"),
    ],
)
def test_tags_of_a_template_are_replaced(template: str, line: str) -> None:
    assert console.line_of(record(logging.INFO, "hello %s", "you"), template) == line


def test_line_has_the_time() -> None:
    line = console.line_of(record(), FORMAT)
    assert re.fullmatch(r"\[INFO\] \[\d{10}\.\d{6}\]: hello %s", line)
    assert console.line_of(record(), "${thread}").isdigit()


@pytest.mark.usefixtures("simulated")
def test_line_has_the_simulated_time() -> None:
    assert re.fullmatch(r"\d{10}\.\d{6}, 5\.000000", console.line_of(record(), "${time}"))
    assert console.line_of(record(), "${time:then}") == "then, 5.000000"
    assert re.fullmatch(r"\d{10}\.\d{6}", console.line_of(record(), "${walltime}"))


@pytest.mark.parametrize(
    ("level", "severity"),
    [(10, "DEBUG"), (20, "INFO"), (30, "WARN"), (40, "ERROR"), (50, "FATAL"), (33, "Level 33")],
)
def test_level_has_the_name_of_ros(level: int, severity: str) -> None:
    assert console.line_of(record(level), "${severity}") == severity


def test_warnings_are_printed_on_standard_error(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("ROSCONSOLE_FORMAT", "${message}")
    handler = console.Console()
    handler.emit(record(logging.INFO, "news"))
    handler.emit(record(logging.WARNING, "trouble"))
    out, err = capsys.readouterr()
    assert (out, err) == ("news\n", "trouble\n")


@pytest.mark.parametrize(
    ("level", "line"),
    [
        (logging.DEBUG, "\033[32mx\033[0m\n"),
        (logging.INFO, "x\n"),
        (logging.WARNING, "\033[33mx\033[0m\n"),
        (logging.ERROR, "\033[31mx\033[0m\n"),
        (logging.CRITICAL, "\033[31mx\033[0m\n"),
    ],
)
def test_terminal_shows_colours(level: int, line: str, monkeypatch: pytest.MonkeyPatch) -> None:
    terminal = Terminal()
    monkeypatch.setenv("ROSCONSOLE_FORMAT", "${message}")
    monkeypatch.delenv("NO_COLOR", raising=False)
    monkeypatch.setattr(sys, "stdout", terminal)
    monkeypatch.setattr(sys, "stderr", terminal)
    console.Console().emit(record(level, "x"))
    assert terminal.getvalue() == line


def test_no_color_disables_colours(monkeypatch: pytest.MonkeyPatch) -> None:
    terminal = Terminal()
    monkeypatch.setenv("ROSCONSOLE_FORMAT", "${message}")
    monkeypatch.setenv("NO_COLOR", "1")
    monkeypatch.setattr(sys, "stderr", terminal)
    console.Console().emit(record(logging.ERROR, "x"))
    assert terminal.getvalue() == "x\n"


def test_characters_that_a_stream_cannot_encode_are_escaped(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    terminal = Terminal()
    monkeypatch.setenv("ROSCONSOLE_FORMAT", "${message}")
    monkeypatch.setattr(sys, "stdout", terminal)
    console.Console().emit(record(logging.INFO, "ä"))
    assert terminal.getvalue() == "\\xe4\n"


def test_broken_pipe_is_raised(monkeypatch: pytest.MonkeyPatch) -> None:
    class Closed(Terminal):
        def write(self, text: str, /) -> int:
            raise BrokenPipeError

    monkeypatch.setattr(sys, "stdout", Closed())
    with pytest.raises(BrokenPipeError):
        console.Console().emit(record())


def test_formatting_error_is_printed(capsys: pytest.CaptureFixture[str]) -> None:
    console.Console().emit(record(logging.INFO, "%d", "no number"))
    assert "%d format" in capsys.readouterr().err


def test_log_file_that_cannot_be_made_is_left_out(tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    handler = console.log_file(str(tmp_path / "file" / "node.log"))
    for _ in range(2):
        handler.emit(record())
    handler.close()
    assert [each.name for each in tmp_path.iterdir()] == ["file"]


def test_log_is_appended_to_a_file(tmp_path: Path) -> None:
    path = tmp_path / "node.log"
    handler = console.log_file(str(path))
    assert not path.exists()
    handler.emit(record())
    handler.close()
    assert re.fullmatch(
        r"\[rosout\]\[INFO\] \d{4}-\d\d-\d\d \d\d:\d\d:\d\d,\d{3}: hello %s\n",
        path.read_text("utf-8"),
    )
