"""The tutorial's second node: it logs the numbers that it receives."""

from __future__ import annotations

import click

import fibws
from fibws.cli import node_program


async def listen(node: fibws.Node, type_: str) -> None:
    """Log every number on ``fibonacci``."""
    async for number in node.subscribe("fibonacci", type_, queue_size=10):
        node.log.info("I heard %s", number.data)


@click.command(context_settings=node_program.SETTINGS)
@node_program.node("fibonacci_listener")
@node_program.number_type
def command(node: fibws.Node, type_: str) -> None:
    """Log the numbers on the topic fibonacci.

    FROM:=TO renames the topic (fibonacci:=numbers), the node (__name:=ear) or its namespace
    (__ns:=/robot), as in ROS.
    """

    async def program() -> None:
        async with node:
            await listen(node, type_)

    node_program.run(program())


if __name__ == "__main__":
    command(prog_name="python -m fibws.programs.listener")
