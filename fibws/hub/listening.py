"""The port that the hub listens on, and the URL by which programs of this machine reach it."""

from __future__ import annotations

import asyncio
import errno
import json
import socket
from collections.abc import Callable
from contextlib import suppress
from typing import Any

from fibws.errors import SettingError
from fibws.hub.announcement import ALL, ALL_IPV4
from fibws.hub.settings import Settings
from fibws.hub.tls.certificate import ServerTls

LEAST_TIMEOUT = 0.001
"""Seconds; asyncio accepts no timeouts of 0 for TLS."""
PATIENCE = 1.0
"""Seconds to wait for an answer."""
LARGEST = 4096
"""Bytes of an answer that are read."""
PORT_TRIES = 20
"""How many ports are tried until one is free for IPv4 and IPv6."""
ACCEPTED_AT_ONCE = 32
"""Connections that are accepted before those that are open have their turn: asyncio would accept
the whole backlog."""


async def listen(
    settings: Settings, tls: ServerTls | None, make: Callable[[], asyncio.BaseProtocol]
) -> asyncio.Server:
    """Take the port of the settings; connections wait until the hub serves.

    Args:
        make: returns what handles a new connection.

    Raises:
        SettingError: the port is taken, or cannot be listened on.
    """
    loop = asyncio.get_running_loop()
    host, port = settings.host, settings.port
    # With port 0, asyncio would take another port for each family.
    are_both = host in ALL
    for _ in range(PORT_TRIES):
        try:
            return await loop.create_server(
                make,
                None if are_both else host,
                port or (_free_port() if are_both else 0),
                backlog=ACCEPTED_AT_ONCE,
                start_serving=False,
                **_tls_arguments(settings, tls),
            )
        except OSError as error:
            fault = error
            if port or error.errno != errno.EADDRINUSE:
                break
    reason = _why_not(host, port, fault)
    if fault.errno == errno.EADDRINUSE:
        is_hub = await _is_hub_at(reached_at(host), port)
        owner = "another hub" if is_hub else "another program"
        reason = f"Port {port} on {host} is in use by {owner}; choose one with --port"
    raise SettingError(reason) from fault


def local_url(settings: Settings, port: int, tls: ServerTls | None = None) -> str:
    """Return the URL by which programs on this machine reach a hub that listens on a port."""
    scheme, host = "wss" if settings.has_tls else "ws", reached_at(settings.host)
    if tls is not None:
        host = tls.name_for(host)
    return f"{scheme}://{f'[{host}]' if ':' in host else host}:{port}{settings.base_path}"


def reached_at(host: str) -> str:
    """Return the address by which programs on this machine reach a hub that listens there."""
    return "127.0.0.1" if host in (ALL_IPV4, *ALL) else host


def _free_port() -> int:
    """Return a port that is free, at least for IPv4."""
    with socket.socket() as probe:
        probe.bind(("", 0))
        port: int = probe.getsockname()[1]
        return port


def _tls_arguments(settings: Settings, tls: ServerTls | None) -> dict[str, Any]:
    """Return the arguments of the event loop's create_server."""
    if tls is None:
        return {}
    return {
        "ssl": tls.context,
        "ssl_handshake_timeout": max(settings.open_timeout, LEAST_TIMEOUT),
        "ssl_shutdown_timeout": max(settings.close_timeout, LEAST_TIMEOUT),
    }


async def _is_hub_at(host: str, port: int) -> bool:
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


def _why_not(host: str, port: int, error: OSError) -> str:
    if error.errno in (errno.EADDRNOTAVAIL, None):  # From Python 3.13 on asyncio names none.
        return f"--host: {host} is not an address of this machine"
    option = "--host: cannot" if isinstance(error, socket.gaierror) else "Cannot"
    return f"{option} listen on {host}:{port}: {error.strerror or error}"
