"""The frames that a node has yet to write to its socket."""

from __future__ import annotations

import asyncio
import threading
from itertools import pairwise

import pytest

from fibws.node.outgoing_queue import CHUNK, FRAME_COST, TURN, OutgoingQueue, PublisherLane


def lane(queue_size: int = 2, topic: str = "/t") -> PublisherLane:
    return PublisherLane(queue_size, topic, lambda frame: frame)


class Socket:
    """Takes frames, each write as a list."""

    def __init__(self, queue: OutgoingQueue) -> None:
        self.writes: list[list[bytes]] = []
        self.is_behind = False
        self.falls_behind = False
        self._queue = queue

    def write(self, frame: bytes, lane: PublisherLane | None) -> None:
        self.writes.append([frame])
        if self.falls_behind:
            self._queue.pause()

    def write_joined(self, frames: list[tuple[bytes, PublisherLane | None]]) -> None:
        self.writes.append([frame for frame, _ in frames])

    @property
    def frames(self) -> list[bytes]:
        return [frame for write in self.writes for frame in write]


def connected(queue: OutgoingQueue, *, paused: bool = False, hold: bool = False) -> Socket:
    socket = Socket(queue)
    queue.connect(socket, hold=hold)
    if paused:
        queue.pause()
    return socket


async def turn() -> None:
    """Run the ready callbacks of the loop."""
    await asyncio.sleep(0)


async def test_first_frame_of_a_turn_is_written_at_once_and_the_others_together() -> None:
    queue = OutgoingQueue()
    socket = connected(queue)
    for frame in (b"1", b"2", b"3"):
        queue.put(frame, lane())
    assert socket.writes == [[b"1"]]
    assert queue.size
    await turn()
    assert socket.writes == [[b"1"], [b"2", b"3"]]
    assert not queue.size
    queue.put(b"4")
    assert socket.writes[2:] == [[b"4"]]


async def test_large_frames_are_not_joined_with_others() -> None:
    queue = OutgoingQueue()
    socket = connected(queue)
    large = bytes(CHUNK)
    for frame in (b"1", b"2", large, b"3", b"4"):
        queue.put(frame)
    await turn()
    assert socket.writes == [[b"1"], [b"2"], [large], [b"3", b"4"]]


async def test_frames_wait_in_order_while_the_socket_is_behind() -> None:
    queue, first, second = OutgoingQueue(), lane(), lane()
    socket = connected(queue, paused=True)
    for frame, source in ((b"1", first), (b"2", None), (b"3", second), (b"4", first)):
        queue.put(frame, source)
    await turn()
    assert socket.writes == []
    queue.resume()
    assert socket.frames == [b"1", b"2", b"3", b"4"]
    assert not first.waiting


async def test_writing_stops_when_the_socket_falls_behind() -> None:
    queue = OutgoingQueue()
    socket = connected(queue, paused=True)
    socket.falls_behind = True
    for _ in range(3):
        queue.put(bytes(CHUNK))
    for written in (1, 2, 3):
        queue.resume()
        assert len(socket.writes) == written


async def test_each_publisher_keeps_its_newest_messages_without_a_hub() -> None:
    queue, first, second = OutgoingQueue(), lane(2), lane(1)
    for number in range(4):
        queue.put(b"first %d" % number, first)
        queue.put(b"second %d" % number, second)
    assert (first.dropped, second.dropped) == (2, 3)
    assert connected(queue).frames == [b"first 2", b"first 3", b"second 3"]


async def test_nothing_is_dropped_below_the_limit() -> None:
    queue, publisher = OutgoingQueue(), lane(1)
    socket = connected(queue, paused=True)
    for number in range(5):
        queue.put(b"%d" % number, publisher)
    assert publisher.dropped == 0
    queue.resume()
    assert socket.frames == [b"0", b"1", b"2", b"3", b"4"]


async def test_newest_messages_of_publishers_that_do_not_wait_are_kept_above_the_limit() -> None:
    queue, publisher = OutgoingQueue(limit=3 * FRAME_COST), lane(2)
    socket = connected(queue, paused=True)
    for number in range(4):
        queue.put(b"%d" % number, publisher)
    assert publisher.dropped == 2
    queue.resume()
    assert socket.frames == [b"2", b"3"]


async def test_operations_are_void_and_newest_messages_kept_when_the_hub_is_lost() -> None:
    queue, first, closed = OutgoingQueue(), lane(2), lane(2)
    connected(queue, paused=True)
    for number in range(3):
        queue.put(b"first %d" % number, first)
        queue.put(b"closed %d" % number, closed)
        queue.put(b"operation %d" % number)
    closed.limit = 0
    queue.disconnect()
    queue.disconnect()
    assert not queue.connected
    assert (first.dropped, closed.dropped) == (1, 3)
    assert connected(queue).frames == [b"first 1", b"first 2"]


