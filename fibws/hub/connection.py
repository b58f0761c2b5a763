"""A client's connection: bytes in, messages to the session, frames out.

An asyncio protocol around websockets' sans-I/O `ServerProtocol`. A message is handled within the
callback that read it; there is no task and no timer for a connection, only `Connection.sweep`,
which the server calls for all of them once a second.
"""

from __future__ import annotations

import asyncio
import http
import logging
import socket
import sys
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import cast

from websockets.frames import Frame, Opcode
from websockets.http11 import Request
from websockets.protocol import State
from websockets.server import ServerProtocol

from fibws.errors import InvalidUtf8
from fibws.hub.gate import Gate, node_name
from fibws.hub.graph.graph import Graph
from fibws.hub.liveness import Liveness
from fibws.hub.logtext import printable
from fibws.hub.outbox import Flusher, Outbox
from fibws.hub.rosapi.nodes import OwnNodes
from fibws.hub.session.session import Session
from fibws.hub.settings import KIB, Settings
from fibws.hub.splitter import Splitter
from fibws.protocol.closing import FRAGMENTS, INVALID_UTF8, OVERFULL, Closing

logger = logging.getLogger("fibws.hub")
_library_logger = logging.getLogger("fibws.hub.websockets")
_library_logger.setLevel(logging.WARNING)

HIGH_WATER = 64 * KIB
"""Bytes in a transport's buffer at which its client counts as slow."""
MAX_FRAGMENTS = 4096
"""Frames that one fragmented message may have: empty ones do not count towards its size."""
DROP_REPORT_INTERVAL = 10.0
"""Seconds between two log lines about one client's dropped messages."""


@dataclass(frozen=True, slots=True)
class Shared:
    """What all connections of one hub use together.

    ``small`` and ``large`` are the buffers that sockets are read into: what is read is used up
    within the same callback, so that one buffer serves all. A small one makes a flooding publisher
    take turns with the others; the large one is for connections that are sending a large frame.
    """

    settings: Settings
    gate: Gate
    graph: Graph
    loop: asyncio.AbstractEventLoop
    flusher: Flusher
    own: OwnNodes
    opened: Callable[[Connection], None]
    lost: Callable[[Connection], None]
    small: memoryview = field(default_factory=lambda: memoryview(bytearray(16 * KIB)))
    large: memoryview = field(default_factory=lambda: memoryview(bytearray(256 * KIB)))


