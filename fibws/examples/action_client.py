"""The tutorials' action client: it asks for the Fibonacci numbers."""

from __future__ import annotations

from collections.abc import Sequence

import click

import fibws
from fibws.cli import node_program

ACTIONS = {"topics": "actionlib_tutorials/Fibonacci", "operations": "example_interfaces/Fibonacci"}
"""The action's type in each of the two ROS."""


async def ask(node: fibws.Node, order: int, over: fibws.Over) -> None:
    """Print the numbers as the server comes to them, and the result."""
    client = node.action_client("fibonacci", ACTIONS[over], over=over)
    click.echo("Waiting for action server to start.")
    await client.wait_for_server()
    goal = await client.send({"order": order})
    try:
        async for feedback in goal.feedback():
            click.echo(f"Feedback: {listed(feedback.sequence)}")
        result = await goal.result()
        click.echo(f"Result: {listed(result.sequence)}")
    finally:
        await goal.cancel()  # Does nothing once it has ended.


def listed(numbers: Sequence[int]) -> str:
    """Write 0, 1, 1, 2, 3, 5."""
    return ", ".join(map(str, numbers))


# What begins with - is a negative number here, and not always an option.
@click.command(context_settings={**node_program.SETTINGS, "ignore_unknown_options": True})
@click.argument("order", type=int)
@node_program.node("fibonacci_action_client")
@click.option(
    "--over",
    type=click.Choice(["topics", "operations"]),
    default="topics",
    show_default=True,
    help="How to ask.  topics: as ROS 1's actionlib.  operations: as rosbridge does for ROS 2.",
)
def command(node: fibws.Node, order: int, over: fibws.Over) -> None:
    """Send the action fibonacci a goal of ORDER; Ctrl-C cancels it.

    FROM:=TO renames the action (fibonacci:=numbers), the node (__name:=asker) or its namespace
    (__ns:=/robot), as in ROS.
    """

    async def program() -> None:
        async with node:
            await ask(node, order, over)

    node_program.run(program())


if __name__ == "__main__":
    command(prog_name="python -m fibws.examples.action_client")
