"""How much a node logs, as others may ask and change."""

from __future__ import annotations

import logging

import pytest

from fibws.node.log import Loggers
from fibws.node.services import NodeServices
from fibws.node.types import NodeTypes
from fibws.protocol.levels import LEVELS

from .conftest import FakeSession, deliver, next_operation, sent_operations


@pytest.fixture
def log(session: FakeSession, types: NodeTypes) -> logging.Logger:
    log = logging.Logger("/talker", logging.INFO)
    Loggers(log, NodeServices(session, types), lambda name: f"/talker/{name[1:]}")
    return log


async def level(session: FakeSession) -> str:
    deliver(session, "call_service", id="get", service="/talker/get_loggers", args={})
    answer = await next_operation(session)
    (logger,) = answer["values"]["loggers"]
    assert logger["name"] == "rosout"
    found: str = logger["level"]
    return found


async def change(session: FakeSession, logger: str, level: str) -> object:
    args = {"logger": logger, "level": level}
    deliver(session, "call_service", id="set", service="/talker/set_logger_level", args=args)
    return (await next_operation(session))["values"]


async def test_both_services_are_advertised(session: FakeSession, log: logging.Logger) -> None:
    services = [(each["service"], each["type"]) for each in sent_operations(session)]
    assert services == [
        ("/talker/get_loggers", "roscpp/GetLoggers"),
        ("/talker/set_logger_level", "roscpp/SetLoggerLevel"),
    ]


@pytest.mark.parametrize(("name", "number"), [(each.name, each.python) for each in LEVELS])
@pytest.mark.parametrize("logger", ["rosout", "/talker"])
async def test_level_can_be_changed(
    session: FakeSession, log: logging.Logger, logger: str, name: str, number: int
) -> None:
    sent_operations(session)
    assert await level(session) == "info"
    assert await change(session, logger, name.capitalize()) == {}
    assert await level(session) == name
    assert log.level == number


async def test_level_between_two_is_reported_as_the_next_higher_one(
    session: FakeSession, log: logging.Logger
) -> None:
    sent_operations(session)
    log.setLevel(logging.INFO + 5)
    assert await level(session) == "warn"


async def test_child_loggers_are_listed_and_changed_separately(
    session: FakeSession, types: NodeTypes
) -> None:
    log = logging.getLogger("listed")
    log.setLevel(logging.INFO)
    Loggers(log, NodeServices(session, types), lambda name: f"/talker/{name[1:]}")
    sent_operations(session)
    arm = log.getChild("robot.arm")
    arm.setLevel(logging.NOTSET)
    deliver(session, "call_service", id="get", service="/talker/get_loggers", args={})
    assert (await next_operation(session))["values"]["loggers"] == [
        {"name": "rosout", "level": "info"},
        {"name": "rosout.robot.arm", "level": "info"},
    ]
    assert await change(session, "rosout.robot.arm", "debug") == {}
    assert (arm.level, log.level) == (logging.DEBUG, logging.INFO)
    assert await change(session, "rosout.robot", "debug") == (
        "unknown logger 'rosout.robot'; known: 'rosout', 'rosout.robot.arm'"
    )


async def test_root_logger_contains_all_loggers(session: FakeSession, types: NodeTypes) -> None:
    deep = logging.getLogger("library.deep")
    Loggers(logging.getLogger(), NodeServices(session, types), lambda name: f"/talker/{name[1:]}")
    sent_operations(session)
    deliver(session, "call_service", id="get", service="/talker/get_loggers", args={})
    first, *others = [each["name"] for each in (await next_operation(session))["values"]["loggers"]]
    assert first == "rosout"
    assert "rosout.library.deep" in others
    assert all(name.startswith("rosout.") for name in others)
    assert await change(session, "rosout.library.deep", "error") == {}
    assert deep.level == logging.ERROR


@pytest.mark.parametrize(
    ("logger", "name", "text"),
    [
        ("ros", "info", "unknown logger 'ros'; known: 'rosout'"),
        ("rosout", "loud", "unknown level 'loud'; expected one of debug, info, warn, error, fatal"),
    ],
)
async def test_unknown_logger_or_level_is_refused(
    session: FakeSession, log: logging.Logger, logger: str, name: str, text: str
) -> None:
    sent_operations(session)
    assert await change(session, logger, name) == text
    assert log.level == logging.INFO


async def test_logger_without_a_level_has_that_of_its_parent(
    session: FakeSession, types: NodeTypes
) -> None:
    log = logging.Logger("mine")
    log.parent = logging.Logger("root", logging.ERROR)
    Loggers(log, NodeServices(session, types), lambda name: f"/talker/{name[1:]}")
    sent_operations(session)
    assert await level(session) == "error"
