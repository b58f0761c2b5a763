"""The log in JSON: one object per line, whatever is logged."""

from __future__ import annotations

import json
import logging
import subprocess
import sys
from typing import Any

import pytest

from fibws.hub.log.audit import Audit
from fibws.hub.log.output import JsonFormatter, TextFormatter
from fibws.hub.log.text import LONGEST_TEXT


def formatted(**attributes: Any) -> dict[str, Any]:
    """Return the object of a log record."""
    fields: dict[str, Any] = {"name": "fibws.hub", "msg": "text", "levelname": "INFO"}
    record = logging.makeLogRecord({**fields, "levelno": logging.INFO, **attributes})
    line = JsonFormatter().format(record)
    assert line.isascii() and line.isprintable()
    found: dict[str, Any] = json.loads(line)
    return found


def test_line_has_time_level_logger_and_message() -> None:
    line = formatted(created=1_769_851_613.5897, msg="%s left", args=("/talker",))
    assert line == {
        "ts": "2026-01-31T09:26:53.589Z",
        "level": "info",
        "logger": "fibws.hub",
        "message": "/talker left",
    }


@pytest.mark.parametrize(
    ("number", "name"),
    [(logging.WARNING, "warning"), (logging.ERROR, "error"), (logging.CRITICAL, "critical")],
)
def test_levels_have_their_usual_names(number: int, name: str) -> None:
    assert formatted(levelno=number, levelname="WARN")["level"] == name


def test_fields_of_an_event_follow_but_replace_nothing() -> None:
    fields = {"node": "/talker", "ip": "10.0.0.7", "principal": "", "message": "forged", "code": 0}
    line = formatted(event="connected", fields=fields)
    assert line["event"] == "connected"
    assert (line["node"], line["ip"], line["code"]) == ("/talker", "10.0.0.7", 0)
    assert line["message"] == "text"
    assert "principal" not in line


@pytest.mark.parametrize("text", ["a\nb", "\x1b[31m", "ä中\N{ROBOT FACE}", "lone \ud800", '"\\'])
def test_any_text_stays_in_its_line(text: str) -> None:
    line = formatted(msg=text, event="refused", fields={"node": text})
    assert (line["message"], line["node"]) == (text, text)


def test_long_texts_of_clients_are_cut() -> None:
    line = formatted(msg="x" * 10**6, event="refused", fields={"node": "/" * 10**6})
    assert len(line["message"]) < 2000 and len(line["node"]) < 2000


@pytest.mark.parametrize(
    ("text", "line"),
    [
        ("at http://x/\n[INFO] [1.0]: forged", r"at http://x/\n[INFO] [1.0]: forged"),
        ("\x1b[31mred", r"\x1b[31mred"),
        ("a\u2028b", r"a\u2028b"),
        ("x" * 10**6, "x" * LONGEST_TEXT + "..."),
    ],
)
def test_any_text_stays_in_its_line_of_the_text_format(text: str, line: str) -> None:
    record = logging.LogRecord("fibws.hub", logging.WARNING, "", 0, "%s", (text,), None)
    assert TextFormatter().format(record).endswith(f"]: {line}")


def test_question_ends_a_line_without_a_full_stop() -> None:
    record = logging.LogRecord("fibws.hub", 30, "", 0, "%s.", ("did you mean allow?",), None)
    assert TextFormatter().format(record).endswith(": did you mean allow?")
    assert json.loads(JsonFormatter().format(record))["message"] == "did you mean allow?"


def test_traceback_follows_the_line_of_the_text_format() -> None:
    try:
        raise ValueError("broken")
    except ValueError:
        fields = ("fibws.hub", logging.ERROR, "", 0, "failed", None, sys.exc_info())
        first, second, *_ = TextFormatter().format(logging.LogRecord(*fields)).splitlines()
    assert first.endswith("]: failed")
    assert second.startswith("Traceback")


def test_exception_has_its_traceback() -> None:
    try:
        raise ValueError("broken")
    except ValueError:
        line = formatted(exc_info=sys.exc_info())
    assert line["exception"].startswith("Traceback")
    assert "ValueError: broken" in line["exception"]


def test_audit_event_is_an_object_with_its_fields(caplog: pytest.LogCaptureFixture) -> None:
    Audit(lambda: 0.0).refused("authentication", "unknown token", ip="10.0.0.8")
    line = json.loads(JsonFormatter().format(caplog.records[0]))
    assert line["logger"] == "fibws.hub.audit"
    assert (line["event"], line["reason"], line["ip"]) == ("refused", "authentication", "10.0.0.8")
    assert "unknown token" in line["message"]


@pytest.mark.parametrize(
    "fault",
    [
        "raise RuntimeError('broken')",
        "thread = threading.Thread(target=lambda: 1 / 0); thread.start(); thread.join()",
        "warnings.warn('old')",
        "asyncio.run(leave_a_fault())",
    ],
    ids=["main thread", "other thread", "warning", "event loop"],
)
@pytest.mark.long
def test_all_that_python_reports_is_json(fault: str) -> None:
    program = f"""
import asyncio, threading, warnings
from fibws.hub.log import output as log_output
async def leave_a_fault():
    asyncio.get_running_loop().call_soon(lambda: 1 / 0)
    await asyncio.sleep(0)
log_output.configure("json")
{fault}
"""
    found = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True)
    [line] = found.stderr.splitlines()
    assert {"ts", "level", "logger", "message"} <= json.loads(line).keys()
