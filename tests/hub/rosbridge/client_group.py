"""Clients that call each other and send each other goals, and may leave at any moment.

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
"""Stands for an id that was not used before."""


class Company:
    """The clients of one hub, with the calls and goals that each sent and received."""

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
        """Add a client, which replaces an older one of its name."""
        client = self.hub.client(node)
        for older in [each for each in self.present if each.closings]:
            self._is_gone(older)
        self.present.append(client)
        self.everyone.append(client)
        return client

    def leaves(self, client: Client) -> None:
        """Let a client leave, if it is there."""
        if client in self.present:
            client.leaves()
            self._is_gone(client)

    def _is_gone(self, client: Client) -> None:
        self.present.remove(client)
        self._listens(client)
        assert client.forgotten

    def send(self, client: Client, op: str, **fields: Any) -> None:
        """Let a client send an operation, if it is there; then all receive."""
        if client in self.present:
            client.send(op, **fields)
        self.listen()

    def calls(self, client: Client, service: str, id_: object = NEW, **fields: Any) -> None:
        fields["id"] = self._id(client, id_)
        self.send(client, "call_service", service=service, **fields)

    def sends_goal(self, client: Client, action: str, id_: object = NEW, **fields: Any) -> None:
        fields = {"action_type": FIBONACCI, "feedback": True, **fields}
        fields["id"] = self._id(client, id_)
        self.send(client, "send_action_goal", action=action, **fields)

    def provides(self, client: Client, service: str) -> None:
        self.send(client, "advertise_service", service=service, type=ADD)

    def serves(self, client: Client, action: str) -> None:
        self.send(client, "advertise_action", action=action, type=FIBONACCI)

    def answers(self, client: Client, asked: dict[str, Any], **fields: Any) -> None:
        """Let a client respond to a call or goal; it may do so again later."""
        if asked["op"] == "call_service":
            response = {"service": asked["service"], "id": asked["id"], "result": True, **fields}
            self.send(client, "service_response", **response)
        else:
            result = {"action": asked["action"], "id": asked["id"], "result": True, **fields}
            self.send(client, "action_result", **result)

    def tells(self, client: Client, asked: dict[str, Any]) -> None:
        """Let a client send feedback of a goal."""
        self.send(client, "action_feedback", action="/any", id=asked["id"], values={})

    def passes(self, seconds: float) -> None:
        """Advance the clock."""
        self.hub.clock.advance(seconds)
        self.listen()

    def listen(self) -> None:
        """Let all clients receive; nothing may come after a client has left."""
        for client in self.present:
            self._listens(client)
        for client in self.everyone:
            assert client in self.present or client.receive() == []

    def _listens(self, client: Client) -> None:
        if client.queue.paused:
            return
        for heard in client.receive():
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
        """Return how many responses and results a client waits for."""
        return self.asked[client].total() - self.answered[client].total()

    def end(self) -> None:
        """Let all calls time out and all clients leave; nothing may be left."""
        for client in self.present:
            client.queue.resume()
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
