"""Services across both worlds, with a program that speaks rmw_zenoh's layout."""

from __future__ import annotations

import asyncio
import struct
from collections.abc import Callable

import pytest
import zenoh
from patience import PATIENCE

import fibws
from fibws.errors import ServiceError
from fibws.hub.server import HubServer
from fibws.srv.example_interfaces import AddTwoInts

from ..federation.conftest import until
from .conftest import StartPeer, StartRos2Hub
from .peer import ADD, ADD_HASH, Peer, read_attachment
from .test_topics import tokens_of, until_tokens

HEAD = b"\x00\x01\x00\x00"


def request(a: int, b: int) -> bytes:
    return HEAD + struct.pack("<qq", a, b)


def adder(key: str, **options: bool) -> Callable[[zenoh.Query], None]:
    """Return what answers as a server of rmw_zenoh does."""

    def answer(query: zenoh.Query) -> None:
        assert query.payload is not None
        assert query.attachment is not None
        data = query.payload.to_bytes()
        assert data[:4] == HEAD
        a, b = struct.unpack_from("<qq", data, 4)
        read_attachment(query.attachment.to_bytes())
        query.reply(key, HEAD + struct.pack("<q", a + b), attachment=query.attachment)
        query.drop()  # type: ignore[no-untyped-call]

    return answer


def has_service(hub: HubServer, name: str) -> bool:
    return name in hub.graph.services


async def test_nodes_call_services_of_ros_2(hub: HubServer, peer: Peer, node: fibws.Node) -> None:
    server = await peer.server("/adder", "/add", adder(peer.key("/add", ADD, ADD_HASH)))
    await until(lambda: has_service(hub, "/add"), hub)
    assert hub.graph.services["/add"].node == "/adder"
    for number in range(3):
        response = await node.call("/add", AddTwoInts, {"a": 40, "b": number}, timeout=PATIENCE)
        assert response.sum == 40 + number
    await server.close()
    await until(lambda: not has_service(hub, "/add"), hub)


async def test_caller_is_shown_to_ros_2_as_a_client(
    hub: HubServer, peer: Peer, node: fibws.Node
) -> None:
    tokens, changed = await tokens_of(peer, hub)
    await peer.server("/adder", "/add", adder(peer.key("/add", ADD, ADD_HASH)))
    await until(lambda: has_service(hub, "/add"), hub)
    await node.call("/add", AddTwoInts, {"a": 1, "b": 2}, timeout=PATIENCE)
    start = f"SC/%/%/ours/%add/{ADD}/{ADD_HASH}/"
    await until_tokens(changed, lambda: any(token.startswith(start) for token in tokens))


async def test_error_of_a_ros_2_service_is_that_of_the_call(
    hub: HubServer, peer: Peer, node: fibws.Node
) -> None:
    def answer(query: zenoh.Query) -> None:
        query.reply_err(b"no sums today")
        query.drop()  # type: ignore[no-untyped-call]

    await peer.server("/adder", "/add", answer)
    await until(lambda: has_service(hub, "/add"), hub)
    with pytest.raises(ServiceError, match="no sums today"):
        await node.call("/add", AddTwoInts, {"a": 1}, timeout=PATIENCE)


@pytest.mark.parametrize(
    ("data", "attachment"),
    [
        (HEAD + bytes(7), bytes(16) + b"\x10" + bytes(16)),
        (b"", bytes(16) + b"\x10" + bytes(16)),
        (HEAD + bytes(8), b"short"),
    ],
)
async def test_invalid_response_of_ros_2_fails_the_call(
    hub: HubServer, peer: Peer, node: fibws.Node, data: bytes, attachment: bytes
) -> None:
    def answer(query: zenoh.Query) -> None:
        query.reply(peer.key("/add", ADD, ADD_HASH), data, attachment=attachment)
        query.drop()  # type: ignore[no-untyped-call]

    await peer.server("/adder", "/add", answer)
    await until(lambda: has_service(hub, "/add"), hub)
    with pytest.raises(ServiceError, match="invalid"):
        await node.call("/add", AddTwoInts, {"a": 1}, timeout=PATIENCE)


async def test_call_fails_when_the_ros_2_server_leaves(
    hub: HubServer, start_peer: StartPeer, node: fibws.Node
) -> None:
    peer = await start_peer()
    asked = asyncio.Event()
    loop = asyncio.get_running_loop()
    queries: list[zenoh.Query] = []

    def answer(query: zenoh.Query) -> None:
        queries.append(query)
        loop.call_soon_threadsafe(asked.set)

    server = await peer.server("/adder", "/add", answer)
    await until(lambda: has_service(hub, "/add"), hub)
    call = asyncio.create_task(node.call("/add", AddTwoInts, {"a": 1}, timeout=PATIENCE))
    async with asyncio.timeout(PATIENCE):
        await asked.wait()
    await server.close()
    with pytest.raises(ServiceError, match=r"has left|did not answer"):
        await call
    queries.clear()


async def test_call_ends_after_the_time_that_the_caller_gives(
    hub: HubServer, peer: Peer, node: fibws.Node
) -> None:
    queries: list[zenoh.Query] = []
    await peer.server("/adder", "/add", queries.append)
    await until(lambda: has_service(hub, "/add"), hub)
    with pytest.raises(ServiceError):
        await node.call("/add", AddTwoInts, {"a": 1}, timeout=0.05)
    queries.clear()


