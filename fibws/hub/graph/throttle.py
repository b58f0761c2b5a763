"""The throttle: at most one message of a subscription in a period, as throttle_rate asks for."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable

from fibws.hub.budget import Budget
from fibws.hub.clock import Clock, Timer

EARLY = 0.001
"""Seconds by which a message may come early: timers are no finer than a millisecond."""


class Throttle:
    """Lets one frame through in a period; what comes between waits in a queue or is passed over.

    With a queue, frames leave it one a period, the oldest first, and the oldest is dropped when it
    is full, as in rosbridge_library's message handlers.

    Args:
        send: takes a frame when its turn has come.
        period: seconds.
        queue_length: frames that may wait; 0 passes over all that come too early.
        budget: bytes that the client's queues may keep together.
    """

    def __init__(
        self,
        send: Callable[[bytes], None],
        clock: Clock,
        *,
        period: float,
        queue_length: int,
        budget: Budget,
    ) -> None:
        self._send = send
        self._clock = clock
        self._period = period
        self._queue_length = queue_length
        self._budget = budget
        self._waiting: deque[bytes] = deque()
        self._due = clock.time()
        self._timer: Timer | None = None

    @property
    def wants_more(self) -> bool:
        """Whether a frame that is offered now is sent, now or later."""
        return bool(self._queue_length) or self._is_due(self._clock.time())

    def _is_due(self, now: float) -> bool:
        return self._timer is None and now >= self._due - EARLY

    def offer(self, frame: bytes) -> None:
        """Send a frame now, later or never."""
        if self._timer is None:  # Else others wait before it, and the time does not matter.
            now = self._clock.time()
            if self._is_due(now):
                self._due = now + self._period
                self._send(frame)
                return
        if not self._queue_length:
            return
        self._waiting.append(frame)
        self._budget.used += len(frame)
        # A message that alone breaks the budget may wait; else there would be none that large.
        while len(self._waiting) > self._queue_length or (
            self._waiting and self._budget.exceeded and self._budget.used > len(frame)
        ):
            self._pop()
        if self._timer is None and self._waiting:
            self._timer = self._clock.call_later(self._due - self._clock.time(), self._drain)

    def cancel(self) -> None:
        """Send nothing more."""
        if self._timer is not None:
            self._timer.cancel()
            self._timer = None
        while self._waiting:
            self._pop()

    def _drain(self) -> None:
        self._timer = None
        if not self._waiting:  # All of it made way for the budget.
            return
        self._due = max(self._due, self._clock.time() - self._period) + self._period
        self._send(self._pop())
        if self._waiting:
            self._timer = self._clock.call_later(self._due - self._clock.time(), self._drain)

    def _pop(self) -> bytes:
        frame = self._waiting.popleft()
        self._budget.used -= len(frame)
        return frame
