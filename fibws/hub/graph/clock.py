"""The time of the graph's messages."""

from __future__ import annotations

from collections.abc import Callable


class GraphClock:
    """The system's time, or a simulated one (http://wiki.ros.org/Clock).

    Args:
        system: returns the nanoseconds since 1970.
    """

    def __init__(self, system: Callable[[], int]) -> None:
        self._system = system
        self._simulated: int | None = None
        self._watchers: list[Callable[[], object]] = []

    @property
    def simulated(self) -> int | None:
        """The simulated time in nanoseconds; None while it is the system's."""
        return self._simulated

    @simulated.setter
    def simulated(self, time: int | None) -> None:
        self._simulated = time
        for changed in self._watchers:
            changed()

    def watch(self, changed: Callable[[], object]) -> None:
        """Call a function whenever the simulated time is set, or has ended."""
        self._watchers.append(changed)

    def now(self) -> int:
        """Return the time in nanoseconds."""
        return self._system() if self._simulated is None else self._simulated
