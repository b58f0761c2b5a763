"""A service client: it requests the sum of two integers."""

from __future__ import annotations

import click

import fibws
from fibws.cli import node_program
from fibws.srv.rospy_tutorials import AddTwoInts


async def call(node: fibws.Node, a: int, b: int) -> None:
    """Wait for the service ``add_two_ints``, call it and print the sum."""
    click.echo(f"Requesting {a}+{b}")
    await node.wait_for_service("add_two_ints")
    response = await node.call("add_two_ints", AddTwoInts, AddTwoInts.Request(a, b))
    click.echo(f"{a} + {b} = {response.sum}")


# Unknown options may be negative numbers.
@click.command(context_settings={**node_program.SETTINGS, "ignore_unknown_options": True})
@click.argument("a", type=int)
@click.argument("b", type=int)
@node_program.node("add_two_ints_client")
def command(node: fibws.Node, a: int, b: int) -> None:
    """Add the integers A and B with the service add_two_ints.

    FROM:=TO renames the service (add_two_ints:=add), the node (__name:=asker) or its namespace
    (__ns:=/robot), as in ROS.
    """

    async def program() -> None:
        async with node:
            await call(node, a, b)

    node_program.run(program())


if __name__ == "__main__":
    command(prog_name="python -m fibws.examples.add_two_ints_client")
