"""The levels of the hub's log: the services that every ROS node has beside its own.

All of the hub's nodes write to the one log. As in rospy it has two names: that of ROS's topic, and
that of the Python logger.
"""

from __future__ import annotations

import logging
from typing import Any

from fibws.errors import OperationError
from fibws.hub.graph.service import Answer, Function
from fibws.protocol.levels import LEVELS, named, threshold
from fibws.protocol.parsing import quoted

LOGGER = logging.getLogger("fibws.hub")
NAMES = ("rosout", LOGGER.name)


def services(node: str) -> dict[str, tuple[str, Function]]:
    """Those of one node by their global names, each with its type and what answers it."""
    return {
        f"{node}/get_loggers": ("roscpp/GetLoggers", get_loggers),
        f"{node}/set_logger_level": ("roscpp/SetLoggerLevel", set_logger_level),
    }


def get_loggers(request: dict[str, Any], caller: str) -> Answer:
    """The levels from which on the hub logs."""
    level = threshold(LOGGER.getEffectiveLevel())
    return {"loggers": [{"name": name, "level": level.name} for name in NAMES]}


def set_logger_level(request: dict[str, Any], caller: str) -> Answer:
    """Have the hub log from a level on, whose name may be in capitals.

    Raises:
        OperationError: there is no such level, or no such logger.
    """
    level = named(request["level"])
    if level is None:
        known = " or ".join(each.name for each in LEVELS)
        raise OperationError(f"a level is {known}, not {quoted(request['level'])}")
    if request["logger"] not in NAMES:
        raise OperationError(
            f"a logger of the hub is {' or '.join(NAMES)}, not {quoted(request['logger'])}"
        )
    LOGGER.setLevel(level.python)
    return {}
