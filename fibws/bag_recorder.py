"""Recording: messages wait in a bounded buffer, and a thread writes them to bags.

`Recorder.put` never waits: if the disk is too slow, or hangs, the oldest messages are dropped and
counted. The thread compresses and writes. It hands everything to the system at least once a second,
so that a crash of the process loses no more than the last second.
"""

from __future__ import annotations

import errno
import logging
import os
import shutil
import sys
import threading
import time
from collections import deque
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Literal, NamedTuple, TypeAlias

from fibws.bags import Connection, Writer, open_reader, open_writer
from fibws.bags.connection import ANY_TYPE
from fibws.bags.files import check_writer
from fibws.command_names import command_name
from fibws.errors import BagError
from fibws.exit_signals import unfinished
from fibws.files import check_not_written

Buffer: TypeAlias = bytes | bytearray | memoryview
Compression: TypeAlias = Literal["none", "bz2", "lz4", "zstd"]

MIB = 2**20
MESSAGE_COST = 160
"""Bytes that a message in the buffer takes besides its own."""
WRITE_INTERVAL = 0.05
"""Seconds between two looks of the thread into the buffer."""
FLUSH_INTERVAL = 0.5
"""Seconds after which what was written is handed to the system."""
DISK_INTERVAL = 1.0
"""Seconds between two looks at the free space of the disk."""
WARNING_INTERVAL = 5.0
"""Seconds between two warnings of the same kind."""
TURN = 256 * 1024
"""Bytes that the thread writes before other threads of the process get their turn."""
TURN_COST = 4096
"""Bytes that a message counts for in a turn besides its own."""
PAUSE = 1e-5
"""Seconds between two turns: without a pause, another thread would get the interpreter only after
5 ms."""
MAX_CONNECTIONS = 20_000
"""Publishers in a file after which a split goes on with the next file: MCAP has at most 65,535, and
all of them are kept in memory until the file is complete."""
NEVER = 2**63
"""A time later than all others."""
PLAYBACK = "fibws_msgs/PlaybackState"
"""The type of the topics of players' states, which are not among all topics: who plays a recording
does not want the state of another player."""
SUFFIXES = (".bag", ".mcap")
ACTIVE = ".active"
"""The end of a file's name while it is written."""


class Origin(NamedTuple):
    """Where messages come from: a publisher of a topic, with the type of its messages."""

    topic: str
    type: str
    md5sum: str
    definition: str
    callerid: str
    latching: bool


@dataclass(frozen=True, slots=True, kw_only=True)
class RecordingOptions:
    """The settings of a recording.

    Attributes:
        path: the file, or with ``dated`` what its name begins with: a folder, if it ends with a
            slash. The suffix chooses the format: ``.mcap``, else ``.bag``.
        dated: whether the date and time of the beginning are added to the name.
        compression: of the chunks.
        chunk_size: bytes of a chunk before compression.
        buffer_size: bytes of messages that may wait for the disk, and of latched ones that may
            be kept for the next files; 0 for no limit.
        split: whether to begin another file when one is full or has lasted long enough; else the
            recording ends.
        max_size: bytes of a file; 0 for no limit.
        max_duration: nanoseconds that a file may last; 0 for no limit.
        max_splits: files that are kept, the newest ones; 0 for all.
        limit: messages to record of each topic; 0 for no limit.
        min_space: bytes of free disk space below which nothing is recorded.
        repeat_latched: whether each file of a split begins with the last latched messages.
    """

    path: str = ""
    dated: bool = True
    compression: Compression = "none"
    chunk_size: int = 768 * 1024
    buffer_size: int = 256 * MIB
    split: bool = False
    max_size: int = 0
    max_duration: int = 0
    max_splits: int = 0
    limit: int = 0
    min_space: int = 1024 * MIB
    repeat_latched: bool = False

    def check(self) -> None:
        """Raise BagError if the format lacks the compression, or a package for it is missing."""
        check_writer(self.file(0, 0).name, self.compression)

    def file(self, number: int, began: float) -> Path:
        """Return the path of a file of the recording, named as rosbag names them.

        Args:
            number: counts the files of a split from 0.
            began: when the file begins, in seconds since 1970, for the date in the name.
        """
        stem, suffix = self.path, ".bag"
        for each in SUFFIXES:
            if stem.endswith(each):
                stem, suffix = stem.removesuffix(each), each
        parts = [stem] if stem and not stem.endswith("/") else []
        if self.dated:
            parts.append(time.strftime("%Y-%m-%d-%H-%M-%S", time.localtime(began)))
        if self.split:
            parts.append(str(number))
        folder = stem if stem.endswith("/") else ""
        return Path(f"{folder}{'_'.join(parts)}{suffix}")


