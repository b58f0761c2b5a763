"""The receiving end of a topic."""

from __future__ import annotations

import asyncio
import logging
from typing import Any

import pytest

from fibws.errors import InvalidMessage, NodeReplaced
from fibws.node.subscription import Subscription
from fibws.protocol.operations import Subscribe


def subscription(
    queue_size: int | None = 10, *, headers: bool | None = None, **changes: Any
) -> Subscription[Any]:
    arguments = {
        "build": lambda msg: msg,
        "leave": lambda subscription: None,
        "log": logging.Logger("test"),
    }
    operation = Subscribe(topic="/t", type="std_msgs/Int32", headers=headers)
    return Subscription(operation, "std_msgs/Int32", queue_size, **{**arguments, **changes})


async def rest(numbers: Subscription[Any]) -> list[Any]:
    return [number async for number in numbers]


def test_it_shows_what_it_listens_to() -> None:
    assert repr(subscription()) == "<Subscription /t [std_msgs/Int32]>"


async def test_messages_are_read_in_order_and_then_the_end() -> None:
    numbers = subscription()
    for number in range(3):
        numbers.offer(number)
    numbers.end()
    assert await rest(numbers) == [0, 1, 2]


async def test_the_oldest_make_way_and_are_counted() -> None:
    numbers = subscription(queue_size=2)
    for number in range(5):
        numbers.offer(number)
    numbers.end()
    assert numbers.dropped == 3
    assert await rest(numbers) == [3, 4]


async def test_a_reader_waits_for_what_comes() -> None:
    numbers = subscription()
    reading = asyncio.create_task(anext(numbers))
    await asyncio.sleep(0)
    numbers.offer(1)
    assert await reading == 1


async def test_two_readers_share_the_messages_and_both_hear_of_the_end() -> None:
    numbers = subscription()
    readers = [asyncio.create_task(rest(numbers)) for _ in range(2)]
    await asyncio.sleep(0)
    numbers.offer(1)
    numbers.offer(2)
    await asyncio.sleep(0)
    numbers.end()
    first, second = await asyncio.gather(*readers)
    assert sorted(first + second) == [1, 2]


async def test_closing_forgets_what_was_not_read_and_is_told_once() -> None:
    left: list[object] = []
    numbers = subscription(leave=left.append)
    numbers.offer(1)
    numbers.close()
    numbers.close()
    assert left == [numbers]
    assert await rest(numbers) == []


async def test_a_reader_who_stops_waiting_misses_nothing() -> None:
    numbers = subscription()
    with pytest.raises(TimeoutError):
        async with asyncio.timeout(0):
            await anext(numbers)
    numbers.offer(1)
    assert await anext(numbers) == 1


async def test_what_cannot_be_read_is_passed_over() -> None:
    def build(msg: object) -> object:
        if msg == "bad":
            raise InvalidMessage("bad")
        return msg

    numbers = subscription(build=build)
    numbers.offer("bad")
    numbers.offer("good")
    assert await anext(numbers) == "good"


async def test_a_fault_is_raised_each_time() -> None:
    numbers = subscription()
    numbers.end(NodeReplaced("by another"))
    for _ in range(2):
        with pytest.raises(NodeReplaced):
            await anext(numbers)


async def test_without_a_queue_size_nothing_makes_way() -> None:
    numbers = subscription(queue_size=None)
    for number in range(20_000):
        numbers.offer(number)
    numbers.end()
    assert len(await rest(numbers)) == 20_000
    assert numbers.dropped == 0


async def test_the_header_is_that_of_the_message_that_was_read() -> None:
    numbers = subscription(headers=True)
    assert numbers.connection_header == {}
    numbers.offer(1, {"callerid": "/a"})
    numbers.offer(2, {"callerid": "/b"})
    numbers.offer(3)
    for header in ({"callerid": "/a"}, {"callerid": "/b"}, {}):
        await anext(numbers)
        assert numbers.connection_header == header


async def test_who_did_not_ask_has_no_header() -> None:
    numbers = subscription()
    numbers.offer(1, {"callerid": "/a"})
    await anext(numbers)
    assert numbers.connection_header == {}


async def test_messages_may_be_handed_to_a_function_as_they_come() -> None:
    taken: list[object] = []

    def build(msg: object) -> object:
        if msg == "bad":
            raise InvalidMessage("bad")
        return msg

    numbers = subscription(build=build, headers=True)

    def take(message: object) -> None:
        taken.append((message, numbers.connection_header))

    numbers.hand_to(take)
    for number in range(20):
        numbers.offer(number, {"callerid": str(number)})
    numbers.offer("bad")
    assert taken == [(number, {"callerid": str(number)}) for number in range(20)]
    assert numbers.dropped == 0
    numbers.end()
    assert await rest(numbers) == []


def test_it_is_full_when_the_next_message_drops_one() -> None:
    numbers, all_ = subscription(queue_size=2), subscription(queue_size=None)
    seen = []
    for number in range(3):
        for each in (numbers, all_):
            each.offer(number)
        seen.append((numbers.is_full, numbers.dropped, all_.is_full))
    assert seen == [(False, 0, False), (True, 0, False), (True, 1, False)]
