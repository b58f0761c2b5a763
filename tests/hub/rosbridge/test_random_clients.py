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

from ..fakes import Client, FakeHub
from .client_group import Company

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
    """No exception leaves a session, and `Company` finds one answer to everything."""

    clients: Bundle[Client] = Bundle("clients")
    asked: Bundle[tuple[Client, dict[str, Any]]] = Bundle("asked")

    def __init__(self) -> None:
        super().__init__()
        self.hub = FakeHub(policy=None, **LIMITS)
        self.company = Company(self.hub)

    @rule(target=clients, node=NODES)
    def somebody_enters(self, node: str | None) -> Client:
        return self.company.enters(node)

    @rule(client=consumes(clients))
    def somebody_leaves(self, client: Client) -> None:
        self.company.leaves(client)

    @rule(client=clients, name=NAMES)
    def somebody_provides(self, client: Client, name: str) -> None:
        self.company.provides(client, name)

    @rule(client=clients, name=NAMES)
    def somebody_provides_no_more(self, client: Client, name: str) -> None:
        self.company.send(client, "unadvertise_service", service=name)

    @rule(client=clients, name=NAMES, id_=IDS, timeout=TIMEOUTS)
    def somebody_calls(self, client: Client, name: str, id_: object, timeout: object) -> None:
        if "#" in name and id_ is None:
            id_ = name.partition("#")[2]
            self.company.calls(client, name, id_)
        else:
            self.company.calls(client, name, id_, timeout=timeout)

    @rule(client=clients, name=NAMES)
    def somebody_serves(self, client: Client, name: str) -> None:
        self.company.serves(client, name)

    @rule(client=clients, name=NAMES)
    def somebody_serves_no_more(self, client: Client, name: str) -> None:
        self.company.send(client, "unadvertise_action", action=name)

    @rule(client=clients, name=NAMES, id_=IDS, feedback=st.booleans())
    def somebody_sends_a_goal(self, client: Client, name: str, id_: object, feedback: bool) -> None:
        self.company.sends_goal(client, name, id_, feedback=feedback)

    @rule(client=clients, name=NAMES, id_=IDS)
    def somebody_cancels(self, client: Client, name: str, id_: object) -> None:
        self.company.send(client, "cancel_action_goal", action=name, id=id_)

    @rule(client=clients, id_=IDS)
    def somebody_cancels_all(self, client: Client, id_: object) -> None:
        self.company.calls(client, "/x/_action/cancel_goal", id_)

    @rule(target=asked, client=clients)
    def somebody_looks_at_what_it_is_asked(self, client: Client) -> Any:
        return multiple(*((client, each) for each in self.company.due[client]))

    @rule(asked=asked, values=VALUES, result=st.booleans())
    def somebody_answers(
        self, asked: tuple[Client, dict[str, Any]], values: object, result: bool
    ) -> None:
        client, what = asked
        self.company.answers(client, what, values=values, result=result)

    @rule(client=clients, asked=asked)
    def somebody_answers_for_another(
        self, client: Client, asked: tuple[Client, dict[str, Any]]
    ) -> None:
        self.company.answers(client, asked[1], values={})

    @rule(client=clients, name=NAMES, values=VALUES)
    def somebody_answers_without_an_id(self, client: Client, name: str, values: object) -> None:
        self.company.send(client, "service_response", service=name, values=values, result=True)

    @rule(asked=asked)
    def somebody_tells_how_far_it_has_come(self, asked: tuple[Client, dict[str, Any]]) -> None:
        self.company.tells(*asked)

    @rule(client=clients, text=OTHER)
    def somebody_says_something_else(self, client: Client, text: str) -> None:
        if client in self.company.present:
            client.send_text(text)
        self.company.listen()

    @rule(seconds=st.sampled_from([0.5, 3, 61]))
    def time_passes(self, seconds: float) -> None:
        self.company.passes(seconds)

    @rule(client=clients)
    def somebody_stops_reading(self, client: Client) -> None:
        client.queue.pause()

    @rule(client=clients)
    def somebody_reads_again(self, client: Client) -> None:
        if client in self.company.present:
            client.queue.resume()
        self.company.listen()

    @invariant()
    def the_graph_holds_only_who_is_there(self) -> None:
        present = {client.session.node for client in self.company.present}
        graph = self.hub.graph
        assert graph.nodes.keys() == present
        assert {each.node for each in graph.services.values()} <= present
        assert {each.node for each in graph.actions.values()} <= present
        assert self.hub.clock.timers <= len(present)

    @invariant()
    def what_one_waits_for_another_is_to_answer(self) -> None:
        sessions = [client.session for client in self.company.present]
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
        self.company.end()


RandomClients.TestCase.settings = settings(max_examples=times(0.5), stateful_step_count=40)
TestRandomClients = RandomClients.TestCase
