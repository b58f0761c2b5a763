"""Compressed messages: permessage-deflate, which clients offer in their handshake."""

from __future__ import annotations

import asyncio
import json
import random
import zlib
from collections.abc import AsyncIterator
from pathlib import Path
from typing import Any

import pytest
from conftest import StartHub
from patience import PATIENCE
from websockets.asyncio.client import ClientConnection, connect

from fibws.access.token_file import digest_of
from fibws.hub.server import HubServer
from fibws.hub.settings import KIB, MIB
from fibws.hub.websocket.deflate_extension import may_deflate
from fibws.protocol.deflate import MOST_BITS, PIECE

from ..raw_client import (
    BINARY,
    CONT,
    PING,
    TEXT,
    Client,
    connected,
    dialled,
    frame,
    handshake,
    publish,
)

RSV1 = 4
OFFER = "permessage-deflate"
ACCEPTED = "permessage-deflate; server_no_context_takeover; client_no_context_takeover"
STRING = "std_msgs/String"


def compressed(data: bytes, bits: int = MOST_BITS) -> bytes:
    """The payload of a compressed message."""
    deflater = zlib.compressobj(wbits=-bits)
    return (deflater.compress(data) + deflater.flush(zlib.Z_SYNC_FLUSH))[:-4]


def deflated(client_frame: bytes, opcode: int = TEXT) -> bytes:
    """A client's frame with its payload compressed."""
    start = {126: 8, 127: 14}.get(client_frame[1] & 127, 6)
    return frame(opcode, compressed(client_frame[start:]), rsv=RSV1)


@pytest.fixture(params=[True, False], ids=["fast", "slow"])
async def hub(request: pytest.FixtureRequest, start_hub: StartHub) -> HubServer:
    """A hub that compresses for all, with fast framing and without it."""
    return await start_hub(fast_framing=request.param, deflate="always", max_message_size=8 * MIB)


@pytest.fixture
def tokens(tmp_path: Path) -> Path:
    """A hub's file of tokens."""
    path = tmp_path / "tokens.toml"
    path.write_text(f'[tokens.robot]\nsha256 = "{digest_of("robot")}"\nadmin = true\n', "utf-8")
    return path


@pytest.fixture
async def client(hub: HubServer) -> AsyncIterator[Client]:
    """A client that may send compressed messages."""
    async with connected(hub.port, Sec_WebSocket_Extensions=OFFER) as client:
        yield client


async def accepted(hub: HubServer, offer: str = OFFER, **headers: str) -> str | None:
    """The hub's answer to an offer."""
    async with dialled(hub.port) as client:
        await client.send(handshake(Sec_WebSocket_Extensions=offer, **headers))
        status, found, _ = await client.response()
    assert status == 101
    return found.get("sec-websocket-extensions")


class TestNegotiation:
    @pytest.mark.parametrize(
        ("offer", "answer"),
        [
            (OFFER, ACCEPTED),
            (f"{OFFER}; client_max_window_bits", ACCEPTED),
            (f"{OFFER}; server_max_window_bits=10", f"{ACCEPTED}; server_max_window_bits=10"),
            (f"{OFFER}; server_max_window_bits=8", None),
            (f"{OFFER}; server_max_window_bits=8, {OFFER}", ACCEPTED),
            (f"{OFFER}; unknown", None),
            ("x-webkit-deflate-frame", None),
            (f"{OFFER}, {OFFER}", ACCEPTED),
        ],
    )
    async def test_offer_is_accepted_without_context_takeover(
        self, hub: HubServer, offer: str, answer: str | None
    ) -> None:
        assert await accepted(hub, offer) == answer

    @pytest.mark.parametrize("protocol", ["fibws.v1", "fibws.hub.v1", "foxglove.sdk.v1"])
    async def test_protocols_with_binary_messages_have_none(
        self, hub: HubServer, protocol: str
    ) -> None:
        assert await accepted(hub, Sec_WebSocket_Protocol=protocol) is None

    @pytest.mark.parametrize("settings", [{}, {"deflate": "never"}])
    async def test_clients_of_this_machine_have_none(
        self, start_hub: StartHub, settings: dict[str, str]
    ) -> None:
        assert await accepted(await start_hub(**settings)) is None

    async def test_address_that_a_proxy_names_counts(self, start_hub: StartHub) -> None:
        hub = await start_hub(trusted_proxy=("127.0.0.1",))
        assert await accepted(hub, X_Forwarded_For="192.0.2.7") == ACCEPTED
        assert await accepted(hub, X_Forwarded_For="127.0.0.1") is None

    @pytest.mark.parametrize(
        ("address", "expected"),
        [
            ("127.0.0.1", False),
            ("::1", False),
            ("::ffff:127.0.0.1", False),
            ("unknown", False),
            ("192.168.1.2", True),
            ("fe80::1%eth0", True),
            ("::ffff:10.0.0.1", True),
        ],
    )
    def test_addresses_of_this_machine(self, address: str, expected: bool) -> None:
        assert may_deflate("auto", address) is expected
        assert may_deflate("always", address)
        assert not may_deflate("never", address)

    async def test_compressed_message_without_negotiation_is_an_error(self, hub: HubServer) -> None:
        async with connected(hub.port) as client:
            await client.send(deflated(publish("/t", "x")))
            assert await client.is_closed() == (1002, "reserved bits must be 0")


