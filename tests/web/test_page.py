"""The page around its views, and the snippet of the README, in a real browser."""

from __future__ import annotations

import asyncio
import gzip
import json
import re
from pathlib import Path
from urllib.parse import quote, urlsplit

import pytest
from playwright.async_api import Browser, Error, Page, Route, expect
from websockets.asyncio.client import connect

import fibws
from fibws.hub import Settings
from fibws.hub.server import HubServer
from fibws.msg.std_msgs import Int32
from fibws.srv.fibws_msgs import KillNode

from .conftest import BUILT, STRANGER, Complaints, OpenPage, until, web_address

README = Path(__file__).parents[2] / "README.md"
SNIPPET = re.compile(r"```js\n(const hub = new WebSocket.*?)```", re.DOTALL)
VIEWS = ["graph", "topics", "services", "console", "parameters"]
LOST = "WebSocket connection to"
"""Chromium's warning about a failed connection."""


async def publish_a_number(hub: HubServer) -> None:
    """Publish a latched number, until cancelled."""
    async with connect(f"{hub.url}/?node=/broadcaster") as client:
        topic = {"topic": "/fibonacci", "type": "std_msgs/Int32", "latch": True}
        await client.send(json.dumps({"op": "advertise", **topic}))
        await client.send(json.dumps({"op": "publish", "topic": "/fibonacci", "msg": {"data": 8}}))
        await client.wait_closed()


async def paste(page: Page, snippet: str, hub: HubServer) -> str:
    """Run a snippet as in the browser's console; return the first line that it logs."""
    broadcaster = asyncio.create_task(publish_a_number(hub))
    console = await page.context.new_cdp_session(page)
    try:
        async with page.expect_console_message(lambda line: line.type == "log") as message:
            answer = await console.send(
                "Runtime.evaluate", {"expression": snippet, "replMode": True}
            )
            assert "exceptionDetails" not in answer, answer
        return (await message.value).text
    finally:
        broadcaster.cancel()


async def roslib(page: Page) -> None:
    """Use `ROSLIB` in the console for the first time, and wait until it is available."""
    await page.evaluate("try { ROSLIB } catch {}")
    await until(page, "'value' in (Object.getOwnPropertyDescriptor(window, 'ROSLIB') ?? {})")


@pytest.mark.smoke
async def test_empty_hub_shows_first_steps(open_page: OpenPage, hub: HubServer) -> None:
    page = await open_page(hub)
    await expect(page.get_by_role("heading", name="This hub is empty")).to_be_visible()
    commands = page.locator(".copyable pre")
    await expect(commands.nth(0)).to_have_text(f"python -m fibws.broadcaster --hub {hub.url}")
    await expect(commands.nth(1)).to_have_text(f"python -m fibws.listener --hub {hub.url}")
    await expect(page.locator("#count-nodes")).to_have_text("0")


async def test_first_steps_disappear_with_the_first_node_and_can_be_reopened(
    open_page: OpenPage, hub: HubServer
) -> None:
    page = await open_page(hub)
    welcome = page.get_by_role("heading", name="This hub is empty")
    await expect(welcome).to_be_visible()
    async with fibws.Node("talker", hub=hub.url) as node:
        await node.advertise("chatter", Int32)
        await expect(welcome).to_be_hidden()
        await expect(page.locator("#counts div").nth(0)).to_have_text("node1")
        await expect(page.locator("#counts div").nth(1)).to_have_text("topic1")
        await page.get_by_role("button", name="Help").click()
        help_ = page.get_by_role("dialog", name="Help")
        await expect(help_).to_contain_text("python -m fibws.broadcaster")
        await page.keyboard.press("Escape")
        await expect(help_).to_be_hidden()
    await expect(welcome).to_be_visible()


async def test_one_click_opens_the_hub_in_foxglove(open_page: OpenPage, hub: HubServer) -> None:
    page = await open_page(hub)
    opened: list[str] = []

    async def serve(route: Route) -> None:
        opened.append(route.request.url)
        await route.fulfill(body="Foxglove")

    await page.context.route("https://app.foxglove.dev/**", serve)
    async with page.expect_popup() as popup:
        await page.locator("#tools").get_by_role("link", name="Foxglove").click()
    await expect((await popup.value).locator("body")).to_have_text("Foxglove")
    address = f"ws%3A%2F%2F127.0.0.1%3A{hub.port}%2F"
    assert [url.partition("?")[2] for url in opened] == [f"ds=foxglove-websocket&ds.url={address}"]
    await page.get_by_role("button", name="Help").click()
    help_ = page.get_by_role("dialog", name="Help")
    await expect(help_).to_contain_text("--allow-origin https://app.foxglove.dev")
    link = help_.get_by_role("link", name="Lichtblick")
    assert address in (await link.get_attribute("href") or "")


