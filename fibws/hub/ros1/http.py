"""XML-RPC over HTTP/1.1: the calls that ROS 1 nodes make, and those that the hub makes to them."""

from __future__ import annotations

import asyncio
import logging
import os
from collections.abc import Awaitable, Callable, Iterable, Sequence
from contextlib import suppress
from http import HTTPStatus
from time import perf_counter
from typing import Any, NamedTuple, TypeAlias, cast
from urllib.parse import urlsplit

import h11

from fibws.errors import NodeUnreachable, XmlRpcError
from fibws.hub.ros1.xmlrpc import CallParser, iter_response, write_call, write_fault

logger = logging.getLogger("fibws.hub")

SLICE = 16 * 1024
"""Bytes of XML that are parsed at once, in about a millisecond."""
TURN = 0.002
"""Seconds after which a long answer lets others have their turn."""
IDLE_TIMEOUT = 60.0
"""Seconds for which a connection is kept that sends nothing."""
BODY_TIMEOUT = 30.0
"""Seconds in which a request must arrive."""
MOST_UNREAD = 256 * 1024
"""Bytes that are buffered before reading pauses."""
CALL_TIMEOUT = 3.0
"""Seconds in which a node must answer a call, as at the real master."""
MOST_CALLS = 64
"""Calls to nodes at the same time."""
MOST_RESPONSE = 4 * 1024 * 1024
"""Bytes of a node's response."""
FIRST_RETRY, LONGEST_RETRY = 1.0, 30.0
"""Seconds before a notification that failed is sent again."""
NOT_POST = (
    b"This is a ROS master, which programs reach by XML-RPC: export ROS_MASTER_URI=http://%b/\n"
)


class Caller(NamedTuple):
    """Where a call comes from."""

    host: str
    """The caller's IP address."""
    hub_host: str
    """The hub's address by which it reached the hub."""


Answer: TypeAlias = Callable[[str, str, list[Any], Caller], Awaitable[object]]
"""Returns the value for the path, the method and the parameters of a call; raises `XmlRpcError`."""


