"""The bytes that Linux counts on each TCP connection, so that the hub need not."""

from __future__ import annotations

import socket
import struct
import sys
from typing import NamedTuple

_TCP_INFO = getattr(socket, "TCP_INFO", None) if sys.platform == "linux" else None
"""Other systems have an option of this name, too, but another struct."""
_COUNTERS = struct.Struct("=120x2Q")
"""tcpi_bytes_acked and tcpi_bytes_received in struct tcp_info (linux/tcp.h)."""

are_available = _TCP_INFO is not None


class TcpCounters(NamedTuple):
    """Bytes of a connection, with headers of WebSocket frames and TLS, without those of TCP.

    Attributes:
        acknowledged: bytes that the client's system has received.
        received: bytes that the client has sent.
    """

    acknowledged: int
    received: int


def read(sock: socket.socket | None) -> TcpCounters | None:
    """Return a socket's counters; None if unknown: it is closed, or the system has no counters."""
    if _TCP_INFO is None or sock is None:
        return None
    try:
        info = sock.getsockopt(socket.IPPROTO_TCP, _TCP_INFO, _COUNTERS.size)
        return TcpCounters(*_COUNTERS.unpack(info))
    except (OSError, struct.error):
        return None
