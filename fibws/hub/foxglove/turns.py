"""Turns: how all clients that follow the graph share the event loop's time."""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Callable

from fibws.hub.delivery.clock import Clock, Timer

TURN = 0.001
"""Seconds after which a client's turn ends."""
ITERATION = 0.003
"""Seconds that all of them get together in one iteration of the event loop."""

Send = Callable[[], object]
"""Sends a client what has changed, for about `TURN`."""


class FeedTurns:
    """The turns of one hub's clients, each of which comes once for each `wait`."""

    def __init__(self, clock: Clock) -> None:
        self._clock = clock
        self._waiting: OrderedDict[Send, None] = OrderedDict()
        self._timer: Timer | None = None

    def wait(self, send: Send) -> None:
        """Have a function called soon, once."""
        self._waiting[send] = None
        if self._timer is None:
            self._timer = self._clock.call_later(0, self._run)

    def cancel(self, send: Send) -> None:
        """Do not call a function that waits."""
        self._waiting.pop(send, None)
        if not self._waiting and self._timer is not None:
            self._timer.cancel()
            self._timer = None

    def _run(self) -> None:
        until = self._clock.time() + ITERATION
        self._timer = self._clock.call_later(0, self._run)  # Also if a function fails.
        while self._waiting:
            send = next(iter(self._waiting))
            self.cancel(send)
            send()
            if self._clock.time() >= until:
                break
