"""Nodes are pinged and killed by their connections."""

from __future__ import annotations

from typing import Any

import pytest

from fibws.hub.rosapi.rosnode import PATIENCE
from fibws.protocol.closing import KILLED

from ..fakes import INT32, Client
from .asking import Asking, Connection


class Pinging(Asking):
    """A hub of a connected talker, and who asks it for pongs."""

    def __init__(self) -> None:
        super().__init__(service_timeout=0)  # Else callers have timers of their own.
        self.talker = self.connects("/talker")
        self.hub.clock.advance(1)
        self.graph.now = lambda: round(self.hub.clock.time() * 1e9)

    def pings(self, node: str = "/talker", client: Client | None = None) -> None:
        asks(client or self.client, "ping_node", node)

    def hears(self) -> dict[str, Any]:
        """The one answer that has come."""
        response = self.hears_of("/rosapi/ping_node")
        assert response["result"], response
        values: dict[str, Any] = response["values"]
        assert self.graph.services["/rosapi/ping_node"].type.response(values) == values
        return values

    def hears_nothing(self) -> bool:
        return self.client.hears() == []

    @property
    def forgotten(self) -> bool:
        """Whether nothing of a ping is left."""
        provider: Any = self.graph.services["/rosapi/ping_node"].provider
        pings = self.own._rosnode._pings
        return not provider._later and not pings and not self.hub.clock.timers


def asks(client: Client, service: str, node: str) -> None:
    client.says("call_service", service=f"/rosapi/{service}", args={"node": node})


def pong(asking: Asking, connection: Connection, number: int = -1) -> None:
    asking.own.ponged(connection, connection.pings[number])


@pytest.fixture
def pinging() -> Pinging:
    return Pinging()


# Pings.


@pytest.mark.parametrize("spelling", ["/talker", "talker"])
def test_a_ping_is_answered_when_the_pong_is_back(pinging: Pinging, spelling: str) -> None:
    pinging.pings(spelling)
    pinging.hub.clock.advance(0.25)
    assert pinging.hears_nothing()
    pong(pinging, pinging.talker)
    message = "/talker has answered"
    assert pinging.hears() == {"success": True, "message": message, "seconds": 0.25}
    assert pinging.forgotten


def test_a_clock_that_is_set_back_makes_no_pong_come_before_its_ping(pinging: Pinging) -> None:
    pinging.pings()
    pinging.graph.now = lambda: 0
    pong(pinging, pinging.talker)
    assert pinging.hears()["seconds"] == 0


def test_the_hubs_own_nodes_answer_at_once(pinging: Pinging) -> None:
    answer = pinging.gets("/rosapi/ping_node", node="/rosout")
    assert answer == {"success": True, "message": "/rosout is the hub's own", "seconds": 0.0}


@pytest.mark.parametrize("node", ["/nobody", "", "no name", "~"])
def test_who_is_not_there_is_named(pinging: Pinging, node: str) -> None:
    for service in ("/rosapi/ping_node", "/rosapi/kill_node"):
        answer = pinging.gets(service, node=node)
        assert not answer["success"]
        assert node.strip("~") in answer["message"]
        assert "does not exist" in answer["message"]


def test_a_name_without_end_is_not_repeated_to_the_end(pinging: Pinging) -> None:
    answer = pinging.gets("/rosapi/ping_node", node=f"/{'x' * 10_000}")
    assert len(answer["message"]) < 1100


