"""The Dashboard tab of the page: panels in a layout that is changed, kept and shared."""

from __future__ import annotations

import asyncio
import json
import re
from collections.abc import AsyncIterator, Iterable
from contextlib import asynccontextmanager
from pathlib import Path
from typing import Any

import pytest
from playwright.async_api import FilePayload, Locator, Page, expect

import fibws
from fibws.hub.server import HubServer
from fibws.msg.diagnostic_msgs import DiagnosticArray, DiagnosticStatus
from fibws.msg.geometry_msgs import Twist
from fibws.msg.nav_msgs import MapMetaData, OccupancyGrid
from fibws.msg.sensor_msgs import BatteryState, Image, LaserScan
from fibws.msg.std_msgs import Bool, Float64, Header, String

from .conftest import Complaints, OpenPage, fixture, until

DASHBOARD = "#/dashboard"
LAYOUT = json.dumps(
    {
        "schema": 1,
        "layout": {
            "split": "col",
            "items": [
                {
                    "split": "row",
                    "size": 0.6,
                    "items": [
                        {"view": "image", "name": "/camera"},
                        {"view": "map", "name": "/map"},
                    ],
                },
                {
                    "split": "row",
                    "size": 0.4,
                    "items": [
                        {"view": "teleop", "name": "/cmd_vel"},
                        {"view": "diagnostics", "name": "/diagnostics"},
                    ],
                },
            ],
        },
    }
)
FOUR = ["Image /camera", "Map /map", "Teleop /cmd_vel", "Diagnostics /diagnostics"]


class Robot:
    """A node with a camera, a map, diagnostics and wheels."""

    def __init__(self, node: fibws.Node, hub: HubServer) -> None:
        self.node = node
        self.publishers: dict[str, fibws.Publisher[Any]] = {}
        self.hub = hub
        self.commands = node.subscribe("/cmd_vel", Twist, queue_size=None)

    async def start(self) -> None:
        messages = {
            "/camera": Image(height=4, width=4, encoding="rgb8", step=12, data=bytes(range(48))),
            "/map": OccupancyGrid(
                info=MapMetaData(resolution=0.5, width=2, height=1), data=[0, 100]
            ),
            "/diagnostics": DiagnosticArray(status=[DiagnosticStatus(1, "/laser", "dust")]),
        }
        for name, message in messages.items():
            publisher = await self.node.advertise(name, type(message), latch=True, peers=True)
            await publisher.publish(message)
            self.publishers[name] = publisher
        await self.node.flush()

    async def subscribed(self, *topics: str) -> None:
        """Wait until pages subscribe to these of the robot's topics, and to no others."""
        async with asyncio.timeout(60):
            for name, publisher in self.publishers.items():
                async for peers in publisher.peers.changes():
                    if bool(peers) == (name in topics):
                        break


@fixture
async def robot(hub: HubServer) -> AsyncIterator[Robot]:
    async with fibws.Node("robot", hub=hub.url) as node:
        robot = Robot(node, hub)
        await robot.start()
        yield robot


def panes(page: Page) -> Locator:
    return page.locator(".pane")


def pane(page: Page, name: str) -> Locator:
    return page.locator(".pane").and_(page.get_by_role("region", name=name))


async def expect_panes(page: Page, names: Iterable[str]) -> None:
    """Wait until there are these panels, in this order."""
    found = panes(page)
    await expect(found).to_have_count(len(list(names)))
    for number, name in enumerate(names):
        await expect(found.nth(number)).to_have_attribute("aria-label", name)


async def box(element: Locator) -> tuple[float, float, float, float]:
    found = await element.bounding_box()
    assert found is not None
    return found["x"], found["y"], found["width"], found["height"]


async def open_robot(
    robot: Robot, open_page: OpenPage, route: str = DASHBOARD, **context: Any
) -> Page:
    """Open the dashboard with four panels of a robot."""
    page = await open_page(robot.hub, route, **context)
    if route == DASHBOARD:
        await page.get_by_label("File with a layout").set_input_files(payload(LAYOUT))
    await expect_panes(page, FOUR)
    return page


async def choose(page: Page, view: str, name: str) -> None:
    """Choose what the new panel shows."""
    group = page.locator(".pane-chooser details", has=page.locator("summary", has_text=view))
    await group.get_by_role("button", name=name, exact=True).click()


async def save(page: Page, name: str, *, shared: bool = False) -> None:
    await page.get_by_role("button", name="Save").first.click()
    dialog = page.get_by_role("dialog")
    await dialog.get_by_label("Name").fill(name)
    await dialog.get_by_label("For everybody").set_checked(shared)
    await dialog.get_by_role("button", name="Save").click()
    await expect(dialog).to_have_count(0)


