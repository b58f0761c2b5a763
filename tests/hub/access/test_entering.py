"""Clients that enter a hub with authentication: with a token, without one, and with a wrong one."""

from __future__ import annotations

import asyncio
import json
import logging
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from pathlib import Path
from typing import Any

import pytest
from conftest import StartHub
from hub_reload import reloaded
from patience import PATIENCE
from websockets.asyncio.client import ClientConnection, connect
from websockets.exceptions import ConnectionClosed
from websockets.typing import Subprotocol

from fibws.access.token_file import digest_of
from fibws.hub.rosbridge.session import MAX_OBJECTS
from fibws.hub.server import HubServer
from fibws.protocol.serialized import SUBPROTOCOL

INT32 = "std_msgs/Int32"
FILE = f"""\
[tokens.ann]
sha256 = "{digest_of("one")}"
allow = {{publish = ["/a", "/ann/**"], subscribe = ["/**"], provide = ["/add"], node = ["/ann*"]}}

[tokens.bob]
sha256 = "{digest_of("two")}"
allow = {{publish = ["/b"]}}
"""
ANONYMOUS = '[anonymous]\nallow = {subscribe = ["/a"]}\n'


class Hubs:
    """Starts hubs with a file of tokens, which tests may change."""

    def __init__(self, start: StartHub, path: Path) -> None:
        self._start = start
        self.path = path

    async def __call__(self, text: str = FILE, **settings: Any) -> HubServer:
        self.path.write_text(text, "utf-8")
        return await self._start(tokens=self.path, **settings)


@pytest.fixture
def start(start_hub: StartHub, tmp_path: Path) -> Hubs:
    return Hubs(start_hub, tmp_path / "tokens.toml")


@asynccontextmanager
async def entered(
    hub: HubServer, path: str = "", **options: Any
) -> AsyncIterator[ClientConnection]:
    async with asyncio.timeout(PATIENCE), connect(f"{hub.url}/{path}", **options) as client:
        yield client


def bearer(token: str) -> dict[str, Any]:
    return {"additional_headers": {"Authorization": f"Bearer {token}"}}


async def call(client: ClientConnection, service: str, **args: Any) -> Any:
    """Return a response's values; other operations that come before are dropped."""
    operation = {"op": "call_service", "service": service, "args": args, "id": "call"}
    await client.send(json.dumps(operation))
    while True:
        received = json.loads(await client.recv())
        if received.get("id") == "call" and received["op"] == "service_response":
            return received["values"]


async def nodes(client: ClientConnection) -> list[str]:
    found: list[str] = (await call(client, "/rosapi/nodes"))["nodes"]
    return found


async def closing(client: ClientConnection) -> tuple[int, str]:
    """Return the code and the reason with which the hub closes."""
    try:
        while True:
            await client.recv()
    except ConnectionClosed as closed:
        assert closed.rcvd is not None
        return closed.rcvd.code, closed.rcvd.reason


async def statuses(client: ClientConnection, operation: dict[str, Any]) -> list[dict[str, Any]]:
    """Send an operation and return the statuses that it gets."""
    await client.send(json.dumps(operation))
    await client.send(json.dumps({"op": "call_service", "service": "/rosapi/get_time", "id": "t"}))
    found = []
    while (received := json.loads(await client.recv())).get("id") != "t":
        found.append(received)
    return found


WAYS: list[tuple[str, dict[str, Any]]] = [
    ("?node=/ann_1", bearer("one")),
    ("?node=/ann_1&token=one", {}),
    ("?node=/ann_1", {"subprotocols": [Subprotocol("fibws.token.one")]}),
    ("?node=/ann_1", {"subprotocols": [Subprotocol(SUBPROTOCOL), Subprotocol("fibws.token.one")]}),
]


@pytest.mark.parametrize(
    ("path", "options"), WAYS, ids=["header", "query", "subprotocol", "subprotocols"]
)
async def test_client_enters_with_a_token(
    start: Hubs, path: str, options: dict[str, Any], caplog: pytest.LogCaptureFixture
) -> None:
    caplog.set_level(logging.DEBUG, "fibws")
    hub = await start()
    async with entered(hub, path, **options) as client:
        assert "/ann_1" in await nodes(client)
        offered = options.get("subprotocols")
        assert client.subprotocol == (offered[0] if offered else None)
    assert "ann" in caplog.text
    assert "token=one" not in caplog.text
    assert "Bearer" not in caplog.text


async def test_client_enters_by_the_operation_auth(start: Hubs) -> None:
    hub = await start()
    async with entered(hub, "?node=/ann_1") as client:
        (refusal,) = [json.loads(await ask(client, {"op": "subscribe", "topic": "/a", "id": 7}))]
        assert (refusal["op"], refusal["level"], refusal["id"]) == ("status", "error", 7)
        assert "/ann_1" not in hub.graph.nodes
        await client.send('{"op": "auth", "token": "one"}{"op": "set_level", "level": "info"}')
        assert "/ann_1" in await nodes(client)
        (status,) = await statuses(client, {"op": "auth", "token": "one", "id": 8})
        assert (status["level"], status["id"]) == ("info", 8)
        assert "ann" in status["msg"]


