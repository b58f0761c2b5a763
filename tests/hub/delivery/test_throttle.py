"""Throttles: at most one message in a period."""

from __future__ import annotations

import pytest

from fibws.hub.delivery.send_queue import Flusher, Frame, SendQueue
from fibws.hub.delivery.throttle import Throttle

from ..fakes import FakeClock


class Throttled:
    """A throttle, and the frames that it lets pass."""

    def __init__(
        self,
        *,
        queue_length: int,
        period: float = 0.3,
        clock: FakeClock | None = None,
        queue: SendQueue | None = None,
    ) -> None:
        self.clock = clock or FakeClock()
        self.queue = queue or send_queue(self.clock)
        self.sent: list[tuple[float, bytes]] = []
        self.throttle = Throttle(
            self._send,
            self.clock,
            self.queue,
            period=period,
            queue_length=queue_length,
        )

    def _send(self, frame: Frame) -> None:
        assert isinstance(frame, bytes)
        self.sent.append((round(self.clock.time(), 6), frame))

    @property
    def frames(self) -> list[int]:
        return [int(frame) for _, frame in self.sent]

    def offer(self, number: int, at: float) -> None:
        self.clock.advance_to(at)
        self.offer_frame(b"%d" % number)

    def offer_frame(self, frame: bytes) -> None:
        self.throttle.offer(frame, self.clock.time())


def send_queue(clock: FakeClock) -> SendQueue:
    """A client's send queue that may keep 1000 bytes."""
    return SendQueue(print, print, Flusher(clock.call_soon), max_bytes=1000)


@pytest.mark.parametrize(
    ("queue_length", "sent"),
    [
        (0, [0, 3, 6, 9]),
        (1, [0, 2, 5, 8, 11]),
        (5, [0, 1, 2, 4, 7, 8, 9, 10, 11]),
    ],
)
def test_the_same_messages_pass_as_on_rosbridge_suite(queue_length: int, sent: list[int]) -> None:
    throttled = Throttled(queue_length=queue_length)
    for number in range(12):
        throttled.offer(number, at=number / 10)
    throttled.clock.advance(10)
    assert throttled.frames == sent


def test_messages_are_sent_a_period_apart() -> None:
    throttled = Throttled(queue_length=3)
    for number in range(4):
        throttled.offer(number, at=0.1)
    throttled.clock.advance(10)
    assert throttled.sent == [(0.1, b"0"), (0.4, b"1"), (0.7, b"2"), (1.0, b"3")]


def test_a_message_after_a_pause_is_sent_at_once() -> None:
    throttled = Throttled(queue_length=1)
    throttled.offer(0, at=0)
    throttled.offer(1, at=5)
    assert throttled.sent[-1] == (5, b"1")


def test_a_message_may_come_a_millisecond_early() -> None:
    throttled = Throttled(queue_length=0)
    for number, moment in enumerate([0, 0.2985, 0.2995]):
        throttled.offer(number, at=moment)
    assert throttled.frames == [0, 2]


def test_a_late_timer_does_not_let_messages_pass_too_fast() -> None:
    throttled = Throttled(queue_length=5)
    for number in range(4):
        throttled.offer(number, at=0)
    throttled.clock.late = 1.0
    throttled.clock.advance(1.3)
    assert throttled.sent == [(0, b"0"), (1.3, b"1")]
    throttled.clock.late = 0
    throttled.clock.advance(10)
    assert throttled.sent[2:] == [(1.3, b"2"), (1.6, b"3")]


def test_nothing_is_sent_after_cancel() -> None:
    throttled = Throttled(queue_length=5)
    for number in range(3):
        throttled.offer(number, at=0)
    throttled.throttle.cancel()
    throttled.clock.advance(10)
    assert throttled.frames == [0]
    assert throttled.clock.timers == 0


def test_a_throttle_without_a_timer_can_be_cancelled() -> None:
    throttled = Throttled(queue_length=5)
    throttled.throttle.cancel()
    assert throttled.sent == []


