"""A port for servers that must be told one, because they start twice or a file names it."""

from __future__ import annotations

import socket
import sys
from collections.abc import Iterator
from contextlib import contextmanager

import pytest


@contextmanager
def reserved_port() -> Iterator[int]:
    """Reserve a port of 127.0.0.1, which refuses connections unless a server of the test has it.

    A bound socket keeps it from all who ask for any free port. It does not listen, so that a server
    may bind the port, too, if it sets SO_REUSEADDR, as those of asyncio and ROS 1's do.
    """
    with socket.socket() as holder:
        holder.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        holder.bind(("127.0.0.1", 0))
        number = holder.getsockname()[1]
        if sys.platform != "linux":
            holder.close()  # Only Linux lets two sockets bind one port in this way.
        yield number


@pytest.fixture
def port() -> Iterator[int]:
    """A port that is reserved for the servers of the test."""
    with reserved_port() as number:
        yield number