async def test_empty_hub_says_what_to_publish_and_fills_as_a_robot_comes(
    hub: HubServer, open_page: OpenPage, complaints: Complaints
) -> None:
    page = await open_page(hub, DASHBOARD)
    await expect(page.locator(".dashboard")).to_contain_text("fibws demo robot")
    await page.get_by_role("button", name="Auto").click()
    await expect(page.get_by_role("alert")).to_contain_text("nothing to show")
    async with fibws.Node("robot", hub=hub.url) as node:
        robot = Robot(node, hub)
        await node.flush()
        drive = pane(page, "Teleop /cmd_vel")
        await expect(drive).to_be_visible()
        await robot.start()
        await expect(panes(page)).to_have_count(4)
        camera = pane(page, "Image /camera")
        await expect(camera).to_contain_text("rgb8")
        await expect(pane(page, "Diagnostics /diagnostics")).to_contain_text("1 warning")
        await expect(panes(page).nth(1)).to_have_attribute("aria-label", re.compile("3D|Map"))
        left, top, *_ = await box(camera)
        space, below = await box(panes(page).nth(1)), await box(drive)
        assert space[0] > left and space[1] == top
        assert below[0] == left and below[1] > top
        # What the user has closed does not come back, not even after a reload.
        await drive.get_by_role("button", name="Close").click()
        for _ in range(2):
            await expect(panes(page)).to_have_count(3)
            await page.reload()
        await page.get_by_role("button", name="Auto").click()
        await expect(panes(page)).to_have_count(4)
        await page.close()
        # A scene is drawn by software here, which the browser warns of.
        complaints.allow("GPU stall due to ReadPixels")


async def test_panels_are_split_chosen_moved_closed_and_brought_back(
    robot: Robot, open_page: OpenPage
) -> None:
    page = await open_robot(robot, open_page)
    await pane(page, "Map /map").get_by_role("button", name="Split right").click()
    await expect_panes(page, [*FOUR[:2], "New panel", *FOUR[2:]])
    await choose(page, "Raw messages", "/diagnostics")
    five = [*FOUR[:2], "Raw messages /diagnostics", *FOUR[2:]]
    await expect_panes(page, five)
    echo = pane(page, "Raw messages /diagnostics")
    await expect(echo.locator(".tree")).to_contain_text("dust")
    assert (await box(echo))[1] == (await box(pane(page, "Map /map")))[1]

    title = echo.get_by_role("button", name="Raw messages /diagnostics")
    await title.click()
    await echo.get_by_label("Side").select_option("below")
    await echo.get_by_label("Panel").select_option(label="Image /camera")
    await echo.get_by_role("button", name="Move").click()
    await expect_panes(page, [FOUR[0], "Raw messages /diagnostics", *FOUR[1:]])
    await expect(title).to_be_focused()
    await expect(echo.locator(".tree")).to_be_visible()
    left, top, *_ = await box(pane(page, "Image /camera"))
    moved = await box(echo)
    assert moved[0] == left and moved[1] > top

    await pane(page, "Teleop /cmd_vel").get_by_role("button", name="Close").click()
    await expect(panes(page)).to_have_count(4)
    for expected in ([FOUR[0], "Raw messages /diagnostics", *FOUR[1:]], five):
        await page.get_by_role("button", name="Undo").click()
        await expect_panes(page, expected)
    await page.reload()
    await expect_panes(page, five)


async def test_bars_are_moved_by_mouse_and_keys_and_stay_there(
    robot: Robot, open_page: OpenPage
) -> None:
    page = await open_robot(robot, open_page)
    bars = page.get_by_role("separator")
    await expect(bars).to_have_count(3)
    camera = pane(page, "Image /camera")
    _, _, width, height = await box(camera)
    left, top, w, h = await box(bars.nth(0))
    await page.mouse.move(left + w / 2, top + h / 2)
    await page.mouse.down()
    await page.mouse.move(left + w / 2 + 200, top + h / 2, steps=4)
    await page.mouse.up()
    assert (await box(camera))[2] == pytest.approx(width + 200, abs=2)
    undo = page.get_by_role("button", name="Undo")
    await undo.click()
    assert (await box(camera))[2] == pytest.approx(width, abs=1)
    bar = bars.nth(1)
    await expect(bar).to_have_attribute("aria-orientation", "horizontal")
    await expect(bar).to_have_attribute("aria-valuenow", "60")
    await bar.focus()
    for key in ("ArrowUp", "ArrowUp", "Shift+ArrowUp", "ArrowLeft"):
        await page.keyboard.press(key)
    await expect(bar).to_have_attribute("aria-valuenow", "46")
    assert (await box(camera))[3] < height
    await expect(bar).to_be_focused()
    # All keys are one step.
    await undo.click()
    assert (await box(camera))[3] == pytest.approx(height, abs=1)
    await bar.focus()
    for key in ("ArrowUp", "Shift+ArrowUp"):
        await page.keyboard.press(key)
    before = await box(camera)
    await page.reload()
    await expect_panes(page, FOUR)
    assert await box(camera) == pytest.approx(before, abs=1)
    await bar.dblclick()
    await expect(bar).to_have_attribute("aria-valuenow", "50")
    await undo.click()
    await expect(bar).to_have_attribute("aria-valuenow", "48")