def test_a_throttle_without_a_queue_needs_no_timer() -> None:
    throttled = Throttled(queue_length=0)
    for number in range(3):
        throttled.offer(number, at=0)
    assert throttled.clock.timers == 0


def test_the_queue_length_may_be_larger_than_any_memory() -> None:
    throttled = Throttled(queue_length=2**100)
    for number in range(3):
        throttled.offer(number, at=0)
    throttled.clock.advance(10)
    assert throttled.frames == [0, 1, 2]


def test_frames_are_wanted_when_they_would_be_sent_now_or_later() -> None:
    for queue_length, expected in ((0, [True, False, True]), (1, [True, True, True])):
        throttled = Throttled(queue_length=queue_length)
        wanted = []
        for number, moment in enumerate([0, 0.1, 0.3]):
            throttled.clock.advance_to(moment)
            wanted.append(throttled.throttle.wants(moment))
            throttled.offer(number, at=moment)
        assert wanted == expected


def test_all_throttles_of_a_client_stay_within_its_limit_of_bytes() -> None:
    clock = FakeClock()
    queue = send_queue(clock)
    many = [Throttled(queue_length=10, clock=clock, queue=queue) for _ in range(100)]
    for throttled in many:
        for _ in range(3):
            throttled.offer_frame(bytes(300))
            assert queue.throttled_bytes <= 1000
    clock.advance(10)
    assert (queue.throttled_bytes, clock.timers) == (0, 0)
    assert sum(len(throttled.sent) for throttled in many) == 100 + 3


def test_a_throttle_without_room_goes_on_once_there_is_room() -> None:
    throttled = Throttled(queue_length=10)
    throttled.offer(0, at=0)
    throttled.queue.throttled_bytes = 1000
    throttled.offer(1, at=0.1)
    assert (throttled.queue.throttled_bytes, throttled.clock.timers) == (1000, 0)
    throttled.queue.throttled_bytes = 0
    throttled.offer(2, at=0.2)
    throttled.offer(3, at=1)
    assert throttled.sent == [(0, b"0"), (0.3, b"2"), (1, b"3")]


def test_a_throttle_whose_frames_were_all_dropped_goes_on_after_its_timer() -> None:
    throttled = Throttled(queue_length=10)
    throttled.offer(0, at=0)
    throttled.offer(1, at=0.1)
    others = 995
    throttled.queue.throttled_bytes += others
    throttled.offer_frame(b"much too large")
    assert (throttled.queue.throttled_bytes, throttled.clock.timers) == (others, 1)
    throttled.clock.advance_to(0.3)
    assert (throttled.frames, throttled.clock.timers) == ([0], 0)
    throttled.queue.throttled_bytes -= others
    throttled.offer(2, at=1)
    assert throttled.sent[1:] == [(1, b"2")]


def test_frames_that_wait_in_the_send_queue_leave_less_room_for_those_of_throttles() -> None:
    throttled = Throttled(queue_length=10)
    throttled.queue.pause()
    throttled.queue.reply(bytes(999))
    for number in range(5):
        throttled.offer(number, at=0)
    assert throttled.queue.throttled_bytes == 1
    throttled.clock.advance(10)
    assert throttled.frames == [0, 4]


def test_a_frame_larger_than_the_limit_waits_alone() -> None:
    throttled = Throttled(queue_length=10)
    large = bytes(5000)
    for frame in (b"0", b"1", large):
        throttled.offer_frame(frame)
    assert throttled.queue.throttled_bytes == len(large)
    throttled.offer_frame(b"2")
    assert throttled.queue.throttled_bytes == 1
    throttled.clock.advance(10)
    assert throttled.sent[1:] == [(0.3, b"2")]
    assert throttled.queue.throttled_bytes == 0


def test_a_cancelled_throttle_frees_its_bytes() -> None:
    throttled = Throttled(queue_length=10)
    for number in range(5):
        throttled.offer(number, at=0)
    assert throttled.queue.throttled_bytes == 4
    throttled.throttle.cancel()
    assert throttled.queue.throttled_bytes == 0
