"""When a hub tries again to join another one, and how often it says why it could not.

    lost          the network, a restart: at once, then every 2 seconds
    overloaded    a limit, a fault in what was sent: after a second, then ever later, to 30 seconds
    refused       a wrong token, a missing right: every 30 seconds, as tokens and rights may change

All times vary, so that the robots of a fleet do not come at one moment.
"""

from __future__ import annotations

import random
import re
from collections.abc import Callable
from typing import NamedTuple

STABLE = 60.0
"""Seconds after which a connection counts as one that works."""
LONGEST_ASKED = 120.0
"""Most seconds that the other hub may ask for, by ``Retry-After``."""
SHORTEST_SHARE = 0.7
"""The least share of a delay that is waited."""


class Pace(NamedTuple):
    """Seconds before the first retry, and the most before later ones; they double each time."""

    first: float
    longest: float


LOST = Pace(0.1, 2.0)
OVERLOADED = Pace(1.0, 30.0)
REFUSED = Pace(30.0, 30.0)

_LOST_CODES = {1000, 1001, 1005, 1006, 1011, 1012}
_OVERLOADED_CODES = {1013, 4429}
_LOST_STATUSES = {502, 504}
"""The statuses of a proxy while its hub restarts."""


def pace_of_close(code: int) -> Pace:
    """Return the pace after a connection was closed with a code."""
    if code in _LOST_CODES:
        return LOST
    return REFUSED if code >= 4000 and code not in _OVERLOADED_CODES else OVERLOADED


def pace_of_status(status: int) -> Pace:
    """Return the pace after a handshake was answered with an HTTP status."""
    if status in _LOST_STATUSES:
        return LOST
    return OVERLOADED if status >= 500 or status in (408, 429) else REFUSED


class Retries:
    """The delays of one hub that joins another one.

    Args:
        chance: returns a random number from 0 to 1.
    """

    def __init__(self, chance: Callable[[], float] = random.random) -> None:
        self._chance = chance
        self._next: dict[Pace, float] = {}
        self._logged: dict[str, Pace] = {}

    def delay(self, pace: Pace, asked: float = 0.0) -> float:
        """Return the seconds to wait.

        Args:
            asked: the least seconds, as the other hub has asked for.
        """
        delay = self._next.get(pace, pace.first)
        self._next[pace] = min(2 * delay, pace.longest)
        delay *= SHORTEST_SHARE + (1 - SHORTEST_SHARE) * self._chance()
        return max(delay, min(asked, LONGEST_ASKED) * (1 + self._chance() / 2))

    def is_new(self, pace: Pace, fault: str) -> bool:
        """Return whether a fault was not logged before, apart from numbers in it."""
        key = re.sub(r"\d+", "0", fault)
        is_new = key not in self._logged
        self._logged[key] = pace
        return is_new

    def joined(self) -> None:
        """Forget the losses, as the other hub is reached; its limits may soon be passed again."""
        self._next.pop(LOST, None)
        self._logged = {key: pace for key, pace in self._logged.items() if pace is not LOST}

    def worked(self, seconds: float) -> None:
        """Forget everything if a connection has worked for long enough."""
        if seconds >= STABLE:
            self._next.clear()
            self._logged.clear()


def seconds_asked(retry_after: str | None) -> float:
    """Return the seconds of a ``Retry-After`` header; 0 if it is missing or a date."""
    return float(retry_after) if retry_after is not None and _SECONDS.match(retry_after) else 0.0


_SECONDS = re.compile(r"[0-9]{1,6}\Z")
