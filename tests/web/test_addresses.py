"""The page at different addresses: localhost, IPv6, behind a proxy, and other hubs."""

from __future__ import annotations

import asyncio
import contextlib
import socket
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from pathlib import Path

import pytest
from playwright.async_api import Page, expect

import fibws
from fibws.hub import Settings
from fibws.hub.server import HubServer
from fibws.hub.tls import self_signed
from fibws.msg.std_msgs import Int32

from .conftest import PATIENT, STRANGER, OpenPage, web_address


@asynccontextmanager
async def proxy(hub: HubServer, prefix: str, *, upgrades: bool = True) -> AsyncIterator[str]:
    """Run a reverse proxy that serves only the hub, below a path; yield its address.

    Args:
        upgrades: whether it passes the header Upgrade on.
    """

    async def pump(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        with contextlib.suppress(ConnectionError):
            while piece := await reader.read(2**16):
                writer.write(piece)
                await writer.drain()
        writer.close()

    async def answer(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        request = await reader.readline()
        asked.append(request.split()[1].decode())
        upstream, downstream = await asyncio.open_connection("127.0.0.1", hub.port)
        head = await reader.readuntil(b"\r\n\r\n")
        if not upgrades:
            head = head.replace(b"Upgrade: websocket\r\n", b"")
        downstream.write(request.replace(f" {prefix}/".encode(), b" /", 1) + head)
        await asyncio.gather(pump(reader, downstream), pump(upstream, writer))

    asked: list[str] = []
    async with await asyncio.start_server(answer, "127.0.0.1", 0) as server:
        yield f"http://127.0.0.1:{server.sockets[0].getsockname()[1]}{prefix}"
    assert asked
    assert [path for path in asked if not path.startswith(f"{prefix}/")] == []


async def expect_page_to_work(page: Page, hub: HubServer, address: str) -> None:
    """Check that scripts, styles, worker and connection use that address and no other."""
    async with fibws.Node("talker", hub=hub.url) as node:
        numbers = await node.advertise("fibonacci", Int32, latch=True)
        await numbers.publish(data=8)
        # The worker computes the layout.
        await expect(page.locator('.graph [data-id="topic /fibonacci"]')).to_be_visible()
        await page.goto(f"{address}/#/topics/%2Ffibonacci")
        await expect(page.locator(".echo .tree-value")).to_have_text("8")
        await page.get_by_role("button", name="Help").click()
        help_ = page.get_by_role("dialog", name="Help")
        await expect(help_).to_contain_text(f'src="{address}/roslib.js"')
        await expect(help_).to_contain_text(f'WebSocket("{address.replace("http", "ws", 1)}")')
        fetched = await page.evaluate("performance.getEntriesByType('resource').map(e => e.name)")
        assert len(fetched) > 5
        assert [url for url in fetched if not url.startswith((f"{address}/", "data:"))] == []


async def test_page_works_at_localhost(hub: HubServer, open_page: OpenPage) -> None:
    address = f"http://localhost:{hub.port}"
    await expect_page_to_work(await open_page(hub, address=address), hub, address)


@pytest.mark.skipif(not socket.has_dualstack_ipv6(), reason="IPv6 is not available")
async def test_page_works_at_an_ipv6_address(open_page: OpenPage) -> None:
    async with HubServer(Settings(host="::1", **PATIENT)) as hub:
        page = await open_page(hub)
        assert web_address(hub).startswith("http://[::1]:")
        await expect_page_to_work(page, hub, web_address(hub))
        await page.close()


async def test_page_works_below_the_path_of_the_hub(open_page: OpenPage) -> None:
    async with HubServer(Settings(url_path="/lab/robot", **PATIENT)) as hub:
        page = await open_page(hub)
        assert web_address(hub).endswith("/lab/robot")
        await expect_page_to_work(page, hub, web_address(hub))
        await page.goto(web_address(hub))  # without the slash at the end
        await expect(page.locator("#hub[data-state=open]")).to_be_visible()
        await page.close()


async def test_phone_gets_a_secure_page_without_an_option_for_its_name(
    open_page: OpenPage, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path))
    monkeypatch.setenv("FIBWS_CA", str(self_signed.files().authority))
    async with HubServer(Settings(self_signed=True, **PATIENT)) as hub:
        address = f"https://{STRANGER}:{hub.port}"
        page = await open_page(hub, address=address, ignore_https_errors=True)
        await expect_page_to_work(page, hub, address)
        await page.goto(address.replace("https:", "http:"))  # as a person types it
        await expect(page.locator("#hub[data-state=open]")).to_be_visible()
        assert page.url.startswith(f"{address}/")
        features = "[isSecureContext, 'mediaDevices' in navigator, 'getGamepads' in navigator]"
        assert await page.evaluate(features) == [True, True, True]
        await page.close()


async def test_page_works_behind_a_proxy_with_a_path(hub: HubServer, open_page: OpenPage) -> None:
    async with proxy(hub, "/lab/robot") as address:
        page = await open_page(hub, address=address)
        await expect_page_to_work(page, hub, address)
        await page.close()