def test_who_does_not_answer_is_waited_for_no_longer_than_three_seconds(
    pinging: Pinging, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("fibws.hub.rosapi.rosnode.PATIENCE", PATIENCE)
    pinging.pings()
    pinging.hub.clock.advance(PATIENCE - 0.01)
    assert pinging.hears_nothing()
    pinging.hub.clock.advance(0.02)
    message = "/talker did not answer within 3 s"
    assert pinging.hears() == {"success": False, "message": message, "seconds": 0.0}
    assert pinging.forgotten
    pong(pinging, pinging.talker)
    assert pinging.hears_nothing()


def test_who_leaves_answers_no_more(pinging: Pinging) -> None:
    pinging.pings()
    pinging.own.disconnected(pinging.talker)
    assert pinging.hears() == {"success": False, "message": "/talker has left", "seconds": 0.0}
    assert pinging.forgotten


def test_others_that_leave_change_nothing(pinging: Pinging) -> None:
    other = pinging.connects("/other")
    pinging.pings()
    pinging.own.disconnected(other)
    assert pinging.hears_nothing()
    pong(pinging, pinging.talker)
    assert pinging.hears()["success"]


def test_nothing_is_kept_for_a_caller_that_leaves(pinging: Pinging) -> None:
    pinging.pings()
    pinging.client.leaves()
    assert pinging.forgotten
    pong(pinging, pinging.talker)
    assert pinging.hears_nothing()


def test_a_caller_may_be_less_patient(pinging: Pinging) -> None:
    pinging.client.says(
        "call_service", service="/rosapi/ping_node", args={"node": "/talker"}, timeout=1
    )
    pinging.hub.clock.advance(1)
    assert not pinging.hears_of("/rosapi/ping_node")["result"]
    assert pinging.forgotten


def test_a_pong_is_its_own_pings_alone(pinging: Pinging) -> None:
    other = pinging.connects("/other")
    pinging.pings()
    pinging.pings("/other")
    for client, data in ((pinging.talker, b""), (pinging.talker, bytes(8)), (other, b"x")):
        pinging.own.ponged(client, data)
    pinging.own.ponged(other, pinging.talker.pings[0])
    assert pinging.hears_nothing()
    pong(pinging, pinging.talker)
    assert pinging.hears()["success"]


def test_several_may_ping_at_once(pinging: Pinging) -> None:
    second = pinging.joins("/second")
    pinging.pings()
    pinging.hub.clock.advance(1)
    pinging.pings(client=second)
    assert len(set(pinging.talker.pings)) == 2
    pong(pinging, pinging.talker, 0)
    assert pinging.hears()["seconds"] == 1
    assert second.hears() == []
    pinging.hub.clock.advance(0.5)
    pong(pinging, pinging.talker, 1)
    assert second.hears_one("service_response")["values"]["seconds"] == 0.5
    assert pinging.forgotten


def test_a_pong_may_stand_for_the_pings_before(pinging: Pinging) -> None:
    pinging.pings()
    pinging.pings()
    pinging.pings()
    pong(pinging, pinging.talker, 1)
    assert len(pinging.client.hears()) == 2
    pong(pinging, pinging.talker, 2)
    assert pinging.hears()["success"]
    assert pinging.forgotten


def test_a_slow_client_is_not_pinged(pinging: Pinging) -> None:
    pinging.talker.outbox.pause()
    answer = pinging.gets("/rosapi/ping_node", node="/talker")
    assert not answer["success"]
    assert "/talker reads too slowly" in answer["message"]
    assert pinging.talker.pings == []


def test_when_the_hub_closes_nobody_waits(pinging: Pinging) -> None:
    pinging.pings()
    pinging.own.close()
    response = pinging.hears_of("/rosapi/ping_node")
    assert response["values"]["message"] == "the hub is shutting down"
    assert pinging.hub.clock.timers == 0
    pinging.client.leaves()


# Kills.


def test_a_node_is_killed_with_a_reason(pinging: Pinging) -> None:
    pinging.talker.client.says("advertise", "/fib", type=INT32)
    answer = pinging.gets("/rosapi/kill_node", node="talker")
    assert answer == {"success": True, "message": "killed /talker"}
    pinging.hub.clock.advance(0)
    assert pinging.talker.closings == [KILLED]
    assert "/talker" not in pinging.graph.nodes
    assert "/fib" not in pinging.graph.topics
    assert not pinging.gets("/rosapi/kill_node", node="/talker")["success"]


@pytest.mark.parametrize("node", ["/rosapi", "/rosout", "/rosbridge_websocket"])
def test_the_hubs_own_nodes_cannot_be_killed(pinging: Pinging, node: str) -> None:
    answer = pinging.gets("/rosapi/kill_node", node=node)
    assert not answer["success"]
    assert answer["message"] == f"{node} is the hub's own, which ends with the hub alone"
    assert node in pinging.graph.nodes


def test_a_node_may_kill_itself_and_what_it_says_after_that_does_not_outlive_it(
    pinging: Pinging,
) -> None:
    client = pinging.talker.client
    kill = '{"op":"call_service","service":"/rosapi/kill_node","args":{"node":"/talker"}}'
    client.says_text(kill + '{"op":"advertise","topic":"/fib","type":"std_msgs/Int32"}')
    assert client.hears_one("service_response")["values"]["success"]
    pinging.hub.clock.advance(0)
    assert pinging.talker.closings == [KILLED]
    assert "/fib" not in pinging.graph.topics
    assert client.forgotten


def test_only_the_newest_of_a_name_is_killed(pinging: Pinging) -> None:
    newer = pinging.connects("/talker")
    assert pinging.gets("/rosapi/kill_node", node="/talker")["success"]
    pinging.hub.clock.advance(0)
    assert (pinging.talker.closings, newer.closings) == ([], [KILLED])
