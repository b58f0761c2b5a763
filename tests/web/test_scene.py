"""The scene: what it draws at which pixels, its layers in words, and its tools."""

from __future__ import annotations

import asyncio
import json
import math
import os
import random
import re
import shutil
import struct
import subprocess
import time
from collections.abc import AsyncIterator
from pathlib import Path
from typing import Any, TypeAlias

import pytest
from playwright.async_api import FloatRect, Page, expect

import fibws
from fibws.hub.server import HubServer
from fibws.msg.geometry_msgs import (
    PointStamped,
    PoseStamped,
    PoseWithCovarianceStamped,
    Quaternion,
    Transform,
    TransformStamped,
    Vector3,
)
from fibws.msg.map_msgs import OccupancyGridUpdate
from fibws.msg.nav_msgs import MapMetaData, OccupancyGrid, Odometry
from fibws.msg.nav_msgs import Path as PathMessage
from fibws.msg.sensor_msgs import LaserScan, PointCloud2, PointField
from fibws.msg.std_msgs import Header
from fibws.msg.tf2_msgs import TFMessage
from fibws.tf import transform as tf_transform
from fibws.tf.buffer import Buffer
from fibws.tf.errors import TransformError
from fibws.tf.history import Sample

from .conftest import Complaints, OpenPage, fixture, until

WEB = Path(__file__).parents[2] / "web"
Color: TypeAlias = tuple[int, int, int]
Place: TypeAlias = tuple[float, float, float]
UPRIGHT = Quaternion(w=1.0)
RED, BLACK = (0xE5, 0x48, 0x4D), (0, 0, 0)
ORANGE, DARK = (0xE5, 0x93, 0x3B), (0x16, 0x1C, 0x23)
"""The colour of odometry, and the background of the dark theme."""
FOUND = """(canvas, color) => {
    const { width, height } = canvas;
    const copy = new OffscreenCanvas(width, height).getContext("2d", { willReadFrequently: true });
    copy.drawImage(canvas, 0, 0);
    const { data } = copy.getImageData(0, 0, width, height);
    const found = { count: 0, x: 0, y: 0, left: width, right: 0, top: height, bottom: 0 };
    for (let at = 0; at < data.length; at += 4) {
        if (color.some((each, band) => Math.abs(data[at + band] - each) > 8)) continue;
        const [x, y] = [(at / 4) % width, Math.floor(at / 4 / width)];
        found.count += 1;
        found.x += x + 0.5;
        found.y += y + 0.5;
        found.left = Math.min(found.left, x);
        found.right = Math.max(found.right, x + 1);
        found.top = Math.min(found.top, y);
        found.bottom = Math.max(found.bottom, y + 1);
    }
    found.x /= found.count;
    found.y /= found.count;
    return found;
}"""
"""Count the pixels of a colour, and find their middle and the box around them."""
COUNT_DRAWS = """
    window.draws = 0;
    window.durations = [];
    const { transferFromImageBitmap } = ImageBitmapRenderingContext.prototype;
    ImageBitmapRenderingContext.prototype.transferFromImageBitmap = function (bitmap) {
        window.draws += 1;
        return transferFromImageBitmap.call(this, bitmap);
    };
    const { requestAnimationFrame } = window;
    window.requestAnimationFrame = (callback) => requestAnimationFrame((now) => {
        const [before, start] = [window.draws, performance.now()];
        callback(now);
        if (window.draws > before) window.durations.push(performance.now() - start);
    });
"""
LARGE = """() => {
    const { style } = document.querySelector(".scene-stage");
    style.width = "1280px";
    style.height = "720px";
}"""
TURN = """async () => {
    durations.length = 0;
    const stage = document.querySelector(".scene-stage");
    while (durations.length < 8) {
        stage.dispatchEvent(new KeyboardEvent("keydown", { key: "ArrowLeft", bubbles: true }));
        await new Promise(requestAnimationFrame);
    }
    return durations;
}"""
"""Turn the camera until some pictures have been drawn; return how long each took, in ms."""
FRAME = """new Promise((done) => {
    const observer = new IntersectionObserver(() => { observer.disconnect(); done(); });
    observer.observe(document.body);
})"""
"""Wait until the browser has laid the page out, and its observers of sizes and places know that."""
HIDE = """
    window.hide = (hidden) => {
        Object.defineProperty(document, "hidden", { value: hidden, configurable: true });
        document.dispatchEvent(new Event("visibilitychange"));
    };
"""
KEEP_CONTEXT = """
    const { getContext } = OffscreenCanvas.prototype;
    OffscreenCanvas.prototype.getContext = function (kind, ...all) {
        const context = getContext.call(this, kind, ...all);
        if (kind === "webgl2") window.context = context;
        return context;
    };
"""
NO_WEBGL = """
    const { getContext } = OffscreenCanvas.prototype;
    OffscreenCanvas.prototype.getContext = function (kind, ...all) {
        return kind === "webgl2" ? null : getContext.call(this, kind, ...all);
    };
"""


