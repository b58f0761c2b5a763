"""Take the pictures of the hub's page in docs/images: python docs/take_pictures.py [NAME ...]

It needs Chromium, and ``pip install 'fibws[test]'``. Hubs and nodes are those of this checkout.
"""

from __future__ import annotations

import asyncio
import io
import math
import shutil
import sys
from collections.abc import AsyncIterator, Awaitable, Callable
from contextlib import asynccontextmanager
from pathlib import Path

from PIL import Image
from playwright.async_api import Browser, Page, async_playwright

import fibws
from fibws.action.move_base_msgs import MoveBase
from fibws.msg.geometry_msgs import Point, Pose, PoseStamped, Quaternion
from fibws.msg.move_base_msgs import MoveBaseGoal
from fibws.msg.nav_msgs import Odometry
from fibws.msg.std_msgs import Header
from fibws.programs.broadcaster import broadcast
from fibws.programs.demo_robot import robot_node
from fibws.programs.listener import listen
from fibws.programs.turtlesim.turtlesim_node import simulate
from fibws.srv.turtlesim import Kill, SetPen, Spawn, TeleportAbsolute

FOLDER = Path(__file__).parent / "images"
WIDTH = 1280
LARGEST = 150_000
"""Bytes of a picture."""
COLORS = 256
TYPE = "std_msgs/Int32"
SHOWN = "localhost:9090"
"""The hub's address as the page shows it; Chromium maps it to the hub."""

Show = Callable[..., Awaitable[Page]]


async def page(show: Show, url: str) -> Page:
    """The graph of the first steps."""
    async with (
        fibws.Node("fibonacci_broadcaster", hub=url, rosout=False) as broadcaster,
        fibws.Node("fibonacci_listener", hub=url, rosout=False) as first,
        fibws.Node("second_listener", hub=url, rosout=False) as second,
        _running(broadcast(broadcaster, TYPE, 1, "restart"), listen(first, TYPE)),
        _running(listen(second, TYPE)),
    ):
        shown = await show("#/graph", height=570)
        await shown.get_by_text("1.0 Hz").nth(2).wait_for()
        return await _taken(shown, "page")


async def topics(show: Show, url: str) -> Page:
    """The camera beside the list of the robot's topics, and a plot."""
    async with fibws.Node("robot", hub=url) as robot, _running(robot_node.simulate(robot)):
        goal = await _sent(robot, 6.1, 3.4)
        shown = await show("#/topics/%2Fodom", height=800)
        for field in ("pose.pose.position.x", "twist.twist.linear.x"):
            await shown.get_by_label("Field").fill(field)
            await shown.get_by_role("button", name="Plot", exact=True).click()
        await shown.get_by_text("/camera/image", exact=True).first.click()
        await shown.get_by_label("Plot", exact=True).get_by_text("Plot", exact=True).click()
        await _driven(robot, 3.5)
        await goal.cancel()
        return await _taken(shown, "topics")


async def dashboard(show: Show, url: str) -> Page:
    """The dashboard, with the robot on its way."""
    async with fibws.Node("robot", hub=url) as robot, _running(robot_node.simulate(robot)):
        shown = await show("#/dashboard", height=800)
        goal = await _sent(robot, 6.1, 3.4)
        await _driven(robot, 4.5)
        await goal.cancel()
        return await _taken(shown, "dashboard")


async def turtlesim(show: Show, url: str) -> Page:
    """Three turtles that have drawn."""
    async with (
        fibws.Node("turtlesim", hub=url) as node,
        _running(simulate(node)),
        fibws.Node("artist", hub=url) as artist,
    ):
        await artist.wait_for_service("/spawn")
        await artist.call("/kill", Kill, {"name": "turtle1"})  # It is not where its curve begins.
        for number, (pen, curve) in enumerate(CURVES, 1):
            name = f"turtle{number}"
            await artist.call("/spawn", Spawn, _place(curve(0.0)) | {"name": name})
            color = dict(zip("rgb", pen, strict=True))
            await artist.call(f"/{name}/set_pen", SetPen, color | {"width": 4})
            for step in range(201):
                place = _place(curve(step / 200))
                await artist.call(f"/{name}/teleport_absolute", TeleportAbsolute, place)
        shown = await show("#/turtlesim", height=720)
        await shown.get_by_text("turtle3").last.wait_for()
        return await _taken(shown, "turtlesim")


