"""A bounded buffer of transforms: a tree of frames over time, after tf2's BufferCore.

Pure: no clock, no sockets.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from math import isfinite
from operator import attrgetter
from typing import Any, NamedTuple, TypeVar

from fibws.interfaces.times import Time
from fibws.tf.errors import (
    FrameLoop,
    InvalidTransform,
    TransformOutOfTime,
    UnconnectedFrames,
    UnknownFrame,
)
from fibws.tf.history import CACHE_TIME, LATEST, History, Sample, Static, nanoseconds_of
from fibws.tf.transform import (
    Link,
    Transform,
    along,
    link_of,
    normalized,
    transform_of,
    with_sign_of_matrix,
)

L = TypeVar("L", bound=tuple[Any, ...])
_LATEST_LINK: Callable[[History | Static], tuple[str, int]] = attrgetter("latest_link")

MAX_FRAMES = 1000
"""Maximum number of frames with a parent; more remove the one that was silent the longest."""

MAX_SAMPLES = 200_000
"""Maximum number of samples of all frames: 100 frames at 100 Hz fill half, at 0.5 kB each."""

MAX_FRAME_ID = 256
"""Maximum number of characters of a frame's id."""

TOLERANCE = 0.01
"""Maximum difference between a quaternion's squared length and 1, as in tf2."""


class FrameInfo(NamedTuple):
    """What is known about a frame with a parent."""

    frame: str
    parent: str
    authority: str
    """The node that sent the latest sample."""
    samples: int
    latest: int
    """The stamp of the latest sample; 0 for static frames."""
    oldest: int
    """The stamp of the oldest sample; 0 for static frames."""


