"""A WebSocket handshake by hand, to time a server's answer and nothing else."""

from __future__ import annotations

import base64
import os
import socket
import time

from bench.errors import BenchError


def handshake(port: int, patience: float = 10.0) -> float:
    """Return the seconds from connecting to 127.0.0.1:port until the server's 101."""
    key = base64.b64encode(os.urandom(16)).decode()
    request = (
        f"GET / HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\nUpgrade: websocket\r\n"
        f"Connection: Upgrade\r\nSec-WebSocket-Key: {key}\r\nSec-WebSocket-Version: 13\r\n\r\n"
    ).encode()
    start = time.perf_counter()
    try:
        with socket.create_connection(("127.0.0.1", port), patience) as connection:
            connection.sendall(request)
            answer = b""
            while b"\r\n\r\n" not in answer:
                if not (chunk := connection.recv(4096)):
                    break
                answer += chunk
            seconds = time.perf_counter() - start
    except OSError as error:
        raise BenchError(f"no handshake on port {port}: {error}") from error
    if not answer.startswith(b"HTTP/1.1 101"):
        raise BenchError(f"handshake refused on port {port}: {answer[:60]!r}")
    return seconds
