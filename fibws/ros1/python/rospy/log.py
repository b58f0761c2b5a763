"""What the program says: on the console, and on /rosout for the whole graph.

All goes through Python's logger ``rosout``, or one below it, which `init_node` gives its handlers.
"""

from __future__ import annotations

import logging
import sys
from types import FrameType
from typing import Any

from rospy.rostime import Duration, Time, get_rostime

DEBUG, INFO, WARN, ERROR, FATAL = 1, 2, 4, 8, 16
"""The levels as rosgraph_msgs/Log has them, which is how `init_node` is told them."""

PYTHON_LEVELS = {
    DEBUG: logging.DEBUG,
    INFO: logging.INFO,
    WARN: logging.WARNING,
    ERROR: logging.ERROR,
    FATAL: logging.CRITICAL,
}

_Place = tuple[str, int, int]
"""Where a line of the log is written: the file, the line and the instruction in it."""

_times: dict[_Place, Time] = {}
_texts: dict[_Place, str] = {}
_places: set[_Place] = set()


def logdebug(msg: Any, *args: Any, **kwargs: Any) -> None:
    """Log a line at level DEBUG.

    Args:
        msg: the text; with ``args``, what ``%`` makes of both.
        args: what is put into the text.
        kwargs: ``logger_name`` for a logger below ``rosout``; ``exc_info`` and ``extra`` as for
            Python's `logging`.
    """
    _log(logging.DEBUG, msg, args, kwargs)


def loginfo(msg: Any, *args: Any, **kwargs: Any) -> None:
    """Log a line at level INFO, as `logdebug` does at DEBUG."""
    _log(logging.INFO, msg, args, kwargs)


def logwarn(msg: Any, *args: Any, **kwargs: Any) -> None:
    """Log a line at level WARN, as `logdebug` does at DEBUG."""
    _log(logging.WARNING, msg, args, kwargs)


def logerr(msg: Any, *args: Any, **kwargs: Any) -> None:
    """Log a line at level ERROR, as `logdebug` does at DEBUG."""
    _log(logging.ERROR, msg, args, kwargs)


def logfatal(msg: Any, *args: Any, **kwargs: Any) -> None:
    """Log a line at level FATAL, as `logdebug` does at DEBUG."""
    _log(logging.CRITICAL, msg, args, kwargs)


logout = loginfo
logerror = logerr


def rospydebug(msg: Any, *args: Any) -> None:
    """Log a line at level DEBUG for whoever looks for faults of the library; not on the console."""
    logging.getLogger("rospy").debug(msg, *args)


def rospyinfo(msg: Any, *args: Any) -> None:
    """Log a line at level INFO, as `rospydebug` does at DEBUG."""
    logging.getLogger("rospy").info(msg, *args)


def rospywarn(msg: Any, *args: Any) -> None:
    """Log a line at level WARN, as `rospydebug` does at DEBUG."""
    logging.getLogger("rospy").warning(msg, *args)


def rospyerr(msg: Any, *args: Any) -> None:
    """Log a line at level ERROR, as `rospydebug` does at DEBUG."""
    logging.getLogger("rospy").error(msg, *args)


def logdebug_throttle(period: float, msg: Any, *args: Any, **kwargs: Any) -> None:
    """Log a line at level DEBUG, but not more often than once in a time.

    Args:
        period: that time in seconds, for this place in the program.
        msg: as for `logdebug`.
        args: as for `logdebug`.
        kwargs: as for `logdebug`.
    """
    _log_throttled(period, logging.DEBUG, msg, args, kwargs)


def loginfo_throttle(period: float, msg: Any, *args: Any, **kwargs: Any) -> None:
    """Log a line at level INFO, as `logdebug_throttle` does at DEBUG."""
    _log_throttled(period, logging.INFO, msg, args, kwargs)


def logwarn_throttle(period: float, msg: Any, *args: Any, **kwargs: Any) -> None:
    """Log a line at level WARN, as `logdebug_throttle` does at DEBUG."""
    _log_throttled(period, logging.WARNING, msg, args, kwargs)


def logerr_throttle(period: float, msg: Any, *args: Any, **kwargs: Any) -> None:
    """Log a line at level ERROR, as `logdebug_throttle` does at DEBUG."""
    _log_throttled(period, logging.ERROR, msg, args, kwargs)


def logfatal_throttle(period: float, msg: Any, *args: Any, **kwargs: Any) -> None:
    """Log a line at level FATAL, as `logdebug_throttle` does at DEBUG."""
    _log_throttled(period, logging.CRITICAL, msg, args, kwargs)


