"""The WebSocket connections of links, which either hub opens."""

from __future__ import annotations

import asyncio
import logging
import math
import secrets
import time
from asyncio import sleep
from collections.abc import Callable
from typing import Any, NamedTuple

from websockets.asyncio.client import ClientConnection, connect
from websockets.exceptions import ConnectionClosed, InvalidStatus, WebSocketException
from websockets.http11 import Response
from websockets.typing import Subprotocol

from fibws import credentials
from fibws.access.rights import Principal
from fibws.client_handshake import ClientHandshake, RedirectedToTls
from fibws.credentials import Credentials
from fibws.errors import AuthenticationError, FibwsError, HubUnreachable
from fibws.hub.errors import FederationError
from fibws.hub.federation.backplane import Peer
from fibws.hub.federation.federation import Federation
from fibws.hub.federation.link import SUBPROTOCOL, UNSENT, Link, unique_node
from fibws.hub.federation.names import NameView
from fibws.hub.federation.retries import (
    LOST,
    OVERLOADED,
    REFUSED,
    Pace,
    Retries,
    pace_of_close,
    pace_of_status,
    seconds_asked,
)
from fibws.hub.foreign.worklist import TURN
from fibws.hub.log.text import printable
from fibws.hub.settings import Settings
from fibws.hub.websocket.endpoint import Opening, Registration, Work, limit_unsent
from fibws.hub_address import hub_url, node_url
from fibws.protocol.refusals import Refusal
from fibws.protocol.websocket import (
    BINARY,
    LIMITED,
    RESTART,
    CloseReason,
    Payload,
    close_reason,
    server_frame,
)
from fibws.tls import TlsFiles
from fibws.tls import fault as tls_fault

logger = logging.getLogger("fibws.hub")

OPEN_TIMEOUT = 5.0
CLOSE_TIMEOUT = 1.0

NOT_BINARY = CloseReason(1003, "expected binary messages of fibws.hub.v1")


class LinkEndpoint:
    """The accepting end of a link; an `Endpoint`, and the `Wire` of its link."""

    protocol = SUBPROTOCOL

    def __init__(self, opening: Opening, federation: Federation, settings: Settings) -> None:
        if opening.log_in is not None and opening.principal is None:
            raise AuthenticationError("missing token: a hub must send it in its handshake")
        self._opening = opening
        self._loop = asyncio.get_running_loop()
        self._is_due = False
        self._reason = "the connection was closed"
        opening.limit_unsent(UNSENT)
        self.link = _link(
            "accept",
            self,
            federation,
            settings,
            self._loop,
            view=NameView(hub=federation.hub.name),
            node=opening.node or f"/hub_{secrets.token_hex(3)}",
            principal=opening.principal,
            address=opening.address,
        )

    @property
    def node(self) -> str:
        """The node that stands for the other hub."""
        return self.link.node

    @property
    def incomplete_bytes(self) -> int:
        """Bytes that are kept of records that came in part."""
        return self.link.incomplete_bytes

    def receive_text(self, data: Payload) -> None:
        """Close the connection: links are binary."""
        self.close(NOT_BINARY)

    def receive_binary(self, data: Payload) -> Work:
        """Take some records."""
        try:
            yield from self.link.receive(data)
        except FederationError as error:
            logger.warning("%s: %s", self.node, error)
            self.close(close_reason(1008, str(error)))

    def refuse(self, data: Payload, reason: str, *, is_text: bool) -> None:
        """Close the connection: a link that loses records is of no use."""
        self.close(close_reason(LIMITED, reason))

    def registrations(self, what: Registration) -> int:
        """Return 0: limits of a client's registrations are not for hubs."""
        return 0

    def authorize(self, principal: Principal) -> Work:
        """Close the connection: the hub joins again, with its new rights."""
        self.close(RESTART)
        return iter(())

    def revoke(self) -> None:
        """Do nothing: what the other hub's nodes have here ends with the link."""

    def leave(self) -> Work:
        """Detach the other hub."""
        self.link.closed(self._reason)
        return iter(())

    # The link's wire.

    @property
    def is_behind(self) -> bool:
        """Whether the socket's buffer is full."""
        return self._opening.queue.paused

    def wake(self) -> None:
        """Write the next records in the next turn."""
        if not self._is_due:
            self._is_due = True
            self._loop.call_soon(self._write)

    def close(self, reason: CloseReason) -> None:
        """Close the connection."""
        self._reason = reason.reason
        self._opening.close(reason)

    def _write(self) -> None:
        self._is_due = False
        queue = self._opening.queue
        if queue.paused:
            queue.reply_fresh(self._next_frame)
        elif frame := self._next_frame():
            queue.reply(frame)

    def _next_frame(self) -> bytes:
        """Return the next frame, or nothing; write the one after it in another turn."""
        data = self.link.next_frame()
        if data is None:
            return b""
        self.wake()
        return server_frame(BINARY, data)


