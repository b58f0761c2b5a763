"""A client that publishes without end, and subscribers that disconnect: others are not affected."""

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

from fibws.hub.graph.topic import Source
from fibws.hub.server import HubServer
from fibws.hub.settings import MIB

from ..raw_client import Client, connected, dialled, longest_turn, publish, until

pytestmark = pytest.mark.both_loops


class TestFlooder:
    """R3: a client that publishes as fast as it can."""

    async def test_others_communicate_and_connect_during_a_flood(self, start_hub: StartHub) -> None:
        hub = await start_hub()
        async with connected(hub.port) as one, connected(hub.port) as flooder:
            await one.subscribes("/quiet")
            await flooder.advertises("/loud")
            with _flood(flooder, publish("/loud", 1) * 20_000):
                trips, entries = [], []
                for number in range(40):
                    began = time.thread_time()
                    await one.send(publish("/quiet", number))
                    assert await one.receive_data(1) == [number]
                    trips.append(time.thread_time() - began)
                for _ in range(10):
                    began = time.thread_time()
                    async with connected(hub.port):
                        entries.append(time.thread_time() - began)
        # In CPU time of this thread: the flooding one shares Python's lock with it.
        assert statistics.median(trips) < 0.1
        assert statistics.median(entries) < 0.2

    async def test_others_communicate_during_a_flood_of_large_messages(
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
                    assert await one.receive_data(1) == [number]
                    trips.append(time.thread_time() - began)
        assert statistics.median(trips) < 0.1

    async def test_flood_during_the_handshake_does_not_harm_others(
        self, start_hub: StartHub
    ) -> None:
        hub = await start_hub()
        async with dialled(hub.port) as flooder, connected(hub.port) as one:
            with _flood(flooder, b"X: y\r\n" * 20_000):
                for _ in range(20):
                    await one.is_processed()

    async def test_turns_of_the_event_loop_are_short(self, hub: HubServer) -> None:
        async with connected(hub.port) as client:
            await client.advertises("/t", "std_msgs/String")
            async with longest_turn() as longest:
                await client.send(publish("/t", "x" * 100) * 20_000)
                await client.is_processed()
        assert longest() < 0.25


class TestDeadSubscriber:
    """R4: failures of a subscriber do not harm the publisher."""

    async def test_publisher_survives_the_resets_of_its_subscribers(self, hub: HubServer) -> None:
        async with connected(hub.port) as talker, connected(hub.port) as listener:
            await talker.advertises("/t")
            await listener.subscribes("/t")
            for number in range(50):
                async with connected(hub.port) as dying:
                    await dying.subscribes("/t")
                    await talker.send(publish("/t", 2 * number))
                    dying.reset()
                    await talker.send(publish("/t", 2 * number + 1))
            assert await listener.receive_data(100) == list(range(100))
            await until(lambda: len(hub._connections) == 2)

    async def test_publisher_survives_a_subscribers_socket_closing_in_the_same_turn(
        self, hub: HubServer
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
            # The hub does not know yet that it lost the connection.
            talker.socket.send(publish("/t", 1))
            assert await listener.receive_data(1) == [1]

    async def test_write_that_raises_ends_only_its_own_connection(
        self, hub: HubServer, monkeypatch: pytest.MonkeyPatch
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
            monkeypatch.setattr(connection.queue, "_write", fail)
            await talker.send(publish("/t", 1), publish("/t", 2))
            assert await listener.receive_data(2) == [1, 2]
            await until(lambda: len(hub._connections) == 2)

    async def test_operation_that_fails_ends_no_connection(
        self, hub: HubServer, faults: Faults, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        def fail(*_: Any) -> None:
            raise ZeroDivisionError("injected")

        async with connected(hub.port) as talker, connected(hub.port) as listener:
            await listener.subscribes("/t")
            await talker.advertises("/t")
            with monkeypatch.context() as broken:
                broken.setattr(Source, "publish", fail)
                await talker.send(publish("/t", 1))
                assert (await talker.receive())["level"] == "error"
            await talker.send(publish("/t", 2))
            assert await listener.receive_data(1) == [2]
        faults.expect("injected")
        faults.expect("Cannot publish on /rosout")  # It failed to report the first fault, too.


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
