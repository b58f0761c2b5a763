"""The transforms of one frame in its parent over time.

A stamp is in nanoseconds since 1970; 0 stands for the latest one, as in tf2. Pure: no clock.
"""

from __future__ import annotations

from bisect import bisect_left
from operator import attrgetter
from typing import NamedTuple

from fibws.tf.errors import TransformOutOfTime
from fibws.tf.transform import Transform

CACHE_TIME = 10_000_000_000
"""Nanoseconds that a history reaches back from its latest sample, as in tf2."""

LATEST = 0


class Sample(NamedTuple):
    """The transform of a frame in its parent at one time."""

    stamp: int
    parent: str
    transform: Transform


class History:
    """The samples of a moving frame during the last `CACHE_TIME`, by their stamps."""

    def __init__(self, frame: str) -> None:
        self._frame = frame
        self._samples: list[Sample] = []  # Oldest first.

    def __len__(self) -> int:
        return len(self._samples)

    @property
    def latest(self) -> Sample:
        """The newest sample; there is always one after the first `insert`."""
        return self._samples[-1]

    def insert(self, sample: Sample) -> None:
        """Add a sample; it replaces one of the same time.

        tf2 ignores it since Noetic (TF_REPEATED_DATA), which would freeze every broadcaster that
        does not set its stamps. A sample older than the history (TF_OLD_DATA) clears it: the clock
        was set back, or a recording was restarted.
        """
        samples = self._samples
        if samples and sample.stamp < self.latest.stamp - CACHE_TIME:
            samples.clear()
        place = bisect_left(samples, sample.stamp, key=attrgetter("stamp"))
        same = place < len(samples) and samples[place].stamp == sample.stamp
        samples[place : place + same] = [sample]
        oldest = self.latest.stamp - CACHE_TIME
        del samples[: bisect_left(samples, oldest, key=attrgetter("stamp"))]

    def shorten(self) -> None:
        """Remove the oldest sample."""
        del self._samples[0]

    def at(self, stamp: int) -> Sample:
        """Return the sample at a time, interpolated between two samples.

        Between samples with different parents, it is the older one.

        Raises:
            TransformOutOfTime: the time is outside the history.
        """
        samples = self._samples
        if stamp == LATEST:
            return self.latest
        place = bisect_left(samples, stamp, key=attrgetter("stamp"))
        if place < len(samples) and samples[place].stamp == stamp:
            return samples[place]
        if not 0 < place < len(samples):
            raise self._out_of_time(stamp)
        before, after = samples[place - 1], samples[place]
        if before.parent != after.parent:
            return before
        ratio = (stamp - before.stamp) / (after.stamp - before.stamp)
        between = before.transform.interpolated(after.transform, ratio)
        return Sample(stamp, before.parent, between)

    def _out_of_time(self, stamp: int) -> TransformOutOfTime:
        oldest, latest = self._samples[0].stamp, self.latest.stamp
        if oldest == latest:
            known = f"is known at {seconds(latest)} only"
        elif stamp > latest:
            known = f"is known until {seconds(latest)}: extrapolation into the future"
        else:
            known = f"is known since {seconds(oldest)}: extrapolation into the past"
        return TransformOutOfTime(
            f"The transform of {self._frame!r} was requested at {seconds(stamp)}, but it {known}"
        )


class Static:
    """The sample of a static frame, which is valid at all times."""

    def __init__(self, sample: Sample) -> None:
        self._sample = sample._replace(stamp=LATEST)

    def __len__(self) -> int:
        return 1

    @property
    def latest(self) -> Sample:
        """The sample; its stamp is 0, so that it does not limit the latest common time."""
        return self._sample

    def at(self, stamp: int) -> Sample:
        """Return the sample."""
        return self._sample


def seconds(nanoseconds: int) -> str:
    """Write nanoseconds as seconds, exactly, without trailing zeros."""
    whole, rest = divmod(nanoseconds, 1_000_000_000)
    return f"{whole}.{rest:09}".rstrip("0").rstrip(".")
