"""The connection between a node and its hub, which is made again whenever it breaks.

connect() of websockets ── _Handshake ── the response's head ──> WebSocket
socket ── WebSocket.buffer_updated ── FrameParser ──> messages: Session.receive_binary
                                                 ├──> operations: Session.receive_text
                                                 └──> control frames, fragments: _Handshake
Session ── OutgoingQueue ── WebSocket.write ──> socket
"""

from __future__ import annotations

import asyncio
import logging
import os
import random
import re
import time
from collections.abc import Iterator
from contextlib import suppress
from typing import Any

from websockets.asyncio.client import connect
from websockets.exceptions import (
    ConnectionClosed,
    InvalidHandshake,
    InvalidMessage,
    InvalidProxy,
    InvalidStatus,
    InvalidURI,
    SecurityError,
)
from websockets.frames import CloseCode, Frame, Opcode
from websockets.protocol import Event, State
from websockets.typing import Subprotocol

from fibws import credentials
from fibws.client_handshake import ClientHandshake, RedirectedToTls
from fibws.credentials import Credentials
from fibws.errors import (
    AccessDenied,
    AccessError,
    HubUnreachable,
    InvalidAddress,
    NodeError,
    NodeKilled,
    NodeReplaced,
    NoHub,
    NotAHub,
)
from fibws.hub_address import node_url
from fibws.node.liveness import LOOK_INTERVAL, HubLiveness
from fibws.node.log import ROSOUT
from fibws.node.outgoing_queue import TURN, PublisherLane
from fibws.node.session import Session
from fibws.protocol.refusals import Refusal
from fibws.protocol.serialized import SUBPROTOCOL
from fibws.protocol.websocket import (
    KILLED,
    LIMITED,
    REPLACED,
    SERIALIZED,
    SILENT,
    SIMULATED,
    SIZE_HEADER,
    TEXT,
    TIME_HEADER,
    UNAUTHENTICATED,
    VALUES_HEADER,
    FrameParser,
    client_frame,
    client_payload,
    largest_message,
)
from fibws.tls import TlsFiles, expects_tls, fault, refuses_certificate

FIRST_RETRY = 0.1
LONGEST_RETRY = 0.5
LONGEST_WAIT = 10.0
OPEN_TIMEOUT = 5.0
FLUSH_TIMEOUT = 0.6
CLOSE_TIMEOUT = 0.3
"""Seconds, all six: before the first retry, most before others, most while the hub has no room for
the node; and timeouts, of which the last two together bound how long a node's end takes."""

BUFFER_SIZE = 64 * 1024
"""Bytes to read at once; a larger message is read into a buffer of its own."""

_TRY_LATER = (408, 425, 429)
_NO_ROOM = (429, 503)
"""The statuses of a hub that has reached a limit, or is about to end."""
_ERRNO = re.compile(r"\[Errno (\d+)\]")
_DATA = (Opcode.TEXT, Opcode.BINARY, Opcode.CONT)


class _NodeHandshake(ClientHandshake):
    """websockets' connection: it does the handshake, and later control frames and fragments.

    It is given the bytes of the handshake's response, and none that follow: those are kept until
    `NodeWebSocket` takes over.
    """

    def __init__(self, *arguments: Any, **named: Any) -> None:
        super().__init__(*arguments, **named)
        self._head: bytes | None = b""
        """The last bytes of a response that is not complete yet."""
        self.rest = b""
        """The bytes that followed the handshake."""
        self.websocket: NodeWebSocket | None = None

    def data_received(self, data: bytes) -> None:
        """Read what the socket gave, up to the end of the handshake's response."""
        if self._head is None:
            if self.protocol.state is State.OPEN and self.websocket is None:
                self.rest += data
            else:
                super().data_received(data)
            return
        seen = self._head + data
        end = seen.find(b"\r\n\r\n")
        if end < 0:
            self._head = seen[-3:]
            super().data_received(data)
            return
        self._head = None
        rest = seen[end + 4 :]
        super().data_received(data[: len(data) - len(rest)])
        if self.protocol.state is State.OPEN:
            self.rest = rest
            self.transport.pause_reading()
        elif rest:  # The body of a refusal.
            super().data_received(rest)

    def process_event(self, event: Event) -> None:
        """Handle what the library has read."""
        if self.websocket is not None and isinstance(event, Frame) and event.opcode in _DATA:
            self.websocket.on_fragment(event)
        else:
            super().process_event(event)


