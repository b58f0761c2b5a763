"""The frames that wait for one client."""

from __future__ import annotations

from typing import TypeAlias

import pytest
from hypothesis import strategies as st
from hypothesis.stateful import Bundle, RuleBasedStateMachine, initialize, invariant, rule

from fibws.hub.outbox import MOST_UNWRITTEN, Flusher, Outbox, Queue

from .fakes import FakeClock


class Wire:
    """An outbox, and what it writes."""

    def __init__(self, clock: FakeClock, flusher: Flusher, *, max_bytes: int = 1000) -> None:
        self.clock = clock
        self.writes: list[bytes] = []
        self.breaks = 0
        self.error: Exception | None = None
        self.outbox = Outbox(self._write, self._broken, flusher, max_bytes=max_bytes)

    def _write(self, data: bytes) -> None:
        if self.error is not None:
            raise self.error
        self.writes.append(data)

    def _broken(self) -> None:
        self.breaks += 1

    def turn(self) -> list[bytes]:
        """What is written at the end of the loop's turn."""
        self.clock.turn()
        writes, self.writes = self.writes, []
        return writes


def wires(number: int, *, max_bytes: int = 1000) -> list[Wire]:
    clock = FakeClock()
    flusher = Flusher(clock.call_soon)
    return [Wire(clock, flusher, max_bytes=max_bytes) for _ in range(number)]


def wire(*, max_bytes: int = 1000) -> Wire:
    return wires(1, max_bytes=max_bytes)[0]


def test_all_frames_of_a_turn_leave_in_one_write_and_in_order() -> None:
    it, first, second = wire(), Queue(1), Queue(1)
    it.outbox.put(b"1", first)
    it.outbox.put(b"2", second)
    it.outbox.reply(b"3")
    it.outbox.put(b"4", first)
    assert it.writes == []
    assert it.turn() == [b"1234"]
    assert it.turn() == []


