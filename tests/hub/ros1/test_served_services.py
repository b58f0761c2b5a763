"""Services of the hub's clients, called by ROS 1 nodes."""

from __future__ import annotations

import asyncio
import struct
from collections.abc import AsyncIterator, Callable
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit

import pytest
from conftest import StartHub
from hub_reload import reloaded

from fibws.access.rights import Rights
from fibws.access.token_file import TokenFile
from fibws.hub.graph.graph import Graph
from fibws.hub.graph.policy import AllowAll
from fibws.hub.graph.service import Call, Service
from fibws.hub.ros1.connection import TcprosConnection
from fibws.hub.ros1.definition_search import DefinitionSearch
from fibws.hub.ros1.services import ServiceLinks
from fibws.hub.settings import Settings

from ..fakes import ADD, NANOSECONDS, STANDARD
from .service_peers import FakeClient, FakeService, new_node, new_nodes

ADD_MD5 = "6a2e34150c00229791cc89ff309fff21"
REQUEST = struct.pack("<qq", 2**62, -1)
SUM = struct.pack("<q", 2**62 - 1)


class Server:
    """A WebSocket client's services: calls wait until the test responds, or a function does."""

    node = "/provider"

    def __init__(self, respond: Callable[[Call], object] | None = None) -> None:
        self.calls: asyncio.Queue[Call] = asyncio.Queue()
        self.cancelled: asyncio.Queue[Call] = asyncio.Queue()
        self.requests: list[dict[str, Any]] = []
        self.headers: list[dict[str, str] | None] = []
        self._respond = respond

    def handle(self, call: Call) -> None:
        self.requests.append(call.request.values())
        self.headers.append(call.headers)
        self.calls.put_nowait(call)
        if self._respond is not None:
            self._respond(call)

    def cancel(self, call: Call) -> None:
        self.cancelled.put_nowait(call)

    def displaced(self, service: Service) -> None:
        """Do nothing."""


def add(call: Call) -> None:
    request = call.request.values()
    call.respond({"sum": request["a"] + request["b"]})


class ServingHub:
    """A graph whose services ROS 1 nodes can call."""

    def __init__(self, policy: AllowAll | None = None, **settings: Any) -> None:
        self.graph = Graph(STANDARD, lambda: NANOSECONDS, policy=policy)
        self.nodes = new_nodes(self.graph)
        self.links = ServiceLinks(
            self.graph, self.nodes, Settings(**settings), DefinitionSearch([], {})
        )
        self._connections: list[TcprosConnection] = []
        self._vacant = asyncio.Event()
        """Set when a connection has ended and no other is left."""
        self._clients: list[FakeClient] = []
        self._server: asyncio.Server

    async def start(self) -> None:
        loop = asyncio.get_running_loop()
        self._server = await loop.create_server(self._new, "127.0.0.1", 0)
        self.port = self._server.sockets[0].getsockname()[1]

    async def close(self) -> None:
        self._server.close()
        for client in self._clients:
            await client.leave()
        await self.links.close()
        if self._connections:
            await self.vacant()

    async def vacant(self) -> None:
        """Wait until no client is connected."""
        async with asyncio.timeout(60):
            await self._vacant.wait()

    async def connect(self, **header: str) -> FakeClient:
        client, answer = await self.request(**header)
        assert "error" not in answer
        return client

    async def request(self, **header: str) -> tuple[FakeClient, dict[str, str]]:
        client, answer = await FakeClient.connect(self.port, **header)
        self._clients.append(client)
        return client, answer

    async def refusal(self, **header: str) -> str:
        """Return the error that a client gets instead of a header."""
        client, answer = await self.request(**header)
        assert await client.ends()
        return answer["error"]

    def _new(self) -> TcprosConnection:
        loop = asyncio.get_running_loop()
        connection = TcprosConnection({"service": self.links}, loop, 60.0, self._closed)
        self._connections.append(connection)
        self._vacant.clear()
        return connection

    def _closed(self, connection: TcprosConnection) -> None:
        self._connections.remove(connection)
        if not self._connections:
            self._vacant.set()


@pytest.fixture
async def hub() -> AsyncIterator[ServingHub]:
    hub = ServingHub()
    await hub.start()
    yield hub
    await hub.close()


async def test_header_names_the_type_and_the_provider(hub: ServingHub) -> None:
    hub.graph.serve("/add", ADD, None, Server())
    _, header = await hub.request()
    assert header["callerid"] == "/provider"
    assert header["md5sum"] == ADD_MD5
    assert header["type"] == ADD
    assert header["request_type"] == "rospy_tutorials/AddTwoIntsRequest"
    assert header["response_type"] == "rospy_tutorials/AddTwoIntsResponse"


async def test_call_is_served_once_and_the_connection_ends(hub: ServingHub) -> None:
    server = Server(add)
    hub.graph.serve("/add", ADD, None, server)
    client = await hub.connect(md5sum=ADD_MD5)
    client.send(REQUEST, REQUEST)
    assert await client.answer() == (True, SUM)
    assert await client.ends()
    assert server.requests == [{"a": 2**62, "b": -1}]