def _place(pose: tuple[float, float, float]) -> dict[str, float]:
    return dict(zip(("x", "y", "theta"), pose, strict=True))


def _spiral(t: float) -> tuple[float, float, float]:
    angle, radius = 6 * math.pi * t, 0.4 + 1.6 * t
    return 8 + radius * math.cos(angle), 3 + radius * math.sin(angle), angle + math.pi / 2


def _wave(t: float) -> tuple[float, float, float]:
    x, slope = 2.5 + 1.3 * math.sin(9 * t), 11.7 * math.cos(9 * t)
    return x, 1 + 8.5 * t, math.atan2(8.5, slope)


def _rose(t: float) -> tuple[float, float, float]:
    angle = 2 * math.pi * t
    radius, growth = 2.2 * math.cos(3 * angle / 2) ** 2 + 0.3, -3.3 * math.sin(3 * angle)
    x, y = math.cos(angle), math.sin(angle)
    heading = math.atan2(growth * y + radius * x, growth * x - radius * y)
    return 7 + radius * x, 8 + radius * y, heading


CURVES = [((179, 184, 255), _wave), ((255, 208, 80), _spiral), ((255, 120, 130), _rose)]
"""The pens of the turtles, and where each is along its way, from 0 to 1."""

PICTURES = {each.__name__: each for each in (page, topics, dashboard, turtlesim)}


async def _sent(node: fibws.Node, x: float, y: float) -> fibws.ClientGoal:
    """Send the robot to a place."""
    client = node.action_client("/move_base", MoveBase, over="topics")
    await client.wait_for_server()
    pose = Pose(Point(x, y, 0.0), Quaternion(w=1.0))
    return await client.send(MoveBaseGoal(PoseStamped(Header(frame_id="map"), pose)))


async def _driven(node: fibws.Node, meters: float) -> None:
    """Wait until the robot has driven so far."""
    way, last = 0.0, None
    async with node.subscribe("/odom", Odometry) as places:
        async for place in places:
            now = place.pose.pose.position
            way += math.dist((now.x, now.y), (last.x, last.y)) if last is not None else 0.0
            last = now
            if way >= meters:
                return


@asynccontextmanager
async def _running(*programs: Awaitable[object]) -> AsyncIterator[None]:
    tasks = [asyncio.ensure_future(each) for each in programs]
    try:
        yield
    finally:
        for task in tasks:
            task.cancel()
        await asyncio.wait(tasks)


async def _taken(shown: Page, name: str) -> Page:
    """Take the picture, with few colors."""
    image = Image.open(io.BytesIO(await shown.screenshot()))
    path = FOLDER / f"{name}.png"
    image.convert("RGB").quantize(COLORS, dither=Image.Dither.NONE).save(path, optimize=True)
    size = path.stat().st_size
    print(f"{path}: {image.width} x {image.height}, {size} bytes")
    if size > LARGEST:
        raise SystemExit(f"{path} is larger than {LARGEST} bytes")
    return shown


async def take(browser: Browser, url: str, name: str) -> None:
    """Take a picture of a hub's page."""
    context = await browser.new_context(color_scheme="light")

    async def show(route: str, *, height: int) -> Page:
        opened = await context.new_page()
        await opened.set_viewport_size({"width": WIDTH, "height": height})
        await opened.goto(f"http://{SHOWN}/{route}")
        await opened.wait_for_selector("#hub[data-state=open][data-messages=open]")
        return opened

    await PICTURES[name](show, url)
    await context.close()


async def main(names: list[str]) -> None:
    """Take the pictures of these names."""
    async with async_playwright() as playwright:
        for name in names:
            async with fibws.Hub(fibws.Settings(port=0)) as hub:
                rule = f"--host-resolver-rules=MAP {SHOWN} 127.0.0.1:{hub.port}"
                browser = await playwright.chromium.launch(
                    executable_path=shutil.which("chromium"), args=["--no-sandbox", rule]
                )
                await take(browser, hub.url, name)
                await browser.close()


if __name__ == "__main__":
    asyncio.run(main(sys.argv[1:] or list(PICTURES)))
