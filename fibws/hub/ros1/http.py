"""XML-RPC over HTTP/1.1: the calls that ROS 1 nodes make, and those that the hub makes to them."""

from __future__ import annotations

import asyncio
import logging
import os
from collections import OrderedDict
from collections.abc import Awaitable, Callable, Coroutine, Iterable, Sequence
from http import HTTPStatus
from itertools import chain
from time import perf_counter
from typing import Any, NamedTuple, TypeAlias, cast
from urllib.parse import urlsplit

import h11

from fibws.hub.errors import NodeUnreachable, XmlRpcError
from fibws.hub.foreign.worklist import TURN
from fibws.hub.ros1.xmlrpc import CallParser, iter_response, write_call, write_fault

logger = logging.getLogger("fibws.hub")

SLICE = 4 * 1024
"""Bytes of XML that are parsed at once, in about half a millisecond."""
SMALL = 8 * 1024
"""Bytes of a call that is served at once."""
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
MOST_HEAD = 16 * 1024
"""Bytes of a request's head."""
ONCE = {"content-length", "host", "origin"}
"""Headers that a request may have once only."""
NOT_POST = (
    "This is a ROS master, which programs reach by XML-RPC: export ROS_MASTER_URI=http://{host}/"
)
RESPONSE = b"HTTP/1.1 200 OK\r\nContent-Type: text/xml\r\nContent-length: %d\r\n%b\r\n"


class XmlRpcCaller(NamedTuple):
    """Where a call comes from."""

    host: str
    """The caller's IP address."""
    hub_host: str
    """The hub's address by which it reached the hub."""
    size: int = 0
    """The bytes of the call."""


Refusal: TypeAlias = Callable[[str | None, str | None, XmlRpcCaller], str | None]
"""Returns why a request with these headers ``Origin`` and ``Host`` is refused; None if it is not.
A header that the request lacks is None."""
Answer: TypeAlias = Callable[[str, str, list[Any], XmlRpcCaller], object]
"""Returns the value for the path, the method and the parameters of a call, or an awaitable of it if
that takes a while; raises `XmlRpcError`."""


class _Head(NamedTuple):
    """The head of a request."""

    first: str
    """The request line."""
    fields: dict[str, str]
    """The headers, by their names in lower case."""


class _Request(NamedTuple):
    """The head of a call."""

    path: str
    length: int
    is_last: bool
    """Whether the connection ends after it."""


class _RequestRefused(Exception):
    """A request is refused with a status, a text and a header or none."""

    def __init__(self, status: int, text: str, header: str = "") -> None:
        super().__init__(text)
        self.status = status
        self.header = header


