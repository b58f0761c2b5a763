"""Large messages over a real socket: intact, bounded, and forgotten when the client leaves."""

from __future__ import annotations

import gc
import json
import random
import struct
import tracemalloc
from collections.abc import Callable, Iterator
from contextlib import contextmanager

import pytest
from conftest import StartHub
from websockets.server import ServerProtocol

from fibws.hub.server import HubServer
from fibws.hub.settings import KIB, MIB
from fibws.hub.websocket.connection import Connection
from fibws.protocol.serialized import SUBPROTOCOL, publish_head, read_delivery
from fibws.protocol.websocket import BINARY, KILLED, TEXT, ZERO_KEY, client_frame, client_header

from ..raw_client import CONT, PING, PONG, Client, connected, dialled, frame, publish, until
from ..raw_client import operation as raw_operation

pytestmark = pytest.mark.both_loops

KEYS = {"random": b"\x9a\x05\xf0\x33", "zero": ZERO_KEY}


def text(size: int, seed: int = 1) -> str:
    """Return some letters, different ones at every place."""
    return random.Random(seed).randbytes(size // 2).hex()


def operation(data: str) -> bytes:
    return json.dumps({"op": "publish", "topic": "/t", "msg": {"data": data}}).encode()


def serialized(data: str) -> bytes:
    return publish_head(7) + struct.pack("<I", len(data)) + data.encode()


async def cut(client: Client, data: bytes, seed: int) -> None:
    """Send bytes in pieces of random sizes."""
    chance = random.Random(seed)
    start = 0
    while start < len(data):
        size = chance.choice([1, 14, 1000, 16 * KIB, 64 * KIB, 256 * KIB, 300_000, MIB])
        await client.send(data[start : start + size])
        start += size


@pytest.mark.parametrize("size", [64 * KIB - 60, 64 * KIB, 64 * KIB + 1, 1_000_000, 8 * MIB])
@pytest.mark.parametrize("key", KEYS)
@pytest.mark.long
async def test_large_texts_arrive_intact_with_small_ones_behind_them(
    any_hub: HubServer, size: int, key: str
) -> None:
    large = text(size)
    async with connected(any_hub.port) as talker, connected(any_hub.port) as listener:
        await listener.subscribes("/t", "std_msgs/String")
        await talker.advertises("/t", "std_msgs/String")
        frames = client_frame(TEXT, operation(large), KEYS[key])
        small = b"".join(client_frame(TEXT, operation(each), KEYS["random"]) for each in "abc")
        if len(operation(large)) > 8 * MIB:
            frames = client_frame(TEXT, operation(large := large[: 8 * MIB - 100]), KEYS[key])
        await talker.send(small + frames + small)
        assert await listener.receive_data(7) == [*"abc", large, *"abc"]
        await talker.is_processed()


@pytest.mark.parametrize("size", [64 * KIB, 64 * KIB + 1, 1_000_000, 8 * MIB - 100])
@pytest.mark.parametrize("key", KEYS)
async def test_large_serialized_messages_arrive_intact_with_small_ones_behind_them(
    any_hub: HubServer, size: int, key: str
) -> None:
    large = text(size)
    async with (
        connected(any_hub.port, Sec_WebSocket_Protocol=SUBPROTOCOL) as talker,
        connected(any_hub.port, Sec_WebSocket_Protocol=SUBPROTOCOL) as listener,
        connected(any_hub.port) as plain,
    ):
        await plain.subscribes("/t", "std_msgs/String")
        await listener.send_operation(
            "subscribe", topic="/t", type="std_msgs/String", compression="ros1"
        )
        topic = (await listener.receive())["topic_id"]
        await talker.advertises("/t", "std_msgs/String", publisher=7)
        frames = [client_frame(BINARY, serialized(each), KEYS[key]) for each in ("a", large, "b")]
        await talker.send(*frames)
        for expected in ("a", large, "b"):
            _, payload = await listener.frame()
            delivery = read_delivery(payload)
            assert delivery.topic == topic
            assert delivery.message == serialized(expected)[5:]
        assert await plain.receive_data(3) == ["a", large, "b"]


@pytest.mark.parametrize("seed", range(4))
async def test_socket_may_cut_large_messages_anywhere(any_hub: HubServer, seed: int) -> None:
    chance = random.Random(seed)
    texts = [text(chance.choice([10, 70_000, 300_000, 2 * MIB]), each) for each in range(8)]
    data = b"".join(
        client_frame(
            chance.choice([TEXT, BINARY]), operation(each), chance.choice([*KEYS.values()])
        )
        for each in texts
    )
    async with connected(any_hub.port) as talker, connected(any_hub.port) as listener:
        await listener.subscribes("/t", "std_msgs/String", queue_length=100)
        await talker.advertises("/t", "std_msgs/String")
        await cut(talker, data, seed)
        assert await listener.receive_data(len(texts)) == texts
        await talker.is_processed()


@pytest.mark.parametrize("opcode", [TEXT, BINARY])
async def test_message_above_max_message_size_closes_with_1009(
    start_hub: StartHub, opcode: int
) -> None:
    hub = await start_hub(max_message_size=MIB)
    async with connected(hub.port) as client:
        await client.advertises("/t", "std_msgs/String")
        await client.send(publish("/t", "x" * (MIB - 100)))
        await client.is_processed()
        await client.send(client_header(opcode, MIB + 1))
        assert (await client.is_closed())[0] == 1009


UNFINISHED = {
    "large frame": [client_header(BINARY, 60 * MIB), bytes(5 * MIB)],
    "fragment": [client_header(BINARY & 0x7F, 60 * MIB), bytes(5 * MIB)],
    "fragments": [
        frame(BINARY & 0xF, bytes(3 * MIB), fin=False),
        frame(CONT, bytes(3 * MIB), fin=False),
    ],
    "rosbridge fragment": [
        raw_operation("fragment", id="a", num=0, total=2, data=text(5 * MIB)),
    ],
}


@contextmanager
def used_bytes() -> Iterator[Callable[[], int]]:
    """Count the bytes that are allocated from here on, without the cyclic garbage collector."""
    gc.collect()
    gc.disable()
    tracemalloc.start()
    try:
        before, _ = tracemalloc.get_traced_memory()
        yield lambda: tracemalloc.get_traced_memory()[0] - before
    finally:
        tracemalloc.stop()
        gc.enable()


@pytest.mark.parametrize("how", ["reset", "close", "cut off", "killed"])
@pytest.mark.parametrize("unfinished", UNFINISHED)
@pytest.mark.long
async def test_unfinished_message_is_freed_when_the_client_leaves(
    start_hub: StartHub, unfinished: str, how: str
) -> None:
    hub = await start_hub(close_timeout=0.1)
    data = b"".join(UNFINISHED[unfinished])
    async with connected(hub.port) as witness:
        await witness.is_processed()
        with used_bytes() as used:
            async with connected(hub.port, "/?node=/client") as client:
                await client.send(data)
                await until(lambda: used() > 5 * MIB)
                connections = {each.name: each for each in hub._connections}
                if how == "reset":
                    client.reset()
                elif how == "cut off":
                    connections["/client"].abort()
                elif how == "killed":
                    connections["/client"].close(KILLED)
                connections.clear()
            await until(lambda: len(hub._connections) == 1)
            assert used() < MIB


@pytest.mark.parametrize("how", ["reset", "close", "cut off", "killed", "no handshake", "plain"])
async def test_nothing_is_left_of_a_client_that_has_left(hub: HubServer, how: str) -> None:
    def connections() -> int:
        return sum(isinstance(each, Connection | ServerProtocol) for each in gc.get_objects())

    gc.collect()
    gc.disable()
    try:
        before = connections()
        if how == "no handshake":
            async with dialled(hub.port) as client:
                await client.send(b"GET / HTTP/1.1\r\n")
                await until(lambda: hub._connections)
        elif how == "plain":
            async with dialled(hub.port) as client:
                await client.send(b"GET /healthz HTTP/1.1\r\n\r\n")
                assert (await client.response())[0] == 200
        else:
            async with connected(hub.port, Sec_WebSocket_Protocol=SUBPROTOCOL) as client:
                await client.subscribes("/t")
                await client.advertises("/t")
                await client.send_operation("call_service", service="/rosapi/nodes")
                await client.receive()
                [connection] = hub._connections
                if how == "reset":
                    client.reset()
                elif how == "cut off":
                    connection.abort()
                elif how == "killed":
                    connection.close(KILLED)
                del connection
        await until(lambda: not hub._connections)
        # Objects still held by this iteration of the loop are released in the next ones.
        await until(lambda: connections() == before)
    finally:
        gc.enable()


# Slow readers: large frames are written in pieces as the socket takes them.


async def test_slow_reader_gets_large_and_small_messages_intact_and_in_order(
    hub: HubServer,
) -> None:
    texts = [text(size, size) for size in (10, 3 * MIB, 20, 70_000, MIB, 30)]
    async with (
        connected(hub.port, receive_buffer=4 * KIB) as slow,
        connected(hub.port) as talker,
    ):
        await slow.subscribes("/t", "std_msgs/String", queue_length=100)
        await talker.advertises("/t", "std_msgs/String")
        await talker.send(*(publish("/t", each) for each in texts))
        await talker.is_processed()
        assert await slow.receive_data(len(texts)) == texts
        await slow.is_processed()


async def test_half_written_message_is_completed_before_the_close(hub: HubServer) -> None:
    large = text(3 * MIB)
    async with (
        connected(hub.port, "/?node=/slow", receive_buffer=4 * KIB) as slow,
        connected(hub.port) as talker,
    ):
        await slow.subscribes("/t", "std_msgs/String")
        await talker.advertises("/t", "std_msgs/String")
        await talker.send(publish("/t", large))
        await talker.is_processed()
        async with connected(hub.port, "/?node=/slow"):
            data, code, _ = await slow.receive_all()
            assert data == [large]
            assert code == 4001


async def test_half_written_message_is_completed_after_unsubscribe(hub: HubServer) -> None:
    large = text(3 * MIB)
    async with (
        connected(hub.port, receive_buffer=4 * KIB) as slow,
        connected(hub.port) as talker,
    ):
        await slow.subscribes("/t", "std_msgs/String")
        await talker.advertises("/t", "std_msgs/String")
        await talker.send(publish("/t", large), publish("/t", large))
        await talker.is_processed()
        await slow.send_operation("unsubscribe", topic="/t")
        await slow.send_operation("subscribe", topic="/u", type="std_msgs/String")
        await slow.send(publish("/u", "after"))
        received = await slow.receive_data(2)
        assert received[0] == large
        assert received[1] in (large, "after")


async def test_pings_are_answered_between_large_messages(hub: HubServer) -> None:
    large = text(2 * MIB)
    async with (
        connected(hub.port, receive_buffer=4 * KIB) as slow,
        connected(hub.port) as talker,
    ):
        await slow.subscribes("/t", "std_msgs/String")
        await talker.advertises("/t", "std_msgs/String")
        for _ in range(3):
            await talker.send(publish("/t", large))
            await talker.is_processed()
            await slow.send(frame(PING, b"1"), frame(PING, b"2"))
            await talker.is_processed()
            opcodes = [await slow.frame() for _ in range(3)]
            assert [payload for opcode, payload in opcodes if opcode == PONG] == [b"1", b"2"]
            [message] = [payload for opcode, payload in opcodes if opcode != PONG]
            assert json.loads(message)["msg"]["data"] == large


async def test_announced_length_allocates_little_before_the_bytes_come(hub: HubServer) -> None:
    # R6: never allocate memory for an announced length.
    async with connected(hub.port) as client:
        (connection,) = hub._connections
        gc.collect()
        tracemalloc.start()
        try:
            before, _ = tracemalloc.get_traced_memory()
            await client.send(client_header(BINARY, 60 * MIB))
            await until(lambda: connection._reader._parser.in_large)
            _, peak = tracemalloc.get_traced_memory()
        finally:
            tracemalloc.stop()
        assert peak - before < 4 * MIB
        client.reset()
