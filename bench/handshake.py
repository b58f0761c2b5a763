"""A WebSocket handshake by hand, to time a server's answer and nothing else."""

from __future__ import annotations

import base64
import os
import socket
import time

from bench.measure import BenchError


def handshake(port: int, patience: float = 10.0) -> float:
    """Return the seconds from connecting to 127.0.0.1:port until the server's 101."""
    start = time.perf_counter()
    with connected(port, patience=patience):
        return time.perf_counter() - start


def connected(port: int, path: str = "/", patience: float = 10.0) -> socket.socket:
    """Return a socket on which a server has just agreed to speak WebSocket.

    Args:
        patience: the seconds that the server has for this, and for anything on the socket later.
    """
    key = base64.b64encode(os.urandom(16)).decode()
    request = (
        f"GET {path} HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\nUpgrade: websocket\r\n"
        f"Connection: Upgrade\r\nSec-WebSocket-Key: {key}\r\nSec-WebSocket-Version: 13\r\n\r\n"
    ).encode()
    answer = b""
    try:
        connection = socket.create_connection(("127.0.0.1", port), patience)
        try:
            connection.sendall(request)
            while b"\r\n\r\n" not in answer:
                if not (chunk := connection.recv(4096)):
                    break
                answer += chunk
            if not answer.startswith(b"HTTP/1.1 101"):
                raise BenchError(f"handshake refused on port {port}: {answer[:60]!r}")
        except BaseException:
            connection.close()
            raise
    except OSError as error:
        raise BenchError(f"no handshake on port {port}: {error}") from error
    return connection
