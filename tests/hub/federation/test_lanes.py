"""What waits for a slow link is bounded, and only the oldest messages are dropped."""

from __future__ import annotations

import random
import struct
from collections import Counter
from collections.abc import Iterator

import pytest

from fibws.hub.federation import lanes, link
from fibws.hub.federation.backplane import Cancel, OnReply, Peer
from fibws.hub.federation.names import NameView
from fibws.hub.federation.records import Announcement, HubInfo, LinkMessage, Reply, Request
from fibws.protocol.websocket import CloseReason

from ..fakes import FakeClock, finish

MIB = 1024 * 1024
MAX_QUEUED = 16 * MIB
OTHER = HubInfo(id="b" * 16, name="other")


class SlowWire:
    """A connection on which nothing leaves until the test reads it."""

    is_behind = True

    def __init__(self) -> None:
        self.reasons: list[CloseReason] = []

    def wake(self) -> None:
        """Do nothing: the test writes."""

    def close(self, reason: CloseReason) -> None:
        self.reasons.append(reason)


class Network:
    """The hub of a link, of which little matters here."""

    def __init__(self) -> None:
        self.steps: list[Iterator[None]] = []
        self.cancelled: list[str] = []

    def attach(self, backplane: object) -> None: ...
    def detach(self, backplane: object) -> None: ...
    def idle(self, backplane: object) -> None: ...
    def joined(self, peer: Peer) -> None: ...
    def lost(self, peer: Peer, reason: str) -> None: ...
    def announced(self, peer: Peer, announcement: Announcement) -> Iterator[None]:
        return iter(())

    def interested(self, backplane: object, number: int, *, wanted: bool) -> None: ...
    def finish(self, steps: Iterator[None]) -> None:
        self.steps.append(steps)

    def is_flowing(self, peer: Peer, number: int) -> None: ...
    def received(self, peer: Peer, message: LinkMessage) -> None: ...

    def requested(self, peer: Peer, request: Request, reply: OnReply) -> Cancel:
        if request.op != "wait":
            reply(Reply({}, bytes(10)))
        return lambda: self.cancelled.append(request.op)


def record(kind: int, body: bytes) -> bytes:
    return struct.pack("<IB", len(body) + 1, kind) + body


class SlowLink:
    """A link to another hub that has joined, over a network that takes what the test reads."""

    def __init__(self) -> None:
        self.wire = SlowWire()
        self.network = Network()
        self.clock = FakeClock()
        self.link = link.Link(
            "accept",
            self.wire,
            self.network,
            HubInfo(id="a" * 16, name="this"),
            view=NameView(),
            node="/other",
            principal=None,
            address="other",
            clock=self.clock,
            now=lambda: 0,
            max_size=64 * MIB,
            max_queued=MAX_QUEUED,
            max_incoming=64 * MIB,
        )
        hello = link.Hello(hub=OTHER).model_dump_json().encode()
        self.receive(link.HELLO, hello)
        self.receive(link.PONG, bytes(16))
        self._parts: dict[int, bytearray] = {}
        assert list(self.records())

    def receive(self, kind: int, body: bytes) -> None:
        finish(self.link.receive(record(kind, body)))

    def publish(self, number: int, sequence: int, size: int, limit: int = 100) -> None:
        self.link.publish(LinkMessage(number, sequence, 0, bytes(size)), limit=limit)

    @property
    def dropped(self) -> int:
        assert self.link.peer is not None
        return self.link.peer.traffic.dropped

    def records(self) -> Iterator[tuple[int, bytes]]:
        """Take all that waits: the kinds and bodies of the records that the other hub gets."""
        while (frame := self.link.next_frame()) is not None:
            yield from self.read(frame)
        assert not self._parts

    def read(self, frame: bytes) -> Iterator[tuple[int, bytes]]:
        """Yield the kinds and bodies of the records that are complete with a frame."""
        at = 0
        while at < len(frame):
            size, kind = struct.unpack_from("<IB", frame, at)
            body = frame[at + 5 : at + 4 + size]
            at += 4 + size
            if kind == link.PART:
                lane, is_last = struct.unpack_from("<QB", body)
                self._parts.setdefault(lane, bytearray()).extend(body[9:])
                if not is_last:
                    continue
                whole = bytes(self._parts.pop(lane))
                kind, body = whole[4], whole[5:]
            yield kind, body

    def arrived(self) -> list[tuple[int, int]]:
        """Take all that waits; return the messages' publishers and sequence numbers."""
        return [
            struct.unpack_from("<QQ", body) for kind, body in self.records() if kind == link.MESSAGE
        ]


@pytest.fixture
def slow() -> SlowLink:
    return SlowLink()


