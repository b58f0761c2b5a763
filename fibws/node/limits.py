"""The bounds that a program gives: how many, and how long."""

from __future__ import annotations

import math

UNBOUNDED_QUEUE = 10_000
"""Messages that a subscription without a bound of its own asks the hub to keep when it is slow: a
second of the fastest topics. The hub bounds their bytes all the same (--max-queued-bytes)."""


def check_queue_size(queue_size: int) -> None:
    """Raise ValueError unless that many messages can wait."""
    if queue_size < 1:
        raise ValueError(f"queue_size is at least 1, not {queue_size}")


def check_timeout(timeout: float | None) -> None:
    """Raise ValueError unless one can wait that long, in seconds; None is for ever."""
    if timeout is not None and not 0 < timeout < math.inf:
        raise ValueError(f"a timeout is a number of seconds above 0, or None, not {timeout!r}")
