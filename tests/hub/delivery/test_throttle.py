"""Throttles: at most one message in a period."""

from __future__ import annotations

from collections import deque

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fibws.hub.delivery.fan_out import FanOut
from fibws.hub.delivery.send_queue import Flusher, Frame, SendQueue
from fibws.hub.delivery.throttle import Throttle, Throttling
from fibws.protocol.frame_queue import Lane

from ..fakes import FakeClock


class Throttled:
    """A throttle of one member, and the frames that it lets pass."""

    def __init__(
        self,
        *,
        queue_length: int,
        period: float = 0.3,
        clock: FakeClock | None = None,
        queue: RecordedQueue | None = None,
    ) -> None:
        self.clock = clock or FakeClock()
        self.queue = queue or RecordedQueue(self.clock)
        throttling = Throttling(period, queue_length)
        self.member = Subscriber(self.queue, throttling)
        self.throttle = Throttle(self.member, throttling, self.clock)

    @property
    def sent(self) -> list[tuple[float, bytes]]:
        """The frames that were sent, each with its time."""
        return self.queue.sent

    @property
    def frames(self) -> list[int]:
        return [int(frame) for _, frame in self.sent]

    def offer(self, number: int, at: float) -> None:
        self.clock.advance_to(at)
        self.offer_frame(b"%d" % number)

    def offer_frame(self, frame: bytes) -> None:
        self.throttle.offer(frame)


class RecordedQueue(SendQueue):
    """A client's send queue that may keep 1000 bytes; records what is put into it."""

    def __init__(self, clock: FakeClock) -> None:
        super().__init__(print, print, Flusher(clock.call_soon), max_bytes=1000)
        self._clock = clock
        self.sent: list[tuple[float, bytes]] = []

    def put(self, frame: Frame, lane: Lane) -> None:
        assert isinstance(frame, bytes)
        self.sent.append((round(self._clock.time(), 6), frame))


class Subscriber:
    """A `Member` of a throttle."""

    def __init__(self, queue: SendQueue, throttling: Throttling | None) -> None:
        self.queue = queue
        self.lane = Lane(1)
        self.throttling = throttling
        self.sent = self.throttled = self.unacknowledged = 0


@pytest.mark.parametrize(
    ("queue_length", "sent"),
    [
        (0, [0, 3, 6, 9]),
        (1, [0, 2, 5, 8, 11]),
        (5, [0, 1, 2, 4, 7, 8, 9, 10, 11]),
    ],
)
def test_same_messages_pass_as_on_rosbridge_suite(queue_length: int, sent: list[int]) -> None:
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


def test_message_after_a_pause_is_sent_at_once() -> None:
    throttled = Throttled(queue_length=1)
    throttled.offer(0, at=0)
    throttled.offer(1, at=5)
    assert throttled.sent[-1] == (5, b"1")


def test_message_may_come_a_millisecond_early() -> None:
    throttled = Throttled(queue_length=0)
    for number, moment in enumerate([0, 0.2985, 0.2995]):
        throttled.offer(number, at=moment)
    assert throttled.frames == [0, 2]


def test_late_timer_does_not_let_messages_pass_too_fast() -> None:
    throttled = Throttled(queue_length=5)
    for number in range(4):
        throttled.offer(number, at=0)
    throttled.clock.late = 1.0
    throttled.clock.advance(1.3)
    assert throttled.sent == [(0, b"0"), (1.3, b"1")]
    throttled.clock.late = 0
    throttled.clock.advance(10)
    assert throttled.sent[2:] == [(1.3, b"2"), (1.6, b"3")]


def test_nothing_is_sent_to_a_member_that_was_removed() -> None:
    throttled = Throttled(queue_length=5)
    for number in range(3):
        throttled.offer(number, at=0)
    throttled.throttle.close()
    throttled.clock.advance(10)
    assert throttled.frames == [0]
    assert throttled.clock.timers == 0


def test_member_can_be_removed_before_any_message() -> None:
    throttled = Throttled(queue_length=5)
    throttled.throttle.close()
    assert throttled.sent == []


def test_throttle_without_a_queue_needs_no_timer() -> None:
    throttled = Throttled(queue_length=0)
    for number in range(3):
        throttled.offer(number, at=0)
    assert throttled.clock.timers == 0


def test_queue_length_may_be_larger_than_any_memory() -> None:
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
            wanted.append(throttled.throttle.wants_from <= moment)
            throttled.offer(number, at=moment)
        assert wanted == expected


def test_all_throttles_of_a_client_stay_within_its_limit_of_bytes() -> None:
    clock = FakeClock()
    queue = RecordedQueue(clock)
    many = [Throttled(queue_length=10, clock=clock, queue=queue) for _ in range(100)]
    for throttled in many:
        for _ in range(3):
            throttled.offer_frame(bytes(300))
            assert queue.throttled_bytes <= 1000
    clock.advance(10)
    assert (queue.throttled_bytes, clock.timers) == (0, 0)
    assert len(queue.sent) == 100 + 3


def test_throttle_without_room_goes_on_once_there_is_room() -> None:
    throttled = Throttled(queue_length=10)
    throttled.offer(0, at=0)
    throttled.queue.throttled_bytes = 1000
    throttled.offer(1, at=0.1)
    assert (throttled.queue.throttled_bytes, throttled.clock.timers) == (1000, 0)
    throttled.queue.throttled_bytes = 0
    throttled.offer(2, at=0.2)
    throttled.offer(3, at=1)
    assert throttled.sent == [(0, b"0"), (0.3, b"2"), (1, b"3")]


