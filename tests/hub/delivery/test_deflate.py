"""Compression of frames, with threads and a clock that the test moves."""

from __future__ import annotations

import random
import zlib
from collections.abc import Callable
from typing import Any

import pytest

from fibws.hub.delivery.deflate import (
    BURST,
    LEAST,
    LONG,
    MOST_AHEAD,
    SHARE,
    SLICE,
    DeflatedFrames,
    Deflater,
    DeflatingSendQueue,
)
from fibws.hub.delivery.send_queue import Flusher
from fibws.protocol.deflate import MOST_BITS, compressor, text_of
from fibws.protocol.frame_queue import Lane
from fibws.protocol.websocket import BINARY, DEFLATED, TEXT, server_frame

from ..fakes import FakeWorkers, frames

COMPRESSOR = "fibws.hub.delivery.deflate.compressor"


def text(size: int, first: str = "a") -> bytes:
    """The frame of a text that begins with a letter, and compresses well."""
    return server_frame(TEXT, (first + "b" * (size - 1)).encode())


def inflated(frame: bytes) -> bytes:
    """A frame as it was before its compression."""
    [(first, payload)] = frames(frame)
    if first != TEXT | DEFLATED:
        return frame
    return server_frame(TEXT, zlib.decompressobj(-MOST_BITS).decompress(payload))


class Frames:
    """Frames in order, and what came out of them."""

    def __init__(self, most_held: int = 2**30) -> None:
        self.now = 0.0
        self.workers = FakeWorkers()
        self.deflater = Deflater(self.workers, lambda: self.now, most_held)
        self.sent: list[str] = []
        self.frames = self.more()

    def more(self) -> DeflatedFrames[str]:
        """Frames of other recipients, at the same hub."""
        return DeflatedFrames(self.deflater, MOST_BITS, self._send)

    def _send(self, frame: bytes, recipient: str) -> None:
        """Take note of a frame: its recipient, its first letter, and * if it is compressed."""
        letter = chr(inflated(frame)[len(inflated(frame)) - len(text_of(inflated(frame)) or b"")])
        mark = "*" if frame[0] & DEFLATED else ""
        self.sent.append(f"{recipient}{letter}{mark}")


