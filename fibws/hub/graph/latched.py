"""Bounds for the bytes of latched messages and wills: of one node, and of all together."""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Callable
from heapq import heapify, heappop, heappush
from typing import Protocol


class Latching(Protocol):
    """A source, as far as its latched message is bounded here."""

    @property
    def name(self) -> str:
        """The name of its topic."""

    def forget_latched(self) -> None:
        """Keep no latched message any more."""


class LatchQuota:
    """Bytes that the latched messages and the wills of one node may take together.

    Args:
        limit: most bytes; None for no limit.
        total: counts the bytes of all nodes; None counts those of this one alone.
        node: the node's name; empty for a node outside of the hub, which counts for itself.
        report: tells the node that messages are latched no more.
    """

    __slots__ = ("latched", "limit", "node", "report", "total", "used")

    def __init__(
        self,
        limit: int | None = None,
        total: LatchTotal | None = None,
        node: str = "",
        report: Callable[[str], object] = lambda text: None,
    ) -> None:
        self.limit = limit
        self.total = total or LatchTotal()
        self.node = node
        self.report = report
        self.used = 0
        self.latched: dict[Latching, None] = {}
        """The sources with a latched message, the oldest first."""

    @property
    def exceeded(self) -> bool:
        """Whether more is used than allowed."""
        return self.limit is not None and self.used > self.limit

    def add(self, size: int) -> None:
        """Count bytes that are kept from now on; negative ones are not kept any more."""
        self.used += size
        self.total.count(self, size)


class LatchTotal:
    """Bytes that the latched messages and the wills of all nodes may take together.

    If there are too many, the owner who holds most pays, by the node of its that holds most: that
    loses its oldest latched messages. Wills stay.

    Args:
        limit: most bytes; None for no limit.
        owner_of: returns who owns a node, whose nodes pay together.
    """

    def __init__(
        self, limit: int | None = None, owner_of: Callable[[str], str] = lambda node: node
    ) -> None:
        self.limit = limit
        self.used = 0
        self.dropped = 0
        """Latched messages that were dropped so far."""
        self._owner_of = owner_of
        self._quotas: dict[LatchQuota, None] = {}
        """Those of which anything is kept."""

    def count(self, quota: LatchQuota, size: int) -> None:
        """Count bytes of a quota."""
        self.used += size
        if quota.used:
            self._quotas[quota] = None
        else:
            self._quotas.pop(quota, None)

    def has_room(self, size: int) -> bool:
        """Return whether there is room, perhaps after latched messages are dropped."""
        if self.limit is None or self.used + size <= self.limit:
            return True
        if size > self.limit:
            return False
        self._shorten(self.limit - size)
        return self.used + size <= self.limit

    def make_room(self) -> None:
        """Drop latched messages if there are too many bytes."""
        if self.limit is not None and self.used > self.limit:
            self._shorten(self.limit - self.limit // 16)  # Not again for the next message.

    def _shorten(self, size: int) -> None:
        """Drop latched messages until ``size`` bytes are left."""
        dropped: Counter[LatchQuota] = Counter()
        names: dict[LatchQuota, str] = {}
        holders = _Holders(self._quotas, self._owner_of)
        while self.used > size and (quota := holders.largest()) is not None:
            source = next(iter(quota.latched))
            names.setdefault(quota, source.name)
            source.forget_latched()
            dropped[quota] += 1
        for quota, count in dropped.items():
            self.dropped += count
            more = f" and of {count - 1} more topics" if count > 1 else ""
            quota.report(
                f"the message of {names[quota]}{more} is not latched any more: the latched "
                f"messages of all clients may take {self.limit} bytes (--max-total-latched-bytes)"
            )


class _Holders:
    """Finds, each time, the largest quota of the owner who holds most."""

    def __init__(self, quotas: dict[LatchQuota, None], owner_of: Callable[[str], str]) -> None:
        groups: defaultdict[object, list[LatchQuota]] = defaultdict(list)
        for quota in quotas:
            groups[owner_of(quota.node) if quota.node else quota].append(quota)
        self._groups = [
            [(-each.used, number, each) for number, each in enumerate(group) if each.latched]
            for group in groups.values()
        ]
        self._order = [
            (-sum(each.used for each in group), index)
            for index, group in enumerate(groups.values())
        ]
        for group in self._groups:
            heapify(group)
        heapify(self._order)
        self._last: tuple[int, int, int, LatchQuota] | None = None

    def largest(self) -> LatchQuota | None:
        """Return a quota with a latched message, of which the oldest is dropped until next time."""
        if self._last is not None:
            total, index, number, quota = self._last
            before = -heappop(self._groups[index])[0]
            if quota.latched:
                heappush(self._groups[index], (-quota.used, number, quota))
            heappop(self._order)
            heappush(self._order, (total + before - quota.used, index))
        while self._order:
            total, index = self._order[0]
            if self._groups[index]:
                _, number, quota = self._groups[index][0]
                self._last = (total, index, number, quota)
                return quota
            heappop(self._order)
        return None
