"""The Graph tab of the page, in a real browser."""

from __future__ import annotations

import asyncio
import contextlib
import re
from collections.abc import AsyncIterator
from xml.etree import ElementTree
from xmlrpc.client import ServerProxy

import pytest
from playwright.async_api import FloatRect, Locator, Page, expect

import fibws
from fibws.action.actionlib_tutorials import Fibonacci
from fibws.hub import Settings
from fibws.hub.server import HubServer
from fibws.msg.actionlib_tutorials import FibonacciFeedback, FibonacciGoal, FibonacciResult
from fibws.msg.std_msgs import Int32, String
from fibws.srv.std_srvs import Trigger, TriggerRequest, TriggerResponse

from .conftest import OpenPage, until

Goal = fibws.ServerGoal[FibonacciGoal, FibonacciResult, FibonacciFeedback]


def element(page: Page, kind: str, name: str) -> Locator:
    return page.locator(f'.graph .element[data-id="{kind} {name}"]')


def edge(page: Page, start: str, end: str) -> Locator:
    return page.locator(f'.graph .edge[data-id="{start} > {end}"]')


@contextlib.asynccontextmanager
async def chain(
    hub: HubServer, publisher: str, topic: str, subscriber: str, namespace: str = "/"
) -> AsyncIterator[None]:
    """Run a node that publishes numbers at 20 Hz, and a subscriber."""
    async with (
        fibws.Node(publisher, hub=hub.url, namespace=namespace) as one,
        fibws.Node(subscriber, hub=hub.url) as two,
    ):
        numbers = await one.advertise(topic, Int32)
        received = two.subscribe(topic, Int32)

        async def publish() -> None:
            async for _ in one.rate(20):
                await numbers.publish(1)

        async def receive() -> None:
            async for _ in received:
                pass

        async with asyncio.TaskGroup() as tasks:
            running = [tasks.create_task(publish()), tasks.create_task(receive())]
            yield
            for task in running:
                task.cancel()


ALL_WITHIN = """(count, width, height) => {
    const nodes = [...document.querySelectorAll('.graph .element[data-id^="node "]')];
    return nodes.length >= count && nodes.every((node) => {
        const {left, right, top, bottom} = node.getBoundingClientRect();
        return left > 0 && right < width && top > 0 && bottom < height;
    });
}"""
"""Whether all nodes, at least so many, are within the window."""


async def middle(locator: Locator) -> tuple[float, float]:
    """Return the centre of an element, once it no longer moves."""
    await locator.wait_for()
    before = None
    while (box := await locator.bounding_box()) != before or box is None:
        before = box
        await locator.page.evaluate(
            "new Promise(done => requestAnimationFrame(() => requestAnimationFrame(done)))"
        )
    return box["x"] + box["width"] / 2, box["y"] + box["height"] / 2


@pytest.mark.smoke
async def test_publisher_topic_and_subscriber_are_drawn_from_left_to_right(
    hub: HubServer, open_page: OpenPage
) -> None:
    async with chain(hub, "talker", "/chatter", "listener"):
        page = await open_page(hub)
        await expect(page.locator(".graph .edge")).to_have_count(2)
        talker, _ = await middle(element(page, "node", "/talker"))
        chatter, _ = await middle(element(page, "topic", "/chatter"))
        listener, _ = await middle(element(page, "node", "/listener"))
        assert talker < chatter < listener


async def test_edges_show_rates(hub: HubServer, open_page: OpenPage) -> None:
    async with chain(hub, "talker", "/chatter", "listener"):
        page = await open_page(hub)
        out = edge(page, "node /talker", "topic /chatter")
        into = edge(page, "topic /chatter", "node /listener")
        await expect(out.locator(".words")).to_contain_text("Hz")
        await expect(into.locator(".words")).to_contain_text("Hz")
        await out.locator(".hit").dispatch_event("pointerover")
        await expect(out.locator("title")).to_contain_text("/talker publishes /chatter: ")


