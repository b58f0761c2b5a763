"""Clients that call each other and send each other goals, and may leave at any moment.

Each call and goal gets exactly one response while its client is connected. When all clients have
left, the hub keeps nothing of them.
"""

from __future__ import annotations

from collections import Counter, defaultdict
from itertools import count
from typing import Any

from ..fakes import ADD, FIBONACCI, Client, FakeHub

RESPONSES = ("service_response", "action_result")
REQUESTS = ("call_service", "send_action_goal", "cancel_action_goal")
OTHER_OPERATIONS = ("action_feedback", "status")
NEW = object()
"""Stands for a new id."""


class ClientGroup:
    """The clients of one hub, with the calls and goals that each sent and received."""

    def __init__(self, hub: FakeHub) -> None:
        self.hub = hub
        self.present: list[Client] = []
        self.requests: dict[Client, Counter[object]] = defaultdict(Counter)
        """The ids of a client's calls and goals."""
        self.responses: dict[Client, Counter[object]] = defaultdict(Counter)
        self.due: dict[Client, list[dict[str, Any]]] = defaultdict(list)
        """The calls and goals that a client should respond to; some may have been canceled."""
        self.everyone: list[Client] = []
        self._ids = count(1)

    def connect(self, node: str | None) -> Client:
        """Add a client, which replaces an older one of the same name."""
        client = self.hub.client(node)
        for older in [each for each in self.present if each.closings]:
            self._remove(older)
        self.present.append(client)
        self.everyone.append(client)
        return client

    def disconnect(self, client: Client) -> None:
        """Disconnect a client if it is connected."""
        if client in self.present:
            client.disconnect()
            self._remove(client)

    def _remove(self, client: Client) -> None:
        self.present.remove(client)
        self._receive(client)
        assert client.forgotten

    def send(self, client: Client, op: str, **fields: Any) -> None:
        """Let a client send an operation if it is connected; then all receive."""
        if client in self.present:
            client.send(op, **fields)
        self.receive_all()

    def call(self, client: Client, service: str, id_: object = NEW, **fields: Any) -> None:
        fields["id"] = self._id(client, id_)
        self.send(client, "call_service", service=service, **fields)

    def send_goal(self, client: Client, action: str, id_: object = NEW, **fields: Any) -> None:
        fields = {"action_type": FIBONACCI, "feedback": True, **fields}
        fields["id"] = self._id(client, id_)
        self.send(client, "send_action_goal", action=action, **fields)

    def advertise_service(self, client: Client, service: str) -> None:
        self.send(client, "advertise_service", service=service, type=ADD)

    def advertise_action(self, client: Client, action: str) -> None:
        self.send(client, "advertise_action", action=action, type=FIBONACCI)

    def respond(self, client: Client, request: dict[str, Any], **fields: Any) -> None:
        """Let a client respond to a call or goal; it may do so again later."""
        if request["op"] == "call_service":
            response = {
                "service": request["service"],
                "id": request["id"],
                "result": True,
                **fields,
            }
            self.send(client, "service_response", **response)
        else:
            result = {"action": request["action"], "id": request["id"], "result": True, **fields}
            self.send(client, "action_result", **result)

    def send_feedback(self, client: Client, request: dict[str, Any]) -> None:
        """Let a client send feedback of a goal."""
        self.send(client, "action_feedback", action="/any", id=request["id"], values={})

    def advance(self, seconds: float) -> None:
        """Advance the clock."""
        self.hub.clock.advance(seconds)
        self.receive_all()

    def receive_all(self) -> None:
        """Let all clients receive; nothing may come after a client has left."""
        for client in self.present:
            self._receive(client)
        for client in self.everyone:
            assert client in self.present or client.receive() == []

    def _receive(self, client: Client) -> None:
        if client.queue.paused:
            return
        for received in client.receive():
            op, id_ = received["op"], received.get("id")
            assert op in (*RESPONSES, *REQUESTS, *OTHER_OPERATIONS)
            if op in (*RESPONSES, "action_feedback"):
                assert self.responses[client][id_] < self.requests[client][id_]
            if op == "status" and "has not ended yet" in received["msg"]:
                # A result would be mistaken for that of the goal with this id.
                self.requests[client][id_] -= 1
            elif op in RESPONSES:
                self.responses[client][id_] += 1
            elif op in ("call_service", "send_action_goal"):
                self.due[client].append(received)

    def pending(self, client: Client) -> int:
        """Return how many responses and results a client waits for."""
        return self.requests[client].total() - self.responses[client].total()

    def end(self) -> None:
        """Let all calls time out and all clients leave; nothing may be left."""
        for client in self.present:
            client.queue.resume()
        self.advance(100_000)
        # Calls time out but goals do not: the remaining ones are being executed.
        for client in self.present:
            assert self.pending(client) == len(client.session.goals._sent)
        while self.present:
            self.disconnect(self.present[0])
            self.receive_all()
            for client in self.present:
                assert self.pending(client) == len(client.session.goals._sent)
        assert self.hub.empty
        assert self.hub.clock.timers == 0
        assert all(client.forgotten for client in self.everyone)

    def _id(self, client: Client, id_: object) -> object:
        id_ = next(self._ids) if id_ is NEW else id_
        if client in self.present:
            self.requests[client][id_] += 1
        return id_