class XmlRpcConnection(asyncio.Protocol):
    """One connection of a caller, with one call after the other (RFC 9112).

    A small call is answered at once; one that takes a while is served by a task, which lets others
    have their turn.

    Args:
        answer: makes the responses.
        refusal: decides on web pages.
        max_body: most bytes of a call.
        closed: called once the connection has ended.
    """

    def __init__(
        self,
        answer: Answer,
        refusal: Refusal,
        max_body: int,
        closed: Callable[[XmlRpcConnection], object],
    ) -> None:
        self._answer = answer
        self._refusal = refusal
        self._max_body = max_body
        self._closed = closed
        self._received = bytearray()
        self._parsed = 0
        """Bytes of a large call that its values were read from."""
        self._request: _Request | None = None
        """The head of the call that is arriving."""
        self._arrived: asyncio.Future[None] | None = None
        self._has_ended = False
        self._task: asyncio.Task[None] | None = None
        """Serves a call that takes a while."""
        self._transport: asyncio.Transport
        self._caller: XmlRpcCaller
        self._loop: asyncio.AbstractEventLoop
        self._timer: asyncio.TimerHandle
        self._writable = asyncio.Event()
        self._writable.set()

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        """Begin to serve the caller."""
        # Not checked: uvloop's transports are not subclasses of asyncio's.
        self._transport = transport = cast(asyncio.Transport, transport)
        peer, local = transport.get_extra_info("peername"), transport.get_extra_info("sockname")
        self._caller = XmlRpcCaller(peer[0] if peer else "", local[0] if local else "")
        self._loop = asyncio.get_running_loop()
        self._timer = self._loop.call_later(IDLE_TIMEOUT, transport.close)

    @property
    def peer(self) -> str:
        """The address of the other side."""
        return self._caller.host

    @property
    def waiting_bytes(self) -> int:
        """Bytes that wait for the other side."""
        return self._transport.get_write_buffer_size()

    @property
    def incomplete_bytes(self) -> int:
        """Bytes of calls that came in part, or wait."""
        return len(self._received) + self._parsed

    def shorten(self, size: int, least: int) -> None:
        """Do nothing: each call has a response."""

    def data_received(self, data: bytes) -> None:
        """Take bytes of a call."""
        self._received += data
        if self._task is None:
            self._advance()
        elif len(self._received) > MOST_UNREAD:
            self._transport.pause_reading()
        self._wake()

    def eof_received(self) -> bool:
        """Keep the connection until the call is answered."""
        self._has_ended = True
        self._wake()
        if self._task is None:
            self._transport.close()
        return True

    def pause_writing(self) -> None:
        """Wait for a slow reader."""
        self._writable.clear()
        if self._task is None:
            self._start(self._writable.wait())

    def resume_writing(self) -> None:
        """Continue."""
        self._writable.set()

    def connection_lost(self, error: Exception | None) -> None:
        """End."""
        self._timer.cancel()
        if self._task is not None:
            self._task.cancel()
        self._closed(self)

    def abort(self) -> None:
        """Close the connection at once."""
        self._transport.abort()

    def _wake(self) -> None:
        if self._arrived is not None and not self._arrived.done():
            self._arrived.set_result(None)

    def _advance(self) -> None:
        """Serve the calls that have arrived, up to one that takes a while."""
        try:
            while self._task is None and not self._transport.is_closing():
                request = self._request or self._next_request()
                if request is None:
                    return
                if request.length > SMALL:
                    self._start(self._serve_large(request))
                elif len(self._received) < request.length:
                    return
                else:
                    body = bytes(memoryview(self._received)[: request.length])
                    del self._received[: request.length]
                    self._serve(request, body)
        except _RequestRefused as refusal:
            self._refuse(refusal)

    def _next_request(self) -> _Request | None:
        """Return the head of the next call, if it has arrived; raises `_RequestRefused`."""
        end = self._received.find(b"\r\n\r\n")
        if end > MOST_HEAD or (end < 0 and len(self._received) > MOST_HEAD):
            raise _RequestRefused(431, f"The limit of a head is {MOST_HEAD} bytes")
        if end < 0:
            return None
        head = _read_head(bytes(self._received[:end]))
        text = self._refusal(head.fields.get("origin"), head.fields.get("host"), self._caller)
        if text is not None:
            raise _RequestRefused(403, text)
        request = _read_request(head, self._max_body)
        del self._received[: end + 4]
        self._request = request
        self._set_timer(BODY_TIMEOUT)
        return request

    def _serve(self, request: _Request, body: bytes) -> None:
        """Answer a small call."""
        parser = CallParser()
        try:
            parser.feed(body)
            value = self._call(request, parser)
            if isinstance(value, Awaitable):
                self._start(self._serve_slow(request, value))
                return
            pieces = iter_response(value)
            first, second = next(pieces), next(pieces, b"")
        except XmlRpcError as error:
            first, second = write_fault(1, str(error)), b""
        if second:
            self._start(self._respond_slowly(request, chain((first, second), pieces)))
        else:
            self._respond(request, first)

    def _call(self, request: _Request, parser: CallParser) -> object:
        """Make a call; return its value, or what is to be awaited for it."""
        method, params = parser.call()
        caller = self._caller._replace(size=request.length)
        return self._answer(request.path, method, params, caller)

    async def _serve_large(self, request: _Request) -> None:
        """Answer a call while its body arrives."""
        parser, fault, left = CallParser(), "", request.length
        while left:
            while not self._received:
                if self._has_ended:
                    self._transport.close()
                    return
                self._transport.resume_reading()
                self._arrived = self._loop.create_future()
                await self._arrived
            size = min(left, SLICE)
            data = bytes(memoryview(self._received)[:size])
            del self._received[:size]
            left -= len(data)
            try:
                if not fault:
                    parser.feed(data)
                    self._parsed += len(data)
            except XmlRpcError as error:
                fault, parser, self._parsed = str(error), CallParser(), 0
            await asyncio.sleep(0)
        self._set_timer(None)
        try:
            if fault:
                raise XmlRpcError(fault)
            value = self._call(request, parser)
            if isinstance(value, Awaitable):
                value = await value
            body = await written(iter_response(value))
        except XmlRpcError as error:
            body = write_fault(1, str(error))
        self._respond(request, body)

    async def _serve_slow(self, request: _Request, value: Awaitable[object]) -> None:
        """Answer a call whose value takes a while."""
        self._set_timer(None)
        try:
            body = await written(iter_response(await value))
        except XmlRpcError as error:
            body = write_fault(1, str(error))
        self._respond(request, body)

    async def _respond_slowly(self, request: _Request, pieces: Iterable[bytes]) -> None:
        self._set_timer(None)
        self._respond(request, await written(pieces))

    def _start(self, work: Coroutine[Any, Any, object]) -> None:
        """Let a task serve the present call, and the others wait for it."""
        self._task = self._loop.create_task(self._run(work))

    async def _run(self, work: Coroutine[Any, Any, object]) -> None:
        try:
            await work
            await self._writable.wait()
        except Exception:
            logger.exception("%s: an XML-RPC call failed.", self._caller.host)
            self._transport.abort()
        self._task = None
        self._transport.resume_reading()
        self._advance()
        if self._has_ended and self._task is None:
            self._transport.close()

    def _respond(self, request: _Request, body: bytes) -> None:
        self._request = None
        self._parsed = 0
        # roscpp finds the length only with this spelling, and one space.
        head = RESPONSE % (len(body), b"Connection: close\r\n" if request.is_last else b"")
        self._transport.write(head + body)
        self._set_timer(IDLE_TIMEOUT)
        if request.is_last:
            self._transport.close()

    def _refuse(self, refusal: _RequestRefused) -> None:
        text = f"{refusal}\n".encode()
        phrase = HTTPStatus(refusal.status).phrase
        head = (
            f"HTTP/1.1 {refusal.status} {phrase}\r\nContent-Type: text/plain\r\n{refusal.header}"
            f"Connection: close\r\nContent-length: {len(text)}\r\n\r\n"
        )
        self._transport.write(head.encode("latin-1", "replace") + text)
        self._transport.close()

    def _set_timer(self, seconds: float | None) -> None:
        """Close the connection after some time, unless this is called again."""
        self._timer.cancel()
        if seconds is not None:
            self._timer = self._loop.call_later(seconds, self._transport.close)


