"""The page at a hub that wants a token."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator
from pathlib import Path

import pytest
from hub_reload import reloaded
from playwright.async_api import Page, expect

import fibws
from fibws.access.rights import RIGHTS, Rights
from fibws.access.token_file import TokenFile
from fibws.hub import Settings
from fibws.hub.server import HubServer
from fibws.msg.geometry_msgs import Twist
from fibws.msg.sensor_msgs import Image

from .conftest import STRANGER, Complaints, OpenPage, fixture, until


class TokenHub:
    """A hub with tokens: ``robot`` may do everything, ``dashboard`` may only look."""

    def __init__(self, hub: HubServer, file: TokenFile) -> None:
        self.hub = hub
        self.file = file
        self.robot = file.add("robot", Rights({right: ("/**",) for right in RIGHTS}))
        self.dashboard = file.add("dashboard", Rights({"subscribe": ("/**",)}))
        hub.reload()


@fixture
async def token_hub(tmp_path: Path) -> AsyncIterator[TokenHub]:
    """A hub with tokens; tests name it before `open_page`, so that it outlives their pages."""
    path = tmp_path / "tokens.toml"
    path.touch()
    async with HubServer(Settings(port=0, tokens=path)) as hub:
        yield TokenHub(hub, TokenFile(path))


async def log_in(page: Page, token: str) -> None:
    await page.get_by_label("Token", exact=True).fill(token)
    await page.get_by_role("button", name="Log in").click()


@pytest.mark.smoke
async def test_page_logs_in_and_stays_logged_in(token_hub: TokenHub, open_page: OpenPage) -> None:
    page = await open_page(token_hub.hub, state="closed")
    await expect(page.get_by_label("Token", exact=True)).to_be_focused()
    await expect(page.locator("#stage")).to_be_hidden()
    await log_in(page, f" {token_hub.dashboard} ")
    await expect(page.locator("#account")).to_contain_text("dashboard")
    await expect(page.locator("#hub")).to_have_attribute("data-state", "open")
    await expect(page.locator(".login")).to_be_hidden()
    [cookie] = await page.context.cookies()
    assert cookie["name"] == "fibws_session" and cookie["value"] != token_hub.dashboard
    assert cookie["httpOnly"] and cookie["sameSite"] == "Strict" and cookie["path"] == "/"
    assert await page.evaluate("document.cookie") == ""
    await page.reload()
    await expect(page.locator("#account")).to_contain_text("dashboard")
    await until(page, "document.querySelector('#hub').dataset.state === 'open'")


async def test_wrong_token_is_refused_with_the_reason(
    token_hub: TokenHub, open_page: OpenPage, complaints: Complaints
) -> None:
    page = await open_page(token_hub.hub, state="closed")
    await log_in(page, "fibws_wrong")
    await expect(page.locator("#login-problem")).to_contain_text("unknown token")
    complaints.expect("401")
    await log_in(page, token_hub.dashboard)
    await expect(page.locator("#account")).to_contain_text("dashboard")


async def test_logout_hides_what_was_shown(token_hub: TokenHub, open_page: OpenPage) -> None:
    page = await open_page(token_hub.hub, state="closed")
    await log_in(page, token_hub.dashboard)
    await page.get_by_role("button", name="Log out").click()
    await expect(page.get_by_label("Token", exact=True)).to_be_visible()
    await expect(page.locator("#stage")).to_be_hidden()
    assert await page.context.cookies() == []
    await page.reload()
    await expect(page.get_by_label("Token", exact=True)).to_be_visible()


async def test_revoked_token_asks_for_another(token_hub: TokenHub, open_page: OpenPage) -> None:
    page = await open_page(token_hub.hub, state="closed")
    await log_in(page, token_hub.dashboard)
    await expect(page.locator("#hub")).to_have_attribute("data-state", "open")
    token_hub.file.revoke("dashboard")
    await reloaded(token_hub.hub)
    await expect(page.locator("#login-problem")).to_contain_text("unknown token")
    await log_in(page, token_hub.robot)
    await expect(page.locator("#account")).to_contain_text("robot")
    await expect(page.locator("#hub")).to_have_attribute("data-state", "open")


async def test_missing_right_is_named(token_hub: TokenHub, open_page: OpenPage) -> None:
    async with fibws.Node("talker", hub=token_hub.hub.url, token=token_hub.robot) as node:
        await node.advertise("numbers", "std_msgs/Int32")
        page = await open_page(token_hub.hub, "#/topics/%2Fnumbers", state="closed")
        await log_in(page, token_hub.dashboard)
        await page.locator("summary", has_text="Publish").click()
        await page.get_by_role("button", name="Publish", exact=True).click()
        problem = page.get_by_text("missing right publish for /numbers")
        await expect(problem).to_be_visible()


async def test_page_of_another_hub_sends_its_token_by_an_operation(
    token_hub: TokenHub, open_page: OpenPage, hub: HubServer
) -> None:
    page = await open_page(hub, f"?hub={token_hub.hub.url}/%3Ftoken%3D{token_hub.dashboard}")
    async with fibws.Node("talker", hub=token_hub.hub.url, token=token_hub.robot) as node:
        await node.advertise("numbers", "std_msgs/Int32")
        await expect(page.locator("#count-topics")).to_have_text("1")
    assert token_hub.dashboard not in await page.locator("#header").inner_html()
    assert await page.context.cookies() == []


async def test_script_sends_its_token_as_a_subprotocol(
    token_hub: TokenHub, open_page: OpenPage, hub: HubServer
) -> None:
    page = await open_page(hub)
    script = """([url, token]) => new Promise((resolve) => {
        const socket = new WebSocket(url, "fibws.token." + token);
        socket.onopen = () => {
            socket.send(JSON.stringify({op: "call_service", service: "/rosapi/get_time"}));
        };
        socket.onmessage = ({data}) => resolve([socket.protocol, JSON.parse(data).result]);
        socket.onclose = ({code, reason}) => resolve([code, reason]);
    })"""
    token = token_hub.dashboard
    protocol, result = await page.evaluate(script, [token_hub.hub.url, token])
    assert (protocol, result) == (f"fibws.token.{token}", True)
    code, reason = await page.evaluate(script, [token_hub.hub.url, "wrong"])
    assert (code, reason) == (4401, "unknown token")


async def test_form_warns_of_a_connection_without_encryption(
    token_hub: TokenHub, open_page: OpenPage, tmp_path: Path
) -> None:
    page = await open_page(token_hub.hub, state="closed")
    await expect(page.get_by_text("not encrypted")).to_have_count(0)
    async with HubServer(Settings(port=0)) as former:
        port = former.port
    address = f"http://{STRANGER}:{port}"
    settings = Settings(port=port, tokens=tmp_path / "tokens.toml", allow_origin=(address,))
    async with HubServer(settings) as hub:
        page = await open_page(hub, address=address, state="closed")
        await expect(page.get_by_text("not encrypted")).to_be_visible()
        await log_in(page, token_hub.dashboard)
        await expect(page.locator("#account")).to_contain_text("dashboard")
        await page.close()


async def test_second_connection_has_the_rights_of_the_page(
    token_hub: TokenHub, open_page: OpenPage
) -> None:
    """Images arrive on a connection of their own; driving needs the right to publish."""
    async with fibws.Node("camera", hub=token_hub.hub.url, token=token_hub.robot) as node:
        images = await node.advertise("/image", Image, latch=True, peers=True)
        await images.publish(Image(height=1, width=2, encoding="mono8", step=2, data=b"\0\xff"))
        await node.advertise("/cmd_vel", Twist)
        page = await open_page(token_hub.hub, "#/topics/%2Fimage", state="closed")
        await log_in(page, token_hub.dashboard)
        await expect(page.locator(".image-facts")).to_contain_text("mono8")
        await page.get_by_role("button", name="Log out").click()
        async with asyncio.timeout(60):
            async for names in images.peers.changes():
                if not names:
                    break
        await log_in(page, token_hub.dashboard)
        async with asyncio.timeout(60):
            async for names in images.peers.changes():
                if names:
                    break
        await page.evaluate("location.hash = '#/topics/%2Fcmd_vel'")
        await page.locator(".teleop").focus()
        await page.keyboard.press("w")
        await expect(page.locator(".teleop .error")).to_contain_text("publish")