class Buffer:
    """Keeps transforms and looks up the one between any two connected frames.

    Args:
        cache_time: seconds that the history of each moving frame reaches back from its latest
            sample.
        strict: treat samples as tf2 does: those that repeat a stamp and those that are too old are
            refused, and a frame that began as moving, or as static, stays so.
    """

    def __init__(self, cache_time: float = CACHE_TIME / 1e9, *, strict: bool = False) -> None:
        self._cache_time = round(cache_time * 1e9)
        self._strict = strict
        self._frames: dict[str, History | Static] = {}
        """The frames with a parent, by id; the one with the newest sample is last."""
        self._authorities: dict[str, str] = {}
        self._known: dict[str, None] = {}
        """All frames that were named, in this order; their number is bounded, too."""
        self._samples = 0

    def __len__(self) -> int:
        """Return the number of frames with a parent."""
        return len(self._frames)

    @property
    def samples(self) -> int:
        """The number of samples of all frames."""
        return self._samples

    def insert(
        self, frame: str, sample: Sample, *, static: bool = False, authority: str = ""
    ) -> None:
        """Add a sample of a frame's transform in its parent.

        A static transform replaces the moving ones of the frame, and a moving one the static one;
        not so in a strict buffer.

        Args:
            static: the sample is valid at all times; its stamp is ignored.
            authority: the node that sent it.

        Raises:
            InvalidTransform: the frame or the sample is invalid; the text says why.
        """
        self.insert_link(
            frame,
            sample.stamp,
            link_of(sample.parent, sample.transform),
            static=static,
            authority=authority,
        )

    def insert_link(
        self, frame: str, stamp: int, link: Link, *, static: bool = False, authority: str = ""
    ) -> None:
        """Add a sample as a flat tuple; see `insert`."""
        names = self._known
        if frame not in names or link[0] not in names or frame == link[0] or not _is_unit(link):
            frame, sample = checked(frame, Sample(stamp, link[0], transform_of(link)))
            link = link_of(sample.parent, sample.transform)
        known = self._frames.get(frame)
        before = 0 if known is None else len(known)
        if self._strict and known is not None:
            static = isinstance(known, Static)
        place: History | Static
        if static:
            place = Static(link)
        else:
            if not isinstance(known, History):
                known = History(self._cache_time, strict=self._strict)
            known.insert(stamp, link)
            place = known
        self._frames.pop(frame, None)
        self._samples -= before
        self._authorities[frame] = authority
        self._keep(frame, place)
        self._remember(frame, link[0])

    def clear(self) -> None:
        """Remove all samples of moving frames; the static ones stay, as in tf2."""
        for frame, place in list(self._frames.items()):
            if isinstance(place, History):
                self._remove(frame)

    def lookup(self, target: str, source: str, stamp: Time | int = LATEST) -> Sample:
        """Return the transform of ``source`` in ``target``, as tf2's lookupTransform.

        It turns coordinates in the source frame into coordinates in the target frame.

        Args:
            stamp: the time, such as that of a message, or nanoseconds; 0 for the latest one at
                which the whole path is known.

        Returns:
            A sample with the target as parent; its stamp is 0 if the whole path is static.

        Raises:
            InvalidTransform: a frame's id is invalid.
            UnknownFrame: a frame does not exist.
            UnconnectedFrames: no transforms connect the frames.
            FrameLoop: the frames contain a loop.
            TransformOutOfTime: the path is unknown at this time.
        """
        target, source = frame_id(target), frame_id(source)
        stamp, rising, falling = self._timed_path(target, source, nanoseconds_of(stamp))
        transform = along(rising)
        if falling:
            transform = along(falling).inverse() @ transform
        return Sample(stamp, target, transform)

    def lookup_full(
        self,
        target: str,
        target_stamp: Time | int,
        source: str,
        source_stamp: Time | int,
        fixed: str,
    ) -> Sample:
        """Return the transform of ``source`` at one time in ``target`` at another.

        Args:
            target: the frame in which the result is.
            target_stamp: the time of the target frame, and of the result; 0 for the latest.
            source: the frame whose transform is wanted.
            source_stamp: the time of the source frame; 0 for the latest.
            fixed: a frame that does not move between the two times, such as map.

        Raises:
            TransformError: as `lookup`.
        """
        target, source, fixed = frame_id(target), frame_id(source), frame_id(fixed)
        names = (("target_frame", target), ("source_frame", source), ("fixed_frame", fixed))
        for argument, frame in names:
            self._require(frame, argument)
        in_fixed = self.lookup(fixed, source, source_stamp)
        in_target = self.lookup(target, fixed, target_stamp)
        translation, rotation = in_target.transform @ in_fixed.transform
        transform = Transform(translation, with_sign_of_matrix(rotation))  # as in tf2
        return in_target._replace(transform=transform)

    def check(self, target: str, source: str, stamp: Time | int = LATEST) -> None:
        """Raise as `lookup` does, without computing the transform."""
        self._timed_path(frame_id(target), frame_id(source), nanoseconds_of(stamp))

    def latest_common_time(self, target: str, source: str) -> int:
        """Return the latest time at which the path between two frames is known.

        It is 0 if the whole path is static, and a frame's own latest time if both are the same.

        Raises:
            TransformError: as `lookup`.
        """
        target, source = frame_id(target), frame_id(source)
        if target == source:
            place = self._frames.get(source)
            return place.latest_link[1] if place is not None else LATEST
        self._require(target, "target_frame")
        self._require(source, "source_frame")
        return self._common_time(target, source)

    def chain(
        self,
        target: str,
        target_stamp: Time | int,
        source: str,
        source_stamp: Time | int,
        fixed: str,
    ) -> list[str]:
        """Return the frames on the way from ``source`` over ``fixed`` to ``target``.

        Raises:
            TransformError: as `lookup_full`.
        """
        first = self._frames_between(
            frame_id(fixed), frame_id(source), nanoseconds_of(source_stamp)
        )
        second = self._frames_between(
            frame_id(target), frame_id(fixed), nanoseconds_of(target_stamp)
        )
        return [*first[:-1], *second] if first and second else [*first, *second]

    def exists(self, frame: str) -> bool:
        """Return whether a transform has named this frame."""
        return frame in self._known

    def frames(self) -> list[str]:
        """Return all frames, in the order in which transforms named them."""
        return list(self._known)

    def infos(self) -> list[FrameInfo]:
        """Return what is known about each frame with a parent, in the same order."""
        found = ((frame, self._frames.get(frame)) for frame in self._known)
        return [
            FrameInfo(
                frame,
                place.latest_link[0],
                self._authorities.get(frame, ""),
                len(place),
                place.latest_link[1],
                place.oldest_stamp,
            )
            for frame, place in found
            if place is not None
        ]

    def listing(self) -> str:
        """Return a line for each frame with its parent, as tf2's allFramesAsString."""
        return "".join(
            f"Frame {info.frame} exists with parent {info.parent}.\n" for info in self.infos()
        )

    def _keep(self, frame: str, place: History | Static) -> None:
        if len(self._frames) >= MAX_FRAMES:
            self._remove_one()
        self._frames[frame] = place
        self._samples += len(place)
        while self._samples > MAX_SAMPLES and isinstance(place, History) and len(place) > 1:
            place.shorten()
            self._samples -= 1

    def _remember(self, frame: str, parent: str) -> None:
        known = self._known
        if frame not in known:
            known[frame] = None
        if parent not in known:
            known[parent] = None
            if len(known) > 4 * MAX_FRAMES:
                parents = {place.latest_link[0] for place in self._frames.values()}
                self._known = {each: None for each in known if each in {*self._frames, *parents}}

    def _remove_one(self) -> None:
        """Remove a frame; a static one, which is published only once, if there is no other."""
        oldest = next(
            (frame for frame, place in self._frames.items() if isinstance(place, History)),
            next(iter(self._frames)),
        )
        self._remove(oldest)
        if all(place.latest_link[0] != oldest for place in self._frames.values()):
            del self._known[oldest]

    def _remove(self, frame: str) -> None:
        self._samples -= len(self._frames.pop(frame))
        del self._authorities[frame]

    def _require(self, frame: str, argument: str) -> None:
        if frame not in self._known:
            raise UnknownFrame(frame, argument)

    def _timed_path(
        self, target: str, source: str, stamp: int
    ) -> tuple[int, list[Link], list[Link]]:
        """Return the time of a path, and its links up to the nearest common ancestor."""
        if target == source:
            return stamp or self.latest_common_time(target, source), [], []
        self._require(target, "target_frame")
        self._require(source, "source_frame")
        if stamp == LATEST:
            stamp = self._common_time(target, source)
        try:
            return stamp, *self._path(target, source, lambda place: place.at(stamp))
        except TransformOutOfTime as error:
            raise TransformOutOfTime(
                f"{error}, when looking up transform from frame [{source}] to frame [{target}]"
            ) from None

    def _common_time(self, target: str, source: str) -> int:
        rising, falling = self._path(target, source, _LATEST_LINK)
        return min((stamp for _, stamp in rising + falling if stamp), default=LATEST)

    def _path(
        self, target: str, source: str, link_of_place: Callable[[History | Static], L]
    ) -> tuple[list[L], list[L]]:
        """Return the links from source and target up to their nearest common ancestor.

        Args:
            link_of_place: returns a tuple that begins with a frame's parent.
        """
        rising: list[L] = []
        falling: list[L] = []
        height = {source: 0}
        gap: TransformOutOfTime | None = None
        try:
            for link in self._links(source, link_of_place):
                rising.append(link)
                parent = link[0]
                height[parent] = len(rising)
                if parent == target:
                    return rising, []
        except TransformOutOfTime as error:
            gap = error  # The common ancestor may be below the gap.
        for link in self._links(target, link_of_place):
            falling.append(link)
            if link[0] in height:
                return rising[: height[link[0]]], falling
        if gap is not None:
            raise gap
        raise UnconnectedFrames(target, source)

    def _links(self, frame: str, link_of_place: Callable[[History | Static], L]) -> Iterator[L]:
        """Yield the links from a frame to its parent, and so on up to the root."""
        start, frames = frame, self._frames
        for _ in range(len(frames)):
            if (place := frames.get(frame)) is None:
                return
            yield (link := link_of_place(place))
            frame = link[0]
        if frame in frames:
            raise FrameLoop(start, self.listing())

    def _frames_between(self, target: str, source: str, stamp: int) -> list[str]:
        """Return the frames from source to target, both included; none if they are the same."""
        _, rising, falling = self._timed_path(target, source, stamp)
        if not rising and not falling:
            return []
        up = [source, *(link[0] for link in rising)]
        down = [target, *(link[0] for link in falling)]
        return up + down[-2::-1]


