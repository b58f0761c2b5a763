"""Deferred frames: made for clients that read, in threads if that takes long."""

from __future__ import annotations

import asyncio
import json
import math
import re
import threading
from collections import deque
from collections.abc import Callable
from typing import Any

import pytest
from conftest import StartHub
from hypothesis import strategies as st
from hypothesis.stateful import Bundle, RuleBasedStateMachine, invariant, rule
from protocol.png_reader import read_text

from fibws.hub.delivery import send_queue
from fibws.hub.delivery.deferred import SMALL, DeferredFrame
from fibws.hub.delivery.send_queue import Bytes, Flusher, SendQueue
from fibws.hub.rosbridge import encodings
from fibws.protocol.frame_queue import Lane
from fibws.protocol.png import encode_png

from ..fakes import INT32, STRING, FakeClock, FakeHub, number
from ..raw_client import connected, publish, until


class FakeWorkers:
    """Threads that run when the test calls them."""

    def __init__(self) -> None:
        self.jobs: deque[tuple[Callable[[], object], Callable[[], object]]] = deque()

    def run(self, work: Callable[[], object], done: Callable[[], object], /) -> None:
        self.jobs.append((work, done))

    def finish(self) -> None:
        """Finish the first job."""
        for each in self.jobs.popleft():
            each()

    def finish_all(self) -> None:
        while self.jobs:
            self.finish()


class Hub:
    """Clients with one flusher, and frames that are made of numbers."""

    def __init__(self) -> None:
        self.clock = FakeClock()
        self.workers = FakeWorkers()
        self.flusher = Flusher(self.clock.call_soon, self.workers)
        self.made: list[bytes] = []
        self.faults: list[Exception] = []

    def frame(self, value: int, size: int = SMALL) -> DeferredFrame:
        return DeferredFrame(b"%d;" % value + bytes(size), self._encode, self.faults.append)

    def _encode(self, text: bytes) -> bytes:
        name = text.split(b";")[0]
        if name.startswith(b"-"):
            raise ValueError(name)
        self.made.append(name)
        return b"<%b>" % name

    def client(self, *, max_bytes: int = 100 * SMALL) -> Client:
        return Client(self, max_bytes=max_bytes)


class Client:
    def __init__(self, hub: Hub, *, max_bytes: int) -> None:
        self.hub = hub
        self.writes: list[Bytes] = []
        self.room = math.inf
        self.queue = SendQueue(self._write, print, hub.flusher, max_bytes=max_bytes)

    def _write(self, data: Bytes) -> None:
        self.writes.append(data)
        self.room -= len(data)
        if self.room <= 0:
            self.queue.pause()

    def put(self, lane: Lane, *values: int, size: int = SMALL) -> None:
        for value in values:
            self.queue.put(self.hub.frame(value, size), lane)

    def received(self) -> bytes:
        self.hub.clock.turn()
        data = b"".join(self.writes)
        self.writes.clear()
        return data


@pytest.fixture
def hub() -> Hub:
    return Hub()


def test_small_frame_is_made_at_once(hub: Hub) -> None:
    client = hub.client()
    client.put(Lane(9), 1, 2, size=10)
    assert client.received() == b"<1><2>"
    assert not hub.workers.jobs


def test_large_frame_is_encoded_in_a_thread_and_delays_only_its_lane(hub: Hub) -> None:
    client, lane = hub.client(), Lane(9)
    client.put(lane, 1)
    client.put(lane, 2, size=10)
    client.put(Lane(9), 3, size=10)
    client.queue.put(b"other", Lane(9))
    client.queue.reply(b"reply")
    assert client.received() == b"<3>otherreply"
    assert client.queue.kept_bytes == SMALL + 10 + 4
    hub.workers.finish_all()
    assert client.received() == b"<1><2>"
    assert client.queue.kept_bytes == 0


def test_frame_is_encoded_once_for_all_readers(hub: Hub) -> None:
    clients, frame = [hub.client() for _ in range(3)], hub.frame(1)
    for client in clients:
        client.queue.put(frame, Lane(9))
    hub.workers.finish_all()
    late = hub.client()
    late.queue.put(frame, Lane(9))
    assert [each.received() for each in (*clients, late)] == [b"<1>"] * 4
    assert hub.made == [b"1"]


