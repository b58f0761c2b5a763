"""The log functions."""

from __future__ import annotations

import logging
import pickle
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import genpy
import pytest
import rospy
from rospy import log, rostime

LEVELS = {"debug": 10, "info": 20, "warn": 30, "err": 40, "fatal": 50}


class Records(logging.Handler):
    """Keeps what is logged."""

    def __init__(self) -> None:
        super().__init__()
        self.kept: list[logging.LogRecord] = []

    def emit(self, record: logging.LogRecord) -> None:
        self.kept.append(record)

    @property
    def texts(self) -> list[str]:
        return [record.getMessage() for record in self.kept]


@pytest.fixture
def records(monkeypatch: pytest.MonkeyPatch) -> Iterator[Records]:
    """The records of this test; throttling starts from scratch."""
    monkeypatch.setattr(log, "_places", set())
    monkeypatch.setattr(log, "_times", {})
    monkeypatch.setattr(log, "_texts", {})
    handler, logger = Records(), logging.getLogger("rosout")
    logger.addHandler(handler)
    logger.setLevel(logging.DEBUG)
    logger.propagate = False
    yield handler
    logger.removeHandler(handler)
    logger.setLevel(logging.NOTSET)
    logger.propagate = True


@pytest.fixture
def clock() -> Iterator[Callable[[float], None]]:
    """Sets the time, which is simulated and 0 at first."""
    rostime.set_rostime_initialized(True)

    def set_time(seconds: float) -> None:
        rostime.set_rostime(genpy.Time(seconds))

    set_time(0)
    yield set_time
    rostime.switch_to_wallclock()
    rostime.set_rostime_initialized(False)


@pytest.mark.parametrize("name", LEVELS)
def test_line_has_its_level_and_place(records: Records, name: str) -> None:
    getattr(rospy, f"log{name}")("%s and %d", "one", 2)
    (record,) = records.kept
    assert record.getMessage() == "one and 2"
    assert record.levelno == LEVELS[name]
    assert record.name == "rosout"
    assert Path(record.pathname) == Path(__file__)
    assert record.funcName == "test_line_has_its_level_and_place"


@pytest.mark.parametrize("kind", ["", "_throttle", "_throttle_identical", "_once"])
@pytest.mark.parametrize("level", LEVELS)
def test_log_functions_have_their_names(level: str, kind: str) -> None:
    name = f"log{level}{kind}"
    function = getattr(rospy, name)
    assert (function.__name__, function.__qualname__) == (name, name)
    assert pickle.loads(pickle.dumps(function)) is function


def test_method_is_logged_with_its_class(records: Records) -> None:
    class Talker:
        def talk(self) -> None:
            rospy.loginfo("hello")

    Talker().talk()
    assert records.kept[0].funcName == "Talker.talk"


def test_line_can_go_to_another_logger(records: Records) -> None:
    rospy.loginfo("hello", logger_name="wheels")
    assert records.kept[0].name == "rosout.wheels"


def test_message_can_be_any_object(records: Records) -> None:
    rospy.loginfo({"a": 1})
    rospy.logout("100%")
    assert records.texts == ["{'a': 1}", "100%"]


@pytest.mark.parametrize("how", ["it is handled", "it is given", "it is given in parts"])
def test_line_can_include_an_exception(records: Records, how: str) -> None:
    try:
        raise ValueError("no good")
    except ValueError as error:
        parts = type(error), error, error.__traceback__
        given: Any = {"it is handled": True, "it is given": error}.get(how, parts)
        rospy.logerr("failed", exc_info=given)
    assert records.kept[0].exc_info is not None
    assert isinstance(records.kept[0].exc_info[1], ValueError)


def test_lines_below_the_level_are_not_logged(records: Records) -> None:
    logging.getLogger("rosout").setLevel(logging.WARNING)
    rospy.loginfo("hello")
    rospy.logwarn("careful")
    assert records.texts == ["careful"]


@pytest.mark.parametrize("name", LEVELS)
def test_once_logs_once_in_each_place(records: Records, name: str) -> None:
    once = getattr(rospy, f"log{name}_once")
    for number in range(3):
        once("one %d", number)
    once("two")
    assert records.texts == ["one 0", "two"]
    assert {record.levelno for record in records.kept} == {LEVELS[name]}


@pytest.mark.parametrize("name", LEVELS)
def test_throttled_line_is_logged_once_in_a_period(
    records: Records, clock: Callable[[float], None], name: str
) -> None:
    throttled = getattr(rospy, f"log{name}_throttle")
    for seconds in 0, 1, 2, 2.5, 5:
        clock(seconds)
        throttled(2, "at %s", seconds)
    assert records.texts == ["at 0", "at 2.5", "at 5"]
    assert {record.levelno for record in records.kept} == {LEVELS[name]}


def test_period_of_zero_does_not_throttle(records: Records, clock: Callable[[float], None]) -> None:
    for _ in range(3):
        rospy.loginfo_throttle(0, "again")
    assert len(records.kept) == 3


def test_throttling_is_reset_when_time_goes_back(
    records: Records, clock: Callable[[float], None]
) -> None:
    for seconds in 100, 5, 6:
        clock(seconds)
        rospy.loginfo_throttle(10, "at %s", seconds)
    assert records.texts == ["at 100", "at 5"]


@pytest.mark.parametrize("name", LEVELS)
def test_identical_line_is_logged_once_in_a_period(
    records: Records, clock: Callable[[float], None], name: str
) -> None:
    throttled = getattr(rospy, f"log{name}_throttle_identical")
    for seconds, text in (0, "a"), (1, "a"), (2, "b"), (3, "b"), (20, "b"):
        clock(seconds)
        throttled(10, text)
    assert records.texts == ["a", "b", "b"]
    assert {record.levelno for record in records.kept} == {LEVELS[name]}


def test_levels_are_those_of_rosgraph_msgs() -> None:
    assert (rospy.DEBUG, rospy.INFO, rospy.WARN, rospy.ERROR, rospy.FATAL) == (1, 2, 4, 8, 16)
    assert list(log.PYTHON_LEVELS.values()) == list(LEVELS.values())


def test_invalid_arguments_are_an_error(records: Records) -> None:
    with pytest.raises(TypeError, match="a real number is required"):
        rospy.loginfo("%d", "five")
    with pytest.raises(TypeError, match="not all arguments"):
        rospy.logwarn("five", 5)
    rospy.loginfo("100%")
    assert records.texts == ["100%"]


def test_log_of_the_library_is_not_the_log_of_the_node(
    records: Records, caplog: pytest.LogCaptureFixture
) -> None:
    with caplog.at_level(logging.DEBUG, "rospy"):
        log.rospydebug("%s", "debug")
        log.rospyinfo("info")
        log.rospywarn("warn")
        log.rospyerr("err")
    said = [(record.name, record.levelno, record.getMessage()) for record in caplog.records]
    assert said == [
        ("rospy", logging.DEBUG, "debug"),
        ("rospy", logging.INFO, "info"),
        ("rospy", logging.WARNING, "warn"),
        ("rospy", logging.ERROR, "err"),
    ]
    assert records.texts == []
