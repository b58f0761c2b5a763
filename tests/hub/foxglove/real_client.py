"""A client of Foxglove's protocol with a real connection."""

from __future__ import annotations

import asyncio
import json
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from typing import Any

from patience import PATIENCE
from websockets.asyncio.client import ClientConnection, connect
from websockets.typing import Subprotocol

from fibws.hub.foxglove import SUBPROTOCOLS
from fibws.hub.server import HubServer


class Foxglove:
    """A client that keeps what it is told of channels and services."""

    def __init__(self, websocket: ClientConnection) -> None:
        self.websocket = websocket
        self.channels: dict[str, dict[str, Any]] = {}
        self.services: dict[str, dict[str, Any]] = {}

    async def send(self, op: str, **fields: Any) -> None:
        await self.websocket.send(json.dumps({"op": op, **fields}))

    async def receive(self) -> Any:
        """Return the next operation as a dict, or the next binary message."""
        async with asyncio.timeout(PATIENCE):
            data = await self.websocket.recv()
        if isinstance(data, bytes):
            return data
        fields = json.loads(data)
        for each in fields.get("channels", ()):
            self.channels[each["topic"]] = each
        for each in fields.get("services", ()):
            self.services[each["name"]] = each
        return fields

    async def find(self, op: str) -> dict[str, Any]:
        """Return the next operation of a kind, and drop those before."""
        while True:
            received = await self.receive()
            if isinstance(received, dict) and received["op"] == op:
                return received

    async def find_binary(self, kind: int) -> bytes:
        """Return the next binary message of a kind, and drop everything before."""
        while True:
            received = await self.receive()
            if isinstance(received, bytes) and received[0] == kind:
                return received

    async def channel(self, topic: str) -> int:
        """Return the id of a topic's channel, once there is one."""
        while topic not in self.channels:
            await self.receive()
        id_: int = self.channels[topic]["id"]
        return id_

    async def service(self, name: str) -> int:
        """Return the id of a service, once there is one."""
        while name not in self.services:
            await self.receive()
        id_: int = self.services[name]["id"]
        return id_

    async def subscribe(self, topic: str, id_: int = 0) -> None:
        wanted = [{"id": id_, "channelId": await self.channel(topic)}]
        await self.send("subscribe", subscriptions=wanted)

    async def is_processed(self) -> None:
        """Wait until the hub has read everything sent."""
        await self.send("getParameters", parameterNames=[], id="processed")
        while (await self.find("parameterValues")).get("id") != "processed":
            pass


@asynccontextmanager
async def foxglove(
    hub: HubServer, query: str = "?node=/studio", *subprotocols: str
) -> AsyncIterator[Foxglove]:
    """Connect as the applications do."""
    offered = [Subprotocol(each) for each in subprotocols or SUBPROTOCOLS]
    async with connect(
        f"{hub.url}/{query}", subprotocols=offered, max_size=None, compression=None
    ) as websocket:
        yield Foxglove(websocket)
