"""Turns: connections with much to read leave time for the others."""

from __future__ import annotations

import asyncio
import errno
import json
import math
import time
from collections.abc import Callable
from contextlib import AsyncExitStack
from functools import partial
from typing import Any

import pytest
from conftest import Faults, StartHub

from fibws.access.rights import Principal
from fibws.hub.server import HubServer
from fibws.hub.websocket.connection import Connection
from fibws.hub.websocket.endpoint import Opening, Registration, Work
from fibws.hub.websocket.turns import ITERATION, MOST_FRAMES, TURN, Turns
from fibws.protocol.websocket import LARGE, SHUTDOWN, Payload

from ..raw_client import CLOSE, PING, TEXT, connected, dialled, frame, handshake, until
from .virtual_time import VirtualTime

both_loops = pytest.mark.both_loops


class Loop:
    """An event loop's iterations, and a clock that only work advances."""

    def __init__(self) -> None:
        self.now = 100.0
        self.flushes = 0
        self._later: list[Callable[[], None]] = []
        self.turns = Turns(self._call_later, self._flush, lambda: self.now)

    def _call_later(self, delay: float, function: Callable[[], None]) -> None:
        assert delay == 0
        self._later.append(function)

    def _flush(self) -> None:
        self.flushes += 1

    def iterate(self) -> float:
        """Run one iteration; return the seconds that it took."""
        began = self.now
        due, self._later = self._later, []
        for function in due:
            function()
        return self.now - began

    @property
    def idle(self) -> bool:
        return not self._later


class Heavy:
    """A connection with some frames to handle, each of which takes a while."""

    def __init__(self, loop: Loop, frames: int, seconds: float, log: list[Heavy]) -> None:
        self.frames = frames
        self.aborted = False
        self._loop = loop
        self._seconds = seconds
        self._log = log

    def take_turn(self) -> None:
        self._log.append(self)
        passed, left = 0, 1
        while self.frames and left:
            self.frames -= 1
            self._loop.now += self._seconds
            passed += 1
            left -= 1
            if not left:
                left = self._loop.turns.go_on(passed)
        if self.frames:
            self._loop.turns.wait(self)

    def abort(self) -> None:
        self.aborted = True


class Faulty(Heavy):
    def take_turn(self) -> None:
        raise ZeroDivisionError("injected")


def test_iteration_is_short_however_many_wait() -> None:
    loop, log = Loop(), list[Heavy]()
    heavy = [Heavy(loop, 200, TURN / 20, log) for _ in range(30)]
    for each in heavy:
        loop.turns.wait(each)
    longest = 0.0
    while not loop.idle:
        longest = max(longest, loop.iterate())
    assert not any(each.frames for each in heavy)
    assert longest < 2 * ITERATION


def test_waiting_connections_take_turns_in_order() -> None:
    loop, log = Loop(), list[Heavy]()
    heavy = [Heavy(loop, 4, TURN, log) for _ in range(5)]
    for each in heavy:
        loop.turns.wait(each)
    while not loop.idle:
        loop.iterate()
    assert log == heavy * 4


def test_connection_that_waits_alone_gets_the_whole_iteration() -> None:
    loop, log = Loop(), list[Heavy]()
    loop.turns.wait(Heavy(loop, 1000, TURN / 10, log))
    assert ITERATION <= loop.iterate() < 1.5 * ITERATION


def test_first_turn_is_shorter_while_others_wait() -> None:
    loop, log = Loop(), list[Heavy]()
    loop.turns.began = loop.now
    loop.now += 1.5 * TURN
    assert loop.turns.go_on(100)
    loop.turns.wait(Heavy(loop, 1, TURN, log))
    loop.turns.began = loop.now
    loop.now += 1.5 * TURN
    assert not loop.turns.go_on(100)


def test_clock_is_looked_at_often_at_first_and_near_the_end_of_a_turn() -> None:
    loop = Loop()
    loop.turns.began = loop.now
    granted: list[int] = []
    passed = 1
    while left := loop.turns.go_on(passed):
        granted.append(left)
        passed += left
        loop.now += left * ITERATION / 100
    assert granted[:4] == [1, 2, 4, 8]
    assert max(granted) == MOST_FRAMES
    assert granted[-1] < MOST_FRAMES
    assert 100 <= passed <= 103