@pytest.mark.parametrize("number", [2, 3])
async def test_snippets_of_the_first_steps_receive_numbers(
    open_page: OpenPage, hub: HubServer, number: int
) -> None:
    page = await open_page(hub, permissions=["clipboard-read", "clipboard-write"])
    await page.locator(".copyable").nth(number).get_by_role("button", name="Copy").click()
    await expect(page.get_by_role("button", name="Copied")).to_be_visible()
    snippet = await page.evaluate("navigator.clipboard.readText()")
    await roslib(page)
    assert len(snippet.splitlines()) == {2: 5, 3: 2}[number]
    assert await paste(page, snippet, hub) == "I heard 8"


async def test_copying_works_without_the_clipboard_api(open_page: OpenPage, hub: HubServer) -> None:
    page = await open_page(hub)
    await page.evaluate("Object.defineProperty(navigator, 'clipboard', {value: undefined})")
    await page.get_by_role("button", name="Copy").first.click()
    await expect(page.get_by_role("button", name="Copied")).to_be_visible()
    await page.get_by_role("link", name="Parameters").click()
    await page.locator("summary", has_text="Add a parameter").click()
    name = page.get_by_role("textbox", name="Name")
    await name.press("Control+v")
    await expect(name).to_have_value(f"python -m fibws.broadcaster --hub {hub.url}")


async def test_text_is_selected_if_copying_fails(open_page: OpenPage, hub: HubServer) -> None:
    page = await open_page(hub)
    await page.evaluate("Object.defineProperty(navigator, 'clipboard', {value: undefined})")
    await page.evaluate("document.execCommand = () => false")
    await page.get_by_role("button", name="Copy").first.click()
    await expect(page.get_by_role("button", name="Selected: press Ctrl+C")).to_be_visible()
    selected = await page.evaluate("getSelection().toString()")
    assert selected == f"python -m fibws.broadcaster --hub {hub.url}"


async def test_browser_console_shows_an_example_once(
    browser: Browser, hub: HubServer, open_page: OpenPage
) -> None:
    page = await browser.new_page()
    lines: list[str] = []
    page.on("console", lambda message: lines.append(message.text))
    await page.goto(web_address(hub))
    await page.wait_for_selector("#hub[data-state=open]")
    await roslib(page)
    text = next(line for line in lines if "ROSLIB" in line)
    example = re.search(r"(const \w+ = new ROSLIB\.Topic.*\n.*;)", text)
    assert example is not None
    assert await paste(page, example[1], hub) == "I heard 8"


async def test_first_visit_of_the_graph_is_small(browser: Browser, hub: HubServer) -> None:
    page = await browser.new_page()
    names: set[str] = set()
    page.on("request", lambda request: names.add(urlsplit(request.url).path.lstrip("/")))
    async with fibws.Node("robot", hub=hub.url):
        await page.goto(web_address(hub))
        await page.get_by_label(re.compile("^node /robot")).first.wait_for()
    files = [BUILT / (name or "index.html") for name in names]
    sizes = {
        file.name: len(gzip.compress(file.read_bytes(), 6)) for file in files if file.is_file()
    }
    assert any(name.startswith("data.worker") for name in sizes)
    assert sum(sizes.values()) <= 60 * 1024, sizes
    await page.close()


@pytest.mark.parametrize("name", ["ROSLIB", "ros"])
async def test_roslib_is_loaded_when_the_console_first_uses_it(
    open_page: OpenPage, hub: HubServer, name: str
) -> None:
    page = await open_page(hub, "#/topics")
    await expect(page.locator("#count-nodes")).to_have_text("0")
    count = (
        "performance.getEntriesByType('resource').filter(e => e.name.endsWith('roslib.js')).length"
    )
    assert await page.evaluate(count) == 0
    with pytest.raises(Error, match="roslib is being loaded"):
        await page.evaluate(name)
    await roslib(page)
    assert await page.evaluate(count) == 1


