"""Driving a robot from the page of its topic."""

from __future__ import annotations

import asyncio
import time
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager

import pytest
from playwright.async_api import Page, expect

import fibws
from fibws.hub import Hub
from fibws.msg.geometry_msgs import Twist, TwistStamped

from .conftest import OpenPage, fixture, until

CMD = "#/topics/%2Fcmd_vel"
ZERO = (0.0, 0.0, 0.0)
PAD = """
const button = (pressed) => ({pressed, touched: pressed, value: Number(pressed)});
window.pad = {axes: [0, 0, 0, 0], buttons: Array.from({length: 17}, () => button(false))};
navigator.getGamepads = () => window.pad ? [window.pad] : [null];
window.press = (pressed) => { window.pad.buttons[5] = button(pressed); };
"""


class Robot:
    """A node that is driven."""

    def __init__(self, node: fibws.Node) -> None:
        self.node = node
        self.commands = node.subscribe("/cmd_vel", Twist, queue_size=None)

    async def next(self) -> tuple[float, float, float]:
        async with asyncio.timeout(60):
            command = await anext(self.commands)
        return command.linear.x, command.linear.y, command.angular.z

    async def moves(self, *, forward: float = 0, left: float = 0, turn: float = 0) -> None:
        """Wait for this velocity."""
        while await self.next() != pytest.approx((forward, left, turn), abs=0.01):
            pass

    async def rest(self) -> None:
        """Wait for a zero, after which nothing is sent for more than the hub's lease."""
        while await self.next() != ZERO:
            pass
        await self.silence()

    async def stops(self) -> None:
        """Wait for the zeros of a stop, after which nothing is sent."""
        while await self.next() != ZERO:
            pass
        assert [await self.next(), await self.next()] == [ZERO, ZERO]
        await self.silence()

    async def silence(self) -> None:
        with pytest.raises(TimeoutError):
            async with asyncio.timeout(0.7):
                await anext(self.commands)


@fixture
async def robot(hub: Hub) -> AsyncIterator[Robot]:
    async with fibws.Node("robot", hub=hub.url) as node:
        robot = Robot(node)
        await node.flush()
        yield robot


async def drive(page: Page, robot: Robot) -> None:
    """Press the key W, and wait until the robot drives."""
    await page.locator(".teleop").focus()
    await page.keyboard.down("w")
    await robot.moves(forward=0.5)


@asynccontextmanager
async def held(page: Page, x: float, y: float) -> AsyncIterator[None]:
    """Hold the stick at a place, by parts of its radius to the right and down."""
    stick = page.locator(".teleop-stick").first
    await stick.scroll_into_view_if_needed()
    box = await stick.bounding_box()
    assert box is not None
    radius = box["width"] / 2
    left, top = box["x"] + radius, box["y"] + radius
    await page.mouse.move(left, top)
    await page.mouse.down()
    await page.mouse.move(left + x * radius, top + y * radius)
    yield
    await page.mouse.up()


@pytest.mark.smoke
async def test_stick_drives_and_its_release_stops(
    hub: Hub, robot: Robot, open_page: OpenPage
) -> None:
    page = await open_page(hub, CMD)
    async with held(page, 0, -1):
        await robot.moves(forward=0.5)
        await expect(page.locator(".teleop-status")).to_have_text("driving /cmd_vel")
    await robot.rest()
    await expect(page.locator(".teleop-status")).to_have_text("stopped")
    async with held(page, -0.5, 0):
        await robot.moves(turn=0.5)
    await robot.rest()
    await page.get_by_label("Sideways", exact=True).check()
    async with held(page, -1, 0):
        await robot.moves(left=0.5)
    await robot.rest()


async def test_limits_are_kept_for_the_next_time(
    hub: Hub, robot: Robot, open_page: OpenPage
) -> None:
    page = await open_page(hub, CMD)
    await page.get_by_label("Greatest speed in m/s").fill("2")
    await page.get_by_label("Seconds to the greatest speed").fill("0")
    await page.get_by_label("Greatest turn in rad/s").fill("")
    await page.get_by_label("Greatest turn in rad/s").blur()
    await expect(page.get_by_label("Greatest turn in rad/s")).to_have_attribute("aria-invalid", "")
    await page.reload()
    await expect(page.get_by_label("Greatest speed in m/s")).to_have_value("2")
    await expect(page.get_by_label("Greatest turn in rad/s")).to_have_value("1")
    async with held(page, 0, 1):
        await robot.moves(forward=-2)
    await robot.rest()


async def test_keys_drive_while_the_panel_has_the_focus(
    hub: Hub, robot: Robot, open_page: OpenPage
) -> None:
    page = await open_page(hub, CMD)
    await drive(page, robot)
    await page.keyboard.down("ArrowLeft")
    await robot.moves(forward=0.5, turn=1)
    await page.keyboard.up("w")
    await robot.moves(turn=1)
    await page.get_by_label("Sideways", exact=True).focus()
    await robot.rest()
    await page.keyboard.press("w")
    await page.keyboard.up("ArrowLeft")
    await page.locator(".teleop").focus()
    await page.keyboard.down("q")
    await robot.moves(left=0.5)
    await page.keyboard.up("q")
    await robot.rest()


