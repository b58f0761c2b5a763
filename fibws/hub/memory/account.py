"""One account of the bytes that the hub holds for clients, and who loses some when it is full.

Each part of the hub that holds bytes for others adds itself to the account: what waits for clients,
messages that came in part, latched messages and wills, files on their way, a recording's buffer.
All parts together have one bound, and some have one of their own.

When a bound is exceeded, clients that have not logged in are closed first. Then each owner may keep
an equal share, and so may each of its holdings: those that hold more lose their oldest messages. If
that is not enough, because the rest cannot be dropped, the largest holding of the owner that holds
most ends, and so on. Owners who hold little lose nothing.

Bytes are counted only after so many new ones that a bound may be reached.
"""

from __future__ import annotations

import logging
from collections import Counter, defaultdict
from collections.abc import Callable, Iterable, Iterator, Mapping
from functools import partial
from heapq import heapify, heappop, heappush
from typing import Any, NamedTuple, Protocol

from fibws.hub.delivery.byte_allowance import ByteAllowance
from fibws.protocol.websocket import CloseReason

logger = logging.getLogger("fibws.hub")

SPARE = 16
"""Shares of a bound: one of them stays free when bytes had to go, and so many bytes come before the
next count at least."""
RESERVED = 8
"""What bounds itself may have one of so many shares of the account."""


class Bound(NamedTuple):
    """Most bytes of a part, or of all.

    Attributes:
        setting: its name, such as ``--max-memory``.
        what: the bytes that it bounds, for the log.
        reason: for a client that is closed because of it.
    """

    limit: int
    setting: str
    what: str
    reason: CloseReason


def total_bound(limit: int) -> Bound:
    """Return the bound of the whole account."""
    reason = "the hub's memory for all clients is full (--max-memory); this one had the most"
    what = "bytes are held for all clients"
    return Bound(limit, "--max-memory", what, CloseReason(1013, reason))


class SharedQueue(Protocol):
    """A queue whose messages may be those of other queues, too: a send queue."""

    @property
    def own_bytes(self) -> int:
        """Bytes that no other queue holds."""

    def buffers(self) -> Iterator[Any]:
        """Yield the holders of the other bytes."""


class Holding:
    """Bytes of one kind that are held for one owner.

    Args:
        owner: who holds them: a principal, or a client on a hub without authentication.
        measure: returns how many there are.
        shorten: drops the oldest until so many bytes are left, or so many messages, because of a
            bound; what cannot be dropped stays.
        end: gives up all of them, such as by closing the client's connection.
        shared: the queue that they are in, if others may hold the same bytes.
    """

    __slots__ = ("_shared", "end", "is_stranger", "measure", "owner", "shorten", "size")

    def __init__(
        self,
        owner: str,
        measure: Callable[[], int],
        *,
        shorten: Callable[[int, int, Bound], object] = lambda size, least, bound: None,
        end: Callable[[Bound], object] = lambda bound: None,
        shared: SharedQueue | None = None,
        is_stranger: bool = False,
    ) -> None:
        self.owner = owner
        self.measure = measure
        self.shorten = shorten
        self.end = end
        self.is_stranger = is_stranger
        self.size = 0
        """Bytes as of the last count."""
        self._shared = shared

    def own_bytes(self) -> int:
        """Return the bytes that no other holding has."""
        return self.measure() if self._shared is None else self._shared.own_bytes

    def buffers(self) -> Iterable[Any]:
        """Return the holders of its other bytes."""
        return () if self._shared is None else self._shared.buffers()


class AccountPart(NamedTuple):
    """Something that holds bytes.

    Attributes:
        holdings: returns those that are not empty.
        bound: for this part alone.
        reserve: bytes that it may take without being asked; None unless it bounds itself. Others
            never get these.
        is_metered: whether `Account.grow` is called when it grows; else it is counted each second.
    """

    holdings: Callable[[], Iterable[Holding]]
    bound: Bound | None = None
    reserve: int | None = None
    is_metered: bool = False


