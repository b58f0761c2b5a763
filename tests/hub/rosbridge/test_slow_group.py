"""Subscriptions with PNG: large messages are encoded in a thread, one at a time."""

from __future__ import annotations

import asyncio
import json
import threading
from typing import Any

import pytest
from conftest import StartHub
from protocol.png_reader import read_text

from fibws.hub.graph.topic import SinkReport
from fibws.hub.rosbridge import encodings
from fibws.hub.rosbridge.subscription import SMALL
from fibws.protocol.png import encode_png

from ..fakes import STRING, Client, FakeHub, FakeWorkers
from ..raw_client import connected, publish, until


class Topic:
    """A hub, a talker, and the numbers in the large messages that it publishes on /t."""

    def __init__(self, *, latch: bool = False, **settings: Any) -> None:
        self.workers = FakeWorkers()
        self.hub = FakeHub(workers=self.workers, **settings)
        self.talker = self.hub.client("/talker")
        self.talker.send("advertise", "/t", type=STRING, latch=latch)

    def listener(self, name: str = "/listener", **fields: Any) -> Client:
        client = self.hub.client(name)
        client.send("subscribe", "/t", compression="png", **fields)
        return client

    def publish(self, *numbers: int, size: int = SMALL, **fields: Any) -> None:
        for each in numbers:
            self.talker.send("publish", "/t", msg={"data": f"{each};{'x' * size}"}, **fields)

    def report(self, name: str = "/listener") -> SinkReport:
        [sink] = self.hub.graph.topics["/t"].sinks_of(name)
        return sink.report()


def numbers(client: Client) -> list[int]:
    """The numbers in the messages that a client got."""
    return [int(png_of(each).partition(";")[0]) for each in client.receive()]


def png_of(operation: dict[str, Any]) -> Any:
    assert operation["op"] == "png"
    return json.loads(read_text(operation["data"]))["msg"]["data"]


def test_small_message_is_encoded_at_once() -> None:
    topic = Topic()
    listener = topic.listener()
    topic.publish(1, 2, size=10)
    assert numbers(listener) == [1, 2]
    assert not topic.workers.jobs


def test_newest_message_waits_while_one_is_encoded() -> None:
    topic = Topic()
    listeners = [topic.listener("/listener"), topic.listener("/other")]
    topic.publish(1, 2, 3)
    topic.publish(4, size=10)
    assert len(topic.workers.jobs) == 1
    assert [numbers(each) for each in listeners] == [[], []]
    topic.workers.finish_all()
    assert [numbers(each) for each in listeners] == [[1, 4], [1, 4]]
    report = topic.report()
    assert (report.messages, report.dropped, report.throttled) == (2, 2, 0)
    assert [each.queue.kept_bytes for each in listeners] == [0, 0]


def test_waiting_messages_count_as_kept_for_the_client() -> None:
    topic = Topic(max_queued_bytes=3 * SMALL)
    listener = topic.listener()
    topic.publish(1, 2)
    assert 2 * SMALL < listener.queue.kept_bytes < 3 * SMALL
    listener.queue.pause()
    listener.queue.reply(bytes(2 * SMALL))
    topic.publish(3)
    assert listener.queue.kept_bytes < 4 * SMALL
    listener.queue.resume()
    listener.writes.clear()
    topic.workers.finish_all()
    assert numbers(listener) == [1]
    assert topic.report().dropped == 2


def test_message_that_the_throttle_leaves_out_is_not_encoded() -> None:
    topic = Topic()
    listener = topic.listener(throttle_rate=1000)
    topic.publish(1)
    topic.workers.finish_all()
    topic.publish(2, 3)
    assert not topic.workers.jobs
    topic.hub.clock.advance(1)
    topic.publish(4)
    topic.workers.finish_all()
    assert numbers(listener) == [1, 4]
    report = topic.report()
    assert (report.messages, report.dropped, report.throttled) == (2, 0, 2)


def test_latched_messages_of_all_publishers_are_sent() -> None:
    topic = Topic(latch=True)
    topic.publish(1)
    other = topic.hub.client("/talker2")
    other.send("advertise", "/t", type=STRING, latch=True)
    other.send("publish", "/t", msg={"data": f"2;{'x' * SMALL}"})
    first, second = topic.listener(), topic.listener("/second", throttle_rate=1000)
    topic.workers.finish_all()
    assert (numbers(first), numbers(second)) == ([1, 2], [1, 2])


def test_messages_for_one_node_replace_only_each_other() -> None:
    topic = Topic()
    mine, other = topic.listener("/mine"), topic.listener("/other")
    topic.publish(1)
    topic.publish(2, 3, to="/mine")
    topic.publish(4)
    topic.workers.finish_all()
    assert (numbers(mine), numbers(other)) == ([1, 3, 4], [1, 4])


@pytest.mark.parametrize("event", ["unsubscribe", "leave", "other encoding"])
def test_message_being_encoded_for_a_subscription_that_ends_is_dropped(event: str) -> None:
    topic = Topic()
    listener, other = topic.listener(), topic.listener("/other")
    topic.publish(1, 2)
    if event == "unsubscribe":
        listener.send("unsubscribe", "/t")
    elif event == "leave":
        listener.disconnect()
    else:
        listener.send("subscribe", "/t", compression="none")
    assert listener.queue.kept_bytes == 0
    topic.workers.finish_all()
    assert listener.receive() == []
    assert numbers(other) == [1, 2]


def test_message_that_nobody_waits_for_any_more_is_not_encoded() -> None:
    topic = Topic()
    listener = topic.listener()
    topic.publish(1, 2)
    listener.send("unsubscribe", "/t")
    topic.workers.finish()
    assert not topic.workers.jobs
    assert topic.hub.rosbridge.groups == {}


@pytest.mark.parametrize("size", [10, SMALL])
@pytest.mark.parametrize("to", [None, "/listener"])
def test_failed_png_is_reported_to_its_subscribers(
    monkeypatch: pytest.MonkeyPatch,
    size: int,
    to: str | None,
    caplog: pytest.LogCaptureFixture,
) -> None:
    def fail(text: bytes) -> str:
        raise MemoryError("injected")

    monkeypatch.setattr(encodings, "encode_png", fail)
    topic = Topic()
    listener, other = topic.listener(id="mine"), topic.hub.client("/other")
    other.send("subscribe", "/t")
    for each in range(3):
        topic.publish(each, size=size, to=to)
        topic.workers.finish_all()
    assert listener.receive_one("status")["id"] == "mine"
    assert len(other.receive_messages("/t")) == (0 if to else 3)
    assert [each.message for each in caplog.records if each.exc_info] == [
        "/t cannot be encoded (compression png, failure 1)"
    ]


class Gate:
    """An encoder of PNG that a test lets begin and end."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.begun = threading.Event()
        self.open = threading.Event()
        self.threads: set[str] = set()
        """Those that encoded large messages."""
        monkeypatch.setattr(encodings, "encode_png", self._encode)

    def _encode(self, text: bytes) -> str:
        if len(text) >= SMALL:
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
