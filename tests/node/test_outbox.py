"""What a node has yet to send."""

import asyncio
import json

from fibws.node.advertisement import Advertisement
from fibws.node.outbox import FRAME_COST, Outbox
from fibws.protocol.operations import Advertise


def advertisement(queue_size: int = 2) -> Advertisement:
    return Advertisement(Advertise(topic="/t", type="std_msgs/Int32", queue_size=queue_size))


def texts(outbox: Outbox) -> list[bytes]:
    outbox.close()
    return [outbox.pop() for _ in range(len(outbox))]


def test_frames_leave_in_order() -> None:
    outbox, first, second = Outbox(), advertisement(), advertisement()
    outbox.open()
    outbox.put(b"1", first)
    outbox.put(b"2")
    outbox.put(b"3", second)
    outbox.put(b"4", first)
    assert texts(outbox) == [b"1", b"2", b"3", b"4"]
    assert not first.waiting


def test_without_a_hub_each_publisher_keeps_its_newest() -> None:
    outbox, first, second = Outbox(), advertisement(2), advertisement(1)
    for number in range(4):
        outbox.put(b"first %d" % number, first)
        outbox.put(b"second %d" % number, second)
    assert (first.dropped, second.dropped) == (2, 3)
    assert texts(outbox) == [b"first 2", b"first 3", b"second 3"]


def test_with_a_hub_nothing_is_dropped_below_the_limit() -> None:
    outbox, publisher = Outbox(), advertisement(1)
    outbox.open()
    for number in range(5):
        outbox.put(b"%d" % number, publisher)
    assert publisher.dropped == 0
    assert texts(outbox) == [b"0", b"1", b"2", b"3", b"4"]


def test_above_the_limit_those_who_cannot_wait_keep_their_newest() -> None:
    outbox, publisher = Outbox(limit=3 * FRAME_COST), advertisement(2)
    outbox.open()
    for number in range(4):
        outbox.put(b"%d" % number, publisher)
    assert publisher.dropped == 2
    assert texts(outbox) == [b"2", b"3"]


def test_when_the_hub_is_lost_operations_go_and_the_newest_messages_stay() -> None:
    outbox, first, closed = Outbox(), advertisement(2), advertisement(2)
    outbox.open()
    for number in range(3):
        outbox.put(b"first %d" % number, first)
        outbox.put(b"closed %d" % number, closed)
        outbox.put(b"operation %d" % number)
    closed.closed = True
    outbox.lose()
    assert not outbox.connected
    assert (first.dropped, closed.dropped) == (1, 3)
    assert texts(outbox) == [b"first 1", b"first 2"]


def test_what_is_not_sent_is_counted_by_topic() -> None:
    outbox, publisher = Outbox(), advertisement()
    outbox.open()
    outbox.put(b"operation")
    outbox.put(b"1", publisher)
    outbox.put(b"2", publisher)
    assert outbox.unsent() == {"/t": 2}


def test_a_message_waits_until_it_is_taken_or_dropped() -> None:
    outbox, publisher = Outbox(), advertisement(2)
    sent, dropped, kept = (json.dumps({"msg": number}).encode() for number in range(3))
    outbox.open()
    outbox.put(sent, publisher)
    outbox.pop()
    outbox.lose()
    for text in (dropped, kept, b"newest"):
        outbox.put(text, publisher)
    assert [outbox.waits(text, publisher) for text in (sent, dropped, kept)] == [False, False, True]
    assert not outbox.waits(kept, advertisement())


async def test_who_publishes_waits_for_room() -> None:
    outbox = Outbox(limit=2 * FRAME_COST)
    outbox.open()
    outbox.put(b"1")
    await outbox.room()
    outbox.put(b"2")
    waiting = [asyncio.create_task(outbox.room()) for _ in range(2)]
    await asyncio.sleep(0)
    assert not any(task.done() for task in waiting)
    outbox.pop()
    await asyncio.gather(*waiting)


async def test_of_many_who_wait_no_more_go_on_than_there_is_room_for() -> None:
    outbox = Outbox(limit=2 * FRAME_COST)
    outbox.open()
    outbox.put(b"1")
    outbox.put(b"2")

    async def publish(text: bytes) -> None:
        await outbox.room()
        outbox.put(text)

    tasks = [asyncio.create_task(publish(text)) for text in (b"3", b"4")]
    await asyncio.sleep(0)
    outbox.pop()
    await tasks[0]
    await asyncio.sleep(0)
    assert not tasks[1].done()
    outbox.pop()
    await tasks[1]
    assert texts(outbox) == [b"3", b"4"]


async def test_nobody_waits_for_room_once_the_hub_is_lost() -> None:
    outbox = Outbox(limit=1)
    outbox.open()
    outbox.put(b"1", advertisement())
    waiting = asyncio.create_task(outbox.room())
    await asyncio.sleep(0)
    outbox.lose()
    await waiting


async def test_nobody_waits_for_room_once_the_outbox_is_closed() -> None:
    outbox = Outbox(limit=1)
    outbox.open()
    outbox.put(b"1")
    waiting = asyncio.create_task(outbox.room())
    await asyncio.sleep(0)
    outbox.close()
    await waiting


async def test_publishing_without_a_hub_gives_way_to_others() -> None:
    outbox = Outbox()
    done: list[object] = []
    task = asyncio.create_task(asyncio.sleep(0))
    task.add_done_callback(done.append)
    while not done:
        await outbox.room()


async def test_an_arrival_is_waited_for_until_there_will_be_none() -> None:
    outbox = Outbox()
    arrival = asyncio.create_task(outbox.arrival())
    await asyncio.sleep(0)
    assert not arrival.done()
    outbox.put(b"1", advertisement())
    assert await arrival
    outbox.close()
    assert await outbox.arrival()
    outbox.pop()
    assert not await outbox.arrival()


def test_a_frame_that_somebody_takes_at_once_is_not_kept() -> None:
    outbox, publisher, taken = Outbox(), advertisement(), list[bytes]()
    outbox.open()
    takes = [True]

    def take(text: bytes) -> bool:
        if takes[0]:
            taken.append(text)
        return takes[0]

    outbox.offer_first_to(take)
    outbox.put(b"1", publisher)
    takes[0] = False
    outbox.put(b"2", publisher)
    takes[0] = True
    outbox.put(b"3", publisher)
    assert taken == [b"1"], "another one waits before the third"
    outbox.lose()
    outbox.put(b"4", publisher)
    assert texts(outbox) == [b"3", b"4"]
    assert taken == [b"1"]
