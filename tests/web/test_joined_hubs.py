"""The page of a hub that has joined others: the tutorial's programs run on those."""

from __future__ import annotations

from collections.abc import AsyncIterator

from playwright.async_api import expect
from running_programs import Program

import fibws
from fibws.hub import Settings
from fibws.hub.server import HubServer

from .conftest import OpenPage, fixture
from .test_topics import FIBONACCI, row, value


@fixture
async def middle(hub: HubServer) -> AsyncIterator[HubServer]:
    """A hub that has joined another one."""
    async with HubServer(Settings(port=0, hub_name="middle", join=(hub.url,))) as middle:
        yield middle


@fixture
async def last(middle: HubServer) -> AsyncIterator[HubServer]:
    """A hub that has joined that one."""
    async with HubServer(Settings(port=0, hub_name="last", join=(middle.url,))) as last:
        yield last


@fixture
async def programs(hub: HubServer, middle: HubServer) -> AsyncIterator[Program]:
    """The tutorial's broadcaster on the first hub; yields its listener on the second one."""
    listener = await Program.start("fibws.listener", FIBWS_HUB=middle.url)
    broadcaster = await Program.start("fibws.broadcaster", "--rate", "5", FIBWS_HUB=hub.url)
    yield listener
    await broadcaster.stop()
    await listener.stop()


async def test_page_shows_numbers_of_a_broadcaster_two_hubs_away(
    last: HubServer, programs: Program, open_page: OpenPage
) -> None:
    page = await open_page(last, "#/topics")
    await expect(row(page, "/fibonacci").locator(".col-publishers")).to_have_text("1")
    page = await open_page(last, FIBONACCI)
    await expect(value(page, "data")).not_to_be_empty()
    while "I heard" not in (line := await programs.line()):
        assert line


async def test_hubs_tab_lists_links_and_hubs_behind_them(
    last: HubServer, open_page: OpenPage
) -> None:
    page = await open_page(last, "#/hubs")
    await expect(page.get_by_role("heading", name="This hub: last")).to_be_visible()
    links = page.get_by_role("region", name="Links")
    await expect(links.locator("tbody th")).to_have_text("middle")
    await expect(links.locator("tbody td").nth(0)).to_have_text("joined by this hub")
    await expect(links.locator("tbody td").nth(5)).to_contain_text("B/s")


async def test_node_of_another_hub_is_drawn_with_it(
    hub: HubServer, middle: HubServer, open_page: OpenPage
) -> None:
    page = await open_page(middle, "#/graph")
    await expect(page.locator("#tab-hubs")).to_be_hidden()
    async with fibws.Node("camera", hub=hub.url):
        await expect(page.locator("#tab-hubs")).to_be_visible()
        await expect(page.locator(".element.node").filter(has_text="/camera")).to_contain_text(
            f"hub {hub.federation.hub.name}"
        )
        await expect(page.locator(".element.node")).to_have_count(1)
