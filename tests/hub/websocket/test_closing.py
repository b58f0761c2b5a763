"""The end of a connection: violations, closes, missing pongs."""

from __future__ import annotations

import asyncio
import socket
import struct
from typing import Any

import pytest
from conftest import Faults, StartHub

from fibws.hub.rosbridge.session import RosbridgeSession
from fibws.hub.server import HubServer
from fibws.hub.settings import MIB

from ..raw_client import (
    BINARY,
    CLOSE,
    CONT,
    PATIENT,
    PING,
    PONG,
    TEXT,
    connected,
    dialled,
    fragmented,
    frame,
    handshake,
    nodes,
    publish,
    topics,
    until,
)

pytestmark = pytest.mark.both_loops


class TestViolations:
    @pytest.mark.parametrize(
        ("sent", "code"),
        [
            (b"\x81\x01x", 1002),
            (frame(TEXT, b"{}", rsv=4), 1002),
            (frame(TEXT, b"{}", rsv=1), 1002),
            (frame(0x3), 1002),
            (frame(0xB), 1002),
            (frame(CONT, b"{}"), 1002),
            (frame(TEXT, b"{", fin=False) + frame(TEXT, b"}"), 1002),
            (frame(TEXT, b"{", fin=False) + frame(BINARY, b"}"), 1002),
            (frame(PING, fin=False), 1002),
            (frame(PING, bytes(126)), 1002),
            (frame(CLOSE, b"x"), 1002),
            (frame(CLOSE, struct.pack("!H", 1005)), 1002),
            (frame(CLOSE, struct.pack("!H", 1000) + b"\xff"), 1007),
            (frame(TEXT, b"\xff"), 1007),
            (frame(TEXT, b'{"op":"\xff"}'), 1007),
            (frame(TEXT, b"{}", fin=False) + frame(CONT, b"\xff"), 1007),
            (frame(TEXT, bytes(8 * MIB + 1))[:14], 1009),
            (frame(BINARY, bytes(8 * MIB + 1))[:14], 1009),
            (frame(TEXT)[:1] + b"\xff" + bytes([255] * 8) + bytes(4), 1009),
            (frame(TEXT, bytes(MIB), fin=False) + frame(CONT, bytes(8 * MIB))[:14], 1009),
        ],
        ids=repr,
    )
    async def test_connection_is_closed_with_the_right_code(
        self, any_hub: HubServer, sent: bytes, code: int
    ) -> None:
        async with connected(any_hub.port) as client:
            await client.send(sent)
            closed, _ = await client.is_closed()
            assert closed == code
            assert await client.to_the_end() == b""

    async def test_operations_before_a_violation_are_performed(self, any_hub: HubServer) -> None:
        async with connected(any_hub.port) as listener, connected(any_hub.port) as client:
            await listener.subscribes("/t")
            await client.advertises("/t")
            await client.send(publish("/t", 1), frame(0x3))
            assert await listener.receive_data(1) == [1]
            assert (await client.is_closed())[0] == 1002

    async def test_nothing_is_sent_after_the_close_frame(self, any_hub: HubServer) -> None:
        """Though others go on publishing, the client can read why it was closed."""
        async with connected(any_hub.port) as client, connected(any_hub.port) as publisher:
            await client.subscribes("/t")
            await publisher.advertises("/t")
            await client.send(frame(0x3))
            await publisher.send(*(publish("/t", number) for number in range(100)))
            await publisher.is_processed()
            await publisher.send(publish("/t", 100))
            await publisher.is_processed()
            _, code, _ = await client.receive_all()
            assert code == 1002
            assert await client.to_the_end() == b""

    async def test_failing_operation_is_logged_and_the_connection_stays(
        self, any_hub: HubServer, faults: Faults, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        # R4: an exception in the callback would be fatal to the connection.
        def fail(*_: Any) -> None:
            raise RuntimeError("injected")

        monkeypatch.setattr(RosbridgeSession, "receive_text", fail)
        async with connected(any_hub.port) as client:
            await client.send(publish("/t", 1), *fragmented(publish("/t", 1), 9))
            await client.is_processed()
        faults.expect("an operation failed")
        faults.expect("an operation failed")


class TestClosing:
    @pytest.mark.parametrize(
        "payload",
        [b"", struct.pack("!H", 1000), struct.pack("!H", 1001) + b"bye", struct.pack("!H", 4321)],
    )
    async def test_close_is_echoed_and_the_hub_hangs_up(
        self, any_hub: HubServer, payload: bytes
    ) -> None:
        async with connected(any_hub.port) as client:
            await client.send(frame(CLOSE, payload))
            assert await client.frame() == (CLOSE, payload)
            assert await client.to_the_end() == b""

    async def test_messages_published_before_the_close_are_delivered(
        self, any_hub: HubServer
    ) -> None:
        async with connected(any_hub.port) as listener, connected(any_hub.port) as client:
            await listener.subscribes("/t")
            await client.advertises("/t")
            numbers = list(range(10))
            await client.send(*(publish("/t", n) for n in numbers), frame(CLOSE))
            assert await listener.receive_data(10) == numbers

    async def test_frames_after_the_close_are_ignored(self, any_hub: HubServer) -> None:
        async with connected(any_hub.port) as listener, connected(any_hub.port) as client:
            await listener.subscribes("/t")
            await client.advertises("/t")
            await client.send(frame(CLOSE), publish("/t", 1), frame(PING))
            assert await client.frame() == (CLOSE, b"")
            assert await client.to_the_end() == b""
            await listener.is_processed()

    async def test_closing_client_is_forgotten_before_it_disconnects(
        self, any_hub: HubServer
    ) -> None:
        async with connected(any_hub.port, "/?node=/a") as client:
            await client.subscribes("/t")
            await client.send(frame(CLOSE))
            await client.to_the_end()
            assert (nodes(any_hub), topics(any_hub)) == ([], [])

    async def test_client_closed_by_the_hub_is_forgotten_before_it_disconnects(
        self, any_hub: HubServer
    ) -> None:
        async with connected(any_hub.port, "/?node=/a") as client:
            await client.subscribes("/t")
            await client.send(frame(0x3))
            await client.to_the_end()
            assert (nodes(any_hub), topics(any_hub)) == ([], [])

    @pytest.mark.parametrize("rest", [b"", b"\x81", publish("/t", 1)[:9], frame(TEXT, fin=False)])
    async def test_client_that_half_closes_within_a_frame_is_disconnected(
        self, any_hub: HubServer, rest: bytes
    ) -> None:
        async with connected(any_hub.port) as client:
            await client.send(publish("/t", 1), rest)
            client.socket.shutdown(socket.SHUT_WR)
            await client.to_the_end()
            await until(lambda: not any_hub._connections)

    @pytest.mark.parametrize("sent", [b"", b"GET / HT", handshake()[:-2]])
    async def test_client_that_leaves_during_the_handshake_is_forgotten(
        self, hub: HubServer, sent: bytes
    ) -> None:
        async with dialled(hub.port) as client:
            await client.send(sent)
            client.socket.shutdown(socket.SHUT_WR)
            assert await client.to_the_end() == b""
            await until(lambda: not hub._connections)

    async def test_client_that_never_disconnects_is_cut_off(self, start_hub: StartHub) -> None:
        hub = await start_hub(close_timeout=0.1)
        async with connected(hub.port) as client:
            await client.send(frame(CLOSE))
            await until(lambda: not hub._connections)


async def let_time_pass(hub: HubServer, monkeypatch: pytest.MonkeyPatch, seconds: float) -> None:
    """Advance the event loop's clock, as if the hub were busy meanwhile, and await its sweep."""
    loop = asyncio.get_running_loop()
    now, sweeper = loop.time, hub._sweeper
    monkeypatch.setattr(loop, "time", lambda: now() + seconds)
    await until(lambda: hub._sweeper is not sweeper)


class TestPings:
    async def test_ping_is_answered_with_its_text(self, any_hub: HubServer) -> None:
        async with connected(any_hub.port) as client:
            await client.send(frame(PING, b"x" * 125))
            assert await client.frame() == (PONG, b"x" * 125)

    async def test_hub_pings_and_accepts_the_pong(self, start_hub: StartHub) -> None:
        hub = await start_hub(ping_interval=0.05, ping_timeout=PATIENT)
        async with connected(hub.port) as client:
            for _ in range(3):
                assert (await client.frame())[0] == PING
                await client.send(frame(PONG))

    async def test_client_that_does_not_answer_is_closed(self, start_hub: StartHub) -> None:
        hub = await start_hub(ping_interval=0.05, ping_timeout=0.1)
        async with connected(hub.port) as client:
            assert (await client.frame())[0] == PING
            assert await client.is_closed() == (1011, "no answer to a ping")
            assert await client.to_the_end() == b""
            assert nodes(hub) == []

    async def test_no_second_ping_is_sent_before_the_pong(self, start_hub: StartHub) -> None:
        hub = await start_hub(ping_interval=0.02, ping_timeout=0.3)
        async with connected(hub.port) as client:
            assert (await client.frame())[0] == PING
            assert (await client.is_closed())[0] == 1011

    @pytest.mark.parametrize("ping_interval", [0.0, 1e5])
    async def test_no_pings_are_sent_with_ping_interval_0(
        self, start_hub: StartHub, monkeypatch: pytest.MonkeyPatch, ping_interval: float
    ) -> None:
        hub = await start_hub(ping_interval=ping_interval)
        async with connected(hub.port) as client:
            await let_time_pass(hub, monkeypatch, 1e6)
            if ping_interval:
                assert (await client.frame())[0] == PING
            await client.is_processed()

    async def test_clients_are_not_blamed_for_a_busy_hub(
        self, start_hub: StartHub, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        hub = await start_hub(ping_interval=PATIENT, ping_timeout=PATIENT)
        async with connected(hub.port) as client:
            await let_time_pass(hub, monkeypatch, PATIENT)
            assert (await client.frame())[0] == PING
            await let_time_pass(hub, monkeypatch, 10 * PATIENT)
            await client.is_processed()
            assert len(nodes(hub)) == 1

    async def test_unsolicited_pong_is_ignored(self, any_hub: HubServer) -> None:
        async with connected(any_hub.port) as client:
            await client.send(frame(PONG, b"hi"))
            await client.is_processed()

    async def test_sweep_goes_on_after_failing_for_one_client(
        self, start_hub: StartHub, faults: Faults, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        hub = await start_hub(ping_interval=0.05)
        async with connected(hub.port) as one, connected(hub.port) as other:
            await until(lambda: len(nodes(hub)) == 2)
            broken = next(each for each in hub._connections if each.peer.endswith(f":{one.port}"))
            kind = type(broken)
            sweep = kind.sweep

            def fail(self: Any, now: float, late: float) -> None:
                if self is broken:
                    raise RuntimeError("injected")
                sweep(self, now, late)

            monkeypatch.setattr(kind, "sweep", fail)
            assert (await other.frame())[0] == PING
            monkeypatch.setattr(kind, "sweep", sweep)
        faults.seen.clear()
