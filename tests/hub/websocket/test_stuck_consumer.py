"""Clients that stop reading: the hub keeps little for them, and others are not affected."""

from __future__ import annotations

import asyncio
import json
import socket
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from typing import Any

import pytest
from conftest import StartHub
from patience import PATIENCE

from fibws.hub.delivery.send_queue import MOST_UNWRITTEN, WRITE_SIZE
from fibws.hub.rosbridge.session import MAX_OBJECTS, RosbridgeSession
from fibws.hub.server import HubServer
from fibws.hub.settings import KIB, MIB

from ..raw_client import (
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
from .virtual_time import VirtualTime

pytestmark = pytest.mark.both_loops

FILLER = "x" * KIB
QUEUE = 100


def numbered(number: int) -> bytes:
    """Return the frame of a message of about a kilobyte that begins with its number."""
    return publish("/t", f"{number} {FILLER}")


def numbers(received: list[Any]) -> list[int]:
    """Return the numbers of such messages."""
    return [int(each.split()[0]) for each in received]


class TestStuckConsumer:
    """R1 and R2: a client that stops reading, by mistake or on purpose."""

    async def test_others_are_not_affected_and_the_hub_keeps_little(
        self, start_hub: StartHub
    ) -> None:
        hub = await start_hub()
        count = 20_000
        async with _company(hub) as (_stuck, listener, talker):
            assert numbers(await _publish_and_receive(talker, listener, range(count))) == list(
                range(count)
            )
            (slow,) = [each for each in hub._connections if each.queue.dropped]
            assert slow.queue.kept_bytes < 2 * QUEUE * KIB
            assert slow._transport.get_write_buffer_size() < MIB

    async def test_stuck_client_gets_stale_then_newest_messages_in_order(
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
            await _publish_and_receive(talker, listener, range(count))
            dropped = hub.health()["dropped"]
            assert isinstance(dropped, int)
            (slow,) = await _slow_clients(hub)
            assert slow["node"] == "/sleeper"
            assert slow["dropped"] == dropped
            await until(lambda: "/sleeper reads too slowly: " in caplog.text)

            received = numbers(await sleeper.receive_data(count - dropped))
            await talker.send(numbered(count))
            received += numbers(await sleeper.receive_data(1))
        stale = len(received) - QUEUE - 1
        assert received[:stale] == list(range(stale))
        assert received[stale:] == list(range(count - QUEUE, count + 1))

    async def test_replies_to_a_stuck_client_are_kept(self, start_hub: StartHub) -> None:
        hub = await start_hub()
        async with _company(hub) as (stuck, listener, talker):
            await _publish_and_receive(talker, listener, range(5000))
            await stuck.send_operation("nope", id="mine")
            while (received := await stuck.receive())["op"] == "publish":
                pass
            assert received["id"] == "mine"

    async def test_stuck_client_is_closed_with_the_reason(
        self, start_hub: StartHub, caplog: pytest.LogCaptureFixture
    ) -> None:
        hub = await start_hub(stall_timeout=0.2, close_timeout=5.0)
        async with _company(hub) as (stuck, listener, talker):
            await _publish_and_receive(talker, listener, range(5000))
            await until(lambda: "/stuck is closed" in caplog.text)
            assert "/stuck" not in hub.graph.nodes
            _, code, reason = await stuck.receive_all()
            await talker.is_processed()
        assert (code, reason) == (1008, "stopped reading for too long")
        assert "/stuck reads too slowly: " in caplog.text
        assert "/stuck is closed: stopped reading for too long." in caplog.text

    async def test_stuck_client_that_does_not_read_the_close_is_cut_off(
        self, start_hub: StartHub
    ) -> None:
        hub = await start_hub(stall_timeout=0.1, close_timeout=0.1)
        async with _company(hub) as (stuck, listener, talker):
            await _publish_and_receive(talker, listener, range(5000))
            await until(lambda: len(hub._connections) == 2)
            with pytest.raises((Gone, ConnectionError)):
                await stuck.receive_all()

    async def test_slow_but_steady_reader_is_not_closed(self, start_hub: StartHub) -> None:
        """A long message over a slow line may take longer than a client may stop reading."""
        hub = await start_hub(stall_timeout=10.0)
        clock = VirtualTime(hub)
        size, pieces = 4 * MIB, 0
        async with (
            connected(hub.port, "/?node=/slow", receive_buffer=64 * KIB) as slow,
            connected(hub.port) as talker,
        ):
            await slow.subscribes("/t", "std_msgs/String")
            await talker.advertises("/t", "std_msgs/String")
            await talker.send(publish("/t", "x" * size))
            await talker.is_processed()
            (connection,) = [each for each in hub._connections if each.name == "/slow"]
            loop = asyncio.get_running_loop()
            got = 0
            while got < size:
                unread = connection._unread()
                while got < size and connection._unread() == unread:
                    data = await loop.sock_recv(slow.socket, 64 * KIB)
                    assert data, "the hub has closed the connection"
                    got += len(data)
                clock.advance(9.0)
                pieces += 1
            assert len(nodes(hub)) == 2
        assert pieces > 5  # Together they took much longer than a client may stop reading.

    async def test_hub_closes_in_time_despite_a_stuck_client(self, start_hub: StartHub) -> None:
        hub = await start_hub(close_timeout=0.3)
        async with _company(hub) as (_stuck, listener, talker):
            await _publish_and_receive(talker, listener, range(5000))
            async with asyncio.timeout(PATIENCE):
                await hub.close()
            assert (await listener.is_closed())[0] == 1001

    async def test_client_that_half_closes_and_does_not_read_is_cut_off(
        self, start_hub: StartHub
    ) -> None:
        hub = await start_hub(close_timeout=0.1)
        async with _company(hub) as (stuck, listener, talker):
            await _publish_and_receive(talker, listener, range(2000))
            stuck.socket.shutdown(socket.SHUT_WR)
            await until(lambda: len(hub._connections) == 2)
            await _publish_and_receive(talker, listener, range(10))

    async def test_client_that_never_reads_replies_is_closed(
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

    async def test_client_that_never_reads_pongs_is_cut_off(self, start_hub: StartHub) -> None:
        hub = await start_hub(max_queued_bytes=MIB)
        async with connected(hub.port, receive_buffer=4 * KIB) as stuck:
            pings = frame(PING, bytes(125)) * 1000
            with pytest.raises(OSError):
                for _ in range(100):
                    await stuck.send(pings)
            await until(lambda: not hub._connections)

    async def test_client_that_pings_while_reading_a_long_message_stays(
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
            await talker.is_processed()
            await patient.send(frame(PING, b"still here"))
            await talker.is_processed()
            assert len((await patient.receive_data(1))[0]) == 4 * MIB
            assert await patient.frame() == (PONG, b"still here")

    async def test_messages_of_one_turn_are_bounded(self, start_hub: StartHub) -> None:
        """One frame may hold a thousand operations, whose messages leave in one turn."""
        hub = await start_hub(max_queued_bytes=MIB)
        message = {"op": "publish", "topic": "/t", "msg": {"data": FILLER * 16}}
        async with (
            connected(hub.port, receive_buffer=4 * KIB) as stuck,
            connected(hub.port) as talker,
        ):
            await stuck.subscribes("/t", "std_msgs/String", queue_length=QUEUE)
            await talker.advertises("/t", "std_msgs/String")
            await talker.send(frame(TEXT, json.dumps(message).encode() * MAX_OBJECTS))
            await talker.is_processed()
            (slow,) = [each for each in hub._connections if each.queue.paused]
            kept = slow._transport.get_write_buffer_size() + slow.queue.kept_bytes
            assert kept < MOST_UNWRITTEN + 2 * MIB
            stuck.reset()

    async def test_repeated_latched_messages_for_a_stuck_client_are_bounded(
        self, start_hub: StartHub
    ) -> None:
        """Each small subscribe is answered by a message of a megabyte."""
        limit = 4 * MIB
        hub = await start_hub(max_queued_bytes=limit)
        async with (
            connected(hub.port, "/?node=/stuck", receive_buffer=4 * KIB) as stuck,
            connected(hub.port) as talker,
        ):
            await talker.advertises("/t", "std_msgs/String", latch=True)
            await talker.send(publish("/t", "x" * MIB))
            await talker.is_processed()
            asked = [operation("subscribe", topic="/t", id=number) for number in range(90)]
            await stuck.send(*asked[:30])
            one_text = b"".join(
                json.dumps({"op": "subscribe", "topic": "/t", "id": number}).encode()
                for number in range(30, 90)
            )
            await stuck.send(frame(TEXT, one_text))
            await until(lambda: _requests(hub, "/stuck") == 90)
            (slow,) = [each for each in hub._connections if each.name == "/stuck"]
            assert slow._transport.get_write_buffer_size() + slow.queue.kept_bytes < limit + 3 * MIB
            stuck.reset()

    async def test_slow_reader_gets_fresh_messages(self, start_hub: StartHub) -> None:
        """A client reading a tenth of the messages gets them at most two seconds old at 10 MB/s."""
        hub = await start_hub()
        size, at_once, rounds = 10_000, 100, 40
        filler = "x" * size
        ages: list[int] = []
        async with (
            connected(hub.port, "/?node=/slow", receive_buffer=64 * KIB) as slow,
            connected(hub.port) as talker,
        ):
            await slow.subscribes("/t", "std_msgs/String", queue_length=1000)
            await talker.advertises("/t", "std_msgs/String")
            for end in range(at_once, (rounds + 1) * at_once, at_once):
                await talker.send(
                    *(publish("/t", f"{number} {filler}") for number in range(end - at_once, end))
                )
                await talker.is_processed()
                received = numbers(await slow.receive_data(at_once // 10))
                assert received == sorted(received)
                ages += [(end - number) * size for number in received]
            (queue,) = [each.queue for each in hub._connections if each.name == "/slow"]
            assert queue.kept_bytes <= hub.settings.max_queued_bytes
        assert max(ages) <= 20_000_000

    @pytest.mark.parametrize("size", [100, 300_000])
    async def test_bytes_kept_for_a_stuck_client_are_limited(
        self, start_hub: StartHub, size: int
    ) -> None:
        limit = 512 * KIB
        hub = await start_hub(max_queued_bytes=limit)
        async with (
            connected(hub.port, "/?node=/stuck", receive_buffer=4 * KIB) as stuck,
            connected(hub.port) as talker,
        ):
            await stuck.subscribes("/t", "std_msgs/String", queue_length=10**6)
            await stuck.subscribes(
                "t", "std_msgs/String", queue_length=10**6, throttle_rate=1_000_000
            )
            await talker.advertises("/t", "std_msgs/String")
            (slow,) = [each for each in hub._connections if each.name == "/stuck"]
            for _ in range(5):
                message = {"op": "publish", "topic": "/t", "msg": {"data": "x" * size}}
                count = min(MAX_OBJECTS, 4 * MIB // size)
                await talker.send(frame(TEXT, json.dumps(message).encode() * count))
                await stuck.send_operation("call_service", service="/rosapi/topics")
                await talker.is_processed()
                assert slow.queue.kept_bytes <= limit + size + KIB
                assert slow._transport.get_write_buffer_size() <= WRITE_SIZE + 64 * KIB + size
            stuck.reset()

    async def test_dropped_and_throttled_messages_are_shown_by_topic(
        self, start_hub: StartHub
    ) -> None:
        hub = await start_hub()
        async with connected(hub.port, "/?node=/slow") as slow, connected(hub.port) as talker:
            await slow.subscribes("/short", "std_msgs/String", queue_length=1)
            await slow.subscribes("/calm", "std_msgs/String", throttle_rate=1_000_000)
            for topic in ("/short", "/calm"):
                await talker.advertises(topic, "std_msgs/String")
            (connection,) = [each for each in hub._connections if each.name == "/slow"]
            connection.queue.pause()
            for _ in range(5):
                await talker.send(publish("/short", "x"), publish("/calm", "x"))
            await talker.is_processed()
            (shown,) = await _slow_clients(hub)
            assert shown["dropped_by_topic"] == {"/short": 4}
            assert shown["throttled_by_topic"] == {"/calm": 4}

    async def test_dropped_messages_still_count_after_the_client_left(
        self, start_hub: StartHub
    ) -> None:
        hub = await start_hub()
        async with connected(hub.port) as listener, connected(hub.port) as talker:
            await listener.subscribes("/t", "std_msgs/String", queue_length=2000)
            await talker.advertises("/t", "std_msgs/String")
            async with connected(hub.port, receive_buffer=4 * KIB) as stuck:
                await stuck.subscribes("/t", "std_msgs/String", queue_length=QUEUE)
                await _publish_and_receive(talker, listener, range(20_000))
                dropped = hub.health()["dropped"]
                assert isinstance(dropped, int)
                assert dropped > 0
                stuck.reset()
            await until(lambda: len(hub._connections) == 2)
            health = hub.health()
            assert (health["dropped"], health["slow_clients"]) == (dropped, [])


@asynccontextmanager
async def _company(hub: HubServer) -> AsyncIterator[tuple[Client, Client, Client]]:
    """Connect a subscriber that does not read, one that does, and a publisher."""
    async with (
        connected(hub.port, "/?node=/stuck", receive_buffer=4 * KIB) as stuck,
        connected(hub.port) as listener,
        connected(hub.port) as talker,
    ):
        for client in (stuck, listener):
            await client.subscribes("/t", "std_msgs/String", queue_length=QUEUE)
        await talker.advertises("/t", "std_msgs/String")
        yield stuck, listener, talker


def _requests(hub: HubServer, node: str) -> int:
    """Return the number of a client's subscribe requests."""
    session = hub.graph.nodes[node]
    assert isinstance(session, RosbridgeSession)
    return sum(len(each.requests) for each in session.topics.subscriptions.values())


async def _publish_and_receive(talker: Client, listener: Client, which: range) -> list[Any]:
    """Publish numbered messages, and return those that a subscriber received."""

    async def talk() -> None:
        for start in range(which.start, which.stop, 50):
            stop = min(start + 50, which.stop)
            await talker.send(*(numbered(number) for number in range(start, stop)))

    talking = asyncio.create_task(talk())
    received = await listener.receive_data(len(which))
    await talking
    return received


async def _last_words(client: Client) -> tuple[int, int, str]:
    """Return how many frames came before the close, and its code and reason."""
    count = 0
    while (received := await client.frame())[0] != CLOSE:
        count += 1
    return count, int.from_bytes(received[1][:2], "big"), received[1][2:].decode()


async def _slow_clients(hub: HubServer) -> list[dict[str, Any]]:
    """As ``/healthz`` shows them."""
    async with dialled(hub.port) as client:
        await client.send(b"GET /healthz HTTP/1.1\r\n\r\n")
        slow: list[dict[str, Any]] = json.loads((await client.response())[2])["slow_clients"]
        return slow
