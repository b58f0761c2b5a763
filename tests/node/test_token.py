"""Tokens of nodes: how they are sent, renewed and refused."""

from __future__ import annotations

import asyncio
import logging
import time
from collections.abc import AsyncIterator
from pathlib import Path

import jwt as web_tokens
import pytest
from client.servers import redirecting_server
from hub_reload import reloaded
from unsigned_token import unsigned
from websockets.asyncio.server import ServerConnection, serve

import fibws
from fibws import credentials
from fibws.access.rights import RIGHTS, Principal, Rights
from fibws.access.token_file import TokenFile
from fibws.hub import Settings
from fibws.hub.graph.nodes import GraphNode as GraphNode
from fibws.hub.server import HubServer
from fibws.msg.std_msgs import Int32
from fibws.node import connection

from .conftest import Lines, Peer, ScriptedHub


@pytest.fixture(autouse=True)
def impatient(monkeypatch: pytest.MonkeyPatch) -> None:
    """Nodes come back at once, so that tests need not wait."""
    monkeypatch.setattr(connection, "FIRST_RETRY", 0.001)
    monkeypatch.setattr(connection, "LONGEST_RETRY", 0.01)
    monkeypatch.setattr(connection, "LONGEST_WAIT", 0.01)


@pytest.fixture(autouse=True)
def no_variables(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("FIBWS_TOKEN", "FIBWS_TOKEN_FILE", "FIBWS_HUB"):
        monkeypatch.delenv(name, raising=False)


def token_of(peer: Peer) -> str | None:
    """Return the header that the node sent."""
    assert peer.websocket.request is not None
    return peer.websocket.request.headers.get("Authorization")


async def test_token_is_sent_in_the_header(hub: ScriptedHub) -> None:
    async with fibws.Node("talker", hub=hub.url, token="secret") as node:
        peer = await hub.peer()
        assert token_of(peer) == "Bearer secret"
        assert "secret" not in peer.path and "secret" not in repr(node) + node.hub


async def test_token_in_the_url_is_sent_in_the_header(
    hub: ScriptedHub, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("FIBWS_HUB", f"{hub.url}/?token=secret&a=b")
    async with fibws.Node("talker") as node:
        peer = await hub.peer()
        assert token_of(peer) == "Bearer secret"
        assert peer.path == "/?a=b&node=/talker"
        assert "secret" not in repr(node) + node.hub


async def test_node_without_a_token_sends_no_header(hub: ScriptedHub) -> None:
    async with fibws.Node("talker", hub=hub.url):
        assert token_of(await hub.peer()) is None


async def test_invalid_token_is_reported_at_once(hub: ScriptedHub) -> None:
    with pytest.raises(fibws.AccessError, match="the argument token"):
        fibws.Node("talker", hub=hub.url, token="two words")


async def test_token_is_not_in_debug_logs(
    hub: ScriptedHub, caplog: pytest.LogCaptureFixture
) -> None:
    caplog.set_level(logging.DEBUG)
    async with fibws.Node("talker", hub=hub.url, token="secret"):
        await hub.peer()
    sent = [record for record in caplog.records if "client" in record.name]
    assert any("Authorization" in record.getMessage() for record in sent)
    assert not any("secret" in record.getMessage() for record in sent)


@pytest.fixture
async def refusing() -> AsyncIterator[tuple[str, list[tuple[int, str]]]]:
    """A hub that closes each connection with the next code and reason; without one, it reads."""
    closes: list[tuple[int, str]] = []

    async def handle(websocket: ServerConnection) -> None:
        if closes:
            await websocket.close(*closes.pop(0))
        async for _ in websocket:
            pass

    async with serve(handle, "127.0.0.1", 0, compression=None) as server:
        yield f"ws://127.0.0.1:{server.sockets[0].getsockname()[1]}", closes


@pytest.mark.parametrize(
    ("code", "reason", "error"),
    [
        (4401, "missing token", fibws.NotAuthorized),
        (4403, "missing right node for /talker", fibws.MissingRight),
    ],
)
async def test_refused_node_cannot_be_entered(
    refusing: tuple[str, list[tuple[int, str]]],
    code: int,
    reason: str,
    error: type[fibws.AccessDenied],
) -> None:
    url, closes = refusing
    closes += [(code, reason)] * 2
    with pytest.raises(error, match=reason) as caught:
        async with fibws.Node("talker", hub=url, token="secret"):
            pytest.fail("the hub refuses the node")
    assert "secret" not in str(caught.value)
    assert len(closes) == 1, "the node tried again"


@pytest.mark.parametrize("code", [1001, 1008, 1011, 1012, 1013, 4429])
async def test_node_goes_on_after_what_passes(
    refusing: tuple[str, list[tuple[int, str]]], code: int
) -> None:
    url, closes = refusing
    closes += [(code, "too many connections of robot1")] * 3
    async with fibws.Node("talker", hub=url, token="secret"):
        assert not closes


async def test_revoked_token_ends_a_node(hub: ScriptedHub) -> None:
    async with fibws.Node("talker", hub=hub.url, token="secret") as node:
        peer = await hub.peer()
        waiting = asyncio.create_task(node.wait_for_message("numbers", Int32))
        await peer.expect("subscribe")
        await peer.websocket.close(4401, "the token was revoked")
        with pytest.raises(fibws.NotAuthorized, match="revoked"):
            await node.spin()
        with pytest.raises(fibws.NotAuthorized):
            await waiting


async def test_refused_node_goes_on_with_a_new_token_from_its_file(
    hub: ScriptedHub, tmp_path: Path
) -> None:
    file = tmp_path / "token"
    file.write_text("old\n")
    async with fibws.Node("talker", hub=hub.url, token_file=file) as node:
        peer = await hub.peer()
        assert token_of(peer) == "Bearer old"
        numbers = await node.advertise("numbers", Int32)
        file.write_text("new\n")
        await peer.websocket.close(4401, "the token expired")
        peer = await hub.peer()
        assert token_of(peer) == "Bearer new"
        await peer.expect("advertise")
        await numbers.publish(1)
        await peer.websocket.close(4401, "the token expired")
        with pytest.raises(fibws.NotAuthorized, match=r"expired.*the argument token_file"):
            await node.spin()


async def test_node_waits_while_its_file_is_being_replaced(
    hub: ScriptedHub, tmp_path: Path
) -> None:
    file = tmp_path / "token"
    file.write_text("old")
    async with fibws.Node("talker", hub=hub.url, token_file=file) as node:
        peer = await hub.peer()
        lines = Lines(node.log)
        file.unlink()
        await peer.websocket.close(1001)
        assert "trying again" in await lines.next()
        file.write_text("new")
        assert token_of(await hub.peer()) == "Bearer new"


async def test_token_is_renewed_before_it_expires(hub: ScriptedHub, tmp_path: Path) -> None:
    file = tmp_path / "token"
    first, second = unsigned("first", 1), unsigned("second", 1000)
    file.write_text(first)
    async with fibws.Node("talker", hub=hub.url, token_file=file):
        peer = await hub.peer()
        assert token_of(peer) == f"Bearer {first}"
        file.write_text(second)
        assert (await peer.expect("auth"))["token"] == second


async def test_token_is_not_sent_to_where_another_server_redirects(hub: ScriptedHub) -> None:
    with redirecting_server(f"{hub.url.replace('ws:', 'http:')}/robot/") as url:
        async with fibws.Node("talker", hub=url, token="secret") as node:
            peer = await hub.peer()
            assert token_of(peer) is None
            await peer.websocket.close(4401, "missing token")
            with pytest.raises(fibws.NotAuthorized, match="redirects"):
                await node.spin()


async def test_token_without_encryption_is_warned_about_once(
    hub: ScriptedHub, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("fibws.hub_address.is_loopback", lambda host: False)
    node = fibws.Node("talker", hub=hub.url, token="secret")
    lines = Lines(node.log)
    async with node:
        peer = await hub.peer()
        peer.websocket.transport.abort()
        await hub.peer()
    seen = lines.seen()
    assert sum("without encryption" in line for line in seen) == 1
    assert not any("secret" in line for line in seen)


@pytest.fixture
async def token_hub(tmp_path: Path) -> AsyncIterator[tuple[HubServer, TokenFile]]:
    """A real hub that wants tokens, and their file."""
    path = tmp_path / "tokens.toml"
    path.touch()
    file = TokenFile(path)
    settings = Settings(port=0, close_timeout=0.1, tokens=path)
    async with HubServer(settings) as hub:
        yield hub, file


EVERYTHING = Rights({right: ("/**",) for right in RIGHTS})


async def test_real_hub_lets_in_a_node_with_a_token(token_hub: tuple[HubServer, TokenFile]) -> None:
    hub, file = token_hub
    token = file.add("robot1", EVERYTHING)
    await reloaded(hub)
    async with fibws.Node("talker", hub=hub.url, token=token) as node:
        numbers = node.subscribe("numbers", Int32)
        await node.flush()
        await (await node.advertise("numbers", Int32)).publish(8)
        assert await anext(numbers) == Int32(8)


@pytest.mark.parametrize("token", [None, "fibws_wrong"])
@pytest.mark.parametrize("rosout", [True, False])
async def test_real_hub_refuses_a_node_without_a_valid_token(
    token_hub: tuple[HubServer, TokenFile], token: str | None, rosout: bool
) -> None:
    hub, _ = token_hub
    with pytest.raises(fibws.NotAuthorized):
        async with fibws.Node("talker", hub=hub.url, token=token, rosout=rosout) as node:
            pytest.fail(f"{node} was let in")


async def test_real_hub_refuses_a_name_of_another_principal(
    token_hub: tuple[HubServer, TokenFile],
) -> None:
    hub, file = token_hub
    first, second = file.add("first", EVERYTHING), file.add("second", EVERYTHING)
    await reloaded(hub)
    async with fibws.Node("talker", hub=hub.url, token=first) as node:
        with pytest.raises(fibws.MissingRight, match="/talker"):
            async with fibws.Node("talker", hub=hub.url, token=second):
                pytest.fail("the name is taken")
        await node.flush()


async def test_missing_right_is_named(token_hub: tuple[HubServer, TokenFile]) -> None:
    hub, file = token_hub
    token = file.add("looker", Rights({"subscribe": ("/**",)}))
    await reloaded(hub)
    async with fibws.Node("looker", hub=hub.url, token=token) as node:
        with pytest.raises(fibws.OperationRejected, match=r"publish.*/numbers") as caught:
            await node.advertise("numbers", Int32)
        assert caught.value.code == "not_allowed"


async def test_revoked_token_ends_a_node_of_a_real_hub(
    token_hub: tuple[HubServer, TokenFile],
) -> None:
    hub, file = token_hub
    token = file.add("robot1", EVERYTHING)
    await reloaded(hub)
    async with fibws.Node("talker", hub=hub.url, token=token) as node:
        file.revoke("robot1")
        await reloaded(hub)
        with pytest.raises(fibws.NotAuthorized, match="unknown token"):
            await node.spin()


async def test_web_token_is_renewed_at_a_real_hub(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    key, file = tmp_path / "key", tmp_path / "token"
    key.write_bytes(b"0123456789abcdef0123456789abcdef")

    def token(seconds: float) -> str:
        rights = {"allow": {"publish": ["/**"], "subscribe": ["/**"]}}
        claims = {"sub": "robot1", "exp": time.time() + seconds, "fibws": rights}
        return web_tokens.encode(claims, key.read_bytes(), "HS256")

    settings = Settings(port=0, close_timeout=0.1, jwt_key=key, jwt_leeway=0)
    file.write_text(token(100))
    for name in ("SHORTEST_CHECK", "LONGEST_CHECK"):  # It is renewed long before it expires.
        monkeypatch.setattr(credentials, name, 0.01)
    renewed: asyncio.Queue[float | None] = asyncio.Queue()
    async with HubServer(settings) as hub:
        authorize = hub.graph.authorize

        def report(node: GraphNode, name: str, principal: Principal) -> None:
            authorize(node, name, principal)
            renewed.put_nowait(principal.expires)

        monkeypatch.setattr(hub.graph, "authorize", report)
        async with fibws.Node("talker", hub=hub.url, token_file=file) as node:
            file.write_text(token(1000))
            expires = await asyncio.wait_for(renewed.get(), 60)
            assert expires is not None and expires > time.time() + 500
            await node.flush()