async def test_connection_of_the_browser_console_is_a_visible_node(
    open_page: OpenPage, hub: HubServer
) -> None:
    page = await open_page(hub)
    await roslib(page)
    nodes = await page.evaluate("new Promise((done, failed) => ros.getNodes(done, failed))")
    assert len([name for name in nodes if name.startswith("/browser_")]) == 1
    await expect(page.locator("#count-nodes")).to_have_text("1")


@pytest.mark.parametrize("written", ["{}", "ws://{}", " {} "])
async def test_query_names_another_hub(open_page: OpenPage, hub: HubServer, written: str) -> None:
    async with HubServer(Settings(port=0, allow_origin=(web_address(hub),))) as other:
        address = written.format(f"localhost:{other.port}")
        page = await open_page(hub, f"?hub={quote(address)}")
        await expect(page.locator("#hub code")).to_have_text(f"ws://localhost:{other.port}")
        await page.close()  # Before its hub ends, so that it does not complain.


async def test_empty_query_names_the_hub_of_the_page(open_page: OpenPage, hub: HubServer) -> None:
    page = await open_page(hub, "?hub=")
    await expect(page.locator("#hub code")).to_have_text(hub.url)


async def test_invalid_address_is_reported(browser: Browser, hub: HubServer) -> None:
    page = await browser.new_page()
    await page.goto(f"{web_address(hub)}/?hub=http://robot")
    await expect(page.get_by_role("alert")).to_contain_text("http://robot")
    await page.get_by_role("link").click()
    await page.wait_for_selector("#hub[data-state=open]")
    await page.close()


async def test_page_reconnects_when_the_hub_is_back(
    open_page: OpenPage, complaints: Complaints
) -> None:
    async with HubServer(Settings(port=0)) as hub:
        port = hub.port
        page = await open_page(hub, "#/console")
        await roslib(page)
        async with fibws.Node("talker", hub=hub.url) as node:
            node.log.warning("before")
            await expect(page.locator(".log li")).to_contain_text(["before"])
    state = page.get_by_role("status").filter(has_text="reconnecting")
    await expect(state).to_contain_text("the hub is shutting down")
    await expect(page.locator(".log li")).to_contain_text(["before"])
    async with HubServer(Settings(port=port)) as hub:
        await expect(page.locator("#state")).to_have_text("connected")
        async with fibws.Node("talker", hub=hub.url) as node:
            # The page subscribes before it shows that it is connected.
            node.log.warning("after")
            await expect(page.locator(".log li")).to_contain_text(["before", "after"])
    complaints.allow(LOST)


async def test_page_reconnects_on_demand_after_a_shutdown_request(
    open_page: OpenPage, hub: HubServer
) -> None:
    page = await open_page(hub)
    own = await page.locator("#hub code").get_attribute("title") or ""
    [name] = re.findall(r"/page_\w+", own)
    async with fibws.Node("killer", hub=hub.url) as node:
        answer = await node.call("/rosapi/kill_node", KillNode, KillNode.Request(node=name))
        assert answer.success
    await expect(page.locator("#state")).to_have_text("closed (shutdown request: user request)")
    await page.get_by_role("button", name="Connect").click()
    await expect(page.locator("#state")).to_have_text("connected")
    await expect(page.get_by_role("button", name="Connect")).to_be_hidden()


async def test_rate_of_all_messages_is_shown(open_page: OpenPage, hub: HubServer) -> None:
    page = await open_page(hub)
    async with fibws.Node("talker", hub=hub.url) as node:
        numbers = await node.advertise("numbers", Int32)

        async def publish() -> None:
            async for _ in node.rate(50):
                await numbers.publish(data=1)

        publishing = asyncio.create_task(publish())
        await expect(page.locator("#count-rate")).to_have_text(
            re.compile(r"^[\d.]*[1-9][\d.]* Hz$")
        )
        publishing.cancel()


async def test_every_view_fits_the_width_of_a_phone(open_page: OpenPage, hub: HubServer) -> None:
    namespace = "/a/quite/deep/namespace"
    async with fibws.Node("with_a_long_name", namespace=namespace, hub=hub.url) as node:
        await node.advertise("/another/deep/namespace/with/a_topic_of_a_long_name", Int32)
        await node.params.set("/some/parameter", "of words without end " * 10)
        page = await open_page(hub, width=360, height=740)
        node.log.error("word" * 100)
        await expect(page.locator("#count-nodes")).to_have_text("1")
        for view in VIEWS:
            await visit(page, view)
            wide = await page.evaluate("document.documentElement.scrollWidth")
            assert (view, wide) == (view, 360)


