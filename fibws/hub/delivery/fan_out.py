"""Fan-out groups: the subscriptions of one topic that get the same frames."""

from __future__ import annotations

from collections.abc import Callable
from typing import Generic, TypeVar

from fibws.hub.delivery.clock import Clock
from fibws.hub.delivery.cohort import Cohort, M, Throttling
from fibws.hub.delivery.credit import Credit
from fibws.hub.delivery.send_queue import Broadcast, Flusher, Frame
from fibws.hub.delivery.throttle import Throttle

T = TypeVar("T")
"""The kind of publications."""


class FanOut(Generic[T, M]):
    """Makes one frame of each publication and sends it to every member.

    Args:
        encode: makes the frame.
        flusher: that of the members' send queues.
        deferred: whether it makes deferred frames.
    """

    __slots__ = ("_broadcast", "_clock", "_direct", "_offered", "_throttles", "encode")

    def __init__(
        self,
        encode: Callable[[T], Frame],
        flusher: Flusher,
        clock: Clock,
        *,
        deferred: bool = False,
    ) -> None:
        self.encode = encode
        self._broadcast: Broadcast = flusher.broadcast_deferred if deferred else flusher.broadcast
        self._clock = clock
        self._direct: Cohort[M] = Cohort()
        """The members without a throttle."""
        self._throttles: dict[Throttling | M, Throttle[M] | Credit[M]] = {}
        """One for all members that are throttled alike, and those of members for which other frames
        wait than for the others: always if they have credit."""
        self._offered = 0
        """Messages that throttles were given, or did not want."""

    def __len__(self) -> int:
        return len(self._direct) + sum(map(len, self._throttles.values()))

    def members(self) -> list[M]:
        """Return all members."""
        throttles = self._throttles.values()
        return [*self._direct.members(), *(each for one in throttles for each in one.members())]

    def add(self, member: M) -> None:
        """Add a member that is in no group."""
        throttling = member.throttling
        if throttling is None:
            self._direct.add(member)
            return
        member.throttled += member.sent - self._offered
        if throttling.credit:
            self._throttles[member] = Credit(member, self._clock)
            return
        throttle = self._throttles.get(throttling)
        if not isinstance(throttle, Throttle):
            throttle = Throttle(throttling, self._broadcast, self._clock)
            self._throttles[throttling] = throttle
        throttle.add(member)

    def remove(self, member: M) -> None:
        """Remove a member."""
        if member.throttling is None:
            self._direct.remove(member)
            return
        key = self._throttle_key(member.throttling, member)
        throttle = self._throttles[key]
        throttle.remove(member)
        member.throttled += self._offered - member.sent
        if not throttle:
            del self._throttles[key]

    def sent_to(self, member: M) -> int:
        """Return how many messages a member was sent."""
        return member.sent if member.cohort is None else member.cohort.sent_to(member)

    def send(self, publication: T) -> None:
        """Send a publication to every member; raises what ``encode`` raises."""
        frame: Frame | None = None
        direct = self._direct
        if direct.targets:
            frame = self.encode(publication)
            direct.sent += 1
            self._broadcast(frame, direct.targets)
        if self._throttles:
            now = self._clock.time()
            for throttle in self._throttles.values():
                if throttle.wants_from <= now:
                    if frame is None:
                        frame = self.encode(publication)
                    throttle.offer(frame, now)
            self._offered += 1

    def send_to(self, member: M, frame: Frame) -> None:
        """Send a frame to one member alone, now, later or never."""
        throttling = member.throttling
        if throttling is None:
            self.send_now(member, frame)
            return
        member.throttled += 1
        throttle = self._throttles[self._throttle_key(throttling, member)]
        now = self._clock.time()
        if isinstance(throttle, Credit):
            throttle.offer(frame, now)
        elif not throttle.offer_to(member, frame, now):
            if len(throttle) > 1:
                throttle = self._throttles[member] = throttle.split(member)
            throttle.offer(frame, now)

    def send_now(self, member: M, frame: Frame) -> None:
        """Send a frame to one member alone, regardless of its throttle, but not of its credit."""
        if member.throttling is not None:
            member.throttled += 1
            throttle = self._throttles.get(member)
            if isinstance(throttle, Credit):
                throttle.replay(frame)
                return
        member.sent += 1
        member.queue.put(frame, member.lane)

    def acknowledge(self, member: M, count: int) -> None:
        """Count messages that a member's client has acknowledged, and send what waits for it."""
        member.unacknowledged = max(0, member.unacknowledged - count)
        throttle = self._throttles.get(member)
        if isinstance(throttle, Credit):
            throttle.proceed()

    def throttled_for(self, member: M) -> int:
        """Return how many messages a member's throttles have left out."""
        if member.throttling is None:
            return member.throttled
        throttle = self._throttles[self._throttle_key(member.throttling, member)]
        offered = member.throttled + self._offered
        return offered - self.sent_to(member) - throttle.waiting_for(member)

    def _throttle_key(self, throttling: Throttling, member: M) -> Throttling | M:
        return member if member in self._throttles else throttling
