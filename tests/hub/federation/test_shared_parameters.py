"""Parameters that hubs share."""

from __future__ import annotations

import json
import math
import random
from collections.abc import Callable, Iterable
from datetime import datetime
from functools import partial
from typing import Any

import pytest
from random_inputs import times

from fibws.hub.federation.records import ParameterRecord
from fibws.hub.server import HubServer

from .conftest import Join, StartNode, until

BOTH = pytest.mark.parametrize("join", ["websocket", "zenoh"], indirect=True)


def value(hub: HubServer, name: str) -> Any:
    """Return a parameter's value, or None."""
    return hub.graph.parameters.get(name) if hub.graph.parameters.has(name) else None


def text(hub: HubServer) -> bytes | None:
    """Return the shared parameters as JSON, with sorted names."""
    found = value(hub, "/fleet")
    return None if found is None else json.dumps(found, sort_keys=True).encode()


@BOTH
async def test_change_of_a_shared_parameter_reaches_all_hubs(
    join: Join, start_node: StartNode
) -> None:
    first = await join("first", share_params=("/fleet",))
    second = await join("second", first, share_params=("/fleet",))
    third = await join("third", second, share_params=("/fleet",))
    node = await start_node("node", third)
    await node.params.set("/fleet/speed", {"limit": 2.5, "names": ["a", "b"]})
    await node.params.set("/own", 1)
    await until(lambda: value(first, "/fleet/speed/limit") == 2.5, first)
    await until(lambda: value(first, "/fleet/speed/names") == ["a", "b"], first)
    assert value(first, "/own") is None
    first.graph.parameters.set("/fleet/speed/limit", 1)
    await until(lambda: value(third, "/fleet/speed/limit") == 1, third)
    first.graph.parameters.delete("/fleet/speed")
    await until(lambda: value(third, "/fleet/speed") in (None, {}), third)
    assert value(second, "/run_id") != value(first, "/run_id")


async def all_have(hubs: Iterable[HubServer], condition: Callable[[HubServer], object]) -> None:
    """Wait until a condition holds for each hub."""
    for hub in hubs:
        await until(partial(condition, hub), hub)


def is_same(one: HubServer, other: HubServer) -> bool:
    """Return whether two hubs have the same shared parameters."""
    return text(one) == text(other)


VALUES = {
    "bool": True,
    "integer": -(2**63),
    "large integer": 2**1000,
    "float": 0.1,
    "float without a fraction": 1.0,
    "negative zero": -0.0,
    "large float": 1e300,
    "infinity": math.inf,
    "text": "ö\0\n😀",
    "no text": "",
    "list": [1, 2.0, "x", [True, []], {"a": {}}],
    "empty list": [],
    "namespace": {"a": {"b": 1, "c": {"d": [1]}}},
    "bytes": b"\0\xff",
    "date": datetime(2024, 1, 2, 3, 4, 5),
    "empty namespace": {},
    "nested empty namespaces": {"a": {"b": {}, "c": {"d": {}}}, "e": 1, "f": {}},
}


@pytest.mark.parametrize("set_to", VALUES.values(), ids=VALUES)
async def test_each_kind_of_value_comes_and_goes_on_all_hubs(join: Join, set_to: Any) -> None:
    first = await join("first", share_params=("/fleet",))
    second = await join("second", first, share_params=("/fleet",))
    third = await join("third", second, share_params=("/fleet",))
    hubs = (first, second, third)
    parameters = first.graph.parameters
    parameters.set("/fleet/other", "stays")
    parameters.set("/fleet/it", set_to)
    await all_have(hubs, partial(is_same, first))
    parameters.delete("/fleet/it")
    await all_have(hubs, lambda hub: value(hub, "/fleet") == {"other": "stays"})
    parameters.set("/fleet/it", set_to)
    await all_have(hubs, partial(is_same, first))
    third.graph.parameters.set("/fleet/it", 1)
    await all_have(hubs, lambda hub: value(hub, "/fleet/it") == 1)
    third.graph.parameters.delete("/fleet")
    await all_have(hubs, lambda hub: not hub.graph.parameters.has("/fleet"))


async def test_not_a_number_reaches_the_other_hub(join: Join) -> None:
    first = await join("first", share_params=("/fleet",))
    second = await join("second", first, share_params=("/fleet",))
    first.graph.parameters.set("/fleet/it", math.nan)
    await until(lambda: text(second) == b'{"it": null}', second)