async def test_a_bar_is_moved_by_a_finger(robot: Robot, open_page: OpenPage) -> None:
    page = await open_robot(robot, open_page, has_touch=True)
    camera = pane(page, "Image /camera")
    _, _, width, _ = await box(camera)
    left, top, w, h = await box(page.get_by_role("separator").first)
    touch = await page.context.new_cdp_session(page)
    for kind, x in (("touchStart", 0), ("touchMove", -60), ("touchMove", -120), ("touchEnd", None)):
        points = [] if x is None else [{"x": left + w / 2 + x, "y": top + h / 2}]
        await touch.send("Input.dispatchTouchEvent", {"type": kind, "touchPoints": points})
    await touch.detach()
    await until(page, f"document.querySelector('.pane').offsetWidth < {width - 100}")
    assert (await box(camera))[2] == pytest.approx(width - 120, abs=3)


async def test_hidden_panels_end_their_subscriptions(robot: Robot, open_page: OpenPage) -> None:
    page = await open_robot(robot, open_page)
    await robot.subscribed("/camera", "/map", "/diagnostics")
    camera = pane(page, "Image /camera")
    await camera.locator(".pane-head").dblclick(position={"x": 300, "y": 10})
    await robot.subscribed("/camera")
    await expect(pane(page, "Map /map")).to_be_hidden()
    assert (await box(camera))[2] > 1200
    await page.keyboard.press("Escape")
    await robot.subscribed("/camera", "/map", "/diagnostics")
    await camera.get_by_role("button", name="Maximize").click()
    await robot.subscribed("/camera")
    await camera.get_by_role("button", name="Maximize").click()
    await robot.subscribed("/camera", "/map", "/diagnostics")
    await page.get_by_role("link", name="Services", exact=True).click()
    await robot.subscribed()
    await page.get_by_role("link", name="Dashboard", exact=True).click()
    await robot.subscribed("/camera", "/map", "/diagnostics")
    await camera.get_by_role("button", name="Image /camera").click()
    await robot.subscribed("/map", "/diagnostics")


async def test_a_page_in_a_hidden_tab_ends_its_subscriptions_after_10_s(
    robot: Robot, open_page: OpenPage
) -> None:
    page = await open_robot(robot, open_page)
    await robot.subscribed("/camera", "/map", "/diagnostics")
    await page.clock.install()
    for hidden in (True, False):
        await page.evaluate(
            """(hidden) => {
                Object.defineProperty(document, 'hidden', {value: hidden, configurable: true});
                document.dispatchEvent(new Event('visibilitychange'));
            }""",
            hidden,
        )
        await page.clock.fast_forward(9000)
        await robot.subscribed("/camera", "/map", "/diagnostics")
        if hidden:
            await page.clock.fast_forward(2000)
            await robot.subscribed()


async def test_settings_of_panels_are_part_of_the_layout(robot: Robot, open_page: OpenPage) -> None:
    page = await open_robot(robot, open_page)
    camera = pane(page, "Image /camera")
    await camera.get_by_label("Most images").select_option(label="\u2264 5 Hz")
    await camera.get_by_role("button", name="1:1").click()
    await pane(page, "Diagnostics").get_by_label("Filter").fill("laser")
    drive = pane(page, "Teleop /cmd_vel")
    await drive.get_by_label("Greatest speed in m/s").fill("0.25")
    await drive.get_by_label("Sideways", exact=True).check()
    # The last one is kept as the page is left.
    await page.reload()
    await expect_panes(page, FOUR)
    await expect(camera.get_by_label("Most images")).to_have_value("2")
    await expect(page.locator(".pane-image canvas")).to_have_css("width", "4px")
    await expect(pane(page, "Diagnostics").get_by_label("Filter")).to_have_value("laser")
    await expect(drive.get_by_label("Greatest speed in m/s")).to_have_value("0.25")
    await expect(drive.get_by_label("Sideways", exact=True)).to_be_checked()


