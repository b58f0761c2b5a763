"""Driving a robot from the page of its topic."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager

import pytest
from playwright.async_api import Page, expect

import fibws
from fibws.hub.server import HubServer
from fibws.msg.geometry_msgs import Twist, TwistStamped, Vector3

from .conftest import OpenPage, fixture, until

CMD = "#/topics/%2Fcmd_vel"
ZERO = (0.0, 0.0, 0.0)
LEASE = 0.4
"""Seconds without a command after which the hub stops the robot."""
WATCH_SENT = """
window.sent = [];
const { send } = WebSocket.prototype;
WebSocket.prototype.send = function (data) {
    const operation = JSON.parse(data);
    if (operation.topic === "/cmd_vel") window.sent.push(operation);
    window.sendRaw = (operation) => send.call(this, JSON.stringify(operation));
    return send.call(this, data);
};
window.lastWill = () => window.sent.findLast(({ op }) => op.endsWith("_will"));
"""
"""Keep what the page sends about the topic, and let tests send more by the page's connection."""
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
        self._marks = 0

    async def next(self) -> tuple[float, float, float]:
        async with asyncio.timeout(60):
            command = await anext(self.commands)
        return command.linear.x, command.linear.y, command.angular.z

    async def moves(self, *, forward: float = 0, left: float = 0, turn: float = 0) -> None:
        """Wait for this velocity."""
        while await self.next() != pytest.approx((forward, left, turn), abs=0.01):
            pass

    async def rest(self, page: Page, zeros: int = 1) -> None:
        """Wait for the end of driving; require zeros as the last commands, and none after them."""
        # The hub sends a zero by itself, if the page is slow, until the will is cleared.
        await until(page, "lastWill().op === 'clear_will'")
        assert (await self.received(page))[-zeros:] == [ZERO] * zeros
        await self.silence(page)

    async def silence(self, page: Page) -> None:
        """Require that the page sends nothing, although time passes there."""
        await page.clock.run_for(1000)
        assert await self.received(page) == []

    async def received(self, page: Page) -> list[tuple[float, float, float]]:
        """Return all commands that the page has sent so far, and that were not returned before."""
        self._marks += 1
        mark = Twist(linear=Vector3(z=float(self._marks)))
        # What the page has sent comes before what it sends now.
        await page.evaluate(
            """(z) => {
                const topic = { id: "mark", topic: "/cmd_vel", type: "geometry_msgs/Twist" };
                sendRaw({ op: "advertise", ...topic });
                sendRaw({ op: "publish", topic: "/cmd_vel", msg: { linear: { z } } });
                sendRaw({ op: "unadvertise", ...topic });
            }""",
            self._marks,
        )
        return await self._before(mark)

    async def received_from_others(self) -> list[tuple[float, float, float]]:
        """Return all commands that the hub has now, and that were not returned before."""
        self._marks += 1
        mark = Twist(linear=Vector3(z=float(self._marks)))
        async with fibws.Node("marker", hub=self.node.hub) as marker:
            topic = await marker.advertise("/cmd_vel", Twist)
            await topic.publish(mark)
        return await self._before(mark)

    async def _before(self, mark: Twist) -> list[tuple[float, float, float]]:
        found = []
        async with asyncio.timeout(60):
            async for command in self.commands:
                if command == mark:
                    break
                found.append((command.linear.x, command.linear.y, command.angular.z))
        return found


@fixture
async def robot(hub: HubServer) -> AsyncIterator[Robot]:
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
    hub: HubServer, robot: Robot, open_page: OpenPage
) -> None:
    page = await open_page(hub, CMD, has_clock=True, prepare=WATCH_SENT)
    async with held(page, 0, -1):
        await robot.moves(forward=0.5)
        await expect(page.locator(".teleop-status")).to_have_text("driving /cmd_vel")
    await robot.rest(page)
    await expect(page.locator(".teleop-status")).to_have_text("stopped")
    async with held(page, -0.5, 0):
        await robot.moves(turn=0.5)
    await robot.rest(page)
    await page.get_by_label("Sideways", exact=True).check()
    async with held(page, -1, 0):
        await robot.moves(left=0.5)
    await robot.rest(page)


async def test_limits_are_kept_for_the_next_time(
    hub: HubServer, robot: Robot, open_page: OpenPage
) -> None:
    page = await open_page(hub, CMD, has_clock=True, prepare=WATCH_SENT)
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
    await robot.rest(page)


async def test_keys_drive_while_the_panel_has_the_focus(
    hub: HubServer, robot: Robot, open_page: OpenPage
) -> None:
    page = await open_page(hub, CMD, has_clock=True, prepare=WATCH_SENT)
    await drive(page, robot)
    await page.keyboard.down("ArrowLeft")
    await robot.moves(forward=0.5, turn=1)
    await page.keyboard.up("w")
    await robot.moves(turn=1)
    await page.get_by_label("Sideways", exact=True).focus()
    await robot.rest(page)
    await page.keyboard.press("w")
    await page.keyboard.up("ArrowLeft")
    await page.locator(".teleop").focus()
    await page.keyboard.down("q")
    await robot.moves(left=0.5)
    await page.keyboard.up("q")
    await robot.rest(page)


