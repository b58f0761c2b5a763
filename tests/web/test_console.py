"""The page's console: what nodes say on /rosout."""

from __future__ import annotations

import json
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from typing import Any

from playwright.async_api import Browser, Page, expect
from websockets.asyncio.client import ClientConnection, connect

from fibws.hub import Hub

from .conftest import OpenPage, traced, until

DEBUG, INFO, WARN, ERROR, FATAL = 1, 2, 4, 8, 16
MARKUP = "<img src=x onerror=alert(1)>"
ROWS = "section.console .log li"
LAST = "(document.querySelector('section.console .log li:last-child')?.textContent ?? '')"
KEPT = 200
"""Lines that the hub keeps for a page that falls behind."""


class Speaker:
    """A client that says things on /rosout, in the name of any node."""

    def __init__(self, client: ClientConnection) -> None:
        self._client = client

    async def say(self, text: str, level: int = INFO, node: str = "/talker", **more: Any) -> None:
        message = {"level": level, "name": node, "msg": text, **more}
        operation = {"op": "publish", "topic": "/rosout", "msg": message}
        await self._client.send(json.dumps(operation))


@asynccontextmanager
async def speaker(hub: Hub) -> AsyncIterator[Speaker]:
    async with connect(f"{hub.url}/?node=/talker") as client:
        topic = {"topic": "/rosout", "type": "rosgraph_msgs/Log"}
        await client.send(json.dumps({"op": "advertise", **topic}))
        yield Speaker(client)


async def texts(page: Page) -> list[str]:
    return await page.locator(f"{ROWS} .text").all_inner_texts()


async def test_what_nodes_say_is_listed_with_its_level_in_words(
    open_page: OpenPage, hub: Hub
) -> None:
    page = await open_page(hub, "#/console")
    async with speaker(hub) as talker:
        for level in (DEBUG, INFO, WARN, ERROR, FATAL):
            await talker.say(f"level {level}", level)
        rows = page.locator(ROWS)
        await expect(rows).to_have_count(5)
        levels = await rows.locator(".level").all_inner_texts()
        assert levels == ["DEBUG", "INFO", "WARN", "ERROR", "FATAL"]
        assert await texts(page) == [f"level {level}" for level in (1, 2, 4, 8, 16)]
        await expect(rows.first).to_contain_text("/talker")


async def test_nothing_is_missed_while_another_view_is_shown_and_a_badge_counts_what_is_wrong(
    open_page: OpenPage, hub: Hub
) -> None:
    page = await open_page(hub, "#/parameters")
    badge = page.locator("#tab-console .badge")
    await expect(badge).to_be_hidden()
    async with speaker(hub) as talker:
        await talker.say("all is well")
        await talker.say("it is hot", WARN)
        await talker.say("it burns", ERROR)
        await expect(badge).to_have_text("2 warnings and errors")
        await page.get_by_role("link", name="Console").click()
        await expect(badge).to_be_hidden()
        assert await texts(page) == ["all is well", "it is hot", "it burns"]
        await talker.say("it still burns", ERROR)
        await expect(page.locator(ROWS)).to_have_count(4)
        await expect(badge).to_be_hidden()
        await page.get_by_role("link", name="Parameters").click()
        await talker.say("ashes", FATAL)
        await expect(badge).to_have_text("1 warning or error")


async def test_lines_are_filtered_by_level_by_node_and_by_text(
    open_page: OpenPage, hub: Hub
) -> None:
    page = await open_page(hub, "#/console")
    async with speaker(hub) as talker:
        await talker.say("Hello from here", INFO, "/here")
        await talker.say("a warning from here", WARN, "/here")
        await talker.say("hello from there", INFO, "/there")
        await talker.say("an error from there", ERROR, "/there")
        rows = page.locator(ROWS)
        await expect(rows).to_have_count(4)
        await page.get_by_label("Least level").select_option(label="WARN and above")
        assert await texts(page) == ["a warning from here", "an error from there"]
        await page.get_by_label("Node", exact=True).select_option("/there")
        assert await texts(page) == ["an error from there"]
        await page.get_by_label("Least level").select_option(label="all levels")
        await page.get_by_label("Text").fill("HELLO")
        assert await texts(page) == ["hello from there"]
        await talker.say("hello again", INFO, "/there")
        await talker.say("nothing to see", INFO, "/there")
        await talker.say("hello from elsewhere", INFO, "/elsewhere")
        await talker.say("hello at last", INFO, "/there")
        await expect(rows).to_have_count(3)
        assert await texts(page) == ["hello from there", "hello again", "hello at last"]
        await page.get_by_label("Text").fill("no such thing")
        await expect(rows).to_have_count(0)
        await expect(page.locator(".console [role=status]")).to_have_text(
            "Nothing passes the filter."
        )