async def test_text_with_a_login_holds_no_more_operations_than_others(start: Hubs) -> None:
    hub = await start()
    for options in ({}, bearer("one")):
        async with entered(hub, **options) as client:
            await client.send(
                '{"op": "auth", "token": "one"}' + '{"op": "fly"}' * (MAX_OBJECTS - 1)
            )
            assert len(await statuses(client, {"op": "fly", "id": "last"})) >= MAX_OBJECTS
        async with entered(hub, **options) as client:
            await client.send('{"op": "auth", "token": "one"}' + '{"op": "fly"}' * MAX_OBJECTS)
            found = await statuses(client, {"op": "set_level", "level": "error"})
            assert len(found) == MAX_OBJECTS
            assert f"at most {MAX_OBJECTS} operations" in found[-1]["msg"]


async def test_login_after_too_many_operations_in_one_text_is_ignored(start: Hubs) -> None:
    hub = await start()
    async with entered(hub, "?node=/ann_1") as client:
        await client.send('{"op": "subscribe"}' * 200 + '{"op": "auth", "token": "one"}')
        assert await closing(client) == (4401, "missing token")
    assert "/ann_1" not in hub.graph.nodes


async def ask(client: ClientConnection, operation: dict[str, Any]) -> str | bytes:
    await client.send(json.dumps(operation))
    return await client.recv()


@pytest.mark.parametrize("more", ["", ANONYMOUS])
async def test_client_with_a_wrong_token_is_closed(start: Hubs, more: str) -> None:
    hub = await start(FILE + more)
    async with entered(hub, "?node=/ann_1", **bearer("three")) as client:
        code, reason = await closing(client)
    assert code == 4401
    assert "unknown token" in reason
    assert "/ann_1" not in hub.graph.nodes


async def test_client_with_a_wrong_token_in_auth_is_closed(start: Hubs) -> None:
    hub = await start()
    async with entered(hub) as client:
        await client.send('{"op": "auth", "token": "three"}')
        assert (await closing(client))[0] == 4401


async def test_client_that_sends_no_token_in_time_is_closed(start: Hubs) -> None:
    hub = await start(auth_timeout=0.01)
    async with entered(hub) as client:
        assert await closing(client) == (4401, "missing token")


async def test_operations_without_a_token_are_bounded(start: Hubs) -> None:
    hub = await start()
    async with entered(hub) as client:
        for _ in range(200):
            await client.send('{"op": "subscribe", "topic": "/a"}')
        assert await closing(client) == (4401, "missing token")


@pytest.mark.parametrize("data", ["nonsense", "[]", "{}", b"\x80abc", '{"op": "auth"}', "{" * 9999])
async def test_malformed_operation_without_a_token_does_not_harm(
    start: Hubs, data: str | bytes
) -> None:
    hub = await start()
    async with entered(hub) as client, entered(hub, **bearer("one")) as other:
        await client.send(data)
        try:
            assert json.loads(await client.recv())["level"] == "error"
        except ConnectionClosed as closed:
            assert closed.rcvd is not None
            assert closed.rcvd.code == 4401
        assert await nodes(other)


async def test_anonymous_clients_have_their_own_rights(start: Hubs) -> None:
    hub = await start(FILE + ANONYMOUS)
    async with entered(hub) as client:
        assert await statuses(client, {"op": "subscribe", "topic": "/a", "type": INT32}) == []
        (status,) = await statuses(client, {"op": "advertise", "topic": "/b", "type": INT32})
        assert "missing right publish for /b" in status["msg"]
        # The rights of bob replace those: he may not subscribe.
        (status,) = await statuses(client, {"op": "auth", "token": "two"})
        assert "missing right subscribe for /a" in status["msg"]
        assert "/a" not in hub.graph.topics
        assert await statuses(client, {"op": "advertise", "topic": "/b", "type": INT32}) == []


async def test_wrong_token_of_a_client_that_has_entered_changes_nothing(start: Hubs) -> None:
    hub = await start()
    async with entered(hub, **bearer("two")) as client:
        (status,) = await statuses(client, {"op": "auth", "token": "three"})
        assert "unknown token" in status["msg"]
        assert await statuses(client, {"op": "advertise", "topic": "/b", "type": INT32}) == []


async def test_guessing_is_slowed(start: Hubs) -> None:
    hub = await start()
    codes = []
    for number in range(25):
        async with entered(hub, f"?token=guess{number}") as client:
            codes.append((await closing(client))[0])
    assert codes[:20] == [4401] * 20
    assert codes[-1] == 4429


# Names.


async def test_forbidden_name_is_refused(start: Hubs) -> None:
    hub = await start()
    async with entered(hub, "?node=/bob", **bearer("one")) as client:
        code, reason = await closing(client)
    assert code == 4403
    assert reason == "missing right node for /bob"


