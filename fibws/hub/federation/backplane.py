"""The port by which a hub reaches others: a WebSocket link or a zenoh network.

A backplane carries announcements, messages and requests, and knows no topics or nodes. The hub's
`Federation` gives it what is to be announced, and takes what arrives as a `Network`.
"""

from __future__ import annotations

import logging
import math
from abc import ABC, abstractmethod
from collections.abc import Callable, Collection, Iterator
from dataclasses import dataclass, field, fields
from typing import Protocol, TypeAlias

from fibws.access.rights import Principal
from fibws.hub.federation.names import NameView
from fibws.hub.federation.records import Announcement, HubInfo, LinkMessage, Reply, Request

QUICKEST_GROWTH = 1.02
"""The growth, with each ping, of the time in which an answer counts as quick."""

logger = logging.getLogger("fibws.hub")

OnReply: TypeAlias = Callable[[Reply], object]
Cancel: TypeAlias = Callable[[], None]


@dataclass(slots=True)
class Traffic:
    """Messages and bytes exchanged with another hub."""

    messages_sent: int = 0
    messages_received: int = 0
    bytes_sent: int = 0
    bytes_received: int = 0
    dropped: int = 0
    """Messages that were not sent, as the other hub or the network was too slow."""
    lost: int = 0
    """Messages that were sent and have not arrived."""

    def plus(self, other: Traffic) -> Traffic:
        """Return both together."""
        return Traffic(
            *(getattr(self, each.name) + getattr(other, each.name) for each in fields(Traffic))
        )


@dataclass(slots=True, eq=False)
class Peer:
    """Another hub, as a backplane reaches it directly.

    Attributes:
        hub: which one it is.
        address: where, for people.
        round_trip: seconds that a ping takes; None before the first.
        clock_offset: seconds by which its clock is ahead of this hub's; None before the first ping.
        connected: when it was reached, in nanoseconds since 1970.
    """

    hub: HubInfo
    backplane: Backplane
    address: str = ""
    round_trip: float | None = None
    clock_offset: float | None = None
    connected: int = 0
    traffic: Traffic = field(default_factory=Traffic)
    _quickest: float = math.inf
    """Seconds of the quickest answer to a ping of late."""

    def measured(self, sent: int, theirs: int, now: int) -> None:
        """Take the answer to a ping; times are in nanoseconds since 1970.

        Args:
            theirs: when the other hub has answered, by its own clock.
        """
        seconds = max(0, now - sent) / 1e9
        average = self.round_trip
        self.round_trip = seconds if average is None else average + (seconds - average) / 8
        self._quickest *= QUICKEST_GROWTH
        if seconds <= self._quickest:
            # The quickest answer tells the offset best: its error is at most half the time.
            self._quickest = seconds
            offset = (theirs - (sent + now) / 2) / 1e9
            self.clock_offset = offset if abs(offset) > seconds / 2 else 0.0


class Backplane(ABC):
    """A way to one hub or several.

    What has come by a backplane is never announced on it.

    Attributes:
        kind: ``join``, ``accept`` or ``zenoh``.
        view: translates and filters names.
        node: the node of this graph that stands for the backplane, and whose rights the other hubs
            have.
        principal: whose rights these are; None on a hub without authentication.
    """

    kind: str
    view: NameView
    node: str
    principal: Principal | None

    @property
    @abstractmethod
    def peers(self) -> Collection[Peer]:
        """The hubs that it reaches at present."""

    @property
    @abstractmethod
    def is_busy(self) -> bool:
        """Whether announcements would wait; `Network.idle` is called once they do not."""

    @property
    def waiting_bytes(self) -> int:
        """Bytes that wait for the network, and from it."""
        return 0

    @property
    def incomplete_bytes(self) -> int:
        """Bytes that are kept of records that came in part."""
        return 0

    def shorten(self, size: int) -> None:
        """Drop the oldest messages that wait until ``size`` bytes are left, as far as possible."""
        return

    def give_up(self) -> None:
        """Close the connection, if it has one: too much is held for it."""
        return

    @abstractmethod
    def leave(self, peer: Peer) -> None:
        """Leave a hub that has announced too much; it may join again later."""

    @abstractmethod
    def announce(self, announcement: Announcement) -> None:
        """Send changes of what this hub has to all hubs."""

    @abstractmethod
    def publish(self, message: LinkMessage, *, limit: int) -> None:
        """Send a message to the hubs that are interested in its publisher.

        Args:
            limit: most messages of its publisher that wait; the oldest are dropped.
        """

    @abstractmethod
    def interest(self, peer: Peer, number: int, *, wanted: bool) -> None:
        """Begin or cease to ask a hub for the messages of a publisher that it has announced."""

    @abstractmethod
    def flowing(self, number: int) -> None:
        """Report that messages of a publisher of this hub pass, as other hubs have asked."""

    @abstractmethod
    def request(self, peer: Peer, request: Request, on_reply: OnReply) -> Cancel:
        """Send a request; one that must arrive passes all limits, or ends the connection.

        Args:
            on_reply: takes the replies, the first one maybe before this returns; if the hub is
                lost, the last one is a failure with the code ``server_lost``.

        Returns:
            A function that cancels the request, after which no reply follows.
        """

    @abstractmethod
    def replaced(self) -> None:
        """Leave all hubs for good, since the name of `node` has been taken."""

    @abstractmethod
    async def close(self) -> None:
        """Leave all hubs."""


class Network(Protocol):
    """Takes what comes by backplanes; all methods are called in the event loop."""

    def attach(self, backplane: Backplane) -> None:
        """Announce everything on a backplane from now on."""

    def detach(self, backplane: Backplane) -> None:
        """Forget a backplane; its peers have been lost before."""

    def idle(self, backplane: Backplane) -> None:
        """Called when a backplane is not busy any longer."""

    def joined(self, peer: Peer) -> None:
        """Called when a hub is reached."""

    def lost(self, peer: Peer, reason: str) -> None:
        """Called when a hub is lost."""

    def announced(self, peer: Peer, announcement: Announcement) -> Iterator[None]:
        """Take changes of what a hub has, a record with each step."""

    def interested(self, backplane: Backplane, number: int, *, wanted: bool) -> None:
        """Called when the first hub asks for the messages of a publisher, and when none does."""

    def is_flowing(self, peer: Peer, number: int) -> None:
        """Called when messages of a publisher begin to pass, after they were asked for."""

    def received(self, peer: Peer, message: LinkMessage) -> None:
        """Take a message; its data belong to the hub."""

    def requested(self, peer: Peer, request: Request, reply: OnReply) -> Cancel:
        """Handle a request; return a function that abandons it."""

    def finish(self, steps: Iterator[None]) -> None:
        """Take some steps in turns: there may be many."""


def call_all(functions: Iterator[Callable[[], object]]) -> Iterator[None]:
    """Call functions, one with each step; go on if one fails."""
    for each in functions:
        try:
            each()
        except Exception:
            logger.exception("A request of a hub that is lost could not be ended.")
        yield
