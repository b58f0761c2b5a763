"""Lets a turtle draw squares, by its poses alone."""

from __future__ import annotations

from math import cos, pi, remainder, sin

import click

import fibws
from fibws.cli import node_program
from fibws.msg.geometry_msgs import Twist, Vector3
from fibws.msg.turtlesim import Pose
from fibws.srv.std_srvs import Empty

SIDE = 2.0
"""The length of a side in meters."""
LINEAR, ANGULAR = 1.0, 0.4
"""Meters and radians per second."""
NEAR, NEAR_ANGLE = 0.1, 0.01
"""How near to a goal the turtle stops, in meters and radians."""
STILL = 0.0001


class Square:
    """The next velocity of a turtle that draws a square.

    It goes forward to a goal, stops, turns by 90 degrees, stops, and so on.
    """

    def __init__(self) -> None:
        self._goal: Pose | None = None
        self._turns = False
        self._stops = False

    def next(self, pose: Pose) -> tuple[Twist, str | None]:
        """Return the next velocity at a pose, and a text for the log."""
        if self._goal is None:
            return Twist(), self._set_goal(pose)
        if not self._stops and self._has_reached(pose):
            self._stops = True
        if not self._stops:
            turn, forward = Twist(angular=Vector3(z=ANGULAR)), Twist(Vector3(x=LINEAR))
            return (turn if self._turns else forward), None
        if abs(pose.linear_velocity) > STILL or abs(pose.angular_velocity) > STILL:
            return Twist(), None
        self._turns = not self._turns
        self._stops = False
        return Twist(), f"Reached goal\n{self._set_goal(pose)}"

    def _set_goal(self, pose: Pose) -> str:
        x, y, theta = pose.x, pose.y, pose.theta
        if self._turns:
            theta = remainder(theta + pi / 2, 2 * pi)
        else:
            x, y = x + cos(theta) * SIDE, y + sin(theta) * SIDE
        self._goal = Pose(x, y, theta)
        return f"New goal [{x:f} {y:f}, {theta:f}]"

    def _has_reached(self, pose: Pose) -> bool:
        goal = self._goal
        assert goal is not None
        angle = abs(remainder(pose.theta - goal.theta, 2 * pi))
        is_there = abs(pose.x - goal.x) < NEAR and abs(pose.y - goal.y) < NEAR
        return is_there and angle < NEAR_ANGLE


async def draw(node: fibws.Node) -> None:
    """Reset the simulator, then draw squares until the node ends."""
    poses = node.subscribe("turtle1/pose", Pose, queue_size=1)
    velocities = await node.advertise("turtle1/cmd_vel", Twist, queue_size=1)
    await node.wait_for_service("reset")
    await node.call("reset", Empty)
    square = Square()
    async for pose in poses:
        twist, text = square.next(pose)
        for line in (text or "").splitlines():
            node.log.info(line)
        await velocities.publish(twist)


@click.command(context_settings=node_program.SETTINGS)
@node_program.node("draw_square", anonymous=False)
def command(node: fibws.Node) -> None:
    """Let turtle1 draw squares of 2 m."""

    async def program() -> None:
        async with node:
            await draw(node)

    node_program.run(program())


if __name__ == "__main__":
    command(prog_name="python -m fibws.programs.turtlesim.draw_square")
