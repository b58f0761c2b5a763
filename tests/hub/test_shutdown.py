"""Shutdown: every client gets a close frame, and no client delays it."""

from __future__ import annotations

import asyncio
import logging
import socket
from contextlib import AsyncExitStack

import pytest
from conftest import StartHub
from ports import port as port

from fibws.hub.server import DRAIN_INTERVAL, DRAIN_RATE, HubServer

from .raw_client import CLOSE, Gone, connected, dialled, frame, publish, timers, until

pytestmark = pytest.mark.both_loops


class TestEnd:
    async def test_all_clients_get_the_close_reason(self, start_hub: StartHub) -> None:
        hub = await start_hub()
        async with AsyncExitStack() as stack:
            clients = [await stack.enter_async_context(connected(hub.port)) for _ in range(20)]
            end = asyncio.create_task(hub.close())
            for client in clients:
                assert await client.is_closed() == (1001, "the hub is shutting down")
                await client.send(frame(CLOSE, b"\x03\xe9"))
                assert await client.to_the_end() == b""
                client.leave()
            await end

    async def test_pending_messages_are_sent_before_the_close(self, start_hub: StartHub) -> None:
        hub = await start_hub(close_timeout=0.2)
        async with connected(hub.port) as client, connected(hub.port) as talker:
            await client.subscribes("/t")
            await talker.advertises("/t")
            await talker.send(publish("/t", 1))
            await talker.is_processed()
            _, received = await asyncio.gather(hub.close(), client.receive_all())
        assert received == ([1], 1001, "the hub is shutting down")

    async def test_clients_that_do_not_answer_are_cut_off_in_time(
        self, start_hub: StartHub
    ) -> None:
        hub = await start_hub(close_timeout=0.1)
        async with connected(hub.port), dialled(hub.port) as silent:
            await until(lambda: len(hub._connections) == 2)
            async with asyncio.timeout(60):
                await hub.close()
            assert not hub._connections
            with pytest.raises((Gone, ConnectionError)):
                await silent.frame()

    @pytest.mark.parametrize("turns", range(6))
    async def test_client_that_connects_during_shutdown_does_not_delay_it(
        self, start_hub: StartHub, turns: int
    ) -> None:
        """However far the loop has come with accepting it."""
        hub = await start_hub(close_timeout=0.2)
        with socket.socket() as late:
            late.connect(("127.0.0.1", hub.port))
            for _ in range(turns):
                await asyncio.sleep(0)
            async with asyncio.timeout(60):
                await hub.close()
                late.setblocking(False)
                try:
                    assert await asyncio.get_running_loop().sock_recv(late, 1) == b""
                except ConnectionResetError:
                    pass
            assert not hub._connections

    async def test_hub_may_be_closed_twice(self, hub: HubServer) -> None:
        await hub.close()
        await hub.close()

    async def test_connections_are_refused_after_shutdown(
        self, start_hub: StartHub, port: int
    ) -> None:
        hub = await start_hub(port=port)
        await hub.close()
        with pytest.raises(ConnectionRefusedError):
            async with dialled(port):
                pass

    async def test_port_is_free_at_once(self, start_hub: StartHub, port: int) -> None:
        hub = await start_hub(port=port)
        async with connected(port) as client:
            await client.is_processed()
            end = asyncio.create_task(hub.close())
            assert (await client.is_closed())[0] == 1001
            client.leave()
            await end
        again = await start_hub(port=port)
        async with connected(again.port) as client:
            await client.is_processed()

    async def test_no_timer_is_left(self, start_hub: StartHub) -> None:
        hub = await start_hub(close_timeout=0.1)
        async with connected(hub.port) as client:
            await client.subscribes("/t", throttle_rate=10_000, queue_length=5)
            await client.send(*(publish("/t", number) for number in range(3)))
            await client.receive_data(1)
            await client.is_processed()
            await hub.close()
        assert [timer for timer in timers() if "fibws" in repr(timer)] == []

    async def test_leaving_is_logged_once(
        self, hub: HubServer, caplog: pytest.LogCaptureFixture
    ) -> None:
        caplog.set_level(logging.INFO)
        async with connected(hub.port, "/?node=/a") as client:
            await client.is_processed()
            end = asyncio.create_task(hub.close())
            await client.is_closed()
            client.leave()
            await end
        assert caplog.text.count("/a is closed: the hub is shutting down.") == 1


class TestDrain:
    async def test_clients_are_closed_little_by_little(
        self, start_hub: StartHub, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        hub = await start_hub()
        pauses: list[float] = []
        sleep = asyncio.sleep

        async def pause(seconds: float) -> None:
            pauses.append(seconds)
            await sleep(0)

        monkeypatch.setattr("fibws.hub.server.asyncio.sleep", pause)
        async with AsyncExitStack() as stack:
            clients = [await stack.enter_async_context(connected(hub.port)) for _ in range(40)]
            draining = asyncio.create_task(hub.drain(600))
            for client in clients:
                assert await client.is_closed() == (1012, "service restart")
                client.leave()
            await draining
        assert len(pauses) == pytest.approx(40 / DRAIN_RATE / DRAIN_INTERVAL, abs=1)

    @pytest.mark.parametrize("seconds", [0.0, 2 * DRAIN_INTERVAL])
    async def test_many_clients_are_closed_in_time(
        self, start_hub: StartHub, monkeypatch: pytest.MonkeyPatch, seconds: float
    ) -> None:
        hub = await start_hub()
        pauses: list[float] = []
        sleep = asyncio.sleep

        async def pause(length: float) -> None:
            pauses.append(length)
            await sleep(0)

        monkeypatch.setattr("fibws.hub.server.asyncio.sleep", pause)
        async with AsyncExitStack() as stack:
            clients = [await stack.enter_async_context(connected(hub.port)) for _ in range(40)]
            draining = asyncio.create_task(hub.drain(seconds))
            for client in clients:
                assert (await client.is_closed())[0] == 1012
                client.leave()
            await draining
        assert sum(pauses) <= seconds

    async def test_hub_without_clients_is_drained_at_once(self, hub: HubServer) -> None:
        async with asyncio.timeout(60):
            await hub.drain(600)

    async def test_client_that_does_not_answer_delays_it_no_longer_than_a_close(
        self, start_hub: StartHub
    ) -> None:
        hub = await start_hub(close_timeout=0.1)
        async with connected(hub.port), asyncio.timeout(60):
            await hub.drain(600)