class NodeWebSocket(asyncio.BufferedProtocol):
    """A connection after its handshake: reads messages for a session, and writes its frames.

    Args:
        handshake: the connection of websockets, whose handshake has succeeded.
        session: the node's.
    """

    def __init__(self, handshake: _NodeHandshake, session: Session) -> None:
        self._handshake = handshake
        self._session = session
        self._transport = handshake.transport
        self._loop = handshake.loop
        self.serialized = handshake.subprotocol == SUBPROTOCOL
        """Whether the server speaks `fibws.v1`."""
        self._parser = FrameParser(
            session.receive_text,
            session.receive_binary,
            self._feed,
            max_size=session.max_message_size,
            masked=False,
            turn=TURN,
            on_skipped=session.skipped,
        )
        self._buffer = memoryview(bytearray(BUFFER_SIZE))
        self._turn_is_due = False
        """Whether `_next_turn` is about to be called."""
        self._is_reading_paused = True  # by the handshake
        self._fragments: list[bytes] = []
        self._is_text = False
        self._keepalive = HubLiveness()
        self._next_look: asyncio.TimerHandle | None = None

    def start(self, *, hold: bool) -> None:
        """Register with the hub and begin to read.

        Args:
            hold: keep messages until `OutgoingQueue.release`.
        """
        response = self._handshake.response
        assert response is not None
        self._session.is_simulated = response.headers.get(TIME_HEADER) == SIMULATED
        self._handshake.websocket = self
        self._transport.set_protocol(self)
        self._session.connect(
            self,
            serialized=self.serialized,
            serialized_values=response.headers.get(VALUES_HEADER) == SERIALIZED,
            largest=largest_message(response.headers.get(SIZE_HEADER)),
            end_turn=self._parser.pause,
            hold=hold,
        )
        self._receive(self._handshake.rest)
        self._schedule_turn()
        self._look_later()

    async def accepted(self) -> None:
        """Wait until the hub has answered a ping: it has read what was sent before, and refuses a
        client without a valid token by closing the connection instead.
        """
        with suppress(ConnectionClosed, TimeoutError):
            async with asyncio.timeout(OPEN_TIMEOUT):  # Not every server answers.
                await (await self._handshake.ping())

    @property
    def is_open(self) -> bool:
        """Whether the connection is not closed, nor being closed."""
        return self._handshake.protocol.state is State.OPEN

    @property
    def address(self) -> str:
        """The URL of the hub, after redirects."""
        uri = self._handshake.protocol.uri
        host = f"[{uri.host}]" if ":" in uri.host else uri.host
        path = uri.path.removesuffix("/")
        return f"{'wss' if uri.secure else 'ws'}://{host}:{uri.port}{path}"

    @property
    def has_sent_token(self) -> bool:
        """Whether the hub was given the token; a redirect to another server is followed without."""
        request = self._handshake.request
        return request is not None and credentials.HEADER in request.headers

    async def closed(self) -> ConnectionClosed:
        """Wait until the connection is closed; return why."""
        await self._handshake.wait_closed()
        return self._handshake.protocol.close_exc

    async def close(self) -> None:
        """Close the connection within `CLOSE_TIMEOUT` seconds."""
        try:
            with suppress(TimeoutError):
                # The library's own timeout does not run while it waits for a full socket.
                async with asyncio.timeout(CLOSE_TIMEOUT):
                    await self._handshake.close()
        finally:
            self._transport.abort()  # Does nothing if the connection was closed in good order.

    # Liveness of the hub

    def _look_later(self) -> None:
        self._next_look = self._loop.call_later(LOOK_INTERVAL, self._look)

    def _look(self) -> None:
        """Ping the hub, or give it up, if that is due."""
        self._look_later()
        verdict = self._keepalive.look()
        # A ping would wait behind bytes that the hub does not read.
        if verdict == "ping" and self.is_open and not self.is_behind:
            self._handshake.protocol.send_ping(b"")
            self._handshake.send_data()
        elif verdict == "lost":
            if self.is_open:
                self._handshake.protocol.fail(SILENT.code, SILENT.reason)
                self._handshake.send_data()
            self._transport.abort()

    # Writing, for the queue

    def write(self, frame: bytes, lane: PublisherLane | None) -> None:
        """Write one frame."""
        if self._transport.is_closing():
            return
        if not self.serialized:
            frame = _rosbridge_frame(frame, lane)
        # asyncio slices off what the socket takes at once: of large bytes that would be a copy.
        self._transport.write(frame if len(frame) < BUFFER_SIZE else memoryview(frame))

    def write_joined(self, frames: list[tuple[bytes, PublisherLane | None]]) -> None:
        """Write several small frames at once."""
        if self._transport.is_closing():
            return
        if self.serialized:
            self._transport.write(b"".join([frame for frame, _ in frames]))
        else:
            self._transport.write(b"".join([_rosbridge_frame(*frame) for frame in frames]))

    @property
    def is_behind(self) -> bool:
        """Whether the transport still holds bytes that the socket did not take."""
        return self._transport.get_write_buffer_size() > 0

    # Reading: called by asyncio

    def get_buffer(self, sizehint: int) -> memoryview:
        """Return where to read."""
        return self._parser.buffer() if self._parser.in_large else self._buffer

    def buffer_updated(self, nbytes: int) -> None:
        """Handle what was read."""
        self._keepalive.alive()
        try:
            if self._parser.in_large:
                self._parser.filled(nbytes)
            else:
                self._parser.receive(bytes(self._buffer[:nbytes]))
        except Exception as error:  # A bug, because of which the program must not hang.
            self._session.end(error)
        if self._parser.paused:
            self._schedule_turn()

    def eof_received(self) -> None:
        """Handle the end of what the hub sends."""
        self._parser.end()
        self._handshake.eof_received()

    def connection_lost(self, exc: Exception | None) -> None:
        """Deliver what was read already, and report the loss."""
        if self._next_look is not None:
            self._next_look.cancel()
        self._session.outgoing.disconnect()
        while self._parser.paused:
            self._receive_more()
        self._handshake.connection_lost(exc)

    def pause_writing(self) -> None:
        """Handle a socket that is behind."""
        self._handshake.pause_writing()
        self._session.outgoing.pause()

    def resume_writing(self) -> None:
        """Handle a socket that has caught up."""
        self._keepalive.alive()
        self._handshake.resume_writing()
        self._session.outgoing.resume()

    def on_fragment(self, frame: Frame) -> None:
        """Put a fragmented message together; also takes whole messages that the library read."""
        if frame.opcode is not Opcode.CONT:
            self._is_text = frame.opcode is Opcode.TEXT
        self._fragments.append(bytes(frame.data))
        self._parser.fragmented = not frame.fin
        if frame.fin:
            message, self._fragments = b"".join(self._fragments), []
            if self._is_text:
                self._session.receive_text(message)
            else:
                self._session.receive_binary(message)

    def _receive(self, data: bytes) -> None:
        try:
            self._parser.receive(data)
        except Exception as error:  # A bug, because of which the program must not hang.
            self._session.end(error)

    def _receive_more(self) -> None:
        try:
            self._parser.resume()
        except Exception as error:  # As in `_receive`.
            self._session.end(error)

    def _next_turn(self) -> None:
        """Continue reading, now that the readers had a turn of the loop."""
        self._turn_is_due = False
        if self._transport.is_closing():
            return
        self._receive_more()
        if self._parser.paused:
            # One turn was not enough: what the socket brings meanwhile must not pile up.
            if not self._is_reading_paused:
                self._is_reading_paused = True
                self._transport.pause_reading()
            self._schedule_turn()
        elif self._is_reading_paused:
            self._is_reading_paused = False
            self._transport.resume_reading()

    def _schedule_turn(self) -> None:
        if not self._turn_is_due:
            self._turn_is_due = True
            self._loop.call_soon(self._next_turn)

    def _feed(self, data: bytes) -> None:
        """Let the library read."""
        self._handshake.data_received(data)
        if self._handshake.protocol.state is not State.OPEN:
            self._parser.give_up()