@fixture
async def robot(hub: HubServer) -> AsyncIterator[fibws.Node]:
    async with fibws.Node("robot", hub=hub.url) as node:
        yield node


def stamped(parent: str, child: str, x: float, y: float, yaw: float = 0.0) -> TransformStamped:
    rotation = Quaternion(z=math.sin(yaw / 2), w=math.cos(yaw / 2))
    return TransformStamped(Header(frame_id=parent), child, Transform(Vector3(x, y, 0.0), rotation))


async def publish_frames(node: fibws.Node, *transforms: TransformStamped) -> None:
    static = await node.advertise("/tf_static", TFMessage, latch=True)
    await static.publish(TFMessage(list(transforms)))


def scan(frame: str, ranges: list[float]) -> LaserScan:
    """Return a scan whose rays are at 0, 90, 180 and 270 degrees."""
    return LaserScan(
        Header(frame_id=frame),
        angle_increment=math.pi / 2,
        range_min=0.1,
        range_max=20.0,
        ranges=ranges,
    )


def cloud(points: list[tuple[Place, Color]], frame: str = "lidar") -> PointCloud2:
    fields = [PointField(name, 4 * at, PointField.FLOAT32, 1) for at, name in enumerate("xyz")]
    fields.append(PointField("rgb", 12, PointField.FLOAT32, 1))
    data = b"".join(struct.pack("<fff4B", *place, b, g, r, 0) for place, (r, g, b) in points)
    count = len(points)
    return PointCloud2(Header(frame_id=frame), 1, count, fields, False, 16, 16 * count, data, True)


async def pixels(page: Page, color: Color) -> dict[str, float]:
    found: dict[str, float] = await page.locator(".scene-canvas").evaluate(FOUND, list(color))
    return found


async def shown(page: Page, color: Color, least: int = 1) -> dict[str, float]:
    """Wait until a colour is in the picture; return where."""
    canvas = f"({FOUND})(document.querySelector('.scene-canvas'), {list(color)}).count"
    await until(page, f"document.querySelector('.scene-canvas')?.width > 1 && {canvas} >= {least}")
    return await pixels(page, color)


async def state(page: Page, topic: str, text: str | re.Pattern[str]) -> None:
    """Wait until the state of a layer has a text."""
    row = page.locator(".scene-layer-list > li", has=page.get_by_text(topic, exact=True))
    await expect(row.locator(".scene-state")).to_contain_text(text)


async def box_of(page: Page) -> FloatRect:
    box = await page.locator(".scene-canvas").bounding_box()
    assert box is not None
    return box


@pytest.mark.smoke
async def test_return_of_a_scan_on_the_left_is_drawn_on_the_left(
    hub: HubServer, robot: fibws.Node, open_page: OpenPage
) -> None:
    # The robot looks along y of the map, and so does the camera behind it.
    await publish_frames(
        robot, stamped("map", "base_link", 3, 1, math.pi / 2), stamped("base_link", "laser", 0, 0)
    )
    topic = await robot.advertise("/scan", LaserScan, latch=True)
    await topic.publish(scan("/laser", [0.0, 2.0, math.inf, math.nan]))
    page = await open_page(hub, "#/topics/%2Fscan", width=1600)
    await state(page, "/scan", "1 points, nearest 2.00 m at 90°")
    await state(page, "/tf", "3 frames")
    await page.get_by_role("button", name="Settings of /scan").click()
    await page.get_by_label("Point size (px)").fill("9")
    found = await shown(page, RED, 81)
    middle = (await box_of(page))["width"] / 2
    assert found["count"] == 81
    assert found["x"] < middle - 40
    # Seen from the right angle: 2 m to the left of the robot, which is below the middle.
    await page.get_by_role("group", name="Scene").focus()
    await page.keyboard.press("1")
    await until(page, "document.querySelector('.scene-modes .on').textContent === '2D'")
    await page.get_by_text("As text").click()
    await expect(page.locator(".scene-text li")).to_contain_text(
        ["Fixed frame: map", "base_link: x 3.00, y 1.00 m, 90°", "/scan: 1 points", "/tf: 3 frames"]
    )
    await expect(page.locator(".scene-labels span")).to_have_text(["base_link", "laser", "map"])


def corners() -> list[tuple[Place, Color]]:
    """Return eight corners of a box, each in a colour of its own."""
    found = []
    for number in range(8):
        x, y, z = (float(number >> bit & 1) for bit in range(3))
        bands = (int(55 + 200 * x), int(55 + 200 * y), int(55 + 200 * z))
        # No two are alike, and none is the colour of the page.
        found.append(((4 * x - 2, 2 * y - 1, z), bands))
    return found


