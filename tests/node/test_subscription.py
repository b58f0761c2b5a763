"""The receiving end of a topic."""

from __future__ import annotations

import asyncio
import logging
from typing import Any

import pytest

from fibws.errors import NodeReplaced
from fibws.msg.std_msgs import Int32
from fibws.node.subscription import Received, Subscription
from fibws.node.types import NodeTypes
from fibws.protocol.operations import Subscribe

from .conftest import Lines


def subscription(
    queue_size: int | None = 10, *, headers: bool | None = None, **changes: Any
) -> Subscription[Int32]:
    arguments = {
        "codec": NodeTypes(lambda: 0).codec(Int32),
        "withdraw": lambda subscription: None,
        "log": logging.Logger("test"),
    }
    operation = Subscribe(topic="/t", type="std_msgs/Int32", headers=headers)
    return Subscription(operation, queue_size=queue_size, **{**arguments, **changes})


def message(number: int, *, serialized: bool = True) -> Any:
    """The argument of `Subscription.offer`: serialized, or JSON values."""
    return memoryview(number.to_bytes(4, "little")) if serialized else {"data": number}


async def rest(numbers: Subscription[Int32]) -> list[int]:
    return [number.data async for number in numbers]


def test_repr() -> None:
    assert repr(subscription()) == "<Subscription /t [std_msgs/Int32]>"


@pytest.mark.parametrize("serialized", [True, False])
async def test_messages_are_read_in_order_and_then_the_end(serialized: bool) -> None:
    numbers = subscription()
    for number in range(3):
        numbers._offer(message(number, serialized=serialized))
    numbers._end()
    assert await rest(numbers) == [0, 1, 2]


async def test_oldest_messages_are_dropped_and_counted() -> None:
    numbers = subscription(queue_size=2)
    for number in range(5):
        numbers._offer(message(number))
    numbers._end()
    assert numbers.dropped == 3
    assert await rest(numbers) == [3, 4]


async def test_dropped_messages_are_not_decoded() -> None:
    numbers = subscription(queue_size=1)
    for _ in range(3):
        numbers._offer(memoryview(b"invalid"))
    numbers._offer(message(5))
    assert (await anext(numbers)).data == 5


async def test_reader_waits_for_a_message() -> None:
    numbers = subscription()
    reading = asyncio.create_task(anext(numbers))
    await asyncio.sleep(0)
    numbers._offer(message(1))
    assert await reading == Int32(1)


async def test_two_readers_share_the_messages_and_both_end() -> None:
    numbers = subscription()
    readers = [asyncio.create_task(rest(numbers)) for _ in range(2)]
    await asyncio.sleep(0)
    numbers._offer(message(1))
    numbers._offer(message(2))
    await asyncio.sleep(0)
    numbers._end()
    first, second = await asyncio.gather(*readers)
    assert sorted(first + second) == [1, 2]


async def test_closing_discards_messages_and_withdraws_once() -> None:
    withdrawn: list[object] = []
    numbers = subscription(withdraw=withdrawn.append)
    numbers._offer(message(1))
    numbers.close()
    numbers.close()
    assert withdrawn == [numbers]
    assert await rest(numbers) == []


async def test_reader_that_timed_out_misses_nothing() -> None:
    numbers = subscription()
    with pytest.raises(TimeoutError):
        async with asyncio.timeout(0):
            await anext(numbers)
    numbers._offer(message(1))
    assert await anext(numbers) == Int32(1)


@pytest.mark.parametrize("invalid", [memoryview(b"abc"), {"data": "text"}, None])
async def test_invalid_message_is_logged_and_skipped(invalid: Any) -> None:
    log = logging.Logger("test")
    lines = Lines(log)
    numbers = subscription(log=log)
    numbers._offer(invalid)
    numbers._offer(message(1))
    assert await anext(numbers) == Int32(1)
    (line,) = lines.seen()
    assert line.startswith("Dropped a message on /t: ")


async def test_fault_is_raised_each_time() -> None:
    numbers = subscription()
    numbers._end(NodeReplaced("by another"))
    for _ in range(2):
        with pytest.raises(NodeReplaced):
            await anext(numbers)


async def test_nothing_is_dropped_without_a_queue_size() -> None:
    numbers = subscription(queue_size=None)
    for number in range(20_000):
        assert not numbers._offer(message(number))
    numbers._end()
    assert len(await rest(numbers)) == 20_000
    assert numbers.dropped == 0


async def test_header_is_that_of_the_last_message_read() -> None:
    numbers = subscription(headers=True)
    assert numbers.connection_header == {}
    numbers._offer(message(1), b'{"callerid":"/a"}')
    numbers._offer(message(2), b'{"callerid":"/b"}')
    numbers._offer(message(3), b'{"callerid":"/a"}')
    numbers._offer(message(4), {"callerid": "/c"})
    numbers._offer(message(5))
    numbers._offer(message(6), b"")
    for name in ("/a", "/b", "/a", "/c"):
        await anext(numbers)
        assert numbers.connection_header == {"callerid": name}
    for _ in range(2):
        await anext(numbers)
        assert numbers.connection_header == {}


async def test_headers_of_many_publishers_do_not_pile_up() -> None:
    numbers = subscription(headers=True)
    for number in range(1000):
        numbers._offer(message(number), b'{"callerid":"/%d"}' % number)
        await anext(numbers)
        assert numbers.connection_header == {"callerid": f"/{number}"}
    assert len(numbers._headers) <= 100


async def test_headers_are_received_only_on_request() -> None:
    numbers = subscription()
    numbers._offer(message(1), b'{"callerid":"/a"}')
    await anext(numbers)
    assert numbers.connection_header == {}


async def test_messages_can_be_handed_to_a_function() -> None:
    taken: list[object] = []
    numbers = subscription(headers=True)

    def take(number: Int32) -> None:
        taken.append((number.data, numbers.connection_header))

    numbers._hand_to(take)
    for number in range(20):
        assert not numbers._offer(message(number), {"callerid": str(number)})
    numbers._offer(memoryview(b"abc"))
    assert taken == [(number, {"callerid": str(number)}) for number in range(20)]
    assert numbers.dropped == 0
    numbers._end()
    assert await rest(numbers) == []
    numbers._offer(message(1))
    assert len(taken) == 20


async def test_messages_can_be_decoded_later() -> None:
    numbers = subscription()
    taken: list[Received] = []
    numbers._hand_undecoded_to(taken.append)
    numbers._offer(message(5), b"{}")
    numbers._offer(message(6, serialized=False), None)
    numbers._offer(memoryview(b"abc"), None)
    assert [numbers._decode(each) for each in taken] == [Int32(5), Int32(6), None]
    assert [header for _, header in taken] == [b"{}", None, None]


def test_offer_reports_a_full_queue() -> None:
    numbers, single = subscription(queue_size=2), subscription(queue_size=1)
    assert [numbers._offer(message(number)) for number in range(4)] == [False, True, True, True]
    assert [single._offer(message(number)) for number in range(2)] == [True, True]
    assert (numbers.dropped, single.dropped) == (2, 1)


def test_operation_asks_for_serialized_messages_where_it_can() -> None:
    numbers = subscription()
    plain, ours = (numbers._registration(serialized=serialized) for serialized in (False, True))
    assert (plain.compression, plain.md5sum) == ("none", None)
    assert (ours.compression, ours.md5sum) == ("ros1", "da5909fbe378aeaf85e547e830cc1bb7")
