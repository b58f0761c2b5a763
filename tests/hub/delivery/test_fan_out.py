"""Fan-out groups: the subscriptions of one topic that get the same frames."""

from __future__ import annotations

import json
from itertools import permutations
from typing import Any

import pytest

from fibws.hub.delivery.fan_out import FanOut
from fibws.hub.delivery.send_queue import Bytes, Flusher, SendQueue
from fibws.hub.delivery.throttle import Throttling
from fibws.hub.graph.publication import Publication
from fibws.protocol.frame_queue import Lane

from ..fakes import INT32, Client, FakeClock, FakeHub, number


class Subscriber:
    """A `Member` of a group; records the writes to its client's socket."""

    def __init__(self, group: Group, *, period: float = 0, queue_length: int = 0) -> None:
        self.writes: list[Bytes] = []
        self.queue = SendQueue(self.writes.append, print, group.flusher, max_bytes=1000)
        self.lane = Lane(2)
        self.throttling = Throttling(period, queue_length) if period else None
        self.sent = 0
        self.throttled = 0
        self.unacknowledged = 0

    @property
    def frames(self) -> list[bytes]:
        """The numbers that it got, one byte each."""
        return [bytes([each]) for data in self.writes for each in data]


class Group:
    """A group that encodes numbers, and counts how often it does."""

    def __init__(self) -> None:
        self.clock = FakeClock()
        self.flusher = Flusher(self.clock.call_soon)
        self.encoded: list[int] = []
        self.fan_out: FanOut[int, Subscriber] = FanOut(self._encode, self.flusher, self.clock)

    def _encode(self, value: int) -> bytes:
        self.encoded.append(value)
        if value < 0:
            raise ValueError(value)
        return b"%d" % value

    def join(self, **throttle: Any) -> Subscriber:
        member = Subscriber(self, **throttle)
        self.fan_out.add(member)
        return member

    def send(self, *values: int) -> None:
        for value in values:
            self.fan_out.send(value)
        self.clock.turn()


# Groups.


def test_all_members_share_the_bytes_of_a_frame() -> None:
    group = Group()
    first, second = group.join(), group.join()
    group.send(1)
    assert first.writes == [b"1"]
    assert first.writes[0] is second.writes[0]


def test_frame_is_encoded_once_for_direct_and_throttled_members() -> None:
    group = Group()
    members = [group.join(), group.join(), group.join(period=0.3), group.join(period=0.3)]
    group.send(1)
    assert group.encoded == [1]
    assert [member.frames for member in members] == [[b"1"]] * 4


def test_nothing_is_encoded_if_no_throttle_wants_it() -> None:
    group = Group()
    group.join(period=0.3)
    group.send(1, 2, 3)
    assert group.encoded == [1]


def test_each_throttle_is_one_members_own() -> None:
    group = Group()
    direct = group.join()
    throttled, queued = group.join(period=0.3), group.join(period=0.3, queue_length=1)
    group.send(1, 2, 3)
    group.clock.advance(1)
    group.send(4)
    assert direct.frames == [b"1", b"2", b"3", b"4"]
    assert throttled.frames == [b"1", b"4"]
    assert queued.frames == [b"1", b"3", b"4"]


def test_slow_member_keeps_its_newest_frames_and_does_not_delay_others() -> None:
    group = Group()
    slow, quick = group.join(), group.join()
    slow.queue.pause()
    group.send(1, 2, 3)
    assert quick.frames == [b"1", b"2", b"3"]
    assert slow.lane.dropped == 1
    slow.queue.resume()
    group.clock.turn()
    assert slow.frames == [b"2", b"3"]


def test_member_gets_frames_until_it_is_removed() -> None:
    group = Group()
    members = [group.join(), group.join(period=0.3)]
    assert (len(group.fan_out), group.fan_out.members()) == (2, members)
    for member in members:
        assert group.fan_out
        group.fan_out.remove(member)
    assert not group.fan_out
    group.send(1)
    assert [member.frames for member in members] == [[], []]
    assert group.encoded == []


def test_messages_are_counted_for_each_member_since_it_joined() -> None:
    group = Group()
    first, throttled = group.join(), group.join(period=0.3)
    group.send(1, 2)
    second = group.join()
    group.send(3)
    members = first, second, throttled
    assert [group.fan_out.sent_to(member) for member in members] == [3, 1, 1]
    for member in members:
        group.fan_out.remove(member)
    group.send(4)
    assert [group.fan_out.sent_to(member) for member in members] == [3, 1, 1]