def projected(place: Place, width: float, height: float) -> tuple[float, float]:
    """Project a place as a camera that shows all corners, from behind and 45 degrees above."""
    radius = math.hypot(4, 2, 1) / 2
    slope = math.tan(math.pi / 8)
    distance = radius / (slope * min(1, width / height))
    x, y, z = place[0], place[1], place[2] - 0.5
    ahead, up = (x - z) * math.sqrt(0.5), (x + z) * math.sqrt(0.5)
    scale = height / 2 / slope / (distance + ahead)
    return width / 2 - y * scale, height / 2 - up * scale


async def test_corners_of_a_cloud_are_at_known_pixels(
    hub: HubServer, robot: fibws.Node, open_page: OpenPage
) -> None:
    topic = await robot.advertise("/points", PointCloud2, latch=True)
    await topic.publish(cloud(corners()))
    # Nothing publishes tf: the frame of the cloud is the fixed one.
    page = await open_page(hub, "#/topics/%2Fpoints", color_scheme="dark", width=1600)
    await state(page, "/points", "8 points, coloured by rgb")
    await page.get_by_role("button", name="Settings of /points").click()
    await page.get_by_label("Point size (px)").fill("5")
    await page.get_by_title("Show all (0)").click()
    box = await box_of(page)
    for place, color in corners():
        found = await shown(page, color, 25)
        x, y = projected(place, box["width"], box["height"])
        assert abs(found["x"] - x) < 2 and abs(found["y"] - y) < 2, (place, found, x, y)
    # The pointer on a corner shows what is there.
    x, y = projected((2.0, 1.0, 1.0), box["width"], box["height"])
    await page.mouse.move(box["x"] + x, box["y"] + y)
    await expect(page.locator(".scene-hover")).to_have_text(
        "/points: point 7 · 2.00, 1.00, 1.00 m in lidar"
    )
    await page.mouse.click(box["x"] + x, box["y"] + y)
    status = page.locator(".scene-tool-status")
    await expect(status).to_contain_text("/points: point 7 · 2.00, 1.00, 1.00 m in lidar")
    await expect(status.get_by_role("link")).to_have_attribute("href", "#/topics/%2Fpoints")
    # A limit of the values, a field that is missing, and data that ends early.
    await page.locator(".scene-settings select").first.select_option("field")
    await state(page, "/points", "no field intensity: there are x, y, z, rgb")
    short = cloud(corners())
    short.data = short.data[:40]
    await topic.publish(short)
    await page.locator(".scene-settings select").first.select_option("auto")
    await state(
        page, "/points", "the data has 40 bytes, but 8 \N{MULTIPLICATION SIGN} 1 points take 128"
    )


async def test_map_has_its_first_row_below_and_takes_updates(
    hub: HubServer, robot: fibws.Node, open_page: OpenPage
) -> None:
    topic = await robot.advertise("/map", OccupancyGrid, latch=True)
    updates = await robot.advertise("/map_updates", OccupancyGridUpdate, peers=True)
    info = MapMetaData(resolution=0.5, width=4, height=3)
    info.origin.orientation.w = 1.0
    # The only occupied cell is at the top left.
    await topic.publish(OccupancyGrid(Header(frame_id="map"), info, [0] * 8 + [100, 0, 0, 0]))
    page = await open_page(hub, "#/topics/%2Fmap", color_scheme="dark", width=1600)
    await state(page, "/map", "4 \N{MULTIPLICATION SIGN} 3 cells of 0.5 m")
    await page.get_by_role("button", name="Settings of /map").click()
    await page.get_by_label("Opacity").fill("1")
    await page.get_by_role("button", name="2D").click()
    await page.get_by_title("Show all (0)").click()
    black = await shown(page, BLACK, 50)
    white = await shown(page, (255, 255, 255), 500)
    cell = (white["right"] - white["left"]) / 4
    assert (black["left"], black["top"]) == (white["left"], white["top"])
    assert abs(black["right"] - black["left"] - cell) < 2
    assert abs(black["bottom"] - black["top"] - cell) < 2
    # Two cells at the lower right become occupied.
    async with asyncio.timeout(60):
        async for subscribers in updates.peers.changes():
            if subscribers:
                break
    update = OccupancyGridUpdate(Header(frame_id="map"), 2, 0, 2, 1, [100, 100])
    await updates.publish(update)
    after = await shown(page, BLACK, int(2.5 * black["count"]))
    assert (after["right"], after["bottom"]) == (white["right"], white["bottom"])
    update.x = 3
    await updates.publish(update)
    await state(
        page, "/map", "an update of 2 \N{MULTIPLICATION SIGN} 1 cells at 3, 0 is outside of the map"
    )


