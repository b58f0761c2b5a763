"""The Parameters tab of the page: show, change, add and delete parameters."""

from __future__ import annotations

import re
from collections.abc import AsyncIterator

import pytest
from playwright.async_api import Locator, Page, expect

import fibws
from fibws.hub.server import HubServer

from .conftest import OpenPage, fixture

MARKUP = "<img src=x onerror=alert(1)>"


@fixture
async def node(hub: HubServer) -> AsyncIterator[fibws.Node]:
    async with fibws.Node("setter", hub=hub.url) as node:
        yield node


def leaf(page: Page, key: str) -> Locator:
    """Return the row of a parameter, by the last part of its name."""
    return page.locator(".leaf").filter(has=page.locator(f"code.key:text-is('{key}')"))


async def test_parameters_are_shown_by_namespace(
    open_page: OpenPage, hub: HubServer, node: fibws.Node
) -> None:
    await node.params.set("/robot/speed", 0.5)
    await node.params.set("/robot/name", "R2")
    await node.params.set("/robot/arm/joints", [1.5, 2, "three"])
    page = await open_page(hub, "#/parameters")
    await expect(leaf(page, "speed")).to_contain_text("0.5number")
    await expect(leaf(page, "name")).to_contain_text("R2text")
    await expect(leaf(page, "joints")).to_contain_text('[1.5,2,"three"]list')
    robot = page.locator("details", has=page.locator("summary", has_text="robot/")).first
    await expect(robot.locator("summary").first).to_have_text("robot/3")
    await robot.locator("summary").first.click()
    await expect(leaf(page, "joints")).to_be_hidden()


@pytest.mark.smoke
async def test_value_is_changed_with_the_keyboard(
    open_page: OpenPage, hub: HubServer, node: fibws.Node
) -> None:
    await node.params.set("/speed", 0.5)
    page = await open_page(hub, "#/parameters")
    change = page.get_by_role("button", name="Change /speed")
    await change.focus()
    await page.keyboard.press("Enter")
    value = page.get_by_role("textbox", name="Value of /speed")
    await expect(value).to_be_focused()
    await page.keyboard.type("[1, 2.0]")
    await expect(page.locator(".value-form .kind")).to_have_text("list")
    await page.keyboard.press("Enter")
    await expect(leaf(page, "speed")).to_contain_text("[1,2.0]")
    await expect(change).to_be_focused()
    assert await node.params.get("/speed") == [1, 2.0]


async def test_text_that_is_not_json_is_a_string_and_escape_cancels(
    open_page: OpenPage, hub: HubServer, node: fibws.Node
) -> None:
    await node.params.set("/name", "R2")
    page = await open_page(hub, "#/parameters")
    await page.get_by_role("button", name="Change /name").click()
    value = page.get_by_role("textbox", name="Value of /name")
    await value.fill("wrong")
    await page.keyboard.press("Escape")
    await expect(leaf(page, "name")).to_contain_text("R2")
    await page.get_by_role("button", name="Change /name").click()
    await value.fill("a robot, [not] a list")
    await page.get_by_role("button", name="Save").click()
    await expect(leaf(page, "name")).to_contain_text("a robot, [not] a list")
    assert await node.params.get("/name") == "a robot, [not] a list"


async def test_value_saved_without_a_change_keeps_its_type(
    open_page: OpenPage, hub: HubServer, node: fibws.Node
) -> None:
    await node.params.set("/version", "42")
    await node.params.set("/lines", "two\nlines ")
    await node.params.set("/large", 2**63 + 1)
    page = await open_page(hub, "#/parameters")
    for name in ("/version", "/lines", "/large"):
        change = page.get_by_role("button", name=f"Change {name}")
        await change.click()
        await page.get_by_role("button", name="Save").click()
        await expect(change).to_be_focused()
    assert await node.params.get("/version") == "42"
    assert await node.params.get("/lines") == "two\nlines "
    assert await node.params.get("/large") == 2**63 + 1


async def test_parameter_is_added_and_deleted_after_confirmation(
    open_page: OpenPage, hub: HubServer, node: fibws.Node
) -> None:
    page = await open_page(hub, "#/parameters")
    await page.locator("summary", has_text="Add a parameter").click()
    await page.get_by_role("textbox", name="Name").fill("robot/speed")
    await page.get_by_role("textbox", name="Value").fill("true")
    await page.keyboard.press("Enter")
    await expect(leaf(page, "speed")).to_contain_text("true")
    assert await node.params.get("/robot/speed") is True
    delete = page.get_by_role("button", name="Delete /robot/speed")
    await delete.click()
    question = page.get_by_role("dialog", name="Delete /robot/speed?")
    await question.get_by_role("button", name="Keep").click()
    await expect(question).to_be_hidden()
    await expect(leaf(page, "speed")).to_be_visible()
    await delete.click()
    await question.get_by_role("button", name="Delete").click()
    await expect(leaf(page, "speed")).to_have_count(0)
    assert "/robot/speed" not in await node.params.names()


