"""Sends transforms to web pages and other clients without a transform library."""

from __future__ import annotations

import click

import fibws
from fibws.cli import node_program
from fibws.tf.republisher import Republisher


@click.command(context_settings=node_program.SETTINGS)
@node_program.node("tf2_web_republisher", anonymous=False)
def command(node: fibws.Node) -> None:
    """Send transforms to the TFClient of roslib and roslibpy, and to roslib's ROS2TFClient.

    It subscribes to /tf and /tf_static, and serves the action /tf2_web_republisher (over topics, as
    in ROS 1, and over operations, as in ROS 2) and the service /republish_tfs. Clients receive the
    transforms that changed by more than their thresholds, at their rate.

    FROM:=TO renames a topic (/tf:=/robot/tf), the service, or the node with its action
    (__name:=transforms), as in ROS.
    """

    async def program() -> None:
        async with node:
            await Republisher(node).run()

    node_program.run(program())


if __name__ == "__main__":
    command(prog_name="python -m fibws.programs.tf2_web_republisher")