async def test_every_control_is_reached_by_tab_and_has_a_name(
    open_page: OpenPage, hub: HubServer
) -> None:
    async with fibws.Node("talker", hub=hub.url) as node:
        await node.advertise("chatter", Int32)
        page = await open_page(hub)
        await expect(page.locator("#count-topics")).to_have_text("1")
        await page.evaluate(UNMARK_REACHED)
        for view in VIEWS:
            await visit(page, view)
            count = await page.evaluate(MARK_CONTROLS)
            assert count > len(VIEWS)
            # Controls that appear later, when the hub has responded, also take the focus.
            for _ in range(10 * count):
                if not await page.evaluate(MISSED):
                    break
                await page.keyboard.press("Tab")
            assert (view, await page.evaluate(MISSED)) == (view, [])
            assert (view, await page.evaluate(NAMELESS)) == (view, [])


async def visit(page: Page, view: str) -> None:
    """Choose a tab, and wait for its view."""
    await page.locator(f"#tab-{view}").click()
    await expect(page.locator(f"#tab-{view}")).to_have_attribute("aria-current", "page")
    await expect(page.locator("#stage")).to_have_attribute("data-view", view)
    await expect(page.locator("#stage > [role=alert]")).to_have_count(0)


VISIBLE_CONTROLS = """Array.from(
    document.querySelectorAll("a[href], button, input, select, textarea, summary")
).filter((each) => each.checkVisibility() && !each.disabled && each.tabIndex >= 0)"""
MARK_CONTROLS = f"""() => {{
    const controls = {VISIBLE_CONTROLS};
    for (const each of controls) each.dataset.control = "";
    return controls.length;
}}"""
UNMARK_REACHED = """document.addEventListener("focusin", ({target}) =>
    target.removeAttribute("data-control")
)"""
MISSED = "Array.from(document.querySelectorAll('[data-control]'), (each) => each.outerHTML)"
NAMELESS = f"""{VISIBLE_CONTROLS}.filter((each) =>
    each.innerText?.trim() === "" && !each.ariaLabel && !each.labels?.length && !each.title
).map((each) => each.outerHTML)"""


async def test_back_button_returns_to_the_previous_view(
    open_page: OpenPage, hub: HubServer
) -> None:
    page = await open_page(hub)
    await page.get_by_role("link", name="Console").click()
    await page.get_by_role("link", name="Parameters").click()
    await expect(page).to_have_title("Parameters · fibws hub")
    await page.go_back()
    await expect(page).to_have_title("Console · fibws hub")
    await expect(page.locator("section.console")).to_be_visible()


async def test_snippet_of_the_readme_works_from_another_page_on_localhost(
    browser: Browser, hub: HubServer
) -> None:
    found = SNIPPET.search(README.read_text())
    assert found is not None
    snippet = found[1].replace("ws://localhost:9090", hub.url)
    assert len(snippet.splitlines()) == 5
    async with HubServer(Settings(port=0)) as other:
        page = await browser.new_page()
        await page.goto(f"http://localhost:{other.port}/healthz")
        assert await paste(page, snippet, hub) == "I heard 8"


async def test_snippet_of_the_readme_works_in_the_page(open_page: OpenPage, hub: HubServer) -> None:
    found = SNIPPET.search(README.read_text())
    assert found is not None
    page = await open_page(hub)
    assert await paste(page, found[1].replace("ws://localhost:9090", hub.url), hub) == "I heard 8"


@pytest.mark.parametrize("allowed", [False, True])
async def test_page_of_another_origin_connects_only_if_allowed(
    browser: Browser, allowed: bool
) -> None:
    async with HubServer(Settings(port=0)) as other:
        origin = f"http://{STRANGER}:{other.port}"
        async with HubServer(Settings(port=0, allow_origin=(origin,) if allowed else ())) as hub:
            page = await browser.new_page()
            await page.goto(f"{origin}/")
            opened = await page.evaluate(
                """url => new Promise(done => {
                    const socket = new WebSocket(url);
                    socket.onopen = () => done(true);
                    socket.onclose = () => done(false);
                })""",
                hub.url,
            )
            assert opened is allowed