async def test_layers_say_what_is_wrong(
    hub: HubServer, robot: fibws.Node, open_page: OpenPage
) -> None:
    await publish_frames(
        robot, stamped("map", "base_link", 0, 0), stamped("base_link", "lidar", 0, 0)
    )
    topic = await robot.advertise("/scan", LaserScan, latch=True)
    path = await robot.advertise("/path", PathMessage, latch=True)
    page = await open_page(hub, "#/topics/%2Fscan", width=1600)
    await state(page, "/scan", "waiting for the first message")
    await topic.publish(scan("lidar_1", [1.0] * 4))
    await state(page, "/scan", "frame lidar_1 is not in the tree: did you mean lidar?")
    await topic.publish(scan("lidar", [1.0] * 4))
    await state(page, "/scan", "4 points, nearest 1.00 m at 0°")
    await topic.publish(scan("", [1.0] * 4))
    await state(page, "/scan", "no frame_id: shown in map")
    # Of a frame that moves, tf may not have the message's time.
    moving = await robot.advertise("/tf", TFMessage)
    late = scan("arm", [1.0] * 4)
    late.header.stamp = fibws.Time(105)
    await topic.publish(late)
    await state(page, "/scan", "frame arm is not in the tree")
    arm = stamped("base_link", "arm", 1, 0)
    arm.header.stamp = fibws.Time(100)
    await moving.publish(TFMessage([arm]))
    await state(page, "/scan", "tf is 5.0 s from the message's time")
    arm.header.stamp = fibws.Time(106)
    await moving.publish(TFMessage([arm]))
    await state(page, "/scan", "4 points, nearest 1.00 m at 0°")
    # A layer that is not ticked has no state, and no subscription.
    box = page.get_by_role("checkbox", name="/path")
    await expect(box).not_to_be_checked()
    await box.check()
    await state(page, "/path", "waiting for the first message")
    await path.publish(PathMessage(Header(frame_id="map"), [PoseStamped(), PoseStamped()]))
    await state(page, "/path", "2 poses, 0.0 m")
    await page.get_by_role("checkbox", name="/scan").uncheck()
    row = page.locator(".scene-layer-list > li", has=page.get_by_text("/scan", exact=True))
    await expect(row).to_have_attribute("data-level", "off")


async def test_tools_publish_where_they_are_used(
    hub: HubServer, robot: fibws.Node, open_page: OpenPage
) -> None:
    await publish_frames(robot, stamped("map", "base_link", 0, 0))
    goals = robot.subscribe("/move_base_simple/goal", PoseStamped)
    estimates = robot.subscribe("/initialpose", PoseWithCovarianceStamped)
    points = robot.subscribe("/clicked_point", PointStamped)
    odometry = await robot.advertise("/odom", Odometry, latch=True)
    message = Odometry(Header(frame_id="map"), "base_link")
    message.pose.pose.orientation.w = 1.0
    message.pose.covariance = [0.1 if at in (0, 7, 35) else 0.0 for at in range(36)]
    await odometry.publish(message)
    page = await open_page(hub, "#/topics/%2Fodom", width=1600)
    await state(page, "/odom", "x 0.00, y 0.00 m, 0°, 0.00 m/s")
    await page.get_by_role("button", name="2D").click()
    hover = page.locator(".scene-hover")
    box = await box_of(page)
    x, y = box["x"] + 0.7 * box["width"], box["y"] + 0.3 * box["height"]

    async def place_at(x: float, y: float) -> Place:
        # The text is that of the last picture: nothing of another place may be left of it.
        await page.mouse.move(0, 0)
        await expect(hover).to_have_text("")
        await page.mouse.move(x, y)
        await expect(hover).to_contain_text("m in map")
        numbers = (await hover.inner_text()).split("·")[-1].split(" m in")[0].split(",")
        a, b, c = (float(number) for number in numbers)
        return a, b, c

    place = await place_at(x, y)

    async def drag() -> None:
        await page.mouse.move(x, y)
        await page.mouse.down()
        await page.mouse.move(x - 20, y - 20, steps=3)
        await page.mouse.move(x - 40, y - 40)
        await page.mouse.up()

    await page.get_by_role("button", name="Goal", exact=True).click()
    await drag()
    async with asyncio.timeout(60):
        goal = await anext(aiter(goals))
    assert goal.header.frame_id == "map" and goal.header.stamp.secs > 0
    position, orientation = goal.pose.position, goal.pose.orientation
    assert math.dist((position.x, position.y, position.z), place) < 0.05
    # To the upper left, on a picture with x to the right.
    yaw = 2 * math.degrees(math.atan2(orientation.z, orientation.w))
    assert abs(yaw - 135) < 2
    status = page.locator(".scene-tool-status")
    await expect(status).to_contain_text("sent to /move_base_simple/goal: x ")
    await expect(page.locator(".scene-tool-bar")).to_be_hidden()

    stage = page.get_by_role("group", name="Scene")
    await stage.focus()
    await page.keyboard.press("p")
    await drag()
    async with asyncio.timeout(60):
        estimate = await anext(aiter(estimates))
    assert abs(estimate.pose.pose.position.x - place[0]) < 0.05
    covariance = estimate.pose.covariance
    assert [covariance[at] for at in (0, 7)] == [0.25, 0.25] and 0.06 < covariance[35] < 0.07

    # By keys: the mark is in the middle, and moves with the arrows.
    await stage.focus()
    await page.keyboard.press("g")
    await page.keyboard.press("ArrowRight")
    await page.keyboard.press("Shift+ArrowLeft")
    await page.keyboard.press("Escape")
    await page.keyboard.press("u")
    await page.keyboard.press("ArrowRight")
    await page.keyboard.press("Enter")
    async with asyncio.timeout(60):
        point = await anext(aiter(points))
    assert point.point.x > 0.01 and abs(point.point.y) < 0.01

    await page.keyboard.press("m")
    await page.mouse.move(x, y)
    await page.mouse.down()
    await page.mouse.move(x, y + 50, steps=2)
    await page.mouse.up()
    other = await place_at(x, y + 50)
    length = math.dist(place, other)
    label = page.locator(".scene-labels span", has_text=" m (x ")

    async def expect_length() -> None:
        await expect(status).to_contain_text(" m (x ")
        text = await status.inner_text()
        assert abs(float(text.split(" m")[0]) - length) < 0.05
        # The label is that of the line to the pointer until the next picture.
        await expect(label).to_have_text(text)

    await expect_length()
    await stage.focus()
    await page.keyboard.press("Escape")
    await expect(label).to_have_count(0)
    await expect(status).to_have_text("")
    measure = page.get_by_role("button", name="Measure")
    await measure.click()
    # Two clicks measure, too; the line is drawn to the pointer before the second one.
    await page.mouse.click(x, y)
    await page.mouse.move(x, y + 20)
    await expect(label).to_have_count(1)
    await expect(status).to_have_text("")
    await page.mouse.click(x, y + 50)
    await expect_length()
    await measure.click()
    await expect(label).to_have_count(0)


