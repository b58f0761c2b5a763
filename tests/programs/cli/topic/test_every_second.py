"""How the tools that measure go on."""

from __future__ import annotations

from types import SimpleNamespace
from typing import cast

import pytest

from fibws.cli.link import Link
from fibws.cli.topic import every_second
from fibws.errors import OperationRejected

from ..conftest import HubThread, Publish


def test_messages_are_given_as_text(
    hub: HubThread, publish: Publish, capsys: pytest.CaptureFixture[str]
) -> None:
    publish("/number", "std_msgs/Int32", {"data": 8})
    heard: list[bytes] = []
    with Link("ear", hub.url) as ear:
        every_second.hear(ear, "/number", heard.append)
        assert capsys.readouterr().out == "subscribed to [/number]\n"
        shown: list[list[bytes]] = []
        every_second.report(ear, lambda: shown.append(list(heard)), 2)
    assert shown == [[b'{"data":8}'], [b'{"data":8}']]


def test_a_refusal_ends_it(hub: HubThread) -> None:
    with Link("ear", hub.url) as ear, pytest.raises(OperationRejected):
        ear.send({"op": "subscribe", "topic": "/rosout", "type": "std_msgs/Int32"})
        every_second.report(ear, lambda: None)


def test_what_was_missed_while_it_stood_still_is_not_made_up_for(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    now = 0.0
    stops = iter([8.25])
    shown: list[float] = []

    def heed(seconds: float) -> None:
        nonlocal now
        now += next(stops, seconds)

    monkeypatch.setattr(every_second, "time", SimpleNamespace(monotonic=lambda: now))
    link = cast(Link, SimpleNamespace(heed=heed))
    every_second.report(link, lambda: shown.append(now), 3)
    assert shown == [8.25, 9.25, 10.25]


def test_a_report_that_takes_its_time_does_not_put_off_the_next(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    now = 0.0
    shown: list[float] = []

    def heed(seconds: float) -> None:
        nonlocal now
        now += seconds

    def show() -> None:
        nonlocal now
        shown.append(now)
        now += 0.25

    monkeypatch.setattr(every_second, "time", SimpleNamespace(monotonic=lambda: now))
    every_second.report(cast(Link, SimpleNamespace(heed=heed)), show, 3)
    assert shown == [1.0, 2.0, 3.0]
