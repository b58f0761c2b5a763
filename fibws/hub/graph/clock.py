"""The time of the graph's messages."""

from __future__ import annotations

from collections.abc import Callable


class GraphClock:
    """The system's time, or a simulated one (http://wiki.ros.org/Clock).

    Args:
        system: returns the nanoseconds since 1970.

    Attributes:
        simulated: the simulated time in nanoseconds; None while it is the system's.
    """

    def __init__(self, system: Callable[[], int]) -> None:
        self._system = system
        self.simulated: int | None = None

    def now(self) -> int:
        """Return the time in nanoseconds."""
        return self._system() if self.simulated is None else self.simulated
