"""What clients may do to the hub, and to each other through it: not much.

The names R1 to R9 are those of the risks that trials met with. R1 to R4 are here; R5 to R7 are in
test_connection.py (and R6 in test_splitter_fuzz.py). R8, a long flush to a thousand listeners, is
accepted: nothing is to be tested but that all of them hear all (test_server.py). R9 is about
measuring; that coalescing adds no delay is tested in test_server.py.
"""

from __future__ import annotations

import asyncio
import itertools
import json
import random
import socket
import statistics
import string
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import pytest
from conftest import Faults, StartHub
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from fibws.hub import Hub
from fibws.hub.session import Session
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
    handshake,
    longest_turn,
    publish,
    until,
)

pytestmark = pytest.mark.both_loops

FILLER = "x" * KIB
QUEUE = 100
_HEALTHY = [HealthCheck.function_scoped_fixture, HealthCheck.differing_executors]
"""One hub serves all examples, and each loop has a run of its own: both as it should be."""


def numbered(number: int) -> bytes:
    """A message of about a kilobyte that begins with its number."""
    return publish("/t", f"{number} {FILLER}")


def numbers(heard: list[Any]) -> list[int]:
    """The numbers of such messages."""
    return [int(each.split()[0]) for each in heard]


class TestStuckConsumer:
    """R1 and R2: one who stops reading, by mistake or on purpose."""

    async def test_nobody_else_notices_and_the_hub_keeps_little(self, start_hub: StartHub) -> None:
        hub = await start_hub(stall_timeout=60.0)
        count = 20_000
        async with (
            connected(hub.port, receive_buffer=4 * KIB) as stuck,
            connected(hub.port) as listener,
            connected(hub.port) as talker,
        ):
            for client in (stuck, listener):
                await client.subscribes("/t", "std_msgs/String", queue_length=QUEUE)
            await talker.advertises("/t", "std_msgs/String")
            assert numbers(await _told(talker, listener, range(count))) == list(range(count))
            (slow,) = [each for each in hub._connections if each.outbox.dropped]
            assert slow.outbox.kept_bytes < 2 * QUEUE * KIB
            assert slow._transport.get_write_buffer_size() < MIB

    async def test_when_it_wakes_it_hears_the_stale_and_then_the_newest_in_order(
        self, start_hub: StartHub, caplog: pytest.LogCaptureFixture
    ) -> None:
        hub = await start_hub(stall_timeout=60.0)
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
        hub = await start_hub(stall_timeout=60.0)
        async with (
            connected(hub.port, receive_buffer=4 * KIB) as stuck,
            connected(hub.port) as listener,
            connected(hub.port) as talker,
        ):
            for client in (stuck, listener):
                await client.subscribes("/t", "std_msgs/String", queue_length=QUEUE)
            await talker.advertises("/t", "std_msgs/String")
            await _told(talker, listener, range(5000))
            await stuck.says("nope", id="mine")
            while (heard := await stuck.hears())["op"] == "publish":
                pass
            assert heard["id"] == "mine"

    async def test_it_is_closed_with_the_reason(
        self, start_hub: StartHub, caplog: pytest.LogCaptureFixture
    ) -> None:
        hub = await start_hub(stall_timeout=0.2, close_timeout=5.0)
        async with (
            connected(hub.port, "/?node=/stuck", receive_buffer=4 * KIB) as stuck,
            connected(hub.port) as listener,
            connected(hub.port) as talker,
        ):
            for client in (stuck, listener):
                await client.subscribes("/t", "std_msgs/String", queue_length=QUEUE)
            await talker.advertises("/t", "std_msgs/String")
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
        async with (
            connected(hub.port, receive_buffer=4 * KIB) as stuck,
            connected(hub.port) as listener,
            connected(hub.port) as talker,
        ):
            for client in (stuck, listener):
                await client.subscribes("/t", "std_msgs/String", queue_length=QUEUE)
            await talker.advertises("/t", "std_msgs/String")
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
            assert len(hub.graph.nodes) == 2

    async def test_the_hub_closes_in_time_in_spite_of_it(self, start_hub: StartHub) -> None:
        hub = await start_hub(stall_timeout=60.0, close_timeout=0.3)
        async with (
            connected(hub.port, receive_buffer=4 * KIB) as stuck,
            connected(hub.port) as listener,
            connected(hub.port) as talker,
        ):
            for client in (stuck, listener):
                await client.subscribes("/t", "std_msgs/String", queue_length=QUEUE)
            await talker.advertises("/t", "std_msgs/String")
            await _told(talker, listener, range(5000))
            loop = asyncio.get_running_loop()
            began = loop.time()
            await hub.close()
            assert loop.time() - began < 0.8
            assert (await listener.is_closed())[0] == 1001

    async def test_one_who_half_closes_and_does_not_read_is_cut_off(
        self, start_hub: StartHub
    ) -> None:
        hub = await start_hub(stall_timeout=60.0, close_timeout=0.1)
        async with (
            connected(hub.port, receive_buffer=4 * KIB) as stuck,
            connected(hub.port) as listener,
            connected(hub.port) as talker,
        ):
            for client in (stuck, listener):
                await client.subscribes("/t", "std_msgs/String", queue_length=QUEUE)
            await talker.advertises("/t", "std_msgs/String")
            await _told(talker, listener, range(2000))
            stuck.socket.shutdown(socket.SHUT_WR)
            await until(lambda: len(hub._connections) == 2)
            await _told(talker, listener, range(10))

    async def test_one_who_asks_and_never_reads_the_answers_is_closed(
        self, start_hub: StartHub, caplog: pytest.LogCaptureFixture
    ) -> None:
        hub = await start_hub(stall_timeout=60.0, max_queued_bytes=MIB)
        async with connected(hub.port, receive_buffer=4 * KIB) as stuck:
            errors = frame(TEXT, b"{}") * 1000
            while "too many replies wait to be read" not in caplog.text:
                await stuck.send(errors)
            assert hub.graph.nodes == {}
            _, code, _ = await _last_words(stuck)
        assert code == 1008

    async def test_one_who_pings_and_never_reads_the_pongs_is_cut_off(
        self, start_hub: StartHub
    ) -> None:
        hub = await start_hub(stall_timeout=60.0, max_queued_bytes=MIB)
        async with connected(hub.port, receive_buffer=4 * KIB) as stuck:
            pings = frame(PING, bytes(125)) * 1000
            with pytest.raises(OSError):
                for _ in range(100):
                    await stuck.send(pings)
            await until(lambda: not hub._connections)

    async def test_one_who_pings_while_it_reads_a_long_message_is_not(
        self, start_hub: StartHub
    ) -> None:
        hub = await start_hub(stall_timeout=60.0, max_queued_bytes=MIB)
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
        hub = await start_hub(stall_timeout=60.0, max_queued_bytes=MIB)
        one = json.dumps({"op": "publish", "topic": "/t", "msg": {"data": FILLER}}).encode()
        async with (
            connected(hub.port, receive_buffer=4 * KIB) as stuck,
            connected(hub.port) as talker,
        ):
            await stuck.subscribes("/t", "std_msgs/String", queue_length=QUEUE)
            await talker.advertises("/t", "std_msgs/String")
            await talker.send(frame(TEXT, one * 16 * KIB))
            await talker.is_heard()
            (slow,) = [each for each in hub._connections if each._paused_since is not None]
            assert slow._transport.get_write_buffer_size() + slow.outbox.kept_bytes < 4 * MIB
            stuck.reset()


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
                    began = time.perf_counter()
                    await one.send(publish("/quiet", number))
                    assert await one.hears_data(1) == [number]
                    trips.append(time.perf_counter() - began)
                for _ in range(10):
                    began = time.perf_counter()
                    async with connected(hub.port):
                        entries.append(time.perf_counter() - began)
        # The flooding thread and this one share Python's lock: so large are the bounds.
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
                    began = time.perf_counter()
                    await one.send(publish("/quiet", number))
                    assert await one.hears_data(1) == [number]
                    trips.append(time.perf_counter() - began)
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
                broken.setattr(Session, "_publish", fail)
                await talker.send(publish("/t", 1))
                await talker.is_heard()
            await talker.send(publish("/t", 2))
            assert await listener.hears_data(1) == [2]
        faults.expect("injected")