def test_publication_that_cannot_be_encoded_is_not_sent() -> None:
    group = Group()
    member = group.join()
    with pytest.raises(ValueError, match="-1"):
        group.fan_out.send(-1)
    group.send(2)
    assert member.frames == [b"2"]
    assert group.fan_out.sent_to(member) == 1


@pytest.mark.parametrize("order", [*permutations(range(3))], ids=str)
def test_client_with_several_members_gets_each_frame_once(order: tuple[int, ...]) -> None:
    group = Group()
    members = [group.join() for _ in range(3)]
    for member in members[1:]:
        group.fan_out.remove(member)
        member.queue = members[0].queue
        group.fan_out.add(member)
    other = group.join()
    group.send(1)
    for value, left in enumerate(order, 2):
        group.fan_out.remove(members[left])
        assert members[left].sent == value - 1
        group.send(value)
    assert members[0].frames == [b"1", b"2", b"3"]
    assert other.frames == [b"1", b"2", b"3", b"4"]


# Subscriptions in groups.


def texts(client: Client) -> list[bytes]:
    """The payloads of the frames that a client got."""
    return [payload for _, payload in client.receive_frames()]


@pytest.fixture
def hub() -> FakeHub:
    return FakeHub()


@pytest.fixture
def talker(hub: FakeHub) -> Client:
    client = hub.client("/talker")
    client.send("advertise", "/a", type=INT32)
    return client


def test_subscriptions_with_the_same_spelling_and_encoding_share_a_frame(
    hub: FakeHub, talker: Client
) -> None:
    first, second = hub.client(), hub.client()
    for client in (first, second):
        client.send("subscribe", "/a")
    talker.send("publish", "/a", msg=number(1))
    hub.clock.turn()
    assert first.writes[0] is second.writes[0]
    assert texts(first) == [b'{"op":"publish","topic":"/a","msg":{"data":1}}']
    assert len(hub.rosbridge.groups) == 1


@pytest.mark.parametrize("spelling", ["/client_1/a", "client_1/a", "~a"])
def test_each_client_gets_the_topics_name_as_it_spelled_it(hub: FakeHub, spelling: str) -> None:
    talker, listener = hub.client("/talker"), hub.client("/client_1")
    talker.send("advertise", "/client_1/a", type=INT32)
    listener.send("subscribe", spelling)
    talker.send("publish", "/client_1/a", msg=number(1))
    assert [json.loads(text)["topic"] for text in texts(listener)] == [spelling]


@pytest.mark.parametrize("size", [0, 50, 100, 1000, 70_000])
def test_message_may_have_any_size(hub: FakeHub, size: int) -> None:
    talker, listener = hub.client(), hub.client()
    talker.send("advertise", "/text", type="std_msgs/String")
    listener.send("subscribe", "/text")
    talker.send("publish", "/text", msg={"data": "x" * size})
    assert listener.receive_messages("/text") == [{"data": "x" * size}]


@pytest.mark.parametrize("first", ["/a", "a"])
def test_serialized_topic_under_two_spellings_is_delivered_once(
    hub: FakeHub, talker: Client, first: str
) -> None:
    client = hub.client("/listener", serialized=True)
    for spelling in ("/a", "a"):
        client.send("subscribe", spelling, compression="ros1")
        client.receive_one("subscribed")
    talker.send("publish", "/a", msg=number(1))
    assert len(client.receive_frames()) == 1
    client.send("unsubscribe", first)
    talker.send("publish", "/a", msg=number(2))
    assert len(client.receive_frames()) == 1
    client.disconnect()
    assert hub.rosbridge.groups == {}


def test_empty_groups_are_forgotten(hub: FakeHub, talker: Client) -> None:
    client = hub.client("/listener")
    for spelling in ("/a", "a"):
        client.send("subscribe", spelling)
        client.send("subscribe", spelling, id="cbor", compression="cbor")
    assert len(hub.rosbridge.groups) == 2
    client.send("unsubscribe", "/a", id="cbor")
    assert len(hub.rosbridge.groups) == 2
    client.send("unsubscribe", "/a")
    assert len(hub.rosbridge.groups) == 1
    client.disconnect()
    assert hub.rosbridge.groups == {}


@pytest.mark.parametrize("rates", [(0, 300), (300, 0)])
def test_throttle_may_come_and_go(hub: FakeHub, talker: Client, rates: tuple[int, int]) -> None:
    listener = hub.client()
    for rate in rates:
        listener.send("subscribe", "/a", id="1", throttle_rate=rate)
        hub.clock.advance(1)
        for value in (1, 2):
            talker.send("publish", "/a", msg=number(value))
        assert listener.receive_numbers("/a") == ([1] if rate else [1, 2])