async def test_layouts_are_saved_by_name_and_linked(robot: Robot, open_page: OpenPage) -> None:
    page = await open_robot(robot, open_page)
    await save(page, "drive")
    await expect(page).to_have_url(f"{page.url.split('#')[0]}#/dashboard/drive")
    await pane(page, "Map /map").get_by_role("button", name="Close").click()
    await expect(panes(page)).to_have_count(3)
    await page.get_by_label("Layout", exact=True).select_option("")
    await expect_panes(page, FOUR)
    await page.goto(f"{page.url.split('#')[0]}#/dashboard/drive")
    await expect(panes(page)).to_have_count(3)
    await page.get_by_text("More", exact=True).click()
    await page.get_by_role("button", name="Delete \u201cdrive\u201d").click()
    await expect_panes(page, FOUR)
    await expect(page.get_by_label("Layout", exact=True).locator("option")).to_have_count(1)
    await page.goto(f"{page.url.split('#')[0]}#/dashboard/drive")
    await expect(page.get_by_role("alert")).to_contain_text("no layout \u201cdrive\u201d")


async def test_layouts_are_shared_through_a_parameter_of_the_hub(
    robot: Robot, open_page: OpenPage
) -> None:
    page = await open_robot(robot, open_page)
    await expect(panes(page)).to_have_count(4)
    assert not robot.hub.graph.parameters.has("/fibws/layouts")
    await save(page, "lab", shared=True)
    await expect(page.get_by_label("Layout", exact=True)).to_have_value("lab")
    text = await robot.node.params.get("/fibws/layouts/lab")
    assert json.loads(text)["schema"] == 1

    # Somebody else changes it, for himself at first.
    other = await open_robot(robot, open_page, f"{DASHBOARD}/lab")
    await pane(other, "Diagnostics").get_by_role("button", name="Close").click()
    await expect(other.get_by_role("status").filter(has_text="changed here")).to_be_visible()
    assert await robot.node.params.get("/fibws/layouts/lab") == text
    await other.reload()
    await expect_panes(other, FOUR[:3])
    await save(other, "lab", shared=True)
    await expect(other.get_by_role("status").filter(has_text="changed here")).to_have_count(0)

    # The first one gets it at the next visit, as nothing was changed here.
    await page.get_by_role("link", name="Services", exact=True).click()
    await page.go_back()
    await expect_panes(page, FOUR[:3])

    # Changes of both are kept until one of them is thrown away.
    await pane(page, "Map").get_by_role("button", name="Close").click()
    await pane(other, "Image").get_by_role("button", name="Close").click()
    await save(other, "lab", shared=True)
    await page.reload()
    await expect(page.get_by_text("changed here, and on the hub meanwhile")).to_be_visible()
    await expect_panes(page, [FOUR[0], FOUR[2]])
    await page.get_by_text("More", exact=True).click()
    await page.get_by_role("button", name="Load from the hub again").click()
    await expect_panes(page, FOUR[1:3])

    await page.get_by_text("More", exact=True).click()
    await page.get_by_role("button", name="for everybody").click()
    await expect_panes(page, FOUR)
    assert not robot.hub.graph.parameters.has("/fibws/layouts/lab")


async def test_strange_shared_layouts_do_no_harm(robot: Robot, open_page: OpenPage) -> None:
    await robot.node.params.set("/fibws/layouts", {"bad": "{", "worse": {"a": 1}, "n": 5})
    page = await open_robot(robot, open_page)
    await page.goto(f"{page.url.split('#')[0]}#/dashboard/bad")
    await expect(page.get_by_role("alert")).to_contain_text("Invalid JSON")
    options = page.get_by_label("Layout", exact=True).locator("option")
    await expect(options).to_have_text(["Without a name", "bad"])
    await page.get_by_label("Layout", exact=True).select_option("")
    await expect_panes(page, FOUR)


async def test_layouts_are_exported_and_imported(
    robot: Robot, open_page: OpenPage, tmp_path: Path
) -> None:
    page = await open_robot(robot, open_page)
    await pane(page, "Teleop").get_by_role("button", name="Close").click()
    await page.get_by_text("More", exact=True).click()
    async with page.expect_download() as download:
        await page.get_by_role("button", name="Export").click()
    saved = await download.value
    assert saved.suggested_filename == "dashboard.json"
    path = tmp_path / "mine.json"
    await saved.save_as(path)
    file = json.loads(path.read_text())
    assert file["schema"] == 1
    assert file["layout"]["split"] == "col"

    importer = page.get_by_label("File with a layout")
    file["layout"]["items"][0]["view"] = "hologram"
    file["layout"]["items"][0]["name"] = "<b>x</b>"
    del file["layout"]["items"][0]["items"], file["layout"]["items"][0]["split"]
    await importer.set_input_files(payload(json.dumps(file)))
    await expect_panes(page, ["hologram <b>x</b>", "Diagnostics /diagnostics"])
    await expect(pane(page, "hologram")).to_contain_text("no view \u201chologram\u201d")

    for text, reason in {
        '{"schema": 99, "layout": null}': "Unknown schema 99",
        "nonsense": "Invalid JSON",
        '{"schema": 1, "layout": {"split": "row", "items": {}}}': "list of \u201citems\u201d",
    }.items():
        await importer.set_input_files(payload(text))
        await expect(page.get_by_role("alert")).to_contain_text(reason)
    await expect_panes(page, ["hologram <b>x</b>", "Diagnostics /diagnostics"])
    await page.get_by_role("button", name="Undo").click()
    await expect_panes(page, [FOUR[0], FOUR[1], FOUR[3]])


