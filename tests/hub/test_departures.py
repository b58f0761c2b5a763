"""What a client leaves behind, or may not do any more, is removed in turns.

To others it is as if it were gone at once.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any
from unittest.mock import Mock

import pytest

from fibws.access.rights import Principal, Rights
from fibws.hub.access.policy import AccessPolicy
from fibws.hub.errors import NotAllowed
from fibws.hub.server import _login_checks
from fibws.hub.websocket.endpoint import Endpoint, Work
from fibws.hub.websocket.turns import Turns
from fibws.protocol.websocket import REPLACED, RESTART

from .fakes import ADD, FIBONACCI, INT32, STRING, Client, finish, number
from .foxglove.foxglove_client import FoxgloveClient, FoxgloveHub
from .work_clock import WorkClock

FEW, MANY = 10, 100
LIMIT = 1.2
"""How many times as much work there may be between two looks at the clock when a client leaves
ten times as many things."""
WATCHERS = 40


def rosbridge(op: str, **fields: Any) -> Callable[[FoxgloveHub, int], Endpoint]:
    """Return what makes a client that performs an operation many times, and has a server."""

    def make(hub: FoxgloveHub, count: int) -> Endpoint:
        serve(hub.client("/server"))
        client = hub.client("/robot", serialized=True)
        key = {"call_service": "args", "send_action_goal": "id"}.get(op)
        for each in range(count):
            name = {"id": f"goal_{each}"} if key else names(op, f"/name_{each}")
            client.send(op, **{**fields, **name})
        return client.session

    return make


def names(op: str, name: str) -> dict[str, str]:
    kind = {"advertise_service": "service", "advertise_action": "action"}
    return {kind.get(op, "topic"): name}


def serve(server: Client) -> None:
    server.send("advertise_service", service="/service", type=ADD)
    server.send("advertise_action", action="/action", type=FIBONACCI)


def with_calls(hub: FoxgloveHub, count: int) -> Endpoint:
    """Return a server with calls and goals that it has not answered."""
    server, caller = hub.client("/robot"), hub.client("/caller")
    serve(server)
    for each in range(count):
        caller.send("call_service", service="/service", id=f"call_{each}", args={"a": 1, "b": 1})
        caller.send(
            *("send_action_goal", None),
            **{"action": "/action", "action_type": FIBONACCI, "id": f"goal_{each}"},
            args={"order": 1},
        )
    return server.session


def foxglove_channels(hub: FoxgloveHub, count: int) -> Endpoint:
    client = hub.foxglove_client("/robot")
    for each in range(count):
        client.advertise(f"/name_{each}", INT32, each)
    return client.session


def foxglove_subscriptions(hub: FoxgloveHub, count: int) -> Endpoint:
    talker, client = hub.client("/talker"), hub.foxglove_client("/robot")
    for each in range(count):
        talker.send("advertise", f"/name_{each}", type=INT32)
    while len(client.channels) < count:
        client.receive()
    for each in range(count):
        channel = client.channels[f"/name_{each}"]["id"]
        client.send("subscribe", subscriptions=[{"id": each, "channelId": channel}])
    return client.session


def foxglove_calls(hub: FoxgloveHub, count: int) -> Endpoint:
    serve(hub.client("/server"))
    client = hub.foxglove_client("/robot")
    client.receive()
    service = client.services["/service"]["id"]
    for each in range(count):
        client.call(service, bytes(16), each)
    return client.session


LEAVING: dict[str, Callable[[FoxgloveHub, int], Endpoint]] = {
    "publishers": rosbridge("advertise", type=INT32),
    "publishers that watch": rosbridge("advertise", type=INT32, peers=True),
    "subscribers": rosbridge("subscribe", type=INT32),
    "serialized subscribers": rosbridge("subscribe", type=INT32, compression="ros1", credit=9),
    "services": rosbridge("advertise_service", type=ADD),
    "actions": rosbridge("advertise_action", type=FIBONACCI),
    "calls": rosbridge("call_service", service="/service", args={"a": 1, "b": 1}),
    "goals": rosbridge(
        "send_action_goal", action="/action", action_type=FIBONACCI, args={"order": 1}
    ),
    "calls and goals to answer": with_calls,
    "Foxglove's publishers": foxglove_channels,
    "Foxglove's subscribers": foxglove_subscriptions,
    "Foxglove's calls": foxglove_calls,
}


ANYTHING = Rights({right: ["/**"] for right in ("publish", "subscribe", "call", "provide")})


class HubWithTokens(FoxgloveHub):
    """A hub whose clients have tokens, with all rights."""

    def __init__(self, **settings: Any) -> None:
        super().__init__(policy=AccessPolicy(), **settings)

    def client(self, node: str | None = None, **arguments: Any) -> Client:
        return super().client(node, principal=Principal("ann", ANYTHING), **arguments)

    def foxglove_client(self, node: str | None = None, **arguments: Any) -> FoxgloveClient:
        return super().foxglove_client(node, principal=Principal("ann", ANYTHING), **arguments)


class Iterations:
    """An event loop's iterations, by a clock that only work advances."""

    def __init__(self) -> None:
        self.clock = WorkClock()
        self.count = 0
        self._due: list[Callable[[], object]] = []
        self.turns = Turns(lambda delay, call: self._due.append(call), lambda: None, self.clock)

    def finish(self, begin: Callable[[], Work]) -> None:
        self.clock.measure(lambda: self.turns.finish(begin()))
        while self._due:
            self.count += 1
            due, self._due = self._due, []
            for call in due:
                self.clock.measure(call)


