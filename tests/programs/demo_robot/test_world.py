"""The demo robot's world: walls, rays, and a robot that cannot drive through walls."""

from __future__ import annotations

import math
from itertools import pairwise

import pytest

from fibws.programs.demo_robot.world import (
    PLAN,
    RESOLUTION,
    START,
    TRACK,
    WHEEL,
    Robot,
    RobotPose,
    World,
    toward,
)

ROOM = """\
######
#    #
#    #
######
"""


@pytest.fixture
def room() -> World:
    return World(ROOM)


def test_plan_is_a_closed_rectangle() -> None:
    rows = PLAN.splitlines()
    assert len({len(row) for row in rows}) == 1
    assert set(rows[0] + rows[-1]) == {"#"}
    assert all(row[0] == row[-1] == "#" for row in rows)
    assert World().is_free(*START[:2])


def test_upper_row_of_the_plan_is_the_last_one() -> None:
    world = World("##\n# \n")
    assert list(world.cells()) == [True, False, True, True]
    assert world.is_wall(0.1, 0.1) and not world.is_wall(RESOLUTION + 0.1, 0.1)
    assert world.is_wall(-0.1, 0.1) and world.is_wall(0.1, 99.0)


@pytest.mark.parametrize(
    ("angle", "distance"),
    [
        *((0.0, 0.75), (math.pi / 2, 0.25), (math.pi, 0.25), (-math.pi / 2, 0.25)),
        *((math.pi / 4, 0.25 * math.sqrt(2)), (math.tau, 0.75)),
    ],
)
def test_ray_ends_at_the_wall(room: World, angle: float, distance: float) -> None:
    assert room.distance(0.5, 0.5, angle, 10.0) == pytest.approx(distance)


def test_ray_that_is_too_long_is_infinite(room: World) -> None:
    assert room.distance(0.5, 0.5, 0.0, 0.7) == math.inf


def test_return_at_90_degrees_is_left_of_the_robot() -> None:
    robot = Robot(World(ROOM), (1.0, 0.35, 0.0))
    back, right, ahead, left = robot.scan(4, 10.0)
    assert (back, right) == pytest.approx((0.75, 0.1))
    assert (ahead, left) == pytest.approx((0.25, 0.4))


def test_way_goes_around_walls_and_through_doors() -> None:
    world = World()
    start, goal = START[:2], (6.0, 4.0)
    assert not world.is_clear(start, goal)
    way = world.path(start, goal)
    assert way is not None and way[-1] == goal
    assert 2 <= len(way) <= 6
    for before, after in pairwise([start, *way]):
        assert world.is_clear(before, after)


def test_way_in_an_open_room_is_straight(room: World) -> None:
    assert room.path((0.5, 0.5), (0.9, 0.5)) == [(0.9, 0.5)]
    assert room.path((0.5, 0.5), (0.5, 0.5)) == [(0.5, 0.5)]


def test_goal_in_a_wall_and_one_behind_it_have_no_way() -> None:
    world = World("#########\n#   #   #\n#   #   #\n#   #   #\n#########\n")
    assert world.path((0.6, 0.6), (0.1, 0.1)) is None
    assert world.path((0.6, 0.6), (1.6, 0.6)) is None


def test_robot_reaches_goals_all_over_the_world() -> None:
    robot = Robot(World())
    for goal in ((8.5, 0.6), (0.6, 4.2), (9.3, 4.2), (6.0, 1.2), START[:2]):
        way = robot.world.path((robot.pose.x, robot.pose.y), goal)
        assert way is not None
        for x, y in way:
            for _ in range(2000):
                if math.hypot(x - robot.pose.x, y - robot.pose.y) < 0.1:
                    break
                robot.command(*toward(robot.pose, x, y))
                robot.move(0.05)
        assert math.hypot(goal[0] - robot.pose.x, goal[1] - robot.pose.y) < 0.1


def test_robot_drives_until_a_wall() -> None:
    robot = Robot(World())
    robot.command(1.0, 0.0)
    robot.move(0.5)
    assert (robot.pose.x, robot.pose.y) == pytest.approx((1.5, 0.6))
    for _ in range(1000):
        robot.move(0.1)
    assert robot.is_blocked
    assert robot.world.is_free(robot.pose.x, robot.pose.y)
    before = robot.pose.yaw
    robot.command(0.0, 1.0)
    robot.move(0.1)
    assert robot.pose.yaw > before and not robot.is_blocked


def test_wheels_turn_as_far_as_the_robot_drives() -> None:
    robot = Robot(World())
    robot.command(0.7, 0.0)
    robot.move(0.5)
    assert robot.wheels == pytest.approx([0.35 / WHEEL] * 2)
    robot.command(0.0, 1.0)
    robot.move(0.5)
    left, right = robot.wheels
    assert right - left == pytest.approx(0.5 * TRACK / WHEEL)


def test_depths_end_at_walls_and_at_the_floor() -> None:
    robot = Robot(World(ROOM), (0.6, 0.5, 0.0))
    points = robot.depths(1, 31, 2.0, 0.1, 0.3, 5.0)
    assert all(y == pytest.approx(0.0) for _, y, _, _ in points)
    # The wall is 0.55 m ahead; its foot is hidden by nothing.
    ahead = [x for x, _, z, _ in points if z > -0.29]
    assert ahead == pytest.approx([0.55] * len(ahead)) and len(ahead) > 10
    floor = [x for x, _, z, _ in points if z == pytest.approx(-0.3)]
    assert floor and max(floor) < 0.55
    assert max(z for _, _, z, _ in points) < 0.2


def test_velocity_has_limits() -> None:
    robot = Robot(World())
    robot.command(100.0, -100.0)
    assert (robot.speed, robot.turn) == (1.0, -2.0)
    robot.command(math.nan, 0.0)
    robot.command(0.0, math.inf)
    assert (robot.speed, robot.turn) == (1.0, -2.0)


def test_camera_sees_near_walls_higher_than_far_ones() -> None:
    width, height = 8, 20

    def wall_rows(robot: Robot) -> int:
        image = robot.look(width, height, 1.0)
        assert len(image) == 3 * width * height
        column = [image[3 * (row * width + 4) :][:3] for row in range(height)]
        return sum(red > blue for red, _, blue in column)

    near, far = (Robot(World(), (x, 3.0, 0.0)) for x in (4.2, 1.0))
    assert wall_rows(near) > wall_rows(far) > 0


@pytest.mark.parametrize("yaw", [0.0, 1.5, 3.0, -2.0])
def test_robot_reaches_a_place(yaw: float) -> None:
    robot = Robot(World(), (1.0, 0.6, yaw))
    for _ in range(400):
        robot.command(*toward(robot.pose, 3.0, 0.7))
        robot.move(0.05)
    assert math.hypot(robot.pose.x - 3.0, robot.pose.y - 0.7) < 0.05
    assert toward(RobotPose(0.0, 0.0, 0.0), 1.0, 0.0) == pytest.approx((0.6, 0.0))