@pytest.mark.parametrize("size", [10, SMALL])
def test_no_frame_is_encoded_for_a_client_that_does_not_read(hub: Hub, size: int) -> None:
    client, lane = hub.client(), Lane(2)
    client.queue.pause()
    client.put(lane, 1, 2, 3, 4, size=size)
    assert (hub.made, len(hub.workers.jobs)) == ([], 0)
    assert lane.dropped == client.queue.dropped == 2
    assert client.queue.kept_bytes == 2 * (size + 2)
    client.queue.resume()
    hub.workers.finish_all()
    assert client.received() == b"<3><4>"
    assert hub.made == [b"3", b"4"]


def test_newer_frames_replace_those_behind_the_one_being_encoded(hub: Hub) -> None:
    client, lane = hub.client(), Lane(1)
    client.put(lane, *range(5))
    assert lane.dropped == 3
    hub.workers.finish_all()
    assert client.received() == b"<0><4>"


def test_newer_frames_replace_an_unread_encoded_one(hub: Hub) -> None:
    client, lane = hub.client(), Lane(1)
    client.put(lane, 1)
    client.queue.pause()
    hub.workers.finish_all()
    client.put(lane, 2)
    assert (hub.made, lane.dropped) == ([b"1"], 1)
    client.queue.resume()
    hub.workers.finish_all()
    assert client.received() == b"<2>"


def test_frames_that_are_made_wait_in_order_and_leave_as_others_do(hub: Hub) -> None:
    client, lane, frames = hub.client(), Lane(3), [hub.frame(each) for each in range(5)]
    other = hub.client()
    client.queue.pause()
    for frame in frames[:3]:
        client.queue.put(frame, lane)
        other.queue.put(frame, Lane(9))
    hub.workers.finish_all()
    client.room = 1
    client.queue.resume()
    assert client.received() == b"<0><1><2>"
    client.queue.put(frames[3], lane)
    assert client.queue.paused
    client.room = math.inf
    client.queue.resume()
    hub.workers.finish_all()
    assert client.received() == b"<3>"


def test_limit_counts_frames_of_both_kinds(hub: Hub) -> None:
    client, lane = hub.client(), Lane(2)
    client.queue.pause()
    for value in (b"1", b"2"):
        client.queue.put(value, lane)
    client.put(lane, 3)
    assert lane.dropped == client.queue.dropped == 1
    client.queue.resume()
    hub.workers.finish_all()
    assert client.received() == b"2<3>"


@pytest.mark.parametrize("event", ["forget", "close"])
def test_unneeded_frame_is_not_encoded(hub: Hub, event: str) -> None:
    client, lane = hub.client(), Lane(9)
    client.put(lane, 1, 2)
    if event == "forget":
        client.queue.forget(lane)
    else:
        client.queue.close()
    assert client.queue.kept_bytes == 0
    hub.workers.finish_all()
    assert (hub.made, client.received()) == ([], b"")
    assert client.queue.dropped == 0


def test_dropped_frame_is_encoded_when_requested_again(hub: Hub) -> None:
    client, frame = hub.client(), hub.frame(1)
    first, second, third = Lane(9), Lane(9), Lane(9)
    client.queue.put(frame, first)
    client.queue.forget(first)
    client.queue.put(frame, second)
    [(work, done)] = hub.workers.jobs
    hub.workers.jobs.clear()
    client.queue.forget(second)
    work()
    client.queue.put(frame, third)
    done()
    hub.workers.finish_all()
    assert (hub.made, client.received()) == ([b"1"], b"<1>")


def test_frame_being_encoded_for_a_client_that_leaves_is_dropped(hub: Hub) -> None:
    client, other, frame = hub.client(), hub.client(), hub.frame(1)
    for each in (client, other):
        each.queue.put(frame, Lane(9))
    [(work, done)] = hub.workers.jobs
    work()
    client.queue.close()
    done()
    assert (client.received(), other.received()) == (b"", b"<1>")


@pytest.mark.parametrize("size", [10, SMALL])
def test_failed_encoding_is_reported_once_and_skipped(hub: Hub, size: int) -> None:
    clients, lane, frame = [hub.client(), hub.client()], Lane(9), hub.frame(-1, size)
    for client in clients:
        client.queue.put(frame, lane)
        client.put(lane, 2, size=size)
    hub.workers.finish_all()
    assert [each.received() for each in clients] == [b"<2>", b"<2>"]
    assert [str(each) for each in hub.faults] == ["b'-1'"]


