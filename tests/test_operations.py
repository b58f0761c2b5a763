"""The configurations in docs/operations.md, with nginx, Caddy and systemd themselves."""

from __future__ import annotations

import asyncio
import itertools
import json
import os
import re
import shlex
import shutil
import signal
import subprocess
import sys
from collections.abc import AsyncIterator, Callable
from contextlib import AbstractAsyncContextManager, asynccontextmanager
from pathlib import Path
from typing import NamedTuple, TypeAlias
from urllib.parse import urljoin

import pytest
from certificates import Authority
from certificates import authority as authority
from running_programs import Start
from running_programs import start as start
from websockets.asyncio.client import ClientConnection, connect
from websockets.exceptions import InvalidStatus

import fibws
from fibws.hub import Settings
from fibws.hub.server import HubServer

ROOT = Path(__file__).parents[1]
PAGE = (ROOT / "docs" / "operations.md").read_text("utf-8")
TIMEOUT = 30
CLIENT = "127.9.8.7"
"""The address that clients have at the proxy."""
PORT = 9443


class Place(NamedTuple):
    """Where a proxy has the hub, and the number of its configuration on the page."""

    number: int
    host: str
    path: str


Proxy: TypeAlias = AsyncIterator[str]
"""The address at which a proxy listens."""
PLACES = [Place(0, "robot.example", ""), Place(1, "lab.example", "/robot")]


def blocks(language: str) -> list[str]:
    """Return the blocks of a language."""
    return re.findall(rf"^```{language}\n(.*?)^```$", PAGE, re.MULTILINE | re.DOTALL)


def block(language: str) -> str:
    """Return the only block of a language."""
    (text,) = blocks(language)
    return text


def proxy_address() -> str:
    """Return an address of this machine that no other test uses."""
    return f"127.{os.getpid() >> 8 & 0xFF}.{os.getpid() & 0xFF}.{next(_numbers)}"


_numbers = itertools.count(2)


def replaced(text: str, old: str, new: str) -> str:
    assert old in text
    return text.replace(old, new)


@asynccontextmanager
async def nginx(folder: Path, hub: HubServer, place: Place, files: tuple[Path, Path]) -> Proxy:
    """Run nginx with the page's configuration, except for its addresses and files."""
    address = proxy_address()
    server = replaced(blocks("nginx")[place.number], "listen 443", f"listen {address}:{PORT}")
    server = replaced(server, "127.0.0.1:9090", f"127.0.0.1:{hub.port}")
    server = replaced(server, f"/etc/ssl/certs/{place.host}.pem", str(files[0]))
    server = replaced(server, f"/etc/ssl/private/{place.host}.key", str(files[1]))
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
    async with ended(process, address):
        yield address


@asynccontextmanager
async def caddy(folder: Path, hub: HubServer, place: Place, files: tuple[Path, Path]) -> Proxy:
    """Run Caddy with the page's configuration, except for its addresses and certificate."""
    address = proxy_address()
    pem, key = files
    site = replaced(blocks("caddy")[place.number], "127.0.0.1:9090", f"127.0.0.1:{hub.port}")
    site = replaced(
        site, f"{place.host} {{", f"{place.host}:{PORT} {{\nbind {address}\ntls {pem} {key}\n"
    )
    config = folder / "Caddyfile"
    config.write_text(f"{{\nadmin off\nauto_https disable_redirects\n}}\n{site}")
    process = await asyncio.create_subprocess_exec(
        *("caddy", "run", "--config", str(config), "--adapter", "caddyfile"),
        env={"HOME": str(folder), "PATH": "/usr/bin:/usr/local/bin"},
        stderr=asyncio.subprocess.PIPE,
    )
    async with ended(process, address):
        yield address


@asynccontextmanager
async def ended(process: asyncio.subprocess.Process, address: str) -> AsyncIterator[None]:
    """Wait until a proxy listens; end it in the end."""
    try:
        async with asyncio.timeout(TIMEOUT):
            while True:
                try:
                    _, writer = await asyncio.open_connection(address, PORT)
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


@pytest.mark.parametrize("place", PLACES, ids=lambda place: place.path or "/")
@pytest.mark.parametrize("proxy", PROXIES)
async def test_page_and_its_websocket_work_through_a_proxy(
    proxy: Callable[..., AbstractAsyncContextManager[str]],
    place: Place,
    authority: Authority,
    tmp_path: Path,
) -> None:
    trusted = authority.client()
    files = authority.issue(place.host)
    settings = Settings(port=0, trusted_proxy=("127.0.0.1",), url_path=place.path)
    async with HubServer(settings) as hub, proxy(tmp_path, hub, place, files) as address:

        async def get(path: str) -> bytes:
            reader, writer = await asyncio.open_connection(
                address, PORT, ssl=trusted, server_hostname=place.host
            )
            writer.write(
                f"GET {path} HTTP/1.1\r\nHost: {place.host}\r\nConnection: close\r\n\r\n".encode()
            )
            answer = await reader.read()
            writer.close()
            return answer

        def page_of(origin: str) -> connect:
            return connect(
                f"wss://{place.host}{place.path}/",
                host=address,
                port=PORT,
                local_addr=(CLIENT, 0),
                ssl=trusted,
                proxy=None,
                additional_headers={"Origin": origin, "X-Forwarded-For": "203.0.113.1"},
            )

        async with asyncio.timeout(TIMEOUT):
            assert (await get(f"{place.path}/healthz")).startswith(b"HTTP/1.1 200")
            if place.path:
                redirected = await get(place.path)
                assert redirected.startswith(b"HTTP/1.1 307")
                location = re.search(rb"(?im)^location: (\S+)", redirected)
                assert location is not None
                assert urljoin(place.path, location[1].decode()).endswith(f"{place.path}/")
            page: ClientConnection
            async with page_of(f"https://{place.host}") as page:
                topic = "/connected_clients"
                await page.send(json.dumps({"op": "subscribe", "topic": topic}))
                [client] = json.loads(await page.recv())["msg"]["clients"]
                assert client["ip_address"] == CLIENT
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