class _OwnWire:
    """The `Wire` of a link that this hub has opened."""

    def __init__(self, websocket: ClientConnection) -> None:
        self._websocket = websocket
        self._waiting = asyncio.Event()
        self.reason: CloseReason | None = None
        """The reason given when this hub closes the connection."""
        self.closing = asyncio.Event()
        self.is_behind = False
        """Whether the socket's buffer is full."""

    def wake(self) -> None:
        """Write soon."""
        self._waiting.set()

    def close(self, reason: CloseReason) -> None:
        """Close the connection soon."""
        if self.reason is None:
            self.reason = reason
            self.closing.set()

    async def write(self, link: Link) -> None:
        """Write records until the connection is closed."""
        while True:
            await self._waiting.wait()
            self._waiting.clear()
            while (data := link.next_frame()) is not None:
                self.is_behind = True
                await self._websocket.send(data)
                self.is_behind = False
                await asyncio.sleep(0)  # The library yields only when the socket is full.

    async def read(self, link: Link) -> None:
        """Read records until the connection is closed; raise `FederationError` for invalid ones."""
        until = time.perf_counter() + TURN
        async for data in self._websocket:
            if isinstance(data, str):
                raise FederationError("expected binary messages, got a text")
            for _ in link.receive(data):
                if time.perf_counter() > until:
                    await asyncio.sleep(0)
                    until = time.perf_counter() + TURN


class _End(NamedTuple):
    """Why a hub is not joined.

    Attributes:
        asked: the least seconds before the next try, as the other hub has asked for.
    """

    fault: str
    pace: Pace
    asked: float = 0.0


class _HandshakeRefused(FederationError):
    """The handshake was answered with an HTTP status other than that for a WebSocket."""

    def __init__(self, end: _End) -> None:
        self.end = end
        super().__init__(end.fault)


class Join:
    """Keeps this hub joined to another one, by a connection that it opens itself.

    Args:
        address: the other hub's URL, perhaps with a token.
        principal: returns the principal whose rights the other hub has here.

    Raises:
        FibwsError: the address or the token is invalid, or a certificate cannot be read.
    """

    def __init__(
        self,
        address: str,
        federation: Federation,
        settings: Settings,
        principal: Callable[[], Principal | None] = lambda: None,
    ) -> None:
        self.url = hub_url(address)
        self.fault = "it was not tried yet"
        """The reason for not being connected; empty while connected."""
        self.on_fault: Callable[[str], object] = lambda fault: None
        """Called with the reason each time a connection fails or ends."""
        self._credentials = Credentials.find(address, environment={})
        self._tls = TlsFiles.choose()
        if self.url.startswith("wss:"):
            self._tls.context(self.url)
        self._federation = federation
        self._settings = settings
        self._principal = principal
        self._retries = Retries()
        self._joined_at = math.inf
        self._view = NameView(
            settings.join_prefix,
            is_below=bool(settings.join_prefix),
            hub=federation.hub.name,
            exported=settings.join_export or ("/**",),
            imported=settings.join_import or ("/**",),
        )
        self._task: asyncio.Task[None] | None = None
        self._wire: _OwnWire | None = None
        """That of the present connection."""
        self._rights: Principal | None = None
        """The other hub's rights on the present connection."""

    def check_rights(self) -> None:
        """Join again if the other hub has other rights here than it had when it was joined."""
        if self._wire is not None and self._principal() != self._rights:
            self._wire.close(RESTART)

    def report(self) -> dict[str, Any]:
        """Return what is wrong, as a fibws_msgs/HubLink."""
        return {"kind": "join", "address": self.url, "fault": self.fault}

    def start(self) -> None:
        """Begin to connect, again and again."""
        if (warning := self._credentials.warning(self.url)) is not None:
            logger.warning("%s.", warning)
        self._task = asyncio.create_task(self._run(), name=f"join {self.url}")

    async def close(self) -> None:
        """Leave the other hub."""
        if self._task is not None:
            self._task.cancel()
            await asyncio.wait([self._task])

    async def _run(self) -> None:
        while True:
            end = _End("the connection failed", OVERLOADED)
            self._joined_at = math.inf
            try:
                end = await self._connect_once()
            except _HandshakeRefused as error:
                end = error.end
            except (OSError, WebSocketException, FibwsError, TimeoutError, ValueError) as error:
                pace = REFUSED if isinstance(error, HubUnreachable) else LOST
                end = _End(_reason(error), OVERLOADED if tls_fault(error) else pace)
            except Exception:
                logger.exception("The connection to %s failed.", self.url)
            self._retries.worked(time.monotonic() - self._joined_at)
            self._report(end)
            await sleep(self._retries.delay(end.pace, end.asked))

    async def _connect_once(self) -> _End:
        """Connect, and exchange records until the connection is lost; return why it was."""
        token = self._credentials.read()
        websocket = await self._open(token)
        self._wire = wire = _OwnWire(websocket)
        self._rights = self._principal()
        link = _link(
            "join",
            wire,
            self._federation,
            self._settings,
            asyncio.get_running_loop(),
            view=self._view,
            node="",
            principal=self._rights,
            address=self.url,
            on_joined=self._on_joined,
        )
        loop = asyncio.get_running_loop()
        tasks = [loop.create_task(work) for work in (wire.write(link), wire.read(link))]
        closing = loop.create_task(wire.closing.wait())
        reason = "this hub ends"
        try:
            done, _ = await asyncio.wait({*tasks, closing}, return_when=asyncio.FIRST_COMPLETED)
            end = _end_of(wire, websocket, done)
            reason = end.fault
            return end
        finally:
            self._wire = None
            link.closed(reason)
            for task in (*tasks, closing):
                task.cancel()
            await asyncio.shield(_close(websocket, wire.reason))
            await asyncio.wait({*tasks, closing})

    async def _open(self, token: str | None, url: str | None = None) -> ClientConnection:
        """Connect to the other hub.

        Args:
            url: where it has redirected this one to, which does not get the token.
        """
        if url is not None:
            token = None
        url = url or self.url
        prefix = self._view.prefix
        node = f"{prefix}/hub" if prefix else unique_node("hub", self._federation.hub)
        is_tls = url.startswith("wss:")
        try:
            websocket = await connect(
                node_url(url, node),
                ssl=self._tls.context(url) if is_tls else None,
                create_connection=ClientHandshake,
                additional_headers=credentials.headers(token),
                logger=credentials.handshake_log(),
                subprotocols=[Subprotocol(SUBPROTOCOL)],
                compression=None,
                max_size=self._settings.max_message_size,
                open_timeout=OPEN_TIMEOUT,
                close_timeout=CLOSE_TIMEOUT,
                ping_interval=None,
                proxy=True if is_tls else None,
            )
            if websocket.subprotocol != SUBPROTOCOL:
                await websocket.close()
                raise HubUnreachable(self.url, f"it does not speak {SUBPROTOCOL}")
            limit_unsent(websocket.transport, UNSENT)
            return websocket
        except RedirectedToTls as redirect:
            return await self._open(token, redirect.url)
        except InvalidStatus as error:
            raise _HandshakeRefused(_end_of_handshake(error.response)) from None

    def _on_joined(self, peer: Peer) -> None:
        self._joined_at = time.monotonic()
        self._retries.joined()
        self.fault = ""

    def _report(self, end: _End) -> None:
        """Log the reason for not being connected, once."""
        self.fault = end.fault
        self.on_fault(end.fault)
        if self._retries.is_new(end.pace, end.fault):
            often = f" every {REFUSED.longest:g} s" if end.pace is REFUSED else ""
            fault = printable(end.fault)
            logger.warning("Not joined to %s (%s); trying again%s.", self.url, fault, often)


