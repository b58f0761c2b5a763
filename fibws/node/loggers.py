"""How much a node logs, as others may ask and change: rqt_logger_level does, and rosservice."""

from __future__ import annotations

import logging
from collections.abc import Callable, Iterator

from fibws.errors import CallRefused
from fibws.msg.roscpp import Logger
from fibws.node.services import Services
from fibws.protocol.levels import LEVELS, named, threshold
from fibws.srv.roscpp import (
    GetLoggers,
    GetLoggersRequest,
    GetLoggersResponse,
    SetLoggerLevel,
    SetLoggerLevelRequest,
    SetLoggerLevelResponse,
)

NAME = "rosout"
"""What rospy calls the logger of a node's own lines."""


class Loggers:
    """Offers ``~get_loggers`` and ``~set_logger_level``, as every ROS node does."""

    def __init__(
        self, log: logging.Logger, services: Services, resolve: Callable[[str], str]
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
            raise CallRefused(f"there is no logger {request.logger!r} here but {known}")
        level = named(request.level)
        if level is None:
            known = ", ".join(each.name for each in LEVELS)
            raise CallRefused(f"{request.level!r} is no level: say one of {known}")
        log.setLevel(level.python)
        return SetLoggerLevelResponse()

    def _loggers(self) -> dict[str, logging.Logger]:
        """The node's logger and those that the program has below it, by their names on the wire."""
        found = {NAME: self._log}
        for name, log in sorted(self._log.manager.loggerDict.items()):
            if isinstance(log, logging.Logger) and self._log in _ancestors(log):
                below = name.removeprefix(f"{self._log.name}.")  # No name begins with the root's.
                found[f"{NAME}.{below}"] = log
        return found


def _ancestors(log: logging.Logger) -> Iterator[logging.Logger]:
    while log.parent is not None:
        log = log.parent
        yield log
