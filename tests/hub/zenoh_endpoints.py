"""Endpoints of hubs on zenoh networks: zenoh chooses the port, and its administration tells it."""

from __future__ import annotations

import asyncio
import json
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import zenoh

ANY_PORT = "tcp/127.0.0.1:0"


def zenoh_config(folder: Path, **transport: Any) -> Path:
    """Write a configuration file of zenoh that lets `listens_at` ask; return its path."""
    path = folder / "zenoh.json5"
    path.write_text(json.dumps({"adminspace": {"enabled": True}, "transport": transport}))
    return path


async def listens_at(session: zenoh.Session) -> str:
    """Return the endpoint where a session listens."""
    replies = await asyncio.to_thread(lambda: list(session.get(f"@/{session.zid()}/router")))
    assert replies and replies[0].ok is not None
    [endpoint] = json.loads(replies[0].ok.payload.to_bytes())["locators"]
    return str(endpoint)