def logdebug_throttle_identical(period: float, msg: str, *args: Any, **kwargs: Any) -> None:
    """Log a line at level DEBUG, but the same text not more often than once in a time.

    Args:
        period: that time in seconds, for this place in the program.
        msg: as for `logdebug`; it is compared without ``args``.
        args: as for `logdebug`.
        kwargs: as for `logdebug`.
    """
    _log_changed(period, logging.DEBUG, msg, args, kwargs)


def loginfo_throttle_identical(period: float, msg: str, *args: Any, **kwargs: Any) -> None:
    """Log a line at level INFO, as `logdebug_throttle_identical` does at DEBUG."""
    _log_changed(period, logging.INFO, msg, args, kwargs)


def logwarn_throttle_identical(period: float, msg: str, *args: Any, **kwargs: Any) -> None:
    """Log a line at level WARN, as `logdebug_throttle_identical` does at DEBUG."""
    _log_changed(period, logging.WARNING, msg, args, kwargs)


def logerr_throttle_identical(period: float, msg: str, *args: Any, **kwargs: Any) -> None:
    """Log a line at level ERROR, as `logdebug_throttle_identical` does at DEBUG."""
    _log_changed(period, logging.ERROR, msg, args, kwargs)


def logfatal_throttle_identical(period: float, msg: str, *args: Any, **kwargs: Any) -> None:
    """Log a line at level FATAL, as `logdebug_throttle_identical` does at DEBUG."""
    _log_changed(period, logging.CRITICAL, msg, args, kwargs)


def logdebug_once(msg: Any, *args: Any, **kwargs: Any) -> None:
    """Log a line at level DEBUG, the first time that this place in the program is come to."""
    _log_once(logging.DEBUG, msg, args, kwargs)


def loginfo_once(msg: Any, *args: Any, **kwargs: Any) -> None:
    """Log a line at level INFO, as `logdebug_once` does at DEBUG."""
    _log_once(logging.INFO, msg, args, kwargs)


def logwarn_once(msg: Any, *args: Any, **kwargs: Any) -> None:
    """Log a line at level WARN, as `logdebug_once` does at DEBUG."""
    _log_once(logging.WARNING, msg, args, kwargs)


def logerr_once(msg: Any, *args: Any, **kwargs: Any) -> None:
    """Log a line at level ERROR, as `logdebug_once` does at DEBUG."""
    _log_once(logging.ERROR, msg, args, kwargs)


def logfatal_once(msg: Any, *args: Any, **kwargs: Any) -> None:
    """Log a line at level FATAL, as `logdebug_once` does at DEBUG."""
    _log_once(logging.CRITICAL, msg, args, kwargs)


def _log_throttled(
    period: float, level: int, msg: Any, args: tuple[Any, ...], kwargs: dict[str, Any]
) -> None:
    frame = sys._getframe(2)
    if not period or _is_due(_place(frame), period):
        _write(frame, level, msg, args, **kwargs)


def _log_changed(
    period: float, level: int, msg: str, args: tuple[Any, ...], kwargs: dict[str, Any]
) -> None:
    frame = sys._getframe(2)
    place = _place(frame)
    due = _is_due(place, period)
    if due or _texts.get(place) != msg:
        _texts[place] = msg
        _write(frame, level, msg, args, **kwargs)


def _log_once(level: int, msg: Any, args: tuple[Any, ...], kwargs: dict[str, Any]) -> None:
    frame = sys._getframe(2)
    place = _place(frame)
    if place not in _places:
        _places.add(place)
        _write(frame, level, msg, args, **kwargs)


def _log(level: int, msg: Any, args: tuple[Any, ...], kwargs: dict[str, Any]) -> None:
    _write(sys._getframe(2), level, msg, args, **kwargs)


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
    """Log a line in the name of a frame, whose object's class is named with its function."""
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
    record.getMessage()  # What is wrong with the arguments is for the caller to know, as in rospy.
    logger.handle(record)


def _function(frame: FrameType) -> str:
    code = frame.f_code
    if "self" in (*code.co_varnames, *code.co_freevars) and "self" in frame.f_locals:
        return f"{type(frame.f_locals['self']).__name__}.{code.co_name}"
    return code.co_name


def _place(frame: FrameType) -> _Place:
    return frame.f_code.co_filename, frame.f_lineno, frame.f_lasti


def _is_due(place: _Place, period: float) -> bool:
    """Whether the last time was long enough ago; if so, this is the last time from now on."""
    now, last = get_rostime(), _times.get(place)
    if last is not None and last > now:
        _times.clear()  # Simulated time went back: what was logged after now is yet to come.
    elif last is not None and now - last <= Duration.from_sec(period):
        return False
    _times[place] = now
    return True
