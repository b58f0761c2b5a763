"""No message is lost on its way to the loop, and publishers wait as in ROS."""

from __future__ import annotations

import asyncio
import threading
from collections.abc import Callable
from typing import Any, cast

import pytest
from rospy import core, outgoing_queue
from rospy.outgoing_queue import LIMIT, OutgoingQueue

import fibws
from fibws.errors import OperationRejected


class Background:
    """The node's, with the test's own loop."""

    def __init__(self) -> None:
        self.loop: asyncio.AbstractEventLoop | None = asyncio.get_running_loop()
        self.loop_lock = self
        self.open = False
        """Whether the loop counts as asleep."""

    def try_acquire(self) -> bool:
        return self.open

    def release(self) -> None:
        pass

    def soon(self, function: Callable[..., object]) -> bool:
        if self.loop is not None:
            self.loop.call_soon_threadsafe(function)
        return self.loop is not None

    def finish_before_end(self, task: asyncio.Task[None]) -> None:
        self.unfinished = task


class Sender:
    """A publisher, and its connection."""

    def __init__(self) -> None:
        self.sent: list[bytes] = []
        self.fault: Exception | None = None
        self.idle = True
        self._vacant = asyncio.Event()
        self._vacant.set()

    @property
    def _has_room(self) -> bool:
        return self._vacant.is_set()

    @property
    def _is_idle(self) -> bool:
        return self.idle

    async def _room(self) -> None:
        await self._vacant.wait()

    def _send(self, frame: bytes) -> None:
        if self.fault is not None:
            raise self.fault
        self.sent.append(frame)

    def fill(self) -> None:
        self._vacant.clear()

    def drain(self) -> None:
        self._vacant.set()


@pytest.fixture
async def background(monkeypatch: pytest.MonkeyPatch) -> Background:
    found = Background()
    monkeypatch.setattr(core, "background", found)
    return found


def make(sender: Sender, lossless: bool = False) -> OutgoingQueue:
    return OutgoingQueue(cast("fibws.Publisher[Any, ...]", sender), lossless=lossless)


def frames(count: int) -> list[bytes]:
    return [b"%d" % number for number in range(count)]


def in_a_thread(queue: OutgoingQueue, count: int) -> threading.Thread:
    def put_all() -> None:
        for frame in frames(count):
            queue.put(frame)

    thread = threading.Thread(target=put_all, daemon=True)
    thread.start()
    return thread


async def test_all_messages_arrive_in_order(background: Background) -> None:
    sender = Sender()
    queue = make(sender)
    thread = in_a_thread(queue, 20 * LIMIT)
    await asyncio.to_thread(thread.join)
    await queue.flush()
    assert sender.sent == frames(20 * LIMIT)


async def test_busy_loop_makes_the_publisher_wait(background: Background) -> None:
    sender = Sender()
    thread = in_a_thread(make(sender), LIMIT + 2)
    thread.join(0.2)
    assert thread.is_alive()
    await asyncio.to_thread(thread.join)
    assert len(sender.sent) == LIMIT + 2


async def test_slow_network_holds_up_only_a_lossless_publisher(
    background: Background, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(outgoing_queue, "PATIENCE", 0.01)
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
    await hasty.flush()
    await lossless.flush()
    assert patient.sent == sender.sent == frames(3 * LIMIT), "the publisher's queue drops messages"


async def test_network_recovers(background: Background, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(outgoing_queue, "PATIENCE", 0.01)
    sender = Sender()
    queue = make(sender)
    sender.fill()
    queue.put(b"slow")
    await queue.flush()
    sender.drain()
    queue.put(b"fast")
    await queue.flush()
    assert sender.sent == [b"slow", b"fast"]


async def test_refused_publisher_holds_up_nothing(background: Background) -> None:
    sender = Sender()
    queue = make(sender)
    sender.fault = OperationRejected("no")
    queue.put(b"in vain")
    await queue.flush()
    sender.fault = None
    queue.put(b"heard")
    await queue.flush()
    assert sender.sent == [b"heard"]


async def test_another_publisher_sends_the_queued_messages(background: Background) -> None:
    sender, other = Sender(), Sender()
    queue = make(sender, lossless=True)
    sender.fill()
    queue.put(b"left")
    queue.use(cast("fibws.Publisher[Any, ...]", other), lossless=False)
    await queue.flush()
    assert other.sent == [b"left"]


async def test_nothing_is_queued_without_a_loop(background: Background) -> None:
    background.loop = None
    queue = make(Sender())
    for frame in frames(2 * LIMIT):
        queue.put(frame)


async def test_message_is_sent_at_once_while_the_loop_sleeps(background: Background) -> None:
    sender = Sender()
    queue = make(sender)
    background.open = True
    queue.put(b"1")
    assert sender.sent == [b"1"]
    sender.fill()
    queue.put(b"2")
    assert sender.sent == [b"1"], "there is no room"
    sender.drain()
    background.open = True
    queue.put(b"3")
    assert sender.sent == [b"1"], "the one before waits"
    await queue.flush()
    assert sender.sent == [b"1", b"2", b"3"]


async def test_loop_is_woken_for_a_frame_that_the_socket_did_not_take(
    background: Background, monkeypatch: pytest.MonkeyPatch
) -> None:
    sender = Sender()
    background.open = True
    woken: list[Callable[..., object]] = []
    monkeypatch.setattr(background, "soon", woken.append)
    queue = make(sender)
    queue.put(b"1")
    assert not woken
    sender.idle = False
    queue.put(b"2")
    assert len(woken) == 1
    assert sender.sent == [b"1", b"2"]