def test_of_what_only_the_newest_is_of_use_a_slow_client_is_kept_the_newest() -> None:
    it, queue = wire(max_bytes=100), Queue(1)
    it.outbox.latest("a", b"1")
    it.outbox.latest("a", b"2")
    assert it.turn() == [b"12"]
    it.outbox.pause()
    for number in range(100):
        it.outbox.latest("a", b"%d" % number * 5)
        it.outbox.latest("b", b"x" * (80 - number // 2))
    it.outbox.put(b"m", queue)
    it.outbox.reply(b"r")
    assert it.outbox.kept_bytes == len(b"9999999999") + 31 + len(b"mr")
    assert not it.outbox.overfull
    it.outbox.resume()
    assert it.turn() == [b"r9999999999" + b"x" * 31 + b"m"]
    assert it.outbox.kept_bytes == 0
    it.outbox.pause()
    it.outbox.resume()
    assert it.turn() == []


def test_what_only_the_newest_is_of_use_may_make_a_client_overfull_and_then_grows_no_more() -> None:
    it = wire(max_bytes=10)
    it.outbox.pause()
    it.outbox.latest("a", b"x" * 11)
    assert it.outbox.overfull
    it.outbox.latest("b", b"x" * 11)
    assert it.outbox.kept_bytes == 11


def test_every_turn_has_its_write() -> None:
    it = wire()
    for number in (b"1", b"2"):
        it.outbox.reply(number)
        assert it.turn() == [number]


def test_equal_lists_of_frames_are_joined_once_for_all() -> None:
    some, queue = wires(3), Queue(1)
    for frame in (b"1" * 10, b"2" * 10):
        for it in some:
            it.outbox.put(frame, queue)
    some[0].clock.turn()
    first, *others = [it.writes for it in some]
    assert first == [b"1" * 10 + b"2" * 10]
    assert all(other[0] is first[0] for other in others)


def test_lists_that_differ_leave_as_they_are() -> None:
    some, queue = wires(4), Queue(1)
    for it in some:
        it.outbox.put(b"shared", queue)
    some[1].outbox.reply(b"own")
    some[2].outbox.reply(b"other")
    some[0].clock.turn()
    assert [it.writes for it in some] == [
        [b"shared"],
        [b"sharedown"],
        [b"sharedother"],
        [b"shared"],
    ]


def test_a_single_frame_leaves_without_a_copy() -> None:
    it, frame = wire(), b"x" * 100
    it.outbox.reply(frame)
    assert it.turn()[0] is frame


def test_nothing_is_written_while_paused() -> None:
    it = wire()
    it.outbox.pause()
    it.outbox.put(b"message", Queue(1))
    it.outbox.reply(b"reply")
    assert it.turn() == []
    assert it.outbox.paused


def test_a_pause_before_the_end_of_the_turn_holds_back_what_is_due() -> None:
    it = wire()
    it.outbox.put(b"1", Queue(1))
    it.outbox.pause()
    it.outbox.put(b"2", Queue(1))
    assert it.turn() == []
    it.outbox.resume()
    assert it.turn() == [b"12"]


def test_after_a_pause_the_replies_come_first_and_the_rest_in_order() -> None:
    it, first, second = wire(), Queue(9), Queue(9)
    it.outbox.pause()
    for number, queue in [(b"1", first), (b"2", second), (b"3", first)]:
        it.outbox.put(number, queue)
        it.outbox.reply(b"reply" + number)
    it.outbox.resume()
    assert it.turn() == [b"reply1reply2reply3123"]


def test_a_resumption_with_nothing_kept_writes_nothing() -> None:
    it = wire()
    it.outbox.pause()
    it.outbox.resume()
    assert it.turn() == []


def test_a_short_pause_within_a_turn_changes_nothing() -> None:
    it = wire()
    it.outbox.reply(b"1")
    it.outbox.pause()
    it.outbox.resume()
    it.outbox.reply(b"2")
    assert it.turn() == [b"12"]


def test_the_oldest_message_is_dropped_when_a_queue_is_full() -> None:
    it, short, long = wire(), Queue(2), Queue(9)
    it.outbox.pause()
    for number in (b"1", b"2", b"3", b"4"):
        it.outbox.put(b"s" + number, short)
        it.outbox.put(b"l" + number, long)
    assert (short.dropped, long.dropped, it.outbox.dropped) == (2, 0, 2)
    it.outbox.resume()
    assert it.turn() == [b"l1l2s3l3s4l4"]


@pytest.mark.parametrize("limit", [1, 0])
def test_the_newest_message_is_always_kept(limit: int) -> None:
    it, queue = wire(max_bytes=5), Queue(limit)
    it.outbox.pause()
    it.outbox.put(b"x" * 10, queue)
    it.outbox.put(b"y" * 10, queue)
    it.outbox.resume()
    assert it.turn() == [b"y" * 10]


def test_the_queue_that_breaks_the_bound_of_bytes_pays_for_it() -> None:
    it, quiet, loud = wire(max_bytes=50), Queue(100), Queue(100)
    it.outbox.pause()
    it.outbox.put(b"quiet", quiet)
    for _ in range(10):
        it.outbox.put(b"x" * 10, loud)
    assert (quiet.dropped, loud.dropped) == (0, 6)
    assert it.outbox.kept_bytes == 45


def test_if_that_is_not_enough_the_oldest_of_all_pay() -> None:
    it, first, second, large = wire(max_bytes=50), Queue(9), Queue(9), Queue(9)
    it.outbox.pause()
    for frame, queue in [(b"1" * 20, first), (b"2" * 20, second), (b"3" * 25, large)]:
        it.outbox.put(frame, queue)
    assert (first.dropped, second.dropped, large.dropped, it.outbox.dropped) == (1, 0, 0, 1)
    it.outbox.resume()
    assert it.turn() == [b"2" * 20 + b"3" * 25]


def test_bytes_of_replies_count_until_they_alone_break_the_limit() -> None:
    """Then the client is lost, and nothing more needs to be kept for it."""
    it, queue = wire(max_bytes=50), Queue(9)
    it.outbox.pause()
    for _ in range(10):
        it.outbox.reply(b"r" * 10)
    it.outbox.put(b"1", queue)
    it.outbox.put(b"2", queue)
    assert queue.dropped == 1
    assert it.outbox.overfull
    it.outbox.resume()
    assert it.turn() == [b"r" * 60 + b"2"]


def test_too_many_replies_are_told() -> None:
    it = wire(max_bytes=50)
    it.outbox.pause()
    it.outbox.put(b"x" * 100, Queue(1))
    overfull = []
    for frame in (b"r" * 50, b"r"):
        it.outbox.reply(frame)
        overfull.append(it.outbox.overfull)
    it.outbox.resume()
    overfull.append(it.outbox.overfull)
    assert overfull == [False, True, False]


def test_after_a_resumption_the_bounds_are_as_wide_as_before() -> None:
    it, queue = wire(max_bytes=30), Queue(3)
    for _ in range(3):
        it.outbox.pause()
        for _ in range(3):
            it.outbox.put(b"x" * 10, queue)
        assert it.outbox.kept_bytes == 30
        it.outbox.resume()
        assert it.turn() == [b"x" * 30]
    assert queue.dropped == 0


def test_what_a_subscription_that_ended_had_kept_is_forgotten() -> None:
    it, ended, other = wire(), Queue(9), Queue(9)
    it.outbox.pause()
    for _ in range(2):
        it.outbox.put(b"ended", ended)
        it.outbox.put(b"other", other)
    it.outbox.forget(ended)
    assert it.outbox.kept_bytes == 10
    assert it.outbox.dropped == ended.dropped == 0
    it.outbox.resume()
    assert it.turn() == [b"otherother"]


def test_a_subscription_that_kept_nothing_can_be_forgotten() -> None:
    it = wire()
    it.outbox.forget(Queue(1))
    assert it.turn() == []


@pytest.mark.parametrize("error", [OSError("gone"), RuntimeError("unable to write")])
def test_a_client_whose_socket_fails_does_not_harm_the_others(error: Exception) -> None:
    some = wires(3)
    some[1].error = error
    for it in some:
        it.outbox.reply(b"1")
    assert [it.turn() for it in some] == [[b"1"], [], [b"1"]]
    assert [it.breaks for it in some] == [0, 1, 0]


def test_a_socket_fails_but_once() -> None:
    it = wire()
    it.error = OSError("gone")
    for _ in range(3):
        it.outbox.reply(b"1")
        it.turn()
    assert it.breaks == 1


def test_nothing_is_written_once_it_is_closed() -> None:
    it = wire()
    it.outbox.reply(b"1")
    it.outbox.close()
    it.outbox.reply(b"2")
    assert it.turn() == []


def test_what_waits_can_be_written_before_the_end_of_the_turn() -> None:
    it = wire()
    it.outbox.reply(b"1")
    it.outbox.reply(b"2")
    it.outbox.flush()
    assert it.writes == [b"12"]
    assert it.turn() == [b"12"]


def test_a_flush_of_nothing_writes_nothing() -> None:
    it = wire()
    it.outbox.flush()
    it.outbox.pause()
    it.outbox.reply(b"1")
    it.outbox.flush()
    assert it.turn() == []


Kept: TypeAlias = list[tuple[int, bytes]]


class OutboxMachine(RuleBasedStateMachine):
    """An outbox beside the plainest model of one: lists, searched from the front."""

    queues = Bundle("queues")
    MAX_BYTES = 60

    @initialize()
    def open(self) -> None:
        self.wire = wire(max_bytes=self.MAX_BYTES)
        self.known: list[Queue] = []
        self.due: list[bytes] = []
        self.replies: list[bytes] = []
        self.kept: Kept = []
        self.dropped: list[int] = []
        self.number = 0

    @rule(target=queues, limit=st.integers(1, 4))
    def subscribe(self, limit: int) -> int:
        self.known.append(Queue(limit))
        self.dropped.append(0)
        return len(self.known) - 1

    @rule(queue=queues, size=st.integers(0, 25))
    def put(self, queue: int, size: int) -> None:
        frame = self._frame(size)
        self.wire.outbox.put(frame, self.known[queue])
        if not self.wire.outbox.paused:
            self.due.append(frame)
            return
        self.kept.append((queue, frame))
        while self._count(queue) > 1 and (
            self._count(queue) > self.known[queue].limit or self._bytes() > self.MAX_BYTES
        ):
            self._drop(queue)
        while len(self.kept) > 1 and self._bytes() > self.MAX_BYTES:
            self._drop(self.kept[0][0])

    @rule(size=st.integers(0, 25))
    def reply(self, size: int) -> None:
        frame = self._frame(size)
        self.wire.outbox.reply(frame)
        if not self.wire.outbox.paused:
            self.due.append(frame)
        elif sum(map(len, self.replies)) <= self.MAX_BYTES:
            self.replies.append(frame)

    @rule()
    def pause(self) -> None:
        self.wire.outbox.pause()

    @rule()
    def resume(self) -> None:
        self.wire.outbox.resume()
        self.due += [*self.replies, *(frame for _, frame in self.kept)]
        self.replies, self.kept = [], []

    @rule(queue=queues)
    def forget(self, queue: int) -> None:
        self.wire.outbox.forget(self.known[queue])
        self.kept = [each for each in self.kept if each[0] != queue]

    @rule()
    def turn(self) -> None:
        written = self.wire.turn()
        if self.wire.outbox.paused or not self.due:
            assert written == []
        else:
            assert written == [b"".join(self.due)]
            self.due = []

    @invariant()
    def the_counters_agree(self) -> None:
        outbox = self.wire.outbox
        assert outbox.kept_bytes == self._bytes()
        assert outbox.overfull == (sum(map(len, self.replies)) > self.MAX_BYTES)
        assert [queue.dropped for queue in self.known] == self.dropped
        assert outbox.dropped == sum(self.dropped)

    @invariant()
    def each_queue_is_within_its_limit(self) -> None:
        assert all(len(queue.waiting) <= queue.limit for queue in self.known)

    def _frame(self, size: int) -> bytes:
        self.number += 1
        return b"%d." % self.number + b"x" * size

    def _count(self, queue: int) -> int:
        return sum(each == queue for each, _ in self.kept)

    def _bytes(self) -> int:
        return sum(map(len, self.replies)) + sum(len(frame) for _, frame in self.kept)

    def _drop(self, queue: int) -> None:
        del self.kept[[each for each, _ in self.kept].index(queue)]
        self.dropped[queue] += 1


TestOutboxMachine = OutboxMachine.TestCase


def test_what_takes_much_memory_leaves_before_the_turn_ends() -> None:
    it, queue = wire(max_bytes=10 * MOST_UNWRITTEN), Queue(9)
    it.outbox.put(b"x" * MOST_UNWRITTEN, queue)
    assert it.writes == []
    it.outbox.reply(b"y")
    assert it.writes == [b"x" * MOST_UNWRITTEN + b"y"]
    it.outbox.put(b"z", queue)
    assert it.turn() == [b"x" * MOST_UNWRITTEN + b"y", b"z"]


def test_who_cannot_be_written_to_silences_nobody(caplog: pytest.LogCaptureFixture) -> None:
    first, second = wires(2)
    first.error = MemoryError()
    for each in (first, second):
        each.outbox.put(b"1", Queue(1))
    assert second.turn() == [b"1"]
    assert first.breaks == 1
    assert "cut off" in caplog.text
