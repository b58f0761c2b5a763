"""The threads between zenoh and the event loop."""

from __future__ import annotations

import asyncio
import threading
from collections.abc import Iterator
from functools import partial

import pytest
from patience import PATIENCE

from fibws.hub import zenoh_session
from fibws.hub.zenoh_session import LANE_BYTES, LARGE, Inbox, Receivers, ZenohLane, ZenohLanes


async def test_inbox_drops_the_oldest_messages_and_no_other_calls() -> None:
    inbox = Inbox(asyncio.get_running_loop(), limit=300)
    arrived: list[object] = []
    done = asyncio.Event()
    inbox.put(arrived.append, "token")
    for number in range(5):
        inbox.put(arrived.append, number, size=100)
    inbox.put(arrived.append, "token gone")
    inbox.put(done.set)
    await done.wait()
    assert arrived == ["token", 2, 3, 4, "token gone"]
    assert inbox.dropped == 2


async def test_inbox_keeps_the_newest_message_however_large_it_is() -> None:
    inbox = Inbox(asyncio.get_running_loop(), limit=300)
    arrived: list[object] = []
    done = asyncio.Event()
    for number in range(3):
        inbox.put(arrived.append, number, size=1000)
    inbox.put(done.set)
    await done.wait()
    assert arrived == [2]
    inbox.put(arrived.append, "next", size=300)
    done.clear()
    inbox.put(done.set)
    await done.wait()
    assert arrived == [2, "next"]


class Sending:
    """Lanes, and what they have sent.

    Attributes:
        go_on: lets the jobs of `stuck` end.
    """

    def __init__(self) -> None:
        self.dropped = 0
        self.lanes = ZenohLanes("test", 10 * LANE_BYTES, self.note_dropped)
        self.sent: list[object] = []
        self.go_on = threading.Event()
        self.is_stuck = threading.Event()

    def note_dropped(self) -> None:
        self.dropped += 1

    def lane(self) -> ZenohLane:
        lane = ZenohLane()
        self.lanes.open(lane)
        return lane

    def send(self, lane: ZenohLane, name: object, size: int = 1, limit: int = 1000) -> None:
        self.lanes.send(lane, partial(self.sent.append, name), size, limit)

    def stick(self, lane: ZenohLane, size: int = 1) -> None:
        """Send a message that takes long."""

        def job() -> None:
            self.is_stuck.set()
            self.go_on.wait(PATIENCE)

        self.lanes.send(lane, job, size, 1)
        assert self.is_stuck.wait(PATIENCE)

    def wait(self, lane: ZenohLane) -> None:
        """Wait until all messages of a publisher are sent."""
        done = threading.Event()
        self.lanes.send(lane, done.set, 1, 1000)
        assert done.wait(PATIENCE)


@pytest.fixture
def sending() -> Iterator[Sending]:
    found = Sending()
    found.lanes.start()
    yield found
    found.go_on.set()
    found.lanes.close()
    found.lanes.join(PATIENCE)


def test_large_and_small_messages_of_a_publisher_are_sent_in_order(sending: Sending) -> None:
    lane = sending.lane()
    sizes = [1, LARGE, 1, 1, LARGE, LARGE, 1] * 5
    for number, size in enumerate(sizes):
        sending.send(lane, number, size)
    sending.wait(lane)
    assert sending.sent == list(range(len(sizes)))


def test_small_message_does_not_wait_for_a_large_one_of_another_publisher(
    sending: Sending,
) -> None:
    sending.stick(sending.lane(), LARGE)
    other = sending.lane()
    sending.send(other, "small")
    sending.wait(other)
    assert sending.sent == ["small"]


def test_small_message_waits_for_a_large_one_of_its_publisher(sending: Sending) -> None:
    lane, other = sending.lane(), sending.lane()
    sending.stick(lane, LARGE)
    sending.send(lane, "next")
    sending.wait(other)
    assert not sending.sent
    sending.go_on.set()
    sending.wait(lane)
    assert sending.sent == ["next"]


def test_messages_wait_for_the_declaration_of_their_publisher_alone(sending: Sending) -> None:
    early, other = ZenohLane(), sending.lane()
    sending.send(early, "early")
    sending.wait(other)
    assert not sending.sent
    sending.lanes.open(early)
    sending.wait(early)
    assert sending.sent == ["early"]


