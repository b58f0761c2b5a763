"""Errors of transforms, as those of tf2.

TransformError
├── InvalidTransform       a malformed transform, or invalid arguments
├── UnknownFrame           no transform has named this frame
├── UnconnectedFrames      no transforms connect the two frames
├── FrameLoop              a frame is its own ancestor
└── TransformOutOfTime     the frames are connected, but not at the requested time
"""

from __future__ import annotations

from fibws.errors import FibwsError


class TransformError(FibwsError):
    """Something is wrong with a transform."""


class InvalidTransform(TransformError, ValueError):
    """A malformed transform, or invalid arguments; tf2's InvalidArgumentException."""


class UnknownFrame(TransformError, LookupError):
    """No transform in the buffer names this frame; tf2's LookupException."""

    def __init__(self, frame: str) -> None:
        self.frame = frame
        super().__init__(f"Frame {frame!r} does not exist: no transform names it")


class UnconnectedFrames(TransformError):
    """No transforms connect the two frames; tf2's ConnectivityException."""

    def __init__(self, target: str, source: str) -> None:
        self.target = target
        self.source = source
        super().__init__(
            f"Could not find a connection between {target!r} and {source!r} "
            f"because they are not part of the same tree"
        )


class FrameLoop(TransformError):
    """A frame is its own ancestor; also a LookupException in tf2."""

    def __init__(self, frame: str) -> None:
        self.frame = frame
        super().__init__(f"The ancestors of frame {frame!r} contain a loop")


class TransformOutOfTime(TransformError):
    """The frames are connected, but not at the requested time; tf2's ExtrapolationException."""
