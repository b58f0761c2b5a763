"""Endpoints: other protocols beside rosbridge on the hub's port."""

from __future__ import annotations

import json
from typing import Any

import pytest
from websockets.asyncio.client import connect

from fibws.access.rights import Principal
from fibws.hub.rosbridge.encodings import text_frame
from fibws.hub.server import HubServer
from fibws.hub.websocket.endpoint import Opening, Registration, Work
from fibws.protocol.serialized import SUBPROTOCOL
from fibws.protocol.websocket import BINARY, KILLED, Payload, server_frame

from ..raw_client import BINARY as BINARY_OPCODE
from ..raw_client import TEXT as TEXT_OPCODE
from ..raw_client import connected, dialled, frame, handshake, nodes, publish, until

pytestmark = pytest.mark.both_loops


class Echo:
    """Sends every message back; ``close`` ends the connection. It is a node of the graph."""

    incomplete_bytes = 0
    protocol = "test"

    def __init__(self, hub: HubServer, opening: Opening) -> None:
        self._hub = hub
        self._opening = opening
        self.node = hub.graph.enter(self, opening.node)

    def receive_text(self, data: Payload) -> None:
        if data == b"close":
            self._opening.close(KILLED)
        else:
            self._opening.queue.reply(text_frame(bytes(data)))

    def receive_binary(self, data: Payload) -> None:
        self._opening.queue.reply(server_frame(BINARY, bytes(data)))

    def refuse(self, data: Payload, reason: str, *, is_text: bool) -> None:
        raise AssertionError("the hub has no limits")

    def registrations(self, what: Registration) -> int:
        return 0

    def authorize(self, principal: Principal) -> Work:
        raise AssertionError("the hub has no authentication")

    def revoke(self) -> None:
        raise AssertionError("the hub has no authentication")

    def leave(self) -> Work:
        self._hub.graph.leave(self, self.node)
        return iter(())

    def replaced(self) -> None:
        self._opening.close(KILLED)

    def publishing(self) -> list[str]:
        return []

    subscribing = providing = publishing


@pytest.fixture
def echo_hub(hub: HubServer) -> HubServer:
    """A hub that echoes for clients of the subprotocol ``echo`` and of the path ``/echo``."""
    hub.endpoints.add(lambda opening: Echo(hub, opening), subprotocol="echo", path="/echo")
    return hub


async def selected(hub: HubServer, offered: str | None, path: str = "/") -> str | None:
    """Return the subprotocol with which the hub answers a handshake."""
    headers = {} if offered is None else {"Sec_WebSocket_Protocol": offered}
    async with dialled(hub.port) as client:
        await client.send(handshake(path, **headers))
        status, answered, _ = await client.response()
    assert status == 101
    return answered.get("sec-websocket-protocol")


@pytest.mark.parametrize(
    ("path", "headers"),
    [
        ("/?node=/echo", {"Sec_WebSocket_Protocol": "echo"}),
        ("/echo?node=/echo", {}),
        ("/echo?node=/echo", {"Sec_WebSocket_Protocol": "unknown"}),
    ],
    ids=["subprotocol", "path", "path and unknown subprotocol"],
)
async def test_second_endpoint_serves_its_clients_while_rosbridge_goes_on(
    echo_hub: HubServer, path: str, headers: dict[str, Any]
) -> None:
    async with (
        connected(echo_hub.port, path, **headers) as client,
        connected(echo_hub.port, "/?node=/talker") as talker,
        connected(echo_hub.port, "/?node=/listener") as listener,
    ):
        await listener.subscribes("/t")
        await talker.advertises("/t")
        for number in range(3):
            await client.send(frame(TEXT_OPCODE, b"hello"), frame(BINARY_OPCODE, b"\xff" * 70_000))
            await talker.send(publish("/t", number))
            assert await client.frame() == (TEXT_OPCODE, b"hello")
            assert await client.frame() == (BINARY_OPCODE, b"\xff" * 70_000)
            assert await listener.receive_data(1) == [number]
        assert sorted(nodes(echo_hub)) == ["/echo", "/listener", "/talker"]
        health = echo_hub.health()
        assert health["clients"] == 3
    await until(lambda: not nodes(echo_hub))


async def test_endpoint_can_close_its_connection(echo_hub: HubServer) -> None:
    async with connected(echo_hub.port, "/echo") as client:
        await client.send(frame(TEXT_OPCODE, b"close"), frame(TEXT_OPCODE, b"not read"))
        assert await client.is_closed() == (KILLED.code, KILLED.reason)
        assert nodes(echo_hub) == []


async def test_newer_rosbridge_client_replaces_an_echo_client_of_its_name(
    echo_hub: HubServer,
) -> None:
    async with connected(echo_hub.port, "/echo?node=/x") as older:
        async with connected(echo_hub.port, "/?node=/x") as newer:
            assert (await older.is_closed())[0] == KILLED.code
            await newer.is_processed()
            assert nodes(echo_hub) == ["/x"]


async def test_subprotocol_decides_before_the_path(echo_hub: HubServer) -> None:
    async with connected(echo_hub.port, "/echo", Sec_WebSocket_Protocol=SUBPROTOCOL) as client:
        await client.send_operation(
            "subscribe", topic="/t", type="std_msgs/Int32", compression="ros1"
        )
        assert (await client.receive())["op"] == "subscribed"


@pytest.mark.parametrize("offered", [None, "unknown", "fibws.v2, rosbridge_v2"])
async def test_unknown_subprotocols_get_plain_rosbridge_and_no_header(
    echo_hub: HubServer, offered: str | None
) -> None:
    assert await selected(echo_hub, offered) is None
    headers: dict[str, Any] = {} if offered is None else {"Sec_WebSocket_Protocol": offered}
    async with connected(echo_hub.port, **headers) as client:
        await client.send_operation("set_level", level="warning")
        await client.send_operation(
            "subscribe", topic="/t", type="std_msgs/Int32", compression="ros1"
        )
        status = await client.receive()
        assert (status["op"], status["level"]) == ("status", "warning")
        await client.send_operation("nonsense")
        assert "code" not in await client.receive()


@pytest.mark.parametrize(
    ("offered", "expected"),
    [
        ("echo", "echo"),
        ("fibws.v1", "fibws.v1"),
        ("unknown, fibws.v1, echo", "fibws.v1"),
        ("echo, fibws.v1", "echo"),
        ("FIBWS.V1", None),
    ],
)
async def test_first_known_subprotocol_is_selected(
    echo_hub: HubServer, offered: str, expected: str | None
) -> None:
    assert await selected(echo_hub, offered) == expected


async def test_real_client_negotiates_fibws_v1(hub: HubServer) -> None:
    async with connect(hub.url, subprotocols=[SUBPROTOCOL]) as websocket:  # type: ignore[list-item]
        assert websocket.subprotocol == SUBPROTOCOL
        await websocket.send('{"op":"nonsense"}')
        assert json.loads(await websocket.recv())["code"] == "invalid_operation"
