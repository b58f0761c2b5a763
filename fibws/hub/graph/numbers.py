"""Numbers of 32 bits, by which binary frames name topics and services."""

from __future__ import annotations


class Numbers:
    """Gives out numbers from 1 on, each to one user at a time.

    A number that was given back is used again once all later ones have been given out: frames that
    name its former user may still be on their way.

    Args:
        last: the last one, which is followed by 1.
    """

    def __init__(self, last: int = 2**32 - 1) -> None:
        self._last = last
        self._newest = 0
        self._used: set[int] = set()

    def take(self) -> int:
        """Return a number that nobody uses."""
        number = self._after(self._newest)
        while number in self._used:
            number = self._after(number)
        self._newest = number
        self._used.add(number)
        return number

    def give_back(self, number: int) -> None:
        """End the use of a number; nothing happens if nobody uses it."""
        self._used.discard(number)

    def _after(self, number: int) -> int:
        return number % self._last + 1
