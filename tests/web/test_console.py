"""The Console tab of the page: messages of nodes on /rosout."""

from __future__ import annotations

import json
import re
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from typing import Any

import pytest
from playwright.async_api import Browser, Page, expect
from websockets.asyncio.client import ClientConnection, connect

from fibws.hub.server import HubServer

from .conftest import OpenPage, traced, until

DEBUG, INFO, WARN, ERROR, FATAL = 1, 2, 4, 8, 16
MARKUP = "<img src=x onerror=alert(1)>"
ROWS = "section.console .log li"
LAST = "(document.querySelector('section.console .log li:last-child')?.textContent ?? '')"
KEPT = 200
"""How many messages the hub queues for a page that falls behind."""


class Logger:
    """A client that publishes on /rosout, in the name of any node."""

    def __init__(self, client: ClientConnection) -> None:
        self._client = client

    async def log(self, text: str, level: int = INFO, node: str = "/talker", **more: Any) -> None:
        message = {"level": level, "name": node, "msg": text, **more}
        operation = {"op": "publish", "topic": "/rosout", "msg": message}
        await self._client.send(json.dumps(operation))


@asynccontextmanager
async def logger(hub: HubServer) -> AsyncIterator[Logger]:
    async with connect(f"{hub.url}/?node=/talker") as client:
        topic = {"topic": "/rosout", "type": "rosgraph_msgs/Log"}
        await client.send(json.dumps({"op": "advertise", **topic}))
        yield Logger(client)


async def texts(page: Page) -> list[str]:
    return await page.locator(f"{ROWS} .text").all_inner_texts()


@pytest.mark.smoke
async def test_messages_are_listed_with_their_levels(open_page: OpenPage, hub: HubServer) -> None:
    page = await open_page(hub, "#/console")
    async with logger(hub) as talker:
        for level in (DEBUG, INFO, WARN, ERROR, FATAL):
            await talker.log(f"level {level}", level)
        rows = page.locator(ROWS)
        await expect(rows).to_have_count(5)
        levels = await rows.locator(".level").all_inner_texts()
        assert levels == ["DEBUG", "INFO", "WARN", "ERROR", "FATAL"]
        assert await texts(page) == [f"level {level}" for level in (1, 2, 4, 8, 16)]
        await expect(rows.first).to_contain_text("/talker")


async def test_badge_counts_warnings_and_errors_while_another_view_is_shown(
    open_page: OpenPage, hub: HubServer
) -> None:
    page = await open_page(hub, "#/parameters")
    badge = page.locator("#tab-console .badge")
    await expect(badge).to_be_hidden()
    async with logger(hub) as talker:
        await talker.log("all is well")
        await talker.log("it is hot", WARN)
        await talker.log("it burns", ERROR)
        await expect(badge).to_have_text("2 warnings and errors")
        await page.get_by_role("link", name="Console").click()
        await expect(badge).to_be_hidden()
        assert await texts(page) == ["all is well", "it is hot", "it burns"]
        await talker.log("it still burns", ERROR)
        await expect(page.locator(ROWS)).to_have_count(4)
        await expect(badge).to_be_hidden()
        await page.get_by_role("link", name="Parameters").click()
        await talker.log("ashes", FATAL)
        await expect(badge).to_have_text("1 warning or error")