async def test_ros_2_clients_call_services_of_the_hub(
    hub: HubServer, peer: Peer, node: fibws.Node
) -> None:
    tokens, changed = await tokens_of(peer, hub)

    def add(request: AddTwoInts.Request) -> AddTwoInts.Response:
        return AddTwoInts.Response(sum=request.a + request.b)

    await node.service("/add", AddTwoInts, add)
    start = f"SS/%/%/ours/%add/{ADD}/{ADD_HASH}/"
    await until_tokens(changed, lambda: any(token.startswith(start) for token in tokens))
    client = await peer.declare("SC", "/client", "/add", ADD, ADD_HASH)
    await until(lambda: "/client" in hub.graph.nodes, hub)
    attachment = client.attachment()
    reply = await peer.call("/add", request(40, 2), attachment)
    assert reply is not None
    assert reply.ok is not None
    assert reply.ok.attachment is not None
    assert reply.ok.payload.to_bytes() == HEAD + struct.pack("<q", 42)
    sequence, stamp, gid = read_attachment(reply.ok.attachment.to_bytes())
    assert (sequence, gid) == (1, client.gid)
    assert stamp > 1_700_000_000_000_000_000


@pytest.mark.parametrize(
    ("data", "attachment", "fault"),
    [
        (request(1, 2), None, "attachment"),
        (request(1, 2), b"short", "attachment"),
        (request(1, 2), bytes(77), "0.2.4"),
        (request(1, 2)[:-1], bytes(16) + b"\x10" + bytes(16), "invalid CDR"),
        (None, bytes(16) + b"\x10" + bytes(16), "invalid CDR"),
    ],
)
async def test_invalid_request_gets_an_error_and_does_no_harm(
    hub: HubServer,
    peer: Peer,
    node: fibws.Node,
    data: bytes | None,
    attachment: bytes | None,
    fault: str,
) -> None:
    tokens, changed = await tokens_of(peer, hub)
    await node.service("/add", AddTwoInts, lambda request: AddTwoInts.Response(sum=request.a))
    await until_tokens(changed, lambda: any("%add/" in token for token in tokens))
    reply = await peer.call("/add", data, attachment)
    assert reply is not None
    assert reply.err is not None
    assert fault in reply.err.payload.to_string()
    reply = await peer.call("/add", request(1, 2), bytes(16) + b"\x10" + bytes(16))
    assert reply is not None
    assert reply.ok is not None


async def test_service_that_fails_or_is_too_slow_gives_ros_2_an_error(
    start_ros2_hub: StartRos2Hub,
) -> None:
    hub, endpoint = await start_ros2_hub(service_timeout=0.05)

    async def add(request: AddTwoInts.Request) -> AddTwoInts.Response:
        if request.a:
            raise ValueError("out of numbers")
        await asyncio.Event().wait()
        raise AssertionError

    async with Peer(endpoint) as peer, fibws.Node("ours", hub=hub.url) as node:
        tokens, changed = await tokens_of(peer, hub)
        await node.service("/add", AddTwoInts, add)
        await until_tokens(changed, lambda: any("%add/" in token for token in tokens))
        attachment = bytes(16) + b"\x10" + bytes(16)
        for a, fault in ((1, "out of numbers"), (0, "did not answer")):
            reply = await peer.call("/add", request(a, 0), attachment)
            assert reply is not None
            assert reply.err is not None
            assert fault in reply.err.payload.to_string()


async def test_service_with_other_fields_is_not_attached(
    hub: HubServer, peer: Peer, caplog: pytest.LogCaptureFixture
) -> None:
    wrong = f"RIHS01_{'0' * 64}"
    await peer.server("/adder", "/add", lambda query: None, type_hash=wrong)
    await peer.server("/adder", "/other", lambda query: None)
    await until(lambda: has_service(hub, "/other"), hub)
    assert not has_service(hub, "/add")
    assert "/adder cannot serve /add here" in caplog.text


async def test_newer_server_of_the_hub_is_called_until_it_leaves(
    hub: HubServer, peer: Peer, node: fibws.Node
) -> None:
    await peer.server("/adder", "/add", adder(peer.key("/add", ADD, ADD_HASH)))
    await until(lambda: has_service(hub, "/add"), hub)
    async with fibws.Node("newer", hub=hub.url) as newer:
        await newer.service("/add", AddTwoInts, lambda request: AddTwoInts.Response(sum=-1))
        assert (await node.call("/add", AddTwoInts, {"a": 1})).sum == -1
    await until(
        lambda: has_service(hub, "/add") and hub.graph.services["/add"].node == "/adder", hub
    )
    assert (await node.call("/add", AddTwoInts, {"a": 1}, timeout=PATIENCE)).sum == 1


async def test_parts_of_actions_are_left_out(hub: HubServer, peer: Peer) -> None:
    await peer.server("/robot", "/walk/_action/send_goal", lambda query: None)
    await peer.publisher("/robot", "/walk/_action/feedback")
    await peer.publisher("/robot", "/name")
    await until(lambda: "/name" in hub.graph.topics, hub)
    assert not any("_action" in name for name in (*hub.graph.topics, *hub.graph.services))
