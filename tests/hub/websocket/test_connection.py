"""A client's connection over a real socket: messages, a real client, the log."""

from __future__ import annotations

import gc
import json
import logging
import time
from typing import Any

import pytest
from conftest import StartHub
from websockets.asyncio.client import connect
from websockets.exceptions import ConnectionClosed
from websockets.http11 import Request

from fibws.hub.server import HubServer
from fibws.hub.settings import KIB, MIB

from ..raw_client import (
    BINARY,
    CONT,
    PING,
    PONG,
    TEXT,
    connected,
    fragmented,
    frame,
    longest_turn,
    publish,
    until,
)

pytestmark = pytest.mark.both_loops


async def test_headers_of_the_handshake_are_not_kept(hub: HubServer) -> None:
    """A thousand connections would keep a thousand tokens and cookies in memory."""
    async with connected(hub.port, X_Secret="secret") as client:
        await client.is_processed()
        requests = [each for each in gc.get_objects() if type(each) is Request]
        assert [each for each in requests if "X-Secret" in each.headers] == []


class TestMessages:
    @pytest.mark.parametrize("size", [0, 1, 125, 126, 65535, 65536, MIB, 4 * MIB])
    async def test_text_of_any_size_passes(self, any_hub: HubServer, size: int) -> None:
        text = "x" * size
        async with connected(any_hub.port) as client:
            await client.subscribes("/t", "std_msgs/String")
            await client.advertises("/t", "std_msgs/String")
            await client.send(publish("/t", text))
            assert await client.receive_data(1) == [text]

    @pytest.mark.parametrize(
        "payload", [b"", b" ", b"null", b"[]", b"1", b'"x"', b"{", b"\xef\xbb\xbf{}"]
    )
    async def test_text_that_is_not_an_operation_gets_an_error(
        self, any_hub: HubServer, payload: bytes
    ) -> None:
        async with connected(any_hub.port) as client:
            await client.send(frame(TEXT, payload))
            received = await client.receive() if payload.strip() else None
            await client.is_processed()
        assert received is None or (received["op"], received["level"]) == ("status", "error")

    async def test_message_of_the_maximum_size_is_read_fast(self, hub: HubServer) -> None:
        # R6: half a minute if the tail grew by copying; see tests/protocol, too.
        async with connected(hub.port) as client:
            await client.advertises("/t", "std_msgs/String")
            message = publish("/t", "x" * 60 * MIB)
            began = time.thread_time()
            await client.send(message)
            await client.is_processed()
            assert time.thread_time() - began < 10

    @pytest.mark.parametrize("size", [1, 7, 1000, 16 * KIB, 300 * KIB])
    async def test_socket_may_cut_frames_anywhere(self, any_hub: HubServer, size: int) -> None:
        texts = ["", "a" * 130, "b" * (2000 if size < 1000 else 400_000), "c"]
        sent = b"".join(
            [
                publish("/t", texts[0]),
                frame(PING),
                publish("/t", texts[1]),
                publish("/t", texts[2]),
                *fragmented(publish("/t", texts[3]), 9),
            ]
        )
        async with connected(any_hub.port) as client, connected(any_hub.port) as listener:
            await listener.subscribes("/t", "std_msgs/String")
            await client.advertises("/t", "std_msgs/String")
            for start in range(0, len(sent), size):
                await client.send(sent[start : start + size])
            assert await listener.receive_data(4) == texts

    async def test_fragmented_messages_may_have_pings_in_between(self, any_hub: HubServer) -> None:
        async with connected(any_hub.port) as client:
            await client.subscribes("/t")
            for number in range(3):
                pieces = fragmented(publish("/t", number), 5)
                await client.send(*(piece + frame(PING, b"p") for piece in pieces))
                for _ in pieces[:-1]:
                    assert await client.frame() == (PONG, b"p")
                assert {await client.frame(), await client.frame()} == {
                    (PONG, b"p"),
                    (TEXT, b'{"op":"publish","topic":"/t","msg":{"data":%d}}' % number),
                }

    async def test_json_in_binary_frames_is_accepted(self, any_hub: HubServer) -> None:
        async with connected(any_hub.port) as client:
            await client.subscribes("/t")
            message = json.dumps({"op": "publish", "topic": "/t", "msg": {"data": 5}}).encode()
            await client.send(frame(BINARY, message))
            await client.send(frame(BINARY, message[:9], fin=False), frame(CONT, message[9:]))
            assert await client.receive_data(2) == [5, 5]

    async def test_binary_that_is_neither_json_nor_cbor_gets_an_error(
        self, any_hub: HubServer
    ) -> None:
        async with connected(any_hub.port) as client:
            await client.send(frame(BINARY, b"\xff\xfe"))
            assert (await client.receive())["level"] == "error"
            await client.is_processed()

    async def test_4096_fragments_are_accepted(self, any_hub: HubServer) -> None:
        async with connected(any_hub.port) as client:
            await client.subscribes("/t")
            (whole,) = fragmented(publish("/t", 1), 1000)
            empty = frame(CONT, fin=False) * 4094
            await client.send(frame(TEXT, fin=False), empty, frame(CONT, whole[6:]))
            assert await client.receive_data(1) == [1]

    async def test_4097_fragments_are_refused(self, any_hub: HubServer) -> None:
        # R5: empty fragments do not count towards the size, and the library does not count them.
        async with connected(any_hub.port) as client:
            await client.send(frame(TEXT, fin=False), frame(CONT, fin=False) * 4096)
            assert await client.is_closed() == (1009, "too many fragments in one message")
            assert await client.to_the_end() == b""

    async def test_one_frame_may_hold_several_operations(self, any_hub: HubServer) -> None:
        async with connected(any_hub.port) as client:
            await client.subscribes("/t")
            one, other = publish("/t", 1)[6:], publish("/t", 2)[6:]
            await client.send(frame(TEXT, one + b" " + other))
            assert await client.receive_data(2) == [1, 2]

    async def test_frame_of_many_objects_does_not_block_the_hub(
        self, hub: HubServer, caplog: pytest.LogCaptureFixture
    ) -> None:
        """Two bytes for which the hub writes three hundred, a hundred thousand times."""
        async with connected(hub.port) as flooder:
            async with longest_turn() as longest:
                await flooder.send(frame(TEXT, b"{}" * 100_000))
                await until(lambda: "Received a message without an op" in caplog.text)
            flooder.reset()
        assert longest() < 0.5


