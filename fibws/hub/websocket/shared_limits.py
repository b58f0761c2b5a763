"""Limits for all connections together: how many there may be, and the bytes kept for them.

Limits of one client do not bound a thousand clients. What happens when there are too many bytes is
up to the hub's account.
"""

from __future__ import annotations

import errno
import sys
from collections import Counter
from collections.abc import Collection, Iterator
from functools import partial
from typing import Any, Protocol

from fibws.hub.delivery.send_queue import SendQueue
from fibws.hub.log.audit import Audit
from fibws.hub.memory.account import Account, AccountPart, Bound, Holding
from fibws.hub.settings import KIB, Settings
from fibws.hub.websocket.quotas import Quotas
from fibws.protocol.websocket import CloseReason

SPARE_FILES = 32
"""File descriptors that clients may not take: they are for plain HTTP requests, and for refusing
clients with a text."""
LAST_FILES = 8
"""File descriptors that no connection may take."""
SMALL = 4 * KIB
"""Bytes of a message that is small."""
MOST_UNSENT = 64 * KIB
"""Bytes that a connection may still send that is closed for lack of memory."""
TOO_MUCH_QUEUED = CloseReason(1013, "too many bytes wait for all clients; this one had the most")
TOO_MUCH_INCOMING = CloseReason(
    1013, "too many bytes of incomplete messages of all clients; this one had the most"
)


class Limited(Protocol):
    """A connection, as far as it is limited here."""

    queue: SendQueue

    @property
    def owner(self) -> str:
        """Who holds what is kept for it: its principal, or itself."""

    @property
    def is_stranger(self) -> bool:
        """Whether it has no client yet, or one that has still to log in."""

    @property
    def is_open(self) -> bool:
        """Whether it has a client, whose queue may hold frames."""

    @property
    def incoming_bytes(self) -> int:
        """Bytes that are kept of messages that came in part."""

    @property
    def unsent_bytes(self) -> int:
        """Bytes that the socket has still to take once the connection is being closed."""

    def fail(self, reason: CloseReason) -> None:
        """Close because of the client."""

    def abort(self) -> None:
        """Cut the connection off."""


