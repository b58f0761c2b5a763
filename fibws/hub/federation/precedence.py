"""Which one of two nodes, services or actions of one name stays: rules for all hubs.

Where two hubs meet that have a node of one name each, the older node stays: nobody has replaced it
on purpose. A node that connects while its hub knows of another one replaces that, as ROS's master
has it. Of two services, and of two actions, the newer one is used, as in ROS.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

from fibws.hub.federation.announced import PeerGraph
from fibws.hub.federation.records import Kind, NodeRecord

SAME_AGE = 200_000_000
"""Nanoseconds by which the ages of two nodes must differ to tell which is the older one: the
difference of two hubs' clocks is known that well."""


class NodeOffer(NamedTuple):
    """A node as one hub has announced it."""

    home: PeerGraph
    record: NodeRecord
    since: int
    """When it connected, by the clock of this hub."""


class Ages:
    """Since when the nodes, services and actions of this hub are there, and what they replaced.

    Args:
        hub: the id of this hub.
        now: returns the nanoseconds since 1970.
    """

    def __init__(self, hub: str, now: Callable[[], int]) -> None:
        self._hub = hub
        self._now = now
        self._since: dict[tuple[Kind, str], tuple[object, int]] = {}
        self._replaced: dict[tuple[Kind, str], tuple[str, int]] = {}
        """The hub and the ``since`` of the remote ones that have been replaced."""

    def note(self, kind: Kind, name: str, own: object | None, *, is_remote: bool = False) -> None:
        """Record which node, service or action has a name now.

        Args:
            own: the node, service or action if it is of this hub.
            is_remote: whether one of another hub has the name.
        """
        known = self._since.get((kind, name))
        if own is None:
            self._since.pop((kind, name), None)
            if not is_remote:
                self._replaced.pop((kind, name), None)
        elif known is None or known[0] is not own:
            self._since[kind, name] = own, self._now()

    def replaced(self, kind: Kind, name: str, hub: str, since: int) -> None:
        """Record that an owner on this hub has replaced one on another hub."""
        self._replaced[kind, name] = hub, since

    def forget_replaced(self, kind: Kind, name: str) -> None:
        """Record that an owner on another hub has the name again."""
        self._replaced.pop((kind, name), None)

    def since(self, kind: Kind, name: str) -> int:
        """Return since when one of this hub is there."""
        found = self._since.get((kind, name))
        return found[1] if found is not None else self._now()

    def replaced_hub(self, kind: Kind, name: str) -> str:
        """Return the id of the hub whose node, service or action has been replaced."""
        found = self._replaced.get((kind, name))
        return found[0] if found is not None else ""

    def was_replaced(self, kind: Kind, name: str, hub: str, since: int) -> bool:
        """Return whether this very one was replaced, which its hub does not know yet."""
        return self._replaced.get((kind, name)) == (hub, since)

    def is_own_older(self, offer: NodeOffer, name: str) -> bool:
        """Return whether a node of this hub is older than one of another hub."""
        own = self.since("nodes", name)
        if abs(own - offer.since) < SAME_AGE:
            return self._hub < offer.record.hub.id
        return own < offer.since

    def is_own_newer(self, kind: Kind, name: str, since: int) -> bool:
        """Return whether this hub has a service or an action that is newer."""
        found = self._since.get((kind, name))
        return found is not None and found[1] >= since


def choose(offers: Sequence[NodeOffer]) -> NodeOffer | None:
    """Return the node of another hub that has a name: the one with the shortest way."""
    replaced = {offer.record.replaces for offer in offers}
    left = [offer for offer in offers if offer.record.hub.id not in replaced] or offers
    if not left:
        return None
    oldest = min(left, key=lambda offer: (offer.since // SAME_AGE, offer.record.hub.id))
    same = [offer for offer in left if offer.record.hub.id == oldest.record.hub.id]
    return min(same, key=lambda offer: len(offer.record.path))