async def open_dashboard(hub: HubServer, open_page: OpenPage, *views: str, **context: Any) -> Page:
    """Open the dashboard with some views that need no topic, side by side."""
    page = await open_page(hub, "#/dashboard", **context)
    items = [{"view": view, "name": ""} for view in views]
    layout = {"schema": 1, "layout": {"split": "row", "items": items}}
    await page.get_by_label("File with a layout").set_input_files(
        {
            "name": "views.json",
            "mimeType": "application/json",
            "buffer": json.dumps(layout).encode(),
        }
    )
    await expect(page.locator(".pane")).to_have_count(len(views))
    return page


async def test_scene_has_the_theme_that_changed_while_it_was_covered(
    hub: HubServer, robot: fibws.Node, open_page: OpenPage
) -> None:
    await publish_frames(robot, stamped("map", "base_link", 0, 0))
    page = await open_dashboard(hub, open_page, "scene", "console", color_scheme="light")
    await shown(page, (255, 255, 255), 1000)
    large = page.locator(".pane-console").get_by_role("button", name="Maximize")
    await large.click()
    await expect(page.locator(".pane-3d")).to_be_hidden()
    await page.emulate_media(color_scheme="dark")
    await large.click()
    await shown(page, DARK, 1000)


async def test_followed_robot_is_in_the_middle_at_once_and_after_a_reload(
    hub: HubServer, robot: fibws.Node, open_page: OpenPage
) -> None:
    await publish_frames(robot, stamped("map", "base_link", 3, 1, math.pi / 2))
    topic = await robot.advertise("/scan", LaserScan, latch=True)
    await topic.publish(scan("base_link", [1.0] * 4))
    page = await open_dashboard(hub, open_page, "scene", "console", width=1600)
    # The returns are all around the robot.
    await shown(page, RED, 20)

    async def off_the_middle() -> float:
        return (await pixels(page, RED))["x"] - (await box_of(page))["width"] / 2

    async def centered() -> None:
        async with asyncio.timeout(60):
            while abs(await off_the_middle()) > 3:
                await page.evaluate("new Promise(requestAnimationFrame)")

    async def move_aside() -> None:
        await page.get_by_role("group", name="Scene").focus()
        await page.keyboard.press("ArrowRight")
        async with asyncio.timeout(60):
            while abs(await off_the_middle()) < 10:
                await page.evaluate("new Promise(requestAnimationFrame)")

    await page.get_by_role("group", name="Scene").focus()
    await page.keyboard.press("1")
    await move_aside()
    follow = page.get_by_label("Follow the robot")
    await follow.select_option("position")
    await centered()
    await move_aside()
    await page.reload()
    await expect(follow).to_have_value("position")
    await shown(page, RED, 20)
    await centered()


