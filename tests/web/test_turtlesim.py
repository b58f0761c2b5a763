"""The Turtlesim tab: turtles, what they have drawn, and keys that drive them."""

from __future__ import annotations

from collections.abc import AsyncIterator

from playwright.async_api import Page, expect
from running_programs import Program

import fibws
from fibws.hub.server import HubServer
from fibws.srv.turtlesim import SetPen, Spawn, TeleportAbsolute

from .conftest import OpenPage, fixture

COUNT = """(canvas, color) => {
    const copy = new OffscreenCanvas(500, 500).getContext("2d", { willReadFrequently: true });
    copy.drawImage(canvas, 0, 0);
    const { data } = copy.getImageData(0, 0, 500, 500);
    let count = 0;
    for (let i = 0; i < data.length; i += 4) {
        if (data[i] === color[0] && data[i + 1] === color[1] && data[i + 2] === color[2]) count++;
    }
    return count;
}"""
BACKGROUND, PEN, RED = [69, 86, 255], [0xB3, 0xB8, 0xFF], [255, 0, 0]


@fixture
async def simulator(hub: HubServer) -> AsyncIterator[Program]:
    """A simulator with the turtle that it begins with."""
    program = await Program.start("fibws.programs.turtlesim.turtlesim_node", FIBWS_HUB=hub.url)
    while "Spawning" not in (line := await program.line()):
        assert line, "the simulator has ended"
    yield program
    await program.stop()


async def count_of(page: Page, color: list[int], least: int) -> int:
    """Wait until the picture has so many pixels of a colour; return how many it has."""
    await page.wait_for_function(
        f"([color, least]) => ({COUNT})(document.querySelector('canvas'), color) >= least",
        arg=[color, least],
    )
    count = await page.locator("canvas").evaluate(COUNT, color)
    assert isinstance(count, int)
    return count


async def test_arrow_keys_drive_the_turtle(
    hub: HubServer, simulator: Program, open_page: OpenPage
) -> None:
    page = await open_page(hub, "#/topics")
    await page.locator("#tab-turtlesim").click()
    await expect(page.locator(".turtles li")).to_contain_text("x 5.54 m, y 5.54 m, 0°")
    assert await count_of(page, BACKGROUND, 1) == 500 * 500
    await page.keyboard.down("ArrowUp")
    drawn = await count_of(page, PEN, 60)
    await page.keyboard.up("ArrowUp")
    await expect(page.locator(".turtles li")).not_to_contain_text("m/s")
    assert await count_of(page, PEN, drawn) < 500 * 3 + 9
    await expect(page.locator("g.turtle")).to_have_count(1)


async def test_what_was_drawn_before_is_shown(
    hub: HubServer, simulator: Program, open_page: OpenPage
) -> None:
    async with fibws.Node("test", hub=hub.url) as node:
        await node.wait_for_service("/kill")
        await node.call("/spawn", Spawn, {"x": 1, "y": 1, "name": "painter"})
        await node.call("/painter/set_pen", SetPen, {"r": 255, "width": 1})
        await node.call("/painter/teleport_absolute", TeleportAbsolute, {"x": 1, "y": 9})
    page = await open_page(hub, "#/turtlesim")
    assert await count_of(page, RED, 8 * 45) <= 8 * 45 + 2
    await expect(page.locator(".turtles li b")).to_have_text(["painter", "turtle1"])
    await page.get_by_role("button", name="Clear").click()
    await count_of(page, BACKGROUND, 500 * 500)
    await page.get_by_role("button", name="Spawn a turtle").click()
    await expect(page.locator(".turtles li b")).to_have_text(["painter", "turtle1", "turtle2"])
    await page.get_by_role("button", name="Reset").click()
    await expect(page.locator(".turtles li b")).to_have_text(["turtle1"])


async def test_without_a_simulator_the_tab_says_how_to_start_one(
    hub: HubServer, open_page: OpenPage
) -> None:
    page = await open_page(hub, "#/topics")
    await expect(page.locator("#tab-turtlesim")).to_be_hidden()
    page = await open_page(hub, "#/turtlesim")
    await expect(page.get_by_text("fibws run turtlesim turtlesim_node")).to_be_visible()


async def test_stick_drives_the_chosen_turtle(
    hub: HubServer, simulator: Program, open_page: OpenPage
) -> None:
    page = await open_page(hub, "#/turtlesim", width=390, has_touch=True)
    await page.get_by_text("Stick", exact=True).click()
    stick = page.locator(".teleop-stick").first
    await stick.scroll_into_view_if_needed()
    box = await stick.bounding_box()
    assert box is not None
    await page.mouse.move(box["x"] + box["width"] / 2, box["y"] + box["height"] / 2)
    await page.mouse.down()
    await page.mouse.move(box["x"] + box["width"] / 2, box["y"])
    await count_of(page, PEN, 20)
    await page.mouse.up()
    await expect(page.locator(".turtles li")).not_to_contain_text("m/s")
    await page.get_by_text("Stick", exact=True).click()
    await expect(stick).to_be_hidden()
