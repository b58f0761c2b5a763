"""The Actions tab of the page: goals with feedback, cancel and result, in a real browser."""

from __future__ import annotations

from collections.abc import AsyncIterator
from typing import Any
from urllib.parse import quote

import pytest
from playwright.async_api import Locator, Page, expect

import fibws
from fibws.action.actionlib_tutorials import Fibonacci
from fibws.hub.server import HubServer
from fibws.msg.actionlib_tutorials import FibonacciFeedback, FibonacciGoal, FibonacciResult
from fibws.node.actions.actions import Over

from .conftest import OpenPage, fixture

MARKUP = "<img src=x onerror='window.harmed = true'>"
ENDLESS = 99
FAILING = 13
Goal = fibws.ServerGoal[FibonacciGoal, FibonacciResult, FibonacciFeedback]

both_kinds = pytest.mark.parametrize("over", ["topics", "operations"])


async def execute(goal: Goal) -> FibonacciResult:
    """Compute the numbers; ENDLESS waits for a cancel, and FAILING fails."""
    order = goal.request.order
    sequence = [0, 1]
    for _ in range(3 if order == ENDLESS else order):
        sequence.append(sequence[-1] + sequence[-2])
        await goal.publish_feedback(FibonacciFeedback(sequence))
    if order == FAILING:
        raise ValueError(f"13 is unlucky {MARKUP}")
    if order == ENDLESS:
        await goal.cancellation()
        return goal.canceled(FibonacciResult(sequence))
    return FibonacciResult(sequence)


@fixture
async def node(hub: HubServer) -> AsyncIterator[fibws.Node]:
    async with fibws.Node("counter", hub=hub.url) as node:
        yield node


async def open_action(
    hub: HubServer, node: fibws.Node, open_page: OpenPage, over: Over, **keywords: Any
) -> Page:
    await node.action_server("/fibonacci", Fibonacci, execute, over=over, concurrent=True)
    return await open_page(hub, f"#/actions/{quote('/fibonacci', '')}", **keywords)


async def send(page: Page, order: int) -> Locator:
    """Send a goal by the form; return its box."""
    boxes = page.locator(".goal")
    before = await boxes.count()
    await page.get_by_label("order int32").fill(str(order))
    await page.get_by_role("button", name="Send goal").click()
    return page.get_by_role("listitem", name=f"Goal {before + 1}", exact=True)


async def test_actions_are_listed_with_type_transport_and_node(
    hub: HubServer, node: fibws.Node, open_page: OpenPage
) -> None:
    page = await open_page(hub, "#/actions")
    await expect(page.get_by_text("No actions.")).to_be_visible()
    await node.action_server("/fibonacci", Fibonacci, execute)
    await node.action_server("/fibonacci", Fibonacci, execute, over="operations")
    rows = page.locator(".browse-list tbody tr")
    await expect(rows).to_have_count(2)
    for row, over in zip(await rows.all(), ("operations", "topics"), strict=True):
        await expect(row).to_contain_text(f"actionlib_tutorials/Fibonacci over {over}")
        await expect(row).to_contain_text("/counter")
        await row.get_by_role("link", name="/fibonacci").click()
        article = page.get_by_role("article", name="/fibonacci")
        await expect(article).to_contain_text(f"over {over}, provided by /counter")


@both_kinds
async def test_goal_has_feedback_and_result(
    hub: HubServer, node: fibws.Node, open_page: OpenPage, over: Over
) -> None:
    page = await open_action(hub, node, open_page, over)
    goal = await send(page, 3)
    await expect(goal.get_by_role("status")).to_have_text("SUCCEEDED")
    await expect(goal.locator(".goal-feedback")).to_contain_text("Feedback (3 messages)")
    await expect(goal.locator(".goal-result .tree-value")).to_have_text(["0", "1", "1", "2", "3"])
    await expect(goal.get_by_role("button", name="Cancel")).to_be_hidden()


@both_kinds
async def test_several_goals_are_followed_and_one_of_them_is_canceled(
    hub: HubServer, node: fibws.Node, open_page: OpenPage, over: Over
) -> None:
    page = await open_action(hub, node, open_page, over)
    first, second = await send(page, ENDLESS), await send(page, ENDLESS)
    for goal in (first, second):
        await expect(goal.locator(".goal-feedback")).to_contain_text("Feedback (3 messages)")
        await expect(goal.get_by_role("status")).to_have_text("ACTIVE")
    await first.get_by_role("button", name="Cancel").click()
    await expect(first.get_by_role("status")).to_have_text("PREEMPTED")
    await expect(first.locator(".goal-result")).to_be_visible()
    await expect(second.get_by_role("status")).to_have_text("ACTIVE")
    # Goals that have not ended are still there after a visit to another tab.
    await page.get_by_role("link", name="Services", exact=True).click()
    await page.get_by_role("link", name="Actions", exact=True).click()
    await page.locator(".browse-list").get_by_role("link", name="/fibonacci").click()
    await second.get_by_role("button", name="Cancel").click()
    await expect(second.get_by_role("status")).to_have_text("PREEMPTED")


