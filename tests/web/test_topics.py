"""The Topics tab of the page: list, echo, plot and form to publish, in a real browser."""

from __future__ import annotations

import asyncio
import csv
import json
import re
import time
from collections.abc import AsyncIterator
from itertools import count
from math import cos, inf, isnan, nan, pi, sin
from typing import Any

import pytest
from playwright.async_api import Locator, Page, expect
from websockets.asyncio.client import connect
from websockets.typing import Subprotocol

import fibws
from fibws.hub.server import HubServer
from fibws.msg.actionlib_msgs import GoalStatus
from fibws.msg.actionlib_tutorials import FibonacciActionFeedback
from fibws.msg.geometry_msgs import Point, PointStamped, Pose, PoseStamped
from fibws.msg.sensor_msgs import JointState, LaserScan
from fibws.msg.std_msgs import (
    Float64,
    Float64MultiArray,
    Header,
    Int8,
    Int32,
    Int64,
    String,
    UInt8MultiArray,
)

from .conftest import OpenPage, fixture, until

MARKUP = "<img src=x onerror='window.harmed = true'>"
FIBONACCI = "#/topics/%2Ffibonacci"


@fixture
async def node(hub: HubServer) -> AsyncIterator[fibws.Node]:
    async with fibws.Node("robot", hub=hub.url) as node:
        yield node


async def publish_fibonacci(node: fibws.Node, topic: str = "/fibonacci") -> None:
    """Publish the Fibonacci numbers at 20 Hz, repeatedly, until cancelled."""
    numbers = await node.advertise(topic, Int32)
    while True:
        one, other = 0, 1
        while one < 2**31:
            await numbers.publish(data=one)
            one, other = other, one + other
            await asyncio.sleep(0.05)


@fixture
async def fibonacci(node: fibws.Node) -> AsyncIterator[None]:
    """Publish the Fibonacci numbers on /fibonacci."""
    task = asyncio.create_task(publish_fibonacci(node))
    yield
    task.cancel()


def row(page: Page, topic: str) -> Locator:
    """Return the row of a topic in the list."""
    return page.locator(".browse-list tbody tr").filter(has=page.get_by_text(topic, exact=True))


def curve(page: Page, name: str) -> Locator:
    """Return the entry of a curve in the legend."""
    return page.locator(".plot-legend li").filter(has_text=name)


def value(page: Page, key: str) -> Locator:
    """Return the value of a field in the echo."""
    key_of = page.locator(".tree-key", has_text=re.compile(f"^{re.escape(key)}:$"))
    return page.locator(".echo .tree-leaf").filter(has=key_of).locator(".tree-value")


async def open_publish(page: Page) -> None:
    await page.locator("details.section > summary", has_text="Publish").click()


async def test_list_has_types_and_rates(
    hub: HubServer, fibonacci: None, open_page: OpenPage
) -> None:
    page = await open_page(hub, "#/topics")
    cells = row(page, "/fibonacci")
    await expect(cells.locator(".col-type")).to_have_text("std_msgs/Int32")
    await expect(cells.locator(".col-publishers")).to_have_text("1")
    await expect(cells.locator(".col-rate")).to_have_text(re.compile(r"^[\d.]*[1-9][\d.]* Hz$"))
    await expect(cells.locator(".col-bandwidth")).to_have_text(re.compile(r"B/s$"))


async def test_list_is_sorted_and_filtered_and_hides_topics_of_the_hub(
    hub: HubServer, node: fibws.Node, open_page: OpenPage
) -> None:
    for topic, kind in (("/b", Int32), ("/a", String), ("/c", Int32)):
        await node.advertise(topic, kind)
    page = await open_page(hub, "#/topics")
    names = page.locator(".browse-list tbody th a")
    await expect(names).to_have_text(["/a", "/b", "/c"])
    await page.get_by_role("button", name="Type").click()
    await expect(page.locator("th.col-type")).to_have_attribute("aria-sort", "ascending")
    await expect(names).to_have_text(["/b", "/c", "/a"])
    await page.get_by_role("button", name="Type").click()
    await expect(names).to_have_text(["/a", "/b", "/c"])
    await page.get_by_label("Filter topics").fill("int32 -/c")
    await expect(names).to_have_text(["/b"])
    await page.get_by_label("Filter topics").fill("rosout")
    await expect(page.get_by_text("No topics match")).to_be_visible()
    await page.get_by_label("Debug").check()
    await expect(names).to_have_text(["/rosout", "/rosout_agg"])


async def test_link_has_the_filter_the_order_and_the_topic(
    hub: HubServer, node: fibws.Node, fibonacci: None, open_page: OpenPage
) -> None:
    await node.advertise("/robot/scan", LaserScan)
    page = await open_page(hub, "#/topics")
    await page.get_by_label("Filter").fill("/robot -/rosout")
    await page.get_by_role("checkbox", name="Debug").check()
    await page.get_by_role("button", name="Rate").click()
    await row(page, "/fibonacci").click()
    await expect(page).to_have_url(re.compile("/%2Ffibonacci[?].*sort=-rate"))
    copy = await open_page(hub, "#" + page.url.partition("#")[2])
    await expect(copy.get_by_label("Filter")).to_have_value("/robot -/rosout")
    await expect(copy.get_by_role("checkbox", name="Debug")).to_be_checked()
    await expect(copy.get_by_role("columnheader", name="Rate")).to_have_attribute(
        "aria-sort", "descending"
    )
    # The node /robot publishes both; /rosout, too, but this is excluded.
    await expect(row(copy, "/rosout")).to_have_count(0)
    await expect(row(copy, "/robot/scan")).to_have_count(1)
    await expect(copy.get_by_role("article", name="/fibonacci")).to_be_visible()


