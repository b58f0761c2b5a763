"""Parameters that hubs share."""

from __future__ import annotations

from typing import Any

import pytest

from fibws.hub import Hub

from .conftest import Join, StartNode, until

BOTH = pytest.mark.parametrize("join", ["websocket", "zenoh"], indirect=True)


def value(hub: Hub, name: str) -> Any:
    """Return a parameter's value, or None."""
    return hub.graph.parameters.get(name) if hub.graph.parameters.has(name) else None


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
