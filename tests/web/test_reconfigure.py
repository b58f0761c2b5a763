"""The Reconfigure tab, with an unmodified rospy script as the server."""

from __future__ import annotations

from collections.abc import AsyncIterator
from pathlib import Path

from playwright.async_api import Locator, Page, expect
from running_programs import Program

from fibws.hub.server import HubServer

from .conftest import OpenPage, fixture

SERVER = Path(__file__).parents[1] / "ros1" / "scripts" / "reconfigure" / "server.py"


@fixture
async def server(hub: HubServer) -> AsyncIterator[Program]:
    """A node with two servers: /server, and /server/second below it."""
    program = await Program.start("fibws.rospy", str(SERVER), FIBWS_HUB=hub.url)
    while "ready" not in await program.line():
        pass
    yield program
    await program.stop()


def number(page: Page, name: str) -> Locator:
    return page.get_by_label(name, exact=True)


async def test_tab_appears_with_a_server(hub: HubServer, open_page: OpenPage) -> None:
    page = await open_page(hub, "#/topics")
    await expect(page.locator("#tab-reconfigure")).to_be_hidden()
    program = await Program.start("fibws.rospy", str(SERVER), FIBWS_HUB=hub.url)
    await page.locator("#tab-reconfigure").click()
    await expect(page.locator("tbody th a")).to_have_text(["/server", "/server/second"])
    await page.locator("tbody th a").first.click()
    await expect(number(page, "str_param")).to_have_value("Hello")
    await program.stop()


async def test_values_are_changed_and_clamped(
    hub: HubServer, server: Program, open_page: OpenPage
) -> None:
    page = await open_page(hub, "#/reconfigure/%2Fserver")
    text = number(page, "int_param")
    await expect(text).to_have_value("100")
    await text.fill("700")
    await text.press("Enter")
    await expect(text).to_have_value("100")
    slider = page.get_by_label("int_param, slider")
    await slider.fill("13")
    # The server's callback makes 14 of 13, and changes a text.
    await expect(text).to_have_value("14")
    await expect(slider).to_have_value("14")
    await expect(number(page, "str_param")).to_have_value("not 13")
    await page.get_by_label("size").select_option("Large (2)")
    await page.get_by_label("bool_param").uncheck()
    while "('bool_param', False)" not in (line := await server.line()):
        pass
    assert "('size', 2)" in line
    assert hub.graph.parameters.get("/server/size") == 2


async def test_invalid_text_is_refused_beside_it(
    hub: HubServer, server: Program, open_page: OpenPage
) -> None:
    page = await open_page(hub, "#/reconfigure/%2Fserver")
    text = number(page, "int_param")
    await expect(text).to_have_value("100")
    await text.fill("many")
    await text.press("Enter")
    await expect(page.locator("#reconfigure-int_param-problem")).to_contain_text("integer")
    await text.fill("7")
    await text.press("Enter")
    await expect(page.locator("#reconfigure-int_param-problem")).to_be_empty()
    while "('int_param', 7)" not in await server.line():
        pass


async def test_changes_of_others_and_refusals_are_shown(
    hub: HubServer, server: Program, open_page: OpenPage
) -> None:
    page = await open_page(hub, "#/reconfigure/%2Fserver%2Fsecond")
    other = await open_page(hub, "#/reconfigure/%2Fserver%2Fsecond")
    await expect(number(other, "int_param")).to_have_value("50")
    await number(page, "str_param").fill("from one page")
    await number(page, "str_param").blur()
    await expect(number(other, "str_param")).to_have_value("from one page")
    await number(page, "int_param").fill("99")
    await number(page, "int_param").press("Enter")
    await expect(page.get_by_role("alert")).to_contain_text("callback should return")


async def test_group_is_opened_for_everybody(
    hub: HubServer, server: Program, open_page: OpenPage
) -> None:
    page = await open_page(hub, "#/reconfigure/%2Fserver")
    other = await open_page(hub, "#/reconfigure/%2Fserver")
    await expect(number(page, "inner")).to_be_hidden()
    await expect(number(other, "deepest")).to_be_hidden()
    await page.get_by_text("Second_Group").click()
    await expect(number(page, "inner")).to_have_value("2")
    await expect(number(other, "deepest")).to_be_visible()
