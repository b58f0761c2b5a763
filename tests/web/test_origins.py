"""Pages that the hub refuses say why: the hub's own page, and pages that load /roslib.js."""

from __future__ import annotations

from collections.abc import AsyncIterator

import pytest
from playwright.async_api import Browser, Page, expect

from fibws.hub import Settings
from fibws.hub.server import HubServer

from .conftest import STRANGER, Complaints, OpenPage, fixture, web_address
from .test_addresses import proxy
from .test_roslib_js import served


@fixture
async def page(browser: Browser) -> AsyncIterator[Page]:
    page = await browser.new_page()
    yield page
    await page.close()


async def test_page_under_an_unknown_name_shows_the_option_that_lets_it_in(
    page: Page, hub: HubServer
) -> None:
    origin = f"http://{STRANGER}:{hub.port}"
    await page.goto(f"{origin}/")
    problem = page.get_by_role("alert")
    await expect(problem).to_contain_text("The hub refuses this page")
    command = problem.locator("pre")
    await expect(command).to_have_text(f"python -m fibws.hub --allow-origin {origin}")


async def test_option_that_the_page_shows_lets_it_in(browser: Browser, open_page: OpenPage) -> None:
    async with HubServer(Settings(port=0)) as refusing:
        page = await browser.new_page()
        await page.goto(f"http://{STRANGER}:{refusing.port}/")
        text = await page.get_by_role("alert").locator("pre").inner_text()
        option = text.removeprefix("python -m fibws.hub --allow-origin ")
        await page.close()
        port = refusing.port
    async with HubServer(Settings(port=port, allow_origin=(option,))) as hub:
        page = await open_page(hub, address=f"http://{STRANGER}:{port}")
        await expect(page.locator(".connection-problem")).to_be_hidden()
        await page.close()


async def test_page_of_another_hub_shows_why_that_refuses_it(page: Page, hub: HubServer) -> None:
    async with HubServer(Settings(port=0)) as other:
        await page.goto(f"{web_address(hub)}/?hub={STRANGER}:{other.port}")
        await expect(page.get_by_role("alert")).to_contain_text(
            f"--allow-origin {web_address(hub)}"
        )
        await page.goto("about:blank")


async def test_address_without_a_hub_is_named(page: Page, hub: HubServer) -> None:
    async with HubServer(Settings(port=0)) as other:
        address = f"localhost:{other.port}"
    await page.goto(f"{web_address(hub)}/?hub={address}")
    await expect(page.get_by_role("alert")).to_contain_text(f"No hub answers at ws://{address}")
    await page.goto("about:blank")


async def test_proxy_without_websockets_is_named_as_the_reason(page: Page, hub: HubServer) -> None:
    async with proxy(hub, "/robot", upgrades=False) as address:
        await page.goto(f"{address}/")
        await expect(page.get_by_role("alert")).to_contain_text("Upgrade")
        await page.goto("about:blank")


ROSLIB_PAGE = """\
<!doctype html>
<script src="{site}/roslib.js"></script>
<script>
  const ros = new ROSLIB.Ros({{url: "{hub}"}});
  const topic = new ROSLIB.Topic({{ros, name: "/number", messageType: "std_msgs/Int32"}});
  ros.on("connection", () => topic.publish({{data: "eight"}}));
  {more}
</script>
"""


@pytest.mark.parametrize("listens", [False, True])
async def test_refused_message_is_in_the_console_unless_the_page_handles_it(
    page: Page, hub: HubServer, complaints: Complaints, listens: bool
) -> None:
    complaints.watch(page)
    more = ""
    if listens:
        more = 'ros.on("status", ({msg}) => { document.title = msg; });'
    html = ROSLIB_PAGE.format(site=web_address(hub), hub=hub.url, more=more)
    async with served(html) as address:
        if listens:
            await page.goto(address)
            await page.wait_for_function("document.title.includes('data')")
            assert complaints.seen == []
        else:
            async with page.expect_console_message(lambda said: said.type == "error"):
                await page.goto(address)
            complaints.expect("The hub says")
        await page.goto("about:blank")


async def test_refused_page_of_another_server_finds_the_option_in_its_console(
    page: Page, hub: HubServer
) -> None:
    html = ROSLIB_PAGE.format(site=web_address(hub), hub=hub.url, more="")
    async with served(html) as address:
        port = address.rstrip("/").rpartition(":")[2]
        origin = f"http://{STRANGER}:{port}"
        async with page.expect_console_message(lambda said: "--allow-origin" in said.text) as found:
            await page.goto(f"{origin}/")
        assert f"--allow-origin {origin}" in (await found.value).text
        await page.goto("about:blank")