async def test_names_are_broken_only_after_slashes_and_underscores(
    hub: HubServer, node: fibws.Node, open_page: OpenPage
) -> None:
    name = "/kitchen_robot/front_laser_scanner/detected_obstacles/all_of_them_together"
    await node.advertise(name, FibonacciActionFeedback)
    page = await open_page(hub, "#/topics", width=390)
    await row(page, name).wait_for()
    lines = """
        element => {
            const lines = [];
            const walker = document.createTreeWalker(element, NodeFilter.SHOW_TEXT);
            while (walker.nextNode()) {
                for (let at = 0; at < walker.currentNode.length; at += 1) {
                    const range = document.createRange();
                    range.setStart(walker.currentNode, at);
                    range.setEnd(walker.currentNode, at + 1);
                    const top = Math.round(range.getBoundingClientRect().top);
                    if (lines.at(-1)?.top !== top) lines.push({top, text: ""});
                    lines.at(-1).text += range.toString();
                }
            }
            return lines.map(({text}) => text);
        }
    """
    for selector in (".browse-list th a", ".browse-list .type-below", ".browse-page h2"):
        if selector == ".browse-page h2":
            await row(page, name).click()
        broken = await page.locator(selector).first.evaluate(lines)
        assert len(broken) > 1
        assert all(line.endswith(("/", "_")) for line in broken[:-1]), broken


async def test_rows_are_not_replaced_while_numbers_change(
    hub: HubServer, fibonacci: None, open_page: OpenPage
) -> None:
    page = await open_page(hub, "#/topics")
    await expect(row(page, "/fibonacci").locator(".col-rate")).to_contain_text("Hz")
    await page.evaluate("""() => {
        window.rows = [...document.querySelectorAll(".browse-list tbody tr")];
        window.changes = [];
        new MutationObserver(all => window.changes.push(...all.map(each => each.target.className)))
            .observe(document.querySelector(".browse-list tbody"),
                     {subtree: true, childList: true});
    }""")
    await until(page, "window.changes.length > 0")
    assert "" not in await page.evaluate("window.changes"), (
        "only cells may change; unlike the body, they have a class"
    )
    assert await page.evaluate(
        "window.rows.every((row, at) => row === document.querySelectorAll('tbody tr')[at])"
    )


async def test_echo_shows_the_newest_message_until_paused(
    hub: HubServer, node: fibws.Node, open_page: OpenPage
) -> None:
    numbers = await node.advertise("/fibonacci", Int32, latch=True)
    await numbers.publish(data=8)
    page = await open_page(hub, FIBONACCI)
    await expect(value(page, "data")).to_have_text("8")
    await numbers.publish(data=13)
    await expect(value(page, "data")).to_have_text("13")
    await page.get_by_role("button", name="Plot data").click()
    plotted = curve(page, "/fibonacci data").locator("output")
    await expect(plotted).to_have_text("13")
    # The latched message came again, but only for the plot.
    count = page.locator(".echo-count")
    await expect(count).to_contain_text("2 messages shown")

    await page.locator(".echo").focus()
    await page.keyboard.press("Space")
    await expect(page.get_by_role("button", name="Resume")).to_be_visible()
    for number in (21, 34):
        await numbers.publish(data=number)
        await expect(plotted).to_have_text(str(number))
    await expect(count).to_contain_text("paused · 2 messages shown")
    await expect(value(page, "data")).to_have_text("13")

    await page.locator(".echo").focus()
    await page.keyboard.press("Space")
    await numbers.publish(data=55)
    await expect(value(page, "data")).to_have_text("55")


async def test_echo_keeps_its_open_branches(
    hub: HubServer, node: fibws.Node, open_page: OpenPage
) -> None:
    scans = await node.advertise("/scan", LaserScan, latch=True)
    await scans.publish(ranges=[float(each) for each in range(1000)], header=Header(frame_id="a"))
    page = await open_page(hub, "#/topics/%2Fscan")
    # The scene is shown instead of it.
    await page.locator("details.section", has_text="Raw messages").locator("summary").first.click()
    summary = page.locator(".tree summary", has_text="ranges")
    await expect(summary).to_contain_text(
        re.compile(r"float32\[\] 1\u202f000 elements +0, 1, 2, 3, …")
    )
    await summary.click()
    await expect(value(page, "[49]")).to_have_text("49")
    await expect(value(page, "[50]")).to_have_count(0)
    await page.get_by_role("button", name="… 950 more").click()
    await expect(value(page, "[249]")).to_have_text("249")
    await scans.publish(ranges=[1.5] * 300, header=Header(frame_id="b"))
    await expect(value(page, "frame_id")).to_have_text('"b"')
    await expect(value(page, "[249]")).to_have_text("1.5")
    await expect(page.get_by_role("button", name="… 50 more")).to_be_visible()