async def test_stop_holds_until_it_is_released(
    hub: HubServer, robot: Robot, open_page: OpenPage
) -> None:
    page = await open_page(hub, CMD, has_clock=True, prepare=WATCH_SENT)
    stick = page.locator(".teleop-stick").first
    await drive(page, robot)
    await page.keyboard.press("Space")
    await robot.rest(page, zeros=3)
    await expect(page.locator(".teleop-status")).to_have_text("stopped until you resume")
    await page.keyboard.up("w")
    await page.keyboard.down("w")
    async with held(page, 0, -1):
        await expect(stick).to_be_visible()
    await page.keyboard.up("w")
    await page.get_by_role("button", name="Resume").click()
    async with held(page, 0, -1):
        await robot.moves(forward=0.5)
    await robot.rest(page)
    await page.get_by_role("button", name="STOP").click()
    await robot.rest(page, zeros=3)


async def test_stick_must_be_pressed_again_after_the_window_had_lost_the_focus(
    hub: HubServer, robot: Robot, open_page: OpenPage
) -> None:
    page = await open_page(hub, CMD, has_clock=True, prepare=WATCH_SENT)
    async with held(page, 0, -1):
        await robot.moves(forward=0.5)
        await page.evaluate("window.dispatchEvent(new Event('blur'))")
        await robot.rest(page)
        await page.mouse.move(0, 0)
        await robot.silence(page)
    async with held(page, 0, -1):
        await robot.moves(forward=0.5)
    await robot.rest(page)


@pytest.mark.parametrize("event", ["blur", "pagehide", "visibilitychange", "tab", "close"])
async def test_robot_stops_when_nobody_looks(
    hub: HubServer, robot: Robot, open_page: OpenPage, event: str
) -> None:
    page = await open_page(hub, CMD, has_clock=True, prepare=WATCH_SENT)
    await drive(page, robot)
    if event == "close":
        await page.close()
        while await robot.next() != ZERO:
            pass
        assert await robot.received_from_others() == []
        return
    if event == "tab":
        await page.evaluate("location.hash = '#/services'")
    else:
        target = "document" if event == "visibilitychange" else "window"
        await page.evaluate(f"{target}.dispatchEvent(new Event('{event}'))")
    await robot.rest(page)


async def test_robot_stops_when_the_page_stands_still(
    hub: HubServer, robot: Robot, open_page: OpenPage
) -> None:
    page = await open_page(hub, CMD, has_clock=True, prepare=WATCH_SENT)
    await drive(page, robot)
    assert await page.evaluate("lastWill().timeout") == LEASE
    debugger = await page.context.new_cdp_session(page)
    is_standing = asyncio.Event()
    debugger.on("Debugger.paused", lambda _: is_standing.set())
    await debugger.send("Debugger.enable")
    await debugger.send("Debugger.pause")
    async with asyncio.timeout(60):
        await is_standing.wait()
    # The page cannot have sent it.
    while await robot.next() != ZERO:
        pass
    await debugger.detach()
    # Chromium drops the events of keys until the page goes on.
    await page.evaluate("new Promise(requestAnimationFrame)")
    await page.keyboard.up("w")
    await robot.rest(page)


async def test_gamepad_drives_while_a_shoulder_button_is_held(
    hub: HubServer, robot: Robot, open_page: OpenPage
) -> None:
    page = await open_page(hub, CMD, has_clock=True, prepare=WATCH_SENT + PAD)
    await expect(page.locator(".teleop")).to_be_visible()
    await page.evaluate("window.pad.axes = [0, -1, 0.55, 0]")
    await page.evaluate("window.press(true)")
    await robot.moves(forward=0.5, turn=-0.5)
    await page.evaluate("window.press(false)")
    await robot.rest(page)
    await page.evaluate("window.press(true)")
    await robot.moves(forward=0.5, turn=-0.5)
    await page.evaluate("window.pad = null")
    await robot.rest(page)


async def test_stamped_velocities_have_a_time(hub: HubServer, open_page: OpenPage) -> None:
    async with fibws.Node("robot", hub=hub.url) as node:
        commands = node.subscribe("/stamped", TwistStamped, queue_size=None)
        await node.flush()
        page = await open_page(hub, "#/topics/%2Fstamped")
        async with held(page, 0, -1):
            async for command in commands:
                assert command.header.stamp.secs > 0
                if command.twist.linear.x > 0:
                    break


async def test_others_at_the_topic_are_named(
    hub: HubServer, robot: Robot, open_page: OpenPage
) -> None:
    async with fibws.Node("planner", hub=hub.url) as planner:
        await planner.advertise("/cmd_vel", Twist)
        page = await open_page(hub, CMD, has_clock=True, prepare=WATCH_SENT)
        await expect(page.get_by_text("also published by /planner")).to_be_visible()
    robot.commands.close()
    async with fibws.Node("planner", hub=hub.url) as planner:
        await planner.advertise("/cmd_vel", Twist)
        await expect(page.get_by_text("no node subscribes to /cmd_vel")).to_be_visible()


async def test_nothing_is_held_after_a_lost_connection(
    hub: HubServer, robot: Robot, open_page: OpenPage
) -> None:
    page = await open_page(hub, CMD, has_clock=True, prepare=WATCH_SENT)
    await drive(page, robot)
    (name,) = [*hub.graph.topics["/cmd_vel"].publishers]
    await robot.node.call("/rosapi/kill_node", "fibws_msgs/KillNode", {"node": name})
    while await robot.next() != ZERO:
        pass
    assert await robot.received_from_others() == []
    await page.get_by_role("button", name="Connect", exact=True).click()
    await until(page, "document.querySelector('#hub').dataset.state === 'open'")
    await robot.silence(page)
