"""The course of a playback: when each message is due, and pauses, steps, rates and jumps."""

from __future__ import annotations

import asyncio
import heapq
import math
from collections.abc import Awaitable, Callable, Collection, Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from itertools import islice
from operator import itemgetter
from typing import Protocol, TypeAlias, TypeVar

from fibws.bags import Reader
from fibws.msg.fibws_msgs import PlaybackState

BATCH_MESSAGES, BATCH_BYTES = 1000, 2 * 2**20
"""Messages and bytes that are read at once, ahead of time."""
TURN = 64
"""Messages that are published before other tasks have their turn."""
DELAY = 0.1
"""Seconds between two looks at the rate control topic."""
_T = TypeVar("_T")


class Target(Protocol):
    """Where the messages of one connection are published."""

    topic: str
    """The topic's name in the bag, without the slash before it."""

    def publish(self, data: bytes) -> None:
        """Publish a serialized message."""


TimedMessage: TypeAlias = tuple[int, Target, bytes]
"""When it was recorded, in nanoseconds since 1970; where to publish it; and its bytes."""


class Bags:
    """The messages of several bags in the order of time, read ahead by a thread.

    Args:
        bags: the readers, each with the targets of its connections that are played, by their ids.
        end: the time of the last message to play, in nanoseconds.
    """

    def __init__(self, bags: Sequence[tuple[Reader, Mapping[int, Target]]], end: int) -> None:
        self._bags = bags
        self._end = end
        self._thread = ThreadPoolExecutor(1, thread_name_prefix="bags")
        self._messages: Iterator[TimedMessage] = iter(())
        self._ahead: asyncio.Future[list[TimedMessage]] | None = None

    async def seek(self, time: int) -> list[tuple[Target, bytes]]:
        """Go to a time; return the last latched message of each connection before it."""
        self._ahead = None
        latched = await self._in_thread(lambda: self._open(time))
        self._ahead = self._in_thread(self._read)
        return latched

    async def batch(self) -> list[TimedMessage]:
        """Return the next messages; none at the end.

        Raises:
            BagError: a bag is damaged.
        """
        if self._ahead is None:
            return []
        batch = await self._ahead
        self._ahead = self._in_thread(self._read) if batch else None
        return batch

    def close(self) -> None:
        """End the thread."""
        self._thread.shutdown(cancel_futures=True)

    def _in_thread(self, function: Callable[[], _T]) -> asyncio.Future[_T]:
        return asyncio.get_running_loop().run_in_executor(self._thread, function)

    def _open(self, time: int) -> list[tuple[Target, bytes]]:
        latched: list[tuple[Target, bytes]] = []
        for reader, targets in self._bags:
            wanted = [each for each in reader.connections if each.id in targets and each.latching]
            last: dict[int, bytes] = {}
            if wanted and time > reader.start:
                for connection, _, data in reader.messages(end=time - 1, connections=wanted):
                    last[connection.id] = data
            latched += ((targets[id_], data) for id_, data in last.items())
        played = [self._played(reader, targets, time) for reader, targets in self._bags]
        self._messages = heapq.merge(*played, key=itemgetter(0)) if len(played) > 1 else played[0]
        return latched

    def _played(
        self, reader: Reader, targets: Mapping[int, Target], time: int
    ) -> Iterator[TimedMessage]:
        wanted = [each for each in reader.connections if each.id in targets]
        messages = reader.messages(start=time, end=self._end, connections=wanted)
        return ((received, targets[each.id], data) for each, received, data in messages)

    def _read(self) -> list[TimedMessage]:
        batch: list[TimedMessage] = []
        size = 0
        for message in islice(self._messages, BATCH_MESSAGES):
            batch.append(message)
            size += len(message[2])
            if size >= BATCH_BYTES:
                break
        return batch