def watch(hub: FoxgloveHub, count: int) -> None:
    """Let clients of both protocols watch the graph, and the peers of the first topics."""
    for each in range(count):
        hub.foxglove_client(f"/viewer_{each}").send("subscribeConnectionGraph")
        peer = hub.client(f"/peer_{each}", serialized=True)
        for topic in range(FEW):
            peer.send("subscribe", f"/name_{topic}", peers=True)


def assert_one_by_one(
    kind: str, hub_class: type[FoxgloveHub], watchers: int, begin: Callable[[Endpoint], Work]
) -> None:
    longest = {}
    for count in (FEW, MANY):
        hub = hub_class(max_calls=10**6, max_goals=10**6)
        endpoint = LEAVING[kind](hub, count)
        watch(hub, watchers)
        hub.clock.turn()
        iterations = Iterations()
        iterations.finish(partial(begin, endpoint))
        assert iterations.count >= count
        longest[count] = iterations.clock.longest
    assert longest[MANY] <= LIMIT * longest[FEW], longest


@pytest.mark.parametrize("watchers", [0, WATCHERS])
@pytest.mark.parametrize("hub_class", [FoxgloveHub, HubWithTokens])
@pytest.mark.parametrize("kind", LEAVING)
def test_registrations_are_removed_one_by_one(
    kind: str, hub_class: type[FoxgloveHub], watchers: int
) -> None:
    assert_one_by_one(kind, hub_class, watchers, lambda endpoint: endpoint.leave())


@pytest.mark.parametrize("kind", LEAVING)
def test_registrations_are_withdrawn_one_by_one(kind: str) -> None:
    nobody = Principal("ann", Rights())
    assert_one_by_one(kind, HubWithTokens, 0, lambda endpoint: endpoint.authorize(nobody))


class Checked:
    """The connection of a client, whose login is checked after a reload."""

    name = "/client"

    def __init__(self, session: Endpoint, *, stays: bool = True, fails: bool = False) -> None:
        self.session = session
        self.stays, self.fails = stays, fails
        self.is_aborted = False

    def check_login(self, when: str) -> bool:
        if self.fails:
            raise ValueError("a fault of the hub's")
        finish(self.session.authorize(Principal("ann", Rights())))
        return self.stays

    def abort(self) -> None:
        self.is_aborted = True


def connections(hub: HubWithTokens, count: int, **arguments: bool) -> list[Any]:
    clients = [hub.client(f"/client_{each}") for each in range(count)]
    return [Checked(client.session, **arguments) for client in clients]


def test_logins_are_checked_one_by_one() -> None:
    longest, closed = {}, list[int]()
    for count in (FEW, MANY):
        found = connections(HubWithTokens(), count, stays=False)
        iterations = Iterations()
        iterations.finish(partial(_login_checks, found, "after a reload", closed.append))
        assert iterations.count >= count
        longest[count] = iterations.clock.longest
    assert longest[MANY] <= LIMIT * longest[FEW], longest
    assert closed == [FEW, MANY]


def test_login_that_cannot_be_checked_ends_that_client_alone() -> None:
    hub, closed = HubWithTokens(), list[int]()
    good, bad = hub.client("/good"), hub.client("/bad")
    found: list[Any] = [Checked(bad.session, fails=True), Checked(good.session)]
    finish(_login_checks(found, "after a reload", closed.append))
    assert [each.is_aborted for each in found] == [True, False]
    assert closed == [1]