class HubConnection:
    """Keeps one node connected to its hub until the node ends.

    Args:
        hub: the hub's URL.
        node: the node's global name.
        session: the node's.
        log: gets a line when the hub is lost or found.
        tls: the node's certificates; they are read each time that it connects.
        token: what the node proves its identity with.
    """

    def __init__(
        self,
        hub: str,
        node: str,
        session: Session,
        log: logging.Logger,
        tls: TlsFiles,
        token: Credentials,
    ) -> None:
        self._hub = hub
        self._node = node
        self._session = session
        self._log = log
        self._tls = tls
        self._credentials = token
        self._token: str | None = None
        """The token of the current connection."""
        self._address = hub
        """The URL of the current connection, after redirects."""
        session.on_not_authenticated = self._on_not_authenticated
        self._found = asyncio.Event()
        """Set once there was a hub, or will never be one."""
        self._is_missing = False
        self._is_closed = False
        self._task: asyncio.Task[None] | None = None

    async def open(self) -> None:
        """Wait until there is a hub, for as long as that takes.

        Raises:
            HubUnreachable: the hub refuses the node, or its address cannot be used.
        """
        if (warning := self._credentials.warning(self._hub)) is not None:
            self._log.warning("%s.", warning)
        # Makes glibc keep freed memory: otherwise each large message trims and grows the heap.
        bytearray(16 << 20)
        self._session.begin()
        self._task = asyncio.create_task(self._run(), name=f"connection of {self._node}")
        try:
            await self._found.wait()
            self._session.check()
        except BaseException:
            await self.close()
            raise

    async def close(self) -> None:
        """Send what waits within `FLUSH_TIMEOUT`, disconnect, and log what was not sent.

        Does nothing when called again.
        """
        self._session.end()
        if self._task is None or self._is_closed:
            return
        self._is_closed = True
        if not self._session.outgoing.connected:
            self._task.cancel()
        try:
            await asyncio.wait({self._task}, timeout=FLUSH_TIMEOUT)
        finally:
            self._task.cancel()
            await asyncio.wait({self._task})
        unsent = self._session.outgoing.unsent()
        del unsent[ROSOUT]  # The console has shown those.
        if unsent:
            self._log.warning("Messages that were not sent: %d.", unsent.total())

    async def _run(self) -> None:
        """Connect again and again, until the node ends."""
        retries, waits = _retries(), _waits()
        loop = asyncio.get_running_loop()
        try:
            while not self._session.over:
                began = loop.time()
                must_wait = await self._connect_once()
                lasted = loop.time() - began
                if lasted > OPEN_TIMEOUT:
                    retries = _retries()
                if lasted > 2 * LONGEST_WAIT:
                    waits = _waits()
                if not self._session.over:
                    await asyncio.sleep(next(waits if must_wait else retries))
        except Exception as error:
            # The hub's final refusal; or a bug, because of which the program must not hang.
            self._session.end(error)
        finally:
            self._found.set()

    async def _connect_once(self) -> bool:
        """Connect, and wait until the connection is lost; return whether the hub has no room."""
        try:
            self._token = self._credentials.read()
            websocket = NodeWebSocket(await self._shake_hands(self._hub), self._session)
        except InvalidStatus as error:
            if error.response.status_code in _NO_ROOM:
                self._on_no_room(_status(error))
                return True
            self._on_missing(_status(error))  # Such as 502 of a proxy.
            return False
        except (OSError, InvalidHandshake, AccessError) as error:
            if refuses_certificate(error):
                raise HubUnreachable(self._hub, _reason(error)) from None
            answers = isinstance(error, InvalidMessage) and fault(error) is None
            self._on_missing(_reason(error), answers=answers)
            return False
        closed = await self._converse(websocket)
        if closed is None or self._session.over:
            return False
        reason = (closed.rcvd.reason if closed.rcvd is not None else "") or str(closed)
        if closed.rcvd is not None and closed.rcvd.code in (LIMITED, CloseCode.TRY_AGAIN_LATER):
            self._on_no_room(reason)
            return True
        self._on_missing(reason)
        return False

    async def _shake_hands(self, hub: str) -> _NodeHandshake:
        try:
            handshake = await connect(
                node_url(hub, self._node),
                ssl=self._tls.context(hub) if hub.startswith("wss:") else None,
                create_connection=_NodeHandshake,
                # A redirect to TLS leads to another server.
                additional_headers=credentials.headers(self._token if hub == self._hub else None),
                logger=credentials.handshake_log(),
                subprotocols=[Subprotocol(SUBPROTOCOL)],
                compression=None,
                max_size=self._session.max_message_size,
                open_timeout=OPEN_TIMEOUT,
                close_timeout=CLOSE_TIMEOUT,
                ping_interval=None,  # See `HubLiveness`.
                # What the socket does not take at once waits in our own queue, where it is bounded.
                write_limit=1,
                # A hub is nearby: the environment's proxy is for the internet.
                proxy=True if hub.startswith("wss:") else None,
            )
            assert isinstance(handshake, _NodeHandshake)
            return handshake
        except RedirectedToTls as redirect:
            return await self._shake_hands(redirect.url)
        except InvalidStatus as error:
            status = error.response.status_code
            if status >= 500 or status in _TRY_LATER:
                raise
            raise HubUnreachable(self._hub, _status(error)) from None
        except (InvalidURI, InvalidProxy, SecurityError, InvalidAddress, ValueError) as error:
            # ValueError is for odd host names and certificates, SecurityError for redirects.
            raise HubUnreachable(self._hub, _reason(error)) from None

    async def _converse(self, websocket: NodeWebSocket) -> ConnectionClosed | None:
        """Exchange messages until the connection is lost or the node ends; return why it was."""
        outgoing = self._session.outgoing
        again = self._found.is_set()
        closed = asyncio.create_task(websocket.closed(), name=f"end of {self._hub}")
        flushed = asyncio.create_task(self._flush(hold=again), name=f"flush to {self._hub}")
        accepted = asyncio.create_task(self._accept(websocket), name=f"entry to {self._hub}")
        self._address = websocket.address
        self._session.has_token = websocket.has_sent_token
        try:
            websocket.start(hold=again)
            await asyncio.wait({closed, flushed}, return_when=asyncio.FIRST_COMPLETED)
            if closed.done() and (error := self._fatal_close(websocket, closed.result())):
                # Before on_disconnect(), which would fail pending calls with another error.
                self._session.end(error)
        finally:
            outgoing.disconnect()
            self._session.on_disconnect()
            flushed.cancel()
            accepted.cancel()
            await websocket.close()
            await asyncio.wait({closed, flushed, accepted})
        return closed.result()

    async def _accept(self, websocket: NodeWebSocket) -> None:
        """Report the hub once it has accepted the node, then keep the node's token valid."""
        await websocket.accepted()
        if websocket.is_open:
            try:
                self._on_found()
                await self._renew_token(websocket)
            except Exception as error:  # Such as a log that cannot be written.
                self._session.end(error)

    async def _renew_token(self, websocket: NodeWebSocket) -> None:
        """Give the hub the next token from the file before the current one, a JWT, expires."""
        while websocket.has_sent_token:
            pause = self._credentials.next_check(self._token, time.time())
            if pause is None:
                return
            await asyncio.sleep(pause)
            token = self._credentials.replacement(self._token)
            if token is not None:
                self._token = token
                self._session.authenticate(token)

    async def _flush(self, *, hold: bool) -> None:
        """Wait until the node has ended and its last frame is written, or the hub is lost.

        Args:
            hold: write messages only after a while: other nodes have lost the hub, too, and would
                get no messages before they are back, which takes them one retry at most.
        """
        if hold:
            with suppress(Exception):  # The node's end, which is handled elsewhere.
                await self._session.ended(LONGEST_RETRY)
            self._session.outgoing.release()
        await self._session.outgoing.emptied()

    def _fatal_close(self, websocket: NodeWebSocket, closed: ConnectionClosed) -> NodeError | None:
        """Return what ends the node if the hub closed the connection for good."""
        code = closed.rcvd.code if closed.rcvd is not None else None
        reason = closed.rcvd.reason if closed.rcvd is not None else ""
        is_replaced = self._credentials.replacement(self._token) is not None
        if code == UNAUTHENTICATED and websocket.has_sent_token and is_replaced:
            return None  # It expired or was replaced; the new one may be good.
        if code == REPLACED.code:
            return NodeReplaced(f"another node took the name {self._node}")
        if code == KILLED.code:
            return NodeKilled(f"{self._node} was killed: another program asked the hub to end it")
        return None if code == LIMITED else self._denied(code, reason)

    def _denied(self, code: int | None, reason: str) -> AccessDenied | None:
        sent = self._session.has_token
        return self._credentials.refusal(
            self._address,
            code,
            reason,
            sent=sent,
            redirected_from=self._hub,
            certificate=self._tls.client_cert if self._address.startswith("wss:") else None,
        )

    def _on_not_authenticated(self) -> None:
        """End the node: the hub would wait a while for a token before it closes the connection."""
        self._session.end(self._credentials.missing(self._address, self._hub))

    def _on_missing(self, reason: str, *, answers: bool = False) -> None:
        """Log that there is no hub, once each time.

        Args:
            answers: whether another program answers.
        """
        if self._is_missing:
            return
        self._is_missing = True
        if self._found.is_set():
            self._log.warning("Lost the hub at %s (%s); trying again.", self._hub, reason)
        else:
            error = NotAHub(self._hub, reason) if answers else NoHub(self._hub, reason)
            text = "Waiting for a hub at %s (%s). %s"
            self._log.warning(text, self._hub, error.cause, error.remedy)

    def _on_no_room(self, reason: str) -> None:
        """Log that the hub does not take the node now, once each time."""
        if not self._is_missing:
            self._is_missing = True
            self._log.warning("The hub at %s has no room (%s); trying again.", self._hub, reason)

    def _on_found(self) -> None:
        if self._is_missing:
            word = "back" if self._found.is_set() else "there"
            self._log.info("The hub at %s is %s.", self._hub, word)
        self._is_missing = False
        self._found.set()


