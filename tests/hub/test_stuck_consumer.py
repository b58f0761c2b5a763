"""What one who stops reading may do to the hub, and to others: not much."""

from __future__ import annotations

import asyncio
import json
import socket
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from typing import Any

import pytest
from conftest import StartHub

from fibws.hub import Hub
from fibws.hub.settings import KIB, MIB

from .wire import (
    CLOSE,
    PING,
    PONG,
    TEXT,
    Client,
    Gone,
    connected,
    dialled,
    frame,
    nodes,
    operation,
    publish,
    until,
)

pytestmark = pytest.mark.both_loops

FILLER = "x" * KIB
QUEUE = 100


def numbered(number: int) -> bytes:
    """A message of about a kilobyte that begins with its number."""
    return publish("/t", f"{number} {FILLER}")


def numbers(heard: list[Any]) -> list[int]:
    """The numbers of such messages."""
    return [int(each.split()[0]) for each in heard]


class TestStuckConsumer:
    """R1 and R2: one who stops reading, by mistake or on purpose."""

    async def test_nobody_else_notices_and_the_hub_keeps_little(self, start_hub: StartHub) -> None:
        hub = await start_hub()
        count = 20_000
        async with _company(hub) as (_stuck, listener, talker):
            assert numbers(await _told(talker, listener, range(count))) == list(range(count))
            (slow,) = [each for each in hub._connections if each.outbox.dropped]
            assert slow.outbox.kept_bytes < 2 * QUEUE * KIB
            assert slow._transport.get_write_buffer_size() < MIB

    async def test_when_it_wakes_it_hears_the_stale_and_then_the_newest_in_order(
        self, start_hub: StartHub, caplog: pytest.LogCaptureFixture
    ) -> None:
        hub = await start_hub()
        count = 20_000
        async with (
            connected(hub.port, "/?node=/sleeper", receive_buffer=4 * KIB) as sleeper,
            connected(hub.port) as listener,
            connected(hub.port) as talker,
        ):
            for client in (sleeper, listener):
                await client.subscribes("/t", "std_msgs/String", queue_length=QUEUE)
            await talker.advertises("/t", "std_msgs/String")
            await _told(talker, listener, range(count))
            dropped = hub.health()["dropped"]
            assert isinstance(dropped, int)
            (slow,) = await _slow_clients(hub)
            assert slow["node"] == "/sleeper"
            assert slow["dropped"] == dropped
            await until(lambda: "/sleeper reads too slowly: " in caplog.text)

            heard = numbers(await sleeper.hears_data(count - dropped))
            await talker.send(numbered(count))
            heard += numbers(await sleeper.hears_data(1))
        stale = len(heard) - QUEUE - 1
        assert heard[:stale] == list(range(stale))
        assert heard[stale:] == list(range(count - QUEUE, count + 1))

    async def test_its_replies_are_kept(self, start_hub: StartHub) -> None:
        hub = await start_hub()
        async with _company(hub) as (stuck, listener, talker):
            await _told(talker, listener, range(5000))
            await stuck.says("nope", id="mine")
            while (heard := await stuck.hears())["op"] == "publish":
                pass
            assert heard["id"] == "mine"

    async def test_it_is_closed_with_the_reason(
        self, start_hub: StartHub, caplog: pytest.LogCaptureFixture
    ) -> None:
        hub = await start_hub(stall_timeout=0.2, close_timeout=5.0)
        async with _company(hub) as (stuck, listener, talker):
            await _told(talker, listener, range(5000))
            await until(lambda: "/stuck is closed" in caplog.text)
            assert "/stuck" not in hub.graph.nodes
            _, code, reason = await stuck.hears_all()
            await talker.is_heard()
        assert (code, reason) == (1008, "stopped reading for too long")
        assert "/stuck reads too slowly: " in caplog.text
        assert "/stuck is closed: stopped reading for too long." in caplog.text

    async def test_it_is_cut_off_if_it_does_not_read_even_that(self, start_hub: StartHub) -> None:
        hub = await start_hub(stall_timeout=0.1, close_timeout=0.1)
        async with _company(hub) as (stuck, listener, talker):
            await _told(talker, listener, range(5000))
            await until(lambda: len(hub._connections) == 2)
            with pytest.raises((Gone, ConnectionError)):
                await stuck.hears_all()

    async def test_one_who_reads_slowly_but_steadily_is_not_stuck(
        self, start_hub: StartHub
    ) -> None:
        """A long message over a slow line may take longer than a client may stop reading."""
        hub = await start_hub(stall_timeout=0.3)
        size = 4 * MIB
        async with (
            connected(hub.port, receive_buffer=64 * KIB) as slow,
            connected(hub.port) as talker,
        ):
            await slow.subscribes("/t", "std_msgs/String")
            await talker.advertises("/t", "std_msgs/String")
            await talker.send(publish("/t", "x" * size))
            await talker.is_heard()
            got = 0
            loop = asyncio.get_running_loop()
            began = loop.time()
            while got < size:
                got += len(await loop.sock_recv(slow.socket, 64 * KIB))
                # As much as a line of 4 MB/s lets through.
                await asyncio.sleep(max(0.0, began + got / (4 * MIB) - loop.time()))
            assert len(nodes(hub)) == 2

    async def test_the_hub_closes_in_time_in_spite_of_it(self, start_hub: StartHub) -> None:
        hub = await start_hub(close_timeout=0.3)
        async with _company(hub) as (_stuck, listener, talker):
            await _told(talker, listener, range(5000))
            loop = asyncio.get_running_loop()
            began = loop.time()
            await hub.close()
            assert loop.time() - began < 30
            assert (await listener.is_closed())[0] == 1001

    async def test_one_who_half_closes_and_does_not_read_is_cut_off(
        self, start_hub: StartHub
    ) -> None:
        hub = await start_hub(close_timeout=0.1)
        async with _company(hub) as (stuck, listener, talker):
            await _told(talker, listener, range(2000))
            stuck.socket.shutdown(socket.SHUT_WR)
            await until(lambda: len(hub._connections) == 2)
            await _told(talker, listener, range(10))

    async def test_one_who_asks_and_never_reads_the_answers_is_closed(
        self, start_hub: StartHub, caplog: pytest.LogCaptureFixture
    ) -> None:
        hub = await start_hub(max_queued_bytes=MIB)
        async with connected(hub.port, receive_buffer=4 * KIB) as stuck:
            errors = frame(TEXT, b"{}") * 1000
            while "too many replies wait to be read" not in caplog.text:
                await stuck.send(errors)
            assert nodes(hub) == []
            _, code, _ = await _last_words(stuck)
        assert code == 1008

    async def test_one_who_pings_and_never_reads_the_pongs_is_cut_off(
        self, start_hub: StartHub
    ) -> None:
        hub = await start_hub(max_queued_bytes=MIB)
        async with connected(hub.port, receive_buffer=4 * KIB) as stuck:
            pings = frame(PING, bytes(125)) * 1000
            with pytest.raises(OSError):
                for _ in range(100):
                    await stuck.send(pings)
            await until(lambda: not hub._connections)

    async def test_one_who_pings_while_it_reads_a_long_message_is_not(
        self, start_hub: StartHub
    ) -> None:
        hub = await start_hub(max_queued_bytes=MIB)
        async with (
            connected(hub.port, receive_buffer=4 * KIB) as patient,
            connected(hub.port) as talker,
        ):
            await patient.subscribes("/t", "std_msgs/String")
            await talker.advertises("/t", "std_msgs/String")
            await talker.send(publish("/t", "x" * 4 * MIB))
            await talker.is_heard()
            await patient.send(frame(PING, b"still here"))
            await talker.is_heard()
            assert len((await patient.hears_data(1))[0]) == 4 * MIB
            assert await patient.frame() == (PONG, b"still here")

    async def test_one_turn_of_messages_is_bounded_too(self, start_hub: StartHub) -> None:
        """One frame may hold thousands of operations: what comes of them in one turn has bounds."""
        hub = await start_hub(max_queued_bytes=MIB)
        one = json.dumps({"op": "publish", "topic": "/t", "msg": {"data": FILLER}}).encode()
        async with (
            connected(hub.port, receive_buffer=4 * KIB) as stuck,
            connected(hub.port) as talker,
        ):
            await stuck.subscribes("/t", "std_msgs/String", queue_length=QUEUE)
            await talker.advertises("/t", "std_msgs/String")
            await talker.send(frame(TEXT, one * 16 * KIB))
            await talker.is_heard()
            (slow,) = [each for each in hub._connections if each.outbox.paused]
            assert slow._transport.get_write_buffer_size() + slow.outbox.kept_bytes < 4 * MIB
            stuck.reset()

    async def test_one_who_asks_again_and_again_for_what_is_latched_is_bounded_too(
        self, start_hub: StartHub
    ) -> None:
        """A subscribe of a few bytes is answered by a megabyte."""
        limit = 4 * MIB
        hub = await start_hub(max_queued_bytes=limit)
        async with (
            connected(hub.port, "/?node=/stuck", receive_buffer=4 * KIB) as stuck,
            connected(hub.port) as talker,
        ):
            await talker.advertises("/t", "std_msgs/String", latch=True)
            await talker.send(publish("/t", "x" * MIB))
            await talker.is_heard()
            asked = [operation("subscribe", topic="/t", id=number) for number in range(90)]
            await stuck.send(*asked[:30])
            one_text = b"".join(
                json.dumps({"op": "subscribe", "topic": "/t", "id": number}).encode()
                for number in range(30, 90)
            )
            await stuck.send(frame(TEXT, one_text))
            await until(lambda: _requests(hub, "/stuck") == 90)
            (slow,) = [each for each in hub._connections if each.name == "/stuck"]
            assert (
                slow._transport.get_write_buffer_size() + slow.outbox.kept_bytes < limit + 3 * MIB
            )
            stuck.reset()

    async def test_what_was_dropped_still_counts_when_it_has_left(
        self, start_hub: StartHub
    ) -> None:
        hub = await start_hub()
        async with connected(hub.port) as listener, connected(hub.port) as talker:
            await listener.subscribes("/t", "std_msgs/String", queue_length=2000)
            await talker.advertises("/t", "std_msgs/String")
            async with connected(hub.port, receive_buffer=4 * KIB) as stuck:
                await stuck.subscribes("/t", "std_msgs/String", queue_length=QUEUE)
                await _told(talker, listener, range(20_000))
                dropped = hub.health()["dropped"]
                assert isinstance(dropped, int)
                assert dropped > 0
                stuck.reset()
            await until(lambda: len(hub._connections) == 2)
            health = hub.health()
            assert (health["dropped"], health["slow_clients"]) == (dropped, [])