async def test_unreachable_ros1_node_and_its_conflict_are_flagged(open_page: OpenPage) -> None:
    async with (
        HubServer(Settings(port=0, ros1=0)) as hub,
        chain(hub, "talker", "/numbers", "listener"),
    ):
        assert hub.ros1 is not None
        with ServerProxy(hub.ros1.uri) as master:
            arguments = ("/camera", "/numbers", "sensor_msgs/Image", "http://127.0.0.1:9/")
            await asyncio.to_thread(master.registerPublisher, *arguments)
        page = await open_page(hub)
        camera = element(page, "node", "/camera")
        await expect(camera).to_contain_text("unreachable")
        await expect(camera).to_have_attribute("aria-label", re.compile("unreachable: .*refused"))
        await expect(camera).to_have_class(re.compile("unreachable"))
        flagged = edge(page, "node /camera", "topic /numbers")
        await expect(flagged).to_have_class(re.compile("conflict"))
        await expect(flagged.locator(".words")).to_have_text("⚠ sensor_msgs/Image")
        fine = edge(page, "node /talker", "topic /numbers")
        await expect(fine).not_to_have_class(re.compile("conflict"))
        conflict = "publishes sensor_msgs/Image, the topic is std_msgs/Int32"
        details = page.get_by_role("complementary", name="Details")
        await camera.click()
        for text in ("http://127.0.0.1:9/", "ROS 1 node", "unreachable: ", conflict):
            await expect(details).to_contain_text(text)
        await details.get_by_role("link", name="/numbers").click()
        await expect(details.get_by_role("listitem").filter(has_text="/camera")).to_contain_text(
            conflict
        )
        await page.close()  # Before its hub ends, so that it does not complain.


async def test_nodes_appear_and_disappear(hub: HubServer, open_page: OpenPage) -> None:
    async with chain(hub, "talker", "/chatter", "listener"):
        page = await open_page(hub)
        await expect(element(page, "node", "/talker")).to_be_visible()
        async with fibws.Node("late", hub=hub.url) as late:
            await late.advertise("/news", String, latch=True)
            await expect(element(page, "node", "/late")).to_be_visible()
            latched = edge(page, "node /late", "topic /news")
            await expect(latched.locator(".words")).to_have_text("latched")
        await expect(element(page, "node", "/late")).to_have_count(0)
        await expect(element(page, "topic", "/news")).to_have_count(0)
        await expect(element(page, "node", "/talker")).to_be_visible()


async def test_drawing_stays_in_place_when_nodes_come_and_go(
    hub: HubServer, open_page: OpenPage
) -> None:
    async with chain(hub, "talker", "/chatter", "listener"):
        page = await open_page(hub)
        edges = page.locator(".graph .edge")
        await expect(edges).to_have_count(2)
        watched = [element(page, "node", "/talker"), element(page, "topic", "/chatter")]
        await middle(watched[0])
        await page.get_by_role("button", name="Zoom out").click()
        before = [await middle(each) for each in watched]
        async with chain(hub, "alpha", "/another", "omega"):
            await expect(edges).to_have_count(4)
            await middle(element(page, "node", "/omega"))
            assert [await middle(each) for each in watched] == [
                pytest.approx(each, abs=2) for each in before
            ]
            await page.get_by_role("button", name="Fit").click()
            for each in (*watched, element(page, "node", "/omega")):
                x, y = await middle(each)
                assert 0 < x < 1280 and 120 < y < 780


async def test_click_opens_details_and_escape_closes_them(
    hub: HubServer, open_page: OpenPage
) -> None:
    async with chain(hub, "talker", "/chatter", "listener"):
        page = await open_page(hub)
        await element(page, "topic", "/chatter").click()
        details = page.get_by_role("complementary", name="Details")
        await expect(details.get_by_role("heading", name="/chatter")).to_be_visible()
        await expect(details).to_contain_text("std_msgs/Int32")
        await expect(details.locator("pre")).to_have_text("int32 data")
        await expect(details).to_contain_text("Hz")
        await expect(details.get_by_role("link", name="echo")).to_have_attribute(
            "href", "#/topics/%2Fchatter"
        )
        await details.get_by_role("link", name="/talker").click()
        await expect(details.get_by_role("heading", name="/talker")).to_be_visible()
        await expect(details).to_contain_text("127.0.0.1:")
        await page.go_back()
        await expect(details.get_by_role("heading", name="/chatter")).to_be_visible()
        await page.keyboard.press("Escape")
        await expect(details).to_be_hidden()