class SharedLimits:
    """The limits of one hub.

    Args:
        connections: all connections, now and later.
        account: counts the bytes.
        audit: counts refused connections, and gets one event a second for each reason.
    """

    def __init__(
        self,
        settings: Settings,
        connections: Collection[Limited],
        account: Account,
        audit: Audit,
    ) -> None:
        self.clients = 0
        """Clients that are connected."""
        self.refused = 0
        """Connections refused so far."""
        self.quotas = Quotas(settings)
        """Limits that clients of one principal or one address share."""
        self.account = account
        self._settings = settings
        self._connections = connections
        self._audit = audit
        self._throttled = 0
        self._refusals: Counter[str] = Counter()
        """Connections refused since the last log line, by the reason."""
        queued = Bound(
            settings.max_total_queued_bytes,
            "--max-total-queued-bytes",
            "bytes wait for all clients",
            TOO_MUCH_QUEUED,
        )
        incoming = Bound(
            settings.max_total_incoming_bytes,
            "--max-total-incoming-bytes",
            "bytes are kept of incomplete messages of all clients",
            TOO_MUCH_INCOMING,
        )
        account.add("queues", AccountPart(self._queued, queued, is_metered=True))
        account.add("incoming", AccountPart(self._incoming, incoming, is_metered=True))

    # Connections.

    def admit(self, descriptor: int) -> bool:
        """Return whether a socket that was accepted may stay open.

        Args:
            descriptor: its number, which is the lowest that was free.
        """
        files = _most_files()
        if files is None or descriptor < files - min(LAST_FILES, files // 8):
            return True
        self.refuse(_files_reason(files))
        return False

    def refusal(self, descriptor: int) -> str | None:
        """Return why a client cannot connect now; None if it can."""
        files = _most_files()
        if self.clients >= self._settings.max_connections:
            most = self._settings.max_connections
            reason = f"the limit of {most} connections is reached (--max-connections)"
        elif files is not None and descriptor >= files - min(SPARE_FILES, files // 4):
            reason = _files_reason(files)
        else:
            return None
        self.refuse(reason)
        return f"The hub cannot accept more connections: {reason}; try again later"

    def handshake_refusal(self, address: str, now: float) -> str | None:
        """Return why an address may send no request now; None if it may.

        Log and count it in the audit: it is about one client only.
        """
        refusal = self.quotas.handshake_refusal(address, now)
        self.refused += refusal is not None
        return refusal

    def accept_failed(self, error: BaseException | None) -> bool:
        """Record that a connection could not be accepted; return whether the reason is known."""
        if not isinstance(error, OSError) or error.errno not in (errno.EMFILE, errno.ENFILE):
            return False
        files = _most_files()
        if error.errno == errno.EMFILE and files is not None:
            reason = _files_reason(files)
        else:
            reason = "the system's limit of open files is reached"
        self._refusals[reason] += 0  # Those who wait are accepted later.
        return True

    def refuse(self, reason: str) -> None:
        """Count a connection that one of the hub's ports has refused, and log it soon."""
        self._refusals[reason] += 1
        self.refused += 1
        self._audit.count("limit")

    def report_refusals(self) -> None:
        """Log the connections that were refused since the last time."""
        refusals, self._refusals = self._refusals, Counter()
        for reason, count in refusals.items():
            self._audit.connections_refused(reason, count)

    # Bytes.

    def queued_bytes(self) -> int:
        """Return the bytes that wait for all clients, also those that several clients share."""
        return sum(_queued_bytes(each) for each in self._connections if each.is_open)

    def incoming_bytes(self) -> int:
        """Return the bytes that are kept of messages that came in part."""
        return sum(each.incoming_bytes for each in self._connections)

    def _queued(self) -> Iterator[Holding]:
        """Yield what waits for each client."""
        for each in self._connections:
            if each.is_open and (each.queue.kept_bytes or each.unsent_bytes):
                yield Holding(
                    each.owner,
                    partial(_queued_bytes, each),
                    shorten=partial(_shorten, each),
                    end=partial(_end, each),
                    shared=_SharedQueue(each),
                    is_stranger=each.is_stranger,
                )

    def _incoming(self) -> Iterator[Holding]:
        """Yield what each connection has sent in part."""
        for each in self._connections:
            if each.incoming_bytes:
                yield Holding(
                    each.owner,
                    partial(_incoming_bytes, each),
                    end=partial(_end, each),
                    is_stranger=each.is_stranger,
                )

    # Once a second.

    def sweep(self, now: float) -> None:
        """Log refused connections and drops, and count the messages that throttles hold back."""
        self.quotas.sweep(now)
        throttled = sum(each.queue.throttled_bytes for each in self._connections if each.is_open)
        self.account.grow(max(0, throttled - self._throttled))
        self._throttled = throttled
        self.report_refusals()
        self.account.sweep()


def _queued_bytes(connection: Limited) -> int:
    queue = connection.queue
    return queue.kept_bytes + queue.begun_bytes + connection.unsent_bytes


class _SharedQueue:
    """A queue whose large messages may be those of other queues, too.

    Small ones count for each queue: there may be millions, which take long to compare.
    """

    def __init__(self, connection: Limited) -> None:
        self._connection = connection

    @property
    def _has_large(self) -> bool:
        queue = self._connection.queue
        return queue.kept_bytes > SMALL * queue.kept_messages

    @property
    def own_bytes(self) -> int:
        connection = self._connection
        return connection.queue.own_bytes if self._has_large else _queued_bytes(connection)

    def buffers(self) -> Iterator[Any]:
        return self._connection.queue.buffers() if self._has_large else iter(())


def _incoming_bytes(connection: Limited) -> int:
    return connection.incoming_bytes


def _shorten(connection: Limited, size: int, least: int, bound: Bound) -> None:
    connection.queue.shorten(size, least)


def _end(connection: Limited, bound: Bound) -> None:
    """Close a connection, and cut it off if it still takes memory."""
    connection.fail(bound.reason)
    if connection.unsent_bytes > MOST_UNSENT:
        connection.abort()


def _files_reason(files: int) -> str:
    return f"the limit of {files} open files is reached (ulimit -n)"


def _most_files() -> int | None:
    """Return how many files the process may have open; None if unlimited or unknown."""
    if sys.platform == "win32":  # Its sockets have no small numbers.
        return None
    import resource

    soft, _ = resource.getrlimit(resource.RLIMIT_NOFILE)
    return None if soft == resource.RLIM_INFINITY else soft