@asynccontextmanager
async def _company(hub: Hub) -> AsyncIterator[tuple[Client, Client, Client]]:
    """One who does not read and one who does, both listening to a third."""
    async with (
        connected(hub.port, "/?node=/stuck", receive_buffer=4 * KIB) as stuck,
        connected(hub.port) as listener,
        connected(hub.port) as talker,
    ):
        for client in (stuck, listener):
            await client.subscribes("/t", "std_msgs/String", queue_length=QUEUE)
        await talker.advertises("/t", "std_msgs/String")
        yield stuck, listener, talker


def _requests(hub: Hub, node: str) -> int:
    """How many subscribes of a client stand."""
    return sum(
        len(each.requests)
        for topic in hub.graph.topics.values()
        for each in topic.subscriptions()
        if each.node == node
    )


async def _told(talker: Client, listener: Client, which: range) -> list[Any]:
    """Have one client tell another numbered messages, and return what it heard."""

    async def talk() -> None:
        for start in range(which.start, which.stop, 50):
            stop = min(start + 50, which.stop)
            await talker.send(*(numbered(number) for number in range(start, stop)))

    talking = asyncio.create_task(talk())
    heard = await listener.hears_data(len(which))
    await talking
    return heard


async def _last_words(client: Client) -> tuple[int, int, str]:
    """How many frames came before the close, and its code and reason."""
    count = 0
    while (heard := await client.frame())[0] != CLOSE:
        count += 1
    return count, int.from_bytes(heard[1][:2], "big"), heard[1][2:].decode()


async def _slow_clients(hub: Hub) -> list[dict[str, Any]]:
    """As ``/healthz`` shows them."""
    async with dialled(hub.port) as client:
        await client.send(b"GET /healthz HTTP/1.1\r\n\r\n")
        slow: list[dict[str, Any]] = json.loads((await client.response())[2])["slow_clients"]
        return slow