@pytest.mark.parametrize(
    ("kind", "sent", "shown"),
    [
        (Int64, 2**53 + 1, "9007199254740993"),
        (Float64, -inf, "-inf"),
        (Float64, nan, "nan"),
        (Float64, -0.0, "-0"),
    ],
)
async def test_numbers_are_shown_saved_and_copied_as_they_were_sent(
    hub: HubServer, node: fibws.Node, open_page: OpenPage, kind: type, sent: float, shown: str
) -> None:
    numbers = await node.advertise("/n", kind, latch=True)
    await numbers.publish(data=sent)
    page = await open_page(hub, "#/topics/%2Fn/plot", permissions=["clipboard-read"])
    await expect(value(page, "data")).to_have_text(shown)
    await expect(curve(page, "/n data").locator("output")).to_have_text(shown)
    async with page.expect_download() as download:
        await page.get_by_role("button", name="CSV", exact=True).click()
    path = await (await download.value).path()
    _, *rows = csv.reader((await asyncio.to_thread(path.read_text)).splitlines())
    assert [line[1] for line in rows] == [shown]
    await page.get_by_role("button", name="Copy as JSON").click()
    copied = await page.evaluate("navigator.clipboard.readText()")
    assert repr(json.loads(copied)["data"]) == repr(None if isnan(sent) else sent)


async def test_text_that_is_not_utf8_is_shown_as_it_was_sent(
    hub: HubServer, open_page: OpenPage
) -> None:
    async with connect(hub.url, subprotocols=[Subprotocol("fibws.v1")]) as talker:
        advertise = {"op": "advertise", "topic": "/t", "type": "std_msgs/String", "publisher": 1}
        await talker.send(json.dumps({**advertise, "latch": True}))
        await talker.send(b"\1\1\0\0\0" + b"\4\0\0\0caf\xe9")
        page = await open_page(hub, "#/topics/%2Ft")
        await expect(value(page, "data")).to_have_text('"caf\\xe9"')


async def test_every_message_of_a_fast_topic_is_plotted_and_saved(
    hub: HubServer, node: fibws.Node, open_page: OpenPage
) -> None:
    """A burst of 2000 messages is more than the page draws in a second, by far."""
    numbers = await node.advertise("/n", Int32, latch=True, queue_size=2000)
    await numbers.publish(data=-1)
    page = await open_page(hub, "#/topics/%2Fn/plot")
    await expect(curve(page, "/n data").locator("output")).to_have_text("-1")
    for number in range(2000):
        await numbers.publish(data=number)
        if number % 100 == 0:
            await asyncio.sleep(0)
    await expect(curve(page, "/n data").locator("output")).to_have_text("1999")
    async with page.expect_download() as download:
        await page.get_by_role("button", name="CSV", exact=True).click()
    path = await (await download.value).path()
    _, *rows = csv.reader((await asyncio.to_thread(path.read_text)).splitlines())
    assert [int(line[1]) for line in rows] == [*range(-1, 2000)]


async def test_markup_is_not_interpreted(
    hub: HubServer, node: fibws.Node, open_page: OpenPage
) -> None:
    words = await node.advertise("/chatter", String, latch=True)
    await words.publish(data=MARKUP)
    page = await open_page(hub, "#/topics/%2Fchatter")
    await expect(value(page, "data")).to_have_text(f'"{MARKUP}"')
    await open_publish(page)
    await page.get_by_label("data string").fill(MARKUP * 2)
    await page.get_by_role("button", name="Publish", exact=True).click()
    await expect(value(page, "data")).to_have_text(f'"{MARKUP * 2}"')
    await page.goto(f"{page.url.split('#')[0]}#/topics/%2F%3Cimg%20src%3Dx%20onerror%3Dalert(1)%3E")
    await expect(page.locator(".browse-page h2")).to_have_text("/<img src=x onerror=alert(1)>")
    assert await page.evaluate("window.harmed") is None
    assert await page.locator("img").count() == 0


INK = """(number = 0) => {
    const canvas = document.querySelector(".plot-canvas .u-over > canvas");
    if (canvas === null || canvas.width === 0) return 0;
    const [width, height] = [canvas.width, canvas.height];
    const copy = new OffscreenCanvas(width, height + 1);
    const context = copy.getContext("2d", {willReadFrequently: true});
    context.drawImage(canvas, 0, 0);
    const swatch = document.querySelectorAll(".plot-legend .swatch")[Number(number) || 0];
    context.fillStyle = getComputedStyle(swatch).color;
    context.fillRect(0, height, 1, 1);
    const wanted = context.getImageData(0, height, 1, 1).data;
    const {data} = context.getImageData(0, 0, width, height);
    const columns = new Set();
    for (let at = 0; at < data.length; at += 4) {
        if ([0, 1, 2].every(part => data[at + part] === wanted[part]) && data[at + 3] === 255)
            columns.add(at / 4 % width);
    }
    return number === "places" ? [...columns].sort((one, other) => one - other) : columns.size;
}"""
"""The number of columns of the canvas in which a curve has pixels, by default the first one."""


async def open_settings(page: Page) -> None:
    """Show the settings of the plot."""
    await page.locator(".plot").get_by_role("button", name="Settings").click()


async def saved(page: Page, button: str) -> list[list[str]]:
    """Return the rows of the file that a button of the plot saves, the head first."""
    async with page.expect_download() as download:
        await page.locator(".plot").get_by_role("button", name=button, exact=True).click()
    path = await (await download.value).path()
    return [*csv.reader((await asyncio.to_thread(path.read_text)).splitlines())]


async def test_plot_draws_a_curve(hub: HubServer, fibonacci: None, open_page: OpenPage) -> None:
    page = await open_page(hub, "#/topics")
    await row(page, "/fibonacci").get_by_role("button", name="Plot").click()
    output = curve(page, "/fibonacci data").locator("output")
    await expect(output).to_have_text(re.compile(r"^\d{4,}$"))
    await until(page, f"({INK})() > 300")
    await open_settings(page)
    await page.get_by_label("Logarithmic", exact=True).check()
    await until(page, f"({INK})() > 300")
    await expect(page.locator(".plot-notes")).to_contain_text("logarithmic axis")
    shown = [await output.inner_text()]
    while len(shown) < 3:
        await expect(output).not_to_have_text(shown[-1])
        shown.append(await output.inner_text())