def frame_id(name: str) -> str:
    """Return a frame's id without a leading ``/``, which only the first version of tf had.

    Raises:
        InvalidTransform: the id is empty or too long.
    """
    name = name.removeprefix("/")
    if not name:
        raise InvalidTransform("a frame's id is empty; expected a name such as base_link")
    if len(name) > MAX_FRAME_ID:
        raise InvalidTransform(
            f"the frame id {name[:40]!r}... is too long (limit {MAX_FRAME_ID} characters)"
        )
    return name


def _is_unit(link: Link) -> bool:
    """Return whether all numbers are finite, and the rotation needs not be normalized."""
    _, x, y, z, qx, qy, qz, qw = link
    return abs(qx * qx + qy * qy + qz * qz + qw * qw - 1) < 1e-12 and isfinite(x + y + z)


def checked(frame: str, sample: Sample) -> tuple[str, Sample]:
    """Return a valid frame id and a sample with a normalized rotation.

    Raises:
        InvalidTransform: the frame or the sample is invalid; the text says why.
    """
    frame, parent = frame_id(frame), frame_id(sample.parent)
    if frame == parent:
        raise InvalidTransform(f"the frame {frame!r} cannot be its own parent")
    translation, rotation = sample.transform
    (x, y, z), (qx, qy, qz, qw) = translation, rotation
    length = qx * qx + qy * qy + qz * qz + qw * qw
    if not isfinite(x + y + z + length) and not all(map(isfinite, (*translation, *rotation))):
        raise InvalidTransform(
            f"{frame!r}: expected finite numbers, got the translation {translation} and the "
            f"rotation {rotation} (x, y, z, w)"
        )
    if not abs(length - 1) <= TOLERANCE:
        raise InvalidTransform(
            f"{frame!r}: the rotation {rotation} is not a quaternion (x, y, z, w) of length 1; "
            f"the identity is (0, 0, 0, 1)"
        )
    transform = Transform(translation, normalized(rotation))
    return frame, Sample(sample.stamp, parent, transform)