def test_small_messages_of_all_publishers_stay_in_order(sending: Sending) -> None:
    first, second, third = sending.lane(), sending.lane(), sending.lane()
    sending.stick(first)
    for lane, name in ((second, "a1"), (second, "a2"), (third, "b1"), (second, "a3")):
        sending.send(lane, name)
    sending.go_on.set()
    for lane in (second, third):
        sending.wait(lane)
    assert sending.sent == ["a1", "a2", "b1", "a3"]


def test_oldest_messages_of_a_publisher_are_dropped_beyond_its_limit(sending: Sending) -> None:
    lane, other = sending.lane(), sending.lane()
    sending.stick(lane)
    sending.send(other, "of another")
    for number in range(5):
        sending.send(lane, number, limit=2)
    sending.go_on.set()
    for each in (lane, other):
        sending.wait(each)
    assert sending.sent == ["of another", 3, 4]
    assert sending.dropped == 3


def test_oldest_messages_of_a_publisher_are_dropped_beyond_its_bytes(sending: Sending) -> None:
    lane = sending.lane()
    sending.stick(lane)
    for number in range(4):
        sending.send(lane, number, LANE_BYTES // 2)
    sending.send(lane, "huge", 3 * LANE_BYTES)
    sending.go_on.set()
    sending.lanes.drain(lane)
    assert sending.sent == ["huge"]


def test_what_waits_is_sent_at_the_end(sending: Sending) -> None:
    lane = sending.lane()
    sending.stick(lane, LARGE)
    sending.send(lane, "large", LARGE)
    sending.send(lane, "small")
    sending.lanes.close()
    sending.go_on.set()
    sending.lanes.join(PATIENCE)
    assert sending.sent == ["large", "small"]


def test_message_that_cannot_be_sent_is_logged_and_the_next_one_sent(
    sending: Sending, caplog: pytest.LogCaptureFixture
) -> None:
    def fail() -> None:
        raise ValueError("no session")

    lane = sending.lane()
    sending.lanes.send(lane, fail, 1, 1)
    sending.wait(lane)
    assert "zenoh: no session" in caplog.text


@pytest.fixture
def receivers() -> Iterator[Receivers]:
    found = Receivers("test")
    yield found
    found.close()
    found.join(PATIENCE)


def test_receiver_that_stands_still_delays_no_other_and_has_its_calls_in_order(
    receivers: Receivers,
) -> None:
    go_on, is_stuck, is_done = threading.Event(), threading.Event(), threading.Event()
    made: list[object] = []

    def wait() -> None:
        is_stuck.set()
        go_on.wait(PATIENCE)

    receivers.call("still", wait, 10)
    assert is_stuck.wait(PATIENCE)
    for number in range(3):
        receivers.call("still", partial(made.append, number), 1)
    other = threading.Event()
    receivers.call("other", other.set)
    assert other.wait(PATIENCE)
    assert made == []
    assert (receivers.waiting("still"), receivers.waiting("other"), receivers.bytes) == (13, 0, 13)
    receivers.call("still", is_done.set)
    go_on.set()
    assert is_done.wait(PATIENCE)
    assert made == [0, 1, 2]


def test_calls_for_a_receiver_that_is_gone_are_dropped(receivers: Receivers) -> None:
    go_on, is_stuck, is_done = threading.Event(), threading.Event(), threading.Event()
    made: list[object] = []

    def wait() -> None:
        is_stuck.set()
        go_on.wait(PATIENCE)

    receivers.call("gone", wait, 10)
    assert is_stuck.wait(PATIENCE)
    receivers.call("gone", partial(made.append, 1), 5)
    receivers.forget("gone")
    assert receivers.bytes == 10
    go_on.set()
    receivers.call("gone", is_done.set)
    assert is_done.wait(PATIENCE)
    assert made == []


def test_threads_of_receivers_end_when_nothing_waits(
    receivers: Receivers, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(zenoh_session, "LINGER", 0.0)
    for number in range(5):
        receivers.call(number, lambda: None, 1)
    receivers.join(PATIENCE)
    assert receivers._jobs == {} and receivers.bytes == 0 and not receivers._bytes