async def test_labels_of_the_axis_follow_the_values(
    hub: HubServer, node: fibws.Node, open_page: OpenPage
) -> None:
    collect = """
        const {fillText} = CanvasRenderingContext2D.prototype;
        window.texts = new Set();
        CanvasRenderingContext2D.prototype.fillText = function(text, ...place) {
            texts.add(text);
            return fillText.call(this, text, ...place);
        };
    """
    numbers = await node.advertise("/n", Float64, latch=True)
    await numbers.publish(data=1.0)
    page = await open_page(hub, "#/topics/%2Fn/plot", prepare=collect)
    below_zero = "[...texts].some((text) => /^-\\d/.test(text))"
    await until(page, "texts.has('now') && texts.size > 4")
    assert not await page.evaluate(below_zero)
    await numbers.publish(data=-50.0)
    await until(page, below_zero)


async def test_samples_of_a_plot_are_saved_as_csv(
    hub: HubServer, node: fibws.Node, open_page: OpenPage
) -> None:
    joints = await node.advertise("/joint_states", JointState, latch=True)
    await joints.publish(JointState(name=["hip", "knee, left"], position=[0.5, 1.5]))
    temperature = await node.advertise("/temperature", Float64, latch=True)
    await temperature.publish(data=-0.25)
    page = await open_page(hub, "#/topics/%2Fjoint_states")
    await page.get_by_label("Field to plot").fill("position[1]")
    await page.keyboard.press("Enter")
    await row(page, "/temperature").get_by_role("button", name="Plot").click()
    await expect(curve(page, "position[knee, left]").locator("output")).to_have_text("1.5")
    await expect(curve(page, "/temperature").locator("output")).to_have_text("-0.25")
    async with page.expect_download() as download:
        await page.get_by_role("button", name="CSV", exact=True).click()
    saved = await download.value
    assert saved.suggested_filename == "plot.csv"
    text = await asyncio.to_thread((await saved.path()).read_text)
    head, *rows = csv.reader(text.splitlines())
    assert head == ["time", "/joint_states position[knee, left]", "/temperature data"]
    assert sorted(line[1:] for line in rows) == [["", "-0.25"], ["1.5", ""]]
    assert all(abs(float(at) - time.time()) < 120 for at, *_ in rows)


async def test_plot_has_several_fields_of_several_topics(
    hub: HubServer, node: fibws.Node, open_page: OpenPage
) -> None:
    poses = await node.advertise("/pose", PoseStamped, latch=True)
    temperature = await node.advertise("/temperature", Float64, latch=True)
    await poses.publish(pose=Pose(position=Point(x=1.5, y=2.5)))
    await temperature.publish(data=-0.25)
    page = await open_page(hub, "#/topics/%2Fpose")
    for path in ("pose.position.x", "pose.position.y"):
        await page.get_by_label("Field to plot").fill(path)
        await page.keyboard.press("Enter")
    await row(page, "/temperature").get_by_role("button", name="Plot").click()
    for name, text in (("position.x", "1.5"), ("position.y", "2.5"), ("/temperature", "-0.25")):
        await expect(curve(page, name).locator("output")).to_have_text(text)
    await page.get_by_role("link", name="Graph", exact=True).click()
    await page.get_by_role("link", name="Topics", exact=True).click()
    await expect(page.locator(".plot-legend li")).to_have_count(3)
    await page.locator(".plot-fold").click()
    await page.get_by_role("button", name="Remove /temperature data").click()
    await expect(page.locator(".plot-legend li")).to_have_count(2)
    await page.get_by_role("button", name="Close the plot").click()
    await expect(page.locator(".plot-legend li")).to_have_count(0)
    await expect(page.locator(".plot")).to_be_hidden()


async def test_plot_moves_by_drawing_only_what_is_new(
    hub: HubServer, node: fibws.Node, open_page: OpenPage
) -> None:
    """Neither the axes nor the drawn part of a curve are drawn again while it moves."""
    numbers = await node.advertise("/number", Int32)

    async def publish() -> None:
        for number in count():
            await numbers.publish(data=number % 2)
            await asyncio.sleep(0.05)

    publishing = asyncio.create_task(publish())
    page = await open_page(hub, "#/topics?plot=/number:data&range=10")
    # From then on, neither axis grows: all numbers have been drawn, and some are older.
    await until(page, f"({INK})() > 0.9 * document.querySelector('.plot-canvas').clientWidth")
    await page.evaluate("""() => {
        const {fillText, lineTo, drawImage} = CanvasRenderingContext2D.prototype;
        window.counts = {texts: 0, lines: 0, moves: 0};
        const count = (name, original) => function(...all) {
            window.counts[name] += 1;
            return original.apply(this, all);
        };
        Object.assign(CanvasRenderingContext2D.prototype, {
            fillText: count("texts", fillText),
            lineTo: count("lines", lineTo),
            drawImage: count("moves", drawImage),
        });
    }""")
    await until(page, "counts.moves > 30")
    counts = await page.evaluate("counts")
    publishing.cancel()
    # All is drawn again when the samples from before have left the axes.
    assert counts["texts"] < 80, counts
    assert counts["lines"] < 1000, counts