class TestIncoming:
    async def test_compressed_and_other_messages_keep_their_order(
        self, hub: HubServer, client: Client
    ) -> None:
        async with connected(hub.port) as listener:
            await listener.subscribes("/t", STRING, queue_length=100)
            await client.advertises("/t", STRING)
            texts = [f"{number}" + "x" * size for number, size in enumerate([0, 10, 1000, MIB, 5])]
            plain = [publish("/t", text) for text in texts]
            whole = [deflated(each) for each in plain]
            body = compressed(b'{"op":"publish","topic":"/t","msg":{"data":"%b"}}' % (b"f" * 9999))
            fragments = [
                frame(TEXT, body[:5], fin=False, rsv=RSV1),
                frame(PING, b"between"),
                frame(CONT, body[5:9], fin=False),
                frame(CONT, body[9:]),
            ]
            await client.send(*plain, *whole, *fragments, deflated(plain[0], BINARY), plain[1])
            expected = [*texts, *texts, "f" * 9999, texts[0], texts[1]]
            assert await listener.receive_data(len(expected)) == expected

    async def test_each_compressed_message_counts_once(
        self, hub: HubServer, client: Client
    ) -> None:
        await client.send(deflated(frame(TEXT, b"{}")))
        assert (await client.receive())["op"] == "status"
        [connection] = hub._connections
        assert connection.messages_received == 1
        assert connection.incoming_bytes == 0

    async def test_bomb_is_refused_as_other_messages_that_are_too_large(
        self, hub: HubServer, client: Client
    ) -> None:
        bomb = frame(TEXT, compressed(b" " * (8 * MIB + 1)), rsv=RSV1)
        assert len(bomb) < 10 * KIB
        await client.send(bomb)
        assert await client.is_closed() == (1009, f"frame exceeds limit of {8 * MIB} bytes")

    async def test_stranger_may_inflate_little(self, start_hub: StartHub, tokens: Path) -> None:
        hub = await start_hub(tokens=tokens, deflate="always")
        async with connected(hub.port, Sec_WebSocket_Extensions=OFFER) as client:
            await client.send(frame(TEXT, compressed(b" " * (64 * KIB + 1)), rsv=RSV1))
            assert await client.is_closed() == (1009, f"frame exceeds limit of {64 * KIB} bytes")

    @pytest.mark.parametrize(
        ("sent", "closed"),
        [
            (
                frame(TEXT, b"\xff\xff\xff", rsv=RSV1),
                (1007, "a compressed message cannot be inflated"),
            ),
            (frame(TEXT, compressed(b'{"op":"\xff"}'), rsv=RSV1), (1007, "a text is not UTF-8")),
            (frame(TEXT, b"", rsv=2), (1002, "reserved bits must be 0")),
            (frame(TEXT, b"", rsv=6), (1002, "reserved bits must be 0")),
            (frame(PING, b"", rsv=RSV1), (1002, "reserved bits must be 0")),
            (
                frame(TEXT, b"", fin=False, rsv=RSV1) + frame(CONT, b"", rsv=RSV1),
                (1002, "reserved bits must be 0"),
            ),
        ],
    )
    async def test_invalid_compression_closes_the_connection(
        self, client: Client, sent: bytes, closed: tuple[int, str]
    ) -> None:
        await client.send(sent)
        assert await client.is_closed() == closed

    async def test_inflated_bytes_count_towards_the_rate(self, start_hub: StartHub) -> None:
        hub = await start_hub(deflate="always", max_bytes_per_second=1000)
        async with connected(hub.port, Sec_WebSocket_Extensions=OFFER) as client:
            await client.send(frame(TEXT, compressed(b" " * MIB), rsv=RSV1))
            await client.is_processed()
            await client.send_operation("call_service", id="a", service="/rosapi/get_time")
            status = await client.receive()
            assert "max-bytes-per-second" in status["msg"]

    async def test_large_compressed_message_is_inflated(
        self, hub: HubServer, client: Client
    ) -> None:
        """Its compressed bytes do not fit one read, and its text many pieces."""
        text = random.Random(1).randbytes(300 * KIB).hex()
        assert len(text) > 8 * PIECE
        async with connected(hub.port) as listener:
            await listener.subscribes("/t", STRING)
            await client.advertises("/t", STRING)
            sent = deflated(publish("/t", text))
            assert len(sent) > 256 * KIB
            await client.send(sent)
            assert await listener.receive_data(1) == [text]