def test_oldest_messages_of_a_lane_are_dropped_behind_a_flowing_record(slow: SlowLink) -> None:
    slow.publish(7, 0, 10 * MIB)
    slow.link.flowing(7)
    for sequence in range(1, 301):
        slow.publish(7, sequence, 1_000_000, limit=2)
    assert slow.dropped == 299
    slow.clock.advance(link.PING_INTERVAL)  # A ping is a record that cannot be dropped.
    assert not slow.wire.reasons
    assert slow.arrived() == [(7, 299), (7, 300)]


def test_fullest_lanes_lose_their_oldest_if_the_memory_is_full(slow: SlowLink) -> None:
    for sequence in range(5):
        slow.publish(7, sequence, 100_000)
    slow.publish(8, 0, 100_000)
    assert slow.link.waiting_bytes > 600_000
    slow.link.shorten(250_000)
    assert slow.link.waiting_bytes < 250_000
    assert sorted(slow.arrived()) == [(7, 4), (8, 0)]
    assert slow.dropped == 4
    slow.link.shorten(0)
    slow.link.give_up()
    assert slow.wire.reasons == [link.OVERFULL]


def test_other_hub_learns_that_messages_pass_whatever_is_dropped(slow: SlowLink) -> None:
    for sequence in range(10):
        slow.publish(7, sequence, 100, limit=1)
        slow.link.flowing(7)
    assert (link.FLOWING, struct.pack("<Q", 7)) in list(slow.records())


def test_message_that_is_sent_in_part_is_sent_wholly(slow: SlowLink) -> None:
    slow.publish(7, 0, 10 * MIB)
    frame = slow.link.next_frame()
    assert frame
    assert not list(slow.read(frame))
    for sequence in range(1, 5):
        slow.publish(7, sequence, MIB, limit=1)
    assert slow.dropped == 3
    assert slow.arrived() == [(7, 0), (7, 4)]


def test_newest_messages_of_many_publishers_do_not_end_the_link(slow: SlowLink) -> None:
    for number in range(1, 301):
        slow.publish(number, 1, MIB)
    slow.clock.advance(link.PING_INTERVAL)
    assert not slow.wire.reasons
    arrived = slow.arrived()
    assert len(arrived) + slow.dropped == 300
    assert 100 <= len(arrived) <= 130
    assert (300, 1) in arrived


def test_messages_of_an_idle_link_are_kept_until_it_writes(slow: SlowLink) -> None:
    slow.wire.is_behind = False
    slow.publish(1, 1, 60 * MIB)
    for number in range(2, 20):
        slow.publish(number, 1, MIB)
    assert sorted(slow.arrived()) == [(number, 1) for number in range(1, 20)]
    assert not slow.dropped