async def test_list_of_layers_is_hidden_by_its_button_and_stays_so(
    hub: HubServer, robot: fibws.Node, open_page: OpenPage
) -> None:
    await publish_frames(robot, stamped("map", "base_link", 0, 0))
    page = await open_dashboard(hub, open_page, "scene", "console", width=1600)
    layers, listed = page.get_by_role("button", name="Layers"), page.locator(".scene-layers")
    await expect(layers).to_have_attribute("aria-expanded", "true")
    before = (await box_of(page))["width"]
    await layers.click()
    await expect(listed).to_be_hidden()
    await expect(layers).to_have_attribute("aria-expanded", "false")
    assert (await box_of(page))["width"] > before + 100
    await page.reload()
    await expect(page.locator(".scene-stage")).to_be_visible()
    await expect(listed).to_be_hidden()
    # Where there is less room it is a drawer, which is closed at first.
    await page.set_viewport_size({"width": 900, "height": 800})
    await layers.click()
    await expect(listed).to_be_visible()
    await expect(layers).to_have_attribute("aria-expanded", "true")
    await layers.click()
    await expect(listed).to_be_hidden()


@pytest.mark.parametrize("cut", ["no messages", "stamps go back"])
async def test_trail_is_not_joined_across_a_cut(
    hub: HubServer, robot: fibws.Node, open_page: OpenPage, cut: str
) -> None:
    odometry = await robot.advertise("/odom", Odometry, peers=True)
    changes = odometry.peers.changes()

    async def subscribed(wanted: bool) -> None:
        async with asyncio.timeout(60):
            async for names in changes:
                if bool(names) == wanted:
                    return

    async def move_to(x: float, y: float, stamp: int) -> None:
        message = Odometry(Header(stamp=fibws.Time(stamp), frame_id="map"), "base_link")
        position, message.pose.pose.orientation.w = message.pose.pose.position, 1.0
        position.x, position.y = x, y
        await odometry.publish(message)
        await state(page, "/odom", f"x {x:.2f}, y {y:.2f} m")

    page = await open_page(hub, "#/topics/%2Fodom", width=1600, color_scheme="dark")
    await subscribed(True)
    await move_to(0, 0, 20)
    await page.get_by_role("button", name="Settings of /odom").click()
    await page.get_by_label("Size (m)").fill("0.01")
    await page.get_by_role("group", name="Scene").focus()
    await page.keyboard.press("1")
    await move_to(0, 0.4, 21)
    # The trail is not opaque: its colour is between that of the setting and the background.
    red, green, blue = (round(0.7 * a + 0.3 * b) for a, b in zip(ORANGE, DARK, strict=True))
    trail = red, green, blue
    before = await shown(page, trail, 50)
    assert before["right"] - before["left"] < 10
    heading = page.locator("details.section", has_text="3D").locator("summary").first
    for wanted in (False, True) if cut == "no messages" else ():
        await heading.click()
        await subscribed(wanted)
    later = 22 if cut == "no messages" else 1
    await move_to(0.3, 0.4, later)
    await move_to(0.3, 0, later + 1)
    canvas = f"({FOUND})(document.querySelector('.scene-canvas'), {list(trail)})"
    await until(page, f"{canvas}.left > {before['right']}")
    after = await shown(page, trail, 50)
    assert after["right"] - after["left"] < 10


async def test_goal_says_its_age_without_a_new_picture(
    hub: HubServer, robot: fibws.Node, open_page: OpenPage
) -> None:
    topic = await robot.advertise("/goal", PoseStamped, latch=True)
    goal = PoseStamped(Header(frame_id="map", stamp=fibws.Time(100)))
    goal.pose.orientation.w = 1.0
    page = await open_page(hub, "#/topics/%2Fgoal", width=1600, has_clock=True, prepare=COUNT_DRAWS)
    now = time.time()
    await page.clock.set_fixed_time(now)
    await topic.publish(goal)
    await state(page, "/goal", "x 0.00, y 0.00 m, 0°")
    before = await at_rest(page)
    await page.clock.set_fixed_time(now + 40)
    await state(page, "/goal", "0°, 40 s ago")
    assert await at_rest(page) == before
    # It is latched, so it comes again, and is as old as before.
    heading = page.locator("details.section", has_text="3D").locator("summary").first
    for _ in range(2):
        await heading.click()
    await state(page, "/goal", "0°, 40 s ago")
    goal.header.stamp = fibws.Time(101)
    goal.pose.position.x = 1.0
    await topic.publish(goal)
    await state(page, "/goal", re.compile("x 1.00, y 0.00 m, 0°$"))


async def test_escape_ends_a_tool_before_the_large_panel(
    hub: HubServer, robot: fibws.Node, open_page: OpenPage
) -> None:
    await publish_frames(robot, stamped("map", "base_link", 0, 0))
    page = await open_dashboard(hub, open_page, "scene", "console")
    await page.locator(".pane-3d").get_by_role("button", name="Maximize").click()
    goal = page.get_by_role("button", name="Goal", exact=True)
    for focused in (goal, page.get_by_label("Topic of the tool")):
        await goal.click()
        await focused.focus()
        await page.keyboard.press("Escape")
        await expect(goal).to_have_attribute("aria-pressed", "false")
        await expect(page.locator(".pane-console")).to_be_hidden()
    await page.keyboard.press("Escape")
    await expect(page.locator(".pane-console")).to_be_visible()


