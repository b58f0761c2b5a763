"""Runtimes of the clients: Node.js, a browser, Python."""

from __future__ import annotations

import asyncio
import json
import os
import shutil
import sys
from collections.abc import AsyncIterator, Callable, Iterator
from contextlib import AbstractAsyncContextManager, asynccontextmanager, contextmanager
from functools import partial
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from threading import Thread
from typing import Any
from urllib.parse import urlencode

from playwright.async_api import ConsoleMessage, async_playwright

from .casts import Cast

HERE = Path(__file__).parent
CHROMIUM = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "chrome"))), None)
QUIET = (
    "--no-sandbox --disable-gpu --disable-quic --no-first-run --disable-background-networking "
    "--disable-component-update --disable-sync"
).split()

Take = Callable[[dict[str, Any]], None]


def run(cast: Cast, url: str, take: Take) -> AbstractAsyncContextManager[None]:
    """A client that plays its scenarios, and each of the lines that it prints."""
    match cast.runtime:
        case "Chromium":
            return _page(cast, url, take)
        case "Node":
            return _process(
                "node", str(HERE / "node.mjs"), cast.library, url, *cast.scenarios, take=take
            )
        case transport:
            module = (sys.executable, "-m", "clients.roslibpy_scenarios")
            return _process(*module, url, *cast.scenarios, take=take, ROSLIBPY_TRANSPORT=transport)


@asynccontextmanager
async def _process(*command: str, take: Take, **environment: str) -> AsyncIterator[None]:
    process = await asyncio.create_subprocess_exec(
        *command,
        cwd=HERE.parent,
        env={**os.environ, **environment},
        stdin=asyncio.subprocess.DEVNULL,
        stdout=asyncio.subprocess.PIPE,
        limit=2**20,
    )

    async def read() -> None:
        assert process.stdout is not None
        async for line in process.stdout:
            _take_line(line.decode(), take)
        if await process.wait():
            take({"complaint": f"It ended with code {process.returncode}."})
        take({"done": True})

    reading = asyncio.create_task(read())
    try:
        yield
    finally:
        if process.returncode is None:
            process.kill()
        await reading


@asynccontextmanager
async def _page(cast: Cast, url: str, take: Take) -> AsyncIterator[None]:
    def on_console(message: ConsoleMessage) -> None:
        if message.type in ("error", "warning"):
            take({"complaint": f"console.{message.type}: {message.text}"})
        else:
            _take_line(message.text, take)

    with _web_server() as origin:
        async with async_playwright() as playwright:
            browser = await playwright.chromium.launch(executable_path=CHROMIUM, args=QUIET)
            page = await browser.new_page()
            page.on("console", on_console)
            page.on("pageerror", lambda error: take({"complaint": f"uncaught: {error}"}))
            query = {"library": cast.library, "url": url, "scenarios": ",".join(cast.scenarios)}
            await page.goto(f"{origin}/page.html?{urlencode(query)}")
            try:
                yield
            finally:
                await browser.close()


class _Quiet(SimpleHTTPRequestHandler):
    def log_message(self, *_: object) -> None:
        pass


@contextmanager
def _web_server() -> Iterator[str]:
    """The files of this folder, the installed packages among them, on a port of their own.

    Chromium lets no page that has no address, such as one that Playwright serves, reach a hub on
    this machine.
    """
    with ThreadingHTTPServer(("127.0.0.1", 0), partial(_Quiet, directory=str(HERE))) as server:
        thread = Thread(target=server.serve_forever, args=(0.05,))
        thread.start()
        try:
            yield f"http://localhost:{server.server_port}"
        finally:
            server.shutdown()
            thread.join()


def _take_line(line: str, take: Take) -> None:
    """Our own lines are JSON objects; libraries may print other lines."""
    if line.startswith("{"):
        take(json.loads(line))
