"""A node's log, on the console as rospy prints it."""

from __future__ import annotations

import logging
import os
import sys
from string import Template
from typing import TextIO

from fibws.protocol.levels import LEVELS

FORMAT = "[${severity}] [${time}]: ${message}"
"""How rospy prints a line when ROSCONSOLE_FORMAT does not say otherwise."""

_TEXT = logging.Formatter()
_NAMES = {each.python: each.name.upper() for each in LEVELS}
_RESET = "\033[0m"


class Console(logging.Handler):
    """Writes a line for each record: to stderr from WARN on, else to stdout.

    Args:
        node: the node's global name.
        template: the line, with the keys of ROSCONSOLE_FORMAT.
    """

    def __init__(self, node: str, template: str) -> None:
        super().__init__()
        self._node = node
        self._template = Template(template)

    def emit(self, record: logging.LogRecord) -> None:
        """Write the record's line, at once even into a pipe.

        A reader who has left (``| head``) is for the program to know, so that it may end.
        """
        try:
            stream = sys.stderr if record.levelno >= logging.WARNING else sys.stdout
            line = self._line(record)
            if colour := _colour(record.levelno, stream):
                line = f"{colour}{line}{_RESET}"
            encoding = stream.encoding or "utf-8"
            stream.write(line.encode(encoding, "backslashreplace").decode(encoding) + "\n")
            stream.flush()
        except BrokenPipeError:
            raise
        except Exception:
            self.handleError(record)

    def _line(self, record: logging.LogRecord) -> str:
        return self._template.safe_substitute(
            severity=_NAMES.get(record.levelno, record.levelname),
            time=f"{record.created:f}",
            walltime=f"{record.created:f}",
            message=_TEXT.format(record),
            node=self._node,
            file=record.pathname,
            line=record.lineno,
            function=record.funcName,
            logger=record.name,
            thread=record.thread,
        )


class _Unlisted(logging.Logger):
    """A logger that `logging` does not know, and so does not tell when its level changes."""

    def isEnabledFor(self, level: int) -> bool:
        """As `logging.Logger` has it, but for its cache."""
        return not self.disabled and self.manager.disable < level >= self.getEffectiveLevel()


def node_log(node: str, template: str) -> logging.Logger:
    """A logger that belongs to one node alone: no other part of the program can find it."""
    log = _Unlisted(node, logging.INFO)
    log.addHandler(Console(node, template))
    return log


def _colour(level: int, stream: TextIO) -> str | None:
    if level == logging.INFO or os.environ.get("NO_COLOR") or not stream.isatty():
        return None
    if level >= logging.ERROR:
        return "\033[31m"
    return "\033[33m" if level >= logging.WARNING else "\033[32m"
