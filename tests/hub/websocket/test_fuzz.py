"""Random bytes, operations and frames."""

from __future__ import annotations

import asyncio
import itertools
import json
import random
import socket
import string
import struct
from typing import Any

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from random_inputs import times

from fibws.hub.server import HubServer
from fibws.protocol.serialized import SUBPROTOCOL, publish_head, read_delivery

from ..raw_client import (
    BINARY,
    CLOSE,
    TEXT,
    connected,
    dialled,
    frame,
    handshake,
    nodes,
    publish,
    topics,
    until,
)

pytestmark = pytest.mark.both_loops

ROUNDS, FRAMES = 50, 2000
"""Of the slow test, on each loop."""
_HEALTHY = [HealthCheck.function_scoped_fixture, HealthCheck.differing_executors]
"""One hub serves all examples, and each loop has a run of its own: both as it should be."""


class TestFuzz:
    """The hub goes on, logs no traceback, and keeps nothing."""

    @settings(
        max_examples=times(0.5),
        deadline=None,
        derandomize=True,
        suppress_health_check=_HEALTHY,
    )
    @given(st.lists(st.binary(max_size=200), max_size=5))
    async def test_random_bytes_after_the_handshake(
        self, hub: HubServer, chunks: list[bytes]
    ) -> None:
        async with _bystanders(hub) as check:
            async with connected(hub.port) as client:
                try:
                    for chunk in chunks:
                        await client.send(chunk)
                except OSError:
                    pass
            await check()

    @settings(
        max_examples=times(0.3),
        deadline=None,
        derandomize=True,
        suppress_health_check=_HEALTHY,
    )
    @given(st.binary(max_size=100), st.integers(0, len(handshake())))
    async def test_random_bytes_in_the_handshake(
        self, hub: HubServer, junk: bytes, at: int
    ) -> None:
        async with _bystanders(hub) as check:
            async with dialled(hub.port) as client:
                await client.send(handshake()[:at], junk, handshake()[at:])
                client.socket.shutdown(socket.SHUT_WR)
                try:
                    await client.to_the_end()
                except OSError:
                    pass
            await check()

    async def test_random_operations(self, hub: HubServer) -> None:
        chance = random.Random(0)
        async with _bystanders(hub) as check:
            for _ in range(times(0.2)):
                async with connected(hub.port) as one, connected(hub.port, "/?node=/x") as other:
                    for _ in range(20):
                        for client in (one, other):
                            await client.send(frame(TEXT, _text(chance)))
                    for client in (one, other):
                        await client.send(frame(CLOSE))
                        await client.to_the_end()
            await check()

    async def test_random_serialized_frames(self, hub: HubServer) -> None:
        chance = random.Random(200)
        async with _bystanders(hub) as check:
            for _ in range(times(0.1)):
                async with (
                    connected(hub.port, "/?node=/x", Sec_WebSocket_Protocol=SUBPROTOCOL) as one,
                    connected(hub.port, Sec_WebSocket_Protocol=SUBPROTOCOL) as other,
                ):
                    for number, (type_, _message) in enumerate(SERIALIZED):
                        topic = f"/s{number}"
                        await one.send_operation(
                            "advertise", topic=topic, type=type_, publisher=number
                        )
                        compression = chance.choice(("ros1", "none", "cbor", "cbor-raw"))
                        await other.send_operation(
                            "subscribe", topic=topic, compression=compression
                        )
                    for _ in range(50):
                        data = frame(BINARY, _serialized(chance))
                        if chance.random() < 0.1:
                            data = frame(TEXT, _text(chance))
                        await chance.choice((one, one, one, other)).send(data)
                    for client in (one, other):
                        await client.send(frame(CLOSE))
                        await client.to_the_end()
            await check()

    @pytest.mark.slow
    @pytest.mark.timeout(900)
    async def test_many_serialized_frames(self, hub: HubServer) -> None:
        chance = random.Random(300)
        async with _bystanders(hub) as check:
            for _ in range(ROUNDS):
                async with connected(hub.port, Sec_WebSocket_Protocol=SUBPROTOCOL) as client:
                    for number, (type_, _message) in enumerate(SERIALIZED):
                        await client.send_operation(
                            "advertise", topic=f"/s{number}", type=type_, publisher=number
                        )
                    frames = [frame(BINARY, _serialized(chance)) for _ in range(FRAMES)]
                    _, received = await asyncio.gather(
                        client.send(*frames, frame(CLOSE)), client.to_the_end()
                    )
                    assert received.endswith(b"\x88\x00")  # It has read all, up to the close.
                await check()

    async def test_random_frames_and_resets(self, hub: HubServer) -> None:
        chance = random.Random(100)
        async with _bystanders(hub) as check:
            for _ in range(times(1)):
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
    """A talker and two listeners that lose nothing while others misbehave.

    One listener gets JSON, one serialized messages; afterwards only these three must be left.
    """

    def __init__(self, hub: HubServer) -> None:
        self._hub = hub
        self._numbers = itertools.count()

    async def __aenter__(self) -> Any:
        self._talker = connected(self._hub.port, "/?node=/talker")
        self._listener = connected(self._hub.port, "/?node=/listener")
        self._reader = connected(
            self._hub.port, "/?node=/reader", Sec_WebSocket_Protocol=SUBPROTOCOL
        )
        self._one = await self._talker.__aenter__()
        self._other = await self._listener.__aenter__()
        self._third = await self._reader.__aenter__()
        await self._one.advertises("/good")
        await self._other.subscribes("/good")
        await self._third.send_operation("subscribe", topic="/good", compression="ros1")
        assert (await self._third.receive())["op"] == "subscribed"
        return self._check

    async def _check(self) -> None:
        for number in itertools.islice(self._numbers, 3):
            await self._one.send(publish("/good", number))
            assert await self._other.receive_data(1) == [number]
            opcode, payload = await self._third.frame()
            assert opcode == BINARY
            assert bytes(read_delivery(payload).message) == struct.pack("<i", number)
        await until(lambda: len(self._hub._connections) == 3)
        assert set(nodes(self._hub)) == {"/talker", "/listener", "/reader"}
        assert set(topics(self._hub)) == {"/good"}

    async def __aexit__(self, *_: object) -> None:
        await self._talker.__aexit__(None, None, None)
        await self._reader.__aexit__(None, None, None)
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