async def test_namespace_whose_last_parameter_is_deleted_stays_on_all_hubs(join: Join) -> None:
    first = await join("first", share_params=("/fleet",))
    second = await join("second", first, share_params=("/fleet",))
    first.graph.parameters.set("/fleet/arm/length", 1)
    await until(lambda: value(second, "/fleet/arm/length") == 1, second)
    first.graph.parameters.delete("/fleet/arm/length")
    await until(lambda: value(second, "/fleet") == {"arm": {}}, second)
    second.graph.parameters.set("/fleet/arm/length", 2)
    await until(lambda: value(first, "/fleet") == {"arm": {"length": 2}}, first)


async def test_empty_namespace_takes_nothing_away_that_another_hub_has_set(join: Join) -> None:
    first = await join("first", share_params=("/fleet",))
    second = await join("second", share_params=("/fleet",))
    second.graph.parameters.set("/fleet/arm/length", 2)
    first.graph.parameters.set("/fleet/arm", {})
    await join("third", first, second, share_params=("/fleet",))
    await until(lambda: value(first, "/fleet") == {"arm": {"length": 2}}, first)
    assert value(second, "/fleet") == {"arm": {"length": 2}}


async def test_parameter_with_the_latest_time_can_be_set(join: Join) -> None:
    first = await join("first", share_params=("/fleet",))
    second = await join("second", first, share_params=("/fleet",))
    shared = second.federation._parameters
    record = ParameterRecord(stamp=2**63 - 1, hub="0" * 16, value="1")
    shared.take("/fleet/it", record, second.federation.backplanes[0])
    await until(lambda: value(first, "/fleet/it") == 1, first)
    second.graph.parameters.set("/fleet/it", 2)
    await until(lambda: value(first, "/fleet/it") == 2, first)


async def test_hubs_agree_after_random_changes(join: Join) -> None:
    first = await join("first", share_params=("/fleet",))
    second = await join("second", first, share_params=("/fleet",))
    third = await join("third", second, share_params=("/fleet",))
    hubs = (first, second, third)
    chance = random.Random(7)
    for _ in range(times(1)):
        for _ in range(chance.randrange(1, 6)):
            parameters = chance.choice(hubs).graph.parameters
            name = "/fleet" + "".join(
                f"/{chance.choice('ab')}" for _ in range(chance.randrange(1, 4))
            )
            if chance.random() < 0.4 and parameters.has(name):
                parameters.delete(name)
            else:
                parameters.set(name, chance.choice([1, {}, {"a": {}}, {"b": 2}, {"a": {"b": 3}}]))
        for one, other in ((first, second), (second, third), (first, second)):
            await until(partial(is_same, one, other), one, other)


async def test_later_change_wins_when_hubs_meet(join: Join) -> None:
    first = await join("first", share_params=("/fleet",))
    second = await join("second", share_params=("/fleet",))
    first.graph.parameters.set("/fleet/old", "first")
    second.graph.parameters.set("/fleet/old", "second")
    second.graph.parameters.set("/fleet/new", "second")
    first.graph.parameters.set("/fleet/new", "first")
    await join("third", first, second, share_params=("/fleet",))
    await until(lambda: value(first, "/fleet/old") == "second", first)
    await until(lambda: value(second, "/fleet/new") == "first", second)


async def test_value_gives_way_to_a_namespace_on_all_hubs(join: Join) -> None:
    first = await join("first", share_params=("/fleet",))
    second = await join("second", first, share_params=("/fleet",))
    first.graph.parameters.set("/fleet/arm", 1)
    await until(lambda: value(second, "/fleet/arm") == 1, second)
    first.graph.parameters.set("/fleet/arm/length", 2)
    await until(lambda: value(second, "/fleet/arm") == {"length": 2}, second)
    second.graph.parameters.set("/fleet/arm", 3)
    await until(lambda: value(first, "/fleet/arm") == 3, first)


async def test_parameters_of_a_robot_lie_below_its_prefix(join: Join) -> None:
    cloud = await join("cloud")
    robot = await join("robot", cloud, join_prefix="/robot7", join_export=("/camera/**",))
    robot.graph.parameters.set("/camera/rate", 30)
    robot.graph.parameters.set("/secret", 1)
    await until(lambda: value(cloud, "/robot7/camera/rate") == 30, cloud)
    cloud.graph.parameters.set("/robot7/camera/rate", 10)
    cloud.graph.parameters.set("/fleet", 1)
    await until(lambda: value(robot, "/camera/rate") == 10, robot)
    assert value(cloud, "/robot7/secret") is None
    assert value(robot, "/fleet") is None
    assert value(cloud, "/robot7/run_id") is None