def test_time_of_an_iteration_is_spent_once() -> None:
    loop, log = Loop(), list[Heavy]()
    assert not loop.turns.is_spent()
    for _ in range(9):
        loop.turns.wait(Heavy(loop, 1, TURN, log))
    loop.iterate()
    assert loop.turns.is_spent()
    loop.iterate()
    loop.iterate()
    assert not loop.turns.is_spent()


def test_frames_of_others_are_written_before_the_heavy_have_their_turn() -> None:
    loop, log = Loop(), list[Heavy]()
    flushes = []

    class Asking(Heavy):
        def take_turn(self) -> None:
            flushes.append(loop.flushes)

    loop.turns.wait(Asking(loop, 1, TURN, log))
    loop.iterate()
    assert flushes == [1]


def test_fault_at_one_connection_cuts_off_only_that_one(faults: Faults) -> None:
    loop, log = Loop(), list[Heavy]()
    faulty, healthy = Faulty(loop, 1, TURN, log), Heavy(loop, 1, TURN, log)
    loop.turns.wait(faulty)
    loop.turns.wait(healthy)
    loop.iterate()
    assert (faulty.aborted, healthy.aborted, healthy.frames) == (True, False, 0)
    faults.expect("injected")


def removing(loop: Loop, count: int, seconds: float, removed: list[int]) -> Work:
    for each in range(count):
        loop.now += seconds
        removed.append(each)
        yield


def test_little_that_a_client_has_left_is_removed_at_once() -> None:
    loop, removed = Loop(), list[int]()
    loop.turns.finish(removing(loop, 3, TURN / 10, removed))
    assert removed == [0, 1, 2]
    loop.iterate()
    assert loop.idle


def test_clients_that_leave_at_once_share_the_time_of_an_iteration() -> None:
    loop, removed = Loop(), list[int]()
    began = loop.now
    for _ in range(100):
        loop.turns.finish(removing(loop, 9, TURN / 3, removed))
    assert loop.now - began < 2 * ITERATION
    longest = 0.0
    while not loop.idle:
        longest = max(longest, loop.iterate())
    assert len(removed) == 900
    assert longest < 2 * ITERATION


def test_all_is_removed_when_the_hub_ends() -> None:
    loop, removed = Loop(), list[int]()
    loop.turns.finish(removing(loop, 100, TURN, removed))
    loop.turns.close()
    assert len(removed) == 100


@pytest.mark.parametrize("is_at_end", [False, True])
def test_a_step_that_fails_keeps_no_other_from_being_taken(
    caplog: pytest.LogCaptureFixture, is_at_end: bool
) -> None:
    loop, removed = Loop(), list[int]()

    def remove(number: int) -> None:
        loop.now += TURN
        if number % 3 == 1:
            raise ValueError("a fault of the hub's")
        removed.append(number)

    for begin in (0, 10):
        loop.turns.finish(map(remove, range(begin, begin + 10)))
    if is_at_end:
        loop.turns.close()
    while not loop.idle:
        loop.iterate()
    assert sorted(removed) == [each for each in range(20) if each % 3 != 1]
    assert "could not be removed" in caplog.text


# With real connections.


class Slow:
    """An endpoint that takes a while for each text, and keeps the texts' last bytes."""

    incomplete_bytes = 0
    protocol = "test"

    def __init__(self, seconds: float) -> None:
        self.received: list[bytes] = []
        self.left = 0
        self._seconds = seconds
        self.node = "/slow"

    def open(self, opening: Opening) -> Slow:
        return self

    def receive_text(self, data: Payload) -> None:
        self.received.append(bytes(data[-4:]))
        end = time.perf_counter() + self._seconds
        while time.perf_counter() < end:
            pass

    def receive_binary(self, data: Payload) -> None:
        raise AssertionError("only texts are sent")

    def refuse(self, data: Payload, reason: str, *, is_text: bool) -> None:
        raise AssertionError("the hub has no limits")

    def registrations(self, what: Registration) -> int:
        return 0

    def authorize(self, principal: Principal) -> Work:
        raise AssertionError("the hub has no authentication")

    def revoke(self) -> None:
        raise AssertionError("the hub has no authentication")

    def leave(self) -> Work:
        self.left += 1
        return iter(())


