"""Limits for all connections together: how many there may be, and the bytes kept for them.

Limits of one client do not bound a thousand clients. If there are too many bytes, clients that
have not logged in are closed first; then the principal that holds most pays, by its connection that
holds most. On an open hub all clients are of one principal.
Bytes are counted only after enough new ones that the limit may be reached.
"""

from __future__ import annotations

import errno
import logging
import sys
from collections import Counter, defaultdict
from collections.abc import Callable, Collection, Iterable, Iterator
from heapq import heapify, heappop, heappush
from typing import Protocol

from fibws.access.rights import Principal
from fibws.hub.audit import Audit
from fibws.hub.delivery.byte_allowance import ByteAllowance
from fibws.hub.delivery.send_queue import SendQueue
from fibws.hub.settings import Settings
from fibws.hub.websocket.quotas import Quotas
from fibws.protocol.websocket import CloseReason

logger = logging.getLogger("fibws.hub")

SPARE_FILES = 32
"""File descriptors that clients may not take: they are for plain HTTP requests, and for refusing
clients with a text."""
LAST_FILES = 8
"""File descriptors that no connection may take."""
TOO_MUCH_QUEUED = CloseReason(1013, "too many bytes wait for all clients; this one had the most")
TOO_MUCH_INCOMING = CloseReason(
    1013, "too many bytes of incomplete messages of all clients; this one had the most"
)


class Limited(Protocol):
    """A connection, as far as it is limited here."""

    queue: SendQueue

    @property
    def principal(self) -> Principal | None:
        """The client's principal; None on an open hub, and before its login."""

    @property
    def is_stranger(self) -> bool:
        """Whether it has no client yet, or one that has still to log in."""

    @property
    def is_open(self) -> bool:
        """Whether it has a client, whose queue may hold frames."""

    @property
    def incoming_bytes(self) -> int:
        """Bytes that are kept of messages that came in part."""

    def fail(self, reason: CloseReason) -> None:
        """Close because of the client."""


