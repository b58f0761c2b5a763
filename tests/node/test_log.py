"""A node's log on the console."""

from __future__ import annotations

import io
import logging
import re
import sys

import pytest

from fibws.node.log import FORMAT, node_log


class Terminal(io.StringIO):
    encoding = "utf-8"

    def isatty(self) -> bool:
        return True


class AsciiPipe(io.StringIO):
    encoding = "ascii"


class BrokenPipe(io.StringIO):
    def write(self, text: str) -> int:
        raise BrokenPipeError


def test_lines_have_the_format_and_the_stream_of_rospy(capsys: pytest.CaptureFixture[str]) -> None:
    log = node_log("/talker", None)
    log.debug("not shown")
    log.info("I heard %d", 13)
    log.warning("careful")
    log.error("wrong")
    log.critical("over")
    printed = capsys.readouterr()
    assert re.fullmatch(r"\[INFO\] \[\d{10}\.\d{6}\]: I heard 13\n", printed.out)
    assert re.fullmatch(
        r"\[WARN\] \[.*\]: careful\n\[ERROR\] \[.*\]: wrong\n\[FATAL\] \[.*\]: over\n", printed.err
    )


def test_level_can_be_changed_at_any_time(capsys: pytest.CaptureFixture[str]) -> None:
    log = node_log("/talker", "${message}")
    for level in (logging.INFO, logging.DEBUG, logging.WARNING, logging.DEBUG):
        log.setLevel(level)
        log.debug("at %d", level)
    log.disabled = True
    log.debug("disabled")
    log.disabled = False
    logging.disable(logging.DEBUG)
    log.debug("disabled for all")
    logging.disable(logging.NOTSET)
    assert capsys.readouterr().out == "at 10\nat 10\n"


def test_line_format_is_configurable(capsys: pytest.CaptureFixture[str]) -> None:
    log = node_log(
        "/talker", "${node} ${severity} ${logger} ${function} ${line} ${odd} 5$ ${message}"
    )
    log.info("${node}")
    function = "test_line_format_is_configurable"
    assert re.fullmatch(
        rf"/talker INFO /talker {function} \d+ \$\{{odd\}} 5\$ \$\{{node\}}\n",
        capsys.readouterr().out,
    )


def test_exception_is_logged_with_its_traceback(capsys: pytest.CaptureFixture[str]) -> None:
    log = node_log("/talker", FORMAT)
    try:
        raise ValueError("seven")
    except ValueError:
        log.exception("no number")
    printed = capsys.readouterr().err
    assert "no number\nTraceback" in printed
    assert "ValueError: seven" in printed


@pytest.mark.parametrize(
    ("level", "colour"), [(10, "\033[32m"), (20, ""), (30, "\033[33m"), (40, "\033[31m")]
)
def test_terminal_shows_colours(monkeypatch: pytest.MonkeyPatch, level: int, colour: str) -> None:
    monkeypatch.delenv("NO_COLOR", raising=False)
    out, err = Terminal(), Terminal()
    monkeypatch.setattr(sys, "stdout", out)
    monkeypatch.setattr(sys, "stderr", err)
    log = node_log("/talker", "${message}")
    log.setLevel(10)
    log.log(level, "text")
    reset = "\033[0m" if colour else ""
    assert out.getvalue() + err.getvalue() == f"{colour}text{reset}\n"


def test_colours_can_be_turned_off(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("NO_COLOR", "1")
    err = Terminal()
    monkeypatch.setattr(sys, "stderr", err)
    node_log("/talker", "${message}").warning("text")
    assert err.getvalue() == "text\n"


def test_unencodable_characters_are_escaped(monkeypatch: pytest.MonkeyPatch) -> None:
    out = AsciiPipe()
    monkeypatch.setattr(sys, "stdout", out)
    node_log("/talker", "${message}").info("é")
    assert out.getvalue() == "\\xe9\n"


def test_broken_pipe_is_reported(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "stdout", BrokenPipe())
    with pytest.raises(BrokenPipeError):
        node_log("/talker", FORMAT).info("text")


def test_invalid_log_call_does_not_stop_the_program(capsys: pytest.CaptureFixture[str]) -> None:
    node_log("/talker", FORMAT).info("%d", "thirteen")
    assert "%d format" in capsys.readouterr().err
