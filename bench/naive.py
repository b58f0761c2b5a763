"""A simple hub, as one would write it in an afternoon: a reference for the figures.

    python -m bench.naive

It uses common libraries as documented: `async for` over websockets, `json.loads`, a pydantic
model for the operation and one for the message, `websockets.broadcast` of `json.dumps`.
"""

from __future__ import annotations

import asyncio
import json
from collections import defaultdict
from typing import Any

from pydantic import BaseModel
from websockets.asyncio.server import ServerConnection, broadcast, serve
from websockets.exceptions import ConnectionClosed


class Publish(BaseModel):
    """The publish operation."""

    op: str
    topic: str
    msg: dict[str, Any]


class String(BaseModel):
    """std_msgs/String."""

    data: str


MODELS: dict[str, type[BaseModel]] = {"std_msgs/String": String}
SUBSCRIBERS: defaultdict[str, set[ServerConnection]] = defaultdict(set)
TYPES: dict[str, str] = {}


def relayed(operation: dict[str, Any], model: type[BaseModel]) -> str:
    """Return the JSON to send to subscribers for a publish operation."""
    publish = Publish.model_validate(operation)
    publish.msg = model.model_validate(publish.msg).model_dump()
    return json.dumps(publish.model_dump())


async def session(connection: ServerConnection) -> None:
    """Serve one client until it disconnects."""
    try:
        async for text in connection:
            operation = json.loads(text)
            match operation["op"]:
                case "publish":
                    topic = operation["topic"]
                    broadcast(SUBSCRIBERS[topic], relayed(operation, MODELS[TYPES[topic]]))
                case "subscribe":
                    SUBSCRIBERS[operation["topic"]].add(connection)
                case "advertise":
                    TYPES[operation["topic"]] = operation["type"]
    except ConnectionClosed:
        pass
    finally:
        for subscribers in SUBSCRIBERS.values():
            subscribers.discard(connection)


async def main() -> None:
    """Serve on a free port and print it."""
    async with serve(session, "127.0.0.1", 0, compression=None, max_size=16 << 20) as server:
        port = next(iter(server.sockets)).getsockname()[1]
        print(f"naive on ws://127.0.0.1:{port}", flush=True)
        await server.serve_forever()


if __name__ == "__main__":
    try:
        asyncio.run(main())
    except KeyboardInterrupt:
        pass
