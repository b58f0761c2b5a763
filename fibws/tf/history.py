"""The transforms of one frame in its parent over time.

A stamp is in nanoseconds since 1970; 0 stands for the latest one, as in tf2. Pure: no clock.
"""

from __future__ import annotations

from bisect import bisect_left
from typing import NamedTuple

from fibws.interfaces.times import Time
from fibws.tf.errors import OldData, RepeatedData, TransformOutOfTime
from fibws.tf.transform import Link, Transform, slerp, transform_of

CACHE_TIME = 10_000_000_000
"""Nanoseconds that a history reaches back from its latest sample by default, as in tf2."""

LATEST = 0


class Sample(NamedTuple):
    """The transform of a frame in its parent at one time."""

    stamp: int
    parent: str
    transform: Transform

    @property
    def time(self) -> Time:
        """The stamp as messages have it."""
        return Time.from_nanoseconds(self.stamp)


class History:
    """The samples of a moving frame, by their stamps.

    Args:
        cache_time: nanoseconds that it reaches back from its latest sample.
        strict: refuse samples as tf2 does; see `insert`.
    """

    def __init__(self, cache_time: int = CACHE_TIME, *, strict: bool = False) -> None:
        self._cache_time = cache_time
        self._strict = strict
        self._stamps: list[int] = []  # Oldest first.
        self._links: list[Link] = []

    def __len__(self) -> int:
        return len(self._stamps)

    @property
    def latest(self) -> Sample:
        """The newest sample; there is always one after the first `insert`."""
        return _sample(self._stamps[-1], self._links[-1])

    @property
    def latest_link(self) -> tuple[str, int]:
        """The parent and the stamp of the newest sample."""
        return self._links[-1][0], self._stamps[-1]

    @property
    def oldest_stamp(self) -> int:
        """The stamp of the oldest sample."""
        return self._stamps[0]

    def insert(self, stamp: int, link: Link) -> None:
        """Add a sample; it replaces one of the same time.

        tf2 ignores it since Noetic (TF_REPEATED_DATA), which would freeze every broadcaster that
        does not set its stamps. A sample older than the history (TF_OLD_DATA) clears it: the clock
        was set back, or a recording was restarted.

        Raises:
            RepeatedData: the history is strict, and has a sample of this time.
            OldData: the history is strict, and the sample is too old for it.
        """
        stamps, links = self._stamps, self._links
        if not stamps or stamp > stamps[-1]:
            stamps.append(stamp)
            links.append(link)
        elif stamp < stamps[-1] - self._cache_time:
            if self._strict:
                raise OldData(
                    "TF_OLD_DATA ignoring data from the past (Possible reasons are listed at "
                    "http://wiki.ros.org/tf/Errors%20explained)"
                )
            stamps[:], links[:] = [stamp], [link]
        else:
            place = bisect_left(stamps, stamp)
            if stamps[place] == stamp:
                if self._strict:
                    raise RepeatedData("TF_REPEATED_DATA ignoring data with redundant timestamp")
                links[place] = link
            else:
                stamps.insert(place, stamp)
                links.insert(place, link)
        if stamps[0] < (oldest := stamps[-1] - self._cache_time):
            count = bisect_left(stamps, oldest)
            del stamps[:count], links[:count]

    def shorten(self) -> None:
        """Remove the oldest sample."""
        del self._links[0], self._stamps[0]

    def at(self, stamp: int) -> Link:
        """Return the parent and the transform at a time, interpolated between two samples.

        Between samples with different parents, they are those of the older one.

        Raises:
            TransformOutOfTime: the time is outside the history.
        """
        stamps = self._stamps
        if stamp == LATEST or stamp == stamps[-1]:
            return self._links[-1]
        place = bisect_left(stamps, stamp)
        if place == len(stamps) or (place == 0 and stamps[0] != stamp):
            raise self._out_of_time(stamp)
        after, link = stamps[place], self._links[place]
        if after == stamp:
            return link
        before, older = stamps[place - 1], self._links[place - 1]
        parent, x, y, z, qx, qy, qz, qw = older
        if parent != link[0]:
            return older
        ratio = (stamp - before) / (after - before)
        rest = 1 - ratio
        _, to_x, to_y, to_z, *to_rotation = link
        rotation = slerp((qx, qy, qz, qw), tuple(to_rotation), ratio)  # type: ignore[arg-type]
        return (
            parent,
            x * rest + to_x * ratio,
            y * rest + to_y * ratio,
            z * rest + to_z * ratio,
            *rotation,
        )

    def _out_of_time(self, stamp: int) -> TransformOutOfTime:
        oldest, latest = self._stamps[0], self._stamps[-1]
        lookup = "Lookup would require extrapolation"
        if oldest == latest:
            return TransformOutOfTime(
                f"{lookup} at time {seconds(stamp)}, but only time {seconds(latest)} is in the "
                "buffer"
            )
        if stamp > latest:
            return TransformOutOfTime(
                f"{lookup} {seconds(stamp - latest)}s into the future.  "
                f"Requested time {seconds(stamp)} but the latest data is at time {seconds(latest)}"
            )
        return TransformOutOfTime(
            f"{lookup} {seconds(oldest - stamp)}s into the past.  Requested time {seconds(stamp)} "
            f"but the earliest data is at time {seconds(oldest)}"
        )


class Static:
    """The sample of a static frame, which is valid at all times."""

    def __init__(self, link: Link) -> None:
        self._link = link

    def __len__(self) -> int:
        return 1

    @property
    def latest(self) -> Sample:
        """The sample; its stamp is 0, so that it does not limit the latest common time."""
        return _sample(LATEST, self._link)

    @property
    def latest_link(self) -> tuple[str, int]:
        """The parent, and 0 as its stamp."""
        return self._link[0], LATEST

    @property
    def oldest_stamp(self) -> int:
        """The stamp of the sample, which is 0."""
        return LATEST

    def at(self, stamp: int) -> Link:
        """Return the parent and the transform."""
        return self._link


def _sample(stamp: int, link: Link) -> Sample:
    return Sample(stamp, link[0], transform_of(link))


def nanoseconds_of(stamp: Time | int) -> int:
    """Return a moment in nanoseconds; an int is returned unchanged."""
    return stamp.to_nanoseconds() if isinstance(stamp, Time) else stamp


def seconds(nanoseconds: int) -> str:
    """Write nanoseconds as seconds, with all nine decimals, as ROS does."""
    whole, rest = divmod(nanoseconds, 1_000_000_000)
    return f"{whole}.{rest:09}"
