"""One who publishes without end, and subscribers that die: others talk on."""

from __future__ import annotations

import socket
import statistics
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import pytest
from conftest import Faults, StartHub

from fibws.hub import Hub
from fibws.hub.session.topics import Topics
from fibws.hub.settings import MIB

from .wire import Client, connected, dialled, longest_turn, publish, until

pytestmark = pytest.mark.both_loops


class TestFlooder:
    """R3: one who publishes as fast as it can."""

    async def test_others_talk_on_and_come_in(self, start_hub: StartHub) -> None:
        hub = await start_hub()
        async with connected(hub.port) as one, connected(hub.port) as flooder:
            await one.subscribes("/quiet")
            await flooder.advertises("/loud")
            with _flood(flooder, publish("/loud", 1) * 20_000):
                trips, entries = [], []
                for number in range(40):
                    began = time.thread_time()
                    await one.send(publish("/quiet", number))
                    assert await one.hears_data(1) == [number]
                    trips.append(time.thread_time() - began)
                for _ in range(10):
                    began = time.thread_time()
                    async with connected(hub.port):
                        entries.append(time.thread_time() - began)
        # In CPU time of this thread: the flooding one shares Python's lock with it.
        assert statistics.median(trips) < 0.1
        assert statistics.median(entries) < 0.2

    async def test_a_flood_of_large_messages_lets_others_talk_too(
        self, start_hub: StartHub
    ) -> None:
        hub = await start_hub()
        async with connected(hub.port) as one, connected(hub.port) as flooder:
            await one.subscribes("/quiet")
            await flooder.advertises("/loud", "std_msgs/String")
            with _flood(flooder, publish("/loud", "x" * MIB) * 4):
                trips = []
                for number in range(20):
                    began = time.thread_time()
                    await one.send(publish("/quiet", number))
                    assert await one.hears_data(1) == [number]
                    trips.append(time.thread_time() - began)
        assert statistics.median(trips) < 0.1

    async def test_a_flood_in_the_handshake_costs_nothing(self, start_hub: StartHub) -> None:
        hub = await start_hub()
        async with dialled(hub.port) as flooder, connected(hub.port) as one:
            with _flood(flooder, b"X: y\r\n" * 20_000):
                for _ in range(20):
                    await one.is_heard()

    async def test_no_turn_is_long(self, hub: Hub) -> None:
        async with connected(hub.port) as client:
            await client.advertises("/t", "std_msgs/String")
            async with longest_turn() as longest:
                await client.send(publish("/t", "x" * 100) * 20_000)
                await client.is_heard()
        assert longest() < 0.25


class TestDeadSubscriber:
    """R4: what fails for a subscriber is not the publisher's fault."""

    async def test_a_publisher_survives_the_resets_of_its_subscribers(self, hub: Hub) -> None:
        async with connected(hub.port) as talker, connected(hub.port) as listener:
            await talker.advertises("/t")
            await listener.subscribes("/t")
            for number in range(50):
                async with connected(hub.port) as dying:
                    await dying.subscribes("/t")
                    await talker.send(publish("/t", 2 * number))
                    dying.reset()
                    await talker.send(publish("/t", 2 * number + 1))
            assert await listener.hears_data(100) == list(range(100))
            await until(lambda: len(hub._connections) == 2)

    async def test_a_publisher_survives_though_the_socket_dies_in_the_same_turn(
        self, hub: Hub
    ) -> None:
        async with (
            connected(hub.port) as talker,
            connected(hub.port) as listener,
            connected(hub.port, "/?node=/dying") as dying,
        ):
            await dying.subscribes("/t")
            await listener.subscribes("/t")
            await talker.advertises("/t")
            for connection in hub._connections:
                if connection.name == "/dying":
                    connection._transport.abort()
            # The hub has not been told yet that it lost the connection.
            talker.socket.send(publish("/t", 1))
            assert await listener.hears_data(1) == [1]

    async def test_a_write_that_raises_ends_only_its_own_connection(
        self, hub: Hub, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        async with (
            connected(hub.port) as talker,
            connected(hub.port) as listener,
            connected(hub.port, "/?node=/broken") as broken,
        ):
            await broken.subscribes("/t")
            await listener.subscribes("/t")
            await talker.advertises("/t")

            def fail(data: bytes) -> None:
                raise RuntimeError("unable to perform operation; the handler is closed")

            (connection,) = [each for each in hub._connections if each.name == "/broken"]
            monkeypatch.setattr(connection.outbox, "_write", fail)
            await talker.send(publish("/t", 1), publish("/t", 2))
            assert await listener.hears_data(2) == [1, 2]
            await until(lambda: len(hub._connections) == 2)

    async def test_an_operation_that_fails_ends_no_connection(
        self, hub: Hub, faults: Faults, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        def fail(*_: Any) -> None:
            raise ZeroDivisionError("injected")

        async with connected(hub.port) as talker, connected(hub.port) as listener:
            await listener.subscribes("/t")
            await talker.advertises("/t")
            with monkeypatch.context() as broken:
                broken.setattr(Topics, "publish", fail)
                await talker.send(publish("/t", 1))
                await talker.is_heard()
            await talker.send(publish("/t", 2))
            assert await listener.hears_data(1) == [2]
        faults.expect("injected")


@contextmanager
def _flood(client: Client, data: bytes) -> Iterator[None]:
    """Send the same bytes again and again in a thread, as fast as the hub takes them."""
    sock = client.socket.dup()
    sock.setblocking(True)
    stopping = threading.Event()

    def pour() -> None:
        try:
            while not stopping.is_set():
                sock.sendall(data)
        except OSError:
            pass

    thread = threading.Thread(target=pour)
    thread.start()
    try:
        yield
    finally:
        stopping.set()
        sock.shutdown(socket.SHUT_RDWR)
        thread.join()
        sock.close()
