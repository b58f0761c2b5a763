"""Throttles: at most one message of a subscription in a period (rosbridge's throttle_rate)."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable

from fibws.hub.delivery.clock import Clock, Timer
from fibws.hub.delivery.send_queue import Frame, SendQueue

EARLY = 0.001
"""Seconds by which a message may come early: timers are no finer than a millisecond."""


class Throttle:
    """Sends one frame in a period; frames in between wait in a queue or are dropped.

    With a queue, one frame leaves it each period, the oldest first, and the oldest is dropped when
    the queue is full, as in rosbridge_library's message handlers.

    Args:
        send: takes a frame whose turn has come.
        queue: the client's send queue, which bounds the bytes that may wait.
        period: seconds.
        queue_length: frames that may wait; 0 drops all that come too early.
    """

    def __init__(
        self,
        send: Callable[[Frame], None],
        clock: Clock,
        queue: SendQueue,
        *,
        period: float,
        queue_length: int,
    ) -> None:
        self._send = send
        self._clock = clock
        self._queue = queue
        self._period = period
        self._queue_length = queue_length
        self._waiting: deque[Frame] = deque()
        self._due = clock.time()
        self._timer: Timer | None = None

    def wants(self, now: float) -> bool:
        """Return whether a frame that comes ``now`` would be sent, now or later."""
        return bool(self._queue_length) or self._is_due(now)

    def offer(self, frame: Frame, now: float) -> None:
        """Send a frame now, later or never."""
        if self._is_due(now):
            self._due = now + self._period
            self._send(frame)
            return
        if not self._queue_length:
            return
        self._waiting.append(frame)
        self._queue.throttled_bytes += len(frame)
        # A frame that alone exceeds the limit may wait; otherwise none that large would pass.
        while len(self._waiting) > self._queue_length or (
            self._waiting and self._queue.exceeded and self._queue.kept_bytes > len(frame)
        ):
            self._pop()
        if self._timer is None and self._waiting:
            self._timer = self._clock.call_later(self._due - now, self._drain)

    def cancel(self) -> None:
        """Send nothing more."""
        if self._timer is not None:
            self._timer.cancel()
            self._timer = None
        while self._waiting:
            self._pop()

    def _is_due(self, now: float) -> bool:
        return self._timer is None and now >= self._due - EARLY

    def _drain(self) -> None:
        self._timer = None
        if not self._waiting:  # All were dropped, as the limit was exceeded.
            return
        now = self._clock.time()
        self._due = max(self._due, now - self._period) + self._period
        self._send(self._pop())
        if self._waiting:
            self._timer = self._clock.call_later(self._due - now, self._drain)

    def _pop(self) -> Frame:
        frame = self._waiting.popleft()
        self._queue.throttled_bytes -= len(frame)
        return frame
