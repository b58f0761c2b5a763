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


def test_lines_look_as_rospys_and_go_where_rospys_go(capsys: pytest.CaptureFixture[str]) -> None:
    log = node_log("/talker", FORMAT)
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


def test_the_level_can_be_changed_at_any_time(capsys: pytest.CaptureFixture[str]) -> None:
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


def test_the_line_can_be_another(capsys: pytest.CaptureFixture[str]) -> None:
    log = node_log(
        "/talker", "${node} ${severity} ${logger} ${function} ${line} ${odd} 5$ ${message}"
    )
    log.info("${node}")
    function = "test_the_line_can_be_another"
    assert re.fullmatch(
        rf"/talker INFO /talker {function} \d+ \$\{{odd\}} 5\$ \$\{{node\}}\n",
        capsys.readouterr().out,
    )


def test_an_exception_is_told_with_its_traceback(capsys: pytest.CaptureFixture[str]) -> None:
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
def test_a_terminal_shows_colours(monkeypatch: pytest.MonkeyPatch, level: int, colour: str) -> None:
    monkeypatch.delenv("NO_COLOR", raising=False)
    out, err = Terminal(), Terminal()
    monkeypatch.setattr(sys, "stdout", out)
    monkeypatch.setattr(sys, "stderr", err)
    log = node_log("/talker", "${message}")
    log.setLevel(10)
    log.log(level, "text")
    reset = "\033[0m" if colour else ""
    assert out.getvalue() + err.getvalue() == f"{colour}text{reset}\n"


def test_but_not_to_those_who_do_not_want_them(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("NO_COLOR", "1")
    err = Terminal()
    monkeypatch.setattr(sys, "stderr", err)
    node_log("/talker", "${message}").warning("text")
    assert err.getvalue() == "text\n"


def test_a_stream_that_lacks_a_character_shows_its_number(monkeypatch: pytest.MonkeyPatch) -> None:
    out = AsciiPipe()
    monkeypatch.setattr(sys, "stdout", out)
    node_log("/talker", "${message}").info("é")
    assert out.getvalue() == "\\xe9\n"


def test_a_reader_who_has_left_is_told_of(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "stdout", BrokenPipe())
    with pytest.raises(BrokenPipeError):
        node_log("/talker", FORMAT).info("text")


def test_a_wrong_log_line_does_not_stop_the_program(capsys: pytest.CaptureFixture[str]) -> None:
    node_log("/talker", FORMAT).info("%d", "thirteen")
    assert "%d format" in capsys.readouterr().err
