"""A bounded buffer of transforms: a tree of frames over time, after tf2's BufferCore.

Pure: no clock, no sockets.
"""

from __future__ import annotations

from collections.abc import Iterator
from math import isfinite

from fibws.tf.errors import (
    FrameLoop,
    InvalidTransform,
    TransformOutOfTime,
    UnconnectedFrames,
    UnknownFrame,
)
from fibws.tf.history import LATEST, History, Sample, Static
from fibws.tf.transform import Transform, normalized

MAX_FRAMES = 1000
"""Maximum number of frames with a parent; more remove the one that was silent the longest."""

MAX_SAMPLES = 200_000
"""Maximum number of samples of all frames: 100 frames at 100 Hz fill half, at 0.5 kB each."""

MAX_FRAME_ID = 256
"""Maximum number of characters of a frame's id."""

TOLERANCE = 0.01
"""Maximum difference between a quaternion's squared length and 1, as in tf2."""


class Buffer:
    """Keeps transforms and looks up the one between any two connected frames."""

    def __init__(self) -> None:
        self._frames: dict[str, History | Static] = {}
        """The frames with a parent, by id; the one with the newest sample is last."""
        self._samples = 0

    def __len__(self) -> int:
        """Return the number of frames with a parent."""
        return len(self._frames)

    @property
    def samples(self) -> int:
        """The number of samples of all frames."""
        return self._samples

    def insert(self, frame: str, sample: Sample, *, static: bool = False) -> None:
        """Add a sample of a frame's transform in its parent.

        A static transform replaces the moving ones of the frame, and a moving one the static one.

        Args:
            static: the sample is valid at all times; its stamp is ignored.

        Raises:
            InvalidTransform: the frame or the sample is invalid; the text says why.
        """
        frame, sample = checked(frame, sample)
        place = self._frames.pop(frame, None)
        self._samples -= len(place) if place is not None else 0
        if static:
            place = Static(sample)
        else:
            if not isinstance(place, History):
                place = History(frame)
            place.insert(sample)
        self._keep(frame, place)

    def lookup(self, target: str, source: str, stamp: int = LATEST) -> Sample:
        """Return the transform of ``source`` in ``target``, as tf2's lookupTransform.

        It turns coordinates in the source frame into coordinates in the target frame.

        Args:
            stamp: the time; 0 for the latest one at which the whole path is known.

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
        if stamp == LATEST:
            rising, falling = self._path(target, source, LATEST)
            stamp = min((link.stamp for link in rising + falling if link.stamp), default=LATEST)
        rising, falling = self._path(target, source, stamp)
        return Sample(stamp, target, _along(falling).inverse() @ _along(rising))

    def _keep(self, frame: str, place: History | Static) -> None:
        if len(self._frames) == MAX_FRAMES:
            self._remove_one()
        self._frames[frame] = place
        self._samples += len(place)
        while self._samples > MAX_SAMPLES and isinstance(place, History) and len(place) > 1:
            place.shorten()
            self._samples -= 1

    def _remove_one(self) -> None:
        """Remove a frame; a static one, which is published only once, if there is no other."""
        oldest = next(
            (frame for frame, place in self._frames.items() if isinstance(place, History)),
            next(iter(self._frames)),
        )
        self._samples -= len(self._frames.pop(oldest))

    def _path(self, target: str, source: str, stamp: int) -> tuple[list[Sample], list[Sample]]:
        """Return the links from source and target up to their nearest common ancestor."""
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
            gap = error  # The common ancestor may be below the gap.
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
        """Yield the links from a frame to its parent, and so on up to the root."""
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


def checked(frame: str, sample: Sample) -> tuple[str, Sample]:
    """Return a valid frame id and a sample with a normalized rotation.

    Raises:
        InvalidTransform: the frame or the sample is invalid; the text says why.
    """
    frame, parent = frame_id(frame), frame_id(sample.parent)
    if frame == parent:
        raise InvalidTransform(f"the frame {frame!r} cannot be its own parent")
    translation, rotation = sample.transform.translation, sample.transform.rotation
    if not all(map(isfinite, (*translation, *rotation))):
        raise InvalidTransform(
            f"{frame!r}: expected finite numbers, got the translation {translation} and the "
            f"rotation {rotation} (x, y, z, w)"
        )
    if abs(sum(component * component for component in rotation) - 1) > TOLERANCE:
        raise InvalidTransform(
            f"{frame!r}: the rotation {rotation} is not a quaternion (x, y, z, w) of length 1; "
            f"the identity is (0, 0, 0, 1)"
        )
    transform = Transform(translation, normalized(rotation))
    return frame, Sample(sample.stamp, parent, transform)


def _along(links: list[Sample]) -> Transform:
    """Return the transform from the first link's frame up to the last link's parent."""
    whole = Transform()
    for link in links:
        whole = link.transform @ whole
    return whole
