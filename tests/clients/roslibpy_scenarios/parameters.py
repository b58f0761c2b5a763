"""Parameters, as the documentation of roslibpy uses them."""

from __future__ import annotations

from typing import Any

from patience import PATIENCE
from roslibpy import Param

from .world import World


def parameter_can_be_set_read_listed_and_deleted(world: World) -> Any:
    ros = world.connect()

    def names() -> list[str]:
        return [name for name in ros.get_params() if name.startswith("/camera")]

    gains = {"red": 1.5, "blue": [1, 2], "label": "wörld", "on": True}
    ros.set_param("/camera/gains", gains)
    value, listed = ros.get_param("/camera/gains"), names()
    ros.delete_param("/camera/gains")
    return {"value": value, "listed": listed, "after": names()}


def parameter_inside_another_one_can_be_read_alone(world: World) -> Any:
    ros = world.connect()
    ros.set_param("/arm", {"joints": {"elbow": 3}})
    return ros.get_param("/arm/joints/elbow")


def missing_parameter_is_null(world: World) -> Any:
    return Param(world.connect(), "/never_set").get(timeout=PATIENCE)


def parameters_of_the_hub_exist(world: World) -> Any:
    return world.connect().get_param("/rosdistro")


def parameter_is_read_by_another_client(world: World) -> Any:
    world.connect().set_param("/max_vel_x", 0.8)
    return world.connect().get_param("/max_vel_x")
