"""A node's log on /rosout."""

from __future__ import annotations

import asyncio
import json
import logging
import threading
import time
from http import HTTPStatus

import pytest

import fibws
from fibws.msg.rosgraph_msgs import Log
from fibws.msg.std_msgs import Int32
from fibws.node.clock import NodeClock
from fibws.node.log import Rosout
from fibws.node.session import Session
from fibws.node.topics import NodeTopics
from fibws.node.types import NodeTypes

from .conftest import ScriptedHub


async def test_message_has_node_file_function_and_line(hub: ScriptedHub) -> None:
    async with fibws.Node("talker", hub=hub.url) as node:
        peer = await hub.peer()
        await node.advertise("fibonacci", Int32)
        node.subscribe("other", Int32)
        node.log.warning("%d is large", 89)
        message = await peer.logged()
    stamp = message["header"]["stamp"]
    assert abs(stamp["secs"] + stamp["nsecs"] / 1e9 - time.time()) < 60
    assert message["level"] == Log.WARN
    assert message["name"] == "/talker"
    assert message["msg"] == "89 is large"
    assert message["file"] == __file__
    assert message["function"] == "test_message_has_node_file_function_and_line"
    assert message["line"] > 20
    assert message["topics"] == ["/fibonacci", "/other", "/rosout"]


async def test_other_threads_may_log(hub: ScriptedHub) -> None:
    async with fibws.Node("talker", hub=hub.url) as node:
        peer = await hub.peer()
        await asyncio.to_thread(node.log.info, "from elsewhere")
        assert (await peer.logged())["msg"] == "from elsewhere"


async def test_topics_are_read_only_in_the_event_loop(hub: ScriptedHub) -> None:
    async with fibws.Node("talker", hub=hub.url) as node:
        peer = await hub.peer()
        elsewhere = threading.Thread(target=node.log.info, args=["from elsewhere"])
        elsewhere.start()
        elsewhere.join()
        await node.advertise("later", Int32)  # It never gives way to what the thread left to do.
        assert (await peer.logged())["topics"] == ["/later", "/rosout"]


def test_other_threads_may_log_after_the_loop_has_closed() -> None:
    session = Session(logging.Logger("test"))
    rosout = Rosout(
        "/talker", NodeTopics(session), NodeTypes(time.time_ns).codec(Log), NodeClock(session)
    )
    rosout.loop = asyncio.new_event_loop()
    rosout.loop.close()
    rosout.handle(logging.LogRecord("test", logging.INFO, "file", 1, "text", (), None))
    assert len(session.outgoing) == 0


def test_newest_lines_are_kept_without_a_hub() -> None:
    session = Session(logging.Logger("test"))
    rosout = Rosout(
        "/talker", NodeTopics(session), NodeTypes(time.time_ns).codec(Log), NodeClock(session)
    )
    for _ in range(1000):
        rosout.handle(logging.LogRecord("test", logging.INFO, "file", 1, "text", (), None))
    assert len(session.outgoing) == 100


def test_lone_surrogate_is_sent_as_a_question_mark() -> None:
    session = Session(logging.Logger("test"))
    rosout = Rosout(
        "/talker", NodeTopics(session), NodeTypes(time.time_ns).codec(Log), NodeClock(session)
    )
    rosout.handle(logging.LogRecord("test", logging.INFO, "\udcff.py", 1, "\ud83d", (), None))
    ((frame, lane),) = session.outgoing._queue
    assert lane is not None
    message = json.loads(lane.to_json(frame))["msg"]
    assert (message["msg"], message["file"]) == ("?", "?.py")


def test_invalid_log_call_does_not_stop_the_program(capsys: pytest.CaptureFixture[str]) -> None:
    session = Session(logging.Logger("test"))
    rosout = Rosout(
        "/talker", NodeTopics(session), NodeTypes(time.time_ns).codec(Log), NodeClock(session)
    )
    rosout.handle(logging.LogRecord("test", logging.INFO, "file", 1, "%d", ("thirteen",), None))
    assert "%d format" in capsys.readouterr().err
    assert len(session.outgoing) == 0


async def test_refused_log_is_not_sent(hub: ScriptedHub) -> None:
    async with fibws.Node("talker", hub=hub.url) as node:
        peer = await hub.peer()
        other = node.subscribe("other", Int32)
        await peer.send("status", level="error", id="advertise:/rosout:1", msg="no")
        await peer.send("publish", topic="/other", msg={"data": 1})
        await anext(other)
        node.log.info("not published")
        await node.advertise("fibonacci", Int32)
        assert (await peer.expect("subscribe"))["topic"] == "/other"
        assert (await peer.expect("advertise"))["topic"] == "/fibonacci"


async def test_given_logger_is_used_unchanged(
    hub: ScriptedHub, capsys: pytest.CaptureFixture[str]
) -> None:
    log = logging.getLogger("fibws.test_rosout")
    log.setLevel(logging.DEBUG)
    own = logging.NullHandler()
    log.addHandler(own)
    async with fibws.Node("talker", hub=hub.url, log=log) as node:
        peer = await hub.peer()
        assert node.log is log
        (lambda: log.debug("small", stacklevel=2))()
        message = await peer.logged()
        assert (message["level"], message["name"]) == (Log.DEBUG, "/talker")
        assert (message["msg"], message["function"]) == (
            "small",
            "test_given_logger_is_used_unchanged",
        )
        log.setLevel(logging.INFO)
        log.debug("not published")
        log.info("large")
        assert (await peer.logged())["msg"] == "large"
        assert log.handlers[0] is own and len(log.handlers) == 2
    assert log.handlers == [own]
    log.removeHandler(own)
    assert capsys.readouterr() == ("", "")


async def test_given_logger_is_unchanged_if_the_node_cannot_start(
    hub: ScriptedHub,
) -> None:
    log = logging.Logger("mine")
    hub.refusal = HTTPStatus.FORBIDDEN, "no"
    with pytest.raises(fibws.HubUnreachable):
        async with fibws.Node("talker", hub=hub.url, log=log):
            pass
    assert log.handlers == []


def test_given_logger_is_unchanged_if_the_node_is_never_entered() -> None:
    log = logging.Logger("mine")
    fibws.Node("talker", log=log)
    assert log.handlers == []


@pytest.mark.parametrize("log", [None, logging.Logger("mine")], ids=["its own", "given"])
async def test_line_logged_before_the_connection_is_sent(
    hub: ScriptedHub, log: logging.Logger | None
) -> None:
    hub.refusal = HTTPStatus.SERVICE_UNAVAILABLE, "not yet"
    node = fibws.Node("talker", hub=hub.url, log=log)
    entering = asyncio.create_task(node.__aenter__())
    await hub.attempted(1)
    hub.refusal = None
    peer = await hub.peer()
    assert (await peer.logged())["msg"].startswith("The hub at ")
    await entering
    await node.__aexit__()


async def test_rosout_can_be_disabled(hub: ScriptedHub, capsys: pytest.CaptureFixture[str]) -> None:
    async with fibws.Node("talker", hub=hub.url, rosout=False) as node:
        peer = await hub.peer()
        node.log.info("only here")
        await node.advertise("numbers", Int32)
        topics: list[str | None] = []
        while topics[-1:] != ["/numbers"]:
            topics.append((await peer.receive()).get("topic"))
    assert "/rosout" not in topics
    assert "only here" in capsys.readouterr().out
    with pytest.raises(RuntimeError, match="a node can be entered only once"):
        await node.__aenter__()
