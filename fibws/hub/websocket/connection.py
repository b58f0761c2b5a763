"""A client's connection: bytes in, messages to its endpoint, frames out.

An asyncio protocol around websockets' sans-I/O `ServerProtocol`. A message is handled within the
callback that read it, or in the client's next turn if it sends much at once (`Turns`). A connection
has no task and no timer, only `Connection.sweep`, which the server calls for all connections once a
second.
"""

from __future__ import annotations

import asyncio
import http
import logging
import math
import socket
import sys
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import partial
from time import perf_counter, time
from typing import Protocol, cast

from websockets.frames import Frame, Opcode
from websockets.http11 import Request, Response
from websockets.protocol import State
from websockets.server import ServerProtocol

from fibws.access.rights import Principal
from fibws.errors import AuthenticationError
from fibws.hub.access.authentication import (
    Authentication,
    AuthoritiesChanged,
    Certificate,
    Login,
)
from fibws.hub.delivery.deflate import Deflater, DeflatingSendQueue
from fibws.hub.delivery.send_queue import Flusher, SendQueue
from fibws.hub.errors import LimitReached, NotAllowed, TooManyAttempts
from fibws.hub.http.proxies import TrustedProxies
from fibws.hub.http.request_head import (
    HandshakeProtocol,
    drop_empty_subprotocols,
    too_long,
)
from fibws.hub.http.requests import DeferredResponse, HttpRequests, node_name, text_response
from fibws.hub.log.audit import Audit
from fibws.hub.settings import KIB, Settings
from fibws.hub.tls.certificate import certificate_of
from fibws.hub.websocket import tcp_counters
from fibws.hub.websocket.client_log import ClientLog
from fibws.hub.websocket.deflate_extension import may_deflate
from fibws.hub.websocket.endpoint import (
    STRANGER_BYTES,
    Endpoint,
    Endpoints,
    Opening,
    Registration,
    limit_unsent,
)
from fibws.hub.websocket.keepalive import Keepalive
from fibws.hub.websocket.message_reader import MessageReader, ReadBuffers
from fibws.hub.websocket.quotas import ClientQuotas
from fibws.hub.websocket.shared_limits import SharedLimits
from fibws.hub.websocket.turns import TURN, Turns
from fibws.protocol.websocket import (
    CERTIFICATE_EXPIRED,
    EXPIRED,
    FORBIDDEN,
    LIMITED,
    MISSING_TOKEN,
    OVERFULL,
    RESTART,
    SERIALIZED,
    SIMULATED,
    SIZE_HEADER,
    TIME_HEADER,
    UNAUTHENTICATED,
    VALUES_HEADER,
    CloseReason,
    close_reason,
)

_library_logger = logging.getLogger("fibws.hub.websockets")
_library_logger.setLevel(logging.WARNING)

HIGH_WATER = 64 * KIB
"""Bytes in a transport's buffer at which its client counts as slow."""
TLS_RECORD = b"\x16\x03"
"""The first bytes from a client that speaks TLS; no HTTP request holds them."""
LONG_HEAD = 4 * KIB
"""Bytes of a request's head that is longer than those of most clients."""
DROPPING_PAUSE = 0.01
"""Seconds between two reads of a client whose messages are dropped: to drop them costs, too."""


@dataclass(frozen=True, slots=True)
class SharedParts:
    """The state that all connections of one hub share."""

    settings: Settings
    http: HttpRequests
    proxies: TrustedProxies
    endpoints: Endpoints
    loop: asyncio.AbstractEventLoop
    flusher: Flusher
    deflater: Deflater
    turns: Turns
    limits: SharedLimits
    observer: Observer
    audit: Audit
    authentication: Authentication | None = None
    now: Callable[[], float] = time
    """Returns the seconds since 1970."""
    is_simulated: Callable[[], bool] = lambda: False
    """Returns whether the graph's time is simulated."""
    buffers: ReadBuffers = field(default_factory=ReadBuffers)


_ENDED = ServerProtocol()
"""Stands in for the library's part of all connections that are lost."""
_ENDED.state = State.CLOSED


