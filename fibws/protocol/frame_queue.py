"""A queue of frames in which every source keeps only its newest ones."""

from __future__ import annotations

from collections import OrderedDict, deque
from collections.abc import Iterator, Sized
from typing import Any, Final, Generic

from typing_extensions import TypeVar

EMPTY: Final[deque[Any]] = deque(maxlen=0)
"""In place of deques in which nothing has waited yet: each takes 600 bytes, and there may be
thousands of clients that are never slow."""


class Lane:
    """One source's share of a `FrameQueue`, such as a topic's messages.

    Args:
        limit: most frames that may wait; one more drops the oldest (ROS's queue_size).
    """

    __slots__ = ("dropped", "limit", "waiting")

    def __init__(self, limit: int) -> None:
        self.limit = limit
        self.dropped = 0
        self.waiting: deque[int] = EMPTY
        """The numbers of its frames in the queue, the oldest first."""


L = TypeVar("L", bound=Lane, default=Lane)
F = TypeVar("F", bound=Sized, default=bytes)
"""The kind of frames."""


class FrameQueue(Generic[L, F]):
    """Frames that wait to be written, in the order in which they came.

    Args:
        cost: bytes that each frame counts for besides its own, to bound floods of small ones.
    """

    __slots__ = ("_cost", "_frames", "_number", "size")

    def __init__(self, *, cost: int = 0) -> None:
        self._cost = cost
        self._frames: OrderedDict[int, tuple[F, L | None]] = OrderedDict()
        self._number = 0
        self.size = 0
        """Bytes that wait."""

    def __len__(self) -> int:
        return len(self._frames)

    def __iter__(self) -> Iterator[tuple[F, L | None]]:
        return iter(self._frames.values())

    def put(self, frame: F, lane: L | None = None) -> None:
        """Append a frame; one without a lane is never dropped. `trim` enforces the limits."""
        self._number += 1
        self._frames[self._number] = (frame, lane)
        self.size += len(frame) + self._cost
        if lane is not None:
            if lane.waiting is EMPTY:
                lane.waiting = deque()
            lane.waiting.append(self._number)

    def pop(self) -> tuple[F, L | None]:
        """Remove and return the oldest frame and its lane; raise KeyError if there is none."""
        _, (frame, lane) = self._frames.popitem(last=False)
        self.size -= len(frame) + self._cost
        if lane is not None:
            lane.waiting.popleft()
        return frame, lane

    def trim(self, lane: L, keep: int) -> int:
        """Drop a lane's oldest frames down to ``keep``; return how many, which it counts, too."""
        dropped = 0
        while len(lane.waiting) > keep:
            self._remove(lane.waiting.popleft())
            dropped += 1
        lane.dropped += dropped
        return dropped

    def forget(self, lane: L) -> None:
        """Remove the frames of a lane that has ended, which does not count as dropping them."""
        while lane.waiting:
            self._remove(lane.waiting.popleft())

    def clear(self) -> None:
        """Remove all frames."""
        for _, lane in self._frames.values():
            if lane is not None:
                lane.waiting.clear()
        self._frames.clear()
        self.size = 0

    def _remove(self, number: int) -> None:
        frame, _ = self._frames.pop(number)
        self.size -= len(frame) + self._cost