def test_frames_make_room_for_the_newest_of_any_lane(hub: Hub) -> None:
    client, lanes = hub.client(max_bytes=3 * SMALL), [Lane(9) for _ in range(5)]
    client.queue.pause()
    for value, lane in enumerate(lanes):
        client.put(lane, value)
        assert client.queue.kept_bytes <= client.queue.max_bytes
    client.queue.reply(bytes(2 * SMALL))
    assert client.queue.kept_bytes <= client.queue.max_bytes
    client.queue.resume()
    hub.workers.finish_all()
    assert client.received().replace(b"\0", b"") in (b"", b"<4>")
    assert client.queue.dropped == sum(lane.dropped for lane in lanes) >= 4


class DeferredMachine(RuleBasedStateMachine):
    """Check that each lane gets its newest frames in order, and all others count as dropped."""

    lanes = Bundle("lanes")

    def __init__(self) -> None:
        super().__init__()
        self.patch = pytest.MonkeyPatch()
        self.patch.setattr(send_queue, "CHUNK", 10)
        self.hub = Hub()
        self.clients = [self.hub.client(max_bytes=4 * SMALL) for _ in range(2)]
        self.read = [b"", b""]
        self.known: list[tuple[Lane, Lane]] = []
        self.put_ = 0
        self.of_lane: list[list[int]] = []

    def teardown(self) -> None:
        for client in self.clients:
            client.room = math.inf
            client.queue.resume()
        self.hub.workers.finish_all()
        for client in self.clients:
            client.queue.resume()
        self.hub.workers.finish_all()
        self.turn()
        self.patch.undo()
        for number_, client in enumerate(self.clients):
            assert client.queue.kept_bytes == 0
            values = [int(each) for each in re.findall(rb"<(\d+)>", self.read[number_])]
            for lanes, sent in zip(self.known, self.of_lane, strict=True):
                got = [each for each in values if each in sent]
                assert got == sorted(set(got))
                assert len(got) + lanes[number_].dropped == len(sent)
                assert not sent or got[-1:] == sent[-1:] or client.queue.dropped

    @rule(target=lanes, limit=st.integers(1, 3))
    def subscribe(self, limit: int) -> int:
        self.known.append((Lane(limit), Lane(limit)))
        self.of_lane.append([])
        return len(self.known) - 1

    @rule(lane=lanes, large=st.booleans())
    def publish(self, lane: int, large: bool) -> None:
        self.put_ += 1
        self.of_lane[lane].append(self.put_)
        frame = self.hub.frame(self.put_, SMALL if large else 10)
        for client, each in zip(self.clients, self.known[lane], strict=True):
            client.queue.put(frame, each)

    @rule(client=st.integers(0, 1))
    def pause(self, client: int) -> None:
        self.clients[client].queue.pause()

    @rule(client=st.integers(0, 1), room=st.integers(1, 20) | st.just(math.inf))
    def resume(self, client: int, room: float) -> None:
        self.clients[client].room = room
        self.clients[client].queue.resume()

    @rule()
    def finish(self) -> None:
        if self.hub.workers.jobs:
            self.hub.workers.finish()

    @rule()
    def turn(self) -> None:
        for number_, client in enumerate(self.clients):
            self.read[number_] += client.received()

    @invariant()
    def no_more_is_kept_than_allowed(self) -> None:
        for client in self.clients:
            # One frame is being made, and the newest is always kept.
            assert client.queue.kept_bytes <= client.queue.max_bytes + 2 * SMALL + 20


TestDeferredMachine = DeferredMachine.TestCase


# Subscriptions with png.


def png_of(operation: dict[str, Any]) -> Any:
    assert operation["op"] == "png"
    return json.loads(read_text(operation["data"]))["msg"]["data"]


def test_slow_subscriber_of_png_costs_no_encoding(monkeypatch: pytest.MonkeyPatch) -> None:
    made: list[bytes] = []

    def encode(text: bytes) -> str:
        made.append(text)
        return encode_png(text)

    monkeypatch.setattr(encodings, "encode_png", encode)
    hub = FakeHub()
    talker, listener = hub.client(), hub.client()
    talker.send("advertise", "/a", type=INT32)
    listener.send("subscribe", "/a", compression="png", queue_length=1)
    listener.queue.pause()
    for value in range(5):
        talker.send("publish", "/a", msg=number(value))
    assert made == []
    listener.queue.resume()
    assert [png_of(each) for each in listener.receive()] == [4]
    assert len(made) == 1


