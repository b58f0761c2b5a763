"""A service server: it adds two integers."""

from __future__ import annotations

import click

import fibws
from fibws.cli import node_program
from fibws.srv.rospy_tutorials import AddTwoInts, AddTwoIntsRequest, AddTwoIntsResponse


def add(request: AddTwoIntsRequest) -> AddTwoIntsResponse:
    """Return the sum."""
    total = request.a + request.b
    click.echo(f"Returning [{request.a} + {request.b} = {total}]")
    return AddTwoIntsResponse(total)


async def serve(node: fibws.Node) -> None:
    """Serve ``add_two_ints`` until the node ends."""
    service = await node.service("add_two_ints", AddTwoInts, add)
    click.echo("Ready to add two ints.")
    await service.spin()


@click.command(context_settings=node_program.SETTINGS)
@node_program.node("add_two_ints_server", anonymous=False)
def command(node: fibws.Node) -> None:
    """Add two integers for callers of the service add_two_ints.

    FROM:=TO renames the service (add_two_ints:=add), the node (__name:=adder) or its namespace
    (__ns:=/robot), as in ROS.
    """

    async def program() -> None:
        async with node:
            await serve(node)

    node_program.run(program())


if __name__ == "__main__":
    command(prog_name="python -m fibws.examples.add_two_ints_server")