@pytest.mark.parametrize("size", [LEAST, 5000, LONG - 10, LONG + 1, SLICE, 3 * SLICE + 1])
@pytest.mark.parametrize("is_random", [False, True])
def test_frame_inflates_to_the_text(size: int, is_random: bool) -> None:
    chance = random.Random(size)
    payload = chance.randbytes(size // 2).hex().encode() if is_random else b"x" * size
    sent: list[bytes] = []
    workers = FakeWorkers()
    deflater = Deflater(workers, lambda: 0.0)
    made: DeflatedFrames[None]
    made = DeflatedFrames(deflater, MOST_BITS, lambda frame, _: sent.append(frame))
    made.put(server_frame(TEXT, payload), None)
    workers.finish_all()
    [frame] = sent
    assert frame[0] == TEXT | DEFLATED
    assert len(frame) < 0.7 * len(payload)
    assert inflated(frame) == server_frame(TEXT, payload)
    assert deflater.held == 0


@pytest.mark.parametrize(
    "frame",
    [
        text(LEAST - 5),
        server_frame(TEXT, random.Random(1).randbytes(5000)),
        server_frame(TEXT, random.Random(1).randbytes(3 * LONG)),
        server_frame(BINARY, bytes(3 * LONG)),
        text(LONG) + text(LONG),
    ],
    ids=["short", "does not pay", "does not pay, long", "binary", "several"],
)
def test_frame_is_sent_as_it_is(frame: bytes) -> None:
    sent: list[bytes] = []
    workers = FakeWorkers()
    deflater = Deflater(workers, lambda: 0.0)
    made: DeflatedFrames[None]
    made = DeflatedFrames(deflater, MOST_BITS, lambda each, _: sent.append(each))
    made.put(frame, None)
    workers.finish_all()
    assert sent == [frame]


def test_window_is_not_larger_than_that_of_the_client() -> None:
    """What repeats beyond the window is not found: the client has not kept it."""
    chance = random.Random(1)
    noise = chance.randbytes(1000).hex().encode()
    frame = server_frame(TEXT, noise + noise)
    deflater = Deflater(FakeWorkers(), lambda: 0.0)
    [small, large] = [deflater.deflated(frame, bits) for bits in (9, MOST_BITS)]
    assert len(large) < 0.6 * len(small)
    [(_, payload)] = frames(small)
    assert zlib.decompressobj(-9).decompress(payload) == noise + noise


def test_frames_keep_their_order() -> None:
    hub = Frames()
    for letter, size in (("a", 5000), ("b", 2 * LONG), ("c", 10), ("d", 2 * LONG), ("e", 5000)):
        hub.frames.put(text(size, letter), ">")
    assert hub.sent == [">a*"]
    hub.workers.finish()
    assert hub.sent == [">a*", ">b*", ">c"]
    hub.workers.finish()
    assert hub.sent == [">a*", ">b*", ">c", ">d*", ">e*"]
    assert hub.deflater.held == 0
    assert not hub.workers.jobs


def test_long_texts_take_turns() -> None:
    """A map of many megabytes keeps no other text waiting for more than a slice."""
    hub = Frames()
    hub.frames.put(text(5 * SLICE), "map ")
    hub.more().put(text(SLICE), "scan ")
    for _ in range(2):
        hub.workers.finish()
    assert hub.sent == ["scan a*"]
    hub.workers.finish_all()
    assert hub.sent == ["scan a*", "map a*"]


def test_texts_that_would_wait_long_are_sent_as_they_are() -> None:
    hub = Frames()
    busy = [hub.more() for _ in range(MOST_AHEAD // SLICE)]
    for each in busy:
        each.put(text(SLICE + 1), "busy ")
    hub.frames.put(text(LONG + 1), "late ")
    assert hub.sent == ["late a"]
    busy[0].put(text(LONG + 1, "z"), "busy ")
    assert hub.sent[1:] == ["busy a", "busy z"]
    hub.workers.finish_all()
    assert hub.sent[3:] == 3 * ["busy a*"]
    assert hub.deflater.held == 0


def test_bytes_that_wait_are_bounded() -> None:
    hub = Frames(most_held=5 * LONG)
    hub.frames.put(text(2 * LONG, "a"), ">")
    hub.frames.put(text(2 * LONG, "b"), ">")
    assert 4 * LONG < hub.deflater.held < 5 * LONG
    hub.frames.put(text(2 * LONG, "c"), ">")
    assert hub.sent == [">a", ">b", ">c"]
    assert hub.deflater.held == 0
    hub.workers.finish_all()
    assert len(hub.sent) == 3


def test_short_texts_take_a_share_of_the_time(monkeypatch: pytest.MonkeyPatch) -> None:
    hub = Frames()

    def slow(bits: int) -> Any:
        hub.now += BURST / 2
        return compressor(bits)

    monkeypatch.setattr(COMPRESSOR, slow)
    for _ in range(4):
        hub.frames.put(text(5000), ">")
    assert hub.sent == [">a*", ">a*", ">a*", ">a"]
    hub.now += BURST / SHARE
    hub.frames.put(text(5000), ">")
    assert hub.sent[4:] == [">a*"]


def test_fault_of_compression_costs_no_message(monkeypatch: pytest.MonkeyPatch) -> None:
    hub = Frames()

    class Failing:
        def compress(self, data: memoryview) -> bytes:
            raise MemoryError

    monkeypatch.setattr(COMPRESSOR, lambda bits: Failing())
    hub.frames.put(text(LONG + 1), ">")
    hub.workers.finish_all()
    assert hub.sent == [">a"]


class Queue:
    """A send queue, and what came out of it."""

    def __init__(self) -> None:
        self.written: list[bytes] = []
        self.workers = FakeWorkers()
        self._due: list[Callable[[], None]] = []
        flusher = Flusher(self._due.append)
        deflater = Deflater(self.workers, lambda: 0.0)
        self.queue = DeflatingSendQueue(
            lambda data: self.written.append(bytes(data)),
            lambda: None,
            flusher,
            deflater,
            max_bytes=10**6,
            bits=MOST_BITS,
        )

    def turn(self) -> list[bytes]:
        """End the loop's turn; return the frames that were written, inflated."""
        due, self._due[:] = list(self._due), []
        for each in due:
            each()
        written, self.written = b"".join(self.written), []
        return [
            server_frame(first & ~DEFLATED, _whole(first, data)) for first, data in frames(written)
        ]


def _whole(first: int, payload: bytes) -> bytes:
    return zlib.decompressobj(-MOST_BITS).decompress(payload) if first & DEFLATED else payload


def test_replies_are_compressed_in_order() -> None:
    queue = Queue()
    replies = [text(10), text(5000), text(2 * LONG), text(20), text(3 * LONG)]
    for each in replies:
        queue.queue.reply(each)
    assert queue.turn() == replies[:2]
    queue.queue.put(text(30), Lane(1))
    queue.workers.finish_all()
    assert queue.turn() == [text(30), *replies[2:]]
    assert queue.queue.bytes_sent < 1000


def test_replies_are_sent_as_they_are_before_the_end() -> None:
    queue = Queue()
    queue.queue.reply(text(2 * LONG))
    queue.queue.flush()
    assert queue.written == [text(2 * LONG)]
    queue.queue.reply(text(2 * LONG))
    queue.queue.close()
    queue.workers.finish_all()
    assert len(queue.written) == 1


def test_replies_of_a_client_that_does_not_read_are_kept_compressed() -> None:
    queue = Queue()
    queue.queue.pause()
    queue.queue.reply(text(2 * LONG))
    queue.workers.finish_all()
    assert 0 < queue.queue.kept_bytes < 1000
    queue.queue.resume()
    assert queue.turn() == [text(2 * LONG)]
