"""What the measuring tools share."""

from __future__ import annotations

from types import SimpleNamespace
from typing import cast

import pytest
from hub_in_thread import HubThread, Publish

from fibws.cli.topic import every_second
from fibws.client.hub_client import HubClient, RawMessage
from fibws.errors import OperationRejected


def test_messages_are_received_between_reports(
    hub: HubThread, publish: Publish, capsys: pytest.CaptureFixture[str]
) -> None:
    publish("/number", "std_msgs/Int32", {"data": 8})
    received: list[RawMessage] = []
    with HubClient("tool", hub.url) as tool:
        every_second.subscribe(tool, "/number", received.append)
        assert capsys.readouterr().out == "subscribed to [/number]\n"
        shown: list[list[RawMessage]] = []
        every_second.report(tool, lambda: shown.append(list(received)), 2)
    assert shown == [[RawMessage(b"\x08\0\0\0", "std_msgs/Int32")]] * 2


def test_nothing_is_printed_when_quiet(
    hub: HubThread, publish: Publish, capsys: pytest.CaptureFixture[str]
) -> None:
    publish("/number", "std_msgs/Int32")
    with HubClient("tool", hub.url) as tool:
        every_second.subscribe(tool, "/number", lambda message: None, quiet=True)
    assert capsys.readouterr().out == ""


def test_refused_operation_is_an_error(hub: HubThread) -> None:
    with HubClient("tool", hub.url) as tool, pytest.raises(OperationRejected):
        tool.send({"op": "subscribe", "topic": "/rosout", "type": "std_msgs/Int32"})
        every_second.report(tool, lambda: None)


def test_missed_reports_are_skipped(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    now = 0.0
    stops = iter([8.25])
    shown: list[float] = []

    def process(seconds: float) -> None:
        nonlocal now
        now += next(stops, seconds)

    monkeypatch.setattr(every_second, "time", SimpleNamespace(monotonic=lambda: now))
    client = cast(HubClient, SimpleNamespace(process=process))
    every_second.report(client, lambda: shown.append(now), 3)
    assert shown == [8.25, 9.25, 10.25]


def test_slow_report_does_not_delay_the_next(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    now = 0.0
    shown: list[float] = []

    def process(seconds: float) -> None:
        nonlocal now
        now += seconds

    def show() -> None:
        nonlocal now
        shown.append(now)
        now += 0.25

    monkeypatch.setattr(every_second, "time", SimpleNamespace(monotonic=lambda: now))
    every_second.report(cast(HubClient, SimpleNamespace(process=process)), show, 3)
    assert shown == [1.0, 2.0, 3.0]
