"""The port of ROS 1: who may connect, what may be said, and that nothing harms the hub."""

from __future__ import annotations

import asyncio
import random
import socket
import struct
import xmlrpc.client
from pathlib import Path
from typing import Any

import pytest
from conftest import StartHub
from hub_reload import reloaded
from random_inputs import times

from fibws.access.rights import Rights
from fibws.access.token_file import TokenFile
from fibws.errors import HubError
from fibws.hub.graph.topic import Topic
from fibws.hub.ros1 import server as module
from fibws.hub.server import HubServer
from fibws.hub.settings import Settings

from .conftest import StartPeer
from .peer import Peer, header, request


def uri(hub: HubServer) -> str:
    assert hub.ros1 is not None
    return hub.ros1.uri


async def sent(hub: HubServer, data: bytes) -> bytes:
    """Send bytes and then the end; return what comes back."""
    assert hub.ros1 is not None
    reader, writer = await asyncio.open_connection("127.0.0.1", hub.ros1.port)
    writer.write(data)
    writer.write_eof()
    try:
        async with asyncio.timeout(60):
            return await reader.read()
    except ConnectionError:
        return b""
    finally:
        writer.close()


# Who may connect.


async def test_only_this_machine_may_connect_by_default(start_hub: StartHub) -> None:
    hub = await start_hub(ros1=0)
    assert hub.ros1 is not None
    addresses = {each.getsockname()[0] for each in hub.ros1._server.sockets}
    assert addresses == {"127.0.0.1"}


@pytest.mark.parametrize(
    ("host", "is_admitted"),
    [
        ("127.0.0.1", True),
        ("::1", True),
        ("::ffff:127.0.0.1", True),
        ("10.1.2.3", True),
        ("::ffff:10.1.2.3", True),
        ("10.2.0.1", False),
        ("fe80::1%eth0", True),
        ("fd00::1", False),
        ("", False),
    ],
)
async def test_networks_that_may_connect(start_hub: StartHub, host: str, is_admitted: bool) -> None:
    hub = await start_hub(ros1=0, ros1_allow=("10.1.0.0/16", "fe80::/10"))
    assert hub.ros1 is not None
    assert hub.ros1.admit(host) is is_admitted
    assert hub.audit.refusals["address"] == (0 if is_admitted or not host else 1)


async def test_taken_port_is_reported(start_hub: StartHub) -> None:
    with socket.create_server(("127.0.0.1", 0)) as taken:
        port = taken.getsockname()[1]
        with pytest.raises(HubError, match=rf"port {port}: address already in use; a roscore"):
            await start_hub(ros1=port)


