"""The bytes of latched messages and wills: of one node, and of all together."""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Callable
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
        self.latched: OrderedDict[Latching, None] = OrderedDict()
        """The sources with a latched message, the oldest first."""

    @property
    def exceeded(self) -> bool:
        """Whether more is used than allowed."""
        return self.limit is not None and self.used > self.limit

    def add(self, size: int) -> None:
        """Count bytes that are kept from now on; negative ones are not kept any more."""
        self.used += size
        self.total.count(self, size)

    def shorten(self, size: int, why: str) -> None:
        """Drop the oldest latched messages until ``size`` bytes are left; wills stay."""
        dropped = 0
        first = ""
        while self.used > size and self.latched:
            source = next(iter(self.latched))
            first = first or source.name
            source.forget_latched()
            dropped += 1
        if dropped:
            self.total.dropped += dropped
            more = f" and of {dropped - 1} more topics" if dropped > 1 else ""
            self.report(f"the message of {first}{more} is not latched any more: {why}")


class LatchTotal:
    """The bytes of the latched messages and the wills of all nodes together."""

    def __init__(self) -> None:
        self.used = 0
        self.dropped = 0
        """Latched messages that were dropped so far, for lack of room."""
        self.quotas: dict[LatchQuota, None] = {}
        """The quotas in which bytes are kept."""
        self.on_grow: Callable[[int], object] = lambda size: None
        """Called with the bytes that are kept from now on."""

    def count(self, quota: LatchQuota, size: int) -> None:
        """Count bytes of a quota."""
        self.used += size
        if quota.used:
            self.quotas[quota] = None
        else:
            self.quotas.pop(quota, None)
        if size > 0:
            self.on_grow(size)
