"""Rates of messages, and other statistics of the latest measurements."""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Mapping, Sequence
from typing import NamedTuple, TypeAlias

_HEADS = ("topic", "rate", "min_delta", "max_delta", "std_dev", "window")

MAX_WINDOW = 50_000
"""Default number of measurements that are kept, as in rostopic."""


class Summary(NamedTuple):
    """Statistics of measurements."""

    mean: float
    least: float
    most: float
    deviation: float
    """The standard deviation."""


class Window:
    """The latest measurements.

    Args:
        size: maximum number of measurements.
    """

    def __init__(self, size: int = MAX_WINDOW) -> None:
        self._values: deque[float] = deque(maxlen=size)

    def __len__(self) -> int:
        return len(self._values)

    def add(self, value: float) -> None:
        """Add a measurement; a full window drops the oldest one."""
        self._values.append(value)

    @property
    def oldest(self) -> float:
        """The oldest measurement; raises `IndexError` if there is none."""
        return self._values[0]

    @property
    def total(self) -> float:
        """The sum of the measurements."""
        return math.fsum(self._values)

    def summary(self) -> Summary:
        """Return the statistics; raise `ValueError` if there are no measurements."""
        if not self._values:
            raise ValueError("no measurements")
        mean = self.total / len(self._values)
        variance = math.fsum((each - mean) ** 2 for each in self._values) / len(self._values)
        return Summary(mean, min(self._values), max(self._values), math.sqrt(variance))


def in_seconds(summary: Summary) -> str:
    """Return statistics of seconds in the format of rostopic hz and rostopic delay."""
    least, most, deviation = summary[1:]
    return f"min: {least:.3f}s max: {most:.3f}s std dev: {deviation:.5f}s"


def as_object(summary: Summary) -> dict[str, float]:
    """Return statistics for JSON."""
    return {"min": summary.least, "max": summary.most, "std_dev": summary.deviation}


class MessageRate:
    """The rate of a topic.

    Args:
        window: number of latest messages to measure.
    """

    def __init__(self, window: int = MAX_WINDOW) -> None:
        self._deltas = Window(window - 1)
        self._last: float | None = None
        self._reported: float | None = None

    def add(self, now: float) -> None:
        """Count a message that is received at ``now``, in seconds."""
        if self._last is not None:
            self._deltas.add(now - self._last)
        self._last = now

    def poll(self) -> tuple[float, Summary, int] | None:
        """Return the rate in Hz, the seconds between messages, and the number of messages.

        Return None if there is no new message since the last poll, or only one message so far.
        """
        if not self._deltas or self._last == self._reported:
            return None
        self._reported = self._last
        summary = self._deltas.summary()
        return 1 / summary.mean if summary.mean > 0 else 0.0, summary, len(self._deltas) + 1


Polled: TypeAlias = Mapping[str, tuple[float, Summary, int]]
"""The rates of topics with new messages, as `MessageRate.poll` returns them."""


def poll(rates: Mapping[str, MessageRate]) -> Polled:
    """Return the rates of the topics that have new messages."""
    return {topic: found for topic, rate in rates.items() if (found := rate.poll()) is not None}


def rates_text(polled: Polled, topics: int) -> str:
    """Return rates in the format of rostopic hz, without the last line break.

    Args:
        polled: the topics with new messages.
        topics: number of topics that are measured.
    """
    if not polled:
        return "no new messages"
    if topics > 1:
        return _table([_row(topic, *each) for topic, each in polled.items()])
    ((rate, deltas, number),) = polled.values()
    return f"average rate: {rate:.3f}\n\t{in_seconds(deltas)} window: {number}"


def _row(topic: str, rate: float, deltas: Summary, number: int) -> list[str]:
    numbers = (rate, deltas.least, deltas.most, deltas.deviation)
    return [topic, *(f"{each:.4}" for each in numbers), str(number)]


def _table(rows: Sequence[Sequence[str]]) -> str:
    """Return rows under a head, in the format of rostopic hz for several topics."""
    widths = [max(len(each[i]) for each in (_HEADS, *rows)) for i in range(len(_HEADS))]
    lines = [
        "   ".join(head.center(width) for head, width in zip(_HEADS, widths, strict=True)),
        "=" * (sum(widths) + 3 * (len(widths) - 1)),
        *("   ".join(c.ljust(w) for c, w in zip(row, widths, strict=True)) for row in rows),
    ]
    return "\n".join(lines) + "\n"


BANDWIDTH_WINDOW = 100
BYTES = ((1_000_000, "MB"), (1_000, "KB"), (1, "B"))
"""Units in bytes, the largest first; a report has one unit for all its numbers."""


class Bandwidth:
    """The bandwidth of a topic.

    Args:
        window: number of latest messages to measure.
    """

    def __init__(self, window: int = BANDWIDTH_WINDOW) -> None:
        self._sizes = Window(window)
        self._times = Window(window)

    def add(self, size: int, now: float) -> None:
        """Count a message of ``size`` bytes, received at ``now`` in seconds."""
        self._sizes.add(size)
        self._times.add(now)

    def at(self, now: float) -> tuple[float, Summary, int] | None:
        """Return the bytes per second until ``now``, the messages' sizes, and their number.

        Return None for fewer than two messages.
        """
        if len(self._sizes) < 2 or now <= self._times.oldest:
            return None
        rate = self._sizes.total / (now - self._times.oldest)
        return rate, self._sizes.summary(), len(self._sizes)


def bandwidth_text(rate: float, sizes: Summary, number: int) -> str:
    """Return a rate in bytes per second and message sizes in the format of rostopic bw."""
    factor, unit = next((each for each in BYTES if rate >= each[0]), BYTES[-1])
    average, mean, least, most = (
        f"{each / factor:.2f}{unit}" for each in (rate, sizes.mean, sizes.least, sizes.most)
    )
    return f"average: {average}/s\n\tmean: {mean} min: {least} max: {most} window: {number}"


def delay_text(delays: Summary, number: int) -> str:
    """Return the delays of ``number`` messages in the format of rostopic delay."""
    return f"average delay: {delays.mean:.3f}\n\t{in_seconds(delays)} window: {number}"
