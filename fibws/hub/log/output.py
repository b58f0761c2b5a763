"""The hub's log on stderr: lines of text, or one JSON object per line for log collectors."""

from __future__ import annotations

import json
import logging
import sys
import threading
from datetime import UTC, datetime
from types import TracebackType
from typing import Any

from fibws.hub.log.text import printable, shortened

logger = logging.getLogger("fibws.hub")

TEXT_FORMAT = "[{}] [{:f}]: {}"
LEVELS = {
    logging.DEBUG: "debug",
    logging.INFO: "info",
    logging.WARNING: "warning",
    logging.ERROR: "error",
    logging.CRITICAL: "critical",
}


class TextFormatter(logging.Formatter):
    """Formats a log record as one line of text, which a traceback may follow.

    Messages have texts of clients and nodes in them: one with a line break would forge a line.
    """

    def formatMessage(self, record: logging.LogRecord) -> str:
        """Return the line; other libraries' messages may have several."""
        if record.name.startswith("fibws"):
            record.message = printable(_ended(record.message))
        level = "WARN" if record.levelno == logging.WARNING else record.levelname  # as in ROS
        return TEXT_FORMAT.format(level, record.created, record.message)


class JsonFormatter(logging.Formatter):
    """Formats a log record as one line with a JSON object.

    ``ts`` is the time in UTC (ISO 8601, milliseconds), ``level`` one of `LEVELS`, ``logger`` the
    Python logger. ``event`` names the kind of line for programs, where it has one; its fields, such
    as ``node``, ``principal`` and ``ip``, follow the ``message``. Of an exception, ``exception``
    has the traceback. Characters beyond ASCII are escaped, so that any terminal and any collector
    can take the line.
    """

    def format(self, record: logging.LogRecord) -> str:
        """Return the line, without its newline."""
        line: dict[str, Any] = {
            "ts": _iso(record.created),
            "level": LEVELS.get(record.levelno, record.levelname.lower()),
            "logger": record.name,
            "event": getattr(record, "event", None),
            "message": shortened(_ended(record.getMessage())),
        }
        for name, value in getattr(record, "fields", {}).items():
            line.setdefault(name, shortened(value) if isinstance(value, str) else value)
        if record.exc_info:
            line["exception"] = self.formatException(record.exc_info)
        if record.stack_info:
            line["stack"] = record.stack_info
        return json.dumps({name: value for name, value in line.items() if value not in ("", None)})


def _ended(text: str) -> str:
    """Return a text without the full stop behind an error that ends with a question."""
    return text[:-1] if text.endswith("?.") else text


def configure(log_format: str) -> None:
    """Write the log of the process to stderr.

    Args:
        log_format: ``text`` or ``json``. With ``json``, exceptions that nothing catches and
            Python's warnings are objects, too.
    """
    handler = logging.StreamHandler()
    if log_format == "json":
        handler.setFormatter(JsonFormatter())
        logging.captureWarnings(True)
        sys.excepthook = _log_uncaught
        threading.excepthook = lambda args: _log_uncaught(
            args.exc_type, args.exc_value, args.exc_traceback
        )
        sys.unraisablehook = lambda args: _log_uncaught(
            args.exc_type, args.exc_value, args.exc_traceback
        )
    else:
        handler.setFormatter(TextFormatter())
    logging.basicConfig(handlers=[handler], level=logging.INFO)


def _log_uncaught(
    kind: type[BaseException], error: BaseException | None, traceback: TracebackType | None
) -> None:
    fault = error if error is not None else kind()
    logger.critical(
        "Uncaught %s.", kind.__name__, exc_info=(kind, fault, traceback), extra={"event": "crash"}
    )


def _iso(created: float) -> str:
    moment = datetime.fromtimestamp(created, UTC)
    return f"{moment:%Y-%m-%dT%H:%M:%S}.{moment.microsecond // 1000:03d}Z"
