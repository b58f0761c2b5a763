"""A node's log: on the console as rospy prints it, on /rosout, and its level as others set it."""

from __future__ import annotations

import asyncio
import logging
import os
import sys
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator
from contextlib import suppress
from string import Template
from typing import ClassVar, TextIO

from fibws.errors import CallRefused, MessageTooLarge
from fibws.interfaces import Time
from fibws.msg.roscpp import Logger
from fibws.msg.rosgraph_msgs import Log
from fibws.msg.std_msgs import Header
from fibws.node.checks import without_surrogates
from fibws.node.clock import NodeClock
from fibws.node.services import NodeServices
from fibws.node.topics import NodeTopics
from fibws.node.types import MessageCodec
from fibws.protocol.levels import LEVELS, named, severity, threshold
from fibws.srv.roscpp import (
    GetLoggers,
    GetLoggersRequest,
    GetLoggersResponse,
    SetLoggerLevel,
    SetLoggerLevelRequest,
    SetLoggerLevelResponse,
)

FORMAT = "[${severity}] [${time}]: ${message}"
"""How rospy prints a line unless ROSCONSOLE_FORMAT is set."""
FORMAT_WITH_NODE = "[${severity}] [${time}] [${node}]: ${message}"
"""How a line is printed while the process has several nodes; ROS 2 prints names like this."""
ROSOUT = "/rosout"
ROSOUT_QUEUE_SIZE = 100
LOGGER_NAME = "rosout"
"""The name of a node's own logger, as in rospy."""

_FORMATTER = logging.Formatter()
_NAMES = {each.python: each.name.upper() for each in LEVELS}
RESET = "\033[0m"
"""Ends a colour on a terminal."""


def severity_name(record: logging.LogRecord) -> str:
    """Return ROS's name of a record's level, such as ``WARN``; Python's for other levels."""
    return _NAMES.get(record.levelno, record.levelname)


class ConsoleHandler(logging.Handler, ABC):
    """A handler that writes a line for each record: to stderr from WARN on, else to stdout."""

    @abstractmethod
    def line(self, record: logging.LogRecord) -> str:
        """Return the record's line."""

    def emit(self, record: logging.LogRecord) -> None:
        """Write the record's line and flush it.

        Raises:
            BrokenPipeError: the output is no longer read (``| head``).
        """
        try:
            stream = sys.stderr if record.levelno >= logging.WARNING else sys.stdout
            line = self.line(record)
            if start := colour(record.levelno, stream):
                line = f"{start}{line}{RESET}"
            encoding = stream.encoding or "utf-8"
            stream.write(line.encode(encoding, "backslashreplace").decode(encoding) + "\n")
            stream.flush()
        except BrokenPipeError:
            raise
        except Exception:
            self.handleError(record)


class Console(ConsoleHandler):
    """The console of one node.

    Args:
        node: the node's global name.
        template: the line, with the keys of ROSCONSOLE_FORMAT; None for rospy's, which names the
            node while other nodes of the process are running.
    """

    running: ClassVar[list[str]] = []
    """The names of the nodes that run in this process."""

    def __init__(self, node: str, template: str | None) -> None:
        super().__init__()
        self._node = node
        self._template = template

    def line(self, record: logging.LogRecord) -> str:
        """Return the record's line, in the format of ROSCONSOLE_FORMAT."""
        template = self._template
        if template is None:
            is_alone = all(name == self._node for name in self.running)
            template = FORMAT if is_alone else FORMAT_WITH_NODE
        return Template(template).safe_substitute(
            severity=severity_name(record),
            time=f"{record.created:f}",
            walltime=f"{record.created:f}",
            message=_FORMATTER.format(record),
            node=self._node,
            file=record.pathname,
            line=record.lineno,
            function=record.funcName,
            logger=record.name,
            thread=record.thread,
        )


class _UnlistedLogger(logging.Logger):
    """A logger that `logging` does not list, and whose level it cannot cache."""

    def isEnabledFor(self, level: int) -> bool:
        """Return whether records of the level are logged, without a cache."""
        return not self.disabled and self.manager.disable < level >= self.getEffectiveLevel()


def node_log(node: str, template: str | None) -> logging.Logger:
    """Return a logger for one node, which no other part of the program can find.

    Args:
        node: the node's global name.
        template: the console's line, as for `Console`.
    """
    log = _UnlistedLogger(node, logging.INFO)
    log.addHandler(Console(node, template))
    return log


