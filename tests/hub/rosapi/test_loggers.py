"""get_loggers and set_logger_level: the level of the hub's log."""

from __future__ import annotations

import logging
from collections.abc import Iterator

import pytest

from .rosapi_client import RosapiClient

LOGGER = logging.getLogger("fibws.hub")
NODES = ["/rosapi", "/rosbridge_websocket", "/rosout"]


@pytest.fixture(autouse=True)
def restore_the_level() -> Iterator[None]:
    level = LOGGER.level
    yield
    LOGGER.setLevel(level)


@pytest.fixture
def rosapi() -> RosapiClient:
    return RosapiClient()


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
def test_level_is_listed_under_both_names(
    rosapi: RosapiClient, node: str, number: int, level: str
) -> None:
    LOGGER.setLevel(number)
    assert rosapi.call(f"{node}/get_loggers") == {
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
def test_level_is_set(
    rosapi: RosapiClient, node: str, logger: str, level: str, number: int
) -> None:
    assert rosapi.call(f"{node}/set_logger_level", logger=logger, level=level) == {}
    assert LOGGER.level == number


@pytest.mark.parametrize("level", ["", "loud", "warning", "20"])
def test_unknown_level_is_refused(rosapi: RosapiClient, level: str) -> None:
    before = LOGGER.level
    refusal = rosapi.refusal("/rosout/set_logger_level", logger="rosout", level=level)
    assert all(each in refusal for each in ("debug", "info", "warn", "error", "fatal", level))
    assert LOGGER.level == before


@pytest.mark.parametrize("logger", ["", "ros", "fibws"])
def test_unknown_logger_is_refused(rosapi: RosapiClient, logger: str) -> None:
    before = LOGGER.level
    refusal = rosapi.refusal("/rosout/set_logger_level", logger=logger, level="debug")
    assert all(each in refusal for each in ("rosout", "fibws.hub", logger))
    assert LOGGER.level == before
