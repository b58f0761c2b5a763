"""Requests of other hubs at their limit."""

from __future__ import annotations

from typing import cast

import pytest

from fibws.hub.federation import calls
from fibws.hub.federation.backplane import Backplane, Peer
from fibws.hub.federation.calls import RemoteCalls
from fibws.hub.federation.records import HubInfo, Reply, Request

from ..fakes import FIBONACCI, FakeHub

ORDER_5 = bytes([5, 0, 0, 0])


def test_goal_is_cancelled_while_as_many_requests_wait_as_may(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(calls, "MOST_REQUESTS", 2)
    hub = FakeHub()
    server = hub.client("/server")
    server.send("advertise_action", action="/fibonacci", type=FIBONACCI)
    handler = RemoteCalls(hub.graph, hub.clock, 0)
    peer = Peer(HubInfo(id="a" * 16, name="a"), cast(Backplane, None))
    replies: list[Reply] = []

    def send(op: str, **fields: str) -> None:
        request = Request(op, fields, ORDER_5 if op == "goal" else b"")
        handler.handle(peer, request, "/link", replies.append)

    for goal in ("one", "two", "three"):
        send("goal", action="/fibonacci", goal=goal)
    assert [each.fields["code"] for each in replies] == ["limit"]
    sent = server.receive()
    send("cancel_goal", goal="two")
    assert server.receive_one("cancel_action_goal")["id"] == sent[1]["id"]
    assert "error" not in replies[-1].fields
