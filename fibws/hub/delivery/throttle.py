"""Throttles: subscriptions that want fewer messages, or no more than their clients can take."""

from __future__ import annotations

from collections import deque
from math import inf
from typing import Generic, NamedTuple, Protocol, TypeVar

from fibws.hub.delivery.clock import Clock, Timer
from fibws.hub.delivery.send_queue import Frame, SendQueue
from fibws.protocol.frame_queue import Lane

EARLY = 0.001
"""Seconds by which a message may come early: timers are no finer than a millisecond."""

M = TypeVar("M", bound="Member")
"""The kind of subscriptions."""


class Throttling(NamedTuple):
    """How a subscription wants its messages throttled.

    Attributes:
        period: least seconds between two messages (rosbridge's throttle_rate).
        queue_length: how many of the newest messages wait for their turn; 0 drops all that come too
            early (rosbridge's queue_length).
        credit: most messages on the way that the client has not acknowledged; 0 for any number.
            With credit at least one message waits.
    """

    period: float
    queue_length: int
    credit: int = 0

    @property
    def room(self) -> int:
        """How many messages may wait."""
        return max(1, self.queue_length) if self.credit else self.queue_length


class Member(Protocol):
    """A subscription in a group; all but the first three are for the group to set."""

    queue: SendQueue
    """Its client's."""
    lane: Lane
    throttling: Throttling | None
    """None while every message is sent at once; it must not change while in a group."""
    sent: int
    """Messages that it was sent, except those that its group counts for all without a throttle."""
    throttled: int
    """Messages that its earlier throttles left out."""
    unacknowledged: int
    """Messages sent on credit that its client has not acknowledged."""


class Throttle(Generic[M]):
    """Sends one member frames at the pace that it asked for; others wait, or are left out.

    Each period the oldest frame that waits is sent, as in rosbridge_library's message handlers.

    A member with credit is sent frames while fewer than its credit are unacknowledged, and only
    once its client's socket takes them: until then newer ones take their places, so that what the
    client gets is as fresh as its link and its own speed allow. Latched frames wait for that, too,
    but are not replaced, since each may be another publisher's.
    """

    __slots__ = (
        "_clock",
        "_due",
        "_latched",
        "_member",
        "_room",
        "_throttling",
        "_timer",
        "_waiting",
        "wants_from",
    )

    def __init__(self, member: M, throttling: Throttling, clock: Clock) -> None:
        self.wants_from = -inf
        """The earliest time at which a frame would be sent or kept."""
        self._member: M | None = member
        self._throttling = throttling
        self._room = throttling.room
        self._clock = clock
        self._waiting: deque[Frame] = deque()
        """Latched frames, then others; their bytes count as kept for the client."""
        self._latched = 0
        """How many of the kept messages are latched."""
        self._due = -inf
        """The earliest time of the next frame."""
        self._timer: Timer | None = None

    @property
    def waiting(self) -> int:
        """How many frames wait."""
        return len(self._waiting)

    def close(self) -> None:
        """Drop the frames that wait: the member has left."""
        while self._waiting:
            self._pop()
        self._member = None
        if self._timer is not None:
            self._timer.cancel()

    def offer(self, frame: Frame) -> None:
        """Send a frame now, later or never."""
        if not self._waiting:
            self._due = max(self._due, self._clock.time())
        self._keep(frame)
        if self._timer is None:  # Else it is early for all frames that wait.
            self._send()
        while len(self._waiting) - self._latched > self._room:
            self._count(-len(self._waiting[self._latched]))
            del self._waiting[self._latched]
            # One that the client did not ask to keep counts as left out.
            if self._throttling.credit and self._room > 1:
                self._count_dropped()
        self._make_room(len(frame))
        self._schedule()

    def replay(self, frame: Frame) -> None:
        """Send a latched frame, regardless of the period, but not of the credit."""
        member = self._member
        assert member is not None
        if not self._throttling.credit:
            member.sent += 1
            member.queue.put(frame, member.lane)
            return
        self._keep(frame)
        self._latched = len(self._waiting)
        self._send()
        self._make_room(len(frame))
        self._schedule()

    def proceed(self) -> None:
        """Send what may be sent by now, and what is only early later."""
        self._send()
        self._schedule()

    def _send(self) -> None:
        """Send one frame whose time has come; with credit, all that the client's socket takes."""
        member = self._member
        if member is None or not self._may_send():
            return
        if not self._throttling.credit:
            member.queue.put(self._take(), member.lane)
            return
        while self._may_send():
            member.queue.reply_fresh(self._take)
            if member.queue.paused:
                return

    def _may_send(self) -> bool:
        """Return whether the next frame may be sent now."""
        return self._has_credit() and (self._latched > 0 or self._due - self._clock.time() <= EARLY)

    def _has_credit(self) -> bool:
        """Return whether a frame waits for its time alone."""
        if self._member is None or not self._waiting:
            return False
        credit = self._throttling.credit
        return not credit or self._member.unacknowledged < credit

    def _take(self) -> Frame:
        """Remove, count and return the next frame; empty if none may be sent now."""
        member = self._member
        if member is None or not self._may_send():
            return b""
        if not self._latched:
            period, _, credit = self._throttling
            now = self._clock.time()
            # Late timers do not add up: frames that waited for their time alone keep their pace.
            self._due = (now if credit else max(self._due, now - period)) + period
            self.wants_from = -inf if self._room else self._due - EARLY
        member.sent += 1
        if self._throttling.credit:
            member.unacknowledged += 1
        return self._pop()

    def _keep(self, frame: Frame) -> None:
        """Let a frame wait, the newest one."""
        self._waiting.append(frame)
        self._count(len(frame))

    def _make_room(self, newest: int) -> None:
        """Drop the oldest frames if the client has no room.

        A frame that alone exceeds the limit may wait; otherwise none that large would pass.

        Args:
            newest: bytes of the newest frame.
        """
        assert self._member is not None
        queue = self._member.queue
        while self._waiting and queue.exceeded and queue.kept_bytes > newest:
            self._pop()
            self._count_dropped()

    def _pop(self) -> Frame:
        """Remove and return the oldest frame that waits."""
        frame = self._waiting.popleft()
        self._latched = max(0, self._latched - 1)
        self._count(-len(frame))
        return frame

    def _count(self, change: int) -> None:
        """Count bytes more or less that wait."""
        assert self._member is not None
        self._member.queue.throttled_bytes += change

    def _count_dropped(self) -> None:
        """Count a frame as dropped, since the client is too slow."""
        member = self._member
        assert member is not None
        member.lane.dropped += 1
        member.queue.dropped += 1
        member.throttled -= 1

    def _schedule(self) -> None:
        """Set the timer for the next frame, if its time alone holds it back."""
        if self._timer is not None or self._latched or not self._has_credit():
            return
        delay = self._due - self._clock.time()
        # Else the client's socket holds it back, and calls for it.
        if delay > EARLY or not self._throttling.credit:
            self._timer = self._clock.call_later(max(0.0, delay), self._on_timer)

    def _on_timer(self) -> None:
        self._timer = None
        self.proceed()