async def test_frames_wait_until_they_are_released() -> None:
    queue = OutgoingQueue()
    queue.put(b"1", lane())
    socket = Socket(queue)
    queue.connect(socket, [(b"registration", None)], hold=True)
    queue.put(b"2")
    queue.resume()
    await turn()
    assert socket.frames == [b"registration"]
    queue.release()
    assert socket.frames == [b"registration", b"1", b"2"]


async def test_many_registrations_are_written_in_chunks() -> None:
    queue = OutgoingQueue()
    socket = Socket(queue)
    queue.connect(socket, [(bytes(CHUNK // 2), None) for _ in range(5)])
    assert [len(write) for write in socket.writes] == [2, 2, 1]


async def test_unsent_messages_are_counted_by_topic() -> None:
    queue, publisher = OutgoingQueue(), lane()
    connected(queue, paused=True)
    for frame, source in ((b"operation", None), (b"1", publisher), (b"2", publisher)):
        queue.put(frame, source)
    assert queue.unsent() == {"/t": 2}
    assert len(queue) == 3


async def test_publisher_waits_for_room() -> None:
    queue = OutgoingQueue(limit=2 * FRAME_COST)
    socket = connected(queue, paused=True)
    queue.put(b"1")
    await queue.room()
    queue.put(b"2")
    waiting = [asyncio.create_task(queue.room()) for _ in range(2)]
    await turn()
    await turn()
    assert not any(task.done() for task in waiting)
    queue.resume()
    await asyncio.gather(*waiting)
    assert socket.frames == [b"1", b"2"]


@pytest.mark.parametrize("end", ["disconnect", "close"])
async def test_nobody_waits_for_room_after_the_end(end: str) -> None:
    queue = OutgoingQueue(limit=1)
    connected(queue, paused=True)
    queue.put(b"1", lane())
    waiting = asyncio.create_task(queue.room())
    await turn()
    getattr(queue, end)()
    await waiting


@pytest.mark.parametrize("has_hub", [True, False])
async def test_publishing_gives_other_tasks_their_turns(has_hub: bool) -> None:
    queue, publisher = OutgoingQueue(), lane(10_000)
    if has_hub:
        connected(queue)
    turns: list[int] = []
    count = 0

    async def other() -> None:
        while True:
            turns.append(count)
            await asyncio.sleep(0)

    task = asyncio.create_task(other())
    while count < 1000:
        if not queue.ready:
            await queue.room()
        queue.put(b"x", publisher)
        count += 1
    task.cancel()
    gaps = [after - before for before, after in pairwise(turns)]
    assert max(gaps) <= TURN
    assert turns[-1] >= 1000 - 2 * TURN


async def test_end_is_reached_when_all_is_written() -> None:
    queue = OutgoingQueue()
    connected(queue, paused=True)
    queue.put(b"1")
    waiting = asyncio.create_task(queue.emptied())
    queue.close()
    await turn()
    assert not waiting.done()
    queue.resume()
    await waiting


async def test_end_is_reached_when_the_hub_is_lost() -> None:
    queue = OutgoingQueue()
    connected(queue)
    waiting = asyncio.create_task(queue.emptied())
    await turn()
    assert not waiting.done()
    queue.disconnect()
    await waiting


async def test_hub_is_waited_for() -> None:
    queue = OutgoingQueue()
    waiting = asyncio.create_task(queue.wait_for_hub())
    await turn()
    assert not waiting.done()
    connected(queue)
    await waiting


def in_another_thread(queue: OutgoingQueue, *frames: bytes) -> None:
    """Put frames while the loop, whose thread waits for the other one, sleeps."""

    def put() -> None:
        for frame in frames:
            queue.put(frame, lane())

    thread = threading.Thread(target=put)
    thread.start()
    thread.join()


async def test_another_thread_writes_at_once_while_the_loop_sleeps() -> None:
    queue = OutgoingQueue()
    socket = connected(queue)
    in_another_thread(queue, b"1", b"2")
    assert socket.writes == [[b"1"], [b"2"]]
    assert not queue.size


async def test_another_thread_wakes_the_loop_only_if_the_socket_is_behind(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    queue = OutgoingQueue()
    socket = connected(queue)
    woken: list[object] = []
    with monkeypatch.context() as patch:
        loop = asyncio.get_running_loop()
        patch.setattr(queue, "_loop", type("Loop", (), {"call_soon_threadsafe": woken.append}))
        assert loop is not None
        in_another_thread(queue, b"1")
        assert not woken
        socket.is_behind = True
        in_another_thread(queue, b"2")
        assert len(woken) == 1


async def test_another_thread_queues_behind_what_waits() -> None:
    queue = OutgoingQueue()
    socket = connected(queue)
    queue.put(b"1")
    queue.put(b"2")
    in_another_thread(queue, b"3")
    await turn()
    assert socket.frames == [b"1", b"2", b"3"]
    queue.pause()
    in_another_thread(queue, b"4")
    queue.resume()
    assert socket.frames[3:] == [b"4"]
