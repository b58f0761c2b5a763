"""The time bar: all panels stop, go back, and return to what comes now."""

from __future__ import annotations

import re

from playwright.async_api import Page, expect

import fibws
from fibws.hub import Hub
from fibws.msg.std_msgs import Int32, String

from .conftest import OpenPage


async def shown(page: Page, value: object) -> None:
    """Wait until Echo shows a value."""
    await expect(page.locator(".echo .tree-value")).to_have_text(str(value))


async def seek_back(page: Page, key: str) -> None:
    await page.get_by_role("slider", name="Time").focus()
    await page.keyboard.press(key)


async def test_pause_stops_all_panels_and_live_returns(open_page: OpenPage, hub: Hub) -> None:
    async with fibws.Node("robot", hub=hub.url) as robot:
        numbers = await robot.advertise("/n", Int32, latch=True)
        await numbers.publish(data=1)
        page = await open_page(hub, "#/topics/%2Fn")
        await shown(page, 1)
        for value in (2, 3):
            await numbers.publish(data=value)
            await shown(page, value)
        bar = page.locator("#timebar")
        await bar.get_by_role("button", name="Pause all").click()
        await expect(bar).to_have_attribute("data-state", "paused")
        await numbers.publish(data=4)
        await seek_back(page, "Home")
        await shown(page, 1)
        await bar.get_by_role("button", name="Next message").click()
        await shown(page, 2)
        await bar.get_by_role("button", name="Next message").click()
        await shown(page, 3)
        await bar.get_by_role("button", name="Previous message").click()
        await shown(page, 2)
        await expect(bar.locator("output")).to_have_text(re.compile(r"^\d\d:\d\d:\d\d\.\d{3}$"))
        await bar.get_by_role("button", name="Live").click()
        await shown(page, 4)
        await expect(bar).to_have_attribute("data-state", "live")
        await numbers.publish(data=5)
        await shown(page, 5)


async def test_latched_messages_are_as_they_were(open_page: OpenPage, hub: Hub) -> None:
    async with fibws.Node("robot", hub=hub.url) as robot:
        latched = await robot.advertise("/mode", String, latch=True)
        await latched.publish(data="idle")
        page = await open_page(hub, "#/topics/%2Fmode")
        await shown(page, '"idle"')
        await latched.publish(data="drive")
        await shown(page, '"drive"')
        await seek_back(page, "Home")
        await shown(page, '"idle"')
        await page.locator("#timebar").get_by_role("button", name="Live").click()
        await shown(page, '"drive"')


async def test_played_messages_end_live(open_page: OpenPage, hub: Hub) -> None:
    async with fibws.Node("robot", hub=hub.url) as robot:
        latched = await robot.advertise("/n", Int32, latch=True)
        await latched.publish(data=1)
        page = await open_page(hub, "#/topics/%2Fn")
        await shown(page, 1)
        await latched.publish(data=2)
        await shown(page, 2)
        await seek_back(page, "Home")
        await shown(page, 1)
        bar = page.locator("#timebar")
        await bar.get_by_label("Speed").select_option("50")
        await bar.get_by_role("button", name="Play").click()
        await expect(bar).to_have_attribute("data-state", "live")
        await shown(page, 2)
