"""Errors of transforms, with the texts of tf2.

TransformError
├── InvalidTransform       a malformed transform, or invalid arguments
│   ├── RepeatedData       the frame has a transform of this time
│   └── OldData            the transform is older than the frame's history
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


class RepeatedData(InvalidTransform):
    """The frame has a transform of this time; tf2's TF_REPEATED_DATA."""


class OldData(InvalidTransform):
    """The transform is older than the frame's history; tf2's TF_OLD_DATA."""


class UnknownFrame(TransformError, LookupError):
    """No transform in the buffer names this frame; tf2's LookupException.

    Args:
        frame: the frame.
        argument: which argument of the lookup it was.
    """

    def __init__(self, frame: str, argument: str = "target_frame") -> None:
        self.frame = frame
        self.argument = argument
        super().__init__(
            f'"{frame}" passed to lookupTransform argument {argument} does not exist. '
        )


class UnconnectedFrames(TransformError):
    """No transforms connect the two frames; tf2's ConnectivityException."""

    def __init__(self, target: str, source: str) -> None:
        self.target = target
        self.source = source
        super().__init__(
            f"Could not find a connection between '{target}' and '{source}' "
            "because they are not part of the same tree."
            "Tf has two or more unconnected trees."
        )


class FrameLoop(TransformError):
    """A frame is its own ancestor; also a LookupException in tf2.

    Args:
        frame: the frame whose ancestors contain the loop.
        listing: all frames with their parents, one on each line.
    """

    def __init__(self, frame: str, listing: str) -> None:
        self.frame = frame
        super().__init__(f"The tf tree is invalid because it contains a loop.\n{listing}\n")


class TransformOutOfTime(TransformError):
    """The frames are connected, but not at the requested time; tf2's ExtrapolationException."""
