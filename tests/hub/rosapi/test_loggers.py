"""The levels of the hub's log can be read and changed by any client."""

from __future__ import annotations

import logging
from collections.abc import Iterator

import pytest

from .asking import Asking

LOGGER = logging.getLogger("fibws.hub")
NODES = ["/rosapi", "/rosbridge_websocket", "/rosout"]


@pytest.fixture(autouse=True)
def the_log_is_left_as_it_was() -> Iterator[None]:
    level = LOGGER.level
    yield
    LOGGER.setLevel(level)


@pytest.fixture
def asking() -> Asking:
    return Asking()


@pytest.mark.parametrize("node", NODES)
@pytest.mark.parametrize(
    ("number", "level"),
    [
        (logging.DEBUG, "debug"),
        (5, "debug"),
        (logging.INFO, "info"),
        (25, "warn"),
        (logging.WARNING, "warn"),
        (logging.ERROR, "error"),
        (logging.CRITICAL, "fatal"),
        (1000, "fatal"),
    ],
)
def test_the_level_is_told_under_both_names(
    asking: Asking, node: str, number: int, level: str
) -> None:
    LOGGER.setLevel(number)
    assert asking.gets(f"{node}/get_loggers") == {
        "loggers": [{"name": "rosout", "level": level}, {"name": "fibws.hub", "level": level}]
    }


@pytest.mark.parametrize("node", NODES)
@pytest.mark.parametrize("logger", ["rosout", "fibws.hub"])
@pytest.mark.parametrize(
    ("level", "number"),
    [
        ("debug", logging.DEBUG),
        ("Info", logging.INFO),
        ("WARN", logging.WARNING),
        ("error", logging.ERROR),
        ("fatal", logging.CRITICAL),
    ],
)
def test_the_level_is_set(asking: Asking, node: str, logger: str, level: str, number: int) -> None:
    assert asking.gets(f"{node}/set_logger_level", logger=logger, level=level) == {}
    assert LOGGER.level == number


@pytest.mark.parametrize("level", ["", "loud", "warning", "20"])
def test_an_unknown_level_is_refused(asking: Asking, level: str) -> None:
    before = LOGGER.level
    refused = asking.is_refused("/rosout/set_logger_level", logger="rosout", level=level)
    assert refused == f'a level is debug or info or warn or error or fatal, not "{level}"'
    assert LOGGER.level == before


@pytest.mark.parametrize("logger", ["", "ros", "fibws"])
def test_an_unknown_logger_is_refused(asking: Asking, logger: str) -> None:
    before = LOGGER.level
    refused = asking.is_refused("/rosout/set_logger_level", logger=logger, level="debug")
    assert refused == f'a logger of the hub is rosout or fibws.hub, not "{logger}"'
    assert LOGGER.level == before