async def test_curves_of_different_size_can_have_own_axes(
    hub: HubServer, node: fibws.Node, open_page: OpenPage
) -> None:
    points = await node.advertise("/point", Point, latch=True)
    page = await open_page(hub, "#/topics/%2Fpoint/plot")
    await expect(page.locator(".plot-legend li")).to_have_count(3)
    notes = page.locator(".plot-notes")
    async with asyncio.timeout(60):
        for each in (1.0, 2.0):
            await points.publish(x=each, y=1000 * each, z=0.0)
            await expect(curve(page, "/point y").locator("output")).to_have_text(f"{1000 * each:g}")
    await expect(notes).to_contain_text("flat")
    await open_settings(page)
    await page.get_by_label("Own axes").check()
    await expect(notes).not_to_contain_text("flat")
    await expect(curve(page, "/point x")).to_contain_text("1 … 2")
    await expect(curve(page, "/point y")).to_contain_text("1000 … 2000")


@fixture
async def circle(node: fibws.Node) -> fibws.Publisher[Any]:
    return await node.advertise("/circle", PointStamped, latch=True, queue_size=99)


async def publish_circle(points: fibws.Publisher[Any], count: int = 41) -> None:
    """Publish points of a circle, whose stamps are those of the last seconds, 0.1 s apart."""
    start = time.time() - 0.1 * count
    for at in range(count):
        angle = 2 * pi * at / (count - 1)
        stamp = fibws.Time.from_sec(start + 0.1 * at)
        point = Point(x=2 + cos(angle), y=sin(angle), z=float(at))
        await points.publish(header=Header(stamp=stamp), point=point)


async def test_part_of_a_plot_is_zoomed_to_moved_and_saved(
    hub: HubServer, circle: fibws.Publisher[Any], open_page: OpenPage
) -> None:
    page = await open_page(hub, "#/topics?plot=/circle:point.z&range=600")
    await expect(row(page, "/circle").locator(".col-subscribers")).to_have_text("1")
    await publish_circle(circle)
    await expect(curve(page, "point.z").locator("output")).to_have_text("40")
    # So that the places stay.
    await page.locator(".plot").get_by_role("button", name="Pause").click()
    assert [int(line[1]) for line in (await saved(page, "CSV"))[1:]] == [*range(41)]

    async def seen() -> list[int]:
        numbers = [int(line[1]) for line in (await saved(page, "CSV of view"))[1:]]
        assert numbers == [*range(numbers[0], numbers[-1] + 1)]
        return numbers

    show_all = page.locator(".plot").get_by_role("button", name="Show all")
    await expect(show_all).to_be_hidden()
    await until(page, f"({INK})() > 20")
    places = await page.evaluate(f"({INK})('places')")
    chart = page.locator(".plot-canvas .u-over")
    box = await chart.bounding_box()
    assert box is not None
    middle = box["y"] + box["height"] / 2
    await page.mouse.move(box["x"] + max(1, places[0] - 9), middle)
    await page.mouse.down()
    await page.mouse.move(box["x"] + (places[0] + places[-1]) / 2, middle, steps=3)
    await page.mouse.up()
    await expect(show_all).to_be_visible()
    first = await seen()
    assert 5 < len(first) < 35
    await expect(curve(page, "point.z")).to_contain_text(
        f"{first[0]} \N{HORIZONTAL ELLIPSIS} {first[-1]}"
    )
    # The button has got the mouse.
    await chart.hover()
    await page.mouse.wheel(0, -500)
    await until(
        page, f"!document.querySelector('.plot-range').textContent.endsWith(' {first[-1]}')"
    )
    nearer = await seen()
    assert len(nearer) < len(first)
    await page.locator(".plot-canvas").focus()
    for _ in range(9):
        await page.keyboard.press("ArrowLeft")
    await until(
        page, f"!document.querySelector('.plot-range').textContent.endsWith(' {nearer[-1]}')"
    )
    assert (await seen())[-1] < nearer[-1]
    await page.locator(".plot-canvas").focus()
    await page.keyboard.press("Escape")
    await expect(show_all).to_be_hidden()
    assert len(await seen()) > len(first)


async def test_one_curve_is_drawn_over_another(
    hub: HubServer, circle: fibws.Publisher[Any], open_page: OpenPage
) -> None:
    page = await open_page(hub, "#/topics?plot=/circle:point.x,/circle:point.y&range=10")
    await expect(row(page, "/circle").locator(".col-subscribers")).to_have_text("1")
    await publish_circle(circle)
    await open_settings(page)
    await page.get_by_label("Horizontal axis").select_option("X-Y: the first curve")
    await until(page, f"({INK})(1) > 300")
    # The first one is the axis.
    assert await page.evaluate(f"({INK})(0)") == 0
    await page.get_by_label("Samples as").select_option("Points")
    await until(page, f"({INK})(1) > 60 && ({INK})(1) < 300")
    assert "across=xy" in page.url


async def test_elements_of_an_array_are_drawn_over_their_index(
    hub: HubServer, node: fibws.Node, open_page: OpenPage
) -> None:
    scans = await node.advertise("/scan", LaserScan, latch=True)
    await scans.publish(ranges=[1.0, 2.0, inf, 4.0])
    page = await open_page(hub, "#/topics/%2Fscan")
    await page.get_by_label("Field to plot").fill("ranges[:] * 2")
    await page.keyboard.press("Enter")
    await expect(curve(page, "ranges[:] * 2")).to_contain_text("2 \N{HORIZONTAL ELLIPSIS} 8")
    await until(page, f"({INK})() > 100")
    rows = [["index", "/scan ranges[:] * 2"], ["0", "2"], ["1", "4"], ["2", "inf"], ["3", "8"]]
    assert await saved(page, "CSV") == rows
    # The legend has the element under the mouse.
    box = await page.locator(".plot-canvas .u-over").bounding_box()
    assert box is not None
    await page.mouse.move(box["x"] + box["width"] - 2, box["y"] + 9)
    await expect(curve(page, "ranges[:]").locator("output")).to_have_text("8")


