"""The tutorial's client: it has two integers added."""

from __future__ import annotations

import click

import fibws
from fibws.cli import node_program
from fibws.srv.rospy_tutorials import AddTwoInts


async def ask(node: fibws.Node, a: int, b: int) -> None:
    """Print the sum that ``add_two_ints`` answers with, once somebody offers that service."""
    click.echo(f"Requesting {a}+{b}")
    await node.wait_for_service("add_two_ints")
    response = await node.call("add_two_ints", AddTwoInts, AddTwoInts.Request(a, b))
    click.echo(f"{a} + {b} = {response.sum}")


# What begins with - is a negative number here, and not always an option.
@click.command(context_settings={**node_program.SETTINGS, "ignore_unknown_options": True})
@click.argument("a", type=int)
@click.argument("b", type=int)
@node_program.node("add_two_ints_client")
def command(node: fibws.Node, a: int, b: int) -> None:
    """Have the service add_two_ints add the integers A and B.

    FROM:=TO renames the service (add_two_ints:=add), the node (__name:=asker) or its namespace
    (__ns:=/robot), as in ROS.
    """

    async def program() -> None:
        async with node:
            await ask(node, a, b)

    node_program.run(program())


if __name__ == "__main__":
    command(prog_name="python -m fibws.examples.add_two_ints_client")
