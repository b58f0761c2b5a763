"""Log handlers: for the console, and for the file of ``__log:=``."""

from __future__ import annotations

import logging
import os
import re
import sys
import time
from typing import TextIO

from rospy import rostime
from rospy.names import get_name

FORMAT = "[${severity}] [${time}]: ${message}"
"""The format of a line without ROSCONSOLE_FORMAT."""

SEVERITIES = {
    logging.DEBUG: "DEBUG",
    logging.INFO: "INFO",
    logging.WARNING: "WARN",
    logging.ERROR: "ERROR",
    logging.CRITICAL: "FATAL",
}

_COLOURS = {"DEBUG": "\033[32m", "WARN": "\033[33m", "ERROR": "\033[31m", "FATAL": "\033[31m"}
_RESET = "\033[0m"
_TAG = re.compile(r"\$\{(\w+)(?::([^}]*))?\}")
_TEXT = logging.Formatter()


class Console(logging.Handler):
    """Writes a line for each record: to stderr from WARN on, otherwise to stdout."""

    def emit(self, record: logging.LogRecord) -> None:
        """Write the record's line and flush it.

        Raises:
            BrokenPipeError: the reader has ended (``| head``).
        """
        try:
            stream = sys.stderr if record.levelno >= logging.WARNING else sys.stdout
            line = line_of(record, os.environ.get("ROSCONSOLE_FORMAT", FORMAT))
            colour = _COLOURS.get(_severity(record))
            if colour and _is_coloured(stream):
                line = f"{colour}{line}{_RESET}"
            encoding = stream.encoding or "utf-8"
            stream.write(line.encode(encoding, "backslashreplace").decode(encoding) + "\n")
            stream.flush()
        except BrokenPipeError:
            raise
        except Exception:
            self.handleError(record)


def line_of(record: logging.LogRecord, template: str) -> str:
    """Format a record by a template for ROSCONSOLE_FORMAT; unknown tags are kept."""

    def value(tag: re.Match[str]) -> str:
        key, format_ = tag.groups()
        if key in ("time", "walltime"):
            text = time.strftime(format_) if format_ is not None else f"{time.time():f}"
            simulated = key == "time" and not rostime.is_wallclock()
            return f"{text}, {rostime.get_time():f}" if simulated else text
        if key not in known or format_ is not None:
            return tag[0]
        return str(known[key])

    known = {
        "severity": _severity(record),
        "message": _TEXT.format(record),
        "node": get_name(),
        "logger": record.name,
        "thread": record.thread,
        "file": record.pathname,
        "line": record.lineno,
        "function": record.funcName,
    }
    return _TAG.sub(value, template)


def log_file(path: str) -> logging.Handler:
    """Return a handler that appends each record to a file."""
    handler = logging.FileHandler(path, encoding="utf-8", errors="backslashreplace", delay=True)
    handler.setFormatter(logging.Formatter("[%(name)s][%(levelname)s] %(asctime)s: %(message)s"))
    return handler


def _severity(record: logging.LogRecord) -> str:
    return SEVERITIES.get(record.levelno, record.levelname)


def _is_coloured(stream: TextIO) -> bool:
    return not os.environ.get("NO_COLOR") and stream.isatty()
