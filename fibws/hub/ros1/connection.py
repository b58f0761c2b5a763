"""A TCPROS connection of a ROS 1 node to the hub: its header, and then a topic or a service."""

from __future__ import annotations

import asyncio
import logging
import socket
from collections.abc import Callable, Mapping
from typing import Protocol, cast

from fibws.errors import FibwsError
from fibws.hub.delivery.clock import Clock
from fibws.hub.errors import TcprosError
from fibws.hub.log.text import printable, shortened
from fibws.hub.ros1.tcpros import LENGTH, check_header_size, decode_header, encode_header

logger = logging.getLogger("fibws.hub")

CLOSE_TIMEOUT = 5.0
"""Seconds in which a peer must take what was written before the connection is closed."""
KEEPALIVE = {"TCP_KEEPIDLE": 60, "TCP_KEEPINTVL": 10, "TCP_KEEPCNT": 9}
"""When the system takes a silent peer for dead, as roscpp and rospy have it."""


def detect_dead_peer(transport: asyncio.Transport) -> None:
    """Let a connection end if the machine of its peer has vanished."""
    sock = transport.get_extra_info("socket")
    if sock is None or sock.family not in (socket.AF_INET, socket.AF_INET6):
        return
    sock.setsockopt(socket.SOL_SOCKET, socket.SO_KEEPALIVE, 1)
    for option, value in KEEPALIVE.items():
        if hasattr(socket, option):
            sock.setsockopt(socket.IPPROTO_TCP, getattr(socket, option), value)


def describe(transport: asyncio.Transport) -> str:
    """Return the ends of a connection, as getBusInfo of roscpp and rospy does."""
    own, peer = transport.get_extra_info("sockname"), transport.get_extra_info("peername")
    number = transport.get_extra_info("socket").fileno()
    ends = f"port {own[1]} to [{peer[0]}:{peer[1]} on socket {number}]"
    return f"TCPROS connection on {ends}"


class Handler(Protocol):
    """Uses a connection whose header has arrived."""

    @property
    def waiting_bytes(self) -> int:
        """Bytes that wait for the peer."""

    @property
    def incomplete_bytes(self) -> int:
        """Bytes of what came in part, or waits to be handled."""

    def shorten(self, size: int, least: int) -> None:
        """Drop the oldest messages until ``size`` bytes wait, or ``least`` messages."""

    def data_received(self, data: bytes) -> None:
        """Take bytes behind the header."""

    def pause_writing(self) -> None:
        """Wait: the peer reads slowly."""

    def resume_writing(self) -> None:
        """Continue."""

    def connection_lost(self) -> None:
        """Called when the connection has ended."""


class Acceptor(Protocol):
    """Takes the connections whose header has a certain field."""

    def accept(self, header: Mapping[str, str], connection: TcprosConnection) -> Handler | None:
        """Answer the header, and return what uses the connection; None if it is closed.

        Raises:
            TcprosError: the header is refused for this reason.
        """


class TcprosConnection(asyncio.Protocol):
    """An accepted connection.

    Args:
        acceptors: by the field of the header: ``topic`` or ``service``.
        timeout: seconds in which the header must arrive.
        closed: called once the connection has ended.
    """

    def __init__(
        self,
        acceptors: Mapping[str, Acceptor],
        clock: Clock,
        timeout: float,
        closed: Callable[[TcprosConnection], object],
    ) -> None:
        self.peer = ""
        """The address and the port of the other side."""
        self.hub_host = ""
        """The address by which it reached the hub."""
        self.transport: asyncio.Transport
        self.is_paused = False
        """Whether the peer reads slowly, so that nothing more should be written."""
        self._acceptors = acceptors
        self._clock = clock
        self._timeout = timeout
        self._closed = closed
        self._handler: Handler | None = None
        self._received = bytearray()

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        """Wait for the header."""
        # Not checked: uvloop's transports are not subclasses of asyncio's.
        self.transport = transport = cast(asyncio.Transport, transport)
        peer, local = transport.get_extra_info("peername"), transport.get_extra_info("sockname")
        self.peer = f"{peer[0]}:{peer[1]}" if peer else ""
        self.hub_host = local[0] if local else ""
        detect_dead_peer(transport)
        self._timer = self._clock.call_later(self._timeout, self._time_out)

    def data_received(self, data: bytes) -> None:
        """Take bytes of the header, or give them to the handler."""
        if self._handler is not None:
            self._handler.data_received(data)
            return
        self._received += data
        try:
            self._read_header()
        except FibwsError as error:
            self.refuse(str(error))

    def pause_writing(self) -> None:
        """Tell the handler that the peer reads slowly."""
        self.is_paused = True
        if self._handler is not None:
            self._handler.pause_writing()

    def resume_writing(self) -> None:
        """Tell the handler to continue."""
        self.is_paused = False
        if self._handler is not None:
            self._handler.resume_writing()

    def connection_lost(self, error: Exception | None) -> None:
        """End."""
        self._timer.cancel()
        handler, self._handler = self._handler, None
        if handler is not None:
            handler.connection_lost()
        self._closed(self)

    @property
    def waiting_bytes(self) -> int:
        """Bytes that wait for the peer, those that were written included."""
        waiting = self._handler.waiting_bytes if self._handler is not None else 0
        return waiting + self.transport.get_write_buffer_size()

    @property
    def incomplete_bytes(self) -> int:
        """Bytes of what came in part, or waits to be handled."""
        handled = self._handler.incomplete_bytes if self._handler is not None else 0
        return len(self._received) + handled

    def shorten(self, size: int, least: int) -> None:
        """Drop the oldest messages until ``size`` bytes wait, or ``least`` messages."""
        if self._handler is not None:
            self._handler.shorten(size, least)

    def answer(self, fields: Mapping[str, str]) -> None:
        """Send the header of the hub's side."""
        self.transport.write(encode_header(fields))

    def refuse(self, text: str) -> None:
        """Send an error in place of a header, and close; it is logged, too, as roscpp does."""
        logger.warning("%s: %s", self.peer, printable(text))
        self.answer({"error": shortened(text)})
        self.close()

    def close(self) -> None:
        """Close once the peer has taken what was written, or after some seconds."""
        self.transport.close()
        self._timer.cancel()
        self._timer = self._clock.call_later(CLOSE_TIMEOUT, self.transport.abort)

    def abort(self) -> None:
        """Close at once."""
        self.transport.abort()

    def _read_header(self) -> None:
        received = self._received
        if len(received) < LENGTH:
            return
        end = LENGTH + check_header_size(int.from_bytes(received[:LENGTH], "little"))
        if len(received) < end:
            return
        self._timer.cancel()
        header, rest = decode_header(bytes(received[LENGTH:end])), bytes(received[end:])
        self._received = bytearray()
        for field, acceptor in self._acceptors.items():
            if field in header:
                self._handler = acceptor.accept(header, self)
                if self.is_paused:
                    self.pause_writing()
                break
        else:
            raise TcprosError("missing required 'topic' or 'service' field")
        if rest and self._handler is not None:
            self._handler.data_received(rest)

    def _time_out(self) -> None:
        self.refuse(f"no connection header within {self._timeout:g} s")
