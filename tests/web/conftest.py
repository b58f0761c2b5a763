"""A hub, and its page in Chromium: whatever the browser complains of fails the test.

The browser is started once, so that all tests here run on one event loop. Fixtures that are
coroutines must be on it, too: `fixture` makes them so.
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
from fibws.hub import Hub, Settings

BUILT = Path(fibws.__file__).parent / "hub" / "page"
CHROMIUM = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "chrome"))), None)
QUIET = (
    "--no-sandbox --disable-gpu --disable-quic --no-first-run --disable-background-networking "
    "--disable-component-update --disable-sync"
).split()
TASK = "ThreadControllerImpl::RunTask"
"""What Chromium's traces call one turn of a thread's loop."""
STRANGER = "stranger.example"
"""A host's name that leads to this machine."""

fixture = partial(pytest_asyncio.fixture, loop_scope="session")

PATIENCE = 60_000
"""Milliseconds: a busy machine is no fault of the page's."""
expect.set_options(timeout=PATIENCE)

OpenPage = Callable[..., Awaitable[Page]]


ONE_LOOP = pytest.mark.asyncio(loop_scope="session")


@pytest.hookimpl(tryfirst=True)
def pytest_generate_tests(metafunc: pytest.Metafunc) -> None:
    """Choose the loop's scope before the plugin makes it a parameter."""
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
    """What the browser complained of: errors, warnings, violations of the policy."""

    def __init__(self) -> None:
        self.seen: list[str] = []

    def watch(self, page: Page) -> None:
        page.on("pageerror", lambda error: self.seen.append(f"{error}\n{error.stack or ''}"))
        page.on("console", self._hear)

    def _hear(self, said: ConsoleMessage) -> None:
        if said.type in ("error", "warning"):
            self.seen.append(f"{said.text} ({said.location['url']})")

    def expect(self, text: str) -> None:
        """Take note of what the test brought about on purpose, however often it was said."""
        assert any(text in each for each in self.seen), f"no complaint says {text!r}: {self.seen}"
        self.allow(text)

    def allow(self, text: str) -> None:
        """As `expect`, of what need not have been said."""
        self.seen = [each for each in self.seen if text not in each]


@fixture(scope="session")
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


@fixture
async def hub() -> AsyncIterator[Hub]:
    async with Hub(Settings(port=0)) as hub:
        yield hub


@pytest.fixture
def complaints() -> Complaints:
    return Complaints()


@fixture
async def open_page(browser: Browser, complaints: Complaints, hub: Hub) -> AsyncIterator[OpenPage]:
    """Opens the page of a hub: ``await open_page(hub, "#/topics", width=360)``.

    Keywords besides ``width`` and ``height`` are those of playwright's ``new_context``, such as
    ``color_scheme="dark"``; ``prepare`` is JavaScript that runs before the page's own, ``address``
    where the page is if that is not the hub's own. The connection to the hub is there when it is
    given. The test's hub is asked for so that it outlives all pages, which would complain.
    """
    if not (BUILT / "index.html").exists() and not os.environ.get("CI"):
        pytest.skip("the page is not built: npm ci && npm run build, in web/")

    async def open_page(
        hub: Hub,
        route: str = "",
        *,
        width: int = 1280,
        height: int = 800,
        prepare: str = "",
        address: str = "",
        **context: Any,
    ) -> Page:
        viewport: ViewportSize = {"width": width, "height": height}
        its_own = await browser.new_context(viewport=viewport, **context)
        its_own.set_default_timeout(PATIENCE)
        page = await its_own.new_page()
        complaints.watch(page)
        await page.add_init_script(prepare)
        await page.goto(f"{address or web_address(hub)}/{route}")
        await page.wait_for_selector("#hub[data-state=open]")
        return page

    yield open_page
    for opened in browser.contexts:
        await opened.close()
    assert complaints.seen == []


def web_address(hub: Hub) -> str:
    """Where the hub serves its page, without a slash at the end."""
    return hub.url.replace("ws:", "http:", 1)


async def until(page: Page, expression: str) -> None:
    """Wait for an expression in JavaScript to be true.

    `Page.wait_for_function` needs eval, which the page's policy forbids.
    """
    look = f"({expression}) ? done() : requestAnimationFrame(look)"
    async with asyncio.timeout(60):
        await page.evaluate(f"new Promise((done) => {{ const look = () => {look}; look(); }})")


@asynccontextmanager
async def traced(browser: Browser) -> AsyncIterator[list[float]]:
    """The CPU time in seconds of each task of the pages' main threads; filled when it is left.

    Unlike the time by the clock, it is not lengthened by what else the machine does.
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