@both_kinds
async def test_failed_goal_shows_the_text_of_the_server(
    hub: HubServer, node: fibws.Node, open_page: OpenPage, over: Over
) -> None:
    page = await open_action(hub, node, open_page, over)
    goal = await send(page, FAILING)
    await expect(goal.get_by_role("status")).to_have_text("ABORTED")
    await expect(goal.locator(".goal-text")).to_contain_text(f"13 is unlucky {MARKUP}")
    assert await page.evaluate("window.harmed") is None


async def test_graph_leads_to_the_page_of_an_action(
    hub: HubServer, node: fibws.Node, open_page: OpenPage
) -> None:
    await node.action_server("/fibonacci", Fibonacci, execute)
    page = await open_page(hub, f"#/graph/action/{quote('/fibonacci', '')}")
    await page.get_by_role("link", name="send a goal").click()
    goal = await send(page, 3)
    await expect(goal.get_by_role("status")).to_have_text("SUCCEEDED")


@both_kinds
async def test_states_of_a_goal_are_a_line_of_steps(
    hub: HubServer, node: fibws.Node, open_page: OpenPage, over: Over
) -> None:
    page = await open_action(hub, node, open_page, over)
    goal = await send(page, ENDLESS)
    steps = goal.locator(".goal-steps li")
    await expect(steps).to_have_text(["PENDING", "ACTIVE", "SUCCEEDED"])
    await expect(goal.locator(".goal-status")).to_have_text("ACTIVE")
    await goal.get_by_role("button", name="Cancel").click()
    await expect(goal.get_by_role("status")).to_have_text("PREEMPTED")
    await expect(steps.last).to_have_text("PREEMPTED")
    assert (await steps.all_text_contents())[:2] == ["PENDING", "ACTIVE"]


async def test_feedback_is_plotted_on_the_page_of_the_action(
    hub: HubServer, node: fibws.Node, open_page: OpenPage
) -> None:
    page = await open_action(hub, node, open_page, "topics")
    goal = await send(page, ENDLESS)
    await goal.locator(".goal-feedback").get_by_role("button", name="Plot sequence[3]").click()
    plot = page.locator(".plot")
    await expect(plot.locator(".plot-legend li")).to_contain_text("feedback.sequence[3]")
    second = await send(page, 3)
    await expect(second.get_by_role("status")).to_have_text("SUCCEEDED")
    # The plot shows the values at the time under the mouse.
    await page.mouse.move(0, 0)
    await expect(plot.locator(".plot-value")).to_have_text("2")
    # It ends with the visit, and goes on with the next one.
    await page.get_by_role("link", name="Services", exact=True).click()
    await expect(plot).to_have_count(0)
    await page.go_back()
    await expect(plot.locator(".plot-value")).to_have_text("\N{EN DASH}")
    await send(page, 4)
    await page.mouse.move(0, 0)
    await expect(plot.locator(".plot-value")).to_have_text("2")


async def test_invalid_goal_is_not_sent(
    hub: HubServer, node: fibws.Node, open_page: OpenPage
) -> None:
    page = await open_action(hub, node, open_page, "topics")
    await page.get_by_label("order int32").fill("many")
    await page.get_by_role("button", name="Send goal").click()
    await expect(page.locator(".form-problems")).to_contain_text("order: “many”")
    await expect(page.locator(".goal")).to_have_count(0)


async def test_goal_ends_when_its_server_leaves(hub: HubServer, open_page: OpenPage) -> None:
    async with fibws.Node("counter", hub=hub.url) as node:
        page = await open_action(hub, node, open_page, "operations")
        goal = await send(page, ENDLESS)
        await expect(goal.get_by_role("status")).to_have_text("ACTIVE")
    await expect(goal.get_by_role("status")).to_have_text("ABORTED")
    await expect(page.get_by_text("No node provides this action now.")).to_be_visible()


@pytest.mark.parametrize("scheme", ["light", "dark"])
async def test_view_fits_a_narrow_window(
    hub: HubServer, node: fibws.Node, open_page: OpenPage, scheme: str
) -> None:
    page = await open_action(
        hub, node, open_page, "topics", width=360, height=740, color_scheme=scheme
    )
    goal = await send(page, 20)
    await expect(goal.get_by_role("status")).to_have_text("SUCCEEDED")
    assert await page.evaluate("document.documentElement.scrollWidth") == 360