class XmlRpcConnection(asyncio.Protocol):
    """One connection of a caller, with one call after the other.

    Args:
        answer: makes the responses.
        max_body: most bytes of a call.
        closed: called once the connection has ended.
    """

    def __init__(
        self, answer: Answer, max_body: int, closed: Callable[[XmlRpcConnection], object]
    ) -> None:
        self._answer = answer
        self._max_body = max_body
        self._closed = closed
        self._http = h11.Connection(h11.SERVER)
        self._unread = 0
        self._transport: asyncio.Transport
        self._caller: Caller
        self._arrived: asyncio.Future[None] | None = None
        self._task: asyncio.Task[None]
        self._writable = asyncio.Event()
        self._writable.set()

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        """Begin to serve the caller."""
        # Not checked: uvloop's transports are not subclasses of asyncio's.
        self._transport = transport = cast(asyncio.Transport, transport)
        peer, local = transport.get_extra_info("peername"), transport.get_extra_info("sockname")
        self._caller = Caller(peer[0] if peer else "", local[0] if local else "")
        self._task = asyncio.get_running_loop().create_task(self._serve())

    def data_received(self, data: bytes) -> None:
        """Take bytes of a call."""
        self._http.receive_data(data)
        self._unread += len(data)
        if self._unread > MOST_UNREAD:
            self._transport.pause_reading()
        self._wake()

    def eof_received(self) -> bool:
        """Keep the connection until the call is answered."""
        with suppress(h11.RemoteProtocolError):
            self._http.receive_data(b"")
        self._wake()
        return True

    def pause_writing(self) -> None:
        """Wait for a slow reader."""
        self._writable.clear()

    def resume_writing(self) -> None:
        """Continue."""
        self._writable.set()

    def connection_lost(self, error: Exception | None) -> None:
        """End."""
        self._task.cancel()
        self._closed(self)

    def abort(self) -> None:
        """Close the connection at once."""
        self._transport.abort()

    def _wake(self) -> None:
        if self._arrived is not None and not self._arrived.done():
            self._arrived.set_result(None)

    async def _serve(self) -> None:
        try:
            while await self._serve_call():
                self._http.start_next_cycle()
        except (h11.RemoteProtocolError, h11.LocalProtocolError) as error:
            await self._refuse(400, str(error).encode())
        except TimeoutError:
            pass
        except Exception:
            logger.exception("%s: an XML-RPC call failed.", self._caller.host)
        finally:
            self._transport.close()

    async def _serve_call(self) -> bool:
        """Answer one call; return whether another one may follow."""
        request = await self._next_event(IDLE_TIMEOUT)
        if not isinstance(request, h11.Request):
            return False
        if request.method != b"POST":
            await self._refuse(405, NOT_POST % self._host(request), (b"Allow", b"POST"))
            return False
        size = next((value for name, value in request.headers if name == b"content-length"), None)
        if size is None:
            await self._refuse(411, b"A Content-Length is needed\n")
            return False
        if int(size) > self._max_body:
            await self._refuse(413, b"The limit of a call is %d bytes\n" % self._max_body)
            return False
        parser, fault = CallParser(), ""
        async with asyncio.timeout(BODY_TIMEOUT):
            while not isinstance(event := await self._next_event(None), h11.EndOfMessage):
                if not isinstance(event, h11.Data):
                    return False
                try:
                    if not fault:
                        await self._feed(parser, event.data)
                except XmlRpcError as error:
                    fault = str(error)
        await self._respond(await self._body(parser, request.target.decode("latin-1"), fault))
        return self._http.our_state is h11.DONE and self._http.their_state is h11.DONE

    async def _feed(self, parser: CallParser, data: bytes) -> None:
        if len(data) <= SLICE:
            parser.feed(bytes(data))
            return
        for start in range(0, len(data), SLICE):
            parser.feed(bytes(data[start : start + SLICE]))
            await asyncio.sleep(0)

    async def _body(self, parser: CallParser, path: str, fault: str) -> bytes:
        try:
            if fault:
                raise XmlRpcError(fault)
            method, params = parser.call()
            value = await self._answer(path, method, params, self._caller)
            return await written(iter_response(value))
        except XmlRpcError as error:
            return write_fault(1, str(error))

    async def _next_event(self, timeout: float | None) -> object:
        while (event := self._http.next_event()) is h11.NEED_DATA:
            self._unread = 0
            self._transport.resume_reading()
            self._arrived = asyncio.get_running_loop().create_future()
            async with asyncio.timeout(timeout):
                await self._arrived
        return event

    async def _respond(self, body: bytes) -> None:
        await self._send(200, body, (b"Content-Type", b"text/xml"))

    async def _refuse(self, status: int, text: bytes, *headers: tuple[bytes, bytes]) -> None:
        if self._http.our_state in (h11.IDLE, h11.SEND_RESPONSE):
            headers = (*headers, (b"Content-Type", b"text/plain"), (b"Connection", b"close"))
            await self._send(status, text, *headers)

    async def _send(self, status: int, body: bytes, *headers: tuple[bytes, bytes]) -> None:
        # roscpp finds the length only with this spelling, and one space.
        length = (b"Content-length", b"%d" % len(body))
        reason = HTTPStatus(status).phrase.encode()
        response = h11.Response(status_code=status, headers=[*headers, length], reason=reason)
        send = self._http.send
        parts = (send(response), send(h11.Data(body)), send(h11.EndOfMessage()))
        self._transport.write(b"".join(part for part in parts if part))
        await self._writable.wait()

    @staticmethod
    def _host(request: h11.Request) -> bytes:
        return next((value for name, value in request.headers if name == b"host"), b"HOST:11311")


async def written(pieces: Iterable[bytes]) -> bytes:
    """Join the pieces of a long text, letting others have their turn meanwhile."""
    parts, until = [], perf_counter() + TURN
    for piece in pieces:
        parts.append(piece)
        if perf_counter() > until:
            await asyncio.sleep(0)
            until = perf_counter() + TURN
    return b"".join(parts)


