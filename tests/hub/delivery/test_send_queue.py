"""Send queues: the frames that wait for one client."""

from __future__ import annotations

import math
import re
from collections.abc import Callable

import pytest
from hypothesis import strategies as st
from hypothesis.stateful import Bundle, RuleBasedStateMachine, initialize, invariant, rule

from fibws.hub.delivery import send_queue
from fibws.hub.delivery.send_queue import (
    CHUNK,
    LARGE,
    MOST_UNWRITTEN,
    WRITE_SIZE,
    Bytes,
    Flusher,
    LargeFrame,
    SendQueue,
    frame_of,
)
from fibws.protocol.frame_queue import Lane

from ..fakes import FakeClock


class FakeClient:
    """A client with a send queue; records the writes to its socket."""

    def __init__(self, clock: FakeClock, flusher: Flusher, *, max_bytes: int = 1000) -> None:
        self.clock = clock
        self.writes: list[Bytes] = []
        self.breaks = 0
        self.error: Exception | None = None
        self.room: float = math.inf
        """Bytes that the socket takes before it is full."""
        self.queue = SendQueue(self._write, self._broken, flusher, max_bytes=max_bytes)

    def _write(self, data: Bytes) -> None:
        if self.error is not None:
            raise self.error
        self.writes.append(data)
        self.room -= len(data)
        if self.room <= 0:
            self.queue.pause()

    def _broken(self) -> None:
        self.breaks += 1

    def turn(self) -> list[Bytes]:
        """End the loop's turn; return the bytes written since the last one."""
        self.clock.turn()
        writes, self.writes = self.writes, []
        return writes


def clients(number: int, *, max_bytes: int = 1000) -> list[FakeClient]:
    clock = FakeClock()
    flusher = Flusher(clock.call_soon)
    return [FakeClient(clock, flusher, max_bytes=max_bytes) for _ in range(number)]


def new_client(*, max_bytes: int = 1000) -> FakeClient:
    return clients(1, max_bytes=max_bytes)[0]


def test_all_frames_of_a_turn_leave_in_order_in_one_write() -> None:
    client, first, second = new_client(), Lane(1), Lane(1)
    client.queue.put(b"1", first)
    client.queue.put(b"2", second)
    client.queue.reply(b"3")
    client.queue.put(b"4", first)
    assert client.writes == []
    assert client.turn() == [b"1234"]
    assert client.turn() == []


def test_fresh_replies_are_made_when_a_slow_client_reads_again() -> None:
    client, lane = new_client(max_bytes=100), Lane(1)
    made = {"a": 0, "b": 0}

    def maker(name: str) -> Callable[[], bytes]:
        def make() -> bytes:
            made[name] += 1
            return f"{name}{made[name]}".encode()

        return make

    a, b = maker("a"), maker("b")
    client.queue.reply_fresh(a)
    client.queue.reply_fresh(a)
    assert client.turn() == [b"a1a2"]
    client.queue.pause()
    for _ in range(100):
        client.queue.reply_fresh(a)
        client.queue.reply_fresh(b)
    client.queue.put(b"m", lane)
    client.queue.reply(b"r")
    assert client.queue.kept_bytes == len(b"mr")
    assert made == {"a": 2, "b": 0}
    client.queue.resume()
    assert b"".join(client.turn()) == b"ra3b1m"
    client.queue.pause()
    client.queue.resume()
    assert client.turn() == []


def test_empty_reply_is_not_sent() -> None:
    client = new_client()
    client.queue.reply_fresh(bytes)
    assert client.turn() == []
    client.queue.pause()
    client.queue.reply_fresh(bytes)
    client.queue.resume()
    assert b"".join(client.turn()) == b""


def test_fresh_replies_are_made_as_the_client_takes_them() -> None:
    client, made = new_client(), []

    def maker(number: int) -> Callable[[], bytes]:
        def make() -> bytes:
            made.append(number)
            return b"x" * CHUNK

        return make

    client.queue.pause()
    for number in range(3):
        client.queue.reply_fresh(maker(number))
    for number in range(3):
        client.room = CHUNK
        client.queue.resume()
        assert made == [*range(number + 1)]
    assert len(b"".join(client.turn())) == 3 * CHUNK


def test_functions_are_called_before_the_frames_of_a_turn_are_written() -> None:
    client = new_client()
    client.queue.reply(b"1")
    client.queue.flusher.call_first(lambda: client.queue.reply(b"2"))
    assert client.turn() == [b"12"]
    client.queue.flusher.call_first(lambda: client.queue.reply(b"3"))
    assert b"".join([*client.turn(), *client.turn()]) == b"3"