async def test_a_paused_list_stands_still_and_catches_up(open_page: OpenPage, hub: Hub) -> None:
    page = await open_page(hub, "#/console")
    async with speaker(hub) as talker:
        await talker.say("one")
        await expect(page.locator(ROWS)).to_have_count(1)
        await page.get_by_role("button", name="Pause").click()
        await talker.say("two")
        await talker.say("three")
        await expect(page.locator(".console [role=status]")).to_have_text("1 line Paused: 2 more.")
        assert await texts(page) == ["one"]
        await page.get_by_role("button", name="Go on").click()
        await expect(page.locator(ROWS)).to_have_count(3)
        assert await texts(page) == ["one", "two", "three"]


async def test_an_empty_list_can_be_paused_too(open_page: OpenPage, hub: Hub) -> None:
    page = await open_page(hub, "#/console")
    await page.get_by_role("button", name="Pause").click()
    async with speaker(hub) as talker:
        await talker.say("one")
        await expect(page.locator(".console [role=status]")).to_contain_text("Paused: 1 more.")
        assert await texts(page) == []


async def test_a_cleared_list_begins_anew(open_page: OpenPage, hub: Hub) -> None:
    page = await open_page(hub, "#/console")
    async with speaker(hub) as talker:
        await talker.say("old")
        await expect(page.locator(ROWS)).to_have_count(1)
        await page.get_by_role("button", name="Clear").click()
        await expect(page.locator(ROWS)).to_have_count(0)
        await talker.say("new")
        await expect(page.locator(ROWS)).to_have_count(1)
        assert await texts(page) == ["new"]


async def test_what_is_listed_can_be_copied_as_a_terminal_would_show_it(
    open_page: OpenPage, hub: Hub
) -> None:
    page = await open_page(hub, "#/console", permissions=["clipboard-read", "clipboard-write"])
    async with speaker(hub) as talker:
        stamp = {"stamp": {"secs": 12, "nsecs": 345678901}}
        await talker.say("hello", header=stamp)
        await talker.say("ouch", ERROR, header=stamp)
        await expect(page.locator(ROWS)).to_have_count(2)
        await page.get_by_role("button", name="Copy").click()
        await expect(page.get_by_role("button", name="Copied")).to_be_visible()
    assert await page.evaluate("navigator.clipboard.readText()") == (
        "[INFO] [12.345678] [/talker]: hello\n[ERROR] [12.345678] [/talker]: ouch"
    )


async def test_where_an_error_comes_from_is_told(open_page: OpenPage, hub: Hub) -> None:
    page = await open_page(hub, "#/console")
    async with speaker(hub) as talker:
        where: dict[str, Any] = {"file": "talker.py", "line": 12, "function": "main"}
        await talker.say("hello", **where)
        await talker.say("ouch", ERROR, **where)
        rows = page.locator(ROWS)
        await expect(rows).to_have_count(2)
        await expect(rows.nth(0)).to_have_attribute("title", "talker.py:12 main")
        await expect(rows.nth(1)).to_contain_text("talker.py:12 main")


async def test_what_is_said_never_becomes_markup(open_page: OpenPage, hub: Hub) -> None:
    page = await open_page(hub, "#/console")
    async with speaker(hub) as talker:
        await talker.say(MARKUP, ERROR, MARKUP, file=MARKUP, function=MARKUP)
        await expect(page.locator(ROWS)).to_have_count(1)
        await expect(page.locator(f"{ROWS} .text")).to_contain_text(MARKUP)
        await expect(page.locator(f"{ROWS} .node")).to_have_text(MARKUP)
        await expect(page.locator("#stage img")).to_have_count(0)


async def test_the_list_follows_the_newest_line_unless_one_reads_further_up(
    open_page: OpenPage, hub: Hub
) -> None:
    page = await open_page(hub, "#/console")
    async with speaker(hub) as talker:
        for number in range(100):
            await talker.say(f"line {number}")
        last = page.locator(ROWS).last
        await expect(last).to_contain_text("line 99")
        await expect(last).to_be_in_viewport()
        await page.locator(".console .scroll").hover()
        await page.mouse.wheel(0, -5000)
        to_newest = page.get_by_role("button", name="To the newest")
        await expect(to_newest).to_be_visible()
        await expect(page.locator(ROWS).first).to_be_in_viewport()
        await talker.say("the newest")
        await expect(last).to_contain_text("the newest")
        await expect(page.locator(ROWS).first).to_be_in_viewport()
        await to_newest.click()
        await expect(last).to_be_in_viewport()
        await expect(to_newest).to_be_hidden()


async def test_a_burst_is_bounded_and_freezes_nothing(
    browser: Browser, open_page: OpenPage, hub: Hub
) -> None:
    page = await open_page(hub, "#/console")
    async with speaker(hub) as talker, traced(browser) as tasks:
        # As much at once as the hub keeps for a page that falls behind, and again.
        for number in range(3000):
            await talker.say(f"line {number}", ERROR if number % 10 == 0 else INFO)
            if number % KEPT == KEPT - 1:
                await until(page, f"{LAST}.includes('line {number}')")
        assert await page.locator(ROWS).count() == 2000
        note = page.locator(".console [role=status]")
        await expect(note).to_contain_text("The newest 2\u202f000 lines")
    assert 0.001 < max(tasks) < 0.5, sorted(tasks)[-5:]
