"""ping_node and kill_node: nodes are pinged and killed through their connections."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest

from fibws.hub.graph.nodes import DistantNode
from fibws.hub.rosapi.rosnode import PATIENCE
from fibws.protocol.websocket import KILLED

from ..fakes import INT32, Client
from .rosapi_client import Connection, RosapiClient


class Pinger(RosapiClient):
    """A client that pings nodes; /talker is connected, too."""

    def __init__(self) -> None:
        super().__init__(service_timeout=0)  # Otherwise calls have timers of their own.
        self.talker = self.connect("/talker")
        self.hub.clock.advance(1)
        self.graph.now = lambda: round(self.hub.clock.time() * 1e9)

    def ping(self, node: str = "/talker", client: Client | None = None) -> None:
        (client or self.client).send(
            "call_service", service="/rosapi/ping_node", args={"node": node}
        )

    def result(self) -> dict[str, Any]:
        """Return the one response that has come."""
        response = self.response_to("/rosapi/ping_node")
        assert response["result"], response
        values: dict[str, Any] = response["values"]
        assert self.graph.services["/rosapi/ping_node"].type.response(values) == values
        return values

    def is_waiting(self) -> bool:
        """Whether no response has come."""
        return self.client.receive() == []

    @property
    def forgotten(self) -> bool:
        """Whether nothing is kept of a ping."""
        server: Any = self.graph.services["/rosapi/ping_node"].server
        pings = self.own._rosnode._pings
        return not server._deferred and not pings and not self.hub.clock.timers


def pong(rosapi: RosapiClient, connection: Connection, number: int = -1) -> None:
    rosapi.own.ponged(connection, connection.pings[number])


@pytest.fixture
def pinger() -> Pinger:
    return Pinger()


# Pings.


@pytest.mark.parametrize("spelling", ["/talker", "talker"])
def test_ping_succeeds_when_the_pong_arrives(pinger: Pinger, spelling: str) -> None:
    pinger.ping(spelling)
    pinger.hub.clock.advance(0.25)
    assert pinger.is_waiting()
    pong(pinger, pinger.talker)
    message = "/talker has answered"
    assert pinger.result() == {"success": True, "message": message, "seconds": 0.25}
    assert pinger.forgotten


def test_ping_takes_zero_seconds_when_the_clock_is_set_back(pinger: Pinger) -> None:
    pinger.ping()
    pinger.graph.now = lambda: 0
    pong(pinger, pinger.talker)
    assert pinger.result()["seconds"] == 0


def test_ping_of_the_hubs_own_node_succeeds_at_once(pinger: Pinger) -> None:
    response = pinger.call("/rosapi/ping_node", node="/rosout")
    assert response == {"success": True, "message": "/rosout is the hub's own", "seconds": 0.0}


@pytest.mark.parametrize("node", ["/nobody", "", "not a name", "~"])
def test_unknown_node_is_named_in_the_response(pinger: Pinger, node: str) -> None:
    for service in ("/rosapi/ping_node", "/rosapi/kill_node"):
        response = pinger.call(service, node=node)
        assert not response["success"]
        assert node.strip("~") in response["message"]
        assert "does not exist" in response["message"]


def test_very_long_name_is_shortened_in_the_response(pinger: Pinger) -> None:
    response = pinger.call("/rosapi/ping_node", node=f"/{'x' * 10_000}")
    assert len(response["message"]) < 1100


def test_ping_fails_after_three_seconds_without_a_pong(
    pinger: Pinger, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("fibws.hub.rosapi.rosnode.PATIENCE", PATIENCE)
    pinger.ping()
    pinger.hub.clock.advance(PATIENCE - 0.01)
    assert pinger.is_waiting()
    pinger.hub.clock.advance(0.02)
    message = "/talker did not answer within 3 s"
    assert pinger.result() == {"success": False, "message": message, "seconds": 0.0}
    assert pinger.forgotten
    pong(pinger, pinger.talker)
    assert pinger.is_waiting()


def test_ping_fails_when_the_node_leaves(pinger: Pinger) -> None:
    pinger.ping()
    pinger.own.disconnected(pinger.talker)
    assert pinger.result() == {"success": False, "message": "/talker has left", "seconds": 0.0}
    assert pinger.forgotten


def test_other_nodes_that_leave_do_not_affect_a_ping(pinger: Pinger) -> None:
    other = pinger.connect("/other")
    pinger.ping()
    pinger.own.disconnected(other)
    assert pinger.is_waiting()
    pong(pinger, pinger.talker)
    assert pinger.result()["success"]


def test_nothing_is_kept_for_a_caller_that_leaves(pinger: Pinger) -> None:
    pinger.ping()
    pinger.client.disconnect()
    assert pinger.forgotten
    pong(pinger, pinger.talker)
    assert pinger.is_waiting()


def test_caller_may_set_a_shorter_timeout(pinger: Pinger) -> None:
    pinger.client.send(
        "call_service", service="/rosapi/ping_node", args={"node": "/talker"}, timeout=1
    )
    pinger.hub.clock.advance(1)
    assert not pinger.response_to("/rosapi/ping_node")["result"]
    assert pinger.forgotten


def test_pong_answers_only_its_own_ping(pinger: Pinger) -> None:
    other = pinger.connect("/other")
    pinger.ping()
    pinger.ping("/other")
    for client, data in ((pinger.talker, b""), (pinger.talker, bytes(8)), (other, b"x")):
        pinger.own.ponged(client, data)
    pinger.own.ponged(other, pinger.talker.pings[0])
    assert pinger.is_waiting()
    pong(pinger, pinger.talker)
    assert pinger.result()["success"]


def test_several_callers_may_ping_at_once(pinger: Pinger) -> None:
    second = pinger.add_client("/second")
    pinger.ping()
    pinger.hub.clock.advance(1)
    pinger.ping(client=second)
    assert len(set(pinger.talker.pings)) == 2
    pong(pinger, pinger.talker, 0)
    assert pinger.result()["seconds"] == 1
    assert second.receive() == []
    pinger.hub.clock.advance(0.5)
    pong(pinger, pinger.talker, 1)
    assert second.receive_one("service_response")["values"]["seconds"] == 0.5
    assert pinger.forgotten


def test_pong_answers_earlier_pings_too(pinger: Pinger) -> None:
    pinger.ping()
    pinger.ping()
    pinger.ping()
    pong(pinger, pinger.talker, 1)
    assert len(pinger.client.receive()) == 2
    pong(pinger, pinger.talker, 2)
    assert pinger.result()["success"]
    assert pinger.forgotten


def test_slow_client_is_not_pinged(pinger: Pinger) -> None:
    pinger.talker.queue.pause()
    response = pinger.call("/rosapi/ping_node", node="/talker")
    assert not response["success"]
    assert "/talker reads too slowly" in response["message"]
    assert pinger.talker.pings == []


def test_ping_fails_when_the_hub_closes(pinger: Pinger) -> None:
    pinger.ping()
    pinger.own.close()
    response = pinger.response_to("/rosapi/ping_node")
    assert response["values"]["message"] == "the hub is shutting down"
    assert pinger.hub.clock.timers == 0
    pinger.client.disconnect()


# Kills.


def test_node_is_killed_with_a_close_reason(pinger: Pinger) -> None:
    pinger.talker.client.send("advertise", "/fib", type=INT32)
    response = pinger.call("/rosapi/kill_node", node="talker")
    assert response == {"success": True, "message": "killed /talker"}
    pinger.hub.clock.advance(0)
    assert pinger.talker.closings == [KILLED]
    assert "/talker" not in pinger.graph.nodes
    assert "/fib" not in pinger.graph.topics
    assert not pinger.call("/rosapi/kill_node", node="/talker")["success"]


@pytest.mark.parametrize("node", ["/rosapi", "/rosout", "/rosbridge_websocket"])
def test_hubs_own_nodes_cannot_be_killed(pinger: Pinger, node: str) -> None:
    response = pinger.call("/rosapi/kill_node", node=node)
    assert not response["success"]
    assert response["message"] == f"{node} is the hub's own, which ends with the hub alone"
    assert node in pinger.graph.nodes


def test_node_that_kills_itself_leaves_nothing_behind(
    pinger: Pinger,
) -> None:
    client = pinger.talker.client
    kill = '{"op":"call_service","service":"/rosapi/kill_node","args":{"node":"/talker"}}'
    client.send_text(kill + '{"op":"advertise","topic":"/fib","type":"std_msgs/Int32"}')
    assert client.receive_one("service_response")["values"]["success"]
    pinger.hub.clock.advance(0)
    assert pinger.talker.closings == [KILLED]
    assert "/fib" not in pinger.graph.topics
    assert client.forgotten


def test_only_the_newest_node_of_a_name_is_killed(pinger: Pinger) -> None:
    newer = pinger.connect("/talker")
    assert pinger.call("/rosapi/kill_node", node="/talker")["success"]
    pinger.hub.clock.advance(0)
    assert (pinger.talker.closings, newer.closings) == ([], [KILLED])


# Nodes that are not connected to this hub.


class Answering(DistantNode):
    """A node that answers before it is known how to cancel the question, as over a full link."""

    since = 0

    def __init__(self, fault: str) -> None:
        self._fault = fault

    def ping(self, done: Callable[[str], object]) -> Callable[[], object]:
        done(self._fault)
        return lambda: None

    def shut_down(self, reason: str, done: Callable[[str], object]) -> Callable[[], object]:
        return self.ping(done)

    def replaced(self) -> None:
        raise AssertionError("nobody takes its name")

    def publishing(self) -> list[str]:
        return []

    subscribing = providing = publishing


@pytest.mark.parametrize("fault", ["", "too much waits for hub cloud"])
@pytest.mark.parametrize("verb", ["ping", "kill"])
def test_distant_node_may_answer_at_once(pinger: Pinger, verb: str, fault: str) -> None:
    pinger.graph.enter(Answering(fault), "/distant")
    response = pinger.call(f"/rosapi/{verb}_node", node="/distant")
    assert response["success"] is not bool(fault)
    assert fault in response["message"]
    assert pinger.forgotten