def test_message_for_one_node_reaches_it_under_each_spelling_and_encoding(
    hub: FakeHub, talker: Client
) -> None:
    options: list[tuple[str, dict[str, Any]]] = [
        ("/a", {}),
        ("a", {"headers": True}),
        ("a", {"throttle_rate": 1}),
        ("~a", {}),
    ]
    mine, other = hub.client("/mine"), hub.client("/other")
    for client in (mine, other):
        for spelling, fields in options:
            client.send("subscribe", spelling, id=str(fields), **fields)
    talker.send("publish", "/a", msg=number(1), to="/mine")
    assert [each["topic"] for each in mine.receive()] == ["/a", "a"]
    assert other.receive() == []


def test_message_for_one_node_waits_for_its_throttle_and_in_its_send_queue(
    hub: FakeHub, talker: Client
) -> None:
    throttled, slow = hub.client("/listener"), hub.client("/slow")
    throttled.send("subscribe", "/a", throttle_rate=1000, queue_length=1)
    slow.send("subscribe", "/a", queue_length=2)
    slow.queue.pause()
    for value in range(3):
        for node in ("/listener", "/slow"):
            talker.send("publish", "/a", msg=number(value), to=node)
    assert throttled.receive_numbers("/a") == [0]
    hub.clock.advance(1)
    assert throttled.receive_numbers("/a") == [2]
    slow.queue.resume()
    assert slow.receive_numbers("/a") == [1, 2]
    reports = {sink.node: sink.report() for sink in hub.graph.topics["/a"].sinks()}
    assert (reports["/listener"].messages, reports["/slow"].messages) == (2, 3)
    assert reports["/slow"].dropped == 1


def test_message_for_one_node_that_cannot_be_encoded_is_reported_to_it(hub: FakeHub) -> None:
    talker, listener = hub.client("/talker"), hub.client("/listener")
    listener.send("subscribe", "/thing", id="s", compression="cbor-raw")
    talker.send("advertise", "/thing", type="my_msgs/Thing")
    for _ in range(2):
        talker.send("publish", "/thing", msg={}, to="/listener")
    status = listener.receive_one("status")
    assert status["id"] == "s"
    assert "definition of my_msgs/Thing" in status["msg"]
    assert talker.receive() == []


# Encodings that fail.


@pytest.fixture
def broken_cbor(monkeypatch: pytest.MonkeyPatch) -> None:
    def cbor(self: Publication) -> bytes:
        raise MemoryError("injected")

    monkeypatch.setattr(Publication, "cbor", cbor)


@pytest.mark.usefixtures("broken_cbor")
@pytest.mark.parametrize("to", [None, "/listener"])
@pytest.mark.parametrize("throttle_rate", [0, 1000])
def test_encoding_that_fails_in_the_hub_is_reported_to_its_subscribers_alone(
    hub: FakeHub,
    talker: Client,
    to: str | None,
    throttle_rate: int,
    caplog: pytest.LogCaptureFixture,
) -> None:
    listener, other = hub.client("/listener", serialized=True), hub.client("/other")
    options = {"compression": "cbor", "throttle_rate": throttle_rate}
    listener.send("subscribe", "/a", id="mine", **options)
    listener.send("subscribe", "a")
    other.send("subscribe", "/a")
    for value in range(3):
        talker.send("publish", "/a", msg=number(value), to=to)
    status, *messages = listener.receive()
    assert (status["level"], status["id"]) == ("error", "mine")
    assert status["code"] == "internal_error"
    assert [each["msg"]["data"] for each in messages] == [0, 1, 2]
    assert other.receive_numbers("/a") == ([0, 1, 2] if to is None else [])
    assert talker.receive() == []
    assert [each.message for each in caplog.records if each.exc_info] == [
        "/a cannot be encoded (compression cbor, failure 1)"
    ]


@pytest.mark.usefixtures("broken_cbor")
def test_encoding_that_fails_in_the_hub_at_subscribing_is_reported(hub: FakeHub) -> None:
    talker, listener = hub.client(), hub.client()
    talker.send("advertise", "/a", type=INT32, latch=True)
    talker.send("publish", "/a", msg=number(1))
    listener.send("subscribe", "/a", id="mine", compression="cbor")
    assert listener.receive_one("status")["id"] == "mine"
