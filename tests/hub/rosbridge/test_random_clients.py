"""Random clients that do random things with each other, with few names and few ids."""

from __future__ import annotations

from typing import Any

from hypothesis import settings
from hypothesis import strategies as st
from hypothesis.stateful import (
    Bundle,
    RuleBasedStateMachine,
    consumes,
    invariant,
    multiple,
    rule,
)
from random_inputs import times

from ..fakes import STANDARD, Client, FakeHub
from .client_group import ClientGroup

LIMITS = {"max_calls": 5, "max_goals": 5, "max_advertisements": 2, "max_queued_bytes": 3000}
NODES = st.sampled_from(["/a", "/b", "/c", None])
NAMES = st.sampled_from(["/x", "x", "~x", "/a/x", "no name", "/x#5"])
IDS = st.sampled_from([None, "x", 1, "1", ""])
VALUES = st.sampled_from([{}, {"sum": 1}, {"sequence": [1]}, {"sum": "one"}, "no", None, [1]])
TIMEOUTS = st.sampled_from([None, 0, 0.5, 2, 30])
OTHER = st.sampled_from(
    ['{"op":"fly"}', "no JSON", '{"op":"set_level","level":"info"}', '{"op":"call_service"}']
)
"""Operations of neither services nor actions."""


class RandomClients(RuleBasedStateMachine):
    """No exception leaves a session, and `ClientGroup` finds one answer to everything."""

    clients: Bundle[Client] = Bundle("clients")
    requests: Bundle[tuple[Client, dict[str, Any]]] = Bundle("requests")

    def __init__(self) -> None:
        super().__init__()
        self.hub = FakeHub(policy=None, clock=None, interfaces=STANDARD, workers=None, **LIMITS)
        self.group = ClientGroup(self.hub)

    @rule(target=clients, node=NODES)
    def client_connects(self, node: str | None) -> Client:
        return self.group.connect(node)

    @rule(client=consumes(clients))
    def client_disconnects(self, client: Client) -> None:
        self.group.disconnect(client)

    @rule(client=clients, name=NAMES)
    def client_advertises_a_service(self, client: Client, name: str) -> None:
        self.group.advertise_service(client, name)

    @rule(client=clients, name=NAMES)
    def client_unadvertises_a_service(self, client: Client, name: str) -> None:
        self.group.send(client, "unadvertise_service", service=name)

    @rule(client=clients, name=NAMES, id_=IDS, timeout=TIMEOUTS)
    def client_calls(self, client: Client, name: str, id_: object, timeout: object) -> None:
        if "#" in name and id_ is None:
            id_ = name.partition("#")[2]
            self.group.call(client, name, id_)
        else:
            self.group.call(client, name, id_, timeout=timeout)

    @rule(client=clients, name=NAMES)
    def client_advertises_an_action(self, client: Client, name: str) -> None:
        self.group.advertise_action(client, name)

    @rule(client=clients, name=NAMES)
    def client_unadvertises_an_action(self, client: Client, name: str) -> None:
        self.group.send(client, "unadvertise_action", action=name)

    @rule(client=clients, name=NAMES, id_=IDS, feedback=st.booleans())
    def client_sends_a_goal(self, client: Client, name: str, id_: object, feedback: bool) -> None:
        self.group.send_goal(client, name, id_, feedback=feedback)

    @rule(client=clients, name=NAMES, id_=IDS)
    def client_cancels(self, client: Client, name: str, id_: object) -> None:
        self.group.send(client, "cancel_action_goal", action=name, id=id_)

    @rule(client=clients, id_=IDS)
    def client_cancels_all(self, client: Client, id_: object) -> None:
        self.group.call(client, "/x/_action/cancel_goal", id_)

    @rule(target=requests, client=clients)
    def client_reads_its_requests(self, client: Client) -> Any:
        return multiple(*((client, each) for each in self.group.due[client]))

    @rule(request=requests, values=VALUES, result=st.booleans())
    def client_responds(
        self, request: tuple[Client, dict[str, Any]], values: object, result: bool
    ) -> None:
        client, operation = request
        self.group.respond(client, operation, values=values, result=result)

    @rule(client=clients, request=requests)
    def client_responds_for_another(
        self, client: Client, request: tuple[Client, dict[str, Any]]
    ) -> None:
        self.group.respond(client, request[1], values={})

    @rule(client=clients, name=NAMES, values=VALUES)
    def client_responds_without_an_id(self, client: Client, name: str, values: object) -> None:
        self.group.send(client, "service_response", service=name, values=values, result=True)

    @rule(request=requests)
    def client_sends_feedback(self, request: tuple[Client, dict[str, Any]]) -> None:
        self.group.send_feedback(*request)

    @rule(client=clients, text=OTHER)
    def client_sends_another_operation(self, client: Client, text: str) -> None:
        if client in self.group.present:
            client.send_text(text)
        self.group.receive_all()

    @rule(seconds=st.sampled_from([0.5, 3, 61]))
    def time_passes(self, seconds: float) -> None:
        self.group.advance(seconds)

    @rule(client=clients)
    def client_stops_reading(self, client: Client) -> None:
        client.queue.pause()

    @rule(client=clients)
    def client_resumes_reading(self, client: Client) -> None:
        if client in self.group.present:
            client.queue.resume()
        self.group.receive_all()

    @invariant()
    def graph_contains_only_connected_clients(self) -> None:
        present = {client.session.node for client in self.group.present}
        graph = self.hub.graph
        assert graph.nodes.keys() == present
        assert {each.node for each in graph.services.values()} <= present
        assert {each.node for each in graph.actions.values()} <= present
        assert self.hub.clock.timers <= len(present)

    @invariant()
    def each_pending_request_has_a_server(self) -> None:
        sessions = [client.session for client in self.group.present]
        calls = {call for each in sessions for call in each.calls._waiting}
        due = {call for each in sessions for call in each.services._calls.values()}
        assert calls == due
        sent = {goal for each in sessions for goal in each.goals._sent}
        pursued = {goal for each in sessions for goal, _ in each.actions._goals.values()}
        assert sent == pursued
        by_id = {goal for each in sessions for goal in each.goals._by_id.values()}
        assert by_id <= sent
        assert all(goal.action.goals[goal.uuid] is goal for goal in sent)

    def teardown(self) -> None:
        self.group.end()


RandomClients.TestCase.settings = settings(max_examples=times(0.5), stateful_step_count=40)
TestRandomClients = RandomClients.TestCase
