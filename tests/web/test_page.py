"""The hub's page and the README's snippet, in a real browser."""

from __future__ import annotations

import asyncio
import json
import os
import re
import shutil
from collections.abc import AsyncIterator
from pathlib import Path

import pytest
from playwright.async_api import Browser, Page, async_playwright
from websockets.asyncio.client import connect

from fibws.hub import Hub, Settings

README = Path(__file__).parents[2] / "README.md"
SNIPPET = re.compile(r"```js\n(const hub = new WebSocket.*?)```", re.DOTALL)
CHROMIUM = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "chrome"))), None)
QUIET = (
    "--no-sandbox --disable-gpu --disable-quic --no-first-run --disable-background-networking "
    "--disable-component-update --disable-sync"
).split()
STRANGER = "stranger.example"


@pytest.fixture
async def browser() -> AsyncIterator[Browser]:
    if CHROMIUM is None and not os.environ.get("CI"):
        pytest.skip("there is no Chromium here")
    async with async_playwright() as playwright:
        browser = await playwright.chromium.launch(
            executable_path=CHROMIUM,
            args=[*QUIET, f"--host-resolver-rules=MAP {STRANGER} 127.0.0.1"],
        )
        yield browser
        await browser.close()


@pytest.fixture
async def hub() -> AsyncIterator[Hub]:
    async with Hub(Settings(port=0)) as hub:
        yield hub


async def publish_a_number(hub: Hub) -> None:
    """Latch a number for all who will listen, until cancelled."""
    async with connect(f"{hub.url}/?node=/broadcaster") as client:
        topic = {"topic": "/fibonacci", "type": "std_msgs/Int32", "latch": True}
        await client.send(json.dumps({"op": "advertise", **topic}))
        await client.send(json.dumps({"op": "publish", "topic": "/fibonacci", "msg": {"data": 8}}))
        await client.wait_closed()


async def paste(page: Page, snippet: str, hub: Hub) -> str:
    """Run a snippet as the console does; return the first line that it logs."""
    broadcaster = asyncio.create_task(publish_a_number(hub))
    console = await page.context.new_cdp_session(page)
    try:
        async with page.expect_console_message(lambda said: said.type == "log") as message:
            await console.send("Runtime.evaluate", {"expression": snippet, "replMode": True})
        return (await message.value).text
    finally:
        broadcaster.cancel()


async def test_the_page_says_what_this_is_and_its_snippet_hears_the_numbers(
    browser: Browser, hub: Hub
) -> None:
    page = await browser.new_page()
    errors: list[str] = []
    page.on("pageerror", lambda error: errors.append(str(error)))
    await page.goto(hub.url.replace("ws:", "http:"))
    assert await page.title() == "fibws hub"
    snippet = await page.inner_text("#snippet")
    assert len(snippet.splitlines()) == 5
    assert await paste(page, snippet, hub) == "I heard 8"
    assert errors == []


async def test_the_readme_snippet_works_from_another_page_on_localhost(
    browser: Browser, hub: Hub
) -> None:
    found = SNIPPET.search(README.read_text())
    assert found is not None
    snippet = found[1].replace("ws://localhost:9090", hub.url)
    assert len(snippet.splitlines()) == 5
    async with Hub(Settings(port=0)) as elsewhere:
        page = await browser.new_page()
        await page.goto(f"http://localhost:{elsewhere.port}/healthz")
        assert await paste(page, snippet, hub) == "I heard 8"


@pytest.mark.parametrize("allowed", [False, True])
async def test_a_page_of_another_origin_connects_only_if_that_is_allowed(
    browser: Browser, allowed: bool
) -> None:
    async with Hub(Settings(port=0)) as elsewhere:
        origin = f"http://{STRANGER}:{elsewhere.port}"
        async with Hub(Settings(port=0, allow_origin=(origin,) if allowed else ())) as hub:
            page = await browser.new_page()
            await page.goto(f"{origin}/")
            opened = await page.evaluate(
                """url => new Promise(done => {
                    const socket = new WebSocket(url);
                    socket.onopen = () => done(true);
                    socket.onclose = () => done(false);
                })""",
                hub.url,
            )
            assert opened is allowed