def test_throttle_whose_frames_were_all_dropped_goes_on_after_its_timer() -> None:
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


def test_frames_of_throttles_make_room_for_replies() -> None:
    throttled = Throttled(queue_length=4)
    for _ in range(5):
        throttled.offer_frame(bytes(200))
    assert throttled.queue.throttled_bytes == 800
    throttled.queue.pause()
    throttled.queue.reply(bytes(500))
    throttled.offer_frame(bytes(200))
    assert throttled.queue.kept_bytes == 900


def test_frame_larger_than_the_limit_waits_alone() -> None:
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


def test_throttle_without_members_frees_its_bytes() -> None:
    throttled = Throttled(queue_length=10)
    for number in range(5):
        throttled.offer(number, at=0)
    assert throttled.queue.throttled_bytes == 4
    throttled.throttle.close()
    assert throttled.queue.throttled_bytes == 0


# Many members.


class Single:
    """A simple model of a throttle with one member."""

    def __init__(self, throttling: Throttling) -> None:
        self.throttling = throttling
        self.waiting: deque[int] = deque()
        self.due = 0.0
        self.sent: list[tuple[float, int]] = []
        self.throttled = 0

    def advance_to(self, now: float) -> None:
        while self.waiting and self.due <= now:
            self._send(self.due, self.waiting.popleft())

    def offer(self, number: int, now: float) -> None:
        self.advance_to(now)
        if not self.waiting and self.due <= now:
            self._send(now, number)
            return
        self.waiting.append(number)
        while len(self.waiting) > self.throttling.queue_length:
            self.waiting.popleft()
            self.throttled += 1

    def _send(self, now: float, number: int) -> None:
        self.sent.append((now, number))
        self.due = now + self.throttling.period


class Many:
    """A group of throttled members, and the frames that each should get."""

    def __init__(self, throttling: Throttling) -> None:
        self.throttling = throttling
        self.clock = FakeClock()
        self.flusher = Flusher(self.clock.call_soon)
        self.group: FanOut[int, Subscriber] = FanOut(
            lambda number: b"%d" % number, self.flusher, self.clock
        )
        self.numbers = 0
        self.models: dict[Subscriber, Single] = {}
        self.sent: dict[Subscriber, list[tuple[float, int]]] = {}

    def join(self) -> Subscriber:
        sent: list[tuple[float, int]] = []
        queue = SendQueue(
            lambda data: sent.append((self.clock.time(), int(bytes(data)))),
            print,
            self.flusher,
            max_bytes=10**6,
        )
        member = Subscriber(queue, self.throttling)
        self.group.add(member)
        self.models[member] = Single(self.throttling)
        self.sent[member] = sent
        return member

    def advance(self, seconds: float) -> None:
        # Advance in small steps: frames of timers are sent on time.
        for _ in range(round(seconds / STEP)):
            self.clock.advance(STEP)
            self.clock.turn()

    def send(self, to: Subscriber | None = None) -> None:
        self.numbers += 1
        now = self.clock.time()
        if to is None:
            self.group.send(self.numbers)
        else:
            self.group.send_alone(to, b"%d" % self.numbers)
        self.clock.turn()
        for member in self.members() if to is None else [to]:
            self.models[member].offer(self.numbers, now)

    def members(self) -> list[Subscriber]:
        return self.group.members()

    def check(self) -> None:
        for member, model in self.models.items():
            model.advance_to(self.clock.time())
            assert self.sent[member] == model.sent
            assert self.group.sent_to(member) == len(model.sent)
            assert self.group.throttled_for(member) == model.throttled
        assert len(self.group) == len(self.members())

    def leave(self, member: Subscriber) -> None:
        self.group.remove(member)
        model = self.models.pop(member)
        assert self.sent.pop(member) == model.sent
        assert member.sent == len(model.sent)
        assert member.throttled == model.throttled + len(model.waiting)
        assert member.queue.throttled_bytes == 0


STEP = 1 / 16
"""Seconds between two events; floats hold its multiples exactly."""


@given(
    period=st.sampled_from([1, 2, 5]),
    queue_length=st.sampled_from([0, 1, 3]),
    events=st.lists(
        st.tuples(
            st.sampled_from(["send", "send", "send", "join", "leave", "send_to"]),
            st.integers(0, 6),
            st.sampled_from([0, 0, 1, 2, 3, 7]),
        ),
        max_size=60,
    ),
)
def test_each_of_many_members_gets_what_it_would_get_alone(
    period: int, queue_length: int, events: list[tuple[str, int, int]]
) -> None:
    many = Many(Throttling(period * STEP, queue_length))
    members = [many.join(), many.join()]
    for event, which, steps in events:
        if event == "send":
            many.send()
        elif event == "join":
            members.append(many.join())
        elif members and event == "leave":
            many.leave(members.pop(which % len(members)))
        elif members:
            many.send(to=members[which % len(members)])
        many.advance(steps * STEP)
        many.check()
    for member in members:
        many.leave(member)
    assert (len(many.group), many.clock.timers) == (0, 0)