async def test_curve_of_simple_maths_with_fields(
    hub: HubServer, circle: fibws.Publisher[Any], open_page: OpenPage
) -> None:
    page = await open_page(hub, "#/topics/%2Fcircle")
    await publish_circle(circle, 2)
    for text in ("point.x * 3.6 + 1", "/circle.point.z^2 - 1", "derivative(point.z)", "point.x +"):
        await page.get_by_label("Field to plot").fill(text)
        await page.keyboard.press("Enter")
    await expect(curve(page, "point.x * 3.6 + 1").locator("output")).to_have_text("11.8")
    await expect(curve(page, "/circle point.z^2 - 1").locator("output")).to_have_text("0")
    await expect(page.locator(".plot-notes")).to_contain_text("Expected a field or a number")
    await publish_circle(circle, 3)
    await expect(curve(page, "derivative(point.z)").locator("output")).to_have_text(
        re.compile("^(10|9.99|10.0)")
    )
    await expect(page.locator(".plot-legend li")).to_have_count(3)
    link = await page.evaluate("location.hash")
    copy = await open_page(hub, link)
    await expect(curve(copy, "point.x * 3.6 + 1")).to_be_visible()
    await expect(copy.locator(".plot-legend li")).to_have_count(3)


async def test_plot_has_any_number_of_curves_and_loads_its_library_when_first_used(
    hub: HubServer, node: fibws.Node, open_page: OpenPage
) -> None:
    arrays = await node.advertise("/n", Float64MultiArray, latch=True)
    await arrays.publish(data=[float(at) for at in range(20)])
    page = await open_page(hub, "#/topics/%2Fn")
    names: list[str] = []
    page.on("request", lambda request: names.append(request.url.rsplit("/", 1)[-1]))
    await expect(value(page, "[19]")).to_have_count(0)
    assert not any(name.startswith("chart") for name in names)
    for at in range(20):
        await page.get_by_label("Field to plot").fill(f"data[{at}]")
        await page.keyboard.press("Enter")
    await expect(curve(page, "data[19]").locator("output")).to_have_text("19")
    assert any(name.startswith("chart") for name in names)
    looks = "[...document.querySelectorAll('.plot-legend .swatch')].map((each) => each.outerHTML)"
    assert len(set(await page.evaluate(looks))) == 20


async def test_elements_are_called_by_their_names(
    hub: HubServer, node: fibws.Node, open_page: OpenPage
) -> None:
    states = await node.advertise("/joint_states", JointState, latch=True)
    await states.publish(name=["shoulder", "elbow"], position=[0.5, 1.5])
    page = await open_page(hub, "#/topics/%2Fjoint_states")
    await expect(value(page, "[1] elbow")).to_have_text("1.5")
    await page.get_by_label("Field to plot").focus()
    await expect(page.locator("#topic-paths option[value='position[elbow]']")).to_have_count(1)
    await page.get_by_role("button", name="Plot position[elbow]").click()
    output = curve(page, "/joint_states position[elbow]").locator("output")
    await expect(output).to_have_text("1.5")
    await states.publish(name=["elbow"], position=[2.5])
    await expect(output).to_have_text("2.5")
    await expect(value(page, "[0] elbow")).to_have_text("2.5")
    await row(page, "/joint_states").get_by_role("button", name="Plot").click()
    await expect(page.locator(".plot-name").first).to_have_text("/joint_states position[elbow]")
    await expect(page.locator(".plot-name")).to_have_count(3)


async def test_plot_is_open_where_it_was_opened_and_a_line_elsewhere(
    hub: HubServer, node: fibws.Node, fibonacci: None, open_page: OpenPage
) -> None:
    await node.advertise("/other", Int32)
    page = await open_page(hub, FIBONACCI)
    chart = page.locator(".plot-canvas")
    await expect(page.locator(".plot")).to_be_hidden()
    await page.get_by_role("button", name="Plot data").click()
    await expect(chart).to_be_visible()
    await row(page, "/other").get_by_role("link").click()
    await expect(chart).to_be_hidden()
    await expect(curve(page, "/fibonacci data")).to_be_visible()
    fold = page.locator(".plot-fold")
    await expect(fold).to_have_attribute("aria-expanded", "false")
    await fold.click()
    await expect(chart).to_be_visible()
    await fold.click()
    await expect(chart).to_be_hidden()
    await row(page, "/fibonacci").get_by_role("link").click()
    await expect(chart).to_be_visible()
    await page.get_by_role("button", name="Close the plot").click()
    await expect(page.locator(".plot")).to_be_hidden()


async def test_link_reproduces_the_plot(
    hub: HubServer, node: fibws.Node, fibonacci: None, open_page: OpenPage
) -> None:
    poses = await node.advertise("/point", Point, latch=True)
    await poses.publish(x=1.0, y=2.0, z=3.0)
    page = await open_page(hub, f"{FIBONACCI}/plot")
    await row(page, "/point").get_by_role("button", name="Plot").click()
    await page.get_by_role("button", name="Remove /point y").click()
    await open_settings(page)
    await page.get_by_label("Own axes").check()
    await page.get_by_label("Samples as").select_option("Steps")
    await page.get_by_label("Time range").select_option("10 s")
    await until(page, "location.hash.includes('range=10')")
    link = await page.evaluate("location.hash")
    assert "plot=/fibonacci:data,/point:x,/point:z" in link.replace("%3A", ":"), link

    copy = await open_page(hub, link)
    names = copy.locator(".plot-name")
    await expect(names).to_have_text(["/fibonacci data", "/point x", "/point z"])
    await expect(copy.get_by_label("Own axes")).to_be_checked()
    await expect(copy.get_by_label("Samples as")).to_have_value("steps")
    await expect(copy.get_by_label("Time range")).to_have_value("10")
    await expect(curve(copy, "/point z").locator("output")).to_have_text("3")
    await copy.locator(".plot-fold").click()
    folded = await open_page(hub, await copy.evaluate("location.hash"))
    await expect(folded.locator(".plot-legend li")).to_have_count(3)
    await expect(folded.locator(".plot-canvas")).to_be_hidden()


