"""Turns: how connections share the event loop's time.

A connection with little to read is served at once. One with more than fits its turn waits in a
queue with the others of its kind, and its socket is not read meanwhile. Each iteration of the loop
spends a few milliseconds on that queue, so that all other connections are served in between,
regardless of how many wait and what their operations cost. A message that asks for many things is
handled item by item, and the clock is looked at after each. What a client leaves behind is removed
in the same way.
"""

from __future__ import annotations

import logging
from collections import deque
from collections.abc import Callable
from time import perf_counter
from typing import Protocol

from fibws.hub.websocket.endpoint import Work

logger = logging.getLogger("fibws.hub")

TURN = 0.001
"""Seconds after which a connection's turn ends."""
ITERATION = 0.003
"""Seconds that the connections with more to do get together in one iteration of the event loop; a
connection that is alone gets all of them."""
MOST_FRAMES = 32
"""Most frames that are handled between two looks at the clock."""


class TurnTaker(Protocol):
    """A connection that has more to read than fits its turn."""

    def take_turn(self) -> None:
        """Handle data read before until `Turns.go_on` returns 0, then wait again or read on."""

    def abort(self) -> None:
        """Cut the connection off."""


class _Rest:
    """Work without a connection."""

    def __init__(self, turns: Turns, work: Work) -> None:
        self._turns = turns
        self._work = work

    def take_turn(self) -> None:
        """Take steps until the turn is over, then wait again."""
        while self._take_step():
            if self._turns.is_over():
                self._turns.wait(self)
                return

    def finish(self) -> None:
        """Take all steps."""
        while self._take_step():
            pass

    def abort(self) -> None:
        """Do nothing: a step that fails keeps no other from being taken."""

    def _take_step(self) -> bool:
        """Take a step; return whether there was one, even if it has failed."""
        try:
            next(self._work)
        except StopIteration:
            return False
        except Exception:
            logger.exception("Something that a client has left behind could not be removed.")
        return True


class Turns:
    """The turns of one hub's connections.

    Args:
        call_later: calls a function after some seconds: after 0 in the event loop's next iteration,
            behind what the sockets bring.
        flush: writes the frames that wait for the end of the iteration.
        clock: returns the seconds since some moment in the past.
    """

    def __init__(
        self,
        call_later: Callable[[float, Callable[[], None]], object],
        flush: Callable[[], None],
        clock: Callable[[], float] = perf_counter,
    ) -> None:
        self._call_later = call_later
        self._flush = flush
        self.clock = clock
        self._waiting: deque[TurnTaker] = deque()
        self._is_due = False
        """Whether `_run` is running or about to be called."""
        self.began = 0.0
        """When the current turn began, on the clock; a connection sets it when it is read from."""
        self._length = ITERATION
        """Seconds that the current turn may take."""
        self._spent_at = 0.0
        """When the current iteration has spent its time on connections with more to do."""

    def go_on(self, passed: int) -> int:
        """Return how many more frames the connection may handle before it asks again.

        Args:
            passed: frames that it has handled in this turn.
        """
        taken = self.clock() - self.began
        left = self._length - taken
        if left <= 0:
            return 0
        # As many as fit at the pace so far; few at first, as the next ones may cost more.
        fitting = int(passed * left / (taken + 1e-9))
        return max(1, min(passed, fitting, MOST_FRAMES))

    def is_over(self) -> bool:
        """Return whether the current turn has taken its time."""
        return self.clock() - self.began >= self._length

    def is_spent(self) -> bool:
        """Return whether a connection with more to do must wait for a later iteration."""
        return bool(self._waiting) and self.clock() >= self._spent_at

    def wait(self, reader: TurnTaker) -> None:
        """Have `TurnTaker.take_turn` called when its time has come."""
        self._waiting.append(reader)
        if not self._is_due:
            self._is_due = True
            self._length = TURN
            self._call_later(0, self._run)

    def finish(self, work: Work) -> None:
        """Do what a client has left behind: at once if that is little, the rest in further turns.

        If many leave at once, they share the time of an iteration.
        """
        rest = _Rest(self, work)
        if not self._is_due:
            self._is_due = True
            self._spent_at = self.clock() + ITERATION
            self._call_later(0, self._run)
        now = self.clock()
        if now >= self._spent_at:
            self._waiting.append(rest)
            return
        present = self.began, self._length
        self.began, self._length = now, TURN
        rest.take_turn()
        self.began, self._length = present

    def close(self) -> None:
        """Do what clients have left behind, at once: the hub ends."""
        for each in list(self._waiting):
            if isinstance(each, _Rest):
                each.finish()

    def _run(self) -> None:
        # What the others have just published must not wait for this.
        self._flush()
        waiting = self._waiting
        now = self.clock()
        self._spent_at = now + ITERATION
        self._length = max(TURN, ITERATION / max(1, len(waiting)))
        for _ in range(len(waiting)):
            reader = waiting.popleft()
            self.began = now
            try:
                reader.take_turn()
            except Exception:
                # A fault at one connection must not keep the others waiting.
                logger.exception("A client is cut off: it could not be read from.")
                reader.abort()
            now = self.clock()
            if now >= self._spent_at:
                break
        self._is_due = bool(waiting)
        self._length = TURN if waiting else ITERATION
        if waiting:
            self._call_later(0, self._run)
