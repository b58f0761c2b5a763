"""Tells web pages and others without a transform library where frames are."""

from __future__ import annotations

import click

import fibws
from fibws.cli import node_program
from fibws.tf.republisher import Republisher


@click.command(context_settings=node_program.SETTINGS)
@node_program.node("tf2_web_republisher", anonymous=False)
def command(node: fibws.Node) -> None:
    """Tell TFClient, as roslib and roslibpy have it, and roslib's ROS2TFClient where frames are.

    It takes what is published on /tf and /tf_static, and answers goals of the action
    /tf2_web_republisher (over topics, as in ROS 1, and by operation, as in ROS 2) and calls of the
    service /republish_tfs: with the transforms that changed by more than a client's thresholds, at
    the client's rate.

    FROM:=TO renames a topic (/tf:=/robot/tf), the service, or the node with its action
    (__name:=transforms), as in ROS.
    """

    async def program() -> None:
        async with node:
            await Republisher(node).run()

    node_program.run(program())


if __name__ == "__main__":
    command(prog_name="python -m fibws.tf.tf2_web_republisher")
