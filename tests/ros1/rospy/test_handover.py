"""No message is lost on its way to the loop, and who publishes waits as in ROS."""

from __future__ import annotations

import asyncio
import threading
from collections.abc import Callable
from typing import Any, cast

import pytest
from rospy import core, handover
from rospy.handover import LIMIT, Handover

import fibws
from fibws.errors import OperationRejected


class Background:
    """The node's, with the test's own loop."""

    def __init__(self) -> None:
        self.loop: asyncio.AbstractEventLoop | None = asyncio.get_running_loop()
        self.gate = self
        self.open = False
        """Whether the loop counts as asleep."""

    def enter(self) -> bool:
        return self.open

    def leave(self) -> None:
        pass

    def soon(self, function: Callable[..., object]) -> bool:
        if self.loop is not None:
            self.loop.call_soon_threadsafe(function)
        return self.loop is not None


class Sender:
    """A publisher, and its connection."""

    def __init__(self) -> None:
        self.sent: list[bytes] = []
        self.fault: Exception | None = None
        self.idle = True
        self._room = asyncio.Event()
        self._room.set()

    @property
    def has_room(self) -> bool:
        return self._room.is_set()

    @property
    def is_idle(self) -> bool:
        return self.idle

    async def room(self) -> None:
        await self._room.wait()

    def send(self, text: bytes) -> None:
        if self.fault is not None:
            raise self.fault
        self.sent.append(text)

    def fill(self) -> None:
        self._room.clear()

    def drain(self) -> None:
        self._room.set()


@pytest.fixture
async def background(monkeypatch: pytest.MonkeyPatch) -> Background:
    found = Background()
    monkeypatch.setattr(core, "background", found)
    return found


def make(sender: Sender, lossless: bool = False) -> Handover:
    return Handover(cast("fibws.Publisher[Any, ...]", sender), lossless=lossless)


def texts(count: int) -> list[bytes]:
    return [b"%d" % number for number in range(count)]


def in_a_thread(way: Handover, count: int) -> threading.Thread:
    def put_all() -> None:
        for text in texts(count):
            way.put(text)

    thread = threading.Thread(target=put_all, daemon=True)
    thread.start()
    return thread


async def test_all_arrives_in_order(background: Background) -> None:
    sender = Sender()
    way = make(sender)
    thread = in_a_thread(way, 20 * LIMIT)
    await asyncio.to_thread(thread.join)
    await way.finish()
    assert sender.sent == texts(20 * LIMIT)


async def test_a_busy_loop_makes_the_publisher_wait(background: Background) -> None:
    sender = Sender()
    thread = in_a_thread(make(sender), LIMIT + 2)
    thread.join(0.2)
    assert thread.is_alive()
    await asyncio.to_thread(thread.join)
    assert len(sender.sent) == LIMIT + 2


async def test_a_slow_network_holds_up_only_who_has_no_queue(
    background: Background, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(handover, "PATIENCE", 0.01)
    sender, patient = Sender(), Sender()
    sender.fill()
    patient.fill()
    hasty, lossless = make(sender), make(patient, lossless=True)
    thread, waiting = in_a_thread(hasty, 3 * LIMIT), in_a_thread(lossless, 3 * LIMIT)
    await asyncio.to_thread(thread.join)
    assert waiting.is_alive()
    assert patient.sent == []
    patient.drain()
    await asyncio.to_thread(waiting.join)
    await hasty.finish()
    await lossless.finish()
    assert patient.sent == sender.sent == texts(3 * LIMIT), "the outbox sees to what is dropped"


async def test_the_network_may_be_fast_again(
    background: Background, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(handover, "PATIENCE", 0.01)
    sender = Sender()
    way = make(sender)
    sender.fill()
    way.put(b"slow")
    await way.finish()
    sender.drain()
    way.put(b"fast")
    await way.finish()
    assert sender.sent == [b"slow", b"fast"]


async def test_a_refused_publisher_holds_nobody_up(background: Background) -> None:
    sender = Sender()
    way = make(sender)
    sender.fault = OperationRejected("no")
    way.put(b"in vain")
    await way.finish()
    sender.fault = None
    way.put(b"heard")
    await way.finish()
    assert sender.sent == [b"heard"]


async def test_another_publisher_sends_what_is_left(background: Background) -> None:
    sender, other = Sender(), Sender()
    way = make(sender, lossless=True)
    sender.fill()
    way.put(b"left")
    way.use(cast("fibws.Publisher[Any, ...]", other), lossless=False)
    await way.finish()
    assert other.sent == [b"left"]


async def test_without_a_loop_nothing_is_kept(background: Background) -> None:
    background.loop = None
    way = make(Sender())
    for text in texts(2 * LIMIT):
        way.put(text)


async def test_while_the_loop_sleeps_a_message_is_sent_at_once(background: Background) -> None:
    sender = Sender()
    taker = make(sender)
    background.open = True
    taker.put(b"1")
    assert sender.sent == [b"1"]
    sender.fill()
    taker.put(b"2")
    assert sender.sent == [b"1"], "there is no room"
    sender.drain()
    background.open = True
    taker.put(b"3")
    assert sender.sent == [b"1"], "the one before waits"
    await taker.finish()
    assert sender.sent == [b"1", b"2", b"3"]


async def test_the_loop_is_woken_for_what_does_not_leave_at_once(
    background: Background, monkeypatch: pytest.MonkeyPatch
) -> None:
    sender = Sender()
    background.open = True
    woken: list[Callable[..., object]] = []
    monkeypatch.setattr(background, "soon", woken.append)
    taker = make(sender)
    taker.put(b"1")
    assert not woken
    sender.idle = False
    taker.put(b"2")
    assert len(woken) == 1
    assert sender.sent == [b"1", b"2"]