async def test_name_of_a_living_node_is_not_taken_by_another_principal(start: Hubs) -> None:
    hub = await start()
    async with entered(hub, "?node=/ann_1", **bearer("one")) as victim:
        assert "/ann_1" in await nodes(victim)
        async with entered(hub, "?node=/ann_1", **bearer("two")) as thief:
            assert (await closing(thief))[0] == 4403
        assert "/ann_1" in await nodes(victim)
        async with entered(hub, "?node=/ann_1", **bearer("one")) as newer:
            assert (await closing(victim))[0] == 4001
            assert "/ann_1" in await nodes(newer)


# Reload and expiry.


async def test_revoked_token_ends_its_clients(start: Hubs) -> None:
    hub = await start()
    async with entered(hub, **bearer("one")) as ann, entered(hub, **bearer("two")) as bob:
        assert await nodes(ann)
        assert await nodes(bob)
        start.path.write_text(
            FILE.replace("tokens.ann", "tokens.eve").replace(digest_of("one"), digest_of("x"))
        )
        reloaded = asyncio.get_running_loop().create_future()
        assert hub.reload(reloaded.set_result) == ["token ann revoked", "token eve added"]
        changes = await asyncio.wait_for(reloaded, PATIENCE)
        assert changes == ["token ann revoked", "token eve added", "1 client closed"]
        assert (await closing(ann))[0] == 4401
        assert await nodes(bob)


async def test_reload_without_a_change_says_so(start: Hubs) -> None:
    hub = await start()
    async with entered(hub, **bearer("one")) as ann:
        assert hub.reload() == []
        assert hub._files == [start.path]
        assert await nodes(ann)


async def test_reload_takes_back_what_is_no_longer_allowed(start: Hubs) -> None:
    hub = await start()
    async with entered(hub, "?node=/ann_1", **bearer("one")) as ann:
        for operation in (
            {"op": "advertise", "topic": "/a", "type": INT32},
            {"op": "advertise", "topic": "/ann/x", "type": INT32},
            {"op": "subscribe", "topic": "/c"},
            {"op": "advertise_service", "service": "/add", "type": "rospy_tutorials/AddTwoInts"},
        ):
            assert await statuses(ann, operation) == []
        ann_only = f'[tokens.ann]\nsha256 = "{digest_of("one")}"\nallow = '
        start.path.write_text(ann_only + '{publish = ["/ann/**"], node = ["/ann*"]}')
        await reloaded(hub)
        texts = [json.loads(await ann.recv())["msg"] for _ in range(3)]
        for fact in ("publish for /a", "subscribe for /c", "provide for /add"):
            assert any(fact in text for text in texts)
        assert "/ann/x" in hub.graph.topics
        assert not {"/a", "/c"} & hub.graph.topics.keys()
        assert "/add" not in hub.graph.services
        assert await statuses(ann, {"op": "publish", "topic": "/ann/x", "msg": {"data": 1}}) == []
        start.path.write_text(
            f'[tokens.ann]\nsha256 = "{digest_of("one")}"\nallow = {{node = ["/x"]}}'
        )
        await reloaded(hub)
        assert (await closing(ann))[0] == 4403


async def test_reload_under_traffic_loses_nothing(start: Hubs) -> None:
    hub = await start()
    async with entered(hub, **bearer("one")) as ann, entered(hub, **bearer("two")) as bob:
        assert await statuses(ann, {"op": "subscribe", "topic": "/b", "type": INT32}) == []
        assert await statuses(bob, {"op": "advertise", "topic": "/b", "type": INT32}) == []
        for number in range(300):
            await bob.send(json.dumps({"op": "publish", "topic": "/b", "msg": {"data": number}}))
            if number % 10 == 0:  # Each time another one may enter, and one may not any more.
                start.path.write_text(
                    f'{FILE}[tokens.n{number}]\nsha256 = "{digest_of(str(number))}"'
                )
                await reloaded(hub)
        received = [json.loads(await ann.recv())["msg"]["data"] for _ in range(300)]
        assert received == [*range(300)]


async def test_failed_reload_changes_nothing(start: Hubs) -> None:
    hub = await start()
    async with entered(hub, **bearer("one")) as ann:
        assert await nodes(ann)
        start.path.write_text("[tokens")
        with pytest.raises(ValueError, match=r"tokens\.toml"):
            await reloaded(hub)
        assert await nodes(ann)
    async with entered(hub, **bearer("two")) as bob:
        assert await nodes(bob)


async def test_client_is_closed_when_its_token_expires(
    start: Hubs, monkeypatch: pytest.MonkeyPatch
) -> None:
    hub = await start(FILE.replace('allow = {publish = ["/b"]}', "expires = 2099-01-01"))
    async with entered(hub, **bearer("two")) as bob:
        assert await nodes(bob)
        (connection,) = hub._connections
        object.__setattr__(connection._shared, "now", lambda: 5e9)
        assert await closing(bob) == (4401, "the token expired")
