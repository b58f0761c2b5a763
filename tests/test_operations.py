"""The configurations in docs/operations.md, with nginx, Caddy and systemd themselves."""

from __future__ import annotations

import asyncio
import json
import re
import shutil
import ssl
import subprocess
from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager
from pathlib import Path
from typing import Any

import pytest
from websockets.asyncio.client import ClientConnection, connect, unix_connect
from websockets.exceptions import InvalidStatus

from fibws.hub import Hub, Settings

PAGE = (Path(__file__).parents[1] / "docs" / "operations.md").read_text("utf-8")
HOST = "robot.example"
TIMEOUT = 30


def block(language: str) -> str:
    """Return the only block of a language."""
    found: list[str] = re.findall(rf"^```{language}\n(.*?)^```$", PAGE, re.MULTILINE | re.DOTALL)
    (text,) = found
    return text


def replaced(text: str, old: str, new: str) -> str:
    assert old in text
    return text.replace(old, new)


Certificate = tuple[Path, Path]
"""A certificate and its key."""


@pytest.fixture(scope="module")
def certificate(tmp_path_factory: pytest.TempPathFactory) -> Certificate:
    folder = tmp_path_factory.mktemp("certificate")
    pem, key = folder / "robot.pem", folder / "robot.key"
    if shutil.which("openssl") is None:
        pytest.skip("openssl is not installed")
    subprocess.run(
        [
            *("openssl", "req", "-x509", "-nodes", "-newkey", "ec", "-days", "2"),
            *("-pkeyopt", "ec_paramgen_curve:prime256v1", "-subj", f"/CN={HOST}"),
            *("-addext", f"subjectAltName=DNS:{HOST}", "-keyout", str(key), "-out", str(pem)),
        ],
        check=True,
        capture_output=True,
    )
    return pem, key


@asynccontextmanager
async def nginx(folder: Path, hub: Hub, certificate: Certificate) -> AsyncIterator[Path]:
    """Run nginx with the page's configuration, but for its addresses and files."""
    socket = folder / "socket"
    server = replaced(block("nginx"), "listen 443 ssl", f"listen unix:{socket} ssl")
    server = replaced(server, "127.0.0.1:9090", f"127.0.0.1:{hub.port}")
    server = replaced(server, "/etc/ssl/certs/robot.example.pem", str(certificate[0]))
    server = replaced(server, "/etc/ssl/private/robot.example.key", str(certificate[1]))
    paths = "".join(
        f"{name}_temp_path {folder / name};\n"
        for name in ("client_body", "proxy", "fastcgi", "uwsgi", "scgi")
    )
    config = folder / "nginx.conf"
    config.write_text(
        f"daemon off; master_process off; pid {folder}/pid; error_log {folder}/log notice;\n"
        f"events {{}} http {{ access_log off; {paths} {server} }}"
    )
    program = shutil.which("nginx", path="/usr/sbin:/usr/bin:/usr/local/bin") or "nginx"
    process = await asyncio.create_subprocess_exec(
        program, "-c", str(config), "-e", f"{folder}/log", stderr=asyncio.subprocess.PIPE
    )
    async with ended(process, socket):
        yield socket


@asynccontextmanager
async def caddy(folder: Path, hub: Hub, certificate: Certificate) -> AsyncIterator[Path]:
    """Run Caddy with the page's configuration, but for its addresses and certificate."""
    socket = folder / "socket"
    pem, key = certificate
    site = replaced(block("caddy"), "127.0.0.1:9090", f"127.0.0.1:{hub.port}")
    site = replaced(site, f"{HOST} {{", f"{HOST} {{\nbind unix/{socket}\ntls {pem} {key}\n")
    config = folder / "Caddyfile"
    config.write_text(f"{{\nadmin off\nauto_https disable_redirects\n}}\n{site}")
    process = await asyncio.create_subprocess_exec(
        *("caddy", "run", "--config", str(config), "--adapter", "caddyfile"),
        env={"HOME": str(folder), "PATH": "/usr/bin:/usr/local/bin"},
        stderr=asyncio.subprocess.PIPE,
    )
    async with ended(process, socket):
        yield socket


@asynccontextmanager
async def ended(process: asyncio.subprocess.Process, socket: Path) -> AsyncIterator[None]:
    """Wait until a proxy listens; end it in the end."""
    try:
        async with asyncio.timeout(TIMEOUT):
            while True:
                try:
                    _, writer = await asyncio.open_unix_connection(socket)
                except OSError:
                    if process.returncode is not None:
                        assert process.stderr is not None
                        raise AssertionError((await process.stderr.read()).decode()) from None
                    await asyncio.sleep(0.01)
                else:
                    writer.close()
                    break
        yield
    finally:
        if process.returncode is None:
            process.terminate()
        await process.communicate()


PROXIES = [
    pytest.param(proxy, marks=pytest.mark.skipif(not found, reason=f"{name} is not installed"))
    for name, proxy, found in (
        ("nginx", nginx, shutil.which("nginx", path="/usr/sbin:/usr/bin:/usr/local/bin")),
        ("caddy", caddy, shutil.which("caddy")),
    )
]


@pytest.mark.parametrize("proxy", PROXIES)
async def test_page_and_its_websocket_work_through_a_proxy(
    proxy: Callable[..., Any], certificate: Certificate, tmp_path: Path
) -> None:
    trusted = ssl.create_default_context(cafile=str(certificate[0]))
    settings = Settings(port=0, allow_origin=(f"https://{HOST}",))
    async with Hub(settings) as hub, proxy(tmp_path, hub, certificate) as socket:

        async def get(path: str) -> bytes:
            reader, writer = await asyncio.open_unix_connection(
                socket, ssl=trusted, server_hostname=HOST
            )
            writer.write(
                f"GET {path} HTTP/1.1\r\nHost: {HOST}\r\nConnection: close\r\n\r\n".encode()
            )
            answer = await reader.read()
            writer.close()
            return answer

        def page_of(origin: str) -> connect:
            return unix_connect(
                str(socket),
                uri=f"wss://{HOST}/",
                ssl=trusted,
                additional_headers={"Origin": origin},
            )

        async with asyncio.timeout(TIMEOUT):
            assert (await get("/healthz")).startswith(b"HTTP/1.1 200")
            page: ClientConnection
            async with page_of(f"https://{HOST}") as page:
                call = {"op": "call_service", "service": "/rosapi/topics", "id": "1"}
                await page.send(json.dumps(call))
                answer = json.loads(await page.recv())
                assert answer["op"] == "service_response" and answer["result"] is True
            with pytest.raises(InvalidStatus) as refused:
                async with page_of("https://stranger.example"):
                    pass
            assert refused.value.response.status_code == 403


@pytest.mark.skipif(shutil.which("systemd-analyze") is None, reason="needs systemd-analyze")
def test_systemd_accepts_the_service(tmp_path: Path) -> None:
    unit = tmp_path / "fibws-hub.service"
    # The program is not installed there on this machine.
    unit.write_text(replaced(block("ini"), "/opt/fibws/bin/python", "/usr/bin/env"))
    checked = subprocess.run(
        ["systemd-analyze", "verify", "--man=no", str(unit)], capture_output=True, text=True
    )
    assert checked.returncode == 0 and str(unit) not in checked.stderr, checked.stderr
    unit.write_text(unit.read_text().replace("[Service]", "[Service]\nNoSuchSetting=1"))
    checked = subprocess.run(
        ["systemd-analyze", "verify", "--man=no", str(unit)], capture_output=True, text=True
    )
    assert "NoSuchSetting" in checked.stderr