async def messages(websocket: ClientConnection, count: int) -> list[dict[str, Any]]:
    """The next operations that a client gets."""
    async with asyncio.timeout(PATIENCE):
        return [json.loads(await websocket.recv()) for _ in range(count)]


class TestRealClient:
    """The library `websockets`, which offers compression unless told otherwise."""

    async def test_both_directions_are_compressed(self, hub: HubServer) -> None:
        text = {"data": "x" * 10_000}
        async with connect(hub.url) as websocket:
            [extension] = websocket.protocol.extensions
            assert extension.name == OFFER
            await websocket.send(json.dumps({"op": "subscribe", "topic": "/t", "type": STRING}))
            for op in ("advertise", "publish"):
                await websocket.send(
                    json.dumps({"op": op, "topic": "/t", "type": STRING, "msg": text})
                )
            [received] = await messages(websocket, 1)
            assert received["msg"] == text
            [connection] = hub._connections
            assert connection.queue.bytes_sent < 500
            assert connection.bytes_received < 1500

    @pytest.mark.parametrize("compression", [None, "deflate"])
    async def test_messages_of_all_lengths_arrive_in_order(
        self, hub: HubServer, compression: str | None
    ) -> None:
        """Beside a client without compression, which gets the same."""
        sizes = [10, 3000, 20_000, 300_000, 5, 600_000, 40_000, 3000, 1]
        texts = [f"{number}" * size for number, size in enumerate(sizes)]
        async with (
            connect(hub.url, compression=compression) as websocket,
            connected(hub.port) as talker,
        ):
            subscribe = {"op": "subscribe", "topic": "/t", "type": STRING, "queue_length": 100}
            await websocket.send(json.dumps(subscribe))
            await (await websocket.ping())
            await talker.advertises("/t", STRING)
            await talker.send(*(publish("/t", text) for text in texts))
            received = await messages(websocket, len(texts))
        assert [each["msg"]["data"] for each in received] == texts

    async def test_listing_is_compressed(self, hub: HubServer) -> None:
        async with connect(hub.url) as websocket, connected(hub.port) as talker:
            for number in range(200):
                await talker.send_operation(
                    "advertise", topic=f"/robot/sensor_{number}/data", type=STRING
                )
            await talker.is_processed()
            call = {"op": "call_service", "service": "/rosapi/topics", "id": "a"}
            await websocket.send(json.dumps(call))
            [response] = await messages(websocket, 1)
            assert len(response["values"]["topics"]) > 200
            [sent] = [each.queue.bytes_sent for each in hub._connections if each.queue.deflate]
            assert sent < len(json.dumps(response)) / 4