async def test_details_say_that_a_node_is_gone(hub: HubServer, open_page: OpenPage) -> None:
    async with fibws.Node("stays", hub=hub.url):
        async with fibws.Node("goes", hub=hub.url):
            page = await open_page(hub, "#/graph/node/%2Fgoes")
            details = page.get_by_role("complementary", name="Details")
            await expect(details).to_contain_text("127.0.0.1:")
        await expect(details).to_contain_text("not in the graph")


async def test_debug_shows_names_of_the_hub_and_of_this_page(
    hub: HubServer, open_page: OpenPage
) -> None:
    async with chain(hub, "talker", "/chatter", "listener"):
        page = await open_page(hub)
        await expect(element(page, "node", "/talker")).to_be_visible()
        await expect(element(page, "topic", "/rosout")).to_have_count(0)
        await page.get_by_role("checkbox", name="Debug").check()
        await expect(element(page, "topic", "/rosout")).to_be_visible()
        # One node calls and publishes, the other one receives.
        await expect(page.locator('.graph .element[data-id^="node /page_"]')).to_have_count(2)
        await page.get_by_role("checkbox", name="Debug").uncheck()
        await expect(element(page, "topic", "/rosout")).to_have_count(0)


async def test_link_has_the_options_and_the_filter(hub: HubServer, open_page: OpenPage) -> None:
    async with chain(hub, "talker", "/chatter", "listener"), chain(hub, "a", "/other", "b"):
        page = await open_page(hub)
        await page.get_by_label("Filter").fill("-/other -/a")
        await page.get_by_role("checkbox", name="Types").uncheck()
        await element(page, "topic", "/chatter").click()
        await expect(page.get_by_role("heading", name="/chatter")).to_be_visible()
        copy = await open_page(hub, page.url.partition("/#")[2].join(["#", ""]))
        await expect(element(copy, "topic", "/chatter")).to_have_attribute("aria-pressed", "true")
        await expect(copy.get_by_label("Filter")).to_have_value("-/other -/a")
        await expect(copy.get_by_role("checkbox", name="Types")).not_to_be_checked()
        await expect(element(copy, "topic", "/other")).to_have_count(0)
        # A tab keeps its state while others are shown.
        await copy.get_by_role("link", name="Topics").click()
        await expect(copy).to_have_url(re.compile("#/topics$"))
        await copy.get_by_role("link", name="Graph").click()
        await expect(copy).to_have_url(re.compile(r"#/graph\?filter=-/other\+-/a&types=0$"))


async def test_options_are_kept_after_a_reload(hub: HubServer, open_page: OpenPage) -> None:
    async with chain(hub, "talker", "/chatter", "listener"):
        page = await open_page(hub)
        await page.get_by_label("Elements").select_option("Nodes only")
        one = page.locator('.graph .edge[data-id^="node /talker > node /listener"]')
        await expect(one.locator(".topic")).to_have_text("/chatter")
        await expect(one.locator(".rate")).to_contain_text("Hz")
        await page.reload()
        await expect(one.locator(".topic")).to_have_text("/chatter")
        await expect(element(page, "topic", "/chatter")).to_have_count(0)


async def test_filter_shows_matching_elements_and_their_neighbours(
    hub: HubServer, open_page: OpenPage
) -> None:
    async with (
        chain(hub, "camera", "/robot/image", "viewer", namespace="/robot"),
        chain(hub, "a", "/other", "b"),
    ):
        page = await open_page(hub)
        await expect(page.locator(".graph .element")).to_have_count(6)
        await expect(page.locator(".graph .group-name")).to_have_text("/robot")
        await page.get_by_label("Filter").fill("/Robot")
        await expect(page.locator(".graph .element")).to_have_count(3)
        await expect(element(page, "node", "/viewer")).to_be_visible()
        await page.get_by_label("Filter").fill("/robot -viewer")
        await expect(page.locator(".graph .element")).to_have_count(2)
        await page.get_by_label("Filter").fill("nothing has this name")
        await expect(page.get_by_text("Clear the filter")).to_be_visible()


