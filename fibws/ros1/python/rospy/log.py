"""The log functions; lines are printed, and published to /rosout.

They use Python's logger ``rosout``, or one below it, to which `init_node` adds handlers.
"""

from __future__ import annotations

import logging
import sys
from types import FrameType
from typing import Any, Protocol

from rospy.rostime import Duration, Time, get_rostime

DEBUG, INFO, WARN, ERROR, FATAL = 1, 2, 4, 8, 16
"""The levels of rosgraph_msgs/Log, for `init_node`."""

PYTHON_LEVELS = {
    DEBUG: logging.DEBUG,
    INFO: logging.INFO,
    WARN: logging.WARNING,
    ERROR: logging.ERROR,
    FATAL: logging.FATAL,
}

_Place = tuple[str, int, int]
"""The place of a log call: file, line and instruction."""

_times: dict[_Place, Time] = {}
_texts: dict[_Place, str] = {}
_places: set[_Place] = set()


class _Log(Protocol):
    def __call__(self, msg: Any, *args: Any, **kwargs: Any) -> None: ...


class _LogThrottled(Protocol):
    def __call__(self, period: float, msg: Any, *args: Any, **kwargs: Any) -> None: ...


def _log(name: str, level: int) -> _Log:
    def log(msg: Any, *args: Any, **kwargs: Any) -> None:
        """Log a line, at the level of the function's name.

        Args:
            msg: the text, formatted by ``%`` if there are ``args``.
            args: the values for the text.
            kwargs: ``logger_name`` for a logger below ``rosout``; ``exc_info`` and ``extra`` as
                for Python's `logging`.
        """
        _write(sys._getframe(1), level, msg, args, **kwargs)

    log.__name__ = log.__qualname__ = name
    return log


def _log_throttle(name: str, level: int) -> _LogThrottled:
    def log(period: float, msg: Any, *args: Any, **kwargs: Any) -> None:
        """Log a line at most once in a period.

        Args:
            period: the period in seconds, for this place in the program.
            msg: as for `logdebug`.
            args: as for `logdebug`.
            kwargs: as for `logdebug`.
        """
        frame = sys._getframe(1)
        if not period or _is_due(_place(frame), period):
            _write(frame, level, msg, args, **kwargs)

    log.__name__ = log.__qualname__ = name
    return log


def _log_throttle_identical(name: str, level: int) -> _LogThrottled:
    def log(period: float, msg: str, *args: Any, **kwargs: Any) -> None:
        """Log a line; the same text at most once in a period.

        Args:
            period: the period in seconds, for this place in the program.
            msg: as for `logdebug`; it is compared without ``args``.
            args: as for `logdebug`.
            kwargs: as for `logdebug`.
        """
        frame = sys._getframe(1)
        place = _place(frame)
        due = _is_due(place, period)
        if due or _texts.get(place) != msg:
            _texts[place] = msg
            _write(frame, level, msg, args, **kwargs)

    log.__name__ = log.__qualname__ = name
    return log


def _log_once(name: str, level: int) -> _Log:
    def log(msg: Any, *args: Any, **kwargs: Any) -> None:
        """Log a line as `logdebug` does, once for this place in the program."""
        frame = sys._getframe(1)
        place = _place(frame)
        if place not in _places:
            _places.add(place)
            _write(frame, level, msg, args, **kwargs)

    log.__name__ = log.__qualname__ = name
    return log


logdebug = _log("logdebug", logging.DEBUG)
loginfo = _log("loginfo", logging.INFO)
logwarn = _log("logwarn", logging.WARNING)
logerr = _log("logerr", logging.ERROR)
logfatal = _log("logfatal", logging.FATAL)
logout, logerror = loginfo, logerr

logdebug_throttle = _log_throttle("logdebug_throttle", logging.DEBUG)
loginfo_throttle = _log_throttle("loginfo_throttle", logging.INFO)
logwarn_throttle = _log_throttle("logwarn_throttle", logging.WARNING)
logerr_throttle = _log_throttle("logerr_throttle", logging.ERROR)
logfatal_throttle = _log_throttle("logfatal_throttle", logging.FATAL)

logdebug_throttle_identical = _log_throttle_identical("logdebug_throttle_identical", logging.DEBUG)
loginfo_throttle_identical = _log_throttle_identical("loginfo_throttle_identical", logging.INFO)
logwarn_throttle_identical = _log_throttle_identical("logwarn_throttle_identical", logging.WARNING)
logerr_throttle_identical = _log_throttle_identical("logerr_throttle_identical", logging.ERROR)
logfatal_throttle_identical = _log_throttle_identical("logfatal_throttle_identical", logging.FATAL)

logdebug_once = _log_once("logdebug_once", logging.DEBUG)
loginfo_once = _log_once("loginfo_once", logging.INFO)
logwarn_once = _log_once("logwarn_once", logging.WARNING)
logerr_once = _log_once("logerr_once", logging.ERROR)
logfatal_once = _log_once("logfatal_once", logging.FATAL)

_library = logging.getLogger("rospy")
"""The library's own log, which is not printed."""

rospydebug, rospyinfo = _library.debug, _library.info
rospywarn, rospyerr = _library.warning, _library.error


def _write(
    frame: FrameType,
    level: int,
    msg: Any,
    args: tuple[Any, ...],
    *,
    logger_name: str | None = None,
    exc_info: Any = None,
    extra: dict[str, Any] | None = None,
) -> None:
    """Log a line with the place of a frame; its function is named with the class of ``self``."""
    logger = logging.getLogger("rosout")
    if logger_name:
        logger = logger.getChild(logger_name)
    if not logger.isEnabledFor(level):
        return
    if isinstance(exc_info, BaseException):
        exc_info = type(exc_info), exc_info, exc_info.__traceback__
    elif exc_info and not isinstance(exc_info, tuple):
        exc_info = sys.exc_info()
    record = logger.makeRecord(
        logger.name,
        level,
        frame.f_code.co_filename,
        frame.f_lineno,
        msg,
        args,
        exc_info,
        _function(frame),
        extra,
    )
    record.getMessage()  # Invalid arguments raise in the caller, as in rospy.
    logger.handle(record)


def _function(frame: FrameType) -> str:
    code = frame.f_code
    if "self" in (*code.co_varnames, *code.co_freevars) and "self" in frame.f_locals:
        return f"{type(frame.f_locals['self']).__name__}.{code.co_name}"
    return code.co_name


def _place(frame: FrameType) -> _Place:
    return frame.f_code.co_filename, frame.f_lineno, frame.f_lasti


def _is_due(place: _Place, period: float) -> bool:
    """Return whether the period since the last time is over; if so, remember this time."""
    now, last = get_rostime(), _times.get(place)
    if last is not None and last > now:
        _times.clear()  # Simulated time went back.
    elif last is not None and now - last <= Duration.from_sec(period):
        return False
    _times[place] = now
    return True