async def test_lines_are_filtered_by_level_node_and_text(
    open_page: OpenPage, hub: HubServer
) -> None:
    page = await open_page(hub, "#/console")
    async with logger(hub) as talker:
        await talker.log("Hello from here", INFO, "/here")
        await talker.log("a warning from here", WARN, "/here")
        await talker.log("hello from there", INFO, "/there")
        await talker.log("an error from there", ERROR, "/there")
        rows = page.locator(ROWS)
        await expect(rows).to_have_count(4)
        await page.get_by_label("Minimum level").select_option(label="WARN and above")
        assert await texts(page) == ["a warning from here", "an error from there"]
        await page.get_by_label("Node", exact=True).select_option("/there")
        assert await texts(page) == ["an error from there"]
        await page.get_by_label("Minimum level").select_option(label="all levels")
        await page.get_by_label("Filter messages").fill("HELLO")
        assert await texts(page) == ["hello from there"]
        await talker.log("hello again", INFO, "/there")
        await talker.log("nothing to see", INFO, "/there")
        await talker.log("hello from elsewhere", INFO, "/elsewhere")
        await talker.log("hello at last", INFO, "/there")
        await expect(rows).to_have_count(3)
        assert await texts(page) == ["hello from there", "hello again", "hello at last"]
        await page.get_by_label("Filter messages").fill("no such thing")
        await expect(rows).to_have_count(0)
        await expect(page.locator(".console [role=status]")).to_contain_text("No lines")


async def test_link_has_the_level_the_node_and_the_filter(
    open_page: OpenPage, hub: HubServer
) -> None:
    page = await open_page(hub, "#/console")
    async with logger(hub) as talker:
        await talker.log("left motor is hot", WARN)
        await expect(page.locator(ROWS)).to_have_count(1)
        await page.get_by_label("Minimum level").select_option("WARN and above")
        await page.get_by_label("Node").select_option("/talker")
        await page.get_by_label("Filter").fill("motor -right")
        route = "#/console?level=warn&node=/talker&filter=motor+-right"
        await expect(page).to_have_url(re.compile(re.escape(route) + "$"))
        copy = await open_page(hub, route)
        await talker.log("left motor is on", INFO)
        await talker.log("right motor is hot", WARN)
        await talker.log("left motor is off", ERROR)
        await expect(copy.locator(ROWS)).to_have_count(1)
        assert await texts(copy) == ["left motor is off"]
        await expect(copy.get_by_label("Node")).to_have_value("/talker")


async def test_paused_list_catches_up_when_resumed(open_page: OpenPage, hub: HubServer) -> None:
    page = await open_page(hub, "#/console")
    async with logger(hub) as talker:
        await talker.log("one")
        await expect(page.locator(ROWS)).to_have_count(1)
        await page.get_by_role("button", name="Pause", exact=True).click()
        await talker.log("two")
        await talker.log("three")
        await expect(page.locator(".console [role=status]")).to_contain_text("2 more")
        assert await texts(page) == ["one"]
        await page.get_by_role("button", name="Resume").click()
        await expect(page.locator(ROWS)).to_have_count(3)
        assert await texts(page) == ["one", "two", "three"]


async def test_empty_list_can_be_paused(open_page: OpenPage, hub: HubServer) -> None:
    page = await open_page(hub, "#/console")
    await page.get_by_role("button", name="Pause", exact=True).click()
    async with logger(hub) as talker:
        await talker.log("one")
        await expect(page.locator(".console [role=status]")).to_contain_text("1 more")
        assert await texts(page) == []


async def test_cleared_list_shows_only_new_messages(open_page: OpenPage, hub: HubServer) -> None:
    page = await open_page(hub, "#/console")
    async with logger(hub) as talker:
        await talker.log("old")
        await expect(page.locator(ROWS)).to_have_count(1)
        await page.get_by_role("button", name="Clear").click()
        await expect(page.locator(ROWS)).to_have_count(0)
        await talker.log("new")
        await expect(page.locator(ROWS)).to_have_count(1)
        assert await texts(page) == ["new"]


async def test_lines_are_copied_in_the_format_of_rospy(open_page: OpenPage, hub: HubServer) -> None:
    page = await open_page(hub, "#/console", permissions=["clipboard-read", "clipboard-write"])
    async with logger(hub) as talker:
        stamp = {"stamp": {"secs": 12, "nsecs": 345678901}}
        await talker.log("hello", header=stamp)
        await talker.log("ouch", ERROR, header=stamp)
        await expect(page.locator(ROWS)).to_have_count(2)
        await page.get_by_role("button", name="Copy").click()
        await expect(page.get_by_role("button", name="Copied")).to_be_visible()
    assert await page.evaluate("navigator.clipboard.readText()") == (
        "[INFO] [12.345678] [/talker]: hello\n[ERROR] [12.345678] [/talker]: ouch"
    )