def slow(hub: HubServer, *, seconds: float = 0.001) -> Slow:
    """Return the endpoint of the next client at /slow."""
    endpoint = Slow(seconds)
    hub.endpoints.add(endpoint.open, path="/slow")
    return endpoint


def texts(count: int, size: int = 10) -> bytes:
    return b"".join(frame(TEXT, b"%*d" % (size, number)) for number in range(count))


def numbers(endpoint: Slow) -> list[int]:
    return [int(each) for each in endpoint.received]


@both_loops
@pytest.mark.parametrize(("count", "size"), [(100, 10), (8, 10_000), (4, LARGE)])
async def test_others_are_served_between_the_turns_of_heavy_clients(
    hub: HubServer, count: int, size: int
) -> None:
    async with AsyncExitStack() as stack:
        witness = await stack.enter_async_context(connected(hub.port))
        endpoints, clients = [], []
        for _ in range(10):
            endpoints.append(slow(hub))
            clients.append(await stack.enter_async_context(connected(hub.port, "/slow")))

        def done() -> int:
            return sum(len(each.received) for each in endpoints)

        sending = asyncio.gather(*(client.send(texts(count, size)) for client in clients))
        between = []
        while done() < 10 * count:
            before = done()
            await witness.is_processed()
            between.append(done() - before)
        await sending
        for endpoint in endpoints:
            assert numbers(endpoint) == list(range(count))
    # The witness's ping and pong take a few iterations, of 3 or 4 messages each.
    assert max(between) <= 30


@both_loops
async def test_clients_that_leave_while_they_wait_are_forgotten(hub: HubServer) -> None:
    endpoints = []
    async with connected(hub.port) as witness:
        for reset in (True, False):
            endpoints.append(slow(hub))
            async with connected(hub.port, "/slow") as client:
                await client.send(texts(500))
                await until(lambda: endpoints[-1].received)
                if reset:
                    client.reset()
        await until(lambda: len(hub._connections) == 1)
        await witness.is_processed()
    assert [each.left for each in endpoints] == [1, 1]
    assert len(endpoints[1].received) == 500  # It closed in good order behind its messages.


