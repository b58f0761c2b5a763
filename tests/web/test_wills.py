"""Last wills of pages: the hub publishes them when a tab is closed or stands still."""

from __future__ import annotations

import asyncio

import pytest
from patience import PATIENCE
from playwright.async_api import Browser, Page

import fibws
from fibws.hub.server import HubServer
from fibws.msg.std_msgs import Int32

pytestmark = pytest.mark.browser

DRIVE = """
async (timeout) => {
  const ros = new ROSLIB.Ros({url: `ws://${location.host}`});
  const cmd = new ROSLIB.Topic({ros, name: "/cmd", messageType: "std_msgs/Int32"});
  await new Promise((resolve) => ros.on("connection", resolve));
  cmd.advertise();
  ros.callOnConnection({op: "set_will", topic: "/cmd", msg: {data: 0}, timeout});
  cmd.publish({data: 5});
}
"""


async def driving_page(browser: Browser, hub: HubServer, timeout: float | None) -> Page:
    page = await browser.new_page()
    await page.goto(f"http://127.0.0.1:{hub.port}/healthz")
    await page.add_script_tag(url=f"http://127.0.0.1:{hub.port}/roslib.js")
    await page.evaluate(DRIVE, timeout)
    return page


@pytest.mark.parametrize("end", ["close", "crash", "stand still"])
async def test_robot_stops_when_its_page_ends(browser: Browser, hub: HubServer, end: str) -> None:
    async with (
        asyncio.timeout(PATIENCE),
        fibws.Node("robot", hub=hub.url) as robot,
        robot.subscribe("/cmd", Int32) as commands,
    ):
        await robot.flush()
        page = await driving_page(browser, hub, 0.2 if end == "stand still" else None)
        assert (await anext(commands)).data == 5
        if end == "close":
            await page.close()
        elif end == "crash":
            crashing = asyncio.create_task(page.goto("chrome://crash"))
        assert (await anext(commands)).data == 0
        if end == "crash":
            crashing.cancel()
        if end == "stand still":
            await page.close()
