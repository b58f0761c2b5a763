"""Names to be brought up to date, and other steps, a millisecond at a time."""

from __future__ import annotations

import logging
from collections import OrderedDict, deque
from collections.abc import Callable, Iterator, Mapping
from time import perf_counter

from fibws.hub.federation.records import Kind

logger = logging.getLogger("fibws.hub")

TURN = 0.001
"""Seconds of work before others have their turn."""


class Worklist:
    """Names that have changed, each handled once soon.

    Args:
        call_soon: calls a function in the next turn of the event loop.
        handle: handles a name of each kind; kinds that come first are handled first.
    """

    def __init__(
        self,
        call_soon: Callable[[Callable[[], None]], object],
        handle: Mapping[Kind, Callable[[str], None]],
    ) -> None:
        self._call_soon = call_soon
        self._handle = handle
        # The first of a dict from which many were removed takes long to find.
        self._waiting: dict[Kind, OrderedDict[str, None]] = {kind: OrderedDict() for kind in handle}
        self._steps: deque[Iterator[None]] = deque()
        self._is_due = False

    def add(self, kind: Kind, name: str) -> None:
        """Handle a name soon."""
        self._waiting[kind][name] = None
        self._schedule()

    def add_steps(self, steps: Iterator[None]) -> None:
        """Take some steps soon, before names are handled."""
        self._steps.append(steps)
        self._schedule()

    def _schedule(self) -> None:
        if not self._is_due:
            self._is_due = True
            self._call_soon(self._run)

    def finish(self) -> None:
        """Handle all names now."""
        while self._run_one():
            pass

    def _run(self) -> None:
        until = perf_counter() + TURN
        while self._run_one():
            if perf_counter() > until:
                self._call_soon(self._run)
                return
        self._is_due = False

    def _run_one(self) -> bool:
        """Take one step or handle one name; return whether there was one."""
        if self._steps:
            try:
                next(self._steps[0])
            except StopIteration:
                self._steps.popleft()
            except Exception:
                logger.exception("What another hub has left cannot be removed.")
                self._steps.popleft()
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
