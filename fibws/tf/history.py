"""Where one frame was in its parent over time.

A stamp is nanoseconds since 1970. As everywhere in tf2, 0 stands for no time in particular: asked
for, it means the latest. Pure: no clock.
"""

from __future__ import annotations

from bisect import bisect_left
from operator import attrgetter
from typing import NamedTuple

from fibws.errors import TransformOutOfTime
from fibws.tf.transform import Transform

CACHE_TIME = 10_000_000_000
"""How far a history reaches back from its latest sample, as tf2's does: nanoseconds."""

LATEST = 0


class Sample(NamedTuple):
    """Where a frame was in its parent at one time."""

    stamp: int
    parent: str
    transform: Transform


class History:
    """The samples of a frame that moves, of the last `CACHE_TIME` that its stamps tell of."""

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
        """Keep a sample; it replaces one of the same time.

        tf2 did so too until, in Noetic, it began to ignore such a sample (TF_REPEATED_DATA). That
        would freeze every broadcaster that never sets its stamps. Nor does it ignore what is older
        than the history reaches back (TF_OLD_DATA): then the clock was set back, or a recording
        began again, and the history begins again with it.
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
        """Forget the oldest sample."""
        del self._samples[0]

    def at(self, stamp: int) -> Sample:
        """Where the frame was at a time, between two samples on the way from one to the other.

        While its parent changes, it stays where it was in the older one.

        Raises:
            TransformOutOfTime: no samples are from before and after the time.
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
            known = f"is known until {seconds(latest)}: that would be extrapolation into the future"
        else:
            known = f"is known since {seconds(oldest)}: that would be extrapolation into the past"
        return TransformOutOfTime(
            f"The transform of {self._frame!r} at {seconds(stamp)} was asked for, but it {known}"
        )


class FixedPlace:
    """The one sample of a frame that does not move; it is right at all times."""

    def __init__(self, sample: Sample) -> None:
        self._sample = sample._replace(stamp=LATEST)

    def __len__(self) -> int:
        return 1

    @property
    def latest(self) -> Sample:
        """The sample, its stamp 0 so that it makes no other frame's seem late."""
        return self._sample

    def at(self, stamp: int) -> Sample:
        """The sample, at this time as at any other."""
        return self._sample


def seconds(nanoseconds: int) -> str:
    """Nanoseconds as seconds, exactly, without zeros at the end."""
    whole, rest = divmod(nanoseconds, 1_000_000_000)
    return f"{whole}.{rest:09}".rstrip("0").rstrip(".")
