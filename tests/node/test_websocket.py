"""Messages take short ways, and lose neither their order nor others' turns by that."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager

import pytest
from websockets.asyncio.client import connect
from websockets.asyncio.server import ServerConnection, serve
from websockets.exceptions import ConnectionClosed

from fibws.node.websocket import TURN, WebSocket


@asynccontextmanager
async def pair() -> AsyncIterator[tuple[WebSocket, ServerConnection]]:
    """A client's connection, and the server's end of it."""
    accepted: asyncio.Future[ServerConnection] = asyncio.get_running_loop().create_future()

    async def accept(websocket: ServerConnection) -> None:
        accepted.set_result(websocket)
        await websocket.wait_closed()

    async with serve(accept, "127.0.0.1", 0, max_size=None) as server:
        host, port = server.sockets[0].getsockname()
        url = f"ws://{host}:{port}"
        async with connect(
            url, create_connection=WebSocket, compression=None, max_size=None
        ) as websocket:
            assert isinstance(websocket, WebSocket)
            yield websocket, await accepted


def numbers(count: int) -> list[bytes]:
    return [b"%d" % number for number in range(count)]


async def heard(websocket: ServerConnection, count: int) -> list[bytes]:
    async with asyncio.timeout(60):
        return [await websocket.recv(decode=False) for _ in range(count)]


async def test_a_message_is_written_before_the_call_returns() -> None:
    async with pair() as (client, server):
        assert client.write_at_once(b"hello")
        assert await heard(server, 1) == [b"hello"]


async def test_a_turn_has_its_bounds_and_the_next_one_has_them_anew() -> None:
    async with pair() as (client, server):
        for _ in range(2):
            written = [text for text in numbers(TURN + 5) if client.write_at_once(text)]
            assert written == numbers(TURN)
            assert await heard(server, TURN) == written


async def test_nothing_is_written_at_once_to_a_socket_that_is_behind() -> None:
    async with pair() as (client, server):
        count = 0
        while client.write_at_once(bytes([count]) * (1 << 20)):
            count += 1
        assert 0 < count < TURN, "the server had no turn to read"
        assert [text[0] for text in await heard(server, count)] == list(range(count))


async def test_a_loop_that_another_thread_acts_for_is_woken_for_what_is_left(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    async with pair() as (client, server):
        woken: list[object] = []
        with monkeypatch.context() as patch:
            patch.setattr(client.loop, "call_soon_threadsafe", woken.append)
            assert client.write_at_once(b"small")
            assert not woken
            assert client.write_at_once(bytes(1 << 24))
            assert len(woken) == 1
        assert [len(text) for text in await heard(server, 2)] == [5, 1 << 24]


async def test_nothing_is_written_to_a_connection_that_was_closed() -> None:
    async with pair() as (client, _):
        await client.close()
        assert not client.write_at_once(b"too late")


class Reader:
    """Is handed messages, and reads those that are not handed on."""

    def __init__(self, websocket: WebSocket, more: Callable[[bytes], bool]) -> None:
        self.handed: list[bytes] = []
        self.received: list[bytes] = []
        self.order: list[bytes] = []
        self._more = more
        websocket.hand_to(self._take)
        self._websocket = websocket

    def _take(self, text: bytes) -> bool:
        self.handed.append(text)
        self.order.append(text)
        return self._more(text)

    async def read(self, count: int) -> None:
        """Read until so many messages have come by either way."""
        async with asyncio.timeout(60):
            while len(self.order) < count:
                try:
                    async with asyncio.timeout(0.01):
                        text = await self._websocket.receive()
                except TimeoutError:
                    continue
                self.received.append(text)
                self.order.append(text)


async def test_messages_are_handed_on_in_order() -> None:
    async with pair() as (client, server):
        reader = Reader(client, lambda text: True)
        for text in numbers(3):
            await server.send(text, text=True)
        await reader.read(3)
        assert reader.handed == reader.order == numbers(3)


async def test_in_one_turn_no_more_are_handed_on_than_its_bound() -> None:
    async with pair() as (client, server):
        reader = Reader(client, lambda text: True)
        for text in numbers(5 * TURN):  # The socket has them all before the client's next turn.
            server.protocol.send_text(text)
        server.transport.write(b"".join(server.protocol.data_to_send()))
        await reader.read(5 * TURN)
        assert reader.order == numbers(5 * TURN)
        assert reader.received, "the rest waits to be read"


async def test_who_wants_no_more_is_handed_none_in_that_turn() -> None:
    async with pair() as (client, server):
        reader = Reader(client, lambda text: text != b"1")
        for text in numbers(4):
            server.protocol.send_text(text)
        server.transport.write(b"".join(server.protocol.data_to_send()))
        await reader.read(4)
        assert reader.handed == numbers(2)
        assert reader.order == numbers(4)
        await server.send("later")
        await reader.read(5)
        assert reader.handed[-1] == b"later", "nothing waits any more"


async def test_what_came_before_there_was_anybody_is_read_first() -> None:
    async with pair() as (client, server):
        await server.send("early")
        await (await server.ping())
        reader = Reader(client, lambda text: True)
        await server.send("late")
        await (await server.ping())
        await reader.read(2)
        assert (reader.received, reader.handed) == ([b"early", b"late"], [])


async def test_a_message_in_fragments_comes_whole() -> None:
    async with pair() as (client, server):
        reader = Reader(client, lambda text: True)
        await server.send(["one ", "two ", "three"])
        await server.send("four")
        await reader.read(2)
        assert reader.order == [b"one two three", b"four"]


async def test_who_reads_hears_of_the_end() -> None:
    async with pair() as (client, server):
        Reader(client, lambda text: True)
        await server.close()
        with pytest.raises(ConnectionClosed):
            await client.receive()
