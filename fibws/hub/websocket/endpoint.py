"""Endpoints: the port by which a protocol attaches to the hub's WebSocket connections.

A connection passes its messages to an `Endpoint` and takes frames from its send queue. Which
endpoint a connection gets is decided by the WebSocket subprotocol, or by the path.
"""

from __future__ import annotations

import asyncio
import logging
import socket
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import chain
from typing import Any, Literal, Protocol, TypeAlias

from websockets.server import ServerProtocol
from websockets.typing import Subprotocol

from fibws.access.rights import Principal
from fibws.hub.delivery.send_queue import SendQueue
from fibws.hub.settings import KIB
from fibws.protocol.websocket import TOKEN_SUBPROTOCOL, CloseReason, Payload

logger = logging.getLogger("fibws.hub")

STRANGER_BYTES = 64 * KIB
"""Bytes that a message of a client may have before its login: those without a token must not use
up the memory that those with one need."""

Registration: TypeAlias = Literal["subscriptions", "advertisements"]
"""A kind of registration: topics subscribed to; topics, services and actions advertised."""

Work: TypeAlias = Iterator[None]
"""What is left to do of a message that asks for many things; each step does one of them.

The connection takes the steps in its turns, the first ones at once, and passes on no other message
before the end. It takes no further step once it is closed.
"""

Removals: TypeAlias = Sequence[tuple[Callable[[Any], object], list[Any]]]
"""What a client leaves behind: functions, each with the things to remove by it one by one."""


class Part(Protocol):
    """A part of an endpoint."""

    def leave(self) -> Removals:
        """Accept nothing more, and return what is to be removed."""


def remove_all(removals: Removals) -> Work:
    """Remove what a client leaves behind, one thing with each step.

    Whatever fails of this, the rest is done.
    """
    for remove, things in removals:
        things.reverse()
        while things:  # Their memory is freed one by one, too.
            try:
                remove(things.pop())
            except Exception:
                logger.exception("Something of a client that has left could not be removed.")
            yield


def withdraw_all(parts: Iterable[Work], fail: Callable[[], object]) -> Work:
    """Take the steps of all parts; call a function if one fails: no right may outlive that."""
    try:
        for steps in parts:
            yield from steps
    except Exception:
        fail()
        raise


class Endpoint(Protocol):
    """One client's protocol on one connection."""

    @property
    def protocol(self) -> str:
        """The protocol's name."""

    @property
    def node(self) -> str:
        """The global name of the client's node."""

    @property
    def incomplete_bytes(self) -> int:
        """Bytes that are kept of messages that the endpoint puts together."""

    def receive_text(self, data: Payload) -> Work | None:
        """Take a text message, and return what is left to do.

        Raises:
            InvalidUtf8: it is not UTF-8, which closes the connection; the steps may raise it, too.
        """

    def receive_binary(self, data: Payload) -> Work | None:
        """Take a binary message, own its buffer, and return what is left to do."""

    def refuse(self, data: Payload, reason: str, *, is_text: bool) -> Work | None:
        """Drop a message of a client that sends too much, and report that, perhaps in steps.

        Raises:
            InvalidUtf8: it is a text, but not UTF-8.
        """

    def registrations(self, what: Registration) -> int:
        """Return how many of something the client has registered."""

    def authorize(self, principal: Principal) -> Work:
        """Use these rights from now on.

        Returns:
            Steps that remove registrations that they do not allow. They come before whatever else
            the client sends, or has sent.

        Raises:
            NotAllowed: the client may not be its node any more.
        """

    def revoke(self) -> None:
        """Take all rights from the client: its token is gone; `leave` follows."""

    def leave(self) -> Work:
        """Take the client's node back; called once, when the connection ends.

        Nothing is accepted from the client any more, its wills are published, and its name is free.

        Returns:
            Steps that remove what it has registered, in turns with other clients.
        """


@dataclass(frozen=True, slots=True)
class Opening:
    """The parameters of a new endpoint.

    Attributes:
        node: the global name that the client requested, if any.
        queue: takes the frames for the client.
        close: closes the connection.
        principal: the client's principal; None before its login, or without authentication.
        log_in: returns the principal of a token, or raises `AuthenticationError`; None on a hub
            without authentication.
        refused: records why an operation was refused that came before the login.
        replace: gives the connection to another endpoint.
        count_operations: counts operations of a message beyond the first as messages, too.
        limit_unsent: sets how many bytes may wait at the socket before the queue is paused.
        check_room: raises `LimitReached` if the client's address or its principal has registered as
            many of something as it may.
        address: the client's IP address and port.
        is_page: whether the client is a web page: browsers name its origin.
    """

    node: str | None
    queue: SendQueue
    close: Callable[[CloseReason], None]
    principal: Principal | None = None
    log_in: Callable[[str], Principal] | None = None
    refused: Callable[[str], None] = lambda reason: None
    replace: Callable[[Endpoint], None] | None = None
    count_operations: Callable[[int], None] = lambda count: None
    limit_unsent: Callable[[int], None] = lambda size: None
    check_room: Callable[[Registration], None] = lambda what: None
    address: str = ""
    is_page: bool = False


OpenEndpoint: TypeAlias = Callable[[Opening], Endpoint]


class Endpoints:
    """The protocols that clients may speak, by WebSocket subprotocol and path.

    Args:
        default: the one for clients that ask for no known subprotocol.
    """

    def __init__(self, default: OpenEndpoint) -> None:
        self._default = default
        self._by_subprotocol: dict[str, OpenEndpoint] = {}
        self._by_path: dict[str, OpenEndpoint] = {}

        def select(protocol: ServerProtocol, offered: Sequence[Subprotocol]) -> Subprotocol | None:
            known = (each for each in offered if each in self._by_subprotocol)
            # A browser fails a connection of which the server takes none of the subprotocols.
            tokens = (each for each in offered if each.startswith(TOKEN_SUBPROTOCOL))
            return next(chain(known, tokens), None)

        self.select = select
        """Selects the first subprotocol of a client's that is known, for `ServerProtocol`, which
        takes a function but no method."""

    def add(self, open_: OpenEndpoint, *, subprotocol: str | None = None, path: str = "") -> None:
        """Add a protocol, for clients that offer its subprotocol or connect to its path."""
        if subprotocol is not None:
            self._by_subprotocol[subprotocol] = open_
        if path:
            self._by_path[path] = open_

    def has_texts(self, subprotocol: str | None) -> bool:
        """Return whether messages are texts in the protocol of a connection: that of rosbridge."""
        return subprotocol not in self._by_subprotocol

    def find(self, subprotocol: str | None, path: str) -> OpenEndpoint:
        """Return the protocol for a connection: the subprotocol decides, then the path."""
        by_path = self._by_path.get(path.partition("?")[0], self._default)
        return self._by_subprotocol.get(subprotocol, by_path) if subprotocol else by_path


def limit_unsent(transport: asyncio.WriteTransport, size: int) -> None:
    """Set how many bytes may wait for the network: in a transport, and in the system."""
    transport.set_write_buffer_limits(size)
    if hasattr(socket, "TCP_NOTSENT_LOWAT"):
        # Otherwise the kernel keeps megabytes of messages that a slow client reads when stale.
        sock = transport.get_extra_info("socket")
        sock.setsockopt(socket.IPPROTO_TCP, socket.TCP_NOTSENT_LOWAT, size)
