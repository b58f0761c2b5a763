"""The tree of frames on the page of /tf."""

from __future__ import annotations

import asyncio
import math
import re

from playwright.async_api import expect

import fibws
from fibws.hub.server import HubServer
from fibws.msg.geometry_msgs import Quaternion, Transform, TransformStamped, Vector3
from fibws.msg.std_msgs import Header
from fibws.msg.tf2_msgs import TFMessage

from .conftest import OpenPage

LEFT = Quaternion(z=math.sqrt(0.5), w=math.sqrt(0.5))
UPRIGHT = Quaternion(w=1)


def transform(
    parent: str, child: str, x: float, rotation: Quaternion = UPRIGHT
) -> TransformStamped:
    return TransformStamped(Header(frame_id=parent), child, Transform(Vector3(x, 0, 0), rotation))


async def test_frames_are_shown_as_a_tree_with_their_faults(
    hub: HubServer, open_page: OpenPage
) -> None:
    async with (
        fibws.Node("wheels", hub=hub.url) as wheels,
        fibws.Node("mount", hub=hub.url) as mount,
    ):
        static = await mount.advertise("/tf_static", TFMessage, latch=True)
        await static.publish(TFMessage([transform("base_link", "lidar", 0.5)]))
        moving = await wheels.advertise("/tf", TFMessage)
        wrong = False

        async def publish() -> None:
            async for _ in wheels.rate(20):
                base = transform("odom", "base_link", 2, LEFT)
                lost = transform("base_link", "arm", 0, Quaternion(w=0 if wrong else 1))
                await moving.publish(TFMessage([transform("map", "odom", 1), base, lost]))

        publishing = asyncio.create_task(publish())
        try:
            page = await open_page(hub, "#/topics/%2Ftf", color_scheme="dark")
            names = page.locator(".frames-tree button")
            await expect(names).to_have_text(["map", "odom", "base_link", "arm", "lidar"])
            counts = page.locator(".frames-counts")
            await expect(counts).to_have_text("5 frames · 1 tree · nothing wrong")
            rows = page.locator(".frames-tree li")
            await expect(rows.nth(4)).to_contain_text("static · /mount")
            await expect(rows.nth(3)).to_contain_text("/wheels")
            await expect(rows.nth(3)).to_contain_text(re.compile(r"[1-9].* Hz"))

            cells = page.locator(".frames-transform tr").first
            await expect(cells).to_have_text("x, y, z3.0000.0000.000m")
            await page.get_by_label("Where the frame is").select_option("lidar")
            await expect(cells).to_have_text("x, y, z3.0000.5000.000m")
            await expect(page.locator(".frames-transform tr").nth(1)).to_contain_text("90.0")
            await page.get_by_label("In the frame").select_option("base_link")
            await expect(cells).to_have_text("x, y, z0.5000.0000.000m")

            wrong = True
            await expect(page.locator(".frames-faults").nth(3)).to_have_text(
                "⚠ the quaternion has the length 0, not 1"
            )
            await expect(counts).to_contain_text("1 with a fault")
        finally:
            publishing.cancel()