async def test_services_and_actions_are_optional(hub: HubServer, open_page: OpenPage) -> None:
    def start(request: TriggerRequest) -> TriggerResponse:
        return TriggerResponse(success=True)

    async def count(goal: Goal) -> FibonacciResult:
        return FibonacciResult([])

    async with fibws.Node("server", hub=hub.url) as node:
        await node.service("start", Trigger, start)
        await node.action_server("fibonacci", Fibonacci, count)
        page = await open_page(hub)
        await expect(element(page, "action", "/fibonacci")).to_be_visible()
        await expect(element(page, "topic", "/fibonacci/status")).to_have_count(0)
        await expect(element(page, "service", "/start")).to_have_count(0)
        await page.get_by_role("checkbox", name="Services").check()
        await element(page, "service", "/start").click()
        details = page.get_by_role("complementary", name="Details")
        await expect(details.get_by_role("link", name="call")).to_be_visible()
        await expect(details).to_contain_text("bool success")
        await page.get_by_role("checkbox", name="Actions").uncheck()
        await expect(element(page, "action", "/fibonacci")).to_have_count(0)


async def test_graph_is_usable_with_the_keyboard(hub: HubServer, open_page: OpenPage) -> None:
    async with chain(hub, "talker", "/chatter", "listener"):
        page = await open_page(hub)
        talker = page.get_by_role("button", name="node /talker, publishes 1, subscribes 0")
        rest = await middle(talker)
        await page.locator(".graph .stage").focus()
        await page.keyboard.press("Tab")
        await expect(talker).to_be_focused()
        await page.keyboard.press("ArrowRight")
        moved = await middle(talker)
        assert moved == pytest.approx((rest[0] - 60, rest[1]), abs=2)
        await page.keyboard.press("+")
        await page.keyboard.press("0")
        assert await middle(talker) == pytest.approx(rest, abs=2)
        await page.keyboard.press("Enter")
        details = page.get_by_role("complementary", name="Details")
        await expect(details.get_by_role("heading", name="/talker")).to_be_visible()
        await expect(talker).to_have_attribute("aria-pressed", "true")
        await page.keyboard.press("Escape")
        await expect(details).to_be_hidden()
        await expect(talker).to_be_focused()
        await page.keyboard.press("Tab")
        await expect(page.get_by_role("button", name="topic /chatter")).to_be_focused()


async def test_drag_moves_the_drawing_without_a_click(hub: HubServer, open_page: OpenPage) -> None:
    async with chain(hub, "talker", "/chatter", "listener"):
        page = await open_page(hub)
        x, y = await middle(element(page, "topic", "/chatter"))
        await page.mouse.move(x, y)
        await page.mouse.down()
        await page.mouse.move(x + 50, y + 80, steps=4)
        await page.mouse.up()
        moved = await middle(element(page, "topic", "/chatter"))
        assert moved == pytest.approx((x + 50, y + 80), abs=2)
        await expect(page.get_by_role("complementary", name="Details")).to_be_hidden()


async def test_graph_is_available_as_text(hub: HubServer, open_page: OpenPage) -> None:
    async with chain(hub, "talker", "/chatter", "listener"):
        page = await open_page(hub)
        await element(page, "topic", "/chatter").wait_for()
        await page.get_by_text("As text").click()
        await expect(page.locator(".graph .as-text pre")).to_contain_text(
            "topic /chatter [std_msgs/"
        )


async def test_names_of_namespaces_cover_no_element(hub: HubServer, open_page: OpenPage) -> None:
    async with chain(hub, "camera", "/robot/arm/image", "viewer", namespace="/robot"):
        page = await open_page(hub, "#/graph?namespaces=1")
        await middle(element(page, "topic", "/robot/arm/image"))
        for _ in range(5):
            captions = await page.locator(".graph .group-name").all()
            names = page.locator(".graph .element .outline, .graph .element .name")
            boxes = [await each.bounding_box() for each in await names.all()]
            for caption in captions:
                box = await caption.bounding_box()
                assert box is not None
                assert box["width"] > 5
                assert not any(other is not None and _overlap(box, other) for other in boxes)
            await page.get_by_role("button", name="Zoom out").click()
            await middle(element(page, "topic", "/robot/arm/image"))


def _overlap(one: FloatRect, other: FloatRect) -> bool:
    return (
        one["x"] < other["x"] + other["width"]
        and other["x"] < one["x"] + one["width"]
        and one["y"] < other["y"] + other["height"]
        and other["y"] < one["y"] + one["height"]
    )