class TestRealClient:
    @pytest.mark.parametrize("size", [0, 125, 126, 65535, 65536, MIB])
    async def test_texts_of_any_size_go_both_ways(self, hub: HubServer, size: int) -> None:
        text = "ü" * (size // 2)
        async with connect(hub.url, max_size=None) as websocket:
            for fields in (
                {"op": "subscribe", "topic": "/t", "type": "std_msgs/String"},
                {"op": "publish", "topic": "/t", "msg": {"data": text}},
            ):
                await websocket.send(json.dumps(fields, ensure_ascii=False))
            received = json.loads(await websocket.recv())
            assert received["msg"]["data"] == text

    async def test_fragments_and_pings_go_both_ways(self, start_hub: StartHub) -> None:
        hub = await start_hub(ping_interval=0.05)
        async with connect(hub.url, ping_interval=0.05) as websocket:
            await websocket.send(
                json.dumps({"op": "subscribe", "topic": "/t", "type": "std_msgs/Int32"})
            )
            pieces = ['{"op":"publish","topic":"/t",', '"msg":{"data"', ":7}}"]
            await websocket.send(pieces)
            assert json.loads(await websocket.recv())["msg"] == {"data": 7}
            await (await websocket.ping())

    async def test_close_is_clean(self, hub: HubServer) -> None:
        async with connect(hub.url) as websocket:
            await websocket.close(4000, "enough")
            with pytest.raises(ConnectionClosed) as closed:
                await websocket.recv()
        assert closed.value.rcvd is not None
        assert (closed.value.rcvd.code, closed.value.rcvd.reason) == (4000, "enough")


class TestLogging:
    async def test_connection_is_logged_with_its_name_and_address(
        self, hub: HubServer, caplog: pytest.LogCaptureFixture
    ) -> None:
        caplog.set_level(logging.INFO)
        async with connected(hub.port, "/?node=/talker") as client:
            await client.is_processed()
            assert f"/talker has connected from 127.0.0.1:{client.port}." in caplog.text

    async def test_connections_of_commands_are_logged_at_level_debug(
        self, hub: HubServer, caplog: pytest.LogCaptureFixture
    ) -> None:
        caplog.set_level(logging.DEBUG, "fibws.hub")
        nodes = ["/fibws_tool_12_345", "/lab/fibws_echo_1_2", "/fibws_robot", "/fibws_tool_1_2x"]
        for node in nodes:
            async with connected(hub.port, f"/?node={node}") as client:
                await client.is_processed()
        records = [each for each in caplog.records if "has connected" in each.getMessage()]
        assert [record.levelname for record in records] == ["DEBUG", "DEBUG", "INFO", "INFO"]

    @pytest.mark.parametrize(
        "fields",
        [
            {"op": "{}"},
            {"op": "subscribe", "topic": "/t", "type": "{}"},
            {"op": "subscribe", "topic": "/t", "type": "a/{}"},
            {"op": "subscribe", "topic": "/t", "type": "std_msgs/{}"},
            {"op": "advertise", "topic": "{}", "type": "std_msgs/Int32"},
            {"op": "publish", "topic": "{}"},
            {"op": "set_level", "level": "{}"},
            {"op": "fragment", "id": "{}", "num": 5, "total": 1, "data": ""},
        ],
        ids=lambda fields: " ".join(fields.values()) if "num" not in fields else "fragment",
    )
    async def test_control_characters_of_clients_are_escaped_in_the_log(
        self, hub: HubServer, caplog: pytest.LogCaptureFixture, fields: dict[str, Any]
    ) -> None:
        """Clients cannot add lines, terminal escape codes or megabytes."""
        bad = "\n\x1b[2J" + "x" * 5000
        fields = {
            name: value.replace("{}", bad) if isinstance(value, str) else value
            for name, value in fields.items()
        }
        async with connected(hub.port) as client:
            await client.send(frame(TEXT, json.dumps(fields).encode()))
            await client.receive()
        for record in caplog.records:
            text = record.getMessage()
            assert (len(text) < 2000, text.isprintable()) == (True, True)
