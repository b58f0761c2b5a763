"""The services of every ROS node that read and set the level of its log.

All of the hub's nodes share one log. As in rospy it has two names: that of ROS's topic, and that of
the Python logger.
"""

from __future__ import annotations

import logging
from typing import Any

from fibws.errors import OperationError
from fibws.hub.graph.service import Function, Response
from fibws.protocol.decoding import quoted
from fibws.protocol.levels import LEVELS, named, threshold

LOGGER = logging.getLogger("fibws.hub")
NAMES = ("rosout", LOGGER.name)


def services(node: str) -> dict[str, tuple[str, Function]]:
    """Return the services of one node by their global names, each with its type and handler."""
    return {
        f"{node}/get_loggers": ("roscpp/GetLoggers", get_loggers),
        f"{node}/set_logger_level": ("roscpp/SetLoggerLevel", set_logger_level),
    }


def get_loggers(request: dict[str, Any], caller: str) -> Response:
    """Return the level of the hub's log."""
    level = threshold(LOGGER.getEffectiveLevel())
    return {"loggers": [{"name": name, "level": level.name} for name in NAMES]}


def set_logger_level(request: dict[str, Any], caller: str) -> Response:
    """Set the level of the hub's log, whose name may be in capitals.

    Raises:
        OperationError: the level or the logger is unknown.
    """
    level = named(request["level"])
    if level is None:
        known = " or ".join(each.name for each in LEVELS)
        raise OperationError(f"level must be {known}, got {quoted(request['level'])}")
    if request["logger"] not in NAMES:
        raise OperationError(
            f"logger must be {' or '.join(NAMES)}, got {quoted(request['logger'])}"
        )
    LOGGER.setLevel(level.python)
    return {}
