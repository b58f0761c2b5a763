"""Connections to the services of ROS 1 nodes (http://wiki.ros.org/ROS/TCPROS).

A call is a request in one frame; its answer is a byte, 1 or 0, and a frame with the response or the
error's text.
"""

from __future__ import annotations

import asyncio
import struct
from collections.abc import Mapping
from contextlib import suppress
from typing import NamedTuple, Self, TypeAlias
from urllib.parse import urlsplit

from fibws.hub.errors import CallFailed, TcprosError
from fibws.hub.ros1.tcpros import (
    LENGTH,
    check_header_size,
    decode_header,
    encode_header,
    frame,
)

CONNECT_TIMEOUT = 10.0
"""Seconds in which a node must accept a connection and send its header."""
TRIAL = 0.5
"""Seconds for which a service must keep its first connection after the response."""
LINGER = 2.0
"""Seconds for which a connection to a service is kept for the next call."""
BUFFERED = 2**20
"""Bytes that are buffered before reading pauses."""
INSTANT = 2**16
"""Bytes from which on a message takes longer than a millisecond to convert."""


Key: TypeAlias = tuple[tuple[str, str], ...]
"""The fields of the header that a connection was opened with."""


class Address(NamedTuple):
    """Where a service is."""

    host: str
    port: int

    @classmethod
    def of(cls, uri: str) -> Self:
        """Return the address in ``rosrpc://host:port``.

        Raises:
            ValueError: the URI is not one.
        """
        url = urlsplit(uri)
        if url.scheme != "rosrpc" or not url.hostname or not url.port:
            raise ValueError(f"invalid service URI {uri!r}, expected rosrpc://host:port")
        return cls(url.hostname, url.port)

    def __str__(self) -> str:
        return f"[{self.host}]:{self.port}" if ":" in self.host else f"{self.host}:{self.port}"


class ServiceConnection:
    """An open connection to one service.

    Attributes:
        header: the fields that the service has sent.
        calls: how many calls it has answered.
        is_persistent: whether the service was asked to keep it after a call.
    """

    def __init__(
        self,
        service: str,
        address: Address,
        reader: asyncio.StreamReader,
        writer: asyncio.StreamWriter,
    ) -> None:
        self.header: dict[str, str] = {}
        self.calls = 0
        self.is_persistent = False
        self._is_idle = True
        self._service = service
        self._address = address
        self._reader = reader
        self._writer = writer

    @classmethod
    async def open(cls, service: str, address: Address, header: Mapping[str, str]) -> Self:
        """Connect to a service, and exchange headers.

        Raises:
            CallFailed: it cannot be reached, or refuses.
        """
        try:
            async with asyncio.timeout(CONNECT_TIMEOUT):
                reader, writer = await asyncio.open_connection(*address, limit=BUFFERED)
                self = cls(service, address, reader, writer)
                self.is_persistent = header.get("persistent") == "1"
                try:
                    await self._exchange_headers(header)
                except BaseException:
                    self.close()
                    raise
        except TimeoutError:
            raise _unavailable(service, address, "no answer") from None
        except (OSError, UnicodeError, EOFError, TcprosError) as error:
            raise _unavailable(service, address, _reason(error)) from None
        return self

    async def call(self, request: bytes, max_size: int) -> bytes:
        """Send a request, and return the response.

        Raises:
            CallFailed: the service fails, is lost, or its response is too large.
        """
        self._is_idle = False
        try:
            self._writer.write(frame(len(request)))
            self._writer.write(request)
            await self._writer.drain()
            is_ok, size = struct.unpack("<BI", await self._reader.readexactly(5))
            if size > max_size:
                text = f"service [{self._service}] responded with {size} bytes, the limit is"
                raise CallFailed(f"{text} {max_size} (--max-message-size)", "limit_reached")
            body = await self._reader.readexactly(size)
        except (OSError, EOFError) as error:
            text = f"lost {self._address} before its response: {_reason(error)}"
            raise CallFailed(f"service [{self._service}]: {text}", "server_lost") from None
        self.calls += 1
        self._is_idle = True
        if not is_ok:
            text = body.decode("utf-8", "replace")
            text = text or f"service [{self._service}] responded with an error"
            raise CallFailed(text, "server_failed")
        return body

    @property
    def is_reusable(self) -> bool:
        """Whether it can be used for another call: it is open, and no call is under way."""
        return self._is_idle and not (self._reader.at_eof() or self._writer.is_closing())

    def close(self) -> None:
        """Close it at once."""
        with suppress(RuntimeError):  # The loop is closed.
            self._writer.transport.abort()

    async def _exchange_headers(self, header: Mapping[str, str]) -> None:
        self._writer.write(encode_header(header))
        size = int.from_bytes(await self._reader.readexactly(LENGTH), "little")
        self.header = decode_header(await self._reader.readexactly(check_header_size(size)))
        if error := self.header.get("error"):
            raise CallFailed(f"service [{self._service}] refused: {error}", "server_failed")