async def test_finger_sends_a_goal_by_a_button(
    hub: HubServer, robot: fibws.Node, open_page: OpenPage
) -> None:
    await publish_frames(robot, stamped("map", "base_link", 0, 0))
    goals = robot.subscribe("/goal", PoseStamped)
    page = await open_page(
        hub, "#/topics/%2Ftf_static", width=390, height=844, has_touch=True, is_mobile=True
    )
    await page.get_by_role("button", name="2D").tap()
    await page.get_by_role("button", name="Goal", exact=True).tap()
    topic = page.get_by_label("Topic of the tool")
    await topic.fill("/goal")
    await topic.blur()
    canvas = page.locator(".scene-canvas")
    await canvas.scroll_into_view_if_needed()
    send = page.get_by_role("button", name="Send", exact=True)
    box = await box_of(page)
    at = {"x": box["width"] / 2, "y": box["height"] / 2}
    await canvas.tap(position={"x": at["x"], "y": at["y"]})
    await expect(send).to_be_visible()
    await page.get_by_role("button", name="Cancel").tap()
    await expect(send).to_be_hidden()
    await page.get_by_role("button", name="Goal", exact=True).tap()
    await canvas.tap(position={"x": at["x"] + 60, "y": at["y"]})
    await send.tap()
    async with asyncio.timeout(60):
        goal = await anext(aiter(goals))
    # The canceled one was in the middle.
    assert goal.pose.position.x > 0.1
    await page.get_by_role("button", name="Layers").tap()
    await expect(page.get_by_role("checkbox", name="/tf")).to_be_visible()


async def at_rest(page: Page) -> int:
    """Wait until nothing is drawn in a second of the page's time; return how many pictures were."""
    before, after = -1, 0
    async with asyncio.timeout(60):
        while after != before:
            before = after
            await page.evaluate(FRAME)
            await page.clock.run_for(1000)
            after = await page.evaluate("draws")
    return after


async def test_nothing_is_drawn_at_rest_and_when_hidden(
    hub: HubServer, robot: fibws.Node, open_page: OpenPage
) -> None:
    topic = await robot.advertise("/scan", LaserScan, latch=True, peers=True)
    changes = topic.peers.changes()

    async def subscribed(wanted: bool) -> None:
        async with asyncio.timeout(60):
            async for names in changes:
                if bool(names) == wanted:
                    return

    await topic.publish(scan("laser", [1.0] * 4))
    page = await open_page(hub, "#/topics/%2Fscan", has_clock=True, prepare=COUNT_DRAWS + HIDE)
    await shown(page, RED)
    await subscribed(True)
    before = await at_rest(page)
    await topic.publish(scan("laser", [2.0] * 4))
    await until(page, f"draws > {before}")
    # A hidden tab ends its subscriptions after a while.
    await page.evaluate("hide(true)")
    await page.clock.run_for(10_000)
    await subscribed(False)
    await page.evaluate("hide(false)")
    await subscribed(True)
    # Nor is it drawn while it is scrolled away.
    await page.evaluate("document.querySelector('.scene').style.marginTop = '3000px'")
    before = await at_rest(page)
    await topic.publish(scan("laser", [2.5] * 4))
    await state(page, "/scan", "nearest 2.50 m")
    assert await at_rest(page) == before
    await page.evaluate("document.querySelector('.scene').style.marginTop = ''")
    await until(page, f"draws > {before}")
    await page.locator("details.section", has_text="3D").locator("summary").first.click()
    await subscribed(False)
    before = await at_rest(page)
    await topic.publish(scan("laser", [3.0] * 4))
    # Something that the hub sends later has come.
    async with fibws.Node("other", hub=hub.url) as other:
        await other.advertise("/scan", LaserScan)
        await expect(page.locator(".topic-flow")).to_contain_text("2 publishers")
    assert await at_rest(page) == before
    await page.locator("details.section", has_text="3D").locator("summary").first.click()
    await state(page, "/scan", "nearest 3.00 m")


async def test_picture_survives_the_loss_of_its_context(
    hub: HubServer, robot: fibws.Node, open_page: OpenPage, complaints: Complaints
) -> None:
    topic = await robot.advertise("/scan", LaserScan, latch=True)
    await topic.publish(scan("laser", [1.0] * 4))
    page = await open_page(hub, "#/topics/%2Fscan", prepare=KEEP_CONTEXT)
    await shown(page, RED)
    await page.evaluate("lost = context.getExtension('WEBGL_lose_context'); lost.loseContext()")
    error = page.locator(".scene > .error")
    await expect(error).to_contain_text("The graphics card was lost")
    await page.evaluate("lost.restoreContext()")
    await expect(error).to_be_hidden()
    await page.get_by_role("button", name="2D").click()
    await shown(page, RED)
    complaints.allow("CONTEXT_LOST_WEBGL")


