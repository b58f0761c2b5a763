"""Cheap rosbridge clients: they send prepared bytes and only split the bytes they receive."""

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

TIMEOUT_SECONDS = 10.0
"""Timeout of a read. Shorter than the hub's ping interval: a ping would restart the timeout."""
NO_MASK = bytes(4)
"""A masking key of zeros leaves the payload unchanged; the server still unmasks it."""
TEXT, BINARY, CLOSE, PING, PONG = 0x81, 0x82, 0x88, 0x89, 0x8A
"""The first bytes of frames."""
_READ = memoryview(bytearray(1 << 20))


def frame(payload: bytes, first: int = TEXT) -> bytes:
    """Return a masked WebSocket frame."""
    size = len(payload)
    if size < 126:
        header = bytes((first, 0x80 | size))
    elif size < 65536:
        header = struct.pack("!BBH", first, 0x80 | 126, size)
    else:
        header = struct.pack("!BBQ", first, 0x80 | 127, size)
    return header + NO_MASK + payload


def operation(op: str, **fields: Any) -> bytes:
    """Return the frame of a rosbridge operation."""
    return frame(json.dumps({"op": op, **fields}, separators=(",", ":")).encode())


class Client:
    """One connection to a hub."""

    def __init__(
        self, port: int, node: str, receive_buffer: int | None = None, subprotocol: str = ""
    ) -> None:
        """Connect under a node's name.

        Args:
            receive_buffer: bytes that the system may keep until they are read.
            subprotocol: the WebSocket subprotocol to offer; none for rosbridge.
        """
        self._node = node
        self._socket = connected(port, f"/?node={node}", TIMEOUT_SECONDS, subprotocol=subprotocol)
        if receive_buffer is not None:
            self._socket.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, receive_buffer)
        self._socket.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        self._data = bytearray()
        self._pongs = 0

    def fileno(self) -> int:
        """Return the socket's file descriptor, for selectors."""
        return self._socket.fileno()

    def send(self, frames: bytes) -> None:
        """Send prepared frames."""
        try:
            self._socket.sendall(frames)
        except OSError as error:
            raise BenchError(f"{self._node} cannot send: {error}") from error

    def read(self, most: int = len(_READ)) -> list[bytes]:
        """Wait for bytes, take at most that many; return the messages that they complete."""
        try:
            size = self._socket.recv_into(_READ, most)
        except OSError as error:
            raise BenchError(f"{self._node} received nothing: {error}") from error
        if not size:
            raise BenchError(f"{self._node} lost its connection")
        self._data += _READ[:size]
        return self._messages()

    def receive(self) -> list[bytes]:
        """Wait for a message; return it and those that arrived with it."""
        while True:
            if messages := self.read():
                return messages

    def settle(self) -> list[bytes]:
        """Wait until the hub has processed all operations; return the messages that arrive."""
        pongs, messages = self._pongs, []
        self.send(frame(b"", PING))
        while self._pongs == pongs:
            messages += self.read()
        return messages

    def close(self) -> None:
        """Close the socket without a closing handshake."""
        self._socket.close()

    def __enter__(self) -> Self:
        """Do nothing; the client is connected."""
        return self

    def __exit__(self, *failure: object) -> None:
        """Close the socket."""
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
                raise BenchError(f"{self._node} received a status: {message.decode()}")
            else:
                found.append(message)
            start = stop
        del data[:start]
        return found


@contextmanager
def connect_all(port: int, size: int, name: str) -> Iterator[list[Client]]:
    """Connect several clients, named after `name` and a number."""
    with ExitStack() as stack:
        yield [stack.enter_context(Client(port, f"/{name}_{n}")) for n in range(size)]


def receive_all(clients: Collection[Client]) -> list[bytes]:
    """Wait until each client has received a message; return all messages."""
    messages: list[bytes] = []
    silent = set(clients)
    deadline = time.monotonic() + TIMEOUT_SECONDS
    with _selector(clients) as selector:
        while silent:
            ready = selector.select(deadline - time.monotonic())
            if not ready:
                raise BenchError(f"{len(silent)} of {len(clients)} clients received nothing")
            for key, _ in ready:
                if received := key.data.read():
                    messages += received
                    silent.discard(key.data)
    return messages


def answer_pings(clients: Collection[Client]) -> None:
    """Answer the pings that have arrived; raise if anything else has."""
    with _selector(clients) as selector:
        while ready := selector.select(0):
            for key, _ in ready:
                if received := key.data.read():
                    raise BenchError(f"an idle client received {received[0].decode()[:200]}")


def _selector(clients: Iterable[Client]) -> selectors.BaseSelector:
    selector = selectors.DefaultSelector()
    for client in clients:
        selector.register(client, selectors.EVENT_READ, client)
    return selector
