"""The Services tab of the page: list, and form for calls, in a real browser."""

from __future__ import annotations

from collections.abc import AsyncIterator

import pytest
from playwright.async_api import Page, expect

import fibws
from fibws.hub.server import HubServer
from fibws.srv.rospy_tutorials import AddTwoInts, AddTwoIntsRequest, AddTwoIntsResponse
from fibws.srv.std_srvs import Trigger, TriggerRequest, TriggerResponse

from .conftest import OpenPage, fixture

MARKUP = "<img src=x onerror='window.harmed = true'>"
ADD = "#/services/%2Fadd_two_ints"


def add(request: AddTwoIntsRequest) -> AddTwoIntsResponse:
    if request.a == 13:
        raise ValueError(f"13 is unlucky {MARKUP}")
    return AddTwoIntsResponse(request.a + request.b)


def speak(request: TriggerRequest) -> TriggerResponse:
    return TriggerResponse(True, MARKUP)


@fixture
async def node(hub: HubServer) -> AsyncIterator[fibws.Node]:
    async with fibws.Node("adder", hub=hub.url) as node:
        await node.service("/add_two_ints", AddTwoInts, add)
        await node.service("/speak", Trigger, speak)
        yield node


async def call(page: Page, a: str, b: str) -> None:
    await page.get_by_label("a int64").fill(a)
    await page.get_by_label("b int64").fill(b)
    await page.keyboard.press("Enter")


@pytest.mark.smoke
async def test_service_is_found_by_the_filter_and_called(
    hub: HubServer, node: fibws.Node, open_page: OpenPage
) -> None:
    page = await open_page(hub, "#/services")
    names = page.locator(".browse-list tbody th a")
    await expect(names).to_have_text(["/add_two_ints", "/speak"])
    await page.get_by_label("Filter services").fill("addtwo")
    await expect(names).to_have_text(["/add_two_ints"])
    await names.click()
    await call(page, "1", "2")
    await expect(page.locator(".service-response .tree")).to_have_text("sum:3")
    await expect(page.get_by_text("response after")).to_be_visible()
    await expect(page.get_by_role("link", name="/adder").first).to_have_attribute(
        "href", "#/graph/node/%2Fadder"
    )


async def test_large_integers_are_sent_exactly_and_marked_as_rounded(
    hub: HubServer, node: fibws.Node, open_page: OpenPage
) -> None:
    page = await open_page(hub, ADD)
    await call(page, str(2**53 + 1), "2")
    # Browsers cannot represent 2^53 + 3; without the 1, the sum would be 2^53 + 2.
    await expect(page.locator(".tree-value")).to_have_text(f"≈ {2**53 + 4}")


async def test_invalid_request_is_not_sent(
    hub: HubServer, node: fibws.Node, open_page: OpenPage
) -> None:
    page = await open_page(hub, ADD)
    await call(page, "1", "two")
    await expect(page.locator(".form-problems")).to_contain_text("b: “two”")
    await expect(page.locator(".service-response")).to_be_empty()


async def test_error_of_the_service_is_shown(
    hub: HubServer, node: fibws.Node, open_page: OpenPage
) -> None:
    page = await open_page(hub, ADD)
    await call(page, "13", "2")
    await expect(page.locator(".browse-page > .error")).to_contain_text(f"13 is unlucky {MARKUP}")
    await expect(page.get_by_text("failed after")).to_be_visible()
    await call(page, "12", "2")
    await expect(page.locator(".service-response .tree")).to_have_text("sum:14")
    await expect(page.locator(".browse-page > .error")).to_be_hidden()


async def test_request_without_fields_and_response_with_markup(
    hub: HubServer, node: fibws.Node, open_page: OpenPage
) -> None:
    page = await open_page(hub, "#/services/%2Fspeak")
    await expect(page.get_by_text("std_srvs/TriggerRequest has no fields.")).to_be_visible()
    await page.get_by_role("button", name="Call").click()
    await expect(page.locator(".service-response .tree")).to_contain_text(f'"{MARKUP}"')
    assert await page.evaluate("window.harmed") is None


async def test_form_is_kept_when_other_services_appear(
    hub: HubServer, node: fibws.Node, open_page: OpenPage
) -> None:
    page = await open_page(hub, ADD)
    await page.get_by_label("a int64").fill("8")
    await node.service("/another", Trigger, speak)
    await expect(page.get_by_role("link", name="/another")).to_be_visible()
    await expect(page.get_by_label("a int64")).to_have_value("8")


async def test_missing_service_can_be_called_when_it_appears(
    hub: HubServer, open_page: OpenPage
) -> None:
    page = await open_page(hub, ADD)
    await expect(page.get_by_text("No node provides this service")).to_be_visible()
    async with fibws.Node("adder", hub=hub.url) as node:
        await node.service("/add_two_ints", AddTwoInts, add)
        await call(page, "1", "2")
        await expect(page.locator(".service-response .tree")).to_have_text("sum:3")
    await expect(page.get_by_text("No node provides this service")).to_be_visible()


@pytest.mark.parametrize("scheme", ["light", "dark"])
async def test_view_fits_a_narrow_window(
    hub: HubServer, node: fibws.Node, open_page: OpenPage, scheme: str
) -> None:
    page = await open_page(hub, "#/services", width=360, height=740, color_scheme=scheme)
    await page.get_by_role("link", name="/add_two_ints").click()
    await call(page, "1", "2")
    await expect(page.locator(".service-response .tree")).to_have_text("sum:3")
    assert await page.evaluate("document.documentElement.scrollWidth") == 360