class TestSession:
    """What goes wrong in one client's session stays there."""

    @pytest.mark.parametrize(
        "fields",
        [
            {"queue_length": 2**63},
            {"queue_length": 2**64},
            {"queue_length": 10**400},
            {"queue_length": -1},
            {"throttle_rate": 1e308},
            {"throttle_rate": 10**400},
            {"throttle_rate": -1},
            {"fragment_size": 10**400},
            {"throttle_rate": 1e300, "queue_length": 2**63 - 1},
        ],
        ids=lambda fields: " ".join(f"{name}={float(str(x)):.0e}" for name, x in fields.items()),
    )
    async def test_no_number_is_too_much_for_a_subscription(
        self, hub: Hub, fields: dict[str, Any]
    ) -> None:
        fields = {"throttle_rate": 10, **fields}
        async with connected(hub.port, "/?node=/odd") as client, connected(hub.port) as talker:
            await talker.advertises("/t")
            await client.says("subscribe", topic="/t", type="std_msgs/Int32", **fields)
            await talker.send(publish("/t", 1), publish("/t", 2))
            await talker.is_heard()
            await client.send(frame(CLOSE))
            await client.to_the_end()
        async with connected(hub.port, "/?node=/odd") as again:
            await again.subscribes("/t")
        await until(lambda: not hub._connections)

    async def test_one_that_cannot_leave_is_forgotten_all_the_same(
        self, hub: Hub, faults: Faults, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        def fail(*_: Any) -> None:
            raise KeyError("injected")

        async with connected(hub.port) as other:
            with monkeypatch.context() as broken:
                async with connected(hub.port, "/?node=/broken") as client:
                    await client.is_heard()
                    broken.setattr(Session, "leave", fail)
                await until(lambda: len(hub._connections) == 1)
            await other.is_heard()
            hub.graph.nodes.pop("/broken", None)
        faults.seen.clear()

    async def test_a_newcomer_is_not_harmed_by_the_older_one_of_its_name(
        self, hub: Hub, faults: Faults, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        def fail(*_: Any) -> None:
            raise KeyError("injected")

        async with connected(hub.port, "/?node=/a") as older:
            await older.is_heard()
            with monkeypatch.context() as broken:
                broken.setattr(Session, "replaced", fail)
                async with connected(hub.port, "/?node=/a") as newer:
                    await newer.is_heard()
        faults.seen.clear()


class TestFuzz:
    """The hub outlives all of it, logs no traceback, and keeps nothing of it."""

    @settings(
        max_examples=100,
        deadline=None,
        derandomize=True,
        suppress_health_check=_HEALTHY,
    )
    @given(st.lists(st.binary(max_size=200), max_size=5))
    async def test_random_bytes_after_the_handshake(self, hub: Hub, chunks: list[bytes]) -> None:
        async with _bystanders(hub) as check:
            async with connected(hub.port) as client:
                try:
                    for chunk in chunks:
                        await client.send(chunk)
                except OSError:
                    pass
            await check()

    @settings(
        max_examples=60,
        deadline=None,
        derandomize=True,
        suppress_health_check=_HEALTHY,
    )
    @given(st.binary(max_size=100), st.integers(0, len(handshake())))
    async def test_random_bytes_in_the_handshake(self, hub: Hub, junk: bytes, at: int) -> None:
        async with _bystanders(hub) as check:
            async with dialled(hub.port) as client:
                await client.send(handshake()[:at], junk, handshake()[at:])
                client.socket.shutdown(socket.SHUT_WR)
                try:
                    await client.to_the_end()
                except OSError:
                    pass
            await check()

    @pytest.mark.parametrize("seed", range(4))
    async def test_random_operations(self, hub: Hub, seed: int) -> None:
        chance = random.Random(seed)
        async with _bystanders(hub) as check:
            for _ in range(10):
                async with connected(hub.port) as one, connected(hub.port, "/?node=/x") as other:
                    for _ in range(20):
                        for client in (one, other):
                            await client.send(frame(TEXT, _text(chance)))
                    for client in (one, other):
                        await client.send(frame(CLOSE))
                        await client.to_the_end()
            await check()

    @pytest.mark.parametrize("seed", range(2))
    async def test_random_frames_and_resets(self, hub: Hub, seed: int) -> None:
        chance = random.Random(100 + seed)
        async with _bystanders(hub) as check:
            for _ in range(100):
                async with connected(hub.port) as client:
                    for _ in range(chance.randrange(10)):
                        opcode = chance.choice((0, 1, 1, 1, 2, 8, 9, 10, 3))
                        payload = _text(chance)[:125] if opcode & 8 else _text(chance)
                        data = frame(opcode, payload, fin=chance.random() < 0.8)
                        try:
                            await client.send(data[: chance.choice((len(data), len(data), 5))])
                        except OSError:
                            break
                    if chance.random() < 0.5:
                        client.reset()
            await check()


class _bystanders:
    """Two clients that talk while others misbehave; afterwards only they must be left."""

    def __init__(self, hub: Hub) -> None:
        self._hub = hub
        self._numbers = itertools.count()

    async def __aenter__(self) -> Any:
        self._talker = connected(self._hub.port, "/?node=/talker")
        self._listener = connected(self._hub.port, "/?node=/listener")
        self._one = await self._talker.__aenter__()
        self._other = await self._listener.__aenter__()
        await self._one.advertises("/good")
        await self._other.subscribes("/good")
        return self._check

    async def _check(self) -> None:
        for number in itertools.islice(self._numbers, 3):
            await self._one.send(publish("/good", number))
            assert await self._other.hears_data(1) == [number]
        await until(lambda: len(self._hub._connections) == 2)
        assert set(self._hub.graph.nodes) == {"/talker", "/listener"}
        assert set(self._hub.graph.topics) == {"/good"}

    async def __aexit__(self, *_: object) -> None:
        await self._talker.__aexit__(None, None, None)
        await self._listener.__aexit__(None, None, None)


def _text(chance: random.Random) -> bytes:
    """An operation with some of its fields changed, several of them, or something else."""
    kind = chance.random()
    if kind < 0.01:
        return chance.randbytes(chance.randrange(30))
    if kind < 0.1:
        return "".join(chance.choices('{}[]":,1 a', k=20)).encode()
    if kind < 0.2:
        return json.dumps(_junk(chance)).encode()
    if kind < 0.3:
        return b" ".join(_text(chance) for _ in range(3))
    whole = json.dumps(_operation(chance)).encode()
    if kind < 0.4:
        return whole[: chance.randrange(len(whole))]
    if kind < 0.5:
        half = chance.randrange(len(whole))
        id_ = chance.choice(("f", 1, _junk(chance)))
        pieces = (whole[:half], whole[half:])
        return b"".join(
            json.dumps(
                {"op": "fragment", "id": id_, "num": num, "total": 2, "data": piece.decode()}
            ).encode()
            for num, piece in enumerate(pieces)
        )
    return whole


def _operation(chance: random.Random) -> dict[str, Any]:
    topic = chance.choice(("/a", "a", "/b", "~c", "/a/b", "/none"))
    fields: dict[str, Any] = chance.choice(
        (
            {"op": "advertise", "topic": topic, "type": "std_msgs/Int32", "latch": True},
            {"op": "advertise", "topic": topic, "type": "geometry_msgs/PoseStamped"},
            {"op": "advertise", "topic": topic, "type": "my/T", "definition": "int32 x\nT y"},
            {"op": "unadvertise", "topic": topic},
            {"op": "publish", "topic": topic, "msg": {"data": 1}},
            {"op": "publish", "topic": topic, "msg": {"header": {"stamp": "now"}}},
            {"op": "subscribe", "topic": topic, "throttle_rate": 1, "queue_length": 2, "id": "s"},
            {"op": "subscribe", "topic": topic, "type": "std_msgs/Int32", "compression": "png"},
            {"op": "unsubscribe", "topic": topic, "id": "s"},
            {"op": "fragment", "id": "f", "num": 0, "total": 1, "data": "{}"},
            {"op": "set_level", "level": "info"},
        )
    )
    for name in list(fields):
        if chance.random() < 0.15:
            fields[name] = _junk(chance)
        elif chance.random() < 0.05:
            del fields[name]
    if chance.random() < 0.2:
        fields["id"] = _junk(chance)
    return fields


def _junk(chance: random.Random, depth: int = 0) -> Any:
    choices: list[Any] = [
        None, True, False, 0, -1, 2**31, 2**64, -(10**30), 0.5, 1e308, float("nan"), float("inf"),
        "", "\0", "\ud83d\ude00", "\n", "".join(chance.choices(string.printable, k=5)), "x" * 2000,
    ]  # fmt: skip
    if depth < 3:
        choices += [
            [_junk(chance, depth + 1) for _ in range(chance.randrange(3))],
            {"data": _junk(chance, depth + 1)},
            {"op": _junk(chance, depth + 1), "id": _junk(chance, depth + 1)},
        ]
    return chance.choice(choices)


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
