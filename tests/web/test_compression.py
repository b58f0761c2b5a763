"""Compressed messages of a page, whose browser compresses all that it sends."""

from __future__ import annotations

from collections.abc import AsyncIterator

import pytest
from playwright.async_api import Browser, Page

from fibws.hub import Settings
from fibws.hub.server import HubServer

from .conftest import fixture, web_address

SIZES = [5, 3000, 20_000, 700_000, 10]
EXCHANGE = """
([url, sizes]) => new Promise((resolve, reject) => {
  const websocket = new WebSocket(url);
  const received = [];
  const send = (op, fields) => websocket.send(JSON.stringify({op, topic: "/t", ...fields}));
  websocket.onopen = () => {
    send("subscribe", {type: "std_msgs/String", queue_length: 100});
    send("advertise", {type: "std_msgs/String"});
    for (const size of sizes) send("publish", {msg: {data: "x".repeat(size)}});
  };
  websocket.onmessage = ({data}) => {
    received.push(JSON.parse(data).msg.data.length);
    if (received.length === sizes.length) resolve([websocket.extensions, received]);
  };
  websocket.onclose = ({code, reason}) => reject(Error(`${code} ${reason}`));
})
"""


@fixture
async def page(browser: Browser) -> AsyncIterator[Page]:
    page = await browser.new_page()
    yield page
    await page.close()


@pytest.mark.parametrize("setting", ["always", "never"])
async def test_page_exchanges_long_texts(page: Page, setting: str) -> None:
    async with HubServer(Settings(port=0, deflate=setting)) as hub:  # type: ignore[arg-type]
        await page.goto(f"{web_address(hub)}/livez")
        extensions, received = await page.evaluate(EXCHANGE, [hub.url, SIZES])
        assert extensions.startswith("permessage-deflate" if setting == "always" else "")
        assert received == SIZES
        [connection] = [each for each in hub._connections if each.is_open]
        for size in (connection.queue.bytes_sent, connection.bytes_received):
            assert size < sum(SIZES) / 20 if setting == "always" else size > sum(SIZES)
        await page.goto("about:blank")