def payload(text: str) -> FilePayload:
    return {"name": "mine.json", "mimeType": "application/json", "buffer": text.encode()}


async def test_tabs_are_panels_that_keep_their_state(
    robot: Robot, hub: HubServer, open_page: OpenPage
) -> None:
    views = ["graph", "topics", "parameters", "services"]
    items = [{"view": view} for view in views] + [{"view": "publish", "name": "/cmd_vel"}]
    layout = {"schema": 1, "layout": {"split": "row", "items": items}}
    page = await open_page(hub, DASHBOARD, width=2400)
    await page.get_by_label("File with a layout").set_input_files(payload(json.dumps(layout)))
    await expect_panes(page, ["Graph", "Topics", "Parameters", "Services", "Publish /cmd_vel"])
    await expect(pane(page, "Graph").locator("svg.drawing")).to_contain_text("/camera")
    await expect(pane(page, "Parameters")).to_contain_text("rosdistro")
    topics = pane(page, "Topics")
    await topics.get_by_label("Filter").fill("cam")
    await topics.get_by_role("link", name="/camera").click()
    await expect(topics.get_by_role("heading", name="/camera")).to_be_visible()
    assert page.url.endswith("#/dashboard")
    await pane(page, "Publish /cmd_vel").get_by_role("button", name="Publish", exact=True).click()
    await expect(pane(page, "Publish /cmd_vel")).to_contain_text("1 message")
    await page.reload()
    await expect(topics.get_by_label("Filter")).to_have_value("cam")


async def test_a_panel_waits_for_its_topic(hub: HubServer, open_page: OpenPage) -> None:
    layout = {"schema": 1, "layout": {"view": "picture", "name": "/camera"}}
    page = await open_page(hub, DASHBOARD)
    await page.get_by_label("File with a layout").set_input_files(payload(json.dumps(layout)))
    await expect(pane(page, "Image /camera")).to_contain_text("/camera does not exist now")
    async with fibws.Node("robot", hub=hub.url) as node:
        await node.advertise("/camera", Float64)
        await expect(pane(page, "Image")).to_contain_text("has the type std_msgs/Float64")
    async with fibws.Node("robot", hub=hub.url) as node:
        await Robot(node, hub).start()
        await expect(pane(page, "Image /camera")).to_contain_text("rgb8")


async def test_numbers_of_an_echo_are_plotted_beside_it(
    hub: HubServer, open_page: OpenPage
) -> None:
    async with fibws.Node("robot", hub=hub.url) as node:
        speed = await node.advertise("/speed", Float64, latch=True)
        await speed.publish(Float64(1.5))
        page = await open_page(hub, DASHBOARD)
        await expect_panes(page, ["Raw messages /speed", "Console"])
        await pane(page, "Raw messages").get_by_role("button", name="Plot data").click()
        plot = pane(page, "Plot")
        await expect(plot.locator(".plot-legend li")).to_have_count(1)
        await expect(plot.locator(".plot-value")).to_have_text("1.5")
        await plot.get_by_label("Time range").select_option("120")
        await page.reload()
        await expect(plot.locator(".plot-value")).to_have_text("1.5")
        await expect(plot.get_by_label("Time range")).to_have_value("120")


async def test_all_plots_show_the_time_under_the_mouse(hub: HubServer, open_page: OpenPage) -> None:
    items = [
        {"view": "plot", "name": "", "config": {"plot": f"/n:{text}"}} for text in ("data", "-data")
    ]
    layout = {"schema": 1, "layout": {"split": "col", "items": items}}
    async with fibws.Node("robot", hub=hub.url) as node:
        numbers = await node.advertise("/n", Float64, latch=True)
        await numbers.publish(Float64(1.5))
        page = await open_page(hub, DASHBOARD)
        await page.get_by_label("File with a layout").set_input_files(payload(json.dumps(layout)))
        marks = page.locator(".plot-mark")
        await expect(marks).to_have_count(2)
        charts = page.locator(".plot-canvas .u-over")
        await expect(page.locator(".plot-value")).to_have_text(["1.5", "-1.5"])
        await charts.first.hover()
        await expect(marks.first).to_be_hidden()
        await expect(marks.last).to_be_visible()
        await expect(page.locator(".plot-notes").last).to_contain_text("At ")
        places = [await each.bounding_box() for each in (charts.first, marks.last)]
        assert places[0] is not None and places[1] is not None
        assert (
            abs(places[0]["x"] + places[0]["width"] / 2 - places[1]["x"]) < 0.1 * places[0]["width"]
        )
        await page.mouse.move(0, 0)
        await expect(marks.last).to_be_hidden()


