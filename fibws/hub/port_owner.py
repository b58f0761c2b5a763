"""Who has the port that the hub should listen on: another hub, or another program."""

from __future__ import annotations

import asyncio
import json
from contextlib import suppress

PATIENCE = 1.0
"""Seconds to wait for an answer."""
LARGEST = 4096
"""Bytes of an answer that are read."""


async def is_hub_at(host: str, port: int) -> bool:
    """Return whether a hub without TLS answers at a port of this machine, or one that expects TLS.

    Every hub answers `/origin` to everybody, and requests without TLS by a redirect.
    """
    with suppress(OSError, ValueError, TimeoutError):
        async with asyncio.timeout(PATIENCE):
            head, body = await _get(host, port, "/origin")
        found = json.loads(body) if body.startswith(b"{") else {}
        return "allowed" in found or b"This port expects TLS" in head + body
    return False


async def _get(host: str, port: int, path: str) -> tuple[bytes, bytes]:
    reader, writer = await asyncio.open_connection(host, port)
    try:
        writer.write(
            f"GET {path} HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n".encode()
        )
        answer = b""
        while len(answer) < LARGEST and (piece := await reader.read(LARGEST)):
            answer += piece
        head, _, body = answer.partition(b"\r\n\r\n")
        return head, body
    finally:
        writer.close()
