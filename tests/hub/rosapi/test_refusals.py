"""Refused operations of clients on /rosout."""

from __future__ import annotations

from typing import Any

import pytest

from fibws.hub.graph.topic import Source
from fibws.hub.log.text import MAX_CLIENT_LINES, MAX_LINES, MAX_TEXTS, REPEAT_AFTER

from ..fakes import NANOSECONDS, Client
from .rosapi_client import RosapiClient


@pytest.fixture
def rosapi() -> RosapiClient:
    return RosapiClient()


@pytest.fixture
def console(rosapi: RosapiClient) -> Client:
    client = rosapi.add_client("/console")
    client.send("subscribe", "/rosout_agg")
    return client


def lines(console: Client) -> list[dict[str, Any]]:
    return console.receive_messages("/rosout_agg")


def texts(console: Client) -> list[str]:
    return [line["msg"] for line in lines(console)]


def test_refused_message_is_logged_with_its_publisher_and_the_reason(
    rosapi: RosapiClient, console: Client
) -> None:
    page = rosapi.add_client("/page")
    page.send("advertise", "/number", type="std_msgs/Int32")
    page.send("publish", "/number", msg={"data": "eight"})
    [line] = lines(console)
    assert line["name"] == "/rosbridge_websocket"
    assert line["level"] == 4
    assert line["header"]["stamp"]["secs"] == NANOSECONDS // 10**9
    assert line["msg"] == f"/page: {page.receive_one('status')['msg']}"


def test_client_that_wants_no_statuses_is_logged_too(rosapi: RosapiClient, console: Client) -> None:
    page = rosapi.add_client("/page")
    page.send("set_level", level="none")
    page.send("nonsense")
    assert page.receive() == []
    assert len(texts(console)) == 1


def test_lost_service_is_logged(rosapi: RosapiClient, console: Client) -> None:
    for node in ("/old", "/new"):
        client = rosapi.add_client(node)
        client.send("advertise_service", service="/add", type="rospy_tutorials/AddTwoInts")
    [text] = texts(console)
    assert text.startswith("/old: ")
    assert text.endswith("/new")


def test_repetitions_are_counted_instead_of_repeated(rosapi: RosapiClient, console: Client) -> None:
    report = rosapi.own.refusals.report
    for _ in range(50):
        report("/page", "no")
    report("/other", "no")
    assert texts(console) == ["/page: no", "/other: no"]
    rosapi.hub.clock.advance(REPEAT_AFTER)
    report("/page", "no")
    report("/other", "no")
    assert texts(console) == ["/page: no (49 more since the last line)", "/other: no"]


def test_lines_of_one_client_and_of_all_are_bounded(rosapi: RosapiClient, console: Client) -> None:
    report = rosapi.own.refusals.report
    for node in range(100):
        for number in range(100):
            report(f"/node{node}", f"no {number}")
    found = texts(console)
    assert len(found) == MAX_LINES
    assert sum(text.startswith("/node0:") for text in found) == MAX_CLIENT_LINES
    rosapi.hub.clock.advance(1)
    report("/node0", "later")
    assert texts(console) == ["/node0: later"]


def test_remembered_texts_are_bounded(rosapi: RosapiClient) -> None:
    for number in range(2 * MAX_TEXTS):
        rosapi.own.refusals.report("/page", f"no {number}")
        rosapi.hub.clock.advance(1)
    assert len(rosapi.own.refusals._limit._texts) == MAX_TEXTS


def test_terminal_codes_of_clients_are_escaped(rosapi: RosapiClient, console: Client) -> None:
    rosapi.own.refusals.report("/page", "\x1b[31mno\n")
    assert texts(console) == ["/page: \\x1b[31mno"]


def test_refusal_of_the_log_itself_does_not_repeat(rosapi: RosapiClient) -> None:
    raw = rosapi.add_client("/raw")
    raw.send("subscribe", "/rosout", type="rosgraph_msgs/Log")
    raw.send("advertise", "/rosout", type="rosgraph_msgs/Log")
    raw.send("publish", "/rosout", msg={"level": "high"})
    received = raw.receive()
    assert [each["op"] for each in received].count("publish") == 1


def test_fault_in_the_log_does_not_keep_the_client_from_its_status(
    rosapi: RosapiClient, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    def fail(*_: Any) -> None:
        raise ZeroDivisionError("injected")

    page = rosapi.add_client("/page")
    monkeypatch.setattr(Source, "publish", fail)
    page.send("nonsense")
    assert page.receive_one("status")["level"] == "error"
    assert "injected" in caplog.text