async def test_choice_of_a_panel_is_filtered_and_stays_while_the_graph_changes(
    hub: HubServer, open_page: OpenPage
) -> None:
    async with fibws.Node("robot", hub=hub.url) as node:
        for number in range(20):
            await node.advertise(f"/fleet/robot_{number}/speed", Float64)
        page = await open_page(hub, DASHBOARD)
        await page.get_by_role("button", name="Add panel").click()
        chooser = page.locator(".pane-chooser:not([hidden])")
        echo = chooser.locator("details", has=page.locator("summary", has_text="Raw messages (20)"))
        await expect(echo.locator("button").first).to_be_hidden()
        await echo.locator("summary").click()
        button = echo.get_by_role("button", name="/fleet/robot_7/speed")
        await button.focus()
        scrolled = await chooser.evaluate("(element) => element.scrollTop = 40")
        await node.advertise("/fleet/robot_20/speed", Float64)
        other = chooser.locator(
            "details", has=page.locator("summary", has_text="Raw messages (21)")
        )
        added = other.get_by_role("button", name="/fleet/robot_20/speed")
        await expect(added).to_be_visible()
        await expect(other.get_by_role("button", name="/fleet/robot_7/speed")).to_be_focused()
        assert await chooser.evaluate("(element) => element.scrollTop") == scrolled
        await page.get_by_label("Filter views").fill("echo robot_7/")
        buttons = chooser.locator(".pane-offers button")
        await expect(buttons).to_have_text(["/fleet/robot_7/speed"])
        await page.get_by_label("Filter views").fill("nothing such")
        await expect(chooser).to_contain_text("No views match the filter.")
        await page.get_by_label("Filter views").fill("echo robot_7/")
        await buttons.click()
        chosen = pane(page, "Raw messages /fleet/robot_7/speed")
        # What it is stays whole, whatever the length of the name.
        label = chosen.locator(".pane-title b")
        assert await label.evaluate("(element) => element.scrollWidth <= element.clientWidth")


@pytest.mark.parametrize("kind", ["laserScan", "Laser scan"])
async def test_layouts_have_ids_of_layers_in_place_of_words(
    hub: HubServer, open_page: OpenPage, kind: str
) -> None:
    """Those of fibws 0.1 have the words."""
    layer = {"topic": "/scan", "type": "sensor_msgs/LaserScan", "kind": kind, "settings": {}}
    pane_ = {"view": "scene", "name": "", "config": {"layers": [layer]}}
    layout = {"schema": 1, "layout": pane_}
    page = await open_page(hub, DASHBOARD)
    await page.get_by_label("File with a layout").set_input_files(payload(json.dumps(layout)))
    await expect(page.locator(".scene-layer").filter(has_text="/scan")).to_contain_text(
        "Laser scan"
    )
    await page.locator("summary", has_text="More").click()
    async with page.expect_download() as download:
        await page.get_by_role("button", name="Export as a file").click()
    saved = json.loads(await asyncio.to_thread((await (await download.value).path()).read_text))
    assert [each["kind"] for each in saved["layout"]["config"]["layers"]] == ["laserScan"]


COLOURS = """[...document.querySelectorAll(".transitions li canvas")].map((canvas) => {
    const {data} = canvas.getContext("2d").getImageData(0, 1, canvas.width, 1);
    const pixels = new Uint32Array(data.buffer).filter((_, at) => data[4 * at + 3] === 255);
    return new Set(pixels).size;
}).join()"""
"""How many colours the spans of each row have."""


async def test_states_are_spans_of_colours(hub: HubServer, open_page: OpenPage) -> None:
    states = "/battery:power_supply_status,/mode:data,/on:data"
    layout = {
        "schema": 1,
        "layout": {"view": "transitions", "name": "", "config": {"states": states}},
    }
    async with fibws.Node("robot", hub=hub.url) as node:
        battery = await node.advertise("/battery", BatteryState, latch=True)
        await battery.publish(power_supply_status=BatteryState.POWER_SUPPLY_STATUS_CHARGING)
        mode = await node.advertise("/mode", String, latch=True)
        await mode.publish(data="manual")
        switch = await node.advertise("/on", Bool, latch=True)
        await switch.publish(data=True)
        page = await open_page(hub, DASHBOARD)
        await page.get_by_label("File with a layout").set_input_files(payload(json.dumps(layout)))
        panel = pane(page, "State transitions")
        values = panel.locator(".transitions-head output")
        await expect(values).to_have_text(["CHARGING", "manual", "true"])
        await battery.publish(power_supply_status=BatteryState.POWER_SUPPLY_STATUS_FULL)
        await switch.publish(data=False)
        await expect(values).to_have_text(["FULL", "manual", "false"])
        await until(page, f"{COLOURS} === '2,1,2'")
        # In another panel, the mouse would point to the same time.
        canvas = panel.locator("canvas").first
        box = await canvas.bounding_box()
        assert box is not None
        await page.mouse.move(box["x"] + 1, box["y"] + 5)
        await expect(panel).to_contain_text("At ")
        await expect(values).to_have_text(["\N{EN DASH}"] * 3)
        await page.mouse.move(0, 0)
        await expect(values).to_have_text(["FULL", "manual", "false"])
        await panel.get_by_role("button", name="Remove /mode data").click()
        await expect(values).to_have_text(["FULL", "false"])
        await panel.get_by_label("Topic to show").select_option("/mode")
        await expect(panel.get_by_label("Field to show")).to_have_value("data")
        await panel.get_by_role("button", name="Show", exact=True).click()
        await expect(values).to_have_text(["FULL", "false", "manual"])
        await page.reload()
        await expect(values).to_have_text(["FULL", "false", "manual"])