STUBS = {
    # What needs the network, root or systemd; all of them record how they were called.
    "git": "",
    "groupadd": "",
    "chgrp": "",
    "systemctl": "",
    "journalctl": "",
    "install": 'exec /usr/bin/install $(printf "%s\n" "$@" | sed "/^--group$/,+1d")',
    "python3": """
        mkdir -p "$3/bin"
        printf '#!/bin/sh\n[ "$2" = pip ] || exec %s "$@"\n' "$PYTHON" > "$3/bin/python"
        printf '#!/bin/sh\nexec %s -m fibws "$@"\n' "$PYTHON" > "$3/bin/fibws"
        chmod +x "$3"/bin/*""",
}


def moved(text: str, root: Path) -> str:
    """Return a text with all absolute paths of the installation below a folder."""
    return re.sub(r"(/opt/|/etc/|/var/lib/)", rf"{root}\1", text)


def installed(root: Path) -> tuple[list[str], str]:
    """Type the page's commands for systemd; return the calls of stubs, and what was printed."""
    section = PAGE.partition("## As a systemd service\n")[2].partition("\n## ")[0]
    steps = re.findall(r"^```console\n(.*?)^```$", section, re.MULTILINE | re.DOTALL)
    stubs = root / "stubs"
    for folder in (stubs, root / "fibws", root / "opt", root / "etc/systemd/system"):
        folder.mkdir(parents=True)
    (root / "fibws" / "deploy").symlink_to(ROOT / "deploy")
    for name, script in STUBS.items():
        (stubs / name).write_text(f'#!/bin/sh\necho {name} "$@" >> {root}/calls\n{script}\n')
        (stubs / name).chmod(0o755)
    ran = subprocess.run(
        ["bash", "-eu", "-c", moved("".join(steps), root)],
        cwd=root,
        capture_output=True,
        text=True,
        env={"PATH": f"{stubs}:/usr/bin:/bin", "PYTHON": sys.executable, "HOME": str(root)},
    )
    assert ran.returncode == 0, ran.stderr
    return (root / "calls").read_text().splitlines(), ran.stdout


def mode(path: Path) -> int:
    return path.stat().st_mode & 0o777


@pytest.mark.skipif(sys.platform != "linux", reason="needs bash and install")
async def test_hub_runs_after_the_commands_for_systemd(tmp_path: Path, start: Start) -> None:
    calls, printed = await asyncio.to_thread(installed, tmp_path)
    assert calls[-4:-2] == ["systemctl daemon-reload", "systemctl enable --now fibws-hub"]
    etc = tmp_path / "etc" / "fibws"
    assert mode(etc) == 0o750
    for name in ("tokens.toml", "hub.toml"):
        assert mode(etc / name) == 0o640
        assert f"chgrp fibws {etc / name}" in calls
    (token,) = re.findall(r"^fibws_\S+$|^[A-Za-z0-9_-]{20,}$", printed, re.MULTILINE)
    unit = moved((tmp_path / "etc/systemd/system/fibws-hub.service").read_text(), tmp_path)
    settings = dict(line.split("=", 1) for line in unit.splitlines() if "=" in line)
    assert settings["SupplementaryGroups"] in " ".join(calls)
    _, _, *words = shlex.split(settings["ExecStart"])
    state = tmp_path / "var" / "lib" / settings["StateDirectory"]
    state.mkdir(parents=True)
    for expected in (None, 5):
        hub = await start(*words, "--port", "0", STATE_DIRECTORY=str(state))
        found = re.search(r"ws://127\.0\.0\.1:\d+", await hub.line())
        assert found is not None
        with pytest.raises(fibws.NotAuthorized):
            async with fibws.Node("stranger", hub=found[0]) as node:
                await node.params.get("/speed")
        async with fibws.Node("robot", hub=found[0], token=token) as node:
            assert await node.params.get("/speed", None) == expected
            await node.params.set("/speed", 5)
        hub.send(signal.SIGTERM)
        code, _, error = await hub.end()
        assert code == 0, error
    assert [each.name for each in state.iterdir() if not each.name.startswith(".")] == [
        "params.yaml"
    ]