def test_another_encoding_takes_the_place_of_png_frames_that_wait() -> None:
    hub = FakeHub()
    talker, listener = hub.client(), hub.client()
    talker.send("advertise", "/a", type=INT32)
    listener.send("subscribe", "/a", compression="png")
    listener.queue.pause()
    talker.send("publish", "/a", msg=number(1))
    listener.send("subscribe", "/a", compression="none")
    talker.send("publish", "/a", msg=number(2))
    listener.queue.resume()
    assert listener.receive_numbers("/a") == [2]


@pytest.mark.parametrize("size", [10, SMALL])
def test_failed_png_is_reported_to_its_subscribers(
    monkeypatch: pytest.MonkeyPatch, size: int, caplog: pytest.LogCaptureFixture
) -> None:
    def fail(text: bytes) -> str:
        raise MemoryError("injected")

    monkeypatch.setattr(encodings, "encode_png", fail)
    hub = FakeHub()
    talker, listener, other = hub.client(), hub.client(), hub.client()
    talker.send("advertise", "/a", type=STRING)
    listener.send("subscribe", "/a", id="mine", compression="png")
    other.send("subscribe", "/a")
    for _ in range(3):
        talker.send("publish", "/a", msg={"data": "x" * size})
    assert listener.receive_one("status")["id"] == "mine"
    assert len(other.receive_messages("/a")) == 3
    assert [each.message for each in caplog.records if each.exc_info] == [
        "/a cannot be encoded (compression png, failure 1)"
    ]


class Gate:
    """An encoder of PNG that a test lets begin and end."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.begun = threading.Event()
        self.open = threading.Event()
        self.threads: set[str] = set()
        monkeypatch.setattr(encodings, "encode_png", self._encode)

    def _encode(self, text: bytes) -> str:
        self.threads.add(threading.current_thread().name)
        self.begun.set()
        assert self.open.wait(60)
        return encode_png(text)


@pytest.fixture
def gate(monkeypatch: pytest.MonkeyPatch) -> Gate:
    return Gate(monkeypatch)


LARGE = "x" * SMALL


@pytest.mark.both_loops
async def test_large_png_does_not_delay_other_clients(start_hub: StartHub, gate: Gate) -> None:
    hub = await start_hub()
    async with connected(hub.port) as listener, connected(hub.port) as talker:
        await listener.subscribes("/t", STRING, compression="png")
        await listener.subscribes("/other", STRING)
        for topic in ("/t", "/other"):
            await talker.advertises(topic, STRING)
        await talker.send(publish("/t", LARGE), publish("/t", "2"), publish("/other", "1"))
        assert await listener.receive_data(1) == ["1"]
        gate.open.set()
        assert [png_of(await listener.receive()) for _ in range(2)] == [LARGE, "2"]
    assert all(name.startswith("fibws-hub") for name in gate.threads)


@pytest.mark.both_loops
@pytest.mark.parametrize("event", ["unsubscribe", "leave", "shutdown"])
async def test_ending_during_a_png_encoding_leaves_nothing_behind(
    start_hub: StartHub, gate: Gate, event: str, caplog: pytest.LogCaptureFixture
) -> None:
    hub = await start_hub()
    async with connected(hub.port) as listener, connected(hub.port) as talker:
        await listener.subscribes("/t", STRING, compression="png")
        await talker.advertises("/t", STRING)
        await talker.send(publish("/t", LARGE))
        await until(gate.begun.is_set)
        if event == "unsubscribe":
            await listener.send_operation("unsubscribe", topic="/t")
            await listener.is_processed()
        elif event == "leave":
            listener.reset()
            await until(lambda: len(hub._connections) == 1)
        else:
            closing = asyncio.create_task(hub.close())
            await asyncio.sleep(0)
        gate.open.set()
        if event == "shutdown":
            listener.leave()
            talker.leave()
            await closing
            await until(lambda: not _threads())
        else:
            await talker.is_processed()
            assert all(not each.queue.kept_bytes for each in hub._connections)
    assert not [each for each in caplog.records if each.levelname == "ERROR"]


def _threads() -> list[threading.Thread]:
    """The hub's threads."""
    return [each for each in threading.enumerate() if each.name.startswith("fibws-hub")]