def _rosbridge_frame(frame: bytes, lane: PublisherLane | None) -> bytes:
    """Return a frame for a server without `fibws.v1`: as JSON, with a random masking key."""
    text = client_payload(frame) if lane is None else lane.to_json(frame)
    return client_frame(TEXT, text, os.urandom(4)) if text else b""


def _retries() -> Iterator[float]:
    """Yield the seconds to wait before each retry after the hub was lost.

    All are shorter than `LONGEST_RETRY`, after which a reconnected node expects the others.
    """
    return _delays(FIRST_RETRY, LONGEST_RETRY)


def _waits() -> Iterator[float]:
    """Yield the seconds to wait before each retry while the hub has no room for the node."""
    return _delays(LONGEST_RETRY, LONGEST_WAIT)


def _delays(first: float, longest: float) -> Iterator[float]:
    """Yield growing delays, with jitter so that nodes spread out."""
    delay = first
    while True:
        yield delay * random.uniform(0.7, 0.9)
        delay = min(2 * delay, longest)


def _status(error: InvalidStatus) -> str:
    """Return the HTTP status with which a server refuses a handshake, and its text."""
    response = error.response
    content_type = response.headers.get("Content-Type", "")
    return str(Refusal(response.status_code, response.reason_phrase, content_type, response.body))


def _reason(error: Exception) -> str:
    """Return why a connection failed, without the address, which the log line has anyway."""
    if tls_fault := fault(error) or expects_tls(error):
        return tls_fault
    if number := _ERRNO.search(str(error)):
        return os.strerror(int(number[1]))
    return getattr(error, "strerror", None) or str(error) or type(error).__name__
