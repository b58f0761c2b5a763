"""What web pages can send to the HTTP ports: requests that browsers make without asking the port.

A page of any site can send a GET, or a POST of a text. It cannot change the headers ``Origin`` and
``Host``, which the ports refuse if they name a stranger.
"""

from __future__ import annotations

import ast
import asyncio
import logging
import re
import socket
import xmlrpc.client
from collections.abc import AsyncIterator, Awaitable, Callable
from pathlib import Path
from typing import NamedTuple

import pytest
from conftest import StartHub

import fibws
from fibws.hub.server import HubServer
from fibws.programs import web_video_server

CALL = xmlrpc.client.dumps(("/page", "/x", "evil"), "setParam")
UPGRADE = {
    "Connection": "Upgrade",
    "Upgrade": "websocket",
    "Sec-WebSocket-Version": "13",
    "Sec-WebSocket-Key": "dGhlIHNhbXBsZSBub25jZQ==",
}


class Port(NamedTuple):
    """An HTTP port, and a request that it answers."""

    number: int
    method: str
    path: str
    body: str = ""
    headers: dict[str, str] = {}  # noqa: RUF012


async def status(port: Port, **headers: str) -> tuple[int, str]:
    """Send the port's request with more headers; return the status and the text."""
    reader, writer = await asyncio.open_connection("127.0.0.1", port.number)
    fields = {"Content-Length": str(len(port.body))} | port.headers | headers
    lines = "".join(f"{name}: {value}\r\n" for name, value in fields.items())
    head = f"{port.method} {port.path} HTTP/1.1\r\n{lines}Connection: close\r\n\r\n"
    try:
        async with asyncio.timeout(60):
            writer.write((head + port.body).encode())
            first = await reader.readline()
            body = b"" if first.split()[1] == b"101" else await reader.read()
            return int(first.split()[1]), body.decode()
    finally:
        writer.close()


@pytest.fixture
async def hub(start_hub: StartHub) -> HubServer:
    return await start_hub(ros1=0, ros1_host="robot.lab.example")


Find = Callable[[str], Awaitable[Port]]


@pytest.fixture
async def find(hub: HubServer) -> AsyncIterator[Find]:
    """Returns one of the ports by its name."""
    hub.graph.parameters.set("/video/port", 0)
    log = logging.getLogger("test.video")
    log.setLevel(logging.INFO)
    async with fibws.Node("video", hub=hub.url, log=log) as node:
        found: asyncio.Future[int] = asyncio.get_running_loop().create_future()

        class Handler(logging.Handler):
            def emit(self, record: logging.LogRecord) -> None:
                if "Waiting for" in (text := record.getMessage()):
                    found.set_result(int(re.findall(r"\d+", text)[-1]))

        log.addHandler(handler := Handler())
        server = asyncio.create_task(web_video_server.serve(node))
        video = await found
        log.removeHandler(handler)
        assert hub.ros1 is not None
        ports = {
            "websocket": Port(hub.port, "GET", "/", headers=UPGRADE),
            "metrics": Port(hub.port, "GET", "/metrics"),
            "ros1": Port(hub.ros1.port, "POST", "/", CALL),
            "video": Port(video, "GET", "/"),
        }

        async def find(name: str) -> Port:
            return ports[name]

        yield find
        server.cancel()
        await asyncio.wait({server})


HOSTNAME = socket.gethostname().lower()
HERE = {"Host": "localhost:1"}
PAGE = {"Host": "localhost:1", "Origin": "http://localhost:1"}
STRANGER = {"Host": "localhost:1", "Origin": "https://evil.example"}
FILE = {"Host": "localhost:1", "Origin": "null"}
REBOUND = {"Host": "evil.example:1", "Origin": "http://evil.example:1"}