@pytest.mark.parametrize("host", ["10.1.2.3", "::ffff:10.1.2.3"])
async def test_other_machines_may_not_end_the_hub(
    hub: HubServer, host: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    reasons: list[str] = []
    hub.stop_requested = reasons.append
    monkeypatch.setattr("fibws.hub.ros1.master.is_loopback", lambda host: False)
    assert (await request(uri(hub), "shutdown", "/tool", "enough"))[0] == -1
    assert reasons == []
    monkeypatch.undo()
    assert (await request(uri(hub), "shutdown", "/tool", "enough"))[0] == 1
    assert reasons == ["/tool: enough"]


async def test_rights_of_ros1_nodes_are_those_of_the_file_of_tokens(
    start_hub: StartHub, tmp_path: Path
) -> None:
    path = tmp_path / "tokens.toml"
    path.write_text('[ros1]\nallow.publish = ["/allowed/**"]\n')
    TokenFile(path).add("admin", Rights({}))
    hub = await start_hub(ros1=0, tokens=path)
    async with Peer("/talker", uri(hub)) as talker:
        await talker.advertise("/allowed/count")
        await talker.advertise("/other/count")
        assert "/talker" in hub.graph.topics["/allowed/count"].sources
        assert "/talker" not in hub.graph.topics["/other/count"].sources
        published = await talker.call("getPublishedTopics", "/other")
        assert published == [["/other/count", "std_msgs/Int32"]]
        assert (await talker.ask("setParam", "/x", 1))[0] == -1
        path.write_text(path.read_text().replace("/allowed/**", "/other/**"))
        detached = asyncio.Event()

        def changed(topic: Topic) -> None:
            if topic.name == "/allowed/count" and "/talker" not in topic.sources:
                detached.set()

        hub.graph.watch_topics(changed)
        await reloaded(hub)
        async with asyncio.timeout(60):
            await detached.wait()
        assert "/talker" in hub.graph.topics["/other/count"].sources
        assert hub.graph.view("/x").conflicts(hub.graph.topics["/other/count"]) == []


async def test_tokens_need_a_list_of_the_machines_beyond_this_one(tmp_path: Path) -> None:
    (tmp_path / "tokens.toml").touch()
    settings = Settings(port=0, host="0.0.0.0", ros1=0, tokens=tmp_path / "tokens.toml")
    async with HubServer(settings) as hub:
        assert hub.ros1 is not None
        assert not hub.ros1.admit("10.0.0.1")


# What may be said.


async def test_calls_and_connections_for_topics_share_the_port(
    hub: HubServer, start_peer: StartPeer
) -> None:
    peer = await start_peer("/peer")
    await peer.subscribe("/none")
    assert (await peer.ask("getPid"))[0] == 1
    link = await sent(hub, header({"topic": "/none", "md5sum": "*", "callerid": "/peer"}))
    assert b"error=" in link
    assert b"405" in await sent(hub, b"GET / HTTP/1.1\r\nHost: here\r\n\r\n")


@pytest.mark.parametrize(
    "data",
    [
        b"",
        b"P",
        b"\0\0\0\0",
        b"\xff\xff\xff\x00",
        struct.pack("<I", 2**24 - 1) + b"x" * 1000,
        struct.pack("<I", 10) + b"short",
        header({"topic": "/x"}),
        header({"service": "/x"}),
        header({"neither": "x"}),
        header({}),
        struct.pack("<II", 8, 2**32 - 1) + b"abcd",
        struct.pack("<II", 8, 4) + b"abcd",
        struct.pack("<II", 8, 4) + b"\xff=\xff=",
        b"POST / HTTP/1.1\r\n\r\n",
        b"\x16\x03\x01\x02\x00",
    ],
)
async def test_nonsense_ends_its_own_connection_alone(hub: HubServer, data: bytes) -> None:
    await sent(hub, data)
    assert (await request(uri(hub), "getPid", "/peer"))[0] == 1
    await _forgotten(hub)


async def test_texts_of_registrations_have_a_bounded_length(hub: HubServer) -> None:
    """They are kept, and logged."""
    api, type_ = "http://127.0.0.1:1/", "std_msgs/String"
    long = "x" * 2000
    for method, *arguments in (
        ("registerPublisher", "/t", type_, api + long),
        ("registerSubscriber", "/t", type_ + long, api),
        ("registerService", "/s", f"rosrpc://127.0.0.1:1/{long}", api),
        ("subscribeParam", api + long, "/p"),
    ):
        code, text, _ = await request(uri(hub), method, "/a", *arguments)
        assert code == -1
        assert text.endswith("longer than 1024 characters")
    assert "/a" not in hub.graph.nodes


async def test_answers_of_many_calls_are_limited(start_hub: StartHub) -> None:
    hub = await start_hub(ros1=0, max_parameter_bytes=10_000)
    await request(uri(hub), "setParam", "/a", "/text", "x" * 5000)
    call = {"methodName": "getParam", "params": ["/a", "/text"]}
    few = await request(uri(hub), "system.multicall", [call] * 5)
    assert [each[0][2] for each in few] == ["x" * 5000] * 5
    with pytest.raises(xmlrpc.client.Fault, match="too large"):
        await request(uri(hub), "system.multicall", [call] * 100)


@pytest.mark.parametrize("seed", range(times(0.5)))
async def test_random_bytes_harm_nobody(hub: HubServer, seed: int) -> None:
    chance = random.Random(seed)
    call = (
        b"POST / HTTP/1.1\r\nHost: h\r\nContent-Length: 90\r\n\r\n<methodCall><methodName>getPid</"
    )
    fields = header({"topic": "/x", "md5sum": "*", "callerid": "/a", "type": "*"})
    for _ in range(20):
        data = bytearray(chance.choice((call, fields)))
        for _ in range(chance.randrange(5)):
            at = chance.randrange(len(data))
            data[at : at + chance.randrange(4)] = chance.randbytes(chance.randrange(4))
        await sent(hub, bytes(data))
    assert (await request(uri(hub), "getPid", "/peer"))[0] == 1
    await _forgotten(hub)


async def test_silent_connection_is_closed(start_hub: StartHub) -> None:
    hub = await start_hub(ros1=0, open_timeout=0.01)
    assert hub.ros1 is not None
    reader, writer = await asyncio.open_connection("127.0.0.1", hub.ros1.port)
    async with asyncio.timeout(60):
        try:
            assert await reader.read() == b""
        except ConnectionError:
            pass
    writer.close()


def test_state_file_is_in_the_users_state(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("STATE_DIRECTORY", raising=False)
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path))
    assert module.default_state_file(11311) == tmp_path / "fibws" / "ros1-11311.json"
    monkeypatch.setenv("STATE_DIRECTORY", "/var/lib/fibws:/other")
    assert module.default_state_file(1) == Path("/var/lib/fibws/ros1-1.json")


async def _forgotten(hub: HubServer) -> None:
    """Wait until the hub has no connection left."""
    server: Any = hub.ros1
    async with asyncio.timeout(60):
        while server._connections:  # noqa: ASYNC110, nothing reports it
            await asyncio.sleep(0.001)
