"""The subscribers of a topic."""

from __future__ import annotations

import asyncio
from collections.abc import Callable
from typing import TypeAlias

import pytest
from patience import PATIENCE

import fibws
from fibws.hub.server import HubServer
from fibws.msg.std_msgs import String
from fibws.tf import subscribers as module
from fibws.tf.subscribers import Subscribers


@pytest.fixture
def quick(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "PAUSE", 0.01)


async def until(condition: Callable[[], bool]) -> None:
    async with asyncio.timeout(PATIENCE):
        while not condition():  # noqa: ASYNC110 - nothing signals the condition
            await asyncio.sleep(0.01)


async def test_subscribers_are_unknown_before_the_first_update(node: fibws.Node) -> None:
    subscribers = Subscribers(node, "/topic")
    assert (subscribers.names, subscribers.is_empty) == (None, False)
    await subscribers.update()
    assert (subscribers.names, subscribers.is_empty) == (frozenset(), True)


async def test_subscribers_are_known_by_name(hub: HubServer, node: fibws.Node) -> None:
    subscribers = Subscribers(node, "/topic")
    async with fibws.Node("listener", hub=hub.url) as other:
        other.subscribe("/topic", String)
        await other.graph.nodes()  # So the hub has had the subscription too.
        await subscribers.update()
        assert (subscribers.names, subscribers.is_empty) == (frozenset({"/listener"}), False)
    async with asyncio.timeout(PATIENCE):
        await subscribers.watch(0.1)
    assert subscribers.is_empty


@pytest.mark.usefixtures("quick")
async def test_changes_are_noticed(node: fibws.Node) -> None:
    subscribers = Subscribers(node, "/topic")
    watching = asyncio.create_task(subscribers.watch())
    async with node.subscribe("/topic", String):
        await until(lambda: subscribers.names == frozenset({"/client"}))
    await until(lambda: subscribers.is_empty)
    watching.cancel()


Answers: TypeAlias = list[list[str] | fibws.ServiceError]
REFUSED = fibws.ServiceError("/rosapi/subscribers", "it does not exist")


@pytest.mark.usefixtures("quick")
@pytest.mark.parametrize(
    "answers",
    [
        [[], [], [], []],
        [["/a"], *([["/a"]] * 20), [], [], [], []],
        [[], [], [], ["/a"], [], [], [], []],
        [*([REFUSED] * 20), [], [], [], []],
    ],
)
async def test_watch_ends_after_a_time_without_subscribers(
    node: fibws.Node, monkeypatch: pytest.MonkeyPatch, answers: Answers
) -> None:
    left = list(answers)

    async def get_subscribers(topic: str) -> list[str]:
        answer = left.pop(0)
        if isinstance(answer, Exception):
            raise answer
        return answer

    monkeypatch.setattr(node.graph, "subscribers", get_subscribers)
    async with asyncio.timeout(PATIENCE):
        await Subscribers(node, "/topic").watch(0.04)
    assert left == []


async def test_failed_update_changes_nothing(
    node: fibws.Node, monkeypatch: pytest.MonkeyPatch
) -> None:
    async def refuse(topic: str) -> list[str]:
        raise REFUSED

    subscribers = Subscribers(node, "/topic")
    await subscribers.update()
    monkeypatch.setattr(node.graph, "subscribers", refuse)
    await subscribers.update()
    assert subscribers.is_empty
