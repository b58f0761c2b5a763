"""Log handlers: for the console, and for the file of ``__log:=``."""

from __future__ import annotations

import logging
import os
import re
import time
from io import TextIOWrapper
from logging.handlers import RotatingFileHandler

from fibws.node.log import FORMAT, ConsoleHandler, severity_name
from rospy import rostime
from rospy.names import get_name

_TAG = re.compile(r"\$\{(\w+)(?::([^}]*))?\}")
_TEXT = logging.Formatter()


MOST_BYTES, OLDER_FILES = 50_000_000, 4
"""Bytes of a log file, and how many older ones are kept."""


class Console(ConsoleHandler):
    """Writes a line for each record in the format of $ROSCONSOLE_FORMAT."""

    def line(self, record: logging.LogRecord) -> str:
        """Return the record's line."""
        return line_of(record, os.environ.get("ROSCONSOLE_FORMAT", FORMAT))


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
        "severity": severity_name(record),
        "message": _TEXT.format(record),
        "node": get_name(),
        "logger": record.name,
        "thread": record.thread,
        "file": record.pathname,
        "line": record.lineno,
        "function": record.funcName,
    }
    return _TAG.sub(value, template)


class _LogFile(RotatingFileHandler):
    """Makes the file's folder, too; nothing is written where that is not possible."""

    def _open(self) -> TextIOWrapper:
        try:
            os.makedirs(os.path.dirname(self.baseFilename), exist_ok=True)
            return super()._open()
        except OSError:
            self.baseFilename = os.devnull
            return super()._open()


def log_file(path: str) -> logging.Handler:
    """Return a handler that appends each record to a file, which it makes for the first one.

    As in ROS, older records go to other files, and of those the oldest are deleted.
    """
    handler = _LogFile(
        path, "a", MOST_BYTES, OLDER_FILES, encoding="utf-8", delay=True, errors="backslashreplace"
    )
    handler.setFormatter(logging.Formatter("[%(name)s][%(levelname)s] %(asctime)s: %(message)s"))
    return handler