async def test_paused_plot_does_not_change(
    hub: HubServer, node: fibws.Node, open_page: OpenPage
) -> None:
    numbers = await node.advertise("/fibonacci", Int32, latch=True)
    await numbers.publish(data=8)
    page = await open_page(hub, f"{FIBONACCI}/plot")
    output = curve(page, "/fibonacci data").locator("output")
    await expect(output).to_have_text("8")
    await page.locator(".plot").get_by_role("button", name="Pause").click()
    await numbers.publish(data=13)
    await expect(value(page, "data")).to_have_text("13")
    await expect(output).to_have_text("8")
    await page.locator(".plot").get_by_role("button", name="Resume").click()
    await expect(output).to_have_text("13")


async def test_plot_names_a_field_without_a_number(
    hub: HubServer, node: fibws.Node, open_page: OpenPage
) -> None:
    numbers = await node.advertise("/fibonacci", Int32, latch=True)
    await numbers.publish(data=8)
    page = await open_page(hub, FIBONACCI)
    await page.get_by_label("Field to plot").fill("nope[3]")
    await page.keyboard.press("Enter")
    await expect(page.locator(".plot-notes")).to_contain_text("nope[3]")


@pytest.mark.smoke
async def test_form_publishes_messages(
    hub: HubServer, node: fibws.Node, open_page: OpenPage
) -> None:
    page = await open_page(hub, "#/topics")
    await node.advertise("/status", GoalStatus)
    async with asyncio.timeout(60), node.subscribe("/status", GoalStatus) as received:
        await row(page, "/status").get_by_role("link").click()
        await open_publish(page)
        assert await page.locator("option[value='3']").inner_text() == "SUCCEEDED"
        await page.get_by_label("status uint8").fill("3")
        await page.get_by_label("text string").fill("well\ndone")
        await page.get_by_label("stamp time").fill("1.5")
        await page.keyboard.press("Enter")
        message = await anext(received)
        assert (message.status, message.text) == (3, "well\ndone")
        assert message.goal_id.stamp.to_sec() == 1.5
        await expect(page.get_by_text("1 message published")).to_be_visible()

        await page.get_by_label("as JSON").check()
        text = page.get_by_label("JSON of actionlib_msgs/GoalStatus")
        assert '"text": "well\\ndone"' in await text.input_value()
        await text.fill('{"status": 4}')
        await page.get_by_role("button", name="Publish", exact=True).click()
        assert (await anext(received)).status == 4
        await page.get_by_label("as JSON").uncheck()
        await expect(page.get_by_label("status uint8")).to_have_value("4")
        await expect(page.get_by_label("text string")).to_have_value("")


async def test_invalid_values_are_not_published(
    hub: HubServer, node: fibws.Node, open_page: OpenPage
) -> None:
    await node.advertise("/small", Int8)
    page = await open_page(hub, "#/topics/%2Fsmall")
    await open_publish(page)
    field = page.get_by_label("data int8")
    publish = page.get_by_role("button", name="Publish", exact=True)
    async with asyncio.timeout(60), node.subscribe("/small", Int8) as received:
        await field.fill("300")
        await publish.click()
        await expect(field).to_have_attribute("aria-invalid", "true")
        problems = page.locator(".form-problems")
        await expect(problems).to_have_text(re.compile("data: 300 .*-128 to 127"))
        await page.get_by_label("as JSON").check()
        text = page.get_by_label("JSON of std_msgs/Int8")
        for wrong, why in (
            ('{"data": 1.5}', "data: “1.5”"),
            ('{"dada": 1}', "dada: "),
            ("{", "Invalid JSON"),
        ):
            await text.fill(wrong)
            await publish.click()
            await expect(problems).to_contain_text(why)
        await text.fill('{"data": 7}')
        await publish.click()
        await expect(problems).to_be_empty()
        assert (await anext(received)).data == 7, "invalid messages must not be published"


async def test_large_integers_and_bytes_are_published_exactly(
    hub: HubServer, node: fibws.Node, open_page: OpenPage
) -> None:
    await node.advertise("/long", Int64)
    page = await open_page(hub, "#/topics/%2Flong")
    await open_publish(page)
    async with asyncio.timeout(60), node.subscribe("/long", Int64) as received:
        await page.get_by_label("data int64").fill("9007199254740993")
        await page.keyboard.press("Enter")
        assert (await anext(received)).data == 2**53 + 1
    await node.advertise("/bytes", UInt8MultiArray)
    async with asyncio.timeout(60), node.subscribe("/bytes", UInt8MultiArray) as bytes_received:
        await row(page, "/bytes").get_by_role("link").click()
        await open_publish(page)
        await page.get_by_label("data uint8[]").fill("[1, 2, 255]")
        await (
            page.locator("summary", has_text="layout")
            .locator("..")
            .locator("summary", has_text="dim")
            .click()
        )
        await page.get_by_role("button", name="Add an element to dim").click()
        await page.get_by_label("label string").fill("x")
        await page.keyboard.press("Enter")
        message = await anext(bytes_received)
        assert message.data == b"\x01\x02\xff"
        assert [each.label for each in message.layout.dim] == ["x"]


