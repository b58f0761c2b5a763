"""Fan-out groups: the subscriptions of one topic that get the same frames."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Generic, Protocol, TypeVar

from fibws.hub.delivery.clock import Clock
from fibws.hub.delivery.send_queue import Flusher, Frame, SendQueue
from fibws.hub.delivery.throttle import Throttle
from fibws.protocol.frame_queue import Lane

T = TypeVar("T")
"""The kind of publications."""
M = TypeVar("M", bound="Member")
"""The kind of subscriptions."""


class Member(Protocol):
    """A subscription in a group."""

    queue: SendQueue
    """Its client's."""
    lane: Lane
    throttle: Throttle | None
    """None while every message is sent at once."""


class FanOut(Generic[T, M]):
    """Makes one frame of each publication and sends it to every member.

    Args:
        encode: makes the frame.
        flusher: that of the members' send queues.
    """

    __slots__ = (
        "_clock",
        "_direct",
        "_flusher",
        "_sent",
        "_sharing",
        "_since",
        "_throttled",
        "encode",
    )

    def __init__(self, encode: Callable[[T], Frame], flusher: Flusher, clock: Clock) -> None:
        self.encode = encode
        self._flusher = flusher
        self._clock = clock
        self._sent = 0
        """Messages sent to all direct members since the group exists."""
        self._since: dict[M, int] = {}
        """Direct members, with what `_sent` was when they came."""
        self._direct: dict[SendQueue, Lane] = {}
        self._sharing: dict[SendQueue, list[M]] = {}
        """Further direct members of the same clients, which get each frame once."""
        self._throttled: dict[M, Throttle] = {}

    def __len__(self) -> int:
        return len(self._since) + len(self._throttled)

    def members(self) -> Iterable[M]:
        """Return all members."""
        return [*self._since, *self._throttled]

    def add(self, member: M) -> None:
        """Add a member that is in no group."""
        if member.throttle is None:
            self._since[member] = self._sent
            if member.queue in self._direct:
                self._sharing.setdefault(member.queue, []).append(member)
            else:
                self._direct[member.queue] = member.lane
        else:
            self._throttled[member] = member.throttle

    def remove(self, member: M) -> int:
        """Remove a member; return how many messages it was sent, except by its throttle."""
        sent = self.sent_to(member)
        if self._since.pop(member, None) is not None:
            self._remove_direct(member)
        self._throttled.pop(member, None)
        return sent

    def _remove_direct(self, member: M) -> None:
        sharing = self._sharing.get(member.queue)
        if sharing is None:
            del self._direct[member.queue]
            return
        if member in sharing:
            sharing.remove(member)
        else:
            self._direct[member.queue] = sharing.pop(0).lane
        if not sharing:
            del self._sharing[member.queue]

    def sent_to(self, member: M) -> int:
        """Return how many messages a member was sent, except by its throttle."""
        return self._sent - self._since.get(member, self._sent)

    def send(self, publication: T) -> None:
        """Send a publication to every member; raises what ``encode`` raises."""
        frame: Frame | None = None
        if self._direct:
            frame = self.encode(publication)
            self._sent += 1
            self._flusher.broadcast(frame, self._direct)
        if self._throttled:
            now = self._clock.time()
            wanting = [each for each in self._throttled.values() if each.wants(now)]
            if wanting:
                frame = self.encode(publication) if frame is None else frame
                for throttle in wanting:
                    throttle.offer(frame, now)
