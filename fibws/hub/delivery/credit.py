"""Credit: a bound of the messages on the way that a client has not acknowledged."""

from __future__ import annotations

from collections import deque
from collections.abc import Collection
from math import inf
from typing import Final, Generic

from fibws.hub.delivery.clock import Clock, Timer
from fibws.hub.delivery.cohort import M
from fibws.hub.delivery.deferred import DeferredFrame
from fibws.hub.delivery.send_queue import Frame, MadeFrame
from fibws.hub.delivery.throttle import EARLY


class Credit(Generic[M]):
    """Sends its one member frames while fewer than its credit are unacknowledged.

    Meanwhile the newest frame waits, and a newer one replaces it, until the client's socket takes
    it: what the client gets is as fresh as its link and its own speed allow. With a queue_length of
    2 or more, so many of the newest wait, and the oldest of more are dropped. Latched frames wait,
    too, but are not replaced, since each may be another publisher's.

    A throttle may ask for a period between two frames, except latched ones.
    """

    __slots__ = ("_clock", "_due", "_latched", "_member", "_timer", "_waiting")

    wants_from: Final = -inf
    """The earliest time at which a frame would be sent or kept, as of a `Throttle`."""

    def __init__(self, member: M, clock: Clock) -> None:
        self._member: M | None = member
        self._clock = clock
        self._waiting: deque[MadeFrame] = deque()
        """Latched frames, then others, at most as many as may wait; their bytes count as kept for
        the client."""
        self._latched = 0
        """How many of these must not be replaced."""
        self._due = -inf
        """The earliest time of the next frame."""
        self._timer: Timer | None = None

    def __len__(self) -> int:
        return len(self.members())

    def members(self) -> Collection[M]:
        """Return the member, unless it was removed."""
        return () if self._member is None else (self._member,)

    def waiting_for(self, _member: M) -> int:
        """Return how many frames wait."""
        return len(self._waiting)

    def remove(self, _member: M) -> None:
        """Remove the member; frames that wait are dropped."""
        while self._waiting:
            self._pop()
        self._member = None
        if self._timer is not None:
            self._timer.cancel()

    def offer(self, frame: Frame, now: float) -> None:
        """Send a frame now or later, unless newer ones replace it."""
        assert self._member is not None
        assert self._member.throttling is not None
        room = max(1, self._member.throttling.queue_length)
        if len(self._waiting) - self._latched >= room:
            replaced = self._waiting[self._latched]
            del self._waiting[self._latched]
            self._count(-len(replaced))
            # One that the client did not ask to keep counts as left out, like those of a throttle.
            if room > 1:
                self._count_dropped()
        self._keep(frame)
        self.proceed()

    def replay(self, frame: Frame) -> None:
        """Send a latched frame now or later, regardless of the throttle."""
        self._keep(frame)
        self._latched = len(self._waiting)
        self.proceed()

    def proceed(self) -> None:
        """Send what may be sent: now, or when the client reads again."""
        member = self._member
        while member is not None and self._may_send(member):
            member.queue.reply_fresh(self._take)
            if member.queue.paused:
                return

    def _may_send(self, member: M) -> bool:
        """Return whether the next frame may be sent; if it is only early, set the timer."""
        assert member.throttling is not None
        if not self._waiting or member.unacknowledged >= member.throttling.credit:
            return False
        delay = self._due - self._clock.time()
        if self._latched or delay <= EARLY:
            return True
        if self._timer is None:
            self._timer = self._clock.call_later(delay, self._on_timer)
        return False

    def _take(self) -> MadeFrame:
        """Remove and return the frame that the client's socket takes; empty if there is none."""
        member = self._member
        if member is None or not self._may_send(member):
            return b""
        if not self._latched:
            assert member.throttling is not None
            self._due = self._clock.time() + member.throttling.period
        member.sent += 1
        member.unacknowledged += 1
        return self._pop()

    def _keep(self, frame: Frame) -> None:
        """Let a frame wait; drop older ones if the client has no room.

        A frame that alone exceeds the limit may wait, as in a `Throttle`.
        """
        assert not isinstance(frame, DeferredFrame), "only serialized messages have credit"
        self._waiting.append(frame)
        self._count(len(frame))
        assert self._member is not None
        queue = self._member.queue
        while self._waiting and queue.exceeded and queue.kept_bytes > len(frame):
            self._pop()
            self._count_dropped()

    def _pop(self) -> MadeFrame:
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

    def _on_timer(self) -> None:
        self._timer = None
        self.proceed()
