"""How much a node logs, as others may ask and change: rqt_logger_level does, and rosservice."""

from __future__ import annotations

import logging
from collections.abc import Callable

from fibws.msg.roscpp import Logger
from fibws.node.rosout import level
from fibws.node.services import Services
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

LEVELS = {
    "debug": logging.DEBUG,
    "info": logging.INFO,
    "warn": logging.WARNING,
    "error": logging.ERROR,
    "fatal": logging.CRITICAL,
}
"""What http://wiki.ros.org/Verbosity%20Levels calls Python's levels."""


class Loggers:
    """Offers ``~get_loggers`` and ``~set_logger_level``, as every ROS node does."""

    def __init__(
        self, log: logging.Logger, services: Services, resolve: Callable[[str], str]
    ) -> None:
        self._log = log
        services.serve(resolve("~get_loggers"), GetLoggers, self._get)
        services.serve(resolve("~set_logger_level"), SetLoggerLevel, self._set)

    def _get(self, request: GetLoggersRequest) -> GetLoggersResponse:
        now = level(self._log.level)
        name = next(name for name, number in LEVELS.items() if level(number) == now)
        return GetLoggersResponse([Logger(NAME, name)])

    def _set(self, request: SetLoggerLevelRequest) -> SetLoggerLevelResponse:
        if request.logger not in (NAME, self._log.name):
            raise ValueError(f"there is no logger {request.logger!r} here but {NAME!r}")
        if request.level.lower() not in LEVELS:
            raise ValueError(f"{request.level!r} is no level: say one of {', '.join(LEVELS)}")
        self._log.setLevel(LEVELS[request.level.lower()])
        return SetLoggerLevelResponse()
