"""An action client: it requests the Fibonacci numbers."""

from __future__ import annotations

from collections.abc import Sequence

import click

import fibws
from fibws.cli import node_program

ACTIONS = {"topics": "actionlib_tutorials/Fibonacci", "operations": "example_interfaces/Fibonacci"}
"""The action's type in ROS 1 and in ROS 2."""


async def send_goal(node: fibws.Node, order: int, over: fibws.Over) -> None:
    """Send a goal; print its feedback and its result."""
    client = node.action_client("fibonacci", ACTIONS[over], over=over)
    click.echo("Waiting for action server to start.")
    await client.wait_for_server()
    goal = await client.send({"order": order})
    try:
        async for feedback in goal.feedback():
            click.echo(f"Feedback: {join(feedback.sequence)}")
        result = await goal.result()
        click.echo(f"Result: {join(result.sequence)}")
    finally:
        await goal.cancel()  # Does nothing if it has ended.


def join(numbers: Sequence[int]) -> str:
    """Return the numbers as ``0, 1, 1, 2``."""
    return ", ".join(map(str, numbers))


# Unknown options may be negative numbers.
@click.command(context_settings={**node_program.SETTINGS, "ignore_unknown_options": True})
@click.argument("order", type=int)
@node_program.node("fibonacci_action_client")
@click.option(
    "--over",
    type=click.Choice(["topics", "operations"]),
    default="topics",
    show_default=True,
    help="How to send the goal.  topics: as in ROS 1.  operations: as rosbridge in ROS 2.",
)
def command(node: fibws.Node, order: int, over: fibws.Over) -> None:
    """Send a goal of ORDER to the action fibonacci; Ctrl-C cancels it.

    FROM:=TO renames the action (fibonacci:=numbers), the node (__name:=asker) or its namespace
    (__ns:=/robot), as in ROS.
    """

    async def program() -> None:
        async with node:
            await send_goal(node, order, over)

    node_program.run(program())


if __name__ == "__main__":
    command(prog_name="python -m fibws.examples.action_client")
