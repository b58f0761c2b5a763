"""All transforms that are known: a tree of frames over time, after tf2's BufferCore.

Pure: no clock, no sockets. What it keeps is bounded, whatever it is given.
"""

from __future__ import annotations

from collections.abc import Iterator
from math import isfinite

from fibws.errors import (
    FrameLoop,
    InvalidTransform,
    TransformOutOfTime,
    UnconnectedFrames,
    UnknownFrame,
)
from fibws.tf.history import LATEST, FixedPlace, History, Sample
from fibws.tf.transform import Transform, normalized

MAX_FRAMES = 1000
"""Frames with a parent. One more makes the frame that has been still the longest be forgotten."""

MAX_SAMPLES = 200_000
"""Samples of all frames together: 100 frames at 100 Hz fill half of it, at about 0.5 kB each."""

MAX_FRAME_ID = 256
"""Characters in a frame's id."""

TOLERANCE = 0.01
"""How far the square of a quaternion's length may be from 1, as in tf2."""


class Buffer:
    """Keeps transforms and tells those between any two frames that they connect."""

    def __init__(self) -> None:
        self._frames: dict[str, History | FixedPlace] = {}
        """Who has a parent, by frame; the one that got a sample last stands last."""
        self._samples = 0

    def __len__(self) -> int:
        """How many frames have a parent."""
        return len(self._frames)

    @property
    def samples(self) -> int:
        """How many samples are kept, of all frames together."""
        return self._samples

    def insert(self, frame: str, sample: Sample, *, static: bool = False) -> None:
        """Keep where a frame is in its parent.

        Its latest parent and kind hold: a static transform makes an end of the moving ones, and a
        moving one of the static one.

        Args:
            static: the sample is right at all times, so its stamp says nothing.

        Raises:
            InvalidTransform: it is of no use: see the text.
        """
        frame, sample = checked(frame, sample)
        place = self._frames.pop(frame, None)
        self._samples -= len(place) if place is not None else 0
        if static:
            place = FixedPlace(sample)
        else:
            if not isinstance(place, History):
                place = History(frame)
            place.insert(sample)
        self._keep(frame, place)

    def lookup(self, target: str, source: str, stamp: int = LATEST) -> Sample:
        """Where ``source`` is in ``target``: what turns coordinates in the one into the other's.

        Args:
            target: the frame to express it in.
            source: the frame that it is about.
            stamp: at what time; 0 for the latest one at which the whole way is known.

        Returns:
            a sample with the target as parent; its stamp is 0 if all of the way is static.

        Raises:
            InvalidTransform: a frame's id is none.
            UnknownFrame: there is no such frame.
            UnconnectedFrames: nothing leads from the one to the other.
            FrameLoop: the frames are no tree.
            TransformOutOfTime: the way is not known at this time.
        """
        target, source = frame_id(target), frame_id(source)
        if stamp == LATEST:
            rising, falling = self._path(target, source, LATEST)
            stamp = min((link.stamp for link in rising + falling if link.stamp), default=LATEST)
        rising, falling = self._path(target, source, stamp)
        return Sample(stamp, target, _along(falling).inverse() @ _along(rising))

    def _keep(self, frame: str, place: History | FixedPlace) -> None:
        if len(self._frames) == MAX_FRAMES:
            self._forget_one()
        self._frames[frame] = place
        self._samples += len(place)
        while self._samples > MAX_SAMPLES and isinstance(place, History) and len(place) > 1:
            place.shorten()
            self._samples -= 1

    def _forget_one(self) -> None:
        """Make room. Static frames are published only once, so they go only if there is no other"""
        still = next(
            (frame for frame, place in self._frames.items() if isinstance(place, History)),
            next(iter(self._frames)),
        )
        self._samples -= len(self._frames.pop(still))

    def _path(self, target: str, source: str, stamp: int) -> tuple[list[Sample], list[Sample]]:
        """The links from the source and from the target up to their nearest common ancestor."""
        if target == source:
            return [], []
        rising: list[Sample] = []
        falling: list[Sample] = []
        height = {source: 0}
        gap: TransformOutOfTime | None = None
        try:
            for link in self._links(source, stamp):
                rising.append(link)
                height[link.parent] = len(rising)
                if link.parent == target:
                    return rising, []
        except TransformOutOfTime as error:
            gap = error  # The common ancestor may still be below.
        for link in self._links(target, stamp):
            falling.append(link)
            if link.parent in height:
                return rising[: height[link.parent]], falling
        if gap is not None:
            raise gap
        for frame in (target, source):
            if not self._exists(frame):
                raise UnknownFrame(frame)
        raise UnconnectedFrames(target, source)

    def _links(self, frame: str, stamp: int) -> Iterator[Sample]:
        """The links from a frame to its parent, from there to the next one, up to the root."""
        start = frame
        for _ in range(len(self._frames)):
            if (place := self._frames.get(frame)) is None:
                return
            yield (link := place.at(stamp))
            frame = link.parent
        if frame in self._frames:
            raise FrameLoop(start)

    def _exists(self, frame: str) -> bool:
        return frame in self._frames or any(
            place.latest.parent == frame for place in self._frames.values()
        )


def frame_id(name: str) -> str:
    """A frame's id as tf2 has it: without the ``/`` that it began with in tf's first version.

    Raises:
        InvalidTransform: it is empty or too long.
    """
    name = name.removeprefix("/")
    if not name:
        raise InvalidTransform("a frame's id is empty: write a name such as base_link")
    if len(name) > MAX_FRAME_ID:
        raise InvalidTransform(
            f"the frame id {name[:40]!r}... is longer than {MAX_FRAME_ID} characters"
        )
    return name


def checked(frame: str, sample: Sample) -> tuple[str, Sample]:
    """A frame's id and sample as they are kept.

    Raises:
        InvalidTransform: they are of no use: see the text.
    """
    frame, parent = frame_id(frame), frame_id(sample.parent)
    if frame == parent:
        raise InvalidTransform(f"the frame {frame!r} cannot be its own parent")
    translation, rotation = sample.transform.translation, sample.transform.rotation
    if not all(map(isfinite, (*translation, *rotation))):
        raise InvalidTransform(
            f"{frame!r}: a number is none in the translation {translation} or the rotation "
            f"{rotation} (x, y, z, w)"
        )
    if abs(sum(component * component for component in rotation) - 1) > TOLERANCE:
        raise InvalidTransform(
            f"{frame!r}: the rotation {rotation} is no quaternion (x, y, z, w) of length 1; "
            f"that of no rotation is (0, 0, 0, 1)"
        )
    transform = Transform(translation, normalized(rotation))
    return frame, Sample(sample.stamp, parent, transform)


def _along(links: list[Sample]) -> Transform:
    """The transform from the first link's frame up to the last link's parent."""
    whole = Transform()
    for link in links:
        whole = link.transform @ whole
    return whole
