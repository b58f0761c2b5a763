"""How the tools that measure go on."""

from __future__ import annotations

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