async def test_message_is_published_repeatedly_until_stopped(
    hub: HubServer, node: fibws.Node, open_page: OpenPage
) -> None:
    await node.advertise("/fibonacci", Int32)
    page = await open_page(hub, FIBONACCI)
    await open_publish(page)
    async with asyncio.timeout(60), node.subscribe("/fibonacci", Int32) as received:
        await page.get_by_label("data int32").fill("8")
        await page.get_by_label("Messages a second").fill("50")
        await page.get_by_role("button", name="Repeat").click()
        for _ in range(5):
            assert (await anext(received)).data == 8
        await page.get_by_role("button", name="Stop").click()
        await page.get_by_label("data int32").fill("13")
        await page.keyboard.press("Enter")
        while (await anext(received)).data == 8:
            pass
        await page.get_by_label("Messages a second").fill("1000")
        await page.get_by_role("button", name="Repeat").click()
        await expect(page.get_by_text("between 0.1 and 100 Hz")).to_be_visible()


async def test_new_topic_is_created_by_its_first_message(
    hub: HubServer, node: fibws.Node, open_page: OpenPage
) -> None:
    page = await open_page(hub, "#/topics")
    await page.get_by_role("button", name="New topic").click()
    form = page.locator(".new-topic")
    await form.get_by_label("Name").fill("two words")
    await page.keyboard.press("Enter")
    await expect(form.get_by_role("alert")).to_contain_text("“two words”")
    await form.get_by_label("Name").fill("chatter")
    await form.get_by_label("Type").fill("std_msgs/String")
    await page.keyboard.press("Enter")
    await expect(row(page, "/chatter")).to_be_visible()  # The page itself has subscribed.
    await expect(page.locator(".browse-page .notice")).to_contain_text("Nobody uses this topic yet")
    async with asyncio.timeout(60), node.subscribe("/chatter", String) as received:
        await node.flush()
        await page.get_by_label("data string").fill("hello")
        await page.keyboard.press("Enter")
        assert (await anext(received)).data == "hello"
        await expect(page.locator(".browse-page .notice")).to_be_hidden()


async def test_unknown_type_is_reported(hub: HubServer, open_page: OpenPage) -> None:
    page = await open_page(hub, "#/topics")
    await page.get_by_role("button", name="New topic").click()
    await page.locator(".new-topic").get_by_label("Name").fill("/x")
    await page.locator(".new-topic").get_by_label("Type").fill("std_msgs/Nope")
    await page.keyboard.press("Enter")
    await expect(page.locator(".browse-page .notice")).to_contain_text("std_msgs")


async def test_topic_page_has_connections_and_type(
    hub: HubServer, fibonacci: None, open_page: OpenPage
) -> None:
    page = await open_page(hub, FIBONACCI)
    await expect(page.get_by_role("link", name="/robot")).to_have_attribute(
        "href", "#/graph/node/%2Frobot"
    )
    await expect(page.locator(".browse-page")).to_contain_text(
        "this page, at most every 100 ms, queue 1"
    )
    await page.locator("details.section > summary", has_text="Type").click()
    await expect(page.locator(".section pre")).to_have_text("int32 data")


async def test_hidden_view_ends_its_subscriptions(
    hub: HubServer, node: fibws.Node, open_page: OpenPage
) -> None:
    await node.advertise("/fibonacci", Int32)
    page = await open_page(hub, f"{FIBONACCI}/plot")
    onlooker = await open_page(hub, "#/topics")
    subscribers = row(onlooker, "/fibonacci").locator(".col-subscribers")
    await expect(subscribers).to_have_text("1")
    await page.goto(f"{page.url.split('#')[0]}#/parameters")
    await expect(subscribers).to_have_text("0")


async def test_form_is_kept_while_another_view_is_shown(
    hub: HubServer, node: fibws.Node, open_page: OpenPage
) -> None:
    await node.advertise("/fibonacci", Int32)
    page = await open_page(hub, FIBONACCI)
    await open_publish(page)
    await page.get_by_label("data int32").fill("8")
    await page.get_by_role("link", name="Console").click()
    await expect(page.locator(".topics")).to_have_count(0)
    await page.go_back()
    await expect(page.get_by_label("data int32")).to_have_value("8")
    async with asyncio.timeout(60), node.subscribe("/fibonacci", Int32) as received:
        await page.get_by_role("button", name="Publish", exact=True).click()
        assert (await anext(received)).data == 8
        await expect(value(page, "data")).to_have_text("8")


@pytest.mark.parametrize("width", [360, 1280])
async def test_view_fits_the_width_of_the_window(
    hub: HubServer, fibonacci: None, node: fibws.Node, open_page: OpenPage, width: int
) -> None:
    await node.advertise("/a/very/long/name/of/a/topic/indeed/" + "x" * 60, PoseStamped)
    page = await open_page(hub, "#/topics", width=width, height=740)
    await row(page, "/fibonacci").get_by_role("button", name="Plot").click()
    await page.get_by_role("link", name="x" * 60).click()
    await open_publish(page)
    await expect(page.get_by_label("frame_id string")).to_be_visible()
    assert await page.evaluate("document.documentElement.scrollWidth") == width
    assert await page.evaluate("document.querySelector('.browse-place').scrollWidth") <= width
