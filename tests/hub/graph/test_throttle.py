"""At most one message in a period."""

from __future__ import annotations

import pytest

from fibws.hub.budget import Budget
from fibws.hub.graph.throttle import Throttle

from ..fakes import FakeClock


class Throttled:
    """A throttle and what it lets through."""

    def __init__(
        self,
        *,
        queue_length: int,
        period: float = 0.3,
        clock: FakeClock | None = None,
        budget: Budget | None = None,
    ) -> None:
        self.clock = clock or FakeClock()
        self.budget = budget or Budget(1000)
        self.sent: list[tuple[float, bytes]] = []
        self.throttle = Throttle(
            lambda frame: self.sent.append((round(self.clock.time(), 6), frame)),
            self.clock,
            period=period,
            queue_length=queue_length,
            budget=self.budget,
        )

    @property
    def frames(self) -> list[int]:
        return [int(frame) for _, frame in self.sent]

    def offer(self, number: int, at: float) -> None:
        self.clock.advance_to(at)
        self.throttle.offer(b"%d" % number)


@pytest.mark.parametrize(
    ("queue_length", "sent"),
    [
        (0, [0, 3, 6, 9]),
        (1, [0, 2, 5, 8, 11]),
        (5, [0, 1, 2, 4, 7, 8, 9, 10, 11]),
    ],
)
def test_of_ten_a_second_those_pass_that_pass_on_the_real_server(
    queue_length: int, sent: list[int]
) -> None:
    throttled = Throttled(queue_length=queue_length)
    for number in range(12):
        throttled.offer(number, at=number / 10)
    throttled.clock.advance(10)
    assert throttled.frames == sent


def test_two_messages_are_a_period_apart() -> None:
    throttled = Throttled(queue_length=3)
    for number in range(4):
        throttled.offer(number, at=0.1)
    throttled.clock.advance(10)
    assert throttled.sent == [(0.1, b"0"), (0.4, b"1"), (0.7, b"2"), (1.0, b"3")]


def test_a_message_that_comes_late_is_sent_at_once() -> None:
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


def test_nothing_is_sent_once_it_is_cancelled() -> None:
    throttled = Throttled(queue_length=5)
    for number in range(3):
        throttled.offer(number, at=0)
    throttled.throttle.cancel()
    throttled.clock.advance(10)
    assert throttled.frames == [0]
    assert throttled.clock.timers == 0


def test_one_that_never_had_to_wait_can_be_cancelled() -> None:
    throttled = Throttled(queue_length=5)
    throttled.throttle.cancel()
    assert throttled.sent == []


def test_without_a_queue_it_needs_no_timer() -> None:
    throttled = Throttled(queue_length=0)
    for number in range(3):
        throttled.offer(number, at=0)
    assert throttled.clock.timers == 0


def test_a_queue_may_be_called_longer_than_there_is_memory() -> None:
    throttled = Throttled(queue_length=2**100)
    for number in range(3):
        throttled.offer(number, at=0)
    throttled.clock.advance(10)
    assert throttled.frames == [0, 1, 2]


def test_the_budget_holds_over_many_throttles() -> None:
    clock, budget = FakeClock(), Budget(1000)
    many = [Throttled(queue_length=10, clock=clock, budget=budget) for _ in range(100)]
    for throttled in many:
        for _ in range(3):
            throttled.throttle.offer(bytes(300))
            assert budget.used <= 1000
    clock.advance(10)
    assert budget.used == 0
    assert clock.timers == 0
    assert sum(len(throttled.sent) for throttled in many) == 100 + 3


def test_one_that_may_keep_nothing_goes_on_when_others_let_go() -> None:
    clock, budget = FakeClock(), Budget(1000)
    throttled = Throttled(queue_length=10, clock=clock, budget=budget)
    throttled.offer(0, at=0)
    budget.used = 1000
    throttled.offer(1, at=0.1)
    assert (budget.used, clock.timers) == (1000, 0)
    budget.used = 0
    throttled.offer(2, at=0.2)
    throttled.offer(3, at=1)
    assert throttled.sent == [(0, b"0"), (0.3, b"2"), (1, b"3")]


def test_one_whose_messages_made_way_goes_on_after_its_timer() -> None:
    throttled = Throttled(queue_length=10)
    throttled.offer(0, at=0)
    throttled.offer(1, at=0.1)
    others = 995
    throttled.budget.used += others
    throttled.throttle.offer(b"much too large")
    assert (throttled.budget.used, throttled.clock.timers) == (others, 1)
    throttled.clock.advance_to(0.3)
    assert (throttled.frames, throttled.clock.timers) == ([0], 0)
    throttled.budget.used -= others
    throttled.offer(2, at=1)
    assert throttled.sent[1:] == [(1, b"2")]


def test_a_message_that_alone_breaks_the_budget_may_wait() -> None:
    throttled = Throttled(queue_length=10)
    large = bytes(5000)
    for frame in (b"0", b"1", large):
        throttled.throttle.offer(frame)
    assert throttled.budget.used == len(large)
    throttled.throttle.offer(b"2")
    throttled.clock.advance(10)
    assert throttled.sent[1:] == [(0.3, b"2")]
    assert throttled.budget.used == 0
