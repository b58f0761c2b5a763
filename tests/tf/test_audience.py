"""Who listens to a topic."""

from __future__ import annotations

import asyncio
from collections.abc import Callable
from typing import TypeAlias

import pytest

import fibws
from fibws.hub import Hub
from fibws.msg.std_msgs import String
from fibws.tf import audience as module
from fibws.tf.audience import Audience

from .conftest import PATIENCE


@pytest.fixture
def quick(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "PAUSE", 0.01)


async def until(condition: Callable[[], bool]) -> None:
    async with asyncio.timeout(PATIENCE):
        while not condition():  # noqa: ASYNC110 - what it waits for tells nobody
            await asyncio.sleep(0.01)


async def test_it_is_not_known_until_somebody_looked(node: fibws.Node) -> None:
    audience = Audience(node, "/topic")
    assert (audience.listeners, audience.is_empty) == (None, False)
    await audience.look()
    assert (audience.listeners, audience.is_empty) == (frozenset(), True)


async def test_listeners_are_known_by_name(hub: Hub, node: fibws.Node) -> None:
    audience = Audience(node, "/topic")
    async with fibws.Node("listener", hub=hub.url) as other:
        other.subscribe("/topic", String)
        await other.graph.nodes()  # So the hub has had the subscription too.
        await audience.look()
        assert (audience.listeners, audience.is_empty) == (frozenset({"/listener"}), False)
    async with asyncio.timeout(PATIENCE):
        await audience.watch(0.1)
    assert audience.is_empty


@pytest.mark.usefixtures("quick")
async def test_whoever_comes_and_goes_is_seen(node: fibws.Node) -> None:
    audience = Audience(node, "/topic")
    watching = asyncio.create_task(audience.watch())
    async with node.subscribe("/topic", String):
        await until(lambda: audience.listeners == frozenset({"/client"}))
    await until(lambda: audience.is_empty)
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
async def test_it_is_watched_until_nobody_has_listened_for_a_time(
    node: fibws.Node, monkeypatch: pytest.MonkeyPatch, answers: Answers
) -> None:
    left = list(answers)

    async def subscribers(topic: str) -> list[str]:
        answer = left.pop(0)
        if isinstance(answer, Exception):
            raise answer
        return answer

    monkeypatch.setattr(node.graph, "subscribers", subscribers)
    async with asyncio.timeout(PATIENCE):
        await Audience(node, "/topic").watch(0.04)
    assert left == []


async def test_a_hub_that_does_not_tell_changes_nothing(
    node: fibws.Node, monkeypatch: pytest.MonkeyPatch
) -> None:
    async def refuse(topic: str) -> list[str]:
        raise REFUSED

    audience = Audience(node, "/topic")
    await audience.look()
    monkeypatch.setattr(node.graph, "subscribers", refuse)
    await audience.look()
    assert audience.is_empty
