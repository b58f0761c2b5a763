"""Clients that call each other and pursue each other's goals, and may vanish at any moment.

Whatever they do, each call and each goal has exactly one answer while its client is there, and when
all have left nothing is left of them.
"""

from __future__ import annotations

from collections import Counter, defaultdict
from itertools import count
from typing import Any

from ..fakes import ADD, FIBONACCI, Client, FakeHub

ANSWERS = ("service_response", "action_result")
ASKING = ("call_service", "send_action_goal", "cancel_action_goal")
OTHERS = ("action_feedback", "status")
NEW = object()
"""An id that was never given before."""


class Company:
    """The clients of one hub, and what each has asked, heard and been asked."""

    def __init__(self, hub: FakeHub) -> None:
        self.hub = hub
        self.present: list[Client] = []
        self.asked: dict[Client, Counter[object]] = defaultdict(Counter)
        """The ids of a client's calls and goals."""
        self.answered: dict[Client, Counter[object]] = defaultdict(Counter)
        self.due: dict[Client, list[dict[str, Any]]] = defaultdict(list)
        """The calls and goals that a client is to answer; some may have been given up."""
        self.everyone: list[Client] = []
        self._ids = count(1)

    def enters(self, node: str | None) -> Client:
        """A new client; whoever had the name has to go."""
        client = self.hub.client(node)
        for older in [each for each in self.present if each.closings]:
            self._is_gone(older)
        self.present.append(client)
        self.everyone.append(client)
        return client

    def leaves(self, client: Client) -> None:
        """A client vanishes, if it is there."""
        if client in self.present:
            client.leaves()
            self._is_gone(client)

    def _is_gone(self, client: Client) -> None:
        self.present.remove(client)
        self._listens(client)
        assert client.forgotten

    def says(self, client: Client, op: str, **fields: Any) -> None:
        """A client says something, if it is there; then all listen."""
        if client in self.present:
            client.says(op, **fields)
        self.listen()

    def calls(self, client: Client, service: str, id_: object = NEW, **fields: Any) -> None:
        fields["id"] = self._id(client, id_)
        self.says(client, "call_service", service=service, **fields)

    def sends_goal(self, client: Client, action: str, id_: object = NEW, **fields: Any) -> None:
        fields = {"action_type": FIBONACCI, "feedback": True, **fields}
        fields["id"] = self._id(client, id_)
        self.says(client, "send_action_goal", action=action, **fields)

    def provides(self, client: Client, service: str) -> None:
        self.says(client, "advertise_service", service=service, type=ADD)

    def serves(self, client: Client, action: str) -> None:
        self.says(client, "advertise_action", action=action, type=FIBONACCI)

    def answers(self, client: Client, asked: dict[str, Any], **fields: Any) -> None:
        """A client answers what it was asked, and may do so again later."""
        if asked["op"] == "call_service":
            response = {"service": asked["service"], "id": asked["id"], "result": True, **fields}
            self.says(client, "service_response", **response)
        else:
            result = {"action": asked["action"], "id": asked["id"], "result": True, **fields}
            self.says(client, "action_result", **result)

    def tells(self, client: Client, asked: dict[str, Any]) -> None:
        """A client says how far a goal has come."""
        self.says(client, "action_feedback", action="/any", id=asked["id"], values={})

    def passes(self, seconds: float) -> None:
        """Time passes."""
        self.hub.clock.advance(seconds)
        self.listen()

    def listen(self) -> None:
        """All hear what there is to be heard; nobody hears anything after its end."""
        for client in self.present:
            self._listens(client)
        for client in self.everyone:
            assert client in self.present or client.hears() == []

    def _listens(self, client: Client) -> None:
        if client.outbox.paused:
            return
        for heard in client.hears():
            op, id_ = heard["op"], heard.get("id")
            assert op in (*ANSWERS, *ASKING, *OTHERS)
            if op in (*ANSWERS, "action_feedback"):
                assert self.answered[client][id_] < self.asked[client][id_]
            if op == "status" and "has not ended yet" in heard["msg"]:
                # A result could not be told from that of the goal that has the id.
                self.asked[client][id_] -= 1
            elif op in ANSWERS:
                self.answered[client][id_] += 1
            elif op in ("call_service", "send_action_goal"):
                self.due[client].append(heard)

    def waits_for(self, client: Client) -> int:
        """How many answers a client is yet to hear."""
        return self.asked[client].total() - self.answered[client].total()

    def end(self) -> None:
        """Whoever still is there gets its answers; then all leave, and nothing is left."""
        for client in self.present:
            client.outbox.resume()
        self.passes(100_000)
        # Calls run out of time, goals do not: who waits has sent one that some server pursues.
        for client in self.present:
            assert self.waits_for(client) == len(client.session.goals._sent)
        while self.present:
            self.leaves(self.present[0])
            self.listen()
            for client in self.present:
                assert self.waits_for(client) == len(client.session.goals._sent)
        assert self.hub.empty
        assert self.hub.clock.timers == 0
        assert all(client.forgotten for client in self.everyone)

    def _id(self, client: Client, id_: object) -> object:
        id_ = next(self._ids) if id_ is NEW else id_
        if client in self.present:
            self.asked[client][id_] += 1
        return id_