async def test_without_webgl_the_scene_is_text(
    hub: HubServer, robot: fibws.Node, open_page: OpenPage
) -> None:
    topic = await robot.advertise("/scan", LaserScan, latch=True)
    await topic.publish(scan("laser", [1.0] * 4))
    page = await open_page(hub, "#/topics/%2Fscan", prepare=NO_WEBGL)
    await expect(page.locator(".scene > .error")).to_contain_text("This browser has no WebGL 2")
    await expect(page.locator(".scene-text")).to_contain_text("/scan: 4 points, nearest 1.00 m")


# It measures milliseconds, which are those of an idle machine only.
@pytest.mark.slow
@pytest.mark.parametrize(("count", "limit"), [(20_000, 60), (300_000, 80)])
async def test_picture_of_a_cloud_is_drawn_in_time(
    hub: HubServer, robot: fibws.Node, open_page: OpenPage, count: int, limit: float
) -> None:
    """Twice the figures for two cores without a graphics card; one picture must be fast enough."""
    await publish_frames(robot, stamped("map", "base_link", 0, 0))
    grid = await robot.advertise("/map", OccupancyGrid, latch=True)
    info = MapMetaData(resolution=0.05, width=1000, height=1000)
    info.origin.orientation.w = 1.0
    await grid.publish(OccupancyGrid(Header(frame_id="map"), info, [0] * 1_000_000))
    topic = await robot.advertise("/points", PointCloud2, latch=True)
    made = random.Random(1)
    places = [(made.uniform(-5, 5), made.uniform(-5, 5), made.random()) for _ in range(1000)]
    some = cloud([(place, (200, 100, 50)) for place in places], "base_link")
    some.data, some.width, some.row_step = some.data * (count // 1000), count, 16 * count
    await topic.publish(some)
    page = await open_page(hub, "#/topics/%2Fpoints", width=2000, height=1000, prepare=COUNT_DRAWS)
    await state(page, "/points", f"{count:,} points")
    if count > 100_000:
        await state(page, "/points", "every 3rd shown")
    await state(page, "/map", "1000 \N{MULTIPLICATION SIGN} 1000 cells")
    await page.evaluate(LARGE)
    await until(page, "document.querySelector('.scene-canvas').width === 1280")
    durations = await page.evaluate(TURN)
    assert min(durations) < limit, durations


def cases(seed: int) -> dict[str, Any]:
    """Make up a tree of moving and static frames, and what `fibws.tf` answers about it."""
    made = random.Random(seed)
    buffer = Buffer()
    transforms = []
    names = ["root"]
    for number in range(8):
        parent, child = made.choice(names), f"frame_{number}"
        names.append(child)
        is_static = made.random() < 0.3
        for secs in [0] if is_static else sorted(made.sample(range(100, 108), 5)):
            turn = [made.uniform(-1, 1) for _ in range(4)]
            length = math.hypot(*turn)
            x, y, z, w = (each / length for each in turn)
            place = [made.uniform(-5, 5) for _ in range(3)]
            transform = tf_transform.Transform((place[0], place[1], place[2]), (x, y, z, w))
            buffer.insert(child, Sample(secs * 10**9, parent, transform), static=is_static)
            rotation = dict(zip("xyzw", (x, y, z, w), strict=True))
            message = {
                "header": {"stamp": {"secs": secs, "nsecs": 0}, "frame_id": parent},
                "child_frame_id": child,
                "transform": {
                    "translation": dict(zip("xyz", place, strict=True)),
                    "rotation": rotation,
                },
            }
            transforms.append({"message": message, "isStatic": is_static})
    lookups: list[dict[str, Any]] = []
    while len(lookups) < 20:
        target, source = made.sample(names, 2)
        millis = made.randrange(100_000, 108_000)
        try:
            found = buffer.lookup(target, source, millis * 10**6).transform
        except TransformError:
            continue
        answer = {
            "translation": dict(zip("xyz", found.translation, strict=True)),
            "rotation": dict(zip("xyzw", found.rotation, strict=True)),
        }
        lookups.append({"target": target, "source": source, "stamp": millis, "transform": answer})
    return {"transforms": transforms, "lookups": lookups}


@pytest.mark.skipif(
    not (os.environ.get("CI") or (WEB / "node_modules").is_dir()) or shutil.which("npx") is None,
    reason="needs npm ci, in web/",
)
def test_scene_looks_transforms_up_as_tf_does(tmp_path: Path) -> None:
    module = tmp_path / "cases.mjs"
    module.write_text(f"export const cases = {json.dumps([cases(seed) for seed in range(10)])};")
    done = subprocess.run(
        ["npx", "--no-install", "vitest", "run", "src/panels/scene/tf_buffer.test.ts"],
        cwd=WEB,
        env={**os.environ, "VITE_TF_CASES": str(module), "NO_COLOR": "1"},
        capture_output=True,
        text=True,
        timeout=120,
    )
    assert done.returncode == 0, done.stdout + done.stderr
    assert "(17 tests)" in done.stdout