async def test_namespace_is_deleted_with_its_parameters(
    open_page: OpenPage, hub: HubServer, node: fibws.Node
) -> None:
    await node.params.set("/robot", {"speed": 1, "arm": {"joints": 6}})
    page = await open_page(hub, "#/parameters")
    await page.get_by_role("button", name="Delete /robot", exact=True).click()
    question = page.get_by_role("dialog", name="Delete /robot and 2 parameters in it?")
    await question.get_by_role("button", name="Delete").click()
    await expect(leaf(page, "joints")).to_have_count(0)
    assert not [name for name in await node.params.names() if name.startswith("/robot")]


async def test_error_of_the_hub_is_shown(
    open_page: OpenPage, hub: HubServer, node: fibws.Node
) -> None:
    await node.params.set("/speed", 1)
    page = await open_page(hub, "#/parameters")
    await page.get_by_role("button", name="Change /speed").click()
    await page.get_by_role("textbox", name="Value of /speed").fill("null")
    await page.get_by_role("button", name="Save").click()
    alert = page.get_by_role("alert").filter(has_text="null")
    await expect(alert).to_be_visible()
    assert await node.params.get("/speed") == 1
    await page.get_by_role("textbox", name="Value of /speed").fill("2")
    await page.get_by_role("button", name="Save").click()
    await expect(alert).to_be_hidden()
    assert await node.params.get("/speed") == 2


async def test_changes_by_others_appear_without_closing_the_form(
    open_page: OpenPage, hub: HubServer, node: fibws.Node
) -> None:
    await node.params.set("/speed", 1)
    page = await open_page(hub, "#/parameters")
    await expect(leaf(page, "speed")).to_contain_text("1")
    await node.params.set("/speed", 2)
    await expect(leaf(page, "speed")).to_contain_text("2")
    await page.get_by_role("button", name="Change /speed").click()
    value = page.get_by_role("textbox", name="Value of /speed")
    await value.fill("3")
    await node.params.set("/other", "new")
    await page.get_by_role("link", name="Console").click()
    await page.get_by_role("link", name="Parameters").click()
    await expect(value).to_have_value("3")
    await page.get_by_role("button", name="Refresh").click()
    await expect(leaf(page, "other")).to_contain_text("new")
    await expect(value).to_have_value("3")


async def test_names_and_values_are_not_interpreted(
    open_page: OpenPage, hub: HubServer, node: fibws.Node
) -> None:
    await node.params.set("/", {MARKUP: MARKUP, "__proto__": {"constructor": {"x": 1}}})
    page = await open_page(hub, "#/parameters")
    await expect(page.locator("code.value", has_text="onerror")).to_have_text(MARKUP)
    await expect(page.locator("summary", has_text="__proto__/")).to_be_visible()
    await expect(page.locator("summary", has_text="constructor/")).to_be_visible()
    await expect(page.locator("#stage img")).to_have_count(0)


async def test_parameters_are_filtered(
    open_page: OpenPage, hub: HubServer, node: fibws.Node
) -> None:
    await node.params.set("/robot/speed", 1)
    page = await open_page(hub, "#/parameters")
    await expect(leaf(page, "rosversion")).to_be_visible()
    await page.get_by_label("Filter").fill("Robot")
    await expect(leaf(page, "rosversion")).to_have_count(0)
    await expect(leaf(page, "speed")).to_be_visible()
    await expect(page.locator(".parameters > [role=status]")).to_have_text("1 of 7 parameters")


async def test_link_has_the_filter_and_the_folded_namespaces(
    open_page: OpenPage, hub: HubServer, node: fibws.Node
) -> None:
    await node.params.set("/robot/arm/speed", 0.5)
    await node.params.set("/robot/name", "R2")
    page = await open_page(hub, "#/parameters")
    await page.get_by_label("Filter").fill("/robot")
    await page.locator(".parameters summary").filter(has_text="arm/").click()
    await expect(page).to_have_url(re.compile(r"filter=/robot&folded=/robot/arm$"))
    copy = await open_page(hub, "#" + page.url.partition("#")[2])
    await expect(leaf(copy, "name")).to_be_visible()
    await expect(leaf(copy, "speed")).to_be_hidden()
    await expect(leaf(copy, "rosdistro")).to_have_count(0)
