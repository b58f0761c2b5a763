"""What ROS 1 nodes may not see looks absent: each method of the master has the same answer."""

from __future__ import annotations

import asyncio
import re
from collections.abc import AsyncIterator, Callable
from contextlib import AsyncExitStack, asynccontextmanager
from itertools import product
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit

import pytest
from conftest import StartHub
from hub_reload import reloaded

import fibws
from fibws.access.rights import Rights
from fibws.access.token_file import TokenFile
from fibws.hub.server import HubServer
from fibws.msg.rosgraph_msgs import Log
from fibws.msg.std_msgs import Int32
from fibws.srv.example_interfaces import AddTwoInts

from .peer import Peer, header

FILE = """\
[ros1]
allow.publish = ["/open/**", "/half/out"]
allow.subscribe = ["/open/**", "/half/in"]
allow.call = ["/open/**"]
allow.param_read = ["/open", "/open/a", "/param"]
allow.node = ["/ros1/**"]
"""
NAMES = (
    *("/hid/arm", "/hid/topic", "/hid/cmd", "/hid/srv", "/hid/param", "/hid", "/open", "/"),
    *("/open/secret", "/half/in", "/half/out", "/ros1/param", "param"),
)
METHODS = {
    "getSystemState": 0,
    "getTopicTypes": 0,
    "getParamNames": 0,
    "getPublishedTopics": 1,
    "lookupNode": 1,
    "lookupService": 1,
    "getParam": 1,
    "hasParam": 1,
    "searchParam": 1,
    "setParam": 2,
    "deleteParam": 1,
    "getPublications": 0,
    "getSubscriptions": 0,
    "getBusInfo": 0,
    "getBusStats": 0,
}
"""Methods of the master and of the hub as a node, with the number of their arguments."""


@asynccontextmanager
async def peer_of(start_hub: StartHub, path: Path, *, is_there: bool) -> AsyncIterator[Peer]:
    """Return a ROS 1 node at a hub on which the hidden node is, or is not."""
    hub = await start_hub(ros1=0, tokens=path)
    assert hub.ros1 is not None
    hub.graph.parameters.set("/param", 1)
    async with AsyncExitStack() as stack:
        if is_there:
            await stack.enter_async_context(hidden_node(hub, path))
        yield await stack.enter_async_context(Peer("/ros1/peer", hub.ros1.uri))


@asynccontextmanager
async def hidden_node(hub: HubServer, path: Path) -> AsyncIterator[None]:
    """Add a node of another principal, and what it uses."""
    token = TokenFile(path).add("owner", Rights(admin=True))
    await reloaded(hub)
    async with fibws.Node("arm", namespace="/hid", hub=hub.url, token=token) as node:
        await node.advertise("topic", Int32, latch=True)
        node.subscribe("cmd", Int32)
        node.subscribe("/rosout", Log)
        await node.service("srv", AddTwoInts, lambda request: {"sum": 0})
        for parameter in ("/hid/param", "/open/secret", "/ros1/param"):
            hub.graph.set_parameter("/hid/arm", parameter, 5)
        yield


def plain(answer: object, peer: Peer) -> str:
    """Return an answer without what differs from hub to hub: ports and the run."""
    text = str(answer).replace(peer.master, "MASTER").replace(peer.api, "PEER")
    return re.sub(r"[0-9a-f-]{36}|(?<=_)\d{4,5}|\b\d{4,5}\b", "", text)


async def check_alike(
    start_hub: StartHub, path: Path, ask: Callable[[Peer], Any]
) -> list[tuple[object, str]]:
    """Check that some questions have the same answers if names are hidden and if absent."""
    answers = []
    for is_there in (True, False):
        async with peer_of(start_hub, path, is_there=is_there) as peer:
            answers.append([(what, plain(answer, peer)) async for what, answer in ask(peer)])
    hidden, absent = answers
    assert hidden == absent
    return hidden


@pytest.fixture
def path(tmp_path: Path) -> Path:
    path = tmp_path / "tokens.toml"
    path.write_text(FILE, "utf-8")
    return path


async def test_methods_of_the_master(start_hub: StartHub, path: Path) -> None:
    async def ask(peer: Peer) -> AsyncIterator[tuple[object, object]]:
        for method, arguments in METHODS.items():
            for names in product(NAMES, repeat=min(arguments, 1)):
                values = (*names, *([7] if arguments == 2 else []))
                yield (method, values), await peer.ask(method, *values)

    answers = await check_alike(start_hub, path, ask)
    assert len(answers) > 90
    assert any("/rosout" in answer for _, answer in answers)


@pytest.mark.parametrize("type_", ["*", "std_msgs/Int32", "std_msgs/String"])
async def test_registrations_of_topics(start_hub: StartHub, path: Path, type_: str) -> None:
    async def ask(peer: Peer) -> AsyncIterator[tuple[object, object]]:
        for method in ("registerSubscriber", "registerPublisher"):
            for name in ("/hid/topic", "/hid/cmd", "/rosout", "/open/t"):
                yield (method, name), await peer.ask(method, name, type_, peer.api)
                for listing in ("getSystemState", "getTopicTypes", "getPublishedTopics"):
                    arguments = [""] if listing == "getPublishedTopics" else []
                    yield (method, name, listing), await peer.ask(listing, *arguments)

    await check_alike(start_hub, path, ask)


async def test_connections(start_hub: StartHub, path: Path) -> None:
    async def ask(peer: Peer) -> AsyncIterator[tuple[object, object]]:
        for key in ("topic", "service"):
            for name in ("/hid/topic", "/hid/cmd", "/hid/srv"):
                fields = {"callerid": peer.name, key: name, "md5sum": "*", "type": "std_msgs/Int32"}
                yield (key, name), await _refusal(urlsplit(peer.master).port, header(fields))

    await check_alike(start_hub, path, ask)


async def _refusal(port: int | None, data: bytes) -> bytes:
    reader, writer = await asyncio.open_connection("127.0.0.1", port)
    writer.write(data)
    async with asyncio.timeout(60):
        answer = await reader.read()
    writer.close()
    return answer