SERIALIZED = [
    ("std_msgs/Int32", struct.pack("<i", 5)),
    ("std_msgs/String", struct.pack("<I", 5) + b"hello"),
    ("std_msgs/Header", struct.pack("<IiiI", 1, 2, 3, 3) + b"map"),
    ("geometry_msgs/Polygon", struct.pack("<I6f", 2, *range(6))),
    ("std_msgs/Float64MultiArray", struct.pack("<IIId", 0, 0, 1, 0.5)),
    ("std_msgs/UInt8MultiArray", struct.pack("<III", 0, 0, 300) + bytes(300)),
]
"""Types, and a valid message of each."""


def _serialized(chance: random.Random) -> bytes:
    """Return a binary frame of fibws.v1: random, mutated, or valid."""
    kind = chance.random()
    if kind < 0.2:
        return chance.randbytes(chance.randrange(40))
    number = chance.randrange(len(SERIALIZED))
    _, message = SERIALIZED[number if kind < 0.9 else chance.randrange(len(SERIALIZED))]
    node = chance.choice((None, None, None, "/client_1", "not a name", ""))
    data = bytearray(publish_head(number, node) + message)
    if kind < 0.6:
        for _ in range(chance.randrange(4)):
            data[chance.randrange(len(data))] = chance.choice((0, 1, 2, 127, 128, 255))
    elif kind < 0.7:
        del data[chance.randrange(len(data)) :]
    elif kind < 0.75:
        data += chance.randbytes(chance.randrange(1, 9))
    return bytes(data)


FIBONACCI = {"action_type": "example_interfaces/Fibonacci", "args": {"order": 3}, "feedback": True}


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
            {"op": "subscribe", "topic": topic, "compression": "cbor", "fragment_size": 9},
            {"op": "subscribe", "topic": topic, "compression": "cbor-raw", "id": "r"},
            {"op": "unsubscribe", "topic": topic, "id": "s"},
            {"op": "advertise_service", "service": topic, "type": "std_srvs/SetBool"},
            {"op": "unadvertise_service", "service": topic},
            {"op": "call_service", "service": topic, "args": {"data": True}, "id": "c"},
            {"op": "call_service", "service": topic, "args": [True], "timeout": 0.01},
            {"op": "call_service", "service": "/rosapi/set_param", "args": ["x", "{}"]},
            {"op": "service_response", "service": topic, "values": {}, "result": True},
            {"op": "service_response", "service": topic, "id": "service_request:/a:1", "result": 0},
            {"op": "advertise_action", "action": topic, "type": "example_interfaces/Fibonacci"},
            {"op": "unadvertise_action", "action": topic},
            {"op": "send_action_goal", "action": topic, "id": "g", **FIBONACCI},
            {"op": "cancel_action_goal", "action": topic, "id": "g"},
            {"op": "action_feedback", "action": topic, "id": "action_goal:/a:1", "values": {}},
            {"op": "action_result", "action": topic, "id": "action_goal:/a:2", "result": True},
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