@pytest.mark.parametrize(
    ("headers", "allowed"),
    [
        (HERE, "websocket metrics ros1 video"),
        ({"Host": "10.1.2.3:1"}, "websocket metrics ros1 video"),
        ({"Host": "[fd00::1]:1"}, "websocket metrics ros1 video"),
        # Programs may open WebSockets by any name: browsers send an origin with each.
        ({"Host": f"{HOSTNAME}:1"}, "websocket ros1 video"),
        ({"Host": f"{HOSTNAME.upper()}.local"}, "websocket ros1 video"),
        ({"Host": "robot.lab.example:1"}, "websocket ros1"),
        ({"Host": "hub:11311"}, "websocket ros1"),
        ({"Host": "evil.example"}, "websocket"),
        ({"Host": "localhost.evil.example"}, "websocket"),
        ({"Host": f"{HOSTNAME}.evil.example"}, "websocket"),
        (PAGE, "websocket metrics video"),
        # The page cannot read the response, and getting it changes nothing.
        (STRANGER, "metrics"),
        (FILE, "metrics"),
        (REBOUND, ""),
    ],
)
@pytest.mark.parametrize("name", ["websocket", "metrics", "ros1", "video"])
async def test_strangers_pages_are_refused(
    hub: HubServer, find: Find, name: str, headers: dict[str, str], allowed: str
) -> None:
    code, text = await status(await find(name), **headers)
    assert code == (403 if name not in allowed.split() else 101 if name == "websocket" else 200)
    if code == 403:
        named = headers.get("Origin") or headers["Host"].partition(":")[0]
        assert named in text
        if name != "video":
            assert hub.audit.refusals["origin"] == 1
    assert ("/x" in hub.graph.parameters.names()) is ((name, code) == ("ros1", 200))


@pytest.mark.parametrize("name", ["websocket", "metrics", "ros1"])
async def test_programs_need_no_host_header(hub: HubServer, find: Find, name: str) -> None:
    assert (await status(await find(name)))[0] in (101, 200)


async def test_refused_page_is_logged_once(
    hub: HubServer, find: Find, caplog: pytest.LogCaptureFixture
) -> None:
    for name in ("ros1", "video"):
        caplog.clear()
        for _ in range(9):
            assert (await status(await find(name), **STRANGER))[0] == 403
        assert caplog.text.count("https://evil.example") == 1


async def test_requests_of_ros1_pages_do_not_end_the_hub(hub: HubServer, find: Find) -> None:
    reasons: list[str] = []
    hub.stop_requested = reasons.append
    call = xmlrpc.client.dumps(("/page", "bye"), "shutdown")
    port = (await find("ros1"))._replace(body=call)
    assert (await status(port, **STRANGER))[0] == 403
    assert reasons == []


@pytest.mark.parametrize("name", ["Host", "Origin"])
async def test_repeated_header_is_refused(hub: HubServer, find: Find, name: str) -> None:
    port = await find("ros1")
    twice = port._replace(headers={f"{name}: localhost\r\n{name}": "localhost"})
    assert (await status(twice))[0] == 400


async def test_connections_that_the_video_server_refuses_are_logged_once(
    hub: HubServer, find: Find, caplog: pytest.LogCaptureFixture, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(web_video_server, "MOST_CONNECTIONS", 0)
    port = await find("video")
    for _ in range(3):
        reader, writer = await asyncio.open_connection("127.0.0.1", port.number)
        assert await reader.read() == b""
        writer.close()
    assert caplog.text.count("the limit of 0 is reached") == 1


@pytest.mark.long
def test_all_listening_ports_are_tested_here() -> None:
    package = Path(fibws.__file__).parent
    listening = {
        path.relative_to(package).as_posix()
        for path in package.rglob("*.py")
        for node in ast.walk(ast.parse(path.read_text("utf-8")))
        if isinstance(node, ast.Attribute)
        and node.attr in ("create_server", "start_server", "create_unix_server", "listen")
    }
    assert listening == {
        "hub/listening.py",
        "hub/ros1/server.py",
        "programs/web_video_server.py",
    }
