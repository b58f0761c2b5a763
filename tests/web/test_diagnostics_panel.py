"""Diagnostics on the page of their topic: a tree, the worst first."""

from __future__ import annotations

from playwright.async_api import expect

import fibws
from fibws.hub.server import HubServer
from fibws.msg.diagnostic_msgs import DiagnosticArray, DiagnosticStatus, KeyValue

from .conftest import OpenPage


def statuses(laser: int, text: str) -> DiagnosticArray:
    return DiagnosticArray(
        status=[
            DiagnosticStatus(0, "/robot/Motors/left", "fine", "m1", [KeyValue("current", "1.5")]),
            DiagnosticStatus(laser, "/robot/Sensors/laser", text),
            DiagnosticStatus(1, "/robot/Sensors/camera", "hot <b>"),
        ]
    )


async def test_worst_diagnostics_come_first(hub: HubServer, open_page: OpenPage) -> None:
    async with fibws.Node("robot", hub=hub.url) as node:
        topic = await node.advertise("/diagnostics", DiagnosticArray, latch=True)
        await topic.publish(statuses(2, "no data"))
        page = await open_page(hub, "#/topics/%2Fdiagnostics", color_scheme="dark")
        counts = page.locator(".diagnostics-counts")
        await expect(counts).to_have_text("1 error · 1 warning · 0 stale · 1 OK")
        names = page.locator(".diagnostics-tree summary b")
        await expect(names).to_have_text(["robot", "Sensors", "laser", "camera", "Motors", "left"])
        laser = page.locator(".diagnostics-tree summary", has_text="no data")
        await expect(laser).to_contain_text("Error")
        await expect(page.get_by_text("hot <b>")).to_be_visible()

        await page.locator("summary", has_text="Motors").click()
        await page.locator("summary", has_text="left").click()
        facts = page.locator(".diagnostics-facts tr")
        await expect(facts.filter(visible=True)).to_have_text(["hardware idm1", "current1.5"])

        await page.locator("summary", has_text="Changes").click()
        await topic.publish(statuses(0, "back"))
        await expect(counts).to_have_text("0 errors · 1 warning · 0 stale · 2 OK")
        await expect(names).to_have_text(["robot", "Sensors", "camera", "laser", "Motors", "left"])
        await expect(page.locator(".diagnostics-changes li").first).to_contain_text(
            "/robot/Sensors/laser: Error \N{RIGHTWARDS ARROW} OK back"
        )
        await page.get_by_label("Filter diagnostics").fill("motors")
        await expect(names).to_have_text(["robot", "Motors", "left"])
