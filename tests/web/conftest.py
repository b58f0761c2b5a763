"""Fixtures with a hub and its page in Chromium: browser warnings and errors fail the test.

The browser is started once, so all tests here run in one event loop. `fixture` makes fixtures use
that loop, too.
"""

from __future__ import annotations

import asyncio
import inspect
import json
import os
import shutil
from collections.abc import AsyncIterator, Awaitable, Callable
from contextlib import asynccontextmanager
from functools import partial
from pathlib import Path
from typing import Any

import pytest
import pytest_asyncio
from playwright.async_api import (
    Browser,
    ConsoleMessage,
    Page,
    ViewportSize,
    async_playwright,
    expect,
)

import fibws
from fibws.hub import Settings
from fibws.hub.server import HubServer

BUILT = Path(fibws.__file__).parent / "hub" / "page"
CHROMIUM = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "chrome"))), None)
QUIET = (
    "--no-sandbox --disable-gpu --disable-quic --no-first-run --disable-background-networking "
    "--disable-component-update --disable-sync"
).split()
TASK = "ThreadControllerImpl::RunTask"
"""The name of a thread's task in Chromium's traces."""
PATIENT: dict[str, Any] = {"port": 0, "open_timeout": 600.0}
"""A browser opens connections before it needs them; it must not meet the hub as it closes them."""
STRANGER = "stranger.example"
"""A host name that resolves to this machine."""

fixture = partial(pytest_asyncio.fixture, loop_scope="session")

TIMEOUT = 60_000
"""A timeout in ms that is long enough for busy machines."""
expect.set_options(timeout=TIMEOUT)

OpenPage = Callable[..., Awaitable[Page]]


ONE_LOOP = pytest.mark.asyncio(loop_scope="session")


@pytest.hookimpl(tryfirst=True)
def pytest_generate_tests(metafunc: pytest.Metafunc) -> None:
    """Choose the loop scope before the plugin makes it a parameter."""
    if inspect.iscoroutinefunction(metafunc.function):
        metafunc.definition.add_marker(ONE_LOOP, append=False)


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    for item in items:
        if item.path.is_relative_to(Path(__file__).parent):
            item.add_marker(pytest.mark.browser)
            if pytest_asyncio.is_async_test(item):
                item.add_marker(ONE_LOOP, append=False)


class Complaints:
    """Errors, warnings and policy violations in the browser's console."""

    def __init__(self) -> None:
        self.seen: list[str] = []

    def watch(self, page: Page) -> None:
        page.on("pageerror", lambda error: self.seen.append(f"{error}\n{error.stack or ''}"))
        page.on("console", self._on_console)

    def _on_console(self, message: ConsoleMessage) -> None:
        # Chromium remarks that software draws WebGL, which is so on test machines.
        is_remark = "GPU stall due to ReadPixels" in message.text
        if message.type in ("error", "warning") and not is_remark:
            self.seen.append(f"{message.text} ({message.location['url']})")

    def expect(self, text: str) -> None:
        """Require and ignore messages with a text, which the test provokes."""
        assert any(text in each for each in self.seen), f"no message has {text!r}: {self.seen}"
        self.allow(text)

    def allow(self, text: str) -> None:
        """Ignore messages with a text."""
        self.seen = [each for each in self.seen if text not in each]


@fixture(scope="session")
async def browser() -> AsyncIterator[Browser]:
    if CHROMIUM is None and not os.environ.get("CI"):
        pytest.skip("Chromium is not installed")
    async with async_playwright() as playwright:
        browser = await playwright.chromium.launch(
            executable_path=CHROMIUM,
            args=[*QUIET, f"--host-resolver-rules=MAP {STRANGER} 127.0.0.1"],
        )
        yield browser
        await browser.close()


@fixture
async def hub() -> AsyncIterator[HubServer]:
    async with HubServer(Settings(**PATIENT)) as hub:
        yield hub


@pytest.fixture
def complaints() -> Complaints:
    return Complaints()


@fixture
async def open_page(
    browser: Browser, complaints: Complaints, hub: HubServer
) -> AsyncIterator[OpenPage]:
    """Return a function that opens a hub's page: ``await open_page(hub, "#/topics", width=360)``.

    It returns once the page is connected and gets messages, or has another ``state``. ``prepare``
    is JavaScript that runs before the page's own, ``address`` is the page's address if it is not
    the hub's own. With ``has_clock``, ``page.clock.run_for`` lets time pass in the page without
    waiting. Other keywords are those of playwright's ``new_context``, such as
    ``color_scheme="dark"``. The fixture ``hub`` is requested so that it outlives all pages.
    """
    if not (BUILT / "index.html").exists() and not os.environ.get("CI"):
        pytest.skip("the page is not built: npm ci && npm run build, in web/")

    async def open_page(
        hub: HubServer,
        route: str = "",
        *,
        width: int = 1280,
        height: int = 800,
        prepare: str = "",
        address: str = "",
        state: str = "open",
        has_clock: bool = False,
        **context: Any,
    ) -> Page:
        viewport: ViewportSize = {"width": width, "height": height}
        own_context = await browser.new_context(viewport=viewport, **context)
        own_context.set_default_timeout(TIMEOUT)
        page = await own_context.new_page()
        complaints.watch(page)
        if has_clock:
            await page.clock.install()
        await page.add_init_script(prepare)
        await page.goto(f"{address or web_address(hub)}/{route}")
        messages = "[data-messages=open]" if state == "open" else ""
        await page.wait_for_selector(f"#hub[data-state={state}]{messages}")
        return page

    yield open_page
    for opened in browser.contexts:
        await opened.close()
    assert complaints.seen == []


def web_address(hub: HubServer) -> str:
    """Return the address of the hub's page, without a trailing slash."""
    return hub.url.replace("ws", "http", 1)


async def until(page: Page, expression: str) -> None:
    """Wait until a JavaScript expression is true.

    `Page.wait_for_function` needs eval, which the page's policy forbids.
    """
    look = f"({expression}) ? done() : requestAnimationFrame(look)"
    async with asyncio.timeout(60):
        await page.evaluate(f"new Promise((done) => {{ const look = () => {look}; look(); }})")


@asynccontextmanager
async def traced(browser: Browser) -> AsyncIterator[list[float]]:
    """Yield a list that gets the CPU seconds of each main thread task of the pages at the end.

    Unlike elapsed time, CPU time does not depend on the load of the machine.
    """
    tasks: list[float] = []
    await browser.start_tracing(categories=["toplevel"])
    try:
        yield tasks
    finally:
        events = json.loads(await browser.stop_tracing())["traceEvents"]
    mains = {
        (event["pid"], event["tid"])
        for event in events
        if event["name"] == "thread_name" and event["args"]["name"] == "CrRendererMain"
    }
    tasks += (
        event["tdur"] / 1e6
        for event in events
        if event["name"] == TASK and "tdur" in event and (event["pid"], event["tid"]) in mains
    )