class SharedLimits:
    """The limits of one hub.

    Args:
        connections: all connections, now and later.
        call_soon: calls a function in the next iteration of the event loop: a client must not be
            closed while a message is on its way to it.
        audit: counts refused connections, and gets one event a second for each reason.
    """

    def __init__(
        self,
        settings: Settings,
        connections: Collection[Limited],
        call_soon: Callable[[Callable[[], None]], object],
        audit: Audit,
    ) -> None:
        self.clients = 0
        """Clients that are connected."""
        self.refused = 0
        """Connections refused so far."""
        self.quotas = Quotas(settings)
        """Limits that clients of one principal or one address share."""
        self.queued = ByteAllowance(lambda: call_soon(self.check_queued))
        """Counts down the bytes that may still wait for clients."""
        self.incoming = ByteAllowance(lambda: call_soon(self.check_incoming))
        """Counts down the bytes that clients may still send."""
        self._settings = settings
        self._connections = connections
        self._audit = audit
        self._throttled = 0
        self._refusals: Counter[str] = Counter()
        """Connections refused since the last log line, by the reason."""
        self._shortened = False
        """Whether queues have been shortened since the last log line."""
        self.queued.allow(settings.max_total_queued_bytes)
        self.incoming.allow(settings.max_total_incoming_bytes)

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
        """Take note that a connection could not be accepted; return whether that is understood."""
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
        return sum(each.queue.kept_bytes for each in self._clients())

    def incoming_bytes(self) -> int:
        """Return the bytes that are kept of messages that came in part."""
        return sum(each.incoming_bytes for each in self._connections)

    def check_queued(self) -> None:
        """Shorten the longest queues if all together are too long.

        Their oldest messages are dropped, so that the principals with the most all have equally
        many bytes left, and of each of them its clients with the most, but at least their newest
        message. If even that is too much, clients lose their newest, too, and those with too many
        replies are closed.
        """
        limit = self._settings.max_total_queued_bytes
        holding = [(size, each) for each in self._clients() if (size := each.queue.kept_bytes)]
        if (total := sum(size for size, _ in holding)) > limit:
            self._shortened = True
            total -= _close_strangers(holding, total - limit, TOO_MUCH_QUEUED)
        if total > limit:
            shares = _fair_shares(holding, limit - limit // 16)
            for each, share in shares.items():
                each.queue.shorten(share)
            if (total := _kept(shares)) > limit:
                self._clear(shares, limit)
                total = _kept(shares)
        self.queued.allow(max(limit - total, limit // 16))

    def _clear(self, shares: dict[Limited, int], limit: int) -> None:
        """Drop all messages of those that hold most, and close them if that is not enough."""
        shared = Counter(id(buffer) for each in shares for buffer in each.queue.buffers())
        sizes = {id(buffer): len(buffer) for each in shares for buffer in each.queue.buffers()}
        total = sum(sizes.values()) + sum(each.queue.own_bytes for each in shares)
        for _, each in _most_first([(each.queue.kept_bytes, each) for each in shares]):
            if total <= limit:
                break
            total -= each.queue.own_bytes
            for buffer in each.queue.buffers():
                shared[id(buffer)] -= 1
                if not shared[id(buffer)]:
                    total -= sizes[id(buffer)]
            each.queue.shorten(shares[each], least=0)
            if each.queue.kept_bytes > shares[each]:
                each.fail(TOO_MUCH_QUEUED)
            else:
                total += each.queue.kept_bytes

    def check_incoming(self) -> None:
        """Close the clients that have sent most in part if that is too much of all."""
        limit = self._settings.max_total_incoming_bytes
        holding = [(size, each) for each in self._connections if (size := each.incoming_bytes)]
        total = sum(size for size, _ in holding)
        if total > limit:
            total -= _close_strangers(holding, total - limit, TOO_MUCH_INCOMING)
            for size, each in _most_first(holding):
                if total <= limit:
                    break
                each.fail(TOO_MUCH_INCOMING)
                total -= size
        self.incoming.allow(max(limit - total, limit // 16))

    def _clients(self) -> Iterable[Limited]:
        return (each for each in self._connections if each.is_open)

    # Once a second.

    def sweep(self, now: float) -> None:
        """Log refused connections and drops, and count the messages that throttles hold back."""
        self.quotas.sweep(now)
        throttled = sum(each.queue.throttled_bytes for each in self._clients())
        self.queued.left -= max(0, throttled - self._throttled)
        self._throttled = throttled
        if self.queued.left < 0:
            self.queued.check()
        self.report_refusals()
        if self._shortened:
            self._shortened = False
            logger.warning(
                "More than %d bytes wait for all clients (--max-total-queued-bytes): "
                "messages of those with the most are dropped.",
                self._settings.max_total_queued_bytes,
            )


def _kept(connections: Iterable[Limited]) -> int:
    return sum(each.queue.kept_bytes for each in connections)


def _close_strangers(holding: list[tuple[int, Limited]], surplus: int, reason: CloseReason) -> int:
    """Close clients that have not logged in, those with most first, until the surplus is gone.

    All of them leave ``holding``.

    Returns:
        The bytes that were kept for those closed.
    """
    closed = 0
    for size, each in sorted(holding, key=lambda pair: pair[0], reverse=True):
        if each.is_stranger and closed < surplus:
            each.fail(reason)
            closed += size
    holding[:] = [pair for pair in holding if not pair[1].is_stranger]
    return closed


def _by_principal(holding: Iterable[tuple[int, Limited]]) -> list[list[tuple[int, Limited]]]:
    """Return the clients of each principal; the sizes of each list rise."""
    found: defaultdict[str, list[tuple[int, Limited]]] = defaultdict(list)
    for size, each in sorted(holding, key=lambda pair: pair[0]):
        found[each.principal.name if each.principal is not None else ""].append((size, each))
    return list(found.values())


def _most_first(holding: Iterable[tuple[int, Limited]]) -> Iterator[tuple[int, Limited]]:
    """Yield, each time, the largest client of the principal whose remaining clients hold most."""
    groups = _by_principal(holding)
    totals = [(-sum(size for size, _ in group), index) for index, group in enumerate(groups)]
    heapify(totals)
    while totals:
        total, index = heappop(totals)
        size, each = groups[index].pop()
        if groups[index]:
            heappush(totals, (total + size, index))
        yield size, each


def _fair_shares(holding: list[tuple[int, Limited]], limit: int) -> dict[Limited, int]:
    """Return the bytes that each client may keep so that all fit the limit.

    Principals have equal shares, and so have the clients of each of them.
    """
    groups = _by_principal(holding)
    totals = [sum(size for size, _ in group) for group in groups]
    most = _fair_share(sorted(totals, reverse=True), limit)
    shares: dict[Limited, int] = {}
    for group, total in zip(groups, totals, strict=True):
        share = group[-1][0]
        if total > most:
            share = _fair_share([size for size, _ in reversed(group)], most)
        shares.update((each, share) for _, each in group)
    return shares


def _fair_share(sizes: list[int], limit: int) -> int:
    """Return the largest size so that all, cut to it, fit the limit; ``sizes`` fall."""
    for count in range(len(sizes), 0, -1):
        share = limit // count
        if sizes[count - 1] >= share:
            return share
        limit -= sizes[count - 1]
    return limit


def _files_reason(files: int) -> str:
    return f"the limit of {files} open files is reached (ulimit -n)"


def _most_files() -> int | None:
    """Return how many files the process may have open; None if unlimited or unknown."""
    if sys.platform == "win32":  # Its sockets have no small numbers.
        return None
    import resource

    soft, _ = resource.getrlimit(resource.RLIMIT_NOFILE)
    return None if soft == resource.RLIM_INFINITY else soft
