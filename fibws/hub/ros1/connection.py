"""A TCPROS connection of a ROS 1 node to the hub: its header, and then a topic or a service."""

from __future__ import annotations

import asyncio
import logging
from collections.abc import Callable, Mapping
from typing import Protocol, cast

from fibws.errors import TcprosError
from fibws.hub.delivery.clock import Clock
from fibws.hub.ros1.tcpros import LENGTH, check_header_size, decode_header, encode_header

logger = logging.getLogger("fibws.hub")


class Handler(Protocol):
    """Uses a connection whose header has arrived."""

    def data_received(self, data: bytes) -> None:
        """Take bytes behind the header."""

    def pause_writing(self) -> None:
        """Wait: the peer reads slowly."""

    def resume_writing(self) -> None:
        """Continue."""

    def connection_lost(self) -> None:
        """Take note of the end."""


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
        self._timer = self._clock.call_later(self._timeout, self._time_out)

    def data_received(self, data: bytes) -> None:
        """Take bytes of the header, or give them to the handler."""
        if self._handler is not None:
            self._handler.data_received(data)
            return
        self._received += data
        try:
            self._read_header()
        except TcprosError as error:
            self.refuse(str(error))

    def pause_writing(self) -> None:
        """Tell the handler that the peer reads slowly."""
        if self._handler is not None:
            self._handler.pause_writing()

    def resume_writing(self) -> None:
        """Tell the handler to continue."""
        if self._handler is not None:
            self._handler.resume_writing()

    def connection_lost(self, error: Exception | None) -> None:
        """End."""
        self._timer.cancel()
        if self._handler is not None:
            self._handler.connection_lost()
        self._closed(self)

    def answer(self, fields: Mapping[str, str]) -> None:
        """Send the header of the hub's side."""
        self.transport.write(encode_header(fields))

    def refuse(self, text: str) -> None:
        """Send an error in place of a header, and close; it is logged, too, as roscpp does."""
        logger.warning("%s: %s", self.peer, text)
        self.answer({"error": text})
        self.transport.close()

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
                break
        else:
            raise TcprosError("missing required 'topic' or 'service' field")
        if rest and self._handler is not None:
            self._handler.data_received(rest)

    def _time_out(self) -> None:
        self.refuse(f"no connection header within {self._timeout:g} s")
