"""Fan-out groups: the subscriptions of one topic that get the same frames."""

from __future__ import annotations

from collections.abc import Callable
from typing import Generic, TypeVar

from fibws.hub.delivery.clock import Clock
from fibws.hub.delivery.send_queue import Flusher, Frame, SendQueue
from fibws.hub.delivery.throttle import M, Throttle
from fibws.protocol.frame_queue import Lane

T = TypeVar("T")
"""The kind of publications."""


class FanOut(Generic[T, M]):
    """Makes one frame of each publication and sends it to every member.

    Members without a throttle are sent each frame at the same moment: a message costs little more
    for many than for one, and is counted once for all of them.

    Args:
        encode: makes the frame.
        flusher: that of the members' send queues.
    """

    __slots__ = (
        "_clock",
        "_flusher",
        "_offered",
        "_sent",
        "_sharing",
        "_since",
        "_targets",
        "_throttles",
        "encode",
    )

    def __init__(self, encode: Callable[[T], Frame], flusher: Flusher, clock: Clock) -> None:
        self.encode = encode
        self._flusher = flusher
        self._clock = clock
        self._targets: dict[SendQueue, Lane] = {}
        """Where frames go at once: each client gets a frame once, however many members it has."""
        self._sharing: dict[SendQueue, list[M]] = {}
        """Second and later members of a client."""
        self._since: dict[M, int] = {}
        """The members without a throttle, and the value of `_sent` when each of them came."""
        self._sent = 0
        """Frames sent to these."""
        self._throttles: dict[M, Throttle[M]] = {}
        self._offered = 0
        """Messages that throttles were given, or did not want."""

    def __len__(self) -> int:
        return len(self._since) + len(self._throttles)

    def members(self) -> list[M]:
        """Return all members."""
        return [*self._since, *self._throttles]

    def add(self, member: M) -> None:
        """Add a member that is in no group."""
        if member.throttling is not None:
            member.throttled += member.sent - self._offered
            self._throttles[member] = Throttle(member, member.throttling, self._clock)
            return
        self._since[member] = self._sent
        if member.queue in self._targets:
            self._sharing.setdefault(member.queue, []).append(member)
        else:
            self._targets[member.queue] = member.lane

    def remove(self, member: M) -> None:
        """Remove a member."""
        throttle = self._throttles.pop(member, None)
        if throttle is not None:
            throttle.close()
            member.throttled += self._offered - member.sent
            return
        member.sent += self._sent - self._since.pop(member)
        sharing = self._sharing.get(member.queue)
        if sharing is None:
            del self._targets[member.queue]
            return
        if member in sharing:
            sharing.remove(member)
        else:
            self._targets[member.queue] = sharing.pop(0).lane
        if not sharing:
            del self._sharing[member.queue]

    def sent_to(self, member: M) -> int:
        """Return how many messages a member was sent."""
        return member.sent + self._sent - self._since.get(member, self._sent)

    def send(self, publication: T) -> None:
        """Send a publication to every member; raises what ``encode`` raises."""
        frame: Frame | None = None
        if self._targets:
            frame = self.encode(publication)
            self._sent += 1
            self._flusher.broadcast(frame, self._targets)
        if self._throttles:
            now = self._clock.time()
            for throttle in self._throttles.values():
                if throttle.wants_from <= now:
                    if frame is None:
                        frame = self.encode(publication)
                    throttle.offer(frame)
            self._offered += 1

    def wants(self, member: M) -> bool:
        """Return whether a member would be sent the next frame, now or later."""
        throttle = self._throttles.get(member)
        return throttle is None or throttle.wants_from <= self._clock.time()

    def send_alone(self, member: M, frame: Frame, *, latched: bool = False) -> None:
        """Send a frame to one member alone: now, later or never.

        Args:
            latched: whether its throttle lets it pass at once, if the member has credit.
        """
        throttle = self._throttles.get(member)
        if throttle is None:
            member.sent += 1
            member.queue.put(frame, member.lane)
            return
        member.throttled += 1
        if latched:
            throttle.replay(frame)
        else:
            throttle.offer(frame)

    def acknowledge(self, member: M, count: int) -> None:
        """Count messages that a member's client has acknowledged, and send what waits for it."""
        member.unacknowledged = max(0, member.unacknowledged - count)
        throttle = self._throttles.get(member)
        if throttle is not None:
            throttle.proceed()

    def throttled_for(self, member: M) -> int:
        """Return how many messages a member's throttles have left out."""
        throttle = self._throttles.get(member)
        if throttle is None:
            return member.throttled
        return member.throttled + self._offered - member.sent - throttle.waiting
