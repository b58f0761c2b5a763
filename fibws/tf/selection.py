"""The transforms that one client of tf2_web_republisher requested, and their changes."""

from __future__ import annotations

import logging
from collections.abc import Sequence
from dataclasses import dataclass
from math import isnan

from fibws.tf.buffer import MAX_FRAMES, Buffer, frame_id
from fibws.tf.errors import InvalidTransform, TransformError
from fibws.tf.transform import Transform


@dataclass(slots=True)
class _Source:
    frame: str
    sent: Transform | None = None
    known: bool = True


class Selection:
    """The transforms of some frames in a target frame, and which changed by more than a threshold.

    The first transform of each frame counts as a change; with a threshold of 0, all do.

    RobotWebTools' tf2_web_republisher compares half of the angle, and takes a quaternion and its
    negative for different rotations; here the threshold is the angle itself. It also sends zeros
    once for unknown frames, which are left out here.

    Args:
        target: the target frame.
        sources: the other frames.
        angular: the angular threshold in radians.
        translational: the translational threshold in metres.
        log: for frames that become unknown, and known again.

    Raises:
        InvalidTransform: a frame's id is invalid, there are too many, or a threshold is NaN.
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
            raise InvalidTransform(f"too many frames: {len(sources)} (limit {MAX_FRAMES})")
        if isnan(angular) or isnan(translational):
            raise InvalidTransform("a threshold is not a number; 0 sends every transform")
        self._target = frame_id(target)
        self._sources = [_Source(frame) for frame in dict.fromkeys(map(frame_id, sources))]
        self._angular = angular
        self._translational = translational
        self._log = log

    @property
    def target(self) -> str:
        """The target frame."""
        return self._target

    def changes(self, buffer: Buffer, *, whole: bool = False) -> dict[str, Transform]:
        """Return the changed transforms by source frame; they count as sent afterwards.

        Args:
            whole: return all known transforms if one has changed.
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
        """Count all transforms as changed, for a new subscriber."""
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
            self._log.info("The transform from %s to %s is known now.", source.frame, self._target)
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