def test_fullest_lanes_lose_messages_when_all_is_full(slow: SlowLink) -> None:
    slow.publish(1, 1, 100)
    for number in range(2, 10):
        for sequence in range(1, 5):
            slow.publish(number, sequence, MIB // 2)
    for number in range(100, 300):
        slow.publish(number, 1, MIB)
    slow.publish(2, 5, 100)
    slow.publish(3, 5, 100)
    arrived = slow.arrived()
    assert (1, 1) in arrived
    assert {number for number, sequence in arrived if sequence == 5} == {2, 3}
    assert not {number for number, sequence in arrived if 1 < number < 100 and sequence < 4}
    assert len(arrived) + slow.dropped == 1 + 32 + 200 + 2
    assert not slow.wire.reasons


def test_message_larger_than_all_that_may_wait_is_sent(slow: SlowLink) -> None:
    slow.publish(1, 1, 60 * MIB)
    slow.publish(2, 1, 100)
    slow.clock.advance(link.PING_INTERVAL)
    assert not slow.wire.reasons
    frame = slow.link.next_frame()
    assert frame and not list(slow.read(frame))[1:]  # A part, behind a ping.
    slow.publish(2, 2, 100)
    slow.clock.advance(link.PING_INTERVAL)
    assert not slow.wire.reasons
    assert sorted(slow.arrived()) == [(1, 1), (2, 1), (2, 2)]


def test_calls_pass_when_messages_fill_all_that_may_wait(slow: SlowLink) -> None:
    for number in range(1, 101):
        slow.publish(number, 1, MIB)
    assert slow.link.peer is not None
    replies: list[Reply] = []
    slow.link.request(slow.link.peer, Request("call", {}, bytes(MIB)), replies.append)
    assert not replies
    slow.receive(link.REQUEST, struct.pack("<QI", 1, 2) + b"{}")
    bodies = {kind: body for kind, body in slow.records() if kind != link.MESSAGE}
    assert len(bodies[link.REQUEST]) > MIB
    assert bodies[link.REPLY].endswith(bytes(10))


def test_cancel_does_not_overtake_its_request(slow: SlowLink) -> None:
    assert slow.link.peer is not None
    for _ in range(2):
        cancel = slow.link.request(slow.link.peer, Request("call", {}, bytes(MIB)), print)
    cancel()
    kinds = [kind for kind, _ in slow.records()]
    assert kinds == [link.REQUEST, link.REQUEST, link.CANCEL]


def test_calls_are_bounded(slow: SlowLink) -> None:
    assert slow.link.peer is not None
    replies: list[Reply] = []
    for _ in range(20):
        slow.link.request(slow.link.peer, Request("call", {}, bytes(MIB)), replies.append)
    assert [reply.fields["code"] for reply in replies] == ["limit"] * 5
    assert not slow.wire.reasons


@pytest.mark.parametrize("op", ["cancel_goal", "older_node"])
@pytest.mark.long
def test_what_nobody_sends_again_passes_a_full_link_or_ends_it(slow: SlowLink, op: str) -> None:
    peer = slow.link.peer
    assert peer is not None
    replies: list[Reply] = []
    while not replies:
        slow.link.request(peer, Request("call", {}, bytes(MIB)), replies.append)
    answers: list[Reply] = []
    slow.link.request(peer, Request(op, {}), answers.append)
    assert not answers
    assert op in str([body for kind, body in slow.records() if kind == link.REQUEST][-1])
    for _ in range(4 * MAX_QUEUED // lanes.OVERHEAD):
        slow.link.request(peer, Request(op, {}), answers.append)
        if slow.wire.reasons:
            break
    assert slow.wire.reasons == [link.OVERFULL]
    assert not answers


def test_link_ends_if_other_records_pass_all_limits(slow: SlowLink) -> None:
    most = 4 * MAX_QUEUED // lanes.OVERHEAD
    for number in range(most):
        slow.link.flowing(number)
        if slow.wire.reasons:
            break
    assert slow.wire.reasons == [link.OVERFULL]


def test_large_messages_begin_only_while_those_in_part_leave_room() -> None:
    waiting = lanes.LinkLanes(4 * MIB, 10 * MIB, lambda count: None, lambda: None)
    for number in range(4):
        waiting.put_message(number, b"", bytes(3 * MIB // 2), limit=10, is_behind=True)
    begun: list[int] = []
    ended: list[int] = []
    while waiting:
        taken = waiting.take()
        if taken.lane not in begun:
            begun.append(taken.lane)
        if taken.is_last:
            ended.append(taken.lane)
        assert len(begun) - len(ended) <= 2
    assert begun == ended == [0, 1, 2, 3]


def test_random_records_stay_within_the_bounds() -> None:
    chance = random.Random(1)
    dropped: Counter[str] = Counter()
    largest = MIB
    most = 4 * MIB
    waiting = lanes.LinkLanes(MIB, most, lambda count: None, lambda: dropped.update(["dropped"]))
    sent: Counter[int] = Counter()
    put: Counter[int] = Counter()
    for _ in range(5000):
        number = chance.randrange(1, 30)
        match chance.randrange(4):
            case 0 if waiting:
                taken = waiting.take()
                sent[taken.lane] += taken.is_last
            case 1 if waiting.calls_weight < MIB:
                waiting.put_call(b"", bytes(chance.randrange(1000)))
                put[lanes.CALLS] += 1
            case _:
                put[number] += 1
                head, size = struct.pack("<Q", put[number]), chance.choice([10, 1000, largest])
                limit, is_behind = chance.choice([1, 10, 1000]), chance.random() < 0.5
                waiting.put_message(number, head, bytes(size), limit=limit, is_behind=is_behind)
        assert waiting.memory - waiting.calls_weight <= most + MIB + 2 * (largest + lanes.OVERHEAD)
    while waiting:
        taken = waiting.take()
        sent[taken.lane] += taken.is_last
    assert sent[lanes.CALLS] == put[lanes.CALLS]
    assert sum(sent.values()) + dropped["dropped"] == sum(put.values())
    assert waiting.memory == 0


def test_each_record_is_a_step() -> None:
    slow = SlowLink()
    data = 1000 * record(link.CANCEL, bytes(8))
    assert sum(1 for _ in slow.link.receive(data)) == 1000


def test_requests_of_a_lost_link_end_one_by_one(slow: SlowLink) -> None:
    peer = slow.link.peer
    assert peer is not None
    failed: list[int] = []

    def fail(number: int) -> Cancel:
        def reply(reply: Reply) -> None:
            assert reply.fields["code"] == "server_lost"
            failed.append(number)
            if number == 1:
                raise RuntimeError("a caller that fails keeps no other waiting")

        return slow.link.request(peer, Request("call", {}), reply)

    cancels = [fail(number) for number in range(4)]
    for id_ in range(3):
        fields = b'{"op":"wait"}'
        slow.receive(link.REQUEST, struct.pack("<QI", id_, len(fields)) + fields)
    slow.link.closed("the cable is cut")
    assert not failed
    assert not slow.network.cancelled
    [steps] = slow.network.steps
    next(steps)
    assert failed == [0]
    cancels[2]()  # Its caller has left meanwhile.
    finish(steps)
    assert failed == [0, 1, 3]
    assert slow.network.cancelled == ["wait"] * 3