class Observer(Protocol):
    """Observes connections."""

    def opened(self, connection: Connection) -> None:
        """A socket has been opened."""

    def connected(self, connection: Connection) -> None:
        """A client has finished its handshake."""

    def entered(self, connection: Connection) -> None:
        """A client is a node now; before, it may have had to prove who it is."""

    def ponged(self, connection: Connection, data: bytes) -> None:
        """A client has sent a pong with these data."""

    def lost(self, connection: Connection) -> None:
        """A socket is closed."""


class Connection(asyncio.BufferedProtocol):
    """One client's connection, from the socket's opening to its end."""

    __slots__ = (
        "_busy",
        "_deferred",
        "_head",
        "_keepalive",
        "_left",
        "_log",
        "_login",
        "_login_due",
        "_pong_bytes",
        "_protocol",
        "_quotas",
        "_reader",
        "_request",
        "_requested",
        "_rest",
        "_seen_bytes",
        "_shared",
        "_transport",
        "_waiting",
        "address",
        "bytes_received",
        "certificate",
        "endpoint",
        "peer",
        "principal",
        "queue",
    )

    def __init__(self, shared: SharedParts) -> None:
        self._shared = shared
        self._protocol: ServerProtocol = HandshakeProtocol(
            shared.endpoints,
            limit=shared.settings.max_request_head,
            max_size=min(STRANGER_BYTES, shared.settings.max_message_size),
            logger=_library_logger,
        )
        self._transport: asyncio.Transport
        self._keepalive = Keepalive(shared.settings, shared.loop.time())
        self._head: bytes | None = b""
        """The last bytes of a request that is not complete yet; None after the handshake."""
        self._request = b""
        """Bytes of a request that wait for the connection's turn."""
        self._reader: MessageReader
        self._busy = False
        """Whether there was more to read than fits a turn, lately."""
        self._waiting = False
        """Whether the connection waits for its turn, and its socket is not read."""
        self._pong_bytes = 0
        self._left = False
        self._deferred: DeferredResponse | None = None
        """The response that takes long to make, until the connection ends."""
        self._rest = memoryview(b"")
        """What is not written yet of that response's body."""
        self._quotas = ClientQuotas(shared.limits.quotas)
        self._log = ClientLog(shared.audit)
        self.bytes_received = self._seen_bytes = 0
        self.queue: SendQueue
        self.endpoint: Endpoint | None = None
        self._requested: str | None = None
        """The name that the client has asked for."""
        self.principal: Principal | None = None
        """The client's principal, on a hub with authentication."""
        self._login: Login | None = None
        """The client's latest, on a hub with authentication."""
        self._login_due = math.inf
        """When a client must have sent its token that had none in its handshake."""
        self.address = ""
        """The IP address that the client comes from, also behind a trusted proxy."""
        self.peer = ""
        """The address with its port, which is unknown behind a trusted proxy."""
        self.certificate: Certificate | None = None
        """The client's certificate, which is verified."""

    @property
    def node(self) -> str:
        """The global name of the client's node; empty before it has one."""
        return self.endpoint.node if self.endpoint is not None else ""

    @property
    def name(self) -> str:
        """How the log calls the client: its node, or its address during the handshake."""
        return self.node or self.peer

    @property
    def socket(self) -> socket.socket | None:
        """The connection's socket, which is not for reading or writing; None at its end."""
        found: socket.socket | None = self._transport.get_extra_info("socket")
        return found

    @property
    def messages_received(self) -> int:
        """How many messages have come, pings and pongs included."""
        return self._reader.messages if self.is_open else 0

    @property
    def limited(self) -> int:
        """Messages that were dropped because they were more than the client may send."""
        return self._reader.dropped if self.is_open else 0

    @property
    def protocol(self) -> str:
        """The name of the protocol that the client speaks; empty during the handshake."""
        return self.endpoint.protocol if self.endpoint is not None else ""

    def registrations(self, what: Registration) -> int:
        """Return how many of something the client has registered."""
        return self.endpoint.registrations(what) if self.endpoint is not None else 0

    @property
    def is_open(self) -> bool:
        """Whether the handshake is done, and the connection is not lost."""
        return self.endpoint is not None

    @property
    def is_stranger(self) -> bool:
        """Whether the client has still to send its token, or sends a long request without end.

        A short one may have a token: clients must be able to connect while memory is full.
        """
        if self.endpoint is None:
            return self.incoming_bytes > LONG_HEAD
        return self._login_due < math.inf

    @property
    def owner(self) -> str:
        """Who holds what is kept for it: its principal, or the client itself."""
        return self.principal.title if self.principal is not None else self.name

    @property
    def unsent_bytes(self) -> int:
        """Bytes that the socket has still to take of what was written, once it is being closed."""
        return self._transport.get_write_buffer_size() if self._left else 0

    @property
    def incoming_bytes(self) -> int:
        """Bytes that are kept of messages that came in part."""
        size = len(self._protocol.reader.buffer) + len(self._request)
        if self.endpoint is not None:
            size += self._reader.kept_bytes + self.endpoint.incomplete_bytes
        return size

    # What asyncio calls.

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        self._transport = transport = cast(asyncio.Transport, transport)
        limit_unsent(transport, HIGH_WATER)
        sock = transport.get_extra_info("socket")
        peer = transport.get_extra_info("peername")
        # Most come from few addresses, and there may be thousands.
        self.address = sys.intern(peer[0]) if peer else "unknown"
        self.peer = f"{peer[0]}:{peer[1]}" if peer else "unknown"
        self.certificate = certificate_of(transport.get_extra_info("ssl_object"))
        self._shared.observer.opened(self)
        if not self._shared.limits.admit(sock.fileno()):
            transport.abort()

    def get_buffer(self, sizehint: int) -> memoryview:
        return self._reader.buffer() if self._head is None else self._shared.buffers.small

    def buffer_updated(self, nbytes: int) -> None:
        shared = self._shared
        turns = shared.turns
        shared.limits.account.grow(nbytes)
        turns.began = began = perf_counter()
        self.bytes_received += nbytes
        if self._deferred is not None:
            return  # Nothing may follow a request whose response is on its way.
        if self._head is None:
            if self._busy and turns.is_spent():
                self._reader.pause()
            has_more = self._reader.filled(nbytes, began)
        else:
            # A handshake costs as much as hundreds of messages, and a thousand may come at once.
            self._request += shared.buffers.small[:nbytes]
            has_more = True
        self._busy = has_more or perf_counter() - began >= TURN
        if self._busy:
            self._wait()
        if self.endpoint is not None and self.queue.paused and self.queue.overfull:
            self.fail(OVERFULL)

    def eof_received(self) -> bool:
        if self._head is None:
            self._reader.end()
        self._protocol.receive_eof()
        self._send()
        return False

    def connection_lost(self, exc: Exception | None) -> None:
        try:
            self._leave()
            if self._deferred is not None:
                self._deferred.end()
        finally:
            self._quotas.leave(self)
            self._shared.observer.lost(self)
            if self.endpoint is not None:
                self._report_drops(math.inf)
                self._log.left(self)
            self._release()

    def pause_writing(self) -> None:
        self._keepalive.paused(self._shared.loop.time(), self._unread())
        if self.endpoint is not None:
            self.queue.pause()

    def _unread(self) -> int:
        """Return a number that decreases while the client reads.

        These are the bytes in the transport's buffer. With TLS another buffer is behind it, of
        which the event loop says nothing: there it is what the client's system has acknowledged.
        """
        if self._transport.get_extra_info("ssl_object") is not None:
            counts = tcp_counters.read(self.socket)
            if counts is not None:
                return -counts.acknowledged
        return self._transport.get_write_buffer_size()

    def resume_writing(self) -> None:
        self._keepalive.resumed()
        self._pong_bytes = 0
        if self.endpoint is not None:
            self.queue.resume()
        elif self._rest:
            self._write_rest()

    # Turns.

    def _is_held(self) -> bool:
        """Return whether frames that were read wait for the next turn."""
        return self._head is None and self._reader.is_paused

    def _wait(self) -> None:
        """Let the others have their turn first; read nothing meanwhile."""
        if not self._transport.is_closing():
            self._waiting = True
            self._transport.pause_reading()
            turns = self._shared.turns
            if self._head is None and self._reader.is_dropping:
                self._shared.loop.call_later(DROPPING_PAUSE, turns.wait, self)
            else:
                turns.wait(self)

    def take_turn(self) -> None:
        """Handle the messages read before; continue reading once nothing is left of them."""
        self._waiting = False
        if self._transport.is_closing():
            return
        if self._request:
            request, self._request = self._request, b""
            self._busy = False  # A handshake takes long, but does not make a client a busy one.
            self._shake_hands(request)
        elif self._is_held():
            self._reader.resume(self._shared.turns.began)
            if self.endpoint is not None and self.queue.paused and self.queue.overfull:
                self.fail(OVERFULL)
        if self._is_held():
            self._wait()
        elif not self._transport.is_closing():
            self._transport.resume_reading()

    # The handshake.

    def _shake_hands(self, data: bytes) -> None:
        """Pass the library the request's head and no byte more.

        It would process frames sent behind the request before that is accepted.
        """
        assert self._head is not None
        if data.startswith(TLS_RECORD):
            text = "This port has no TLS; use http:// or ws://"
            self._protocol.send_response(text_response(http.HTTPStatus.BAD_REQUEST, text))
            self._send()
            return
        limit = self._shared.settings.max_request_head
        is_endless = self.bytes_received > limit + len(data)
        if is_endless and not self._protocol.eof_sent:
            text = too_long(limit)
            self._shared.audit.refused("limit", text, ip=self.address)
            status = http.HTTPStatus.REQUEST_HEADER_FIELDS_TOO_LARGE
            self._protocol.send_response(text_response(status, text.capitalize()))
            self._send()
            return
        seen = self._head + data
        end = seen.find(b"\r\n\r\n")
        if end < 0:
            self._head = seen[-3:]
            self.feed(data)
            return
        rest = seen[end + 4 :]
        self._head = None
        shared = self._shared
        self._reader = MessageReader(
            self, self._quotas, shared.settings, shared.turns, shared.buffers
        )
        self.feed(data[: len(data) - len(rest)])
        if rest and self._protocol.state is State.OPEN:
            self._reader.receive(rest)

    def _on_request(self, request: Request) -> None:
        shared = self._shared
        self._identify(request)
        response = (
            self._refuse_flood(request)
            or shared.http.respond(request, self.address, self.certificate)
            or self._refuse()
            or self._accept(request)
        )
        if isinstance(response, DeferredResponse):
            self._deferred = response
            response.start(self._respond)
            return
        if response.status_code != http.HTTPStatus.SWITCHING_PROTOCOLS:
            self._respond(response)
            return
        self._protocol.send_response(response)
        self.queue = self._send_queue()
        self._keepalive.opened()
        try:
            self._open(request)
        except REFUSED as error:
            self.fail(_refusal(error))
        finally:
            request.headers.clear()  # The library keeps the request as long as the connection.

    def _send_queue(self) -> SendQueue:
        """Return the client's send queue, which compresses if the handshake says so."""
        shared = self._shared
        write, broken = self._transport.write, self._transport.abort
        most = shared.settings.max_queued_bytes
        assert isinstance(self._protocol, HandshakeProtocol)
        bits = self._protocol.deflate_bits
        if not bits:
            return SendQueue(write, broken, shared.flusher, max_bytes=most)
        self._reader.accept_deflated()
        return DeflatingSendQueue(
            write, broken, shared.flusher, shared.deflater, max_bytes=most, bits=bits
        )

    def _open(self, request: Request) -> None:
        """Open the endpoint.

        Raises:
            AuthenticationError, NotAllowed, LimitReached: the client may not enter.
        """
        shared = self._shared
        self._requested = node_name(request.path)
        self._quotas.join_address(self, self.address, shared.turns.clock(), self._requested)
        log_in = None
        if shared.authentication is not None:
            log_in = self._log_in
            offered = ",".join(request.headers.get_all("Sec-WebSocket-Protocol")).split(",")
            login = shared.authentication.log_in(
                request.headers,
                request.path,
                [each.strip() for each in offered],
                self.certificate,
                self.address,
            )
            if login is not None:
                self._logged_in(login)
        open_endpoint = shared.endpoints.find(self._protocol.subprotocol, request.path)
        opening = Opening(
            self._requested,
            self.queue,
            self.close,
            address=self.peer,
            principal=self.principal,
            log_in=log_in,
            refused=partial(shared.audit.refused, "authentication", ip=self.address),
            replace=self._enter,
            count_operations=self._reader.count_operations,
            limit_unsent=partial(limit_unsent, self._transport),
            check_room=self._quotas.check_room,
            is_page="Origin" in request.headers,
        )
        endpoint = open_endpoint(opening)
        shared.observer.connected(self)
        if log_in is None or self.principal is not None:
            self._enter(endpoint)
        else:
            self.endpoint = self._reader.endpoint = endpoint
            self._login_due = shared.loop.time() + shared.settings.auth_timeout

    def _enter(self, endpoint: Endpoint) -> None:
        """Exchange messages with the client through an endpoint that is a node."""
        self.endpoint = self._reader.endpoint = endpoint
        self._login_due = math.inf
        self._protocol.max_message_size = self._shared.settings.max_message_size
        self._reader.enter()
        self._shared.observer.entered(self)
        self._log.connected(self, endpoint.node)

    # Who the client is.

    def _log_in(self, token: str) -> Principal:
        """Log the client in by a token, and return its principal."""
        assert self._shared.authentication is not None
        return self._logged_in(self._shared.authentication.log_in_by_token(token, self.address))

    def _logged_in(self, login: Login) -> Principal:
        self._join(login.principal)
        self._login = login
        self.principal = login.principal
        self._log.logged_in(self, login.principal)
        return login.principal

    @property
    def is_logged_out(self) -> bool:
        """Whether the session has ended by which the client has logged in."""
        session = self._login.session if self._login is not None else None
        return session is not None and session.has_ended

    def check_login(self, when: str) -> bool:
        """Check the client's login and rights again after the tokens have changed, in a turn.

        Args:
            when: for the client, if it is refused.

        Returns:
            Whether the client stays.
        """
        if self._login is None or self.endpoint is None or self._left:
            return True
        try:
            principal = self._login.again()
            if principal != self.principal:
                withdrawing = self.endpoint.authorize(principal)
                self.principal = principal
                self._join(principal)
                self._reader.do_first(withdrawing)
                if self._is_held() and not self._waiting:
                    self._busy = True
                    self._wait()
        except LimitReached as error:
            self.fail(_refusal(error, f"{when}: "))
            return False
        except REFUSED as error:
            self.endpoint.revoke()
            self.fail(_refusal(error, f"{when}: "))
            return False
        except Exception:
            self.endpoint.revoke()
            raise
        return True

    def _is_expired(self) -> bool:
        return self.principal is not None and self.principal.is_expired(self._shared.now())

    def _join(self, principal: Principal) -> None:
        """Count the client of a principal from now on, whose limits may be other ones.

        Raises:
            LimitReached: the principal has too many clients.
        """
        now = self._shared.turns.clock()
        self._quotas.join_principal(self, principal, now, self._requested)
        self._reader.accept()

    def _accept(self, request: Request) -> Response:
        drop_empty_subprotocols(request)
        assert isinstance(self._protocol, HandshakeProtocol)
        self._protocol.may_deflate = may_deflate(self._shared.settings.deflate, self.address)
        response = self._protocol.accept(request)
        response.headers[SIZE_HEADER] = str(self._shared.settings.max_message_size)
        response.headers[VALUES_HEADER] = SERIALIZED
        if self._shared.is_simulated():
            response.headers[TIME_HEADER] = SIMULATED
        return response

    # Requests that open no connection.

    def _refuse_flood(self, request: Request) -> Response | None:
        """Return the response to a client whose address sends too many requests."""
        if not self._shared.http.is_deliberate(request.headers):
            return None
        refusal = self._shared.limits.handshake_refusal(self.address, self._shared.turns.clock())
        if refusal is None:
            return None
        self._shared.audit.refused("limit", refusal, ip=self.address)
        response = text_response(http.HTTPStatus.TOO_MANY_REQUESTS, refusal)
        response.headers["Retry-After"] = "1"
        return response

    def _refuse_invalid(self) -> None:
        """Log why the library has refused a request, or respond if it has not."""
        assert isinstance(self._protocol, HandshakeProtocol)
        response = self._protocol.response_to_invalid()
        if response is not None:  # Before the end, which the library has asked for.
            self._transport.write(response.serialize())
        elif (refusal := self._protocol.refusal()) is not None:
            self._shared.audit.refused("limit", refusal, ip=self.address)

    def _respond(self, response: Response) -> None:
        """Send a response piece by piece: its body may be large, and is shared by all clients."""
        if self._transport.is_closing():
            return
        self._rest, response.body = memoryview(response.body), b""
        self._protocol.send_response(response)
        for data in self._protocol.data_to_send():
            if data:  # Otherwise it is the end, which comes after the body.
                self._transport.write(data)
        self._write_rest()

    def _write_rest(self) -> None:
        while self._rest and self._transport.get_write_buffer_size() <= HIGH_WATER:
            self._transport.write(self._rest[:HIGH_WATER])
            self._rest = self._rest[HIGH_WATER:]
        if self._rest or (self._deferred is not None and self._deferred.read_on(self._go_on)):
            return
        self._write_eof()
        self._keepalive.closing(self._shared.loop.time())

    def _go_on(self, piece: bytes) -> None:
        """Send the next piece of a file."""
        if not piece:  # Only an end without the rest tells the client that this is not all.
            self._transport.abort()
        elif not self._transport.is_closing():
            self._keepalive.sends(self._shared.loop.time())
            self._rest = memoryview(piece)
            self._write_rest()

    def _identify(self, request: Request) -> None:
        """Take the client's address from a trusted proxy, if it comes through one."""
        tls = self._transport.get_extra_info("ssl_object") is not None
        address = self._shared.proxies.resolve(self.address, request.headers, tls=tls)
        if address != self.address:
            self.address = sys.intern(address)
            self.peer = self.address

    def _refuse(self) -> Response | None:
        """Return the response to a client for which there is no room."""
        descriptor = self._transport.get_extra_info("socket").fileno()
        refusal = self._shared.limits.refusal(descriptor)
        if refusal is None:
            return None
        return text_response(http.HTTPStatus.SERVICE_UNAVAILABLE, refusal)

    # Reading.

    def feed(self, data: bytes) -> None:
        """Pass data to the library, and process its events."""
        if self._protocol.state is State.CLOSED:
            return
        is_handshake = self._protocol.handshake_exc is None
        self._protocol.receive_data(data)
        if is_handshake and self._protocol.handshake_exc is not None:
            self._refuse_invalid()
        for event in self._protocol.events_received():
            if isinstance(event, Request):
                self._on_request(event)
            elif isinstance(event, Frame):
                self._on_frame(event)
        if self._protocol.state is not State.OPEN and self._head is None:
            self._reader.give_up()
            self._reader.finish()
            self._leave()
        self._send()

    def _on_frame(self, frame: Frame) -> None:
        self._reader.add(frame)
        if frame.opcode is Opcode.PONG:
            self._keepalive.ponged()
            self._shared.observer.ponged(self, bytes(frame.data))

    # Writing.

    def _send(self) -> None:
        """Write the library's output."""
        for data in self._protocol.data_to_send():
            if data:
                if self.endpoint is None or self._left:
                    self._transport.write(data)
                else:
                    self.queue.write_control(data)
                self._count_pongs(len(data))
            else:
                self._write_eof()
                self._keepalive.closing(self._shared.loop.time())

    def _write_eof(self) -> None:
        """Send no more; a client with TLS cannot send more, either."""
        if not self._transport.can_write_eof():
            self._transport.close()
            return
        try:
            self._transport.write_eof()
        except OSError:  # The client has reset the connection meanwhile.
            self._transport.abort()

    def _count_pongs(self, size: int) -> None:
        """Cut off a client that sends pings but reads no pong: the queue does not bound them."""
        if self.endpoint is not None and self.queue.paused:
            self._pong_bytes += size
            if self._pong_bytes > HIGH_WATER:
                self._transport.abort()

    def ping(self, data: bytes) -> None:
        """Send a ping; `Observer.ponged` gets the payload of its pong."""
        if self._protocol.state is State.OPEN:
            self._protocol.send_ping(data)
            self._send()

    def grow(self, size: int) -> None:
        """Count bytes that are kept of a message beyond those that came."""
        self._shared.limits.account.grow(size)

    def close(self, reason: CloseReason) -> None:
        """Close in good order; a later sweep cuts off a client that does not answer."""
        if self._protocol.state is State.OPEN:
            self._log.closed(self, reason, level=logging.INFO)
            self._leave()
            self._protocol.send_close(reason.code, reason.reason)
            self._keepalive.closing(self._shared.loop.time())
            self._reader.give_up()
            self._send()
        elif self._protocol.state is State.CONNECTING:
            self._transport.abort()

    def abort(self) -> None:
        """Cut the connection off."""
        self._transport.abort()

    def fail(self, reason: CloseReason) -> None:
        """Close because of a fault of the client."""
        if self._protocol.state is State.CONNECTING:
            self._transport.abort()
        if self._protocol.state is not State.OPEN:
            return
        self._log.closed(self, reason, level=logging.WARNING)
        self._leave()
        self._protocol.fail(reason.code, reason.reason)
        self._reader.give_up()
        self._send()

    def _leave(self) -> None:
        """Take the client's node back; frames queued until now are still sent."""
        if self.endpoint is not None and not self._left:
            self._left = True
            self._reader.stop()
            if self._is_expired():
                self.endpoint.revoke()
            rest = self.endpoint.leave()
            self.queue.flush()
            self.queue.close()
            self._shared.turns.finish(rest)

    def _release(self) -> None:
        """Free incomplete messages of the client, and everything else.

        Otherwise megabytes would be kept until the cyclic garbage collector comes: the parser, the
        endpoint and the library's protocol refer back to the connection, or to themselves.
        """
        if self._head is None:
            self._reader.release()
            del self._reader
        self.endpoint = self._deferred = None
        self._rest = memoryview(b"")
        protocol, self._protocol = self._protocol, _ENDED
        vars(protocol).clear()

    # Once a second.

    def sweep(self, now: float, late: float) -> None:
        """Do the overdue action.

        Args:
            now: seconds of the loop's clock.
            late: seconds by which the sweep itself is late.
        """
        self._keepalive.excuse(late)
        if self._busy or self.bytes_received != self._seen_bytes:
            self._keepalive.behind(now)
            self._busy, self._seen_bytes = self._waiting, self.bytes_received
        if self.endpoint is not None:
            self._report_drops(now)
            if self.queue.overfull:
                self.fail(OVERFULL)
            meter = self._quotas.meter
            if meter is not None and meter.sweep(self.limited):
                self.fail(close_reason(LIMITED, meter.reason))
            self._sweep_login(now)
        verdict = self._keepalive.verdict(now, self._unread())
        if verdict == "abort":
            self._transport.abort()
        elif verdict == "ping":
            self._protocol.send_ping(b"")
            self._send()
        elif verdict is not None:
            self.fail(verdict)

    def _sweep_login(self, now: float) -> None:
        """Close the connection if its login is overdue, or is over."""
        if now > self._login_due:
            self.fail(MISSING_TOKEN)
        if self.is_logged_out:
            self._shared.turns.began = self._shared.turns.clock()
            self.check_login("after newer log-ins")
        if self._is_expired():
            assert self.principal is not None
            is_certificate = self.principal.proof == "certificate"
            self.fail(CERTIFICATE_EXPIRED if is_certificate else EXPIRED)

    def _report_drops(self, now: float) -> None:
        meter = self._quotas.meter
        self._log.report_drops(self, now, meter.reason if meter is not None else "")


REFUSED = (AuthenticationError, NotAllowed, LimitReached)
"""The errors for clients that may not enter, or not remain."""


def _refusal(error: Exception, prefix: str = "") -> CloseReason:
    """Return the reason with which the client of an error of `REFUSED` is closed."""
    code = FORBIDDEN
    if isinstance(error, AuthoritiesChanged):
        code = RESTART.code
    elif isinstance(error, LimitReached | TooManyAttempts):
        code = LIMITED
    elif isinstance(error, AuthenticationError):
        code = UNAUTHENTICATED
    return close_reason(code, f"{prefix}{error}")