def test_failing_function_before_a_flush_does_not_prevent_writing(
    caplog: pytest.LogCaptureFixture,
) -> None:
    client = new_client()
    client.queue.reply(b"1")
    client.queue.flusher.call_first(lambda: 1 // 0)  # type: ignore[arg-type]
    assert client.turn() == [b"1"]
    assert "ZeroDivisionError" in caplog.text


def test_each_turn_has_its_own_write() -> None:
    client = new_client()
    for number in (b"1", b"2"):
        client.queue.reply(number)
        assert client.turn() == [number]


def test_equal_lists_of_frames_are_joined_once_for_all_clients() -> None:
    some, lane = clients(3), Lane(1)
    for frame in (b"1" * 10, b"2" * 10):
        for client in some:
            client.queue.put(frame, lane)
    some[0].clock.turn()
    first, *others = [client.writes for client in some]
    assert first == [b"1" * 10 + b"2" * 10]
    assert all(other[0] is first[0] for other in others)


def test_different_lists_of_frames_are_joined_separately() -> None:
    some, lane = clients(4), Lane(1)
    for client in some:
        client.queue.put(b"shared", lane)
    some[1].queue.reply(b"own")
    some[2].queue.reply(b"other")
    some[0].clock.turn()
    assert [client.writes for client in some] == [
        [b"shared"],
        [b"sharedown"],
        [b"sharedother"],
        [b"shared"],
    ]


def test_single_frame_is_written_without_a_copy() -> None:
    client, frame = new_client(), b"x" * 100
    client.queue.reply(frame)
    assert client.turn()[0] is frame


def test_nothing_is_written_while_paused() -> None:
    client = new_client()
    client.queue.pause()
    client.queue.put(b"message", Lane(1))
    client.queue.reply(b"reply")
    assert client.turn() == []
    assert client.queue.paused


def test_pause_before_the_end_of_the_turn_keeps_the_frames_of_the_turn() -> None:
    client = new_client()
    client.queue.put(b"1", Lane(1))
    client.queue.pause()
    client.queue.put(b"2", Lane(1))
    assert client.turn() == []
    client.queue.resume()
    assert client.turn() == [b"12"]


def test_after_a_pause_replies_are_sent_before_messages() -> None:
    client, first, second = new_client(), Lane(9), Lane(9)
    client.queue.pause()
    for number, lane in [(b"1", first), (b"2", second), (b"3", first)]:
        client.queue.put(number, lane)
        client.queue.reply(b"reply" + number)
    client.queue.resume()
    assert client.turn() == [b"reply1reply2reply3123"]


def test_resuming_with_nothing_kept_writes_nothing() -> None:
    client = new_client()
    client.queue.pause()
    client.queue.resume()
    assert client.turn() == []


def test_short_pause_within_a_turn_changes_nothing() -> None:
    client = new_client()
    client.queue.reply(b"1")
    client.queue.pause()
    client.queue.resume()
    client.queue.reply(b"2")
    assert client.turn() == [b"12"]


def test_oldest_message_is_dropped_when_a_lane_is_full() -> None:
    client, short, long = new_client(), Lane(2), Lane(9)
    client.queue.pause()
    for number in (b"1", b"2", b"3", b"4"):
        client.queue.put(b"s" + number, short)
        client.queue.put(b"l" + number, long)
    assert (short.dropped, long.dropped, client.queue.dropped) == (2, 0, 2)
    client.queue.resume()
    assert client.turn() == [b"l1l2s3l3s4l4"]


@pytest.mark.parametrize("limit", [1, 0])
def test_newest_message_is_always_kept(limit: int) -> None:
    client, lane = new_client(max_bytes=5), Lane(limit)
    client.queue.pause()
    client.queue.put(b"x" * 10, lane)
    client.queue.put(b"y" * 10, lane)
    client.queue.resume()
    assert client.turn() == [b"y" * 10]


def test_lane_that_exceeds_the_byte_limit_loses_its_oldest_messages() -> None:
    client, quiet, loud = new_client(max_bytes=50), Lane(100), Lane(100)
    client.queue.pause()
    client.queue.put(b"quiet", quiet)
    for _ in range(10):
        client.queue.put(b"x" * 10, loud)
    assert (quiet.dropped, loud.dropped) == (0, 6)
    assert client.queue.kept_bytes == 45


def test_oldest_messages_of_other_lanes_are_dropped_if_that_is_not_enough() -> None:
    client, first, second, large = new_client(max_bytes=50), Lane(9), Lane(9), Lane(9)
    client.queue.pause()
    for frame, lane in [(b"1" * 20, first), (b"2" * 20, second), (b"3" * 25, large)]:
        client.queue.put(frame, lane)
    assert (first.dropped, second.dropped, large.dropped, client.queue.dropped) == (1, 0, 0, 1)
    client.queue.resume()
    assert client.turn() == [b"2" * 20 + b"3" * 25]


def test_replies_count_towards_the_byte_limit_and_are_never_dropped() -> None:
    client, lane = new_client(max_bytes=50), Lane(9)
    client.queue.pause()
    for _ in range(10):
        client.queue.reply(b"r" * 10)
    client.queue.put(b"1", lane)
    client.queue.put(b"2", lane)
    assert lane.dropped == 1
    assert client.queue.overfull
    client.queue.resume()
    assert client.turn() == [b"r" * 60 + b"2"]


def test_client_is_overfull_when_its_replies_exceed_the_limit() -> None:
    client = new_client(max_bytes=50)
    client.queue.pause()
    client.queue.put(b"x" * 100, Lane(1))
    overfull = []
    for frame in (b"r" * 50, b"r"):
        client.queue.reply(frame)
        overfull.append(client.queue.overfull)
    client.queue.resume()
    overfull.append(client.queue.overfull)
    assert overfull == [False, True, False]


def test_limits_are_the_same_in_each_pause() -> None:
    client, lane = new_client(max_bytes=30), Lane(3)
    for _ in range(3):
        client.queue.pause()
        for _ in range(3):
            client.queue.put(b"x" * 10, lane)
        assert client.queue.kept_bytes == 30
        client.queue.resume()
        assert client.turn() == [b"x" * 30]
    assert lane.dropped == 0


def test_frames_of_a_subscription_that_ended_are_removed() -> None:
    client, ended, other = new_client(), Lane(9), Lane(9)
    client.queue.pause()
    for _ in range(2):
        client.queue.put(b"ended", ended)
        client.queue.put(b"other", other)
    client.queue.forget(ended)
    assert client.queue.kept_bytes == 10
    assert client.queue.dropped == ended.dropped == 0
    client.queue.resume()
    assert client.turn() == [b"otherother"]


def test_lane_without_frames_can_be_forgotten() -> None:
    client = new_client()
    client.queue.forget(Lane(1))
    assert client.turn() == []


@pytest.mark.parametrize("error", [OSError("gone"), RuntimeError("unable to write")])
def test_socket_that_fails_does_not_affect_other_clients(error: Exception) -> None:
    some = clients(3)
    some[1].error = error
    for client in some:
        client.queue.reply(b"1")
    assert [client.turn() for client in some] == [[b"1"], [], [b"1"]]
    assert [client.breaks for client in some] == [0, 1, 0]


def test_failed_socket_is_reported_once() -> None:
    client = new_client()
    client.error = OSError("gone")
    for _ in range(3):
        client.queue.reply(b"1")
        client.turn()
    assert client.breaks == 1


def test_nothing_is_written_after_close() -> None:
    client = new_client()
    client.queue.reply(b"1")
    client.queue.close()
    client.queue.reply(b"2")
    assert client.turn() == []


def test_flush_writes_before_the_end_of_the_turn() -> None:
    client = new_client()
    client.queue.reply(b"1")
    client.queue.reply(b"2")
    client.queue.flush()
    assert client.writes == [b"12"]
    assert client.turn() == [b"12"]


def test_flush_writes_nothing_when_empty_or_paused() -> None:
    client = new_client()
    client.queue.flush()
    client.queue.pause()
    client.queue.reply(b"1")
    client.queue.flush()
    assert client.turn() == []


def test_many_unwritten_bytes_are_written_before_the_turn_ends() -> None:
    client, lane = new_client(max_bytes=10 * MOST_UNWRITTEN), Lane(9)
    for _ in range(4):
        client.queue.put(b"x" * (MOST_UNWRITTEN // 4), lane)
    assert client.writes == []
    client.queue.reply(b"y")
    assert b"".join(client.writes) == b"x" * MOST_UNWRITTEN + b"y"
    client.writes.clear()
    client.queue.put(b"z", lane)
    assert client.turn() == [b"z"]


def test_many_unwritten_bytes_for_all_clients_are_written_before_the_turn_ends() -> None:
    some = clients(4)
    targets = {client.queue: Lane(9) for client in some}
    flusher = some[0].queue.flusher
    flusher.broadcast(b"x" * (MOST_UNWRITTEN // 4), targets)
    assert not any(client.writes for client in some)
    flusher.broadcast(b"y", targets)
    assert all(b"".join(client.writes)[-1:] == b"y" for client in some)


def test_client_that_cannot_be_written_to_is_cut_off_alone(
    caplog: pytest.LogCaptureFixture,
) -> None:
    first, second = clients(2)
    first.error = MemoryError()
    for each in (first, second):
        each.queue.put(b"1", Lane(1))
    assert second.turn() == [b"1"]
    assert first.breaks == 1
    assert "cut off" in caplog.text


# A slow reader gets fresh messages.


def keep(client: FakeClient, lane: Lane, numbers: range, size: int) -> None:
    """Pause a client and put numbered frames of one size into its lane."""
    client.queue.pause()
    for number in numbers:
        client.queue.put(b"%03d" % number + bytes(size - 3), lane)


def numbers(writes: list[Bytes], size: int) -> list[int]:
    """The numbers of the frames that were written."""
    data = b"".join(writes)
    assert len(data) % size == 0
    return [int(data[start : start + 3]) for start in range(0, len(data), size)]


def test_slow_client_is_written_one_chunk_of_kept_messages_at_a_time() -> None:
    client, lane, size = new_client(max_bytes=10 * CHUNK), Lane(1000), CHUNK // 4
    keep(client, lane, range(12), size)
    for expected in ([0, 1, 2, 3], [4, 5, 6, 7], [8, 9, 10, 11]):
        client.room = CHUNK
        client.queue.resume()
        assert numbers(client.turn(), size) == expected
        assert client.queue.paused
    client.room = math.inf
    client.queue.resume()
    assert not client.queue.paused
    assert client.turn() == []


def test_newer_messages_replace_those_that_were_not_written_yet() -> None:
    client, lane, size = new_client(max_bytes=10 * CHUNK), Lane(8), CHUNK // 4
    keep(client, lane, range(8), size)
    client.room = CHUNK
    client.queue.resume()
    assert numbers(client.turn(), size) == [0, 1, 2, 3]
    keep(client, lane, range(8, 100), size)
    assert client.queue.dropped == lane.dropped == 88
    client.room = CHUNK
    client.queue.resume()
    assert numbers(client.turn(), size) == [92, 93, 94, 95]


def test_slow_client_reads_no_message_older_than_its_queue_length() -> None:
    client, lane, size = new_client(max_bytes=100 * CHUNK), Lane(10), CHUNK
    read: list[tuple[int, int]] = []
    client.queue.pause()
    for now in range(300):
        client.queue.put(b"%03d" % now + bytes(size - 3), lane)
        if now % 10 == 9:  # It reads a tenth of the topic.
            client.room = CHUNK
            client.queue.resume()
            read += [(now, number) for number in numbers(client.turn(), size)]
    assert len(read) == 30
    assert all(now - number < 10 for now, number in read)


def test_all_kept_messages_leave_at_once_if_the_socket_takes_them() -> None:
    client, lane, size = new_client(max_bytes=10 * CHUNK), Lane(1000), CHUNK // 4
    keep(client, lane, range(12), size)
    client.queue.resume()
    client.queue.put(b"012" + bytes(size - 3), lane)
    writes = client.turn()
    assert numbers(writes, size) == list(range(13))
    assert max(map(len, writes)) <= CHUNK
    assert client.queue.kept_bytes == 0


def test_messages_sent_before_the_rest_is_written_come_behind_it() -> None:
    client, lane, size = new_client(max_bytes=10 * CHUNK), Lane(1000), CHUNK // 4
    keep(client, lane, range(8), size)
    client.room = CHUNK
    client.queue.resume()
    client.queue.put(b"008" + bytes(size - 3), lane)
    client.room = math.inf
    client.queue.resume()
    assert numbers(client.turn(), size) == list(range(9))


def test_replies_overtake_the_rest_of_the_kept_messages() -> None:
    client, lane = new_client(max_bytes=10 * CHUNK), Lane(1000)
    client.queue.pause()
    for number in (b"1", b"2"):
        client.queue.put(number * CHUNK, lane)
    client.room = CHUNK
    client.queue.resume()
    client.queue.reply(b"reply")
    client.queue.reply_fresh(lambda: b"latest")
    client.queue.resume()
    assert b"".join(client.turn()) == b"1" * CHUNK + b"replylatest" + b"2" * CHUNK


def test_socket_that_fails_while_kept_messages_are_written_is_cut_off() -> None:
    client, lane = new_client(max_bytes=10 * CHUNK), Lane(1000)
    keep(client, lane, range(12), CHUNK // 4)
    client.error = OSError("gone")
    client.queue.resume()
    assert (client.breaks, client.queue.kept_bytes) == (1, 0)
    client.error = None
    client.queue.reply(b"1")
    assert client.turn() == []


def test_kept_replies_leave_one_chunk_at_a_time() -> None:
    client, size = new_client(max_bytes=10 * CHUNK), CHUNK // 4
    client.queue.pause()
    for number in range(12):
        client.queue.reply(b"%03d" % number + bytes(size - 3))
    for expected, left in (([0, 1, 2, 3], 8), ([4, 5, 6, 7], 4)):
        client.room = CHUNK
        client.queue.resume()
        assert numbers(client.turn(), size) == expected
        assert client.queue.kept_bytes == left * size
    client.queue.reply(b"012" + bytes(size - 3))
    client.room = math.inf
    client.queue.resume()
    assert numbers(client.turn(), size) == [8, 9, 10, 11, 12]


# Large frames.


def large_frame(size: int, head: bytes = b"head") -> tuple[LargeFrame, bytes]:
    """A large frame, and its body."""
    body = b"x" * size
    frame = frame_of(head, body)
    assert isinstance(frame, LargeFrame)
    return frame, body


def test_only_a_large_body_is_kept_apart_from_its_header() -> None:
    assert frame_of(b"head", b"x" * (LARGE - 1)) == b"head" + b"x" * (LARGE - 1)
    frame, body = large_frame(LARGE)
    assert len(frame) == 4 + LARGE
    assert (frame.head, frame.body.obj) == (b"head", body)


def test_large_frame_is_written_without_a_copy() -> None:
    client, lane = new_client(), Lane(1)
    frame, body = large_frame(LARGE)
    for each in (b"1", b"2", frame, b"3", frame, b"4"):
        client.queue.put(each, lane)
    writes = client.turn()
    assert writes == [b"12head", body, b"3head", body, b"4"]
    assert all(isinstance(writes[each], memoryview) for each in (1, 3))
    assert all(memoryview(writes[each]).obj is body for each in (1, 3))


@pytest.mark.parametrize("shared", [True, False])
def test_many_small_frames_are_written_in_pieces_as_the_socket_takes_them(shared: bool) -> None:
    client, lane = new_client(max_bytes=10 * WRITE_SIZE), Lane(1)
    frames = [b"%07d\n" % number for number in range(WRITE_SIZE // 2)]
    for frame in frames:
        client.queue.put(frame, lane)
    client.room = WRITE_SIZE
    if not shared:
        client.queue.flush()
    written = b"".join(client.turn())
    assert len(written) == WRITE_SIZE
    assert client.queue.paused
    assert client.queue.kept_bytes == 3 * WRITE_SIZE
    while client.queue.kept_bytes:
        client.room = WRITE_SIZE if client.queue.kept_bytes > WRITE_SIZE else math.inf
        client.queue.resume()
        writes = client.turn()
        assert max(map(len, writes)) <= WRITE_SIZE
        written += b"".join(writes)
    assert written == b"".join(frames)


def test_one_large_piece_of_bytes_is_written_without_a_copy() -> None:
    client, text = new_client(), bytes(3 * WRITE_SIZE)
    client.queue.reply(text)
    client.room = WRITE_SIZE
    [write] = client.turn()
    assert memoryview(write).obj is text
    assert client.queue.kept_bytes == 2 * WRITE_SIZE


def test_large_frame_is_shared_by_all_clients() -> None:
    some = clients(3)
    frame, body = large_frame(LARGE)
    lanes = {client.queue: Lane(1) for client in some}
    flusher = some[0].queue.flusher
    flusher.broadcast(b"small", lanes)
    flusher.broadcast(frame, lanes)
    for client in some:
        writes = client.turn()
        assert writes == [b"smallhead", body]
        assert memoryview(writes[1]).obj is body


def test_large_frame_that_was_kept_is_written_without_a_copy() -> None:
    client, lane = new_client(max_bytes=10 * LARGE), Lane(9)
    frame, body = large_frame(LARGE)
    client.queue.pause()
    for each in (b"1", frame, b"2"):
        client.queue.put(each, lane)
    assert client.queue.kept_bytes == len(frame) + 2
    client.queue.resume()
    writes = client.turn()
    assert writes == [b"1head", body, b"2"]
    assert memoryview(writes[1]).obj is body


def half_written(*, max_bytes: int = 10 * WRITE_SIZE) -> tuple[FakeClient, bytes]:
    """A client whose socket took the first piece of a large frame, and the whole frame."""
    client = new_client(max_bytes=max_bytes)
    frame, body = large_frame(3 * WRITE_SIZE)
    client.queue.put(frame, Lane(1))
    client.room = WRITE_SIZE
    assert client.turn() == [b"head", body[:WRITE_SIZE]]
    assert client.queue.paused
    assert client.queue.kept_bytes == 2 * WRITE_SIZE
    return client, b"head" + body


def test_large_frame_is_written_in_pieces_as_the_socket_takes_them() -> None:
    client, frame = half_written()
    for left in (1, 0):
        client.room = WRITE_SIZE
        client.queue.resume()
        assert client.turn() == [frame[4 : 4 + WRITE_SIZE]]
        assert client.queue.kept_bytes == left * WRITE_SIZE
    client.room = math.inf
    client.queue.resume()
    assert client.turn() == []
    assert not client.queue.paused


def test_everything_else_comes_behind_a_half_written_frame() -> None:
    client, frame = half_written()
    client.queue.put(b"message", Lane(1))
    client.queue.reply(b"reply")
    client.queue.reply_fresh(lambda: b"latest")
    client.room = math.inf
    client.queue.resume()
    assert b"".join(client.turn()) == frame[4 + WRITE_SIZE :] + b"replylatestmessage"


def test_control_frames_come_in_order_behind_a_half_written_frame() -> None:
    client, frame = half_written()
    client.queue.put(b"message", Lane(1))
    for control in (b"ping", b"pong"):
        client.queue.write_control(control)
    assert client.turn() == []
    client.room = math.inf
    client.queue.resume()
    assert b"".join(client.turn()) == frame[4 + WRITE_SIZE :] + b"pingpongmessage"
    client.queue.write_control(b"ping")
    assert client.writes == [b"ping"]


def test_control_frames_stay_in_order_when_the_first_ones_are_next() -> None:
    client, frame = half_written()
    client.queue.put(b"message", Lane(1))
    client.queue.write_control(b"1")
    client.room = 2 * WRITE_SIZE  # The rest of the large frame, and no more.
    client.queue.resume()
    assert b"".join(client.turn()) == frame[4 + WRITE_SIZE :]
    for control in (b"2", b"3"):
        client.queue.write_control(control)
    client.room = math.inf
    client.queue.resume()
    assert b"".join(client.turn()) == b"123message"


def test_messages_are_dropped_while_a_large_frame_is_half_written() -> None:
    client, _ = half_written(max_bytes=2 * WRITE_SIZE)
    lane = Lane(10)
    for number in range(5):
        client.queue.put(b"%d" % number, lane)
    assert lane.dropped == 4
    client.room = math.inf
    client.queue.resume()
    assert client.turn()[-1] == b"4"


def test_closing_completes_a_half_written_frame() -> None:
    client, frame = half_written()
    client.queue.put(b"message", Lane(1))
    client.queue.close()
    assert b"".join(client.turn()) == frame[4 + WRITE_SIZE :]
    assert client.queue.kept_bytes == 0
    client.queue.resume()
    assert client.turn() == []


@pytest.mark.parametrize("event", ["resume", "close"])
def test_socket_that_fails_within_a_large_frame_is_cut_off(event: str) -> None:
    client, _ = half_written()
    client.error = OSError("gone")
    getattr(client.queue, event)()
    assert client.breaks == 1
    assert client.queue.kept_bytes == 0
    assert client.turn() == []


class LargeFrameMachine(RuleBasedStateMachine):
    """Check that whole frames are written, in order, whenever the socket is full."""

    lanes = Bundle("lanes")
    FRAME = re.compile(rb"\[(\w+):(\d+):x*\]")

    def __init__(self) -> None:
        super().__init__()
        self.patch = pytest.MonkeyPatch()
        self.patch.setattr(send_queue, "CHUNK", 20)
        self.patch.setattr(send_queue, "WRITE_SIZE", 8)
        self.client = new_client(max_bytes=200)
        self.lanes_: list[Lane] = []
        self.put_: list[int] = []
        self.replies = 0
        self.pings = 0
        self.written = b""

    def teardown(self) -> None:
        self.client.room = math.inf
        for _ in range(2):
            self.client.queue.resume()
            self.turn()
        assert self.client.queue.kept_bytes == 0
        found = self.FRAME.findall(self.written)
        assert self.FRAME.sub(b"", self.written) == b""
        for number, lane in enumerate(self.lanes_):
            numbers = [int(each) for kind, each in found if kind == b"lane%d" % number]
            assert numbers == sorted(set(numbers))
            assert len(numbers) + lane.dropped == self.put_[number]
        for kind, count in ((b"reply", self.replies), (b"ping", self.pings)):
            assert [int(each) for name, each in found if name == kind] == list(range(count))
        self.patch.undo()

    @rule(target=lanes, limit=st.integers(1, 4))
    def subscribe(self, limit: int) -> int:
        self.lanes_.append(Lane(limit))
        self.put_.append(0)
        return len(self.lanes_) - 1

    @rule(lane=lanes, size=st.integers(0, 50), large=st.booleans())
    def put(self, lane: int, size: int, large: bool) -> None:
        head, body = b"[lane%d:%d:" % (lane, self.put_[lane]), b"x" * size + b"]"
        frame = LargeFrame(head, body) if large else head + body
        self.put_[lane] += 1
        self.client.queue.put(frame, self.lanes_[lane])

    @rule()
    def reply(self) -> None:
        if not self.client.queue.overfull:
            self.client.queue.reply(b"[reply:%d:]" % self.replies)
            self.replies += 1

    @rule()
    def ping(self) -> None:
        self.client.queue.write_control(b"[ping:%d:]" % self.pings)
        self.pings += 1

    @rule(room=st.integers(1, 60))
    def limit(self, room: int) -> None:
        self.client.room = room

    @rule(room=st.integers(1, 60) | st.just(math.inf))
    def resume(self, room: float) -> None:
        self.client.room = room
        self.client.queue.resume()

    @rule()
    def turn(self) -> None:
        self.written += b"".join(self.client.turn())

    @invariant()
    def only_one_message_may_exceed_the_limit(self) -> None:
        queue = self.client.queue
        if queue.exceeded:
            assert sum(len(lane.waiting) for lane in self.lanes_) <= 1


TestLargeFrameMachine = LargeFrameMachine.TestCase


# Limits.


def test_request_needs_half_of_a_slow_clients_limit_to_be_free() -> None:
    client = new_client(max_bytes=100)
    assert client.queue.has_room(1000)
    client.queue.pause()
    assert client.queue.has_room(50)
    assert not client.queue.has_room(51)
    client.queue.reply(b"x" * 20)
    assert client.queue.has_room(30)
    assert not client.queue.has_room(31)
    client.queue.put(b"x" * 60, Lane(1))
    assert client.queue.has_room(30)
    client.queue.resume()
    assert client.queue.has_room(1000)


def test_frames_that_wait_for_a_throttle_count_as_kept() -> None:
    client = new_client(max_bytes=100)
    client.queue.throttled_bytes = 101
    assert client.queue.exceeded
    assert client.queue.kept_bytes == 101
    assert not client.queue.overfull


def test_replies_make_messages_leave_the_limit() -> None:
    client, lane = new_client(max_bytes=100), Lane(100)
    client.queue.pause()
    for _ in range(10):
        client.queue.put(b"x" * 10, lane)
    client.queue.reply(b"r" * 30)
    client.queue.reply(b"s" * 20)
    assert client.queue.kept_bytes == 100
    assert (lane.dropped, client.queue.dropped) == (5, 5)


def test_frames_that_were_sent_in_the_turn_of_a_pause_count_as_kept() -> None:
    client, lane = new_client(max_bytes=100), Lane(100)
    client.queue.put(b"x" * 60, lane)
    client.queue.pause()
    for _ in range(10):
        client.queue.put(b"y" * 10, lane)
    assert client.queue.kept_bytes == 100
    client.queue.resume()
    assert client.turn() == [b"x" * 60 + b"y" * 40]
    assert client.queue.kept_bytes == 0


def test_limit_of_unwritten_bytes_can_be_lower() -> None:
    clock = FakeClock()
    client = FakeClient(clock, Flusher(clock.call_soon, max_unwritten=20), max_bytes=20)
    lane = Lane(100)
    client.room = 10
    for number in range(10):
        client.queue.put(b"%d" % number * 10, lane)
    assert client.queue.kept_bytes <= 20
    assert client.queue.dropped


# Any order of events.


class SendQueueMachine(RuleBasedStateMachine):
    """Compare a send queue to a simple model: lists that are searched from the front."""

    lanes = Bundle("lanes")
    MAX_BYTES = 60
    CHUNK = 20

    def __init__(self) -> None:
        super().__init__()
        self.patch = pytest.MonkeyPatch()
        self.patch.setattr(send_queue, "CHUNK", self.CHUNK)

    def teardown(self) -> None:
        self.patch.undo()

    @initialize()
    def open(self) -> None:
        self.client = new_client(max_bytes=self.MAX_BYTES)
        self.known: list[Lane] = []
        self.paused = False
        self.written = b""
        self.due: list[bytes] = []
        self.replies: list[bytes] = []
        self.kept: list[tuple[int, bytes]] = []
        self.dropped: list[int] = []
        self.number = 0

    @rule(target=lanes, limit=st.integers(1, 4))
    def subscribe(self, limit: int) -> int:
        self.known.append(Lane(limit))
        self.dropped.append(0)
        return len(self.known) - 1

    @rule(lane=lanes, size=st.integers(0, 25))
    def put(self, lane: int, size: int) -> None:
        frame = self._frame(size)
        self.client.queue.put(frame, self.known[lane])
        if not self.paused:
            self.due.append(frame)
            return
        self.kept.append((lane, frame))
        while self._count(lane) > 1 and (
            self._count(lane) > self.known[lane].limit or self._bytes() > self.MAX_BYTES
        ):
            self._drop(lane)
        self._make_room()

    @rule(size=st.integers(0, 25))
    def reply(self, size: int) -> None:
        frame = self._frame(size)
        self.client.queue.reply(frame)
        if not self.paused:
            self.due.append(frame)
        elif sum(map(len, self.replies)) <= self.MAX_BYTES:
            self.replies.append(frame)
            self._make_room()

    @rule()
    def pause(self) -> None:
        self.client.queue.pause()
        self.paused = True

    @rule(room=st.integers(1, 100) | st.just(math.inf))
    def resume(self, room: float) -> None:
        self.client.room = room
        self.client.queue.resume()
        self.client.room = math.inf
        self.paused = False
        while (self.replies or self.kept) and not self.paused:
            chunk = b""
            while self.replies and len(chunk) < self.CHUNK:
                chunk += self.replies.pop(0)
            while self.kept and len(chunk) < self.CHUNK:
                chunk += self.kept.pop(0)[1]
            chunk = b"".join(self.due) + chunk
            self.due = []
            self.written += chunk
            room -= len(chunk)
            self.paused = room <= 0

    @rule(lane=lanes)
    def forget(self, lane: int) -> None:
        self.client.queue.forget(self.known[lane])
        self.kept = [each for each in self.kept if each[0] != lane]

    @rule()
    def turn(self) -> None:
        if not self.paused:
            self.written += b"".join(self.due)
            self.due = []
        assert b"".join(self.client.turn()) == self.written
        self.written = b""

    @invariant()
    def the_counters_agree(self) -> None:
        queue = self.client.queue
        assert queue.paused == self.paused
        assert queue.kept_bytes == self._bytes()
        assert queue.overfull == (sum(map(len, self.replies)) > self.MAX_BYTES)
        assert [lane.dropped for lane in self.known] == self.dropped
        assert queue.dropped == sum(self.dropped)

    @invariant()
    def each_lane_is_within_its_limit(self) -> None:
        assert all(len(lane.waiting) <= lane.limit for lane in self.known)

    def _frame(self, size: int) -> bytes:
        self.number += 1
        return b"%d." % self.number + b"x" * size

    def _count(self, lane: int) -> int:
        return sum(each == lane for each, _ in self.kept)

    def _bytes(self) -> int:
        due = self.due if self.paused else []
        return sum(map(len, due + self.replies)) + sum(len(frame) for _, frame in self.kept)

    def _make_room(self) -> None:
        while len(self.kept) > 1 and self._bytes() > self.MAX_BYTES:
            self._drop(self.kept[0][0])

    def _drop(self, lane: int) -> None:
        del self.kept[[each for each, _ in self.kept].index(lane)]
        self.dropped[lane] += 1


TestSendQueueMachine = SendQueueMachine.TestCase
