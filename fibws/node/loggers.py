"""How much a node logs, as others may ask and change: rqt_logger_level does, and rosservice."""

from __future__ import annotations

import logging
from collections.abc import Callable

from fibws.msg.roscpp import Logger
from fibws.node.levels import LEVELS, level
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


class Loggers:
    """Offers ``~get_loggers`` and ``~set_logger_level``, as every ROS node does."""

    def __init__(
        self, log: logging.Logger, services: Services, resolve: Callable[[str], str]
    ) -> None:
        self._log = log
        services.serve(resolve("~get_loggers"), GetLoggers, self._get)
        services.serve(resolve("~set_logger_level"), SetLoggerLevel, self._set)

    def _get(self, request: GetLoggersRequest) -> GetLoggersResponse:
        return GetLoggersResponse([Logger(NAME, level(self._log.getEffectiveLevel()).name)])

    def _set(self, request: SetLoggerLevelRequest) -> SetLoggerLevelResponse:
        if request.logger not in (NAME, self._log.name):
            raise ValueError(f"there is no logger {request.logger!r} here but {NAME!r}")
        levels = {each.name: each.python for each in LEVELS}
        if request.level.lower() not in levels:
            raise ValueError(f"{request.level!r} is no level: say one of {', '.join(levels)}")
        self._log.setLevel(levels[request.level.lower()])
        return SetLoggerLevelResponse()