def test_connection_is_closed_if_a_right_cannot_be_withdrawn(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    hub = HubWithTokens()
    client, viewer = hub.client("/robot"), hub.foxglove_client("/viewer")
    client.send("advertise", "/topic", type=INT32)
    viewer.advertise("/topic", INT32)
    monkeypatch.setattr(hub.graph.rights, "allows_source", Mock(side_effect=ValueError))
    for each in (client, viewer):
        with pytest.raises(ValueError):
            finish(each.session.authorize(Principal("ann", Rights())))
        assert each.closings == [RESTART]
    assert not hub.graph.topics


def test_one_that_fails_keeps_no_other_from_being_removed(
    monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    hub = FoxgloveHub()
    client = hub.client("/robot")
    for each in range(3):
        client.send("advertise", f"/name_{each}", type=INT32)
    remove = hub.graph.remove_source

    def fail_once(source: Any) -> None:
        remove(source)
        if source.topic.name == "/name_0":
            raise ValueError("a fault of the hub's")

    monkeypatch.setattr(hub.graph, "remove_source", fail_once)
    client.disconnect()
    assert not hub.graph.topics
    assert "could not be removed" in caplog.text


# Whoever comes before all is removed.


class Left:
    """A hub that a client has left, of whose registrations nothing is removed yet."""

    def __init__(self) -> None:
        self.hub = FoxgloveHub()
        robot = self.hub.client("/robot")
        robot.send("advertise", "/topic", type=INT32, latch=True)
        robot.send("publish", "/topic", msg=number(1))
        robot.send("subscribe", "/topic", type=INT32)
        serve(robot)
        self.rest = robot.session.leave()
        assert not self.hub.graph.nodes

    def client(self, node: str = "/robot") -> Client:
        return self.hub.client(node, serialized=True)

    def finish(self) -> None:
        finish(self.rest)


@pytest.fixture
def left() -> Left:
    return Left()


@pytest.mark.parametrize("node", ["/robot", "/other"])
def test_publisher_with_another_type_may_come_at_once(left: Left, node: str) -> None:
    newcomer, listener = left.client(node), left.client("/listener")
    newcomer.send("advertise", "/topic", type=STRING)
    left.finish()
    assert newcomer.receive() == []
    assert [*left.hub.graph.topics["/topic"].sources] == [node]
    listener.send("subscribe", "/topic")
    newcomer.send("publish", "/topic", msg={"data": "new"})
    assert listener.receive_messages("/topic") == [{"data": "new"}]


def test_subscriber_with_another_type_may_come_at_once(left: Left) -> None:
    newcomer, talker = left.client(), left.client("/talker")
    newcomer.send("subscribe", "/topic", type=STRING)
    left.finish()
    talker.send("advertise", "/topic", type=STRING)
    talker.send("publish", "/topic", msg={"data": "new"})
    assert newcomer.receive_messages("/topic") == [{"data": "new"}]
    assert talker.receive() == []


def test_watchers_see_a_node_that_comes_again_leave_first(left: Left) -> None:
    watcher = left.client("/watcher")
    watcher.send("subscribe", "/topic", peers=True)
    watcher.receive()
    newcomer = left.client()
    newcomer.send("advertise", "/topic", type=INT32)
    left.finish()
    assert [*left.hub.graph.topics["/topic"].sources] == ["/robot"]
    newcomer.send("publish", "/topic", msg=number(2))
    assert [each["msg"] for each in watcher.receive() if each["op"] == "publish"] == [number(2)]


def test_services_and_actions_may_be_taken_at_once(left: Left) -> None:
    newcomer, caller = left.client("/other"), left.client("/caller")
    serve(newcomer)
    left.finish()
    caller.send("call_service", service="/service", id="x", args={"a": 1, "b": 2})
    assert newcomer.receive_one("call_service")["args"] == {"a": 1, "b": 2}
    assert left.hub.graph.actions["/action"].node == "/other"


def test_services_and_actions_are_gone_at_once(left: Left) -> None:
    caller = left.client("/caller")
    caller.send("call_service", service="/service", id="x", args={"a": 1, "b": 2})
    assert caller.receive_one("service_response")["code"] == "unknown_service"
    goal: dict[str, Any] = {"action": "/action", "action_type": FIBONACCI, "args": {"order": 1}}
    caller.send("send_action_goal", None, id="y", **goal)
    assert caller.receive_one("action_result")["code"] == "unknown_action"
    left.finish()
    assert not (left.hub.graph.services or left.hub.graph.actions)


def test_a_replaced_client_leaves_in_turns() -> None:
    hub = FoxgloveHub()
    older = hub.client("/robot")
    older.send("advertise", "/topic", type=INT32)
    newer = hub.client("/robot")
    assert older.closings == [REPLACED]
    newer.send("advertise", "/topic", type=STRING)
    assert newer.receive() == []


@pytest.mark.parametrize("protocol", ["rosbridge", "foxglove"])
def test_a_replaced_client_takes_no_rights_from_the_newer_one(protocol: str) -> None:
    hub = HubWithTokens()
    older = hub.client("/robot") if protocol == "rosbridge" else hub.foxglove_client("/robot")
    newer = hub.client("/robot")
    older.session.revoke()  # Its token has expired.
    with pytest.raises(NotAllowed):
        older.session.authorize(Principal("eve", Rights()))
    finish(older.session.leave())
    newer.send("advertise", "/topic", type=STRING)
    assert newer.receive() == []
    assert hub.graph.nodes["/robot"] is newer.session


def test_the_last_client_of_a_name_loses_its_rights() -> None:
    hub = HubWithTokens()
    client = hub.client("/robot")
    client.session.revoke()
    client.send("advertise", "/topic", type=STRING)
    assert client.receive_one("status")["level"] == "error"