async def test_source_of_an_error_is_shown(open_page: OpenPage, hub: HubServer) -> None:
    page = await open_page(hub, "#/console")
    async with logger(hub) as talker:
        where: dict[str, Any] = {"file": "talker.py", "line": 12, "function": "main"}
        await talker.log("hello", **where)
        await talker.log("ouch", ERROR, **where)
        rows = page.locator(ROWS)
        await expect(rows).to_have_count(2)
        await expect(rows.nth(0)).to_have_attribute("title", "talker.py:12 main")
        await expect(rows.nth(1)).to_contain_text("talker.py:12 main")


async def test_messages_are_not_interpreted_as_markup(open_page: OpenPage, hub: HubServer) -> None:
    page = await open_page(hub, "#/console")
    async with logger(hub) as talker:
        await talker.log(MARKUP, ERROR, MARKUP, file=MARKUP, function=MARKUP)
        await expect(page.locator(ROWS)).to_have_count(1)
        await expect(page.locator(f"{ROWS} .text")).to_contain_text(MARKUP)
        await expect(page.locator(f"{ROWS} .node")).to_have_text(MARKUP)
        await expect(page.locator("#stage img")).to_have_count(0)


async def test_list_follows_the_newest_line_unless_scrolled_up(
    open_page: OpenPage, hub: HubServer
) -> None:
    page = await open_page(hub, "#/console")
    async with logger(hub) as talker:
        for number in range(100):
            await talker.log(f"line {number}")
        last = page.locator(ROWS).last
        await expect(last).to_contain_text("line 99")
        await expect(last).to_be_in_viewport()
        await page.locator(".console .scroll").hover()
        await page.mouse.wheel(0, -5000)
        jump = page.get_by_role("button", name="Jump to newest")
        await expect(jump).to_be_visible()
        await expect(page.locator(ROWS).first).to_be_in_viewport()
        await talker.log("the newest")
        await expect(last).to_contain_text("the newest")
        await expect(page.locator(ROWS).first).to_be_in_viewport()
        await jump.click()
        await expect(last).to_be_in_viewport()
        await expect(jump).to_be_hidden()


# It measures the CPU time of tasks, which is more on a busy machine.
@pytest.mark.slow
async def test_burst_of_messages_does_not_block_the_page(
    browser: Browser, open_page: OpenPage, hub: HubServer
) -> None:
    page = await open_page(hub, "#/console")
    async with logger(hub) as talker, traced(browser) as tasks:
        # As many at once as the hub queues for a page that falls behind, repeatedly.
        for number in range(3000):
            await talker.log(f"line {number}", ERROR if number % 10 == 0 else INFO)
            if number % KEPT == KEPT - 1:
                await until(page, f"{LAST}.includes('line {number}')")
        assert await page.locator(ROWS).count() == 2000
        note = page.locator(".console [role=status]")
        await expect(note).to_contain_text("2\u202f000")
    assert 0.001 < max(tasks) < 0.5, sorted(tasks)[-5:]


async def test_refused_message_of_another_page_is_shown(
    hub: HubServer, open_page: OpenPage
) -> None:
    page = await open_page(hub, "#/console")
    await page.evaluate(
        """url => {
            const socket = new WebSocket(`${url}/?node=/dashboard`);
            const send = (operation) => socket.send(JSON.stringify(operation));
            socket.onopen = () => {
                send({op: "advertise", topic: "/number", type: "std_msgs/Int32"});
                send({op: "publish", topic: "/number", msg: {data: "eight"}});
            };
        }""",
        hub.url,
    )
    line = page.locator(".log li")
    await expect(line).to_contain_text("/dashboard: ")
    await expect(line).to_contain_text("data")
    await expect(line.locator(".level")).to_have_text("WARN")