class Connection(asyncio.BufferedProtocol):
    """One client's connection, from the socket's opening to its end."""

    __slots__ = (
        "_binary",
        "_fragments",
        "_head",
        "_left",
        "_liveness",
        "_pong_bytes",
        "_protocol",
        "_reported",
        "_reported_at",
        "_shared",
        "_splitter",
        "_transport",
        "address",
        "outbox",
        "peer",
        "session",
    )

    def __init__(self, shared: Shared) -> None:
        self._shared = shared
        self._protocol = ServerProtocol(
            max_size=shared.settings.max_message_size, logger=_library_logger
        )
        self._transport: asyncio.Transport
        self._liveness = Liveness(shared.settings, shared.loop.time())
        self._head: bytes | None = b""
        """The last bytes of a request that is not complete yet."""
        self._splitter: Splitter
        self._fragments: list[bytes] = []
        self._binary = False
        self._pong_bytes = 0
        self._left = False
        self._reported = 0
        self._reported_at = float("-inf")
        self.outbox: Outbox
        self.session: Session | None = None
        self.address = ""
        self.peer = ""

    # asyncio's calls.

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        self._transport = transport = cast(asyncio.Transport, transport)
        transport.set_write_buffer_limits(HIGH_WATER)
        sock = transport.get_extra_info("socket")
        if hasattr(socket, "TCP_NOTSENT_LOWAT"):
            # Else the kernel keeps megabytes of messages that a slow client will read when stale.
            sock.setsockopt(socket.IPPROTO_TCP, socket.TCP_NOTSENT_LOWAT, HIGH_WATER)
        peer = transport.get_extra_info("peername")
        # Most come from few addresses, and there may be thousands.
        self.address = sys.intern(peer[0]) if peer else "unknown"
        self.peer = f"{peer[0]}:{peer[1]}" if peer else "unknown"
        self._shared.opened(self)

    def get_buffer(self, sizehint: int) -> memoryview:
        if self._head is None and self._splitter.missing > len(self._shared.small):
            return self._shared.large
        return self._shared.small

    def buffer_updated(self, nbytes: int) -> None:
        buffer = self.get_buffer(nbytes)
        data = bytes(buffer[:nbytes])
        if nbytes == len(buffer):
            # There is more: let the other connections have their turn first.
            self._transport.pause_reading()
            self._shared.loop.call_soon(self._resume_reading)
        if self._head is None:
            self._splitter.receive(data)
        else:
            self._shake_hands(data)
        if self.session is not None and self.outbox.overfull:
            self._fail(OVERFULL)

    def eof_received(self) -> bool:
        if self._head is None:
            self._splitter.end()
        self._protocol.receive_eof()
        self._send()
        return False

    def connection_lost(self, exc: Exception | None) -> None:
        try:
            self._leave()
        finally:
            self._shared.lost(self)
        if self.session is not None:
            self._report_drops(float("inf"))
            logger.info("%s has left.", self.session.node)

    def pause_writing(self) -> None:
        self._liveness.paused(self._shared.loop.time(), self._transport.get_write_buffer_size())
        if self.session is not None:
            self.outbox.pause()

    def resume_writing(self) -> None:
        self._liveness.resumed()
        self._pong_bytes = 0
        if self.session is not None:
            self.outbox.resume()

    def _resume_reading(self) -> None:
        if not self._transport.is_closing():
            self._transport.resume_reading()

    # The handshake.

    def _shake_hands(self, data: bytes) -> None:
        """Hand the library the request's head and no byte more.

        It would act on frames sent behind the request before that is accepted.
        """
        assert self._head is not None
        seen = self._head + data
        end = seen.find(b"\r\n\r\n")
        if end < 0:
            self._head = seen[-3:]
            self._feed(data)
            return
        rest = seen[end + 4 :]
        self._head = None
        self._splitter = Splitter(
            self._on_text, self._feed, max_size=self._shared.settings.max_message_size
        )
        if not self._shared.settings.fast_framing:
            self._splitter.give_up()
        self._feed(data[: len(data) - len(rest)])
        if rest and self._protocol.state is State.OPEN:
            self._splitter.receive(rest)

    def _on_request(self, request: Request) -> None:
        response = self._shared.gate.answer(request) or self._protocol.accept(request)
        self._protocol.send_response(response)
        if response.status_code == http.HTTPStatus.FORBIDDEN:
            # A browser does not show its page why it was refused.
            logger.warning("Refused %s: %s", self.peer, printable(bytes(response.body).decode()))
        if self._protocol.state is not State.OPEN:
            return
        shared = self._shared
        self.outbox = Outbox(
            self._transport.write,
            self._transport.abort,
            shared.flusher,
            max_bytes=shared.settings.max_queued_bytes,
        )
        self.session = Session(
            node_name(request.path),
            shared.graph,
            self.outbox,
            shared.loop,
            shared.settings,
            self.close,
        )
        self._liveness.opened()
        shared.own.connected(self)
        logger.info("%s has connected from %s.", self.session.node, self.peer)

    # Reading.

    def _feed(self, data: bytes) -> None:
        """Let the library read, and do what it says."""
        if self._protocol.state is State.CLOSED:
            return
        self._protocol.receive_data(data)
        for event in self._protocol.events_received():
            if isinstance(event, Request):
                self._on_request(event)
            elif isinstance(event, Frame):
                self._on_frame(event)
        if self._protocol.state is not State.OPEN and self._head is None:
            self._splitter.give_up()
            self._leave()
        self._send()

    def _on_frame(self, frame: Frame) -> None:
        if frame.opcode is Opcode.PONG:
            self._liveness.ponged()
            self._shared.own.ponged(self, bytes(frame.data))
        elif frame.opcode in (Opcode.TEXT, Opcode.BINARY, Opcode.CONT):
            self._on_data(frame)

    def _on_data(self, frame: Frame) -> None:
        """Put fragments together.

        The library has read on: what came before a close, or before an error, still counts.
        """
        if self._left:
            return
        if len(self._fragments) == MAX_FRAGMENTS:
            self._fail(FRAGMENTS)
            return
        if frame.opcode is not Opcode.CONT:
            self._binary = frame.opcode is Opcode.BINARY
        self._fragments.append(bytes(frame.data))
        self._splitter.fragmented = not frame.fin
        if frame.fin:
            message, self._fragments = b"".join(self._fragments), []
            on_message = self._on_binary if self._binary else self._on_text
            on_message(message)

    def _on_text(self, text: bytes) -> None:
        assert self.session is not None
        self._receive(self.session.receive, text)

    def _on_binary(self, data: bytes) -> None:
        assert self.session is not None
        self._receive(self.session.receive_binary, data)

    def _receive(self, receive: Callable[[bytes], None], data: bytes) -> None:
        try:
            receive(data)
        except InvalidUtf8:
            self._fail(INVALID_UTF8)
        except Exception:
            # An exception here would end the connection of a client that did nothing wrong.
            logger.exception("%s: an operation failed.", self.name)

    # Writing.

    def _send(self) -> None:
        """Write what the library wants written."""
        for data in self._protocol.data_to_send():
            if data:
                self._transport.write(data)
                self._count_pongs(len(data))
            else:
                self._transport.write_eof()
                self._liveness.closing(self._shared.loop.time())

    def _count_pongs(self, size: int) -> None:
        """Cut off who sends pings without end and reads no pong: the outbox cannot bound those."""
        if self.session is not None and self.outbox.paused:
            self._pong_bytes += size
            if self._pong_bytes > HIGH_WATER:
                self._transport.abort()

    def ping(self, data: bytes) -> None:
        """Send a ping; `OwnNodes.ponged` is given what its pong brings back."""
        if self._protocol.state is State.OPEN:
            self._protocol.send_ping(data)
            self._send()

    def close(self, closing: Closing) -> None:
        """Close in good order; a client that does not answer is cut off by a later sweep."""
        if self._protocol.state is State.OPEN:
            logger.info("%s is closed: %s.", self.name, closing.reason)
            self._leave()
            self._protocol.send_close(closing.code, closing.reason)
            self._liveness.closing(self._shared.loop.time())
            self._splitter.give_up()
            self._send()
        elif self._protocol.state is State.CONNECTING:
            self._transport.abort()

    def abort(self) -> None:
        """Cut the connection off."""
        self._transport.abort()

    def _fail(self, closing: Closing) -> None:
        """Close because of what the client did or left undone."""
        if self._protocol.state is not State.OPEN:
            return
        logger.warning("%s is closed: %s.", self.name, closing.reason)
        self._leave()
        self._protocol.fail(closing.code, closing.reason)
        self._splitter.give_up()
        self._send()

    def _leave(self) -> None:
        """Let the client's registrations go; what it was sent until now still goes out."""
        if self.session is not None and not self._left:
            self._left = True
            self.session.leave()
            self.outbox.flush()
            self.outbox.close()

    @property
    def name(self) -> str:
        """How the log calls the client."""
        return self.session.node if self.session is not None else self.peer

    # Once a second.

    def sweep(self, now: float, late: float) -> None:
        """Do what is overdue; the sweep itself is ``late`` by so many seconds."""
        self._liveness.excuse(late)
        if self.session is not None:
            self._report_drops(now)
            if self.outbox.overfull:
                self._fail(OVERFULL)
        verdict = self._liveness.verdict(now, self._transport.get_write_buffer_size())
        if verdict == "abort":
            self._transport.abort()
        elif verdict == "ping":
            self._protocol.send_ping(b"")
            self._send()
        elif verdict is not None:
            self._fail(verdict)

    def _report_drops(self, now: float) -> None:
        new = self.outbox.dropped - self._reported
        if new and now - self._reported_at >= DROP_REPORT_INTERVAL:
            self._reported = self.outbox.dropped
            self._reported_at = now
            logger.warning(
                "%s reads too slowly: %d messages dropped, %d in all.",
                self.name,
                new,
                self.outbox.dropped,
            )