def _read_head(head: bytes) -> _Head:
    """Return the request line and the headers; raises `_RequestRefused`."""
    first, *lines = head.decode("latin-1").split("\r\n")
    fields: dict[str, str] = {}
    for line in lines:
        name, colon, value = line.partition(":")
        name = name.lower()
        if not colon or name != name.strip() or (name in ONCE and name in fields):
            raise _RequestRefused(400, f"invalid header: {line[:100]!r}")
        fields[name] = value.strip()
    return _Head(first, fields)


def _read_request(head: _Head, max_body: int) -> _Request:
    """Return what a head says of a call; raises `_RequestRefused`."""
    first, fields = head
    match first.split(" "):
        case ["POST", path, "HTTP/1.1" | "HTTP/1.0" as version]:
            pass
        case [_, _, "HTTP/1.1" | "HTTP/1.0"]:
            host = fields.get("host", "HOST:11311")
            raise _RequestRefused(405, NOT_POST.format(host=host), "Allow: POST\r\n")
        case _:
            raise _RequestRefused(400, f"invalid request: {first[:100]!r}")
    length = fields.get("content-length")
    if length is None or "transfer-encoding" in fields:
        raise _RequestRefused(411, "A Content-Length is needed")
    if not (length.isascii() and length.isdigit()):
        raise _RequestRefused(400, f"invalid Content-Length: {length[:100]!r}")
    if len(length) > 18 or int(length) > max_body:
        raise _RequestRefused(413, f"The limit of a call is {max_body} bytes")
    connection = fields.get("connection", "").lower()
    is_last = connection != "keep-alive" if version == "HTTP/1.0" else connection == "close"
    return _Request(path, int(length), is_last)


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
        self._notes: dict[str, OrderedDict[object, tuple[str, Sequence[object]]]] = {}
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
        self._notes.setdefault(uri, OrderedDict())[key] = (method, params)
        if uri not in self._tasks:
            self._tasks[uri] = asyncio.get_running_loop().create_task(self._notify(uri))

    def forget(self, uri: str) -> None:
        """Drop the notifications for a node."""
        self._notes.pop(uri, None)
        task = self._tasks.pop(uri, None)
        if task is not None:
            task.cancel()

    async def close(self) -> None:
        """End all notifications."""
        tasks = list(self._tasks.values())
        for task in tasks:
            task.cancel()
        await asyncio.gather(*tasks, return_exceptions=True)

    async def _notify(self, uri: str) -> None:
        try:
            await self._send_notes(uri)
        finally:
            # At once, and not in a callback: a notification in between would start no task.
            if self._tasks.get(uri) is asyncio.current_task():
                del self._tasks[uri]

    async def _send_notes(self, uri: str) -> None:
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
            raise NodeUnreachable(uri, f"timed out after {timeout:g} s") from None
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