class Rosout(logging.Handler):
    """Publishes each record as a rosgraph_msgs/Log, from any thread, without waiting.

    Args:
        node: the node's global name.
        topics: the node's.
        codec: the codec of `Log`.
        clock: the node's.
    """

    def __init__(
        self, node: str, topics: NodeTopics, codec: MessageCodec[Log], clock: NodeClock
    ) -> None:
        super().__init__()
        self._clock = clock
        self._node = node
        self._topics = topics
        self._publisher = topics.advertise(ROSOUT, codec, queue_size=ROSOUT_QUEUE_SIZE)
        self.loop: asyncio.AbstractEventLoop | None = None
        """The node's loop, once it has one."""

    def emit(self, record: logging.LogRecord) -> None:
        """Publish the record."""
        try:
            message = self._message(record)
        except Exception:
            self.handleError(record)
            return
        if self.loop is None or self.loop is _running_loop():
            self._publish(message)
            return
        with suppress(RuntimeError):  # The loop is closed: the node has ended.
            self.loop.call_soon_threadsafe(self._publish, message)

    def _message(self, record: logging.LogRecord) -> Log:
        stamp = self._clock.simulated
        if stamp is None:
            stamp = round(record.created * 1e9)
        return Log(
            header=Header(stamp=Time.from_nanoseconds(stamp)),
            level=severity(record.levelno).ros,
            name=self._node,
            msg=without_surrogates(_FORMATTER.format(record)),
            file=without_surrogates(record.pathname),
            function=record.funcName or "",
            line=record.lineno,
        )

    def _publish(self, message: Log) -> None:
        if not self._topics.over:
            message.topics = self._topics.names()  # In the loop's thread, which changes them.
            with suppress(MessageTooLarge):  # The console has shown it.
                self._publisher._send_while_open(self._publisher._encode(message))


class Loggers:
    """Provides ``~get_loggers`` and ``~set_logger_level``, as every ROS node does.

    Args:
        log: the node's logger.
        services: the node's.
        resolve: returns the global name of a name.
    """

    def __init__(
        self, log: logging.Logger, services: NodeServices, resolve: Callable[[str], str]
    ) -> None:
        self._log = log
        services.serve(resolve("~get_loggers"), GetLoggers, self._get)
        services.serve(resolve("~set_logger_level"), SetLoggerLevel, self._set)

    def _get(self, request: GetLoggersRequest) -> GetLoggersResponse:
        return GetLoggersResponse(
            [
                Logger(name, threshold(log.getEffectiveLevel()).name)
                for name, log in self._loggers().items()
            ]
        )

    def _set(self, request: SetLoggerLevelRequest) -> SetLoggerLevelResponse:
        loggers = self._loggers()
        log = self._log if request.logger == self._log.name else loggers.get(request.logger)
        if log is None:
            known = ", ".join(map(repr, loggers))
            raise CallRefused(f"unknown logger {request.logger!r}; known: {known}")
        level = named(request.level)
        if level is None:
            known = ", ".join(each.name for each in LEVELS)
            raise CallRefused(f"unknown level {request.level!r}; expected one of {known}")
        log.setLevel(level.python)
        return SetLoggerLevelResponse()

    def _loggers(self) -> dict[str, logging.Logger]:
        """Return the node's logger and the program's loggers below it, by their ROS names."""
        found = {LOGGER_NAME: self._log}
        for name, log in sorted(self._log.manager.loggerDict.items()):
            if isinstance(log, logging.Logger) and self._log in _ancestors(log):
                below = name.removeprefix(f"{self._log.name}.")  # No name begins with the root's.
                found[f"{LOGGER_NAME}.{below}"] = log
        return found


def _ancestors(log: logging.Logger) -> Iterator[logging.Logger]:
    while log.parent is not None:
        log = log.parent
        yield log


def colour(level: int, stream: TextIO) -> str | None:
    """Return what starts the colour of a level's lines; None for lines without one."""
    if level == logging.INFO or os.environ.get("NO_COLOR") or not stream.isatty():
        return None
    if level >= logging.ERROR:
        return "\033[31m"
    return "\033[33m" if level >= logging.WARNING else "\033[32m"


def _running_loop() -> asyncio.AbstractEventLoop | None:
    try:
        return asyncio.get_running_loop()
    except RuntimeError:
        return None
