"""The transforms that one client of tf2_web_republisher asked for, and which of them changed."""

from __future__ import annotations

import logging
from collections.abc import Sequence
from dataclasses import dataclass
from math import isnan

from fibws.errors import InvalidTransform, TransformError
from fibws.tf.buffer import MAX_FRAMES, Buffer, frame_id
from fibws.tf.transform import Transform


@dataclass(slots=True)
class _Source:
    frame: str
    sent: Transform | None = None
    known: bool = True


class Selection:
    """Where some frames are in a target frame, told when it changed by more than a threshold.

    The first transform of each frame counts as a change; where a threshold is 0, all do.

    RobotWebTools' tf2_web_republisher compares half of the angle, and takes a quaternion and its
    negative for two rotations. Here the threshold is the angle itself. Nor does this tell the
    transform of frames that are not known yet, for which that one sends zeros once.

    Args:
        target: the frame to express the others in.
        sources: the frames that it is about.
        angular: the angular threshold in radians.
        translational: the other threshold in metres.
        log: is told when a transform cannot be told any more, and when it can again.

    Raises:
        InvalidTransform: a frame's id is none, there are too many, or a threshold is no number.
    """

    def __init__(
        self,
        target: str,
        sources: Sequence[str],
        angular: float,
        translational: float,
        log: logging.Logger,
    ) -> None:
        if len(sources) > MAX_FRAMES:
            raise InvalidTransform(f"{len(sources)} frames at once: {MAX_FRAMES} are the most")
        if isnan(angular) or isnan(translational):
            raise InvalidTransform("a threshold is no number: write 0 to hear of every change")
        self._target = frame_id(target)
        self._sources = [_Source(frame) for frame in dict.fromkeys(map(frame_id, sources))]
        self._angular = angular
        self._translational = translational
        self._log = log

    @property
    def target(self) -> str:
        """The frame that the others are expressed in."""
        return self._target

    def changes(self, buffer: Buffer, *, whole: bool = False) -> dict[str, Transform]:
        """What is to be told now, by source frame; it counts as told from here on.

        Args:
            whole: tell all that is known if anything changed.
        """
        known = [
            (source, transform)
            for source in self._sources
            if (transform := self._lookup(source, buffer)) is not None
        ]
        due = [each for each in known if self._is_due(*each)]
        if whole and due:
            due = known
        for source, transform in due:
            source.sent = transform
        return {source.frame: transform for source, transform in due}

    def renew(self) -> None:
        """Count nothing as told, since somebody listens who heard none of it."""
        for source in self._sources:
            source.sent = None

    def _lookup(self, source: _Source, buffer: Buffer) -> Transform | None:
        try:
            transform = buffer.lookup(self._target, source.frame).transform
        except TransformError as error:
            if source.known:
                self._log.warning("No transform to %s: %s", self._target, error)
            source.known = False
            return None
        if not source.known:
            self._log.info("The transform from %s to %s is known.", source.frame, self._target)
        source.known = True
        return transform

    def _is_due(self, source: _Source, transform: Transform) -> bool:
        sent = source.sent
        return (
            sent is None
            or min(self._angular, self._translational) <= 0
            or sent.distance(transform) > self._translational
            or sent.angle(transform) > self._angular
        )