class ServiceConnections:
    """The connections to one service, of which idle ones are kept for `LINGER` seconds.

    A call on a new connection takes ten times as long. A service keeps a connection after a call if
    the client asks for that, but some services close each one. A request that is lost by that may
    have been carried out, and must not be sent again. So the first connection is used for another
    call only if the service has kept it for `TRIAL` seconds; until then, and for services that keep
    none, each call has a connection of its own.
    """

    def __init__(self, service: str, address: Address) -> None:
        self._service = service
        self._address = address
        self._idle: dict[Key, list[tuple[ServiceConnection, asyncio.TimerHandle]]] = {}
        self._is_closed = False
        self._keeps: bool | None = None
        """Whether the service keeps connections; None until the trial of the first one ends."""
        self._is_trying = False

    async def call(self, header: Mapping[str, str], request: bytes, max_size: int) -> bytes:
        """Send a request, once, and return the response.

        Raises:
            CallFailed: as `ServiceConnection.open` and `ServiceConnection.call`.
        """
        key = tuple(sorted(header.items()))
        connection = self._take(key) or await self._open(header)
        try:
            return await connection.call(request, max_size)
        except CallFailed as error:
            if error.code == "server_lost" and connection.calls:
                self._keeps = False
            raise
        finally:
            self._give_back(key, connection)

    def close(self) -> None:
        """Close those that are idle, and keep none from now on."""
        self._is_closed = True
        while self._idle:
            connection, timer = self._pop(next(iter(self._idle)), 0)
            timer.cancel()
            connection.close()

    async def _open(self, header: Mapping[str, str]) -> ServiceConnection:
        if self._keeps is False or self._is_trying:
            return await ServiceConnection.open(self._service, self._address, header)
        self._is_trying = is_trial = self._keeps is None
        header = {**header, "persistent": "1"}
        try:
            return await ServiceConnection.open(self._service, self._address, header)
        except BaseException:
            if is_trial:
                self._is_trying = False
            raise

    def _take(self, key: Key) -> ServiceConnection | None:
        """Return a connection with a header, if one is idle."""
        while self._keeps and (idle := self._idle.get(key)):
            connection, timer = self._pop(key, len(idle) - 1)
            timer.cancel()
            if connection.is_reusable:
                return connection
            connection.close()
        return None

    def _give_back(self, key: Key, connection: ServiceConnection) -> None:
        """Keep a connection for other calls, or close it if it is of no use."""
        is_trial = connection.is_persistent and self._keeps is None
        if self._is_closed or not connection.is_persistent or not connection.is_reusable:
            connection.close()
            if is_trial:
                self._is_trying = False
                if connection.calls:
                    self._keeps = False
            return
        delay, end = (TRIAL, self._end_trial) if is_trial else (LINGER, self._expire)
        timer = asyncio.get_running_loop().call_later(delay, end, key)
        self._idle.setdefault(key, []).append((connection, timer))

    def _end_trial(self, key: Key) -> None:
        connection, _ = self._pop(key, 0)
        self._is_trying = False
        self._keeps = connection.is_reusable
        self._give_back(key, connection)

    def _expire(self, key: Key) -> None:
        self._pop(key, 0)[0].close()  # The oldest.

    def _pop(self, key: Key, index: int) -> tuple[ServiceConnection, asyncio.TimerHandle]:
        idle = self._idle[key]
        found = idle.pop(index)
        if not idle:
            del self._idle[key]
        return found


def _unavailable(service: str, address: Address, reason: str) -> CallFailed:
    """Return the error for a service that cannot be reached."""
    text = f"service [{service}] unavailable: cannot reach {address}: {reason}"
    return CallFailed(text, "server_lost")


def _reason(error: Exception) -> str:
    if isinstance(error, EOFError):
        return "the connection was closed"
    if isinstance(error, OSError) and error.strerror:
        return error.strerror
    return str(error)
