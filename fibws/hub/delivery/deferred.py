"""Deferred frames: those that take long to make are made for clients that read, in a thread.

A client that reads is sent its frames in order, lane by lane: a frame that is being made holds back
the later ones of its lane, and nothing else. For a client that does not read frames wait as they
are, and newer ones replace them.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from typing import Protocol

from fibws.protocol.frame_queue import Lane

SMALL = 100_000
"""Bytes below which a text is encoded at once, which takes a few milliseconds at most."""


class Workers(Protocol):
    """Threads for work that takes long."""

    def run(self, work: Callable[[], object], done: Callable[[], object], /) -> None:
        """Call ``work`` in a thread and then ``done`` in the event loop; neither may raise."""


class InlineWorkers:
    """Does the work at once, where there are no threads."""

    def __init__(self) -> None:
        self._jobs: deque[tuple[Callable[[], object], Callable[[], object]]] = deque()
        self._is_busy = False

    def run(self, work: Callable[[], object], done: Callable[[], object], /) -> None:
        """Call ``work`` and then ``done``; if within another job, behind that."""
        self._jobs.append((work, done))
        if not self._is_busy:
            self._is_busy = True
            while self._jobs:
                for each in self._jobs.popleft():
                    each()
            self._is_busy = False


class DeferredFrame:
    """A frame that is made from a text when a client reads it; all who ask share it.

    Args:
        encode: makes the frame; it is called in any thread.
        failed: is called with what ``encode`` raised.
    """

    __slots__ = (
        "_encode",
        "_failed",
        "_fault",
        "_is_queued",
        "_readers",
        "_size",
        "_text",
        "data",
        "is_running",
    )

    def __init__(
        self,
        text: bytes,
        encode: Callable[[bytes], bytes],
        failed: Callable[[Exception], object],
    ) -> None:
        self.data: bytes | None = None
        """The frame, once it is made."""
        self.is_running = False
        """Whether a thread makes it now."""
        self._text: bytes | None = text
        """None once the frame is made, or has failed."""
        self._size = len(text)
        self._encode = encode
        self._failed = failed
        self._fault: Exception | None = None
        self._is_queued = False
        self._readers: dict[tuple[DeferredFrames, Lane], None] = {}

    def __len__(self) -> int:
        """Return the bytes of its text, for which it counts wherever it waits."""
        return self._size

    @property
    def is_done(self) -> bool:
        """Whether it is made, or has failed."""
        return self._text is None

    def make(self) -> bool:
        """Make it at once, unless a thread is to do it; return whether it is done."""
        if self._text is not None and not self._is_queued:
            self._work()
            self._finish()
        return self.is_done

    def start(self, reader: DeferredFrames, lane: Lane, workers: Workers) -> None:
        """Make it in a thread; call the reader when it is done, unless the reader withdraws."""
        self._readers[reader, lane] = None
        if not self._is_queued:
            self._is_queued = True
            workers.run(self._work_if_wanted, lambda: self._after(workers))

    def withdraw(self, reader: DeferredFrames, lane: Lane) -> None:
        """Forget a reader; nothing is made if there is none when its turn comes."""
        self._readers.pop((reader, lane), None)

    def _work_if_wanted(self) -> None:
        if self._readers:
            self.is_running = True
            self._work()

    def _work(self) -> None:
        assert self._text is not None
        try:
            self.data = self._encode(self._text)
        except Exception as fault:
            self._fault = fault

    def _after(self, workers: Workers) -> None:
        self._is_queued = False
        if self.is_running:
            self._finish()
        for reader, lane in list(self._readers):  # They came after its turn.
            self.start(reader, lane, workers)

    def _finish(self) -> None:
        self.is_running = False
        self._text = None
        readers, self._readers = self._readers, {}
        if self._fault is not None:
            self._failed(self._fault)
            self._fault = None
        for reader, lane in readers:
            reader.advance(lane)


class Client(Protocol):
    """The send queue of the client that gets the frames."""

    paused: bool
    dropped: int

    @property
    def exceeded(self) -> bool:
        """Whether more is kept for it than allowed."""

    def put(self, frame: bytes, lane: Lane) -> None:
        """Send a frame that is made, or keep it while paused."""


class DeferredFrames:
    """The frames of one client that wait to be made.

    Args:
        workers: make the large ones.
    """

    __slots__ = ("_client", "_lanes", "_workers", "size")

    def __init__(self, client: Client, workers: Workers) -> None:
        self.size = 0
        """Bytes of all frames that wait."""
        self._client = client
        self._workers = workers
        self._lanes: dict[Lane, deque[DeferredFrame]] = {}
        """By lane, the oldest first; no lane is empty. A client that reads waits for the first."""

    def count(self, lane: Lane) -> int:
        """Return how many frames of a lane wait."""
        return len(self._lanes.get(lane, ()))

    def put(self, frame: DeferredFrame, lane: Lane) -> None:
        """Send a frame once it is made, behind the others of its lane; drop some beyond limits."""
        client = self._client
        waiting = self._lanes.get(lane)
        if waiting is None:
            if not client.paused and len(frame) < SMALL:
                frame.make()
            if frame.is_done:
                self._pass(frame, lane)
                return
            waiting = self._lanes[lane] = deque()
        waiting.append(frame)
        self.size += len(frame)
        # The frame that the client waits for stays, or none would ever be made in time.
        first = 0 if client.paused else 1
        while len(waiting) - first > max(1, lane.limit):
            self._drop(waiting, lane, first)
        while client.exceeded and len(waiting) - first > 1:
            self._drop(waiting, lane, first)
        if client.exceeded:
            self.make_room(lane)
        if len(waiting) == 1 and not client.paused:
            frame.start(self, lane, self._workers)

    def make_room(self, newest: Lane | None = None) -> None:
        """Drop the oldest frames, except those of one lane, until the client's limit is met."""
        client = self._client
        for lane, waiting in list(self._lanes.items()):
            if lane is newest:
                continue
            while waiting and client.exceeded and not (waiting[0].is_running and not client.paused):
                self._drop(waiting, lane, 0)
            self._go_on(waiting, lane)

    def advance(self, lane: Lane) -> None:
        """Send the frames of a lane that are made, and start to make the next one."""
        waiting = self._lanes.get(lane)
        if waiting is not None and not self._client.paused:
            self._send_made(waiting, lane)
            self._go_on(waiting, lane)

    def keep_made(self) -> None:
        """Put the frames that are made into the queue of a client that is about to read again."""
        for lane, waiting in list(self._lanes.items()):
            self._send_made(waiting, lane)
            self._go_on(waiting, lane)

    def resume(self) -> None:
        """Make the next frame of each lane: the client reads again."""
        for lane, waiting in list(self._lanes.items()):
            self._go_on(waiting, lane)

    def forget(self, lane: Lane) -> None:
        """Remove the frames of a lane."""
        waiting = self._lanes.pop(lane, None)
        if waiting:
            waiting[0].withdraw(self, lane)
            self.size -= sum(map(len, waiting))

    def clear(self) -> None:
        """Remove all frames."""
        for lane in list(self._lanes):
            self.forget(lane)

    def _send_made(self, waiting: deque[DeferredFrame], lane: Lane) -> None:
        while waiting and waiting[0].is_done:
            frame = waiting.popleft()
            self.size -= len(frame)
            self._pass(frame, lane)

    def _pass(self, frame: DeferredFrame, lane: Lane) -> None:
        if frame.data is not None:  # Else it has failed.
            self._client.put(frame.data, lane)

    def _go_on(self, waiting: deque[DeferredFrame], lane: Lane) -> None:
        """Make the first frame of a lane, if the client reads; forget a lane without any."""
        if not waiting:
            self._lanes.pop(lane, None)
        elif not self._client.paused:
            waiting[0].start(self, lane, self._workers)

    def _drop(self, waiting: deque[DeferredFrame], lane: Lane, number: int) -> None:
        frame = waiting[number]
        del waiting[number]
        self.size -= len(frame)
        lane.dropped += 1
        self._client.dropped += 1
        if number == 0:
            frame.withdraw(self, lane)