async def test_large_graph_starts_readable_and_fits_on_demand(
    hub: HubServer, open_page: OpenPage
) -> None:
    names = [f"laser_scanner_{number}" for number in range(40)]
    async with contextlib.AsyncExitStack() as nodes:
        for name in names:
            node = await nodes.enter_async_context(fibws.Node(name, hub=hub.url))
            await node.advertise(f"/{name}/scan", Int32)
        for width, height in ((1280, 800), (390, 700)):
            page = await open_page(hub, width=width, height=height)
            first = element(page, "node", f"/{names[0]}")
            await middle(first)
            letters = (
                "parseFloat(getComputedStyle(document.querySelector('.graph .name')).fontSize)"
            )
            zoom = "new DOMMatrix(getComputedStyle(document.querySelector('.graph .drawing'))"
            zoom += ".transform).a"
            assert await page.evaluate(f"{letters} * {zoom}") > 9.5
            await page.get_by_role("button", name="Fit").click()
            await until(page, f"({ALL_WITHIN})({len(names)}, {width}, {height})")


async def test_nodes_without_messages_can_be_hidden(hub: HubServer, open_page: OpenPage) -> None:
    async with (
        chain(hub, "talker", "/chatter", "listener"),
        fibws.Node("idle", hub=hub.url) as idle,
    ):
        await idle.advertise("/silent", Int32)
        page = await open_page(hub)
        await expect(element(page, "node", "/idle")).to_be_visible()
        await page.get_by_role("checkbox", name="Quiet").uncheck()
        await expect(element(page, "topic", "/chatter")).to_be_visible()
        await expect(element(page, "node", "/listener")).to_be_visible()
        await expect(element(page, "node", "/idle")).to_have_count(0)
        await expect(element(page, "topic", "/silent")).to_have_count(0)


async def test_graph_is_saved_as_svg_and_dot(hub: HubServer, open_page: OpenPage) -> None:
    async with chain(hub, "talker", "/robot/chatter", "listener", namespace="/robot"):
        page = await open_page(hub, "#/graph?namespaces=1", color_scheme="dark")
        await element(page, "node", "/robot/talker").wait_for()
        async with page.expect_download() as download:
            await page.get_by_role("button", name="Save the drawing as SVG").click()
        saved = await download.value
        assert saved.suggested_filename == "graph.svg"
        drawing = ElementTree.parse(await saved.path()).getroot()
        namespace = "{http://www.w3.org/2000/svg}"
        texts = ["".join(text.itertext()) for text in drawing.iter(f"{namespace}text")]
        assert {"talker", "chatter", "/listener", "/robot"} <= set(texts)
        shapes = [each for each in drawing.iter() if each.tag.endswith(("ellipse", "path", "rect"))]
        for shape in shapes:
            assert re.fullmatch(r"none|rgb\(\d+, \d+, \d+\)", shape.attrib["fill"])
            assert not {"class", "style"} & set(shape.attrib)
        # The page is dark, the file is not.
        paper = [int(part) for part in re.findall(r"\d+", drawing[0].attrib["fill"])]
        assert min(paper) > 200
        async with page.expect_download() as download:
            await page.get_by_role("button", name="Save the graph as DOT").click()
        saved = await download.value
        assert saved.suggested_filename == "graph.dot"
        dot = await asyncio.to_thread((await saved.path()).read_text)
        assert '"node /robot/talker" -> "topic /robot/chatter";' in dot


@pytest.mark.parametrize("scheme", ["light", "dark"])
async def test_narrow_window_has_layers_from_top_to_bottom(
    hub: HubServer, open_page: OpenPage, scheme: str
) -> None:
    async with chain(hub, "talker", "/chatter", "listener"):
        page = await open_page(hub, width=360, height=740, color_scheme=scheme)
        places = [
            await middle(element(page, *each))
            for each in (("node", "/talker"), ("topic", "/chatter"), ("node", "/listener"))
        ]
        assert sorted(places, key=lambda place: place[1]) == places
        assert all(0 < x < 360 for x, _ in places)
        assert await page.evaluate("document.documentElement.scrollWidth") <= 360
