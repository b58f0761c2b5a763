"""Names to be brought up to date, and other steps, a millisecond at a time."""

from __future__ import annotations

import logging
from collections import OrderedDict, deque
from collections.abc import Callable, Iterator, Mapping
from time import perf_counter
from typing import Generic, TypeVar

logger = logging.getLogger("fibws.hub")

TURN = 0.001
"""Seconds of work before others have their turn."""

K = TypeVar("K", bound=str)


class Worklist(Generic[K]):
    """Names that have changed, each handled once soon.

    Args:
        call_soon: calls a function in the next turn of the event loop.
        handle: handles a name of each kind; kinds that come first are handled first.
        turn_ended: called after each turn.
        is_paused: returns whether work waits for `resume`.
    """

    def __init__(
        self,
        call_soon: Callable[[Callable[[], None]], object],
        handle: Mapping[K, Callable[[str], object]],
        *,
        turn_ended: Callable[[], object] = lambda: None,
        is_paused: Callable[[], bool] = lambda: False,
    ) -> None:
        self._call_soon = call_soon
        self._handle = handle
        self._turn_ended = turn_ended
        self._is_paused = is_paused
        # The first of a dict from which many were removed takes long to find.
        self._waiting: dict[K, OrderedDict[str, None]] = {kind: OrderedDict() for kind in handle}
        self._steps: deque[Iterator[object]] = deque()
        self._is_due = False
        self._is_closed = False

    def __len__(self) -> int:
        return len(self._steps) + sum(map(len, self._waiting.values()))

    def add(self, kind: K, name: str) -> None:
        """Handle a name soon."""
        if not self._is_closed:
            self._waiting[kind][name] = None
            if not self._is_due:
                self._schedule()

    def add_steps(self, steps: Iterator[object], *, at_once: bool = False) -> None:
        """Take some steps soon, before names are handled.

        Args:
            at_once: take those that fit a turn now, unless others wait.
        """
        self._steps.append(steps)
        if at_once and not self._is_due:
            self._is_due = True
            self._run()
        else:
            self._schedule()

    def resume(self) -> None:
        """Continue after a pause."""
        if self:
            self._schedule()

    def finish(self) -> None:
        """Do all work now."""
        while self._run_one():
            pass

    def close(self) -> None:
        """Forget all names, also those that are added later."""
        self._is_closed = True
        for names in self._waiting.values():
            names.clear()

    def _schedule(self) -> None:
        if not self._is_due and not self._is_paused():
            self._is_due = True
            self._call_soon(self._run)

    def _run(self) -> None:
        until = perf_counter() + TURN
        while (has_more := self._run_one()) and perf_counter() <= until:
            pass
        self._is_due = False
        try:
            self._turn_ended()
        finally:
            if has_more:
                self._schedule()

    def _run_one(self) -> bool:
        """Take one step or handle one name; return whether there was one."""
        if self._steps:
            try:
                next(self._steps[0])
            except StopIteration:
                self._steps.popleft()
            except Exception:
                # A generator that has failed is at its end.
                logger.exception("Something that has left the graph cannot be removed.")
            return True
        for kind, names in self._waiting.items():
            if names:
                name, _ = names.popitem(last=False)
                try:
                    self._handle[kind](name)
                except Exception:
                    # One name must not keep the others from being handled.
                    logger.exception("%s cannot be brought up to date.", name)
                return True
        return False