async def test_fields_of_an_echo_are_dragged_onto_plots_and_states(
    hub: HubServer, open_page: OpenPage
) -> None:
    views = ["echo", "plot", "transitions"]
    items = [{"view": view, "name": "/scan" if view == "echo" else ""} for view in views]
    layout = {"schema": 1, "layout": {"split": "row", "items": items}}
    async with fibws.Node("robot", hub=hub.url) as node:
        scans = await node.advertise("/scan", LaserScan, latch=True)
        await scans.publish(range_max=8.0, ranges=[1.0, 2.0], header=Header(frame_id="laser"))
        page = await open_page(hub, DASHBOARD)
        await page.get_by_label("File with a layout").set_input_files(payload(json.dumps(layout)))
        plot, states = pane(page, "Plot"), pane(page, "State transitions")

        async def drag(path: str, target: Locator) -> None:
            # The mouse would miss: rows move while the panels beside them are laid out.
            transfer = {"dataTransfer": await page.evaluate_handle("new DataTransfer()")}
            field = pane(page, "Raw messages").locator(f'[data-field="{path}"]')
            await field.dispatch_event("dragstart", transfer)
            for event in ("dragenter", "dragover", "drop"):
                await target.dispatch_event(event, transfer)

        await drag("range_max", plot.locator(".plot-pane"))
        await expect(plot.locator(".plot-name")).to_have_text("/scan range_max")
        await expect(plot.locator(".plot-value")).to_have_text("8")
        # Onto the chart, too; of an array, all elements.
        await drag("ranges[:]", plot.locator(".plot-canvas"))
        await expect(plot.locator(".plot-name").last).to_have_text("/scan ranges[:]")
        await expect(plot.locator(".plot-name")).to_have_count(2)
        await drag("header.frame_id", states.locator(".plot-pane"))
        await expect(states.locator("output")).to_have_text("laser")


async def test_title_of_a_narrow_panel_is_not_covered(robot: Robot, open_page: OpenPage) -> None:
    page = await open_robot(robot, open_page, width=800)
    bar = page.get_by_role("separator").first
    await bar.focus()
    for _ in range(3):
        await page.keyboard.press("Shift+ArrowLeft")
    camera = pane(page, "Image /camera")
    assert (await box(camera))[2] < 200
    title = camera.get_by_role("button", name="Image /camera")
    tools = camera.locator(".pane-tools")
    left, _, width, _ = await box(title)
    assert left + width <= (await box(tools))[0] + 1
    await expect(camera.get_by_role("button", name="Split")).to_have_count(0)
    # What is not in the head is in the choice that the title opens.
    await title.click()
    await camera.get_by_role("button", name="Split below").click()
    await expect_panes(page, [FOUR[0], "New panel", *FOUR[1:]])


@asynccontextmanager
async def phone(robot: Robot, open_page: OpenPage, width: int, height: int) -> AsyncIterator[Page]:
    yield await open_robot(
        robot, open_page, width=width, height=height, has_touch=True, is_mobile=True
    )


async def test_a_phone_has_panels_below_one_another(robot: Robot, open_page: OpenPage) -> None:
    async with phone(robot, open_page, 390, 844) as page:
        boxes = [await box(panes(page).nth(number)) for number in range(4)]
        assert all(h == pytest.approx(0.6 * 844, abs=1) for _, _, _, h in boxes)
        assert [top for _, top, *_ in boxes] == sorted(top for _, top, *_ in boxes)
        await robot.subscribed("/camera", "/map")
        await pane(page, "Diagnostics").scroll_into_view_if_needed()
        await robot.subscribed("/diagnostics")
        assert await page.evaluate("document.documentElement.scrollWidth") == 390

        await pane(page, "Diagnostics").get_by_role("button", name="Maximize").tap()
        _, top, width, height = await box(pane(page, "Diagnostics"))
        assert (top, width) == (0, 390) and height > 780
        dots = page.get_by_role("navigation", name="Panels")
        for button in await dots.get_by_role("button").all():
            assert min((await box(button))[2:]) >= 44
        await dots.get_by_role("button", name="Map /map").tap()
        await expect(pane(page, "Map")).to_be_visible()
        await expect(pane(page, "Diagnostics")).to_be_hidden()
        await robot.subscribed("/map")
        await dots.get_by_role("button", name="All panels").tap()
        await expect(pane(page, "Image")).to_be_visible()