class Account:
    """All bytes that one hub holds for clients.

    Args:
        limit: most bytes.
        call_soon: calls a function in the next iteration of the event loop: nobody may be closed
            while a message is on its way to it.
    """

    def __init__(
        self, limit: int, call_soon: Callable[[Callable[[], None]], object] = lambda check: None
    ) -> None:
        self.bound = total_bound(limit)
        self.allowance = ByteAllowance(lambda: call_soon(self.check))
        """Counts down the bytes that may come until the next count."""
        self._parts: dict[str, AccountPart] = {}
        self._reached: dict[Bound, None] = {}
        """The bounds that were exceeded since the last log line."""
        self._unmetered = 0
        """Bytes of the parts that are not metered, as of the last look."""
        self.allowance.allow(limit)

    @property
    def reserved(self) -> int:
        """The bytes that a part may take that bounds itself and loses nothing here."""
        return self.bound.limit // RESERVED

    def add(self, name: str, part: AccountPart) -> None:
        """Add a part; several may have one name, under which they are shown together."""
        self._parts[f"{name} {len(self._parts)}"] = part
        if part.bound is not None:
            self.allowance.left = min(self.allowance.left, part.bound.limit)

    def add_fixed(self, name: str, measure: Callable[[], int], reserve: int) -> None:
        """Add a part that bounds itself; arguments as of `Holding` and `AccountPart`."""
        self.add(name, AccountPart(partial(list, [Holding("", measure)]), reserve=reserve))

    def grow(self, size: int) -> None:
        """Count bytes that are held from now on."""
        allowance = self.allowance
        allowance.left -= size
        if allowance.left < 0:
            allowance.check()

    def held(self) -> Mapping[str, int]:
        """Return the bytes of each part; those that several clients share count for each."""
        found: Counter[str] = Counter()
        for name, part in self._parts.items():
            found[name.partition(" ")[0]] += _measure(part.holdings())
        return found

    def total(self) -> int:
        """Return the bytes that are held, each once."""
        return _weigh([each for part in self._parts.values() for each in part.holdings()])

    def check(self) -> None:
        """Count the bytes; where there are too many, those who hold most lose some."""
        left: list[float] = []
        holdings: list[Holding] = []
        fixed = 0
        for part in self._parts.values():
            found = list(part.holdings())
            if part.reserve is not None:
                fixed += max(part.reserve, _measure(found))
                continue
            holdings += found
            if part.bound is not None:
                limit = part.bound.limit
                total = self._fit(found, part.bound, limit, _measure)
                left.append(max(limit - total, limit // SPARE))
        spare = self.bound.limit // SPARE  # So much may come before the next count.
        limit = max(self.bound.limit - spare - fixed, self.bound.limit // RESERVED)
        total = _measure(holdings)
        if total > limit:
            total = self._fit(holdings, self.bound, limit, _weigh)
        self.allowance.allow(min(max(limit - total, spare), *left, limit))

    def sweep(self) -> None:
        """Count what has come without being reported, and log the bounds that were exceeded.

        To be called once a second.
        """
        parts = [part for part in self._parts.values() if not part.is_metered]
        held = sum(_measure(part.holdings()) for part in parts)
        self.grow(max(0, held - self._unmetered))
        self._unmetered = held
        reached, self._reached = self._reached, {}
        for bound in reached:
            logger.warning(
                "More than %d %s (%s): those with the most lose some.",
                *(bound.limit, bound.what, bound.setting),
            )

    def _fit(
        self,
        holdings: list[Holding],
        bound: Bound,
        limit: int,
        count: Callable[[Iterable[Holding]], int],
    ) -> int:
        """Make holdings fit a limit, and return the bytes that are left."""
        total = count(holdings)
        if total <= limit:
            return total
        self._reached[bound] = None
        remaining, closed = _close_strangers(holdings, total - limit, bound)
        if total - closed <= limit:
            return total - closed
        target = limit - limit // SPARE
        shares = _fair_shares(remaining, target)
        _shorten(shares, total - closed - target, bound)
        if count(remaining) > limit:
            _clear(shares, limit, bound)
        return count(holdings)


def _measure(holdings: Iterable[Holding]) -> int:
    """Count bytes; those that several share count for each."""
    total = 0
    for each in holdings:
        each.size = each.measure()
        total += each.size
    return total


def _weigh(holdings: Iterable[Holding]) -> int:
    """Count bytes once: of what several share, each has a part."""
    found = list(holdings)
    shared = Counter(id(buffer) for each in found for buffer in each.buffers())
    total = 0
    for each in found:
        parts = sum(len(buffer) / shared[id(buffer)] for buffer in each.buffers())
        each.size = each.own_bytes() + round(parts)
        total += each.size
    return total


def _shorten(shares: dict[Holding, int], surplus: float, bound: Bound) -> None:
    """Drop the oldest messages of those that hold most until the surplus is gone.

    Some drop more than they must, since a message is large: then others keep theirs.
    """
    for each in _most_first(shares):
        if surplus <= 0:
            break
        before = each.measure()
        if each.size > shares[each]:
            each.shorten(shares[each], 1, bound)
            surplus -= each.size * (1 - each.measure() / before)


def _clear(shares: dict[Holding, int], limit: int, bound: Bound) -> None:
    """Drop all messages of those that hold most, and end what is left if that is not enough."""
    shared = Counter(id(buffer) for each in shares for buffer in each.buffers())
    sizes = {id(buffer): len(buffer) for each in shares for buffer in each.buffers()}
    total = sum(sizes.values()) + sum(each.own_bytes() for each in shares)
    for each in _most_first(shares):
        if total <= limit:
            break
        if each.size <= shares[each]:
            continue
        total -= each.own_bytes()
        for buffer in each.buffers():
            shared[id(buffer)] -= 1
            if not shared[id(buffer)]:
                total -= sizes[id(buffer)]
        each.shorten(shares[each], 0, bound)
        if each.measure() > shares[each]:
            each.end(bound)
        total += each.measure()


def _close_strangers(
    holdings: list[Holding], surplus: int, bound: Bound
) -> tuple[list[Holding], int]:
    """Close clients that have not logged in, those with most first, until the surplus is gone.

    Returns:
        What others hold, and the bytes that are gone.
    """
    strangers = [each for each in holdings if each.is_stranger]
    closed = 0
    for each in sorted(strangers, key=_size, reverse=True):
        if closed >= surplus:
            break
        each.end(bound)
        closed += each.size
    return [each for each in holdings if not each.is_stranger], closed


def _size(holding: Holding) -> int:
    return holding.size


def _by_owner(holdings: Iterable[Holding]) -> list[list[Holding]]:
    """Return the holdings of each owner; the sizes of each list rise."""
    found: defaultdict[str, list[Holding]] = defaultdict(list)
    for each in sorted(holdings, key=_size):
        found[each.owner].append(each)
    return list(found.values())


def _most_first(holdings: Iterable[Holding]) -> Iterator[Holding]:
    """Yield, each time, the largest holding of the owner whose remaining ones are most."""
    groups = _by_owner(holdings)
    totals = [(-sum(map(_size, group)), index) for index, group in enumerate(groups)]
    heapify(totals)
    while totals:
        total, index = heappop(totals)
        each = groups[index].pop()
        if groups[index]:
            heappush(totals, (total + each.size, index))
        yield each


def _fair_shares(holdings: list[Holding], limit: int) -> dict[Holding, int]:
    """Return the bytes that each holding may keep so that all fit the limit.

    Owners have equal shares, and so have the holdings of each of them.
    """
    groups = _by_owner(holdings)
    totals = [sum(map(_size, group)) for group in groups]
    most = _fair_share(sorted(totals, reverse=True), limit)
    shares: dict[Holding, int] = {}
    for group, total in zip(groups, totals, strict=True):
        share = group[-1].size
        if total > most:
            share = _fair_share([each.size for each in reversed(group)], most)
        shares.update((each, share) for each in group)
    return shares


def _fair_share(sizes: list[int], limit: int) -> int:
    """Return the largest size so that all, cut to it, fit the limit; ``sizes`` fall."""
    for count in range(len(sizes), 0, -1):
        share = limit // count
        if sizes[count - 1] >= share:
            return share
        limit -= sizes[count - 1]
    return limit
