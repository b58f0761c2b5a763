"""Clients that cost little: what they send is bytes made before, what they hear is only cut."""

from __future__ import annotations

import json
import selectors
import socket
import struct
import time
from collections.abc import Collection, Iterable, Iterator
from contextlib import ExitStack, contextmanager
from typing import Any, Self

from bench.handshake import connected
from bench.measure import BenchError

PATIENCE_SECONDS = 10.0
"""Less than between two of the hub's pings, which would be taken for a sign of life."""
NO_MASK = bytes(4)
"""A masking key of zeros leaves the payload as it is; the server unmasks it all the same."""
TEXT, CLOSE, PING, PONG = 0x81, 0x88, 0x89, 0x8A
"""The first bytes of frames."""
_READ = memoryview(bytearray(1 << 20))


def frame(payload: bytes, first: int = TEXT) -> bytes:
    """Return a client's frame."""
    size = len(payload)
    if size < 126:
        header = bytes((first, 0x80 | size))
    elif size < 65536:
        header = struct.pack("!BBH", first, 0x80 | 126, size)
    else:
        header = struct.pack("!BBQ", first, 0x80 | 127, size)
    return header + NO_MASK + payload


def operation(op: str, **fields: Any) -> bytes:
    """Return the frame of an operation."""
    return frame(json.dumps({"op": op, **fields}, separators=(",", ":")).encode())


class Client:
    """One connection to a hub, as the node of that name."""

    def __init__(self, port: int, node: str) -> None:
        """Connect."""
        self._node = node
        self._socket = connected(port, f"/?node={node}", PATIENCE_SECONDS)
        self._socket.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        self._data = bytearray()
        self._pongs = 0

    def fileno(self) -> int:
        """Return the socket's, for selectors."""
        return self._socket.fileno()

    def send(self, frames: bytes) -> None:
        """Send prepared frames."""
        try:
            self._socket.sendall(frames)
        except OSError as error:
            raise BenchError(f"{self._node} cannot send: {error}") from error

    def read(self) -> list[bytes]:
        """Wait for bytes; return the messages that are complete with them, maybe none."""
        try:
            size = self._socket.recv_into(_READ)
        except OSError as error:
            raise BenchError(f"{self._node} waits in vain: {error}") from error
        if not size:
            raise BenchError(f"{self._node} lost its connection")
        self._data += _READ[:size]
        return self._messages()

    def receive(self) -> list[bytes]:
        """Wait for a message; return it and those that came with it."""
        while True:
            if messages := self.read():
                return messages

    def settle(self) -> list[bytes]:
        """Wait until the hub has done all that it was asked for; return what came meanwhile."""
        pongs, messages = self._pongs, []
        self.send(frame(b"", PING))
        while self._pongs == pongs:
            messages += self.read()
        return messages

    def close(self) -> None:
        """Leave without a word."""
        self._socket.close()

    def __enter__(self) -> Self:
        """Do nothing; it is connected."""
        return self

    def __exit__(self, *failure: object) -> None:
        """Leave."""
        self.close()

    def _messages(self) -> list[bytes]:
        data, start, end = self._data, 0, len(self._data)
        found = []
        while end - start >= 2:
            payload, size = start + 2, data[start + 1]
            if size >= 126:
                payload += 2 if size == 126 else 8
                if end < payload:
                    break
                size = int.from_bytes(data[start + 2 : payload], "big")
            stop = payload + size
            if end < stop:
                break
            message = bytes(data[payload:stop])
            first = data[start]
            if first == PING:
                self.send(frame(message, PONG))
            elif first == PONG:
                self._pongs += 1
            elif first == CLOSE:
                raise BenchError(f"{self._node} was closed: {message[2:].decode()}")
            elif message.startswith(b'{"op":"status"'):
                raise BenchError(f"{self._node} is told: {message.decode()}")
            else:
                found.append(message)
            start = stop
        del data[:start]
        return found


@contextmanager
def crowd(port: int, size: int, name: str) -> Iterator[list[Client]]:
    """Connect so many clients, named by that name and a number."""
    with ExitStack() as stack:
        yield [stack.enter_context(Client(port, f"/{name}_{n}")) for n in range(size)]


def hear(clients: Collection[Client]) -> list[bytes]:
    """Wait until each of them has heard something; return all of it."""
    messages: list[bytes] = []
    silent = set(clients)
    deadline = time.monotonic() + PATIENCE_SECONDS
    with _selector(clients) as selector:
        while silent:
            ready = selector.select(deadline - time.monotonic())
            if not ready:
                raise BenchError(f"{len(silent)} of {len(clients)} clients wait in vain")
            for key, _ in ready:
                if news := key.data.read():
                    messages += news
                    silent.discard(key.data)
    return messages


def answer_pings(clients: Collection[Client]) -> None:
    """Read what is there, which nobody asked for but the hub's keepalive."""
    with _selector(clients) as selector:
        while ready := selector.select(0):
            for key, _ in ready:
                if news := key.data.read():
                    raise BenchError(f"an idle client hears {news[0].decode()[:200]}")


def _selector(clients: Iterable[Client]) -> selectors.BaseSelector:
    selector = selectors.DefaultSelector()
    for client in clients:
        selector.register(client, selectors.EVENT_READ, client)
    return selector