@dataclass(frozen=True, slots=True, kw_only=True)
class PlaybackOptions:
    """How to play; times are in nanoseconds.

    Attributes:
        start: the time at which the playback begins, and begins again in a loop.
        end: the time at which it ends.
        rate: how much faster than recorded.
        is_immediate: publish without waiting.
        is_paused: begin with a pause.
        is_loop: begin again at the end.
        stays: wait at the end, for `Playback.seek` or the end of the program.
        skip_empty: skip spans without messages that are longer than this; None skips none.
        pause_topics: make a pause before each message of these (`Target.topic`).
        max_delay: wait while the control is further behind than this; see `Playback.controlled`.
    """

    start: int
    end: int
    rate: float = 1.0
    is_immediate: bool = False
    is_paused: bool = False
    is_loop: bool = False
    stays: bool = False
    skip_empty: int | None = None
    pause_topics: Collection[str] = ()
    max_delay: int = 10**9


class _Sought(Exception):
    """The playback is to go on at another time."""


class Playback:
    """Publishes the messages of bags when they are due.

    Args:
        room: waits while messages are published faster than they can be sent, and lets other tasks
            run.
        on_change: called when the playback was paused, resumed, or changed in another way.
        on_time: called with the time of each message in nanoseconds, before it, and
            with that of the playback at first and after a jump.
        on_skip: called with the nanoseconds of each span without messages that is skipped.
    """

    def __init__(
        self,
        bags: Bags,
        options: PlaybackOptions,
        room: Callable[[], Awaitable[None]],
        *,
        on_change: Callable[[], object] = lambda: None,
        on_time: Callable[[int], object] = lambda time: None,
        on_skip: Callable[[int], object] = lambda span: None,
    ) -> None:
        self.options = options
        self.rate = options.rate
        self.is_paused = options.is_paused
        self.is_delayed = False
        """Whether it waits for the control."""
        self.has_ended = False
        self.pauses_for_topics = bool(options.pause_topics)
        """Whether it makes a pause before each message of the pause topics."""
        self.controlled: int | None = None
        """The time up to which another node has followed, in nanoseconds: no message is published
        that is more than `PlaybackOptions.max_delay` later. None if there is no such node."""
        self._bags = bags
        self._room = room
        self._on_change = on_change
        self._on_time = on_time
        self._on_skip = on_skip
        self._clock = asyncio.get_running_loop().time
        self._position = options.start
        """The time of the playback at `_since`, a time of the event loop's clock."""
        self._since = self._clock()
        self._is_running = False
        self._next = options.start
        """The time of the message that is next."""
        self._steps = 0
        self._sought: int | None = None
        self._waiter: asyncio.Future[None] | None = None

    @property
    def status(self) -> int:
        """A constant of fibws_msgs/PlaybackState."""
        if self.has_ended:
            return PlaybackState.ENDED
        if self.is_paused:
            return PlaybackState.PAUSED
        return PlaybackState.DELAYED if self.is_delayed else PlaybackState.PLAYING

    @property
    def position(self) -> int:
        """The time of the playback, in nanoseconds: never later than the next message."""
        if not self._is_running or self.is_paused or self.is_delayed or self.has_ended:
            return self._position
        passed = (self._clock() - self._since) * 1e9 * self.rate  # Infinite at high rates.
        left = max(0, self._next - self._position)
        return self._position + (int(passed) if passed < left else left)

    # Control

    def pause(self, paused: bool) -> None:
        """Pause, or go on."""
        if paused != self.is_paused:
            self._set_position(self.position)
            self.is_paused = paused
            self._steps = 0
            self._changed()

    def step(self) -> None:
        """Publish one message, if this is paused."""
        if self.is_paused and not self.has_ended:
            self._steps += 1
            self._wake()

    def set_rate(self, rate: float) -> None:
        """Play faster or slower from now on; raise ValueError unless the rate is above 0."""
        if not 0 < rate < math.inf:
            raise ValueError(f"rate must be a finite number above 0, got {rate:g}")
        self._set_position(self.position)
        self.rate = rate
        self._changed()

    def seek(self, time: int) -> None:
        """Go on at another time; a time outside of the playback is its start or end."""
        self._sought = max(self.options.start, min(time, self.options.end))
        self.has_ended = False
        self._steps = 0
        self._next = self._sought
        self._set_position(self._sought)
        self._changed()

    def toggle_pause_topics(self) -> None:
        """Begin, or cease, to make pauses before messages of the pause topics."""
        self.pauses_for_topics = not self.pauses_for_topics

    # The course

    async def run(self) -> None:
        """Play until the end.

        Raises:
            BagError: a bag is damaged.
        """
        time = self.options.start
        while True:
            try:
                await self._play(time)
                if not self.options.is_loop:
                    self.has_ended = True
                    self._position = self.options.end
                    self._on_change()
                    if not self.options.stays:
                        return
                    while self._sought is None:
                        await self._sleep(None)
                time = self.options.start
            except _Sought:
                pass
            if self._sought is not None:
                time, self._sought = self._sought, None

    async def _play(self, time: int) -> None:
        latched = await self._bags.seek(time)
        on_time = self._on_time
        on_time(time)
        for target, data in latched:
            target.publish(data)
        self._next = time
        self._set_position(time)
        self._is_running = True
        left = TURN
        while batch := await self._bags.batch():
            for received, target, data in batch:
                self._next = received
                if not self._is_due(received, target):
                    await self._due(received, target)
                on_time(received)
                target.publish(data)
                left -= 1
                if not left:
                    left = TURN
                    await self._room()
                    self._check_sought()
            self._check_sought()
        self._check_sought()

    def _is_due(self, time: int, target: Target) -> bool:
        """Return whether a message is due, without anything to look at besides the clock."""
        options = self.options
        if self.is_paused or self.controlled is not None or options.is_immediate:
            return False
        if self._sought is not None:
            return False
        if self.pauses_for_topics and target.topic in options.pause_topics:
            return False
        return time - self._position <= (self._clock() - self._since) * 1e9 * self.rate

    async def _due(self, time: int, target: Target) -> None:
        """Wait until a message is due; raise `_Sought` if another one is to be next."""
        options = self.options
        empty = time - self.position
        if options.skip_empty is not None and empty > options.skip_empty:
            self._set_position(time)
            self._on_skip(empty)
        if self.pauses_for_topics and target.topic in options.pause_topics:
            self.pause(True)
        while True:
            self._check_sought()
            if self.is_paused:
                if self._steps:
                    self._steps -= 1
                    self._set_position(max(time, self._position))
                    return
                await self._sleep(None)
                continue
            if self._set_delayed(self._is_too_early(time)):
                await self._sleep(DELAY)
                continue
            if options.is_immediate:
                self._set_position(time)
                return
            wait = (time - self._position) / (1e9 * self.rate) - (self._clock() - self._since)
            if wait <= 0:
                return
            await self._sleep(wait)

    def _is_too_early(self, time: int) -> bool:
        return self.controlled is not None and time - self.controlled > self.options.max_delay

    def _set_delayed(self, delayed: bool) -> bool:
        if delayed != self.is_delayed:
            self._set_position(self.position)
            self.is_delayed = delayed
            self._on_change()
        return delayed

    def _check_sought(self) -> None:
        if self._sought is not None:
            raise _Sought

    def _set_position(self, time: int) -> None:
        self._position = time
        self._since = self._clock()

    def _changed(self) -> None:
        self._on_change()
        self._wake()

    def _wake(self) -> None:
        if self._waiter is not None and not self._waiter.done():
            self._waiter.set_result(None)

    async def _sleep(self, seconds: float | None) -> None:
        """Wait for seconds, or until something was changed."""
        loop = asyncio.get_running_loop()
        self._waiter = loop.create_future()
        timer = loop.call_later(seconds, self._wake) if seconds is not None else None
        try:
            await self._waiter
        finally:
            if timer is not None:
                timer.cancel()