class NodeCalls:
    """The calls that the hub makes to the XML-RPC servers of ROS 1 nodes.

    Args:
        failed: takes the URI of each node whose notification failed, and what failed.
    """

    def __init__(
        self, failed: Callable[[str, NodeUnreachable], object] = lambda uri, error: None
    ) -> None:
        self._failed = failed
        self._room = asyncio.Semaphore(MOST_CALLS)
        self._notes: dict[str, dict[object, tuple[str, Sequence[object]]]] = {}
        """By URI: the notifications that are to be sent, the newest of each key."""
        self._tasks: dict[str, asyncio.Task[None]] = {}

    async def call(
        self, uri: str, method: str, *params: object, timeout: float = CALL_TIMEOUT
    ) -> Any:
        """Call a method of a node, and return the third part of its answer, the value.

        Raises:
            NodeUnreachable: it does not answer in time, or not with HTTP.
            XmlRpcError: it answers with a fault, or says that the call has failed.
        """
        answer = await self._call(uri, method, params, timeout)
        match answer:
            case [1, _, value]:
                return value
            case [int(), str() as text, _]:
                raise XmlRpcError(f"{uri} {method}: {text}")
        raise XmlRpcError(f"{uri} {method}: expected [code, text, value], got {answer!r}"[:500])

    def notify(self, uri: str, key: object, method: str, *params: object) -> None:
        """Call a method of a node soon, and again later for as long as it does not answer.

        Args:
            key: of notifications with the same key, only the newest is sent.
        """
        self._notes.setdefault(uri, {})[key] = (method, params)
        if uri not in self._tasks:
            task = asyncio.get_running_loop().create_task(self._notify(uri))
            self._tasks[uri] = task
            task.add_done_callback(lambda _: self._tasks.pop(uri, None))

    def forget(self, uri: str) -> None:
        """Send a node no more notifications."""
        self._notes.pop(uri, None)
        task = self._tasks.get(uri)
        if task is not None:
            task.cancel()

    async def close(self) -> None:
        """End all notifications."""
        tasks = list(self._tasks.values())
        for task in tasks:
            task.cancel()
        await asyncio.gather(*tasks, return_exceptions=True)

    async def _notify(self, uri: str) -> None:
        delay = FIRST_RETRY
        while notes := self._notes.get(uri):
            key, (method, params) = next(iter(notes.items()))
            try:
                await self._call(uri, method, params, CALL_TIMEOUT)
            except NodeUnreachable as error:
                self._failed(uri, error)
                await asyncio.sleep(delay)
                delay = min(2 * delay, LONGEST_RETRY)
                continue
            except XmlRpcError as error:
                logger.debug("%s: %s", uri, error)
            delay = FIRST_RETRY
            if notes.get(key) == (method, params):  # Else there is a newer one.
                del notes[key]
        self._notes.pop(uri, None)

    async def _call(self, uri: str, method: str, params: Iterable[object], timeout: float) -> Any:
        try:
            async with self._room, asyncio.timeout(timeout):
                return await _post(uri, write_call(method, params))
        except TimeoutError:
            raise NodeUnreachable(uri, f"no answer within {timeout:g} s") from None
        except (OSError, UnicodeError) as error:
            raise NodeUnreachable(uri, _reason(error)) from None
        except (h11.RemoteProtocolError, ValueError) as error:
            raise NodeUnreachable(uri, f"not an XML-RPC server: {error}") from None


async def _post(uri: str, body: bytes) -> Any:
    url = urlsplit(uri)
    host, port = url.hostname or "", url.port or 80
    reader, writer = await asyncio.open_connection(host, port)
    try:
        http = h11.Connection(h11.CLIENT)
        request = h11.Request(
            method="POST",
            target=url.path or "/",
            headers=[
                ("Host", f"{host}:{port}"),
                ("User-Agent", "fibws"),
                ("Content-Type", "text/xml"),
                ("Content-length", str(len(body))),
                ("Connection", "close"),
            ],
        )
        sent = (http.send(request), http.send(h11.Data(body)), http.send(h11.EndOfMessage()))
        writer.write(b"".join(part for part in sent if part))
        parser, room = CallParser(), MOST_RESPONSE
        while not isinstance(event := http.next_event(), h11.EndOfMessage):
            if event is h11.NEED_DATA:
                http.receive_data(await reader.read(SLICE))
            elif isinstance(event, h11.Response) and event.status_code != 200:
                raise h11.RemoteProtocolError(f"HTTP status {event.status_code}")
            elif isinstance(event, h11.Data):
                room -= len(event.data)
                if room < 0:
                    raise h11.RemoteProtocolError(f"more than {MOST_RESPONSE} bytes")
                parser.feed(bytes(event.data))
            elif isinstance(event, h11.ConnectionClosed):
                raise h11.RemoteProtocolError("the connection was closed")
        return parser.response()
    finally:
        writer.close()


def _reason(error: Exception) -> str:
    """Return what failed, without Python's numbers."""
    if isinstance(error, OSError) and error.errno is not None and error.errno > 0:
        return os.strerror(error.errno)
    return getattr(error, "strerror", None) or str(error)