class RecordingState(NamedTuple):
    """How far a recording has come."""

    is_recording: bool
    began: int
    """When it began, in nanoseconds since 1970."""
    file: str
    """The path of the current or the last file, without `ACTIVE`."""
    files: int
    """The files so far."""
    messages: int
    """The messages that were written."""
    bytes: int
    """The sizes of all files so far, which only grow."""
    buffered: int
    """The bytes that wait for the disk."""
    dropped: int
    """The messages that were not written: the disk was too slow or full."""
    fault: str
    """Why it ended, or records nothing; usually empty."""


class Stream:
    """The messages of one origin in a recording; `Recorder.stream` returns it.

    Attributes:
        left: how many messages of the topic are still to be recorded; None without a limit.
        is_repeated: whether each file of a split begins with the last message.
        last: that message.
        connection: that of the file of this number.
    """

    __slots__ = ("connection", "file", "is_repeated", "last", "left", "origin")

    def __init__(self, origin: Origin, left: list[int] | None, *, is_repeated: bool) -> None:
        self.origin = origin
        self.left = left
        self.is_repeated = is_repeated
        self.file = -1
        self.connection: Connection
        self.last: Buffer | None = None


class Recorder:
    """A recording, from `start` to `stop`.

    `stream`, `put` and `forget` are for one thread; the others for any.

    Args:
        now: returns the time in nanoseconds since 1970, simulated if the messages' times are.
        log: logs what users should know.
        on_file: called, by the writing thread, with the path of each file that begins.
        on_end: called, by the writing thread, when the recording has ended: it is complete, was
            stopped, or has failed (`RecordingState.fault`).
        open_: opens a bag for writing, as `fibws.bags.open_writer`.
    """

    def __init__(
        self,
        options: RecordingOptions,
        now: Callable[[], int],
        log: logging.Logger,
        *,
        on_file: Callable[[Path], object] = lambda path: None,
        on_end: Callable[[], object] = lambda: None,
        open_: Callable[..., Writer] = open_writer,
    ) -> None:
        self.options = options
        self._now = now
        self._log = log
        self._on_file, self._on_end = on_file, on_end
        self._open = open_
        self._queue: deque[tuple[Stream, int, Buffer]] = deque()
        self._room = options.buffer_size or sys.maxsize
        self._put = 0
        """Bytes that were put into the buffer, and with `_taken` those that were taken out: each
        is counted by one thread, so that neither waits for the other."""
        self._taken = 0
        self._dropped = 0
        """Messages that the buffer had no room for."""
        self._dropped_bytes = 0
        self._discarded = 0
        """Messages that the disk had no room for."""
        self._early: dict[Stream, Buffer] = {}
        """The last latched message of each stream from before simulated time began."""
        self._early_bytes = 0
        self._has_early = False
        self._written = 0
        self._streams: dict[Origin, Stream] = {}
        self._left: dict[str, list[int]] = {}
        self._latched: dict[Stream, None] = {}
        self._latched_bytes = 0
        self._forgotten: deque[Stream] = deque()
        """Streams to be removed from `_latched`."""
        self._began = 0
        self._file_ends = NEVER
        """The time at which the current file has lasted long enough."""
        self._writer: Writer | None = None
        self._path = Path()
        self._number = -1
        self._kept: deque[Path] = deque()
        self._bytes = 0
        """The sizes of all files as the writing thread last saw them: to ask a file for it might
        wait for the disk."""
        self._past_bytes = 0
        """The sizes of the files that are complete."""
        self._has_space = True
        self._flushed = 0
        """Messages that were handed to the system."""
        self._past_messages = self._repeated = 0
        """The messages that were written before the current file, and those that it repeats."""
        self._is_full = False
        self._fault = ""
        self._next_flush = self._next_disk = 0.0
        self._warned: dict[str, float] = {}
        self._reported = 0
        self._stopping, self._ended = threading.Event(), threading.Event()
        self._thread = threading.Thread(target=self._run, name="recorder", daemon=True)

    # For the thread of messages

    def stream(self, origin: Origin) -> Stream:
        """Return the stream of a publisher of a topic."""
        found = self._streams.get(origin)
        if found is None:
            left = None
            if self.options.limit:
                left = self._left.setdefault(origin.topic, [self.options.limit])
            is_repeated = self.options.repeat_latched and origin.latching
            found = self._streams[origin] = Stream(origin, left, is_repeated=is_repeated)
        return found

    def put(self, stream: Stream, received: int, data: Buffer) -> None:
        """Record a message.

        Args:
            received: its time in nanoseconds since 1970. At 0 simulated time has not begun: such a
                message is left out, as by rosbag, unless it is latched. The last latched one
                becomes the first message after that.
            data: ROS 1's serialization, which must not change any more.
        """
        if received <= 0 and not stream.origin.latching:
            self._has_early = True
            return
        left = stream.left
        if left is not None:
            if not left[0]:
                return
            left[0] -= 1
        self._queue.append((stream, received, data))
        self._put += len(data) + MESSAGE_COST
        if self._put - self._taken - self._dropped_bytes > self._room:
            self._drop_oldest()

    def forget(self, stream: Stream) -> None:
        """Keep nothing of a publisher that has left; its messages so far are still written."""
        if self._streams.get(stream.origin) is stream:
            del self._streams[stream.origin]
        if stream.is_repeated:
            stream.is_repeated = False
            self._forgotten.append(stream)

    def is_complete(self, topic: str) -> bool:
        """Return whether as many messages of a topic were put as there are to be recorded."""
        left = self._left.get(topic)
        return left is not None and not left[0]

    @property
    def held_bytes(self) -> int:
        """Bytes of messages that wait, and of latched ones that the next files begin with."""
        return max(0, self._put - self._taken - self._dropped_bytes) + self._latched_bytes

    def _drop_oldest(self) -> None:
        while self._put - self._taken - self._dropped_bytes > self._room:
            try:
                _, _, data = self._queue.popleft()
            except IndexError:  # The writing thread has taken them all meanwhile.
                return
            self._dropped += 1
            self._dropped_bytes += len(data) + MESSAGE_COST

    # For any thread

    def start(self) -> None:
        """Begin; if there cannot be a file, the recording ends at once."""
        self._began = time.time_ns()
        self._thread.start()

    def finish(self) -> None:
        """Have everything written that waits, and the file completed; `on_end` is called then."""
        self._stopping.set()

    def stop(self) -> None:
        """Finish, and wait for that. Does nothing when called again."""
        self.finish()
        if self._thread.ident is not None:
            self._thread.join()

    @property
    def is_finishing(self) -> bool:
        """Whether `finish` was called."""
        return self._stopping.is_set()

    def state(self) -> RecordingState:
        """Return how far the recording has come."""
        return RecordingState(
            is_recording=self._thread.is_alive() and not self._ended.is_set(),
            began=self._began,
            file=str(self._path),
            files=self._number + 1,
            messages=self._written,
            bytes=self._bytes,
            buffered=max(0, self._put - self._taken - self._dropped_bytes),
            dropped=self._dropped + self._discarded,
            fault=self._fault,
        )

    # In the writing thread

    def _run(self) -> None:
        with unfinished(self._left_text):
            self._record()

    def _left_text(self) -> str:
        """Return what is left if the process ends now."""
        if self._writer is None:
            return ""
        active = self._path.with_name(self._path.name + ACTIVE)
        return f"{active} was not completed. To restore it: {command_name('bag reindex')} {active}"

    def _record(self) -> None:
        try:
            self._begin()
            while not self._stopping.wait(WRITE_INTERVAL) and not self._is_full:
                self._write_waiting()
                self._look_at_the_clock()
            if not self._is_full:
                self._write_waiting()
                self._write_early(self._now())
            self._end_file()
        except OSError as error:
            # The reason first: the page's header has room for a few words.
            self._fail(f"{error.strerror or error}: cannot write {self._path}{ACTIVE}")
        except BagError as error:
            self._fail(str(error))
        except Exception as error:
            self._log.exception("The recording failed.")
            self._fail(f"{type(error).__name__}: {error}")
        self._discard()
        self._report_drops(final=True)
        self._ended.set()
        self._on_end()

    def _begin(self) -> None:
        self._path = self.options.file(0, time.time())
        self._check_disk()
        if not self._has_space:
            raise BagError(self._fault)
        if self._free_space() < self.options.chunk_size:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        self._begin_file()

    def _write_waiting(self) -> None:
        """Write the messages that wait."""
        queue = self._queue
        if self._writer is None or not self._has_space:
            self._discard()
            return
        left, duration = TURN, self.options.max_duration
        received: int | None = None
        for _ in range(len(queue)):
            try:
                stream, received, data = queue.popleft()
            except IndexError:  # The other thread has dropped the rest.
                break
            size = len(data)
            self._taken += size + MESSAGE_COST
            late = received - self._file_ends
            if (late > 0 or late < -duration < 0) and not self._enter_span(received):
                return
            if not self._write(stream, received, data):
                continue
            left -= size + TURN_COST
            if left < 0:
                left = TURN
                if self._is_large and not self._continue(received):
                    return
                time.sleep(PAUSE)
        if self._is_large:
            self._continue(received)

    def _enter_span(self, received: int) -> bool:
        """Go on to the time of a message that is outside the file's; return False at the end."""
        late, duration = received - self._file_ends, self.options.max_duration
        if late > 0:
            if not self._continue(received):
                return False
            self._file_ends = received + -late % duration
        elif received > 0:
            self._file_ends = received + duration  # The clock was set back.
        return True

    def _write(self, stream: Stream, received: int, data: Buffer) -> bool:
        """Write a message; return False if bags cannot hold it, such as one of 2 GiB."""
        assert self._writer is not None
        if received <= 0:
            self._keep_early(stream, data)
            return False
        if self._early:
            self._write_early(received)
        try:
            if stream.file != self._number:
                self._join(stream)
            self._writer.write(stream.connection, received, data)
        except BagError as error:
            self._discarded += 1
            text = f"A message of {stream.origin.topic} is not recorded: {error}."
            self._warn("message", text)
            return False
        self._written += 1
        if stream.is_repeated:
            self._keep_latched(stream, data)
        return True

    def _keep_early(self, stream: Stream, data: Buffer) -> None:
        """Keep a latched message until there is a time; drop the oldest if there is no room."""
        self._has_early = True
        self._early_bytes += len(data) - len(self._early.pop(stream, b""))
        self._early[stream] = data
        while self._early_bytes > self._room and len(self._early) > 1:
            self._early_bytes -= len(self._early.pop(next(iter(self._early))))
            self._discarded += 1

    def _write_early(self, now: int) -> None:
        """Write the latched messages from before simulated time began, at its first moment."""
        if now <= 0 or self._writer is None or not self._has_space:
            return
        early, self._early, self._early_bytes = self._early, {}, 0
        for stream, data in early.items():
            self._write(stream, now, data)

    def _keep_latched(self, stream: Stream, data: Buffer) -> None:
        """Keep a message for the next files; drop the oldest ones if there is no room."""
        self._drop_latched(stream)
        stream.last = data
        self._latched[stream] = None
        self._latched_bytes += len(data)
        while self._latched_bytes > self._room:
            self._drop_latched(next(iter(self._latched)))

    def _drop_latched(self, stream: Stream) -> None:
        if stream.last is not None:
            self._latched_bytes -= len(stream.last)
            stream.last = None
            del self._latched[stream]

    @property
    def _is_large(self) -> bool:
        """Whether the file has reached its maximum size."""
        writer, most = self._writer, self.options.max_size
        if writer is None:
            return False
        has_many = self.options.split and len(writer.connections) >= MAX_CONNECTIONS
        return has_many or 0 < most < writer.size

    def _continue(self, received: int | None) -> bool:
        """Go on with the next file of a split; return False if there is to be none.

        Args:
            received: the time of the last message, which those that the file repeats get: no other
                message of the file should be older. None for now.
        """
        if not self.options.split:
            self._is_full = True
            return False
        self._end_file()
        self._begin_file(received)
        return True

    def _join(self, stream: Stream) -> None:
        """Make the stream's connection in the current file."""
        assert self._writer is not None
        topic, type_, md5sum, definition, callerid, latching = stream.origin
        if type_ == ANY_TYPE:
            raise BagError(f"the type of {topic} is unknown")
        stream.connection = self._writer.connection(
            topic, type_, md5sum, definition, callerid=callerid, latching=latching
        )
        stream.file = self._number

    def _look_at_the_clock(self) -> None:
        """Do what is due: flush, look at the disk, end by the clock, warn, forget."""
        options, now = self.options, self._now()
        if options.max_duration and self._file_ends == NEVER and now:
            self._file_ends = now + options.max_duration  # Simulated time has begun.
        self._write_early(now)
        if now > self._file_ends and not options.split:
            self._is_full = True
        ticks = time.monotonic()
        if self._flushed < self._written and ticks >= self._next_flush and self._writer is not None:
            self._writer.flush()
            self._flushed = self._written
            self._next_flush = ticks + FLUSH_INTERVAL
        if self._writer is not None:
            self._bytes = self._past_bytes + self._writer.position
        if ticks >= self._next_disk:
            self._next_disk = ticks + DISK_INTERVAL
            self._check_disk()
        self._report_drops()
        if self._has_early and now <= 0:
            self._has_early = False
            self._warn("early", "Nothing is recorded before the first message of /clock.")
        while self._forgotten:
            self._drop_latched(self._forgotten.popleft())

    def _begin_file(self, begin: int | None = None) -> Writer:
        """Begin the next file; with the last latched messages, if they are to be repeated.

        Args:
            begin: the time of these messages; now if None.
        """
        options = self.options
        self._path = self._unused_path()
        active = self._path.with_name(self._path.name + ACTIVE)
        active.parent.mkdir(parents=True, exist_ok=True)
        self._put_aside(active)
        try:
            self._writer = writer = self._open(
                active, compression=options.compression, chunk_size=options.chunk_size
            )
        except BlockingIOError:  # It is the file of another recorder.
            raise
        except OSError:
            active.unlink(missing_ok=True)
            raise
        self._number += 1
        self._past_messages, self._repeated = self._written, len(self._latched)
        self._bytes = self._past_bytes + writer.position  # Before a message of the file counts.
        now = self._now() if begin is None else begin
        if options.max_duration and self._file_ends == NEVER and now:
            self._file_ends = now + options.max_duration
        self._log.info("Recording to '%s'.", self._path)
        self._on_file(self._path)
        for stream in self._latched:
            self._join(stream)
            assert stream.last is not None
            writer.write(stream.connection, now, stream.last)
        writer.flush()  # The next message may come late.
        return writer

    def _unused_path(self) -> Path:
        """Return the path of the next file; a file that has the same date is not replaced."""
        began = time.time()
        while True:
            path = self.options.file(self._number + 1, began)
            is_used = path.exists() or path.with_name(path.name + ACTIVE).exists()
            if not self.options.dated or not is_used:
                return path
            began += 1

    def _put_aside(self, active: Path) -> None:
        """Rename the file that an earlier recorder has left: it must not be overwritten."""
        if not active.exists():
            return
        check_not_written(active)
        stem = active.name.removesuffix(ACTIVE)
        left = active.with_name(f"{stem}.{time.time_ns()}{ACTIVE}")
        active.rename(left)
        advice = ""
        try:
            open_reader(left).close()  # Maybe it has been repaired.
        except (BagError, OSError):
            advice = f"; to repair it: {command_name('bag reindex')} {left}"
        self._log.warning(
            "An earlier recorder left '%s', which is '%s' now%s", active.name, left.name, advice
        )

    def _end_file(self) -> None:
        """Complete the current file, and remove the oldest ones if there are too many."""
        if self._writer is None:
            return
        self._writer.flush()
        self._flushed = self._written
        self._writer.close()
        self._writer = None  # Not before: an index that does not fit leaves a file to restore.
        self._path.with_name(self._path.name + ACTIVE).replace(self._path)
        self._count_bytes(self._path)
        self._kept.append(self._path)
        if self.options.split and self.options.max_splits:
            # The file that begins next is one of them.
            most = max(0, self.options.max_splits - (0 if self._is_ending else 1))
            while len(self._kept) > most:
                self._kept.popleft().unlink(missing_ok=True)

    def _count_bytes(self, path: Path) -> None:
        """Count a file that is complete."""
        self._past_bytes += path.stat().st_size
        self._bytes = self._past_bytes

    @property
    def _is_ending(self) -> bool:
        return self._stopping.is_set() or self._is_full

    def _check_disk(self) -> None:
        """Look whether the disk has space for more."""
        least, path = self.options.min_space, self._path
        if not least:
            return
        free = self._free_space()
        had, self._has_space = self._has_space, free >= least
        if not self._has_space:
            self._fault = (
                f"Less than {size_text(least)} of space free on disk with '{path}' (--min-space)"
            )
            if had and self._writer is not None:
                self._log.error("%s: recording is disabled.", self._fault)
        elif not had:
            self._fault = ""
            self._log.info("Recording to '%s' again: the disk has space.", path)
        elif free < 5 * least:
            text = f"Less than 5 x {size_text(least)} of space free on disk with '{path}'."
            self._warn("space", text)

    def _free_space(self) -> int:
        """Return the bytes of free space where the file is."""
        folder = self._path.absolute().parent
        while not folder.exists():
            folder = folder.parent
        return shutil.disk_usage(folder).free

    def _discard(self) -> None:
        """Drop the messages that wait: there is nowhere to write them."""
        while self._queue:
            try:
                _, _, data = self._queue.popleft()
            except IndexError:
                return
            self._taken += len(data) + MESSAGE_COST
            if not self._is_full:
                self._discarded += 1

    def _fail(self, reason: str) -> None:
        """End after an error; a file that is not complete keeps its name for ``reindex``."""
        writer, self._writer = self._writer, None
        self._fault = reason
        self._log.error("The recording has ended: %s.", reason)
        if writer is None:
            return
        with suppress(OSError, BagError):  # The index may fit where the messages did not.
            writer.close()
        active = self._path.with_name(self._path.name + ACTIVE)
        left, is_complete = self._flushed, False
        with suppress(OSError, BagError):
            self._count_bytes(active)
            with open_reader(active) as bag:
                left = self._past_messages + bag.message_count - self._repeated
            active.replace(self._path)
            is_complete = True
        self._discarded += self._written - left
        self._written = left
        if is_complete:
            self._log.warning("'%s' is complete up to then.", self._path)
        else:
            self._log.error(
                "To restore what is left of it, on a disk with space: %s --output-dir DIR %s",
                *(command_name("bag reindex"), active),
            )

    def _report_drops(self, *, final: bool = False) -> None:
        dropped = self._dropped + self._discarded
        if dropped > self._reported and (final or self._is_time_to_warn("drops")):
            self._reported = dropped
            self._log.warning(
                "The recording has dropped %d messages so far: %s.",
                dropped,
                "the buffer was exceeded" if self._dropped else "they could not be written",
            )

    def _warn(self, kind: str, text: str) -> None:
        if self._is_time_to_warn(kind):
            self._log.warning("%s", text)

    def _is_time_to_warn(self, kind: str) -> bool:
        now = time.monotonic()
        if now < self._warned.get(kind, 0.0):
            return False
        self._warned[kind] = now + WARNING_INTERVAL
        return True


def size_text(size: float) -> str:
    """Return a number of bytes as people write it: ``1G``, ``1.5M``."""
    for factor, unit in ((2**30, "G"), (MIB, "M"), (1024, "k")):
        if size >= factor:
            return f"{size / factor:.4g}{unit}"
    return f"{size:.0f}"
