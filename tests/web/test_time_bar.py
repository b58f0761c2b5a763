"""The time bar: all panels stop, go back, and return to what comes now."""

from __future__ import annotations

import json
import re
from typing import Any

from playwright.async_api import Page, expect

import fibws
from fibws.hub import Hub
from fibws.msg.geometry_msgs import PoseStamped, Transform, TransformStamped
from fibws.msg.nav_msgs import MapMetaData, OccupancyGrid, Path
from fibws.msg.sensor_msgs import Image
from fibws.msg.std_msgs import Header, Int32, String
from fibws.msg.tf2_msgs import TFMessage

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


LAYER = {"topic": "/path", "type": "nav_msgs/Path", "kind": "path", "settings": {}}
LAYOUT = {
    "schema": 1,
    "layout": {
        "split": "row",
        "items": [
            {"view": "image", "name": "/camera"},
            {"view": "map", "name": "/map"},
            {"view": "transforms", "name": "/tf"},
            {"view": "3d", "name": "", "config": {"layers": [LAYER]}},
        ],
    },
}


async def publish_scene(publishers: list[fibws.Publisher[Any]], size: int) -> None:
    """Publish an image, a map, a path and a frame, all of a size."""
    images, maps, paths, frames = publishers
    data = bytes(3 * size * size)
    await images.publish(height=size, width=size, encoding="rgb8", step=3 * size, data=data)
    grid = MapMetaData(resolution=0.1, width=size, height=size)
    await maps.publish(header=Header(frame_id="map"), info=grid, data=[0] * size * size)
    poses = [PoseStamped(header=Header(frame_id="map"))] * size
    await paths.publish(header=Header(frame_id="map"), poses=poses)
    child = TransformStamped(
        header=Header(frame_id="map"), child_frame_id=f"robot_{size}", transform=Transform()
    )
    child.transform.rotation.w = 1.0
    await frames.publish(transforms=[child])


async def test_images_maps_frames_and_scenes_go_back(open_page: OpenPage, hub: Hub) -> None:
    async with fibws.Node("robot", hub=hub.url) as robot:
        kinds: dict[str, Any] = {
            "/camera": Image,
            "/map": OccupancyGrid,
            "/path": Path,
            "/tf": TFMessage,
        }
        publishers = [await robot.advertise(name, kind, latch=True) for name, kind in kinds.items()]
        await publish_scene(publishers, 2)
        page = await open_page(hub, "#/dashboard", width=2400)
        file: Any = {
            "name": "a.json",
            "mimeType": "application/json",
            "buffer": json.dumps(LAYOUT).encode(),
        }
        await page.get_by_label("File with a layout").set_input_files(file)

        async def expect_size(size: int) -> None:
            for view in ("image", "map"):
                facts = page.locator(f".pane-{view} .image-facts")
                await expect(facts).to_contain_text(f"{size} \N{MULTIPLICATION SIGN} {size}")
            await expect(page.locator(".pane-transforms")).to_contain_text(f"robot_{size}")
            layer = page.locator(".pane-3d .scene-layer-list li").filter(has_text="/path")
            await expect(layer).to_contain_text(f"{size} poses")

        await expect_size(2)
        await publish_scene(publishers, 5)
        await expect_size(5)
        bar = page.locator("#timebar")
        await bar.get_by_role("button", name="Pause all").click()
        await bar.get_by_label("Topic of the steps").select_option("/camera")
        now = await bar.locator("output").inner_text()
        await bar.get_by_role("button", name="Previous message").click()
        await expect(bar.locator("output")).not_to_have_text(now)
        # The second set began with its image.
        await bar.get_by_role("button", name="Previous message").click()
        await expect_size(2)
        await expect(page.locator(".pane-transforms")).not_to_contain_text("robot_5")
        await bar.get_by_role("button", name="Live").click()
        await expect_size(5)
