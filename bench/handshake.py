"""A minimal WebSocket handshake, to time the server's response alone."""

from __future__ import annotations

import base64
import os
import socket
import ssl
import time

from bench.measure import BenchError


def handshake(port: int, timeout: float = 10.0, context: ssl.SSLContext | None = None) -> float:
    """Return the seconds from connecting to 127.0.0.1:port until the server's 101.

    Args:
        context: for TLS.
    """
    start = time.perf_counter()
    with connected(port, timeout=timeout, context=context):
        return time.perf_counter() - start


def connected(
    port: int,
    path: str = "/",
    timeout: float = 10.0,
    context: ssl.SSLContext | None = None,
    subprotocol: str = "",
) -> socket.socket:
    """Return a socket on which the WebSocket handshake is complete.

    Args:
        timeout: seconds for the handshake, and for each later operation on the socket.
        context: for TLS.
        subprotocol: the one to offer, if any.
    """
    key = base64.b64encode(os.urandom(16)).decode()
    request = (
        f"GET {path} HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\nUpgrade: websocket\r\n"
        f"Connection: Upgrade\r\nSec-WebSocket-Key: {key}\r\nSec-WebSocket-Version: 13\r\n"
        + (f"Sec-WebSocket-Protocol: {subprotocol}\r\n" if subprotocol else "")
        + "\r\n"
    ).encode()
    response = b""
    try:
        connection = socket.create_connection(("127.0.0.1", port), timeout)
        try:
            if context is not None:
                connection = context.wrap_socket(connection, server_hostname="127.0.0.1")
            connection.sendall(request)
            while b"\r\n\r\n" not in response:
                # What the server sends behind its response is left for the caller.
                most = 4096 if context is not None else _response_size(connection)
                if not (chunk := connection.recv(most)):
                    break
                response += chunk
            if not response.startswith(b"HTTP/1.1 101"):
                raise BenchError(f"handshake refused on port {port}: {response[:60]!r}")
        except BaseException:
            connection.close()
            raise
    except OSError as error:
        raise BenchError(f"handshake failed on port {port}: {error}") from error
    return connection


def _response_size(connection: socket.socket) -> int:
    """Return how many of the bytes that have arrived belong to the response."""
    arrived = connection.recv(4096, socket.MSG_PEEK)
    end = arrived.find(b"\r\n\r\n")
    return end + 4 if end >= 0 else max(1, len(arrived) - 3)