@pytest.mark.parametrize("persistent", ["1", "true", "True"])
async def test_persistent_connection_serves_many_calls_in_order(
    hub: ServingHub, persistent: str
) -> None:
    server = Server()
    hub.graph.serve("/add", ADD, None, server)
    client = await hub.connect(persistent=persistent)
    client.send(REQUEST, struct.pack("<qq", 1, 2), struct.pack("<qq", 3, 4))
    for _ in range(3):
        call = await server.calls.get()
        assert server.calls.empty(), "the next request must wait"
        call.respond({"sum": sum(server.requests[-1].values())})
    assert [await client.answer() for _ in range(3)] == [
        (True, SUM),
        (True, struct.pack("<q", 3)),
        (True, struct.pack("<q", 7)),
    ]


async def test_probe_is_not_a_call(hub: ServingHub) -> None:
    server = Server(add)
    hub.graph.serve("/add", ADD, None, server)
    client = await hub.connect(probe="1")
    client.send(REQUEST)
    assert await client.ends()
    assert server.requests == []


@pytest.mark.parametrize("missing", ["md5sum", "callerid"])
async def test_missing_header_field_is_named(hub: ServingHub, missing: str) -> None:
    hub.graph.serve("/add", ADD, None, Server())
    assert missing in await hub.refusal(**{missing: ""})


async def test_client_with_another_md5_is_refused_as_rospy_does(hub: ServingHub) -> None:
    hub.graph.serve("/add", ADD, None, Server())
    error = await hub.refusal(md5sum="0" * 32)
    text = f"request from [/caller]: md5sums do not match: [{'0' * 32}] vs. [{ADD_MD5}]"
    assert error == text


async def test_unknown_service_is_refused(hub: ServingHub) -> None:
    assert "is not a provider of [/add]" in await hub.refusal()


async def test_service_of_a_ros1_node_is_not_relayed_to_another(hub: ServingHub) -> None:
    async with FakeService({"type": ADD, "md5sum": ADD_MD5}) as service:
        hub.links.register(new_node(hub.nodes, "/server"), "/add", service.uri)
        assert "is not a provider of [/add]" in await hub.refusal()


async def test_service_whose_fields_are_unknown_is_refused_by_its_type(hub: ServingHub) -> None:
    hub.graph.serve("/add", "unknown_msgs/Add", None, Server())
    assert "unknown_msgs/Add" in await hub.refusal()


async def test_service_of_the_hub_itself_is_called(hub: ServingHub) -> None:
    hub.graph.serve_internally("/add", ADD, "/rosapi", lambda request, caller: {"sum": 5})
    client = await hub.connect()
    assert await client.call(REQUEST) == (True, struct.pack("<q", 5))


async def test_error_of_the_server_reaches_the_client(hub: ServingHub) -> None:
    hub.graph.serve("/add", ADD, None, Server(lambda call: call.fail("too large")))
    client = await hub.connect(persistent="1")
    assert await client.call(REQUEST) == (False, b"too large")
    assert await client.call(REQUEST) == (False, b"too large")


@pytest.mark.parametrize("request_", [b"", b"1234", REQUEST + b"1"])
async def test_invalid_request_fails_alone(hub: ServingHub, request_: bytes) -> None:
    hub.graph.serve("/add", ADD, None, Server(add))
    client = await hub.connect(persistent="1")
    is_ok, text = await client.call(request_)
    assert not is_ok
    assert b"AddTwoInts" in text
    assert await client.call(REQUEST) == (True, SUM)


async def test_client_that_leaves_abandons_its_call(hub: ServingHub) -> None:
    server = Server()
    hub.graph.serve("/add", ADD, None, server)
    client = await hub.connect()
    client.send(REQUEST)
    call = await server.calls.get()
    await client.leave()
    assert await server.cancelled.get() is call
    call.respond({"sum": 1})  # It is too late, and does no harm.


async def test_client_that_leaves_without_a_call_does_no_harm(hub: ServingHub) -> None:
    hub.graph.serve("/add", ADD, None, Server())
    client = await hub.connect(persistent="1")
    await client.leave()
    await hub.vacant()


async def test_call_without_a_response_in_time_fails() -> None:
    hub = ServingHub(service_timeout=0.001)
    await hub.start()
    hub.graph.serve("/add", ADD, None, Server())
    client = await hub.connect()
    is_ok, text = await client.call(REQUEST)
    assert not is_ok
    assert b"/add" in text
    await hub.close()