def _end_of_handshake(response: Response) -> _End:
    """Return why a handshake was refused."""
    status, content_type = response.status_code, response.headers.get("Content-Type", "")
    refusal = Refusal(status, response.reason_phrase, content_type, response.body)
    asked = seconds_asked(response.headers.get("Retry-After"))
    return _End(str(refusal), pace_of_status(status), asked)


def _end_of(wire: _OwnWire, websocket: ClientConnection, done: set[asyncio.Task[Any]]) -> _End:
    """Return why a connection has ended."""
    reason = "the connection was lost"
    for task in done:
        error = task.exception()
        if isinstance(error, FederationError):
            wire.close(close_reason(1008, str(error)))
        elif error is not None and not isinstance(error, ConnectionClosed):
            raise error
    code = websocket.close_code or 1006
    if wire.reason is not None:
        code, reason = wire.reason.code, wire.reason.reason
    elif websocket.close_reason:
        reason = websocket.close_reason
    return _End(reason, pace_of_close(code))


def _link(
    kind: str,
    wire: Any,
    federation: Federation,
    settings: Settings,
    loop: asyncio.AbstractEventLoop,
    *,
    view: NameView,
    node: str,
    principal: Principal | None,
    address: str,
    on_joined: Callable[[Peer], object] = lambda peer: None,
) -> Link:
    return Link(
        kind,
        wire,
        federation,
        federation.hub,
        view=view,
        node=node,
        principal=principal,
        address=address,
        clock=loop,
        now=time.time_ns,
        max_size=settings.max_message_size,
        max_queued=settings.max_queued_bytes,
        max_incoming=settings.max_total_incoming_bytes,
        on_joined=on_joined,
    )


async def _close(websocket: ClientConnection, reason: CloseReason | None) -> None:
    """Close a connection, which takes a second at most."""
    if reason is None:
        await websocket.close()
    else:
        # Codes from 4000 on, and those for faults, are what a client may send.
        await websocket.close(reason.code if reason.code != 1001 else 1000, reason.reason)


def _reason(error: Exception) -> str:
    if fault := tls_fault(error):
        return fault
    if isinstance(error, HubUnreachable):
        return error.cause
    if isinstance(error, TimeoutError):
        return f"no answer within {OPEN_TIMEOUT:g} s"
    return getattr(error, "strerror", None) or str(error) or type(error).__name__