async def test_stop_holds_until_it_is_released(hub: Hub, robot: Robot, open_page: OpenPage) -> None:
    page = await open_page(hub, CMD)
    stick = page.locator(".teleop-stick").first
    await drive(page, robot)
    await page.keyboard.press("Space")
    await robot.stops()
    await expect(page.locator(".teleop-status")).to_have_text("stopped until you resume")
    await page.keyboard.up("w")
    await page.keyboard.down("w")
    async with held(page, 0, -1):
        await expect(stick).to_be_visible()
    await page.keyboard.up("w")
    await page.get_by_role("button", name="Resume").click()
    async with held(page, 0, -1):
        await robot.moves(forward=0.5)
    await robot.rest()
    await page.get_by_role("button", name="STOP").click()
    await robot.stops()


async def test_stick_must_be_pressed_again_after_the_window_had_lost_the_focus(
    hub: Hub, robot: Robot, open_page: OpenPage
) -> None:
    page = await open_page(hub, CMD)
    async with held(page, 0, -1):
        await robot.moves(forward=0.5)
        await page.evaluate("window.dispatchEvent(new Event('blur'))")
        await robot.rest()
        await page.mouse.move(0, 0)
        await robot.silence()
    async with held(page, 0, -1):
        await robot.moves(forward=0.5)
    await robot.rest()


@pytest.mark.parametrize("event", ["blur", "pagehide", "visibilitychange", "tab", "close"])
async def test_robot_stops_when_nobody_looks(
    hub: Hub, robot: Robot, open_page: OpenPage, event: str
) -> None:
    page = await open_page(hub, CMD)
    await drive(page, robot)
    if event == "close":
        await page.close()
    elif event == "tab":
        await page.evaluate("location.hash = '#/services'")
    else:
        target = "document" if event == "visibilitychange" else "window"
        await page.evaluate(f"{target}.dispatchEvent(new Event('{event}'))")
    await robot.rest()


async def test_robot_stops_when_the_page_stands_still(
    hub: Hub, robot: Robot, open_page: OpenPage
) -> None:
    page = await open_page(hub, CMD)
    await drive(page, robot)
    standing = asyncio.create_task(
        page.evaluate("(() => { const end = Date.now() + 1500; while (Date.now() < end); })()")
    )
    last = time.monotonic()
    while await robot.next() != ZERO:
        last = time.monotonic()
    assert time.monotonic() - last < 1.2  # Twice the 600 ms that it may take.
    await standing
    await page.keyboard.up("w")
    await robot.rest()


async def test_gamepad_drives_while_a_shoulder_button_is_held(
    hub: Hub, robot: Robot, open_page: OpenPage
) -> None:
    page = await open_page(hub, CMD, prepare=PAD)
    await expect(page.locator(".teleop")).to_be_visible()
    await page.evaluate("window.pad.axes = [0, -1, 0.55, 0]")
    await page.evaluate("window.press(true)")
    await robot.moves(forward=0.5, turn=-0.5)
    await page.evaluate("window.press(false)")
    await robot.rest()
    await page.evaluate("window.press(true)")
    await robot.moves(forward=0.5, turn=-0.5)
    await page.evaluate("window.pad = null")
    await robot.rest()


async def test_stamped_velocities_have_a_time(hub: Hub, open_page: OpenPage) -> None:
    async with fibws.Node("robot", hub=hub.url) as node:
        commands = node.subscribe("/stamped", TwistStamped, queue_size=None)
        await node.flush()
        page = await open_page(hub, "#/topics/%2Fstamped")
        async with held(page, 0, -1):
            async for command in commands:
                assert command.header.stamp.secs > 0
                if command.twist.linear.x > 0:
                    break


async def test_others_at_the_topic_are_named(hub: Hub, robot: Robot, open_page: OpenPage) -> None:
    async with fibws.Node("planner", hub=hub.url) as planner:
        await planner.advertise("/cmd_vel", Twist)
        page = await open_page(hub, CMD)
        await expect(page.get_by_text("also published by /planner")).to_be_visible()
    robot.commands.close()
    async with fibws.Node("planner", hub=hub.url) as planner:
        await planner.advertise("/cmd_vel", Twist)
        await expect(page.get_by_text("no node subscribes to /cmd_vel")).to_be_visible()


async def test_nothing_is_held_after_a_lost_connection(
    hub: Hub, robot: Robot, open_page: OpenPage
) -> None:
    page = await open_page(hub, CMD)
    await drive(page, robot)
    (name,) = [each for each in hub.graph.nodes if each.startswith("/page_")]
    await robot.node.call("/rosapi/kill_node", "fibws_msgs/KillNode", {"node": name})
    await robot.rest()
    await page.get_by_role("button", name="Connect", exact=True).click()
    await until(page, "document.querySelector('#hub').dataset.state === 'open'")
    await robot.silence()
