"""A client that calls rosapi's services, and a hub with its own nodes for it."""

from __future__ import annotations

from itertools import count
from typing import Any, Literal

from fibws.access.rights import Principal
from fibws.hub.log.audit import Audit
from fibws.hub.rosapi.nodes import OwnNodes
from fibws.protocol.websocket import CloseReason

from ..fakes import Client, FakeHub

RUN_ID = "00000000-0000-4000-8000-000000000000"


class Connection:
    """The connection of a client that has no socket."""

    def __init__(self, client: Client, port: int) -> None:
        self.client = client
        self.name = client.session.node
        self.address = "10.0.0.1"
        self.peer = f"10.0.0.1:{port}"
        self.queue = client.queue
        self.principal: Principal | None = None
        self.messages_received = 3
        self.bytes_received = 300
        self.limited = 2
        self.protocol = "rosbridge"
        self.pings: list[bytes] = []
        self.closings: list[CloseReason] = []

    def registrations(self, what: Literal["subscriptions", "advertisements"]) -> int:
        return self.client.session.registrations(what)

    def ping(self, data: bytes) -> None:
        self.pings.append(data)

    def close(self, closing: CloseReason) -> None:
        self.closings.append(closing)
        self.client.disconnect()


class RosapiClient:
    """A client of a new hub, which calls services and checks their responses.

    Args:
        settings: those of `FakeHub`.
    """

    def __init__(
        self, node: str = "/caller", *, principal: Principal | None = None, **settings: Any
    ) -> None:
        self.hub = FakeHub(**settings)
        self.graph = self.hub.graph
        self.own = OwnNodes(
            self.graph,
            self.hub.clock,
            Audit(self.hub.clock.time),
            host="localhost",
            port=9090,
            address="127.0.0.1",
            run_id=RUN_ID,
            hubs=lambda caller: {},
        )
        self.hub.rosbridge.report = self.own.refusals.report
        self.client = self.hub.client(node, principal=principal)
        self._ports = count(50001)

    def add_client(self, node: str | None, principal: Principal | None = None) -> Client:
        """Add another client."""
        return self.hub.client(node, principal=principal)

    def connect(self, node: str | None = None, *, principal: Principal | None = None) -> Connection:
        """Add another client, and report its connection to the hub's own nodes."""
        connection = Connection(self.add_client(node, principal), next(self._ports))
        self.own.connected(connection)
        return connection

    def call(self, service: str, /, **args: Any) -> dict[str, Any]:
        """Call a service; return the response, which is complete and fits the service's type."""
        response = self._response(service, args)
        assert response["result"], response
        values: dict[str, Any] = response["values"]
        name = service if service.startswith("/") else f"/{service}"
        assert self.graph.services[name].type.response(values) == values
        return values

    def refusal(self, service: str, /, **args: Any) -> str:
        """Call a service that fails; return the text of the error."""
        response = self._response(service, args)
        assert not response["result"], response
        text: str = response["values"]
        return text

    def _response(self, service: str, args: dict[str, Any]) -> dict[str, Any]:
        self.client.send("call_service", service=service, args=args)
        return self.response_to(service)

    def response_to(self, service: str) -> dict[str, Any]:
        """Return the response to an earlier call."""
        (response,) = self.client.receive()
        assert (response["op"], response["service"]) == ("service_response", service)
        return response
