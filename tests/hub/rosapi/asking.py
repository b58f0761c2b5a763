"""A hub with its own nodes, and a client that asks them."""

from __future__ import annotations

from itertools import count
from typing import Any

from fibws.hub.rosapi.nodes import OwnNodes
from fibws.protocol.closing import Closing

from ..fakes import Client, FakeHub

RUN_ID = "00000000-0000-4000-8000-000000000000"


class Connection:
    """The connection of a client that has no socket."""

    def __init__(self, client: Client, port: int) -> None:
        self.client = client
        self.name = client.session.node
        self.address = "10.0.0.1"
        self.peer = f"10.0.0.1:{port}"
        self.outbox = client.outbox
        self.pings: list[bytes] = []
        self.closings: list[Closing] = []

    def ping(self, data: bytes) -> None:
        self.pings.append(data)

    def close(self, closing: Closing) -> None:
        self.closings.append(closing)
        self.client.leaves()


class Asking:
    """The hub, and what a client gets when it calls a service."""

    def __init__(self, node: str = "/asker", **settings: Any) -> None:
        self.hub = FakeHub(**settings)
        self.graph = self.hub.graph
        self.own = OwnNodes(self.graph, self.hub.clock, host="localhost", port=9090, run_id=RUN_ID)
        self.client = self.hub.client(node)
        self._ports = count(50001)

    def joins(self, node: str | None) -> Client:
        """Another client."""
        return self.hub.client(node)

    def connects(self, node: str | None = None) -> Connection:
        """Another client, and the hub is told that it is connected."""
        connection = Connection(self.joins(node), next(self._ports))
        self.own.connected(connection)
        return connection

    def gets(self, service: str, /, **args: Any) -> dict[str, Any]:
        """The response, which is complete and fits the service's type."""
        response = self._response(service, args)
        assert response["result"], response
        values: dict[str, Any] = response["values"]
        name = service if service.startswith("/") else f"/{service}"
        assert self.graph.services[name].type.response(values) == values
        return values

    def is_refused(self, service: str, /, **args: Any) -> str:
        """The text of what went wrong."""
        response = self._response(service, args)
        assert not response["result"], response
        text: str = response["values"]
        return text

    def _response(self, service: str, args: dict[str, Any]) -> dict[str, Any]:
        self.client.says("call_service", service=service, args=args)
        return self.hears_of(service)

    def hears_of(self, service: str) -> dict[str, Any]:
        """The response to a call that was made before."""
        (response,) = self.client.hears()
        assert (response["op"], response["service"]) == ("service_response", service)
        return response