async def test_calls_end_with_the_right_to_them(start_hub: StartHub, tmp_path: Path) -> None:
    path = tmp_path / "tokens.toml"
    path.write_text('[ros1]\nallow.call = ["/add", "/other"]\n', "utf-8")
    TokenFile(path).add("admin", Rights({}))
    hub = await start_hub(ros1=0, tokens=path)
    assert hub.ros1 is not None
    server = Server()
    hub.graph.rights.internal.add(server.node)
    clients, services = [], []
    for name in ("/add", "/other"):
        services.append(hub.graph.serve(name, ADD, None, server))
        port = urlsplit(hub.ros1.uri).port
        assert port is not None
        client, _ = await FakeClient.connect(port, service=name)
        client.send(REQUEST)
        clients.append((client, await server.calls.get()))
    path.write_text(path.read_text("utf-8").replace('"/add", ', ""), "utf-8")
    await reloaded(hub)
    (add_client, call), (other_client, other_call) = clients
    is_ok, text = await add_client.answer()
    assert (is_ok, b"the call was ended" in text) == (False, True)
    assert await server.cancelled.get() is call
    other_call.respond({"sum": 2**62 - 1})
    assert await other_client.answer() == (True, SUM)
    for client, _ in clients:
        await client.leave()
    for service in services:
        hub.graph.remove_service(service)


async def test_connection_ends_when_the_service_has_left(hub: ServingHub) -> None:
    service = hub.graph.serve("/add", ADD, None, Server(add))
    client = await hub.connect(persistent="1")
    assert await client.call(REQUEST) == (True, SUM)
    hub.graph.remove_service(service)
    client.send(REQUEST)
    assert await client.ends()


async def test_connection_ends_when_the_service_has_another_type(hub: ServingHub) -> None:
    hub.graph.serve("/add", ADD, None, Server(add))
    client = await hub.connect(persistent="1")
    assert await client.call(REQUEST) == (True, SUM)
    hub.graph.serve("/add", "std_srvs/Trigger", None, Server())
    client.send(REQUEST)
    assert await client.ends()


async def test_connection_header_reaches_the_server(hub: ServingHub) -> None:
    server = Server()
    hub.graph.serve("/add", ADD, None, server)
    client = await hub.connect(session="7")
    client.send(REQUEST)
    assert (await server.calls.get()).caller == "/caller"
    assert server.headers[0] is not None
    assert server.headers[0]["session"] == "7"


async def test_infinity_and_nan_reach_the_client(hub: ServingHub) -> None:
    text = "---\nfloat64[] values\nuint8[] raw\n"
    values = {"values": [float("inf"), float("-inf"), None], "raw": "AP8B"}
    hub.graph.serve("/read", "maths/Read", text, Server(lambda call: call.respond(values)))
    client = await hub.connect(service="/read")
    is_ok, body = await client.call(b"")
    assert is_ok
    count, *floats = struct.unpack_from("<Iddd", body)
    assert (count, floats[:2]) == (3, [float("inf"), float("-inf")])
    assert floats[2] != floats[2]
    assert body.endswith(b"\x03\x00\x00\x00\x00\xff\x01")


async def test_large_request_and_response_are_exact(hub: ServingHub) -> None:
    text = "uint8[] data\nint64[] numbers\n---\nuint8[] data\nint64[] numbers\n"
    hub.graph.serve(
        "/echo", "maths/Echo", text, Server(lambda call: call.respond(call.request.values()))
    )
    numbers = [2**63 - 1, -(2**63)] * 5_000
    data = bytes(range(256)) * 1000
    body = struct.pack("<I", len(data)) + data + struct.pack("<I10000q", 10_000, *numbers)
    client = await hub.connect(service="/echo")
    assert await client.call(body) == (True, body)


class RightsByName(AllowAll):
    """A policy for which the rights of all nodes differ."""

    allows_all = False

    def may(self, node: str, right: str, name: str) -> bool:
        return (node, right, name) in {
            ("/ros1_node", "call", "/add"),
            ("ros1", "call", "/public"),
            ("/operator", "call", "/secret"),
        }


async def test_rights_are_those_of_the_calling_node() -> None:
    hub = ServingHub(RightsByName())
    await hub.start()
    hub.graph.rights.internal.add("/provider")
    for name in ("/add", "/public", "/secret"):
        hub.graph.serve(name, ADD, None, Server(add))
    new_node(hub.nodes, "/ros1_node")
    client = await hub.connect(callerid="/ros1_node")
    assert await client.call(REQUEST) == (True, SUM)
    assert "is not a provider" in await hub.refusal(callerid="/ros1_node", service="/secret")
    # Others have the rights of all ROS 1 programs, even with the name of a node with more rights.
    for name in ("/stranger", "/operator", "/provider"):
        client = await hub.connect(callerid=name, service="/public")
        assert await client.call(REQUEST) == (True, SUM)
        assert "is not a provider" in await hub.refusal(callerid=name, service="/secret")
    await hub.close()


async def test_request_over_the_limit_ends_the_connection() -> None:
    hub = ServingHub(max_message_size=100)
    await hub.start()
    hub.graph.serve("/add", ADD, None, Server(add))
    client = await hub.connect(persistent="1")
    client.send(bytes(101))
    assert await client.ends()
    await hub.close()


async def test_request_in_pieces_is_put_together(hub: ServingHub) -> None:
    hub.graph.serve("/add", ADD, None, Server(add))
    client = await hub.connect(persistent="1")
    data = struct.pack("<I", len(REQUEST)) + REQUEST
    for byte in data * 2:
        client.write(bytes([byte]))
        await asyncio.sleep(0)
    assert await client.answer() == (True, SUM)
    assert await client.answer() == (True, SUM)
