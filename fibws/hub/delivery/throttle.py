"""Throttles: at most one message of a subscription in a period (rosbridge's throttle_rate)."""

from __future__ import annotations

from collections import OrderedDict, deque
from collections.abc import Iterator
from itertools import chain, islice
from math import inf
from typing import Generic

from fibws.hub.delivery.clock import Clock, Timer
from fibws.hub.delivery.cohort import Cohort, M, Throttling
from fibws.hub.delivery.send_queue import Broadcast, Frame, SendQueue

EARLY = 0.001
"""Seconds by which a message may come early: timers are no finer than a millisecond."""


class Throttle(Generic[M]):
    """Sends each of its members one frame in a period; frames in between wait or are dropped.

    With a queue, one frame leaves it each period, the oldest first, and the oldest is dropped when
    the queue is full, as in rosbridge_library's message handlers.

    Members that were sent a frame at the same moment are due at the same moment: they form a
    cohort, and stay together. Cohorts wait for their time in the order in which it comes, and the
    frames that wait are the same for all, so that a message costs as little for many members as for
    one. Its bytes are counted for one of the members' clients.

    Args:
        broadcast: sends a frame to many clients.
    """

    __slots__ = (
        "_broadcast",
        "_bytes",
        "_caught_up",
        "_clock",
        "_cooling",
        "_due",
        "_number",
        "_payer",
        "_period",
        "_queue_length",
        "_ready",
        "_size",
        "_standing",
        "_timer",
        "_waiting",
        "wants_from",
    )

    def __init__(
        self,
        throttling: Throttling,
        broadcast: Broadcast,
        clock: Clock,
    ) -> None:
        self.wants_from = inf
        """The earliest time at which a frame would be sent to a member."""
        self._period, self._queue_length, _ = throttling
        self._broadcast = broadcast
        self._clock = clock
        self._size = 0
        self._ready: Cohort[M] = Cohort()
        """The members that are sent the next frame at once."""
        self._cooling: OrderedDict[Cohort[M], None] = OrderedDict()
        """The cohorts that must wait, in the order of their times."""
        self._due = inf
        """The time of the first of these."""
        self._waiting: deque[Frame] = deque()
        """The last frames, from the oldest that a cohort has not been sent."""
        self._standing: deque[int] = deque()
        """For how many cohorts each of these is the next one."""
        self._bytes = 0
        self._number = 0
        """Of the frame that comes next."""
        self._caught_up = 0
        """Cohorts that must wait, but have been sent all frames."""
        self._payer: SendQueue | None = None
        """The client for which the bytes of the frames that wait are counted."""
        self._timer: Timer | None = None

    def __len__(self) -> int:
        return self._size

    def members(self) -> Iterator[M]:
        """Return all members."""
        return chain(self._ready.members(), *(each.members() for each in self._cooling))

    def waiting_for(self, member: M) -> int:
        """Return how many frames wait for one of its members."""
        cohort = member.cohort
        return 0 if cohort is self._ready or cohort is None else self._number - self._next(cohort)

    def add(self, member: M) -> None:
        """Add a member, which is sent the next frame at once."""
        self._size += 1
        self._ready.add(member)
        self.wants_from = -inf

    def remove(self, member: M) -> None:
        """Remove one of its members; frames that wait for it alone are dropped."""
        cohort = member.cohort
        assert cohort is not None
        self._size -= 1
        cohort.remove(member)
        if not cohort.targets and cohort is not self._ready:
            del self._cooling[cohort]
            self._stand(self._next(cohort), -1)
            self._forget_sent()
        if member.queue is self._payer:
            self._pass_on(next(self._clients(), None))
            if self._waiting:
                self._make_room()
        if not self._cooling and self._timer is not None:
            self._timer.cancel()
            self._timer = None
        self._schedule()

    def offer(self, frame: Frame, now: float) -> None:
        """Send a frame to each member now, later or never."""
        has_changed = self._due - EARLY <= now
        if has_changed:
            self._release(now)
        self._number += 1
        if self._queue_length and (self._waiting or self._caught_up):
            self._keep(frame)
        if self._ready.targets:
            has_changed = True
            cohort, self._ready = self._ready, Cohort()
            self._send(frame, cohort, now + self._period)
        if has_changed or (self._timer is None and self._waiting):
            self._schedule()

    def offer_to(self, member: M, frame: Frame, now: float) -> bool:
        """Send a frame to one of the members now or never; return False if it must wait."""
        if self._due - EARLY <= now:
            self._release(now)
            self._schedule()
        if member.cohort is self._ready:
            self._ready.remove(member)
            alone: Cohort[M] = Cohort()
            alone.add(member)
            self._send(frame, alone, now + self._period)
            self._schedule()
            return True
        return not self._queue_length

    def split(self, member: M) -> Throttle[M]:
        """Remove one of the members that must wait; return a throttle for it alone."""
        cohort = member.cohort
        assert cohort is not None
        number = self._next(cohort) - self._number + len(self._waiting)
        waiting = list(islice(self._waiting, number, None))
        self.remove(member)
        alone: Throttle[M] = Throttle(
            Throttling(self._period, self._queue_length), self._broadcast, self._clock
        )
        alone._size = 1
        single: Cohort[M] = Cohort()
        single.add(member)
        alone._cool(single, cohort.due)
        for frame in waiting:
            alone._number += 1
            alone._keep(frame)
        alone._schedule()
        return alone

    def _send(self, frame: Frame, cohort: Cohort[M], due: float) -> None:
        """Send a frame to a cohort, which is due again at a later time."""
        self._cool(cohort, due)
        cohort.sent += 1
        self._broadcast(frame, cohort.targets)

    def _cool(self, cohort: Cohort[M], due: float) -> None:
        cohort.due = due
        cohort.next = self._number
        self._cooling[cohort] = None
        self._caught_up += 1

    def _release(self, now: float) -> None:
        """Send each cohort whose time has come the next frame; those without one are ready."""
        for _ in range(len(self._cooling)):
            cohort = next(iter(self._cooling))
            if cohort.due - EARLY > now:
                return
            del self._cooling[cohort]
            number = self._next(cohort)
            self._stand(number, -1)
            if number == self._number:
                self._ready = self._ready.joined(cohort)
                continue
            frame = self._waiting[number - self._number]
            cohort.next = number + 1
            cohort.due = max(cohort.due, now - self._period) + self._period
            self._cooling[cohort] = None
            self._stand(number + 1, 1)
            self._forget_sent()
            cohort.sent += 1
            self._broadcast(frame, cohort.targets)

    def _next(self, cohort: Cohort[M]) -> int:
        """Return the number of the frame that a cohort is sent next."""
        return max(cohort.next, self._number - len(self._waiting))

    def _stand(self, number: int, change: int) -> None:
        """Count some cohorts more or less that are sent the frame of this number next."""
        if number == self._number:
            self._caught_up += change
        else:
            self._standing[number - self._number] += change

    def _keep(self, frame: Frame) -> None:
        """Let a frame wait, the newest one, for all cohorts that are not ready."""
        change = len(frame)
        self._waiting.append(frame)
        self._standing.append(self._caught_up)
        self._caught_up = 0
        if len(self._waiting) > self._queue_length:
            change -= len(self._pop())
        if change:
            self._count(change)
        if change > 0 or (self._payer is not None and self._payer.paused):
            self._make_room()

    def _make_room(self) -> None:
        """Find a client that has room for the frames that wait, or drop the oldest.

        A frame that alone exceeds the limit may wait; otherwise none that large would pass.
        """
        newest = len(self._waiting[-1])
        if not self._is_full(newest):
            return
        for other in self._clients():
            if other.kept_bytes + self._bytes <= other.max_bytes:
                self._pass_on(other)
                break
        while self._waiting and self._is_full(newest):
            self._count_dropped()
            self._count(-len(self._pop()))

    def _is_full(self, newest: int) -> bool:
        payer = self._payer
        return payer is not None and payer.exceeded and payer.kept_bytes > newest

    def _count_dropped(self) -> None:
        """Count the oldest frame as dropped for those that have not been sent it."""
        oldest = self._number - len(self._waiting)
        for cohort in self._cooling:
            if self._next(cohort) == oldest:
                for member in cohort.members():
                    member.lane.dropped += 1
                    member.queue.dropped += 1
                    member.throttled -= 1

    def _forget_sent(self) -> None:
        """Forget the oldest frames if all have been sent them."""
        while self._waiting and not self._standing[0]:
            self._count(-len(self._pop()))

    def _pop(self) -> Frame:
        """Remove and return the oldest frame that waits."""
        cohorts = self._standing.popleft()
        frame = self._waiting.popleft()
        self._stand(self._number - len(self._waiting), cohorts)
        return frame

    def _clients(self) -> Iterator[SendQueue]:
        """Return the clients that must wait."""
        return chain.from_iterable(each.targets for each in self._cooling)

    def _count(self, change: int) -> None:
        """Count bytes more or less that wait."""
        payer = self._payer
        if payer is None:
            payer = self._payer = next(self._clients())
        payer.throttled_bytes += change
        self._bytes += change
        if not self._bytes:
            self._payer = None

    def _pass_on(self, payer: SendQueue | None) -> None:
        """Count the bytes that wait for another client."""
        if self._payer is not None:
            self._payer.throttled_bytes -= self._bytes
        if payer is not None:
            payer.throttled_bytes += self._bytes
        self._payer = payer

    def _schedule(self) -> None:
        """Set the times of the next frames, and the timer, if frames wait."""
        self._due = next(iter(self._cooling)).due if self._cooling else inf
        if self._ready.targets or (self._cooling and self._queue_length):
            self.wants_from = -inf
        else:
            self.wants_from = self._due - EARLY
        if self._waiting and self._timer is None:
            delay = self._due - self._clock.time()
            self._timer = self._clock.call_later(max(0.0, delay), self._on_timer)

    def _on_timer(self) -> None:
        self._timer = None
        self._release(self._clock.time())
        self._schedule()
