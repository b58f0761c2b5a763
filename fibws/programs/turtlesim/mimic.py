"""Lets one turtle do what another one does."""

from __future__ import annotations

import click

import fibws
from fibws.cli import node_program
from fibws.msg.geometry_msgs import Twist, Vector3
from fibws.msg.turtlesim import Pose


async def mimic(node: fibws.Node) -> None:
    """Publish the velocity in each pose until the node ends."""
    # Launch files of ROS remap the namespaces, not the topics.
    follower, leader = node.resolve("output"), node.resolve("input")
    velocities = await node.advertise(f"{follower}/cmd_vel", Twist, queue_size=1)
    async for pose in node.subscribe(f"{leader}/pose", Pose, queue_size=1):
        linear, angular = Vector3(x=pose.linear_velocity), Vector3(z=pose.angular_velocity)
        await velocities.publish(Twist(linear, angular))


@click.command(context_settings=node_program.SETTINGS)
@node_program.node("turtle_mimic", anonymous=False)
def command(node: fibws.Node) -> None:
    """Let a turtle mimic another one.

    Name both turtles: input:=turtle1 output:=turtle2.
    """

    async def program() -> None:
        async with node:
            await mimic(node)

    node_program.run(program())


if __name__ == "__main__":
    command(prog_name="python -m fibws.programs.turtlesim.mimic")
