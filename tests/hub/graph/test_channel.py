"""The subscriptions that hear the same frames."""

from __future__ import annotations

import pytest

from fibws.errors import OperationError
from fibws.hub.graph.channel import Channel
from fibws.hub.graph.encoding import Encoding, Publication
from fibws.hub.graph.subscription import Subscription
from fibws.hub.graph.topic import Topic
from fibws.hub.graph.types import Types
from fibws.hub.outbox import Flusher, Outbox
from fibws.interfaces import Interfaces
from fibws.protocol.operations import Subscribe

from ..fakes import INT32, NANOSECONDS, FakeClock, payloads

TYPES = Types(Interfaces(), lambda: NANOSECONDS, strict=False)


class Hall:
    """A channel, and what each of its subscribers hears."""

    def __init__(self, encoding: Encoding | None = None) -> None:
        self.clock = FakeClock()
        self.flusher = Flusher(self.clock.call_soon)
        self.channel = Channel("/a", encoding or Encoding())
        self.heard: dict[Subscription, list[bytes]] = {}

    def joins(self, *, throttle_rate: float = 0) -> Subscription:
        writes: list[bytes] = []
        outbox = Outbox(writes.append, print, self.flusher, max_bytes=1000)
        subscription = Subscription(
            "/listener", Topic("/a"), "/a", outbox, self.clock, print, queue_length=2
        )
        subscription.request(Subscribe(topic="/a", throttle_rate=throttle_rate))
        self.channel.add(subscription)
        self.heard[subscription] = writes
        return subscription

    def sends(self, *numbers: int) -> None:
        for number in numbers:
            publication = Publication({"data": number}, TYPES.message(INT32), NANOSECONDS)
            self.channel.send(publication)
        self.clock.turn()

    def hears(self, subscription: Subscription) -> list[bytes]:
        texts = [text for data in self.heard[subscription] for text in payloads(data)]
        return [text.partition(b'"data":')[2].rstrip(b"}") for text in texts]


def test_a_channel_has_what_its_subscriptions_have_in_common() -> None:
    channel = Channel("a", Encoding("png", 50))
    assert channel.key == ("a", Encoding("png", 50))


def test_all_share_the_bytes_of_a_frame() -> None:
    hall = Hall()
    first, second = hall.joins(), hall.joins()
    hall.sends(1)
    assert hall.heard[first][0] is hall.heard[second][0]


def test_a_frame_is_made_once_for_direct_and_throttled_subscriptions() -> None:
    hall = Hall()
    hall.joins()
    hall.joins(throttle_rate=300)
    made: list[Publication] = []
    frame = hall.channel.frame

    def counted(publication: Publication) -> bytes:
        made.append(publication)
        return frame(publication)

    hall.channel.frame = counted
    hall.sends(1)
    assert len(made) == 1


def test_a_throttle_is_one_subscriptions_own() -> None:
    hall = Hall()
    direct, throttled = hall.joins(), hall.joins(throttle_rate=300)
    hall.sends(1, 2, 3)
    assert (hall.hears(direct), hall.hears(throttled)) == ([b"1", b"2", b"3"], [b"1"])


def test_a_slow_client_keeps_what_its_queue_holds_and_holds_up_nobody() -> None:
    hall = Hall()
    slow, quick = hall.joins(), hall.joins()
    slow.outbox.pause()
    hall.sends(1, 2, 3)
    assert hall.hears(quick) == [b"1", b"2", b"3"]
    slow.outbox.resume()
    hall.clock.turn()
    assert hall.hears(slow) == [b"2", b"3"]


def test_a_subscription_is_in_the_channel_once_and_until_it_is_taken_out() -> None:
    hall = Hall()
    first, second = hall.joins(), hall.joins(throttle_rate=300)
    for each in (first, second, second):
        hall.channel.add(each)
    assert set(hall.channel.subscriptions()) == {first, second}
    assert len(list(hall.channel.subscriptions())) == 2
    for each in (first, second):
        assert hall.channel
        hall.channel.remove(each)
        hall.channel.remove(each)
    assert not hall.channel
    hall.sends(1)
    assert hall.hears(first) == hall.hears(second) == []


@pytest.mark.parametrize("rates", [(0, 300), (300, 0)])
def test_a_throttle_may_come_and_go(rates: tuple[int, int]) -> None:
    hall = Hall()
    subscription = hall.joins(throttle_rate=rates[0])
    for rate in rates:
        subscription.request(Subscribe(topic="/a", throttle_rate=rate))
        hall.channel.add(subscription)
        assert list(hall.channel.subscriptions()) == [subscription]
        hall.heard[subscription].clear()
        hall.clock.advance(1)
        hall.sends(1, 2)
        assert len(hall.hears(subscription)) == (1 if rate else 2)


def test_what_cannot_be_encoded_is_sent_to_nobody() -> None:
    hall = Hall(Encoding("cbor-raw"))
    subscription = hall.joins()
    publication = Publication({}, TYPES.message("my_msgs/Thing"), NANOSECONDS)
    with pytest.raises(OperationError, match="cbor-raw needs the definition of my_msgs/Thing"):
        hall.channel.send(publication)
    hall.clock.turn()
    assert hall.heard[subscription] == []