async def test_a_phone_on_its_side_has_a_stick_at_each_thumb(
    robot: Robot, open_page: OpenPage
) -> None:
    async with phone(robot, open_page, 844, 390) as page:
        await expect(pane(page, "Image")).to_be_visible()
        await expect(pane(page, "Map")).to_be_hidden()
        left, right = [
            await box(page.locator(each)) for each in (".teleop-stick >> nth=0", ".teleop-turn")
        ]
        assert left[0] + left[2] < 250 and right[0] > 844 - 250
        assert left[2] == pytest.approx(left[3], abs=1)

        # Both thumbs at once: one drives, the other one turns.
        touch = await page.context.new_cdp_session(page)
        at = [(x + w / 2, y + h / 2) for x, y, w, h in (left, right)]
        points = [{"x": x, "y": y, "id": number} for number, (x, y) in enumerate(at)]
        await touch.send("Input.dispatchTouchEvent", {"type": "touchStart", "touchPoints": points})
        points[0]["y"] -= left[2] / 2
        points[1]["x"] -= right[2] / 2
        await touch.send("Input.dispatchTouchEvent", {"type": "touchMove", "touchPoints": points})
        async with asyncio.timeout(60):
            async for command in robot.commands:
                if command.linear.x == pytest.approx(0.5) and command.angular.z > 0.99:
                    break
        await touch.send("Input.dispatchTouchEvent", {"type": "touchEnd", "touchPoints": []})
        async with asyncio.timeout(60):
            async for command in robot.commands:
                if command == Twist():
                    break
        await touch.detach()
        await page.get_by_role("button", name="All panels").tap()
        await expect(pane(page, "Map")).to_be_visible()
        await page.set_viewport_size({"width": 390, "height": 844})
        await expect(page.locator(".teleop-turn")).to_be_hidden()


async def test_keyboard_alone_builds_a_layout(robot: Robot, open_page: OpenPage) -> None:
    page = await open_robot(robot, open_page)
    await page.get_by_role("button", name="Add panel").focus()
    await page.keyboard.press("Enter")
    await expect(pane(page, "New panel")).to_be_focused()
    console = pane(page, "New panel").get_by_role("button", name="Console", exact=True)
    await console.focus()
    await page.keyboard.press("Enter")
    await expect(pane(page, "Console")).to_be_focused()
    await pane(page, "Console").get_by_role("button", name="Maximize").focus()
    await page.keyboard.press("Enter")
    await expect(pane(page, "Map")).to_be_hidden()
    await page.keyboard.press("Escape")
    await expect(pane(page, "Map")).to_be_visible()
    title = pane(page, "Map").get_by_role("button", name="Map /map")
    await title.focus()
    await page.keyboard.press("Enter")
    await expect(title).to_have_attribute("aria-expanded", "true")
    await page.keyboard.press("Escape")
    await expect(title).to_have_attribute("aria-expanded", "false")
    await pane(page, "Map").get_by_role("button", name="Close").focus()
    await page.keyboard.press("Enter")
    await expect(pane(page, "Map")).to_have_count(0)
    await expect(page.locator(".pane:focus")).to_have_count(1)
    summary = page.get_by_text("More", exact=True)
    await summary.focus()
    await page.keyboard.press("Enter")
    await expect(page.get_by_role("button", name="Export")).to_be_visible()
    await page.keyboard.press("Escape")
    await expect(page.get_by_role("button", name="Export")).to_be_hidden()


async def test_nothing_is_drawn_while_nothing_changes(robot: Robot, open_page: OpenPage) -> None:
    page = await open_robot(robot, open_page, has_clock=True)
    await expect(pane(page, "Image")).to_contain_text("without an image")
    await page.evaluate(
        """() => {
            window.changes = 0;
            const observer = new MutationObserver((all) => { window.changes += all.length; });
            const panes = document.querySelector('.dashboard');
            observer.observe(panes, {subtree: true, childList: true});
        }"""
    )
    before, seconds = await page.evaluate("Date.now()"), 10
    await page.clock.run_for(1000 * seconds)
    changes, after = await page.evaluate("[changes, Date.now()]")
    # The age of the image is text that changes once in a second.
    assert changes < 5 * (after - before) / 1000
