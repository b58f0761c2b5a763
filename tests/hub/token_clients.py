"""Clients of a hub that needs tokens: real connections, of several principals."""

from __future__ import annotations

import json
from collections.abc import AsyncIterator, Mapping
from contextlib import AsyncExitStack, asynccontextmanager
from typing import Any

from websockets.asyncio.client import ClientConnection, connect
from websockets.exceptions import ConnectionClosed
from websockets.typing import Subprotocol

from fibws.access.token_file import digest_of
from fibws.hub.server import HubServer
from fibws.protocol.serialized import SUBPROTOCOL


def entry(name: str, more: str, token: str | None = None) -> str:
    """Return the entry of a principal in a token file; its token is its name by default."""
    digest = digest_of(name if token is None else token)
    return f'[tokens.{name}]\nsha256 = "{digest}"\n{more}\n'


class Client:
    """A client of the hub that is one principal.

    Args:
        name: its node's.
        token: None if it is anonymous.
    """

    def __init__(self, connection: ClientConnection, name: str, token: str | None) -> None:
        self.connection = connection
        self.name = name
        self.token = token

    async def send(self, op: str, **fields: Any) -> None:
        """Send an operation."""
        await self.connection.send(json.dumps({"op": op, **fields}))

    async def receive(self, op: str) -> dict[str, Any]:
        """Return the next operation of a kind, and drop those before."""
        while True:
            received: dict[str, Any] = json.loads(await self.connection.recv())
            if received["op"] == op:
                return received

    async def answers(self, op: str, **fields: Any) -> list[dict[str, Any]]:
        """Send an operation, and return everything that comes until the hub has done it."""
        await self.send(op, **fields)
        await self.send("call_service", service="/rosapi/get_time", id="until here")
        found: list[dict[str, Any]] = []
        while True:
            data = await self.connection.recv()
            if isinstance(data, bytes):
                continue
            received = json.loads(data)
            if received.get("id") == "until here":
                return found
            found.append(received)

    async def does(self, op: str, **fields: Any) -> None:
        """Perform an operation that must succeed."""
        assert await self.answers(op, **fields) == []

    async def call(self, service: str, **args: Any) -> dict[str, Any]:
        """Return the response of a service."""
        (response,) = (
            each
            for each in await self.answers("call_service", service=service, args=args, id="call")
            if each["op"] == "service_response"
        )
        return response

    async def values(self, service: str, **args: Any) -> dict[str, Any]:
        """Return the values with which a service responds."""
        response = await self.call(service, **args)
        assert response["result"], response
        values: dict[str, Any] = response["values"]
        return values

    async def is_alive(self) -> bool:
        """Return whether the client is still the node that it was."""
        return self.name in (await self.values("/rosapi/nodes"))["nodes"]


async def closing(connection: ClientConnection) -> tuple[int, str]:
    """Return the code and the reason with which the hub closes."""
    try:
        while True:
            await connection.recv()
    except ConnectionClosed as closed:
        assert closed.rcvd is not None
        return closed.rcvd.code, closed.rcvd.reason


class World:
    """A hub and its clients."""

    def __init__(self, hub: HubServer, stack: AsyncExitStack) -> None:
        self.hub = hub
        self._stack = stack

    async def client(
        self, token: str | None, node: str | None = None, *, serialized: bool = False
    ) -> Client:
        """Return a new client; without a token it is anonymous."""
        known = set(self.hub.graph.nodes)
        connection = await self._stack.enter_async_context(
            entering(self.hub, token, node, serialized=serialized)
        )
        (name,) = self.hub.graph.nodes.keys() - known
        return Client(connection, name, token)


@asynccontextmanager
async def entering(
    hub: HubServer,
    token: str | None,
    node: str | None = None,
    *,
    serialized: bool = False,
    headers: Mapping[str, str] | None = None,
    query: str = "",
) -> AsyncIterator[ClientConnection]:
    """Open a connection; without a token the client is anonymous.

    Args:
        headers: more of the request.
        query: more of the URL's query.
    """
    headers = dict(headers or {})
    if token is not None:
        headers["Authorization"] = f"Bearer {token}"
    subprotocols = [Subprotocol(SUBPROTOCOL)] if serialized else None
    queries = [query] if query else []
    if node is not None:
        queries.append(f"node={node}")
    url = f"{hub.url}/?{'&'.join(queries)}"
    async with connect(
        url, additional_headers=headers, subprotocols=subprotocols, max_size=None
    ) as connection:
        yield connection