async def test_client_that_resets_while_its_close_waits_is_no_error(
    hub: HubServer, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fail() -> None:
        raise OSError(errno.ENOTCONN, "Transport endpoint is not connected")

    endpoint = slow(hub)
    async with connected(hub.port, "/slow") as client:
        await client.send(texts(20) + frame(CLOSE))
        await until(lambda: endpoint.received)
        (connection,) = hub._connections
        monkeypatch.setattr(connection._transport, "write_eof", fail)
        await until(lambda: not hub._connections)
    assert endpoint.left == 1


@both_loops
async def test_client_may_be_closed_while_it_waits(hub: HubServer) -> None:
    endpoint = slow(hub)
    async with connected(hub.port, "/slow") as client:
        await client.send(texts(500))
        await until(lambda: endpoint.received)
        (connection,) = hub._connections
        connection.close(SHUTDOWN)
        received = len(endpoint.received)
        assert (await client.is_closed())[0] == 1001
        await client.send(frame(CLOSE, b"\x03\xe9"))
        assert await client.to_the_end() == b""
    assert len(endpoint.received) == received
    assert endpoint.left == 1


@both_loops
async def test_hub_stops_while_clients_wait(start_hub: StartHub) -> None:
    hub = await start_hub(close_timeout=0.1)
    async with AsyncExitStack() as stack:
        for _ in range(5):
            endpoint = slow(hub)
            client = await stack.enter_async_context(connected(hub.port, "/slow"))
            await client.send(texts(1000))
        await until(lambda: endpoint.received)
        await hub.close()
        assert not hub._connections


@both_loops
async def test_client_whose_pong_is_behind_its_messages_is_alive(start_hub: StartHub) -> None:
    hub = await start_hub(ping_interval=10.0, ping_timeout=20.0)
    clock = VirtualTime(hub)
    endpoint = slow(hub)
    async with connected(hub.port, "/slow") as client:
        clock.advance(10.0)
        assert (await client.frame())[0] == PING
        await client.send(texts(100))
        await until(lambda: endpoint.received)
        swept = 0
        while len(endpoint.received) < 100:
            clock.advance(30.0)
            swept += 1
            await asyncio.sleep(0)
            assert endpoint.left == 0
        assert swept > 1
        # From now on its silence counts.
        clock.advance(10.0)
        clock.advance(30.0)
        assert (await client.frame())[0] == CLOSE


def is_reached(connection: Connection, received: int) -> bool:
    return connection.bytes_received >= received


async def test_client_that_sends_but_whose_pong_does_not_come_is_alive(
    start_hub: StartHub,
) -> None:
    """The pong may wait behind megabytes in the client, or on a slow network."""
    hub = await start_hub(ping_interval=10.0, ping_timeout=20.0)
    clock = VirtualTime(hub)
    async with connected(hub.port) as client:
        clock.advance(10.0)
        assert (await client.frame())[0] == PING
        [connection] = hub._connections
        for _ in range(5):
            expected = connection.bytes_received + 100
            await client.send(frame(TEXT, b"x" * 1000)[:100])  # A part of a message.
            await until(partial(is_reached, connection, expected))
            clock.advance(15.0)
        clock.advance(15.0)
        assert hub._connections
        clock.advance(6.0)
        assert (await client.frame())[0] == CLOSE


@both_loops
async def test_flood_in_the_handshake_waits_for_its_turn(hub: HubServer) -> None:
    async with dialled(hub.port) as client, connected(hub.port) as witness:
        endpoint = slow(hub)
        await client.send(handshake("/slow") + texts(300))
        await until(lambda: endpoint.received)
        await witness.is_processed()
        assert len(endpoint.received) < 100
        assert (await client.response())[0] == 101
        await client.is_processed()
    assert numbers(endpoint) == list(range(300))


@both_loops
async def test_without_fast_framing_turns_end_too(start_hub: StartHub) -> None:
    hub = await start_hub(fast_framing=False)
    endpoint = slow(hub)
    async with connected(hub.port, "/slow") as client, connected(hub.port) as witness:
        await client.send(texts(300, 100))
        await until(lambda: endpoint.received)
        await witness.is_processed()
        assert len(endpoint.received) < 100
        await client.is_processed()
    assert numbers(endpoint) == list(range(300))


@both_loops
async def test_client_that_has_just_connected_waits_for_nobody(
    hub: HubServer, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Its handshake took a turn; its messages are served at once, however many others wait."""
    waits = 0
    wait = Turns.wait

    def count(turns: Turns, reader: Any) -> None:
        nonlocal waits
        waits += 1
        wait(turns, reader)

    monkeypatch.setattr(Turns, "wait", count)
    monkeypatch.setattr(Turns, "is_spent", lambda turns: True)
    monkeypatch.setattr("fibws.hub.websocket.connection.TURN", math.inf)  # The real clock's.
    async with connected(hub.port) as client:
        handshakes = waits
        for _ in range(5):
            await client.is_processed()
    assert (handshakes, waits) == (1, 1)


@both_loops
@pytest.mark.parametrize("fast_framing", [True, False])
async def test_client_that_closes_behind_many_operations_has_them_all_performed(
    start_hub: StartHub, monkeypatch: pytest.MonkeyPatch, fast_framing: bool
) -> None:
    hub = await start_hub(fast_framing=fast_framing)
    monkeypatch.setattr(Turns, "is_over", lambda turns: True)
    async with connected(hub.port) as listener, connected(hub.port) as client:
        advertise = json.dumps({"op": "advertise", "topic": "/t", "type": "std_msgs/Int32"})
        publish = json.dumps({"op": "publish", "topic": "/t", "msg": {"data": 1}})
        await listener.send(frame(TEXT, b'{"op":"subscribe","topic":"/t"}'))
        await listener.is_processed()
        text = advertise + 10 * publish
        await client.send(frame(TEXT, text.encode()) + frame(CLOSE))
        received = [await listener.frame() for _ in range(10)]
    assert all(b'"data":1' in payload for _, payload in received)
