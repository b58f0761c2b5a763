"""The tutorial's first node: it publishes the Fibonacci numbers."""

from __future__ import annotations

from typing import Any

import click

import fibws
from fibws.cli import node_program

WIDER = {
    "std_msgs/Int8": "std_msgs/Int16",
    "std_msgs/Int16": "std_msgs/Int32",
    "std_msgs/Int32": "std_msgs/Int64",
    "std_msgs/Int64": "std_msgs/UInt64",
    "std_msgs/UInt8": "std_msgs/UInt16",
    "std_msgs/UInt16": "std_msgs/UInt32",
    "std_msgs/UInt32": "std_msgs/UInt64",
}
"""The next wider type of each integer type. UInt64 is the widest: a Float64 would round."""


def next_type(error: fibws.FibwsError, now: str, first: str, on_overflow: str) -> str | None:
    """Return the type to continue with after an error; None to stop.

    Raises:
        OperationRejected: the hub refused the first type.
    """
    if isinstance(error, fibws.OperationRejected):
        # The topic has subscribers of the narrower type.
        if now == first:
            raise error
        return first
    if on_overflow == "stop":
        return None
    return WIDER.get(now, now) if on_overflow == "widen" else now


async def broadcast(node: fibws.Node, type_: str, rate: float, on_overflow: str) -> None:
    """Publish 0, 1, 1, 2, 3, 5 ... on ``fibonacci``."""
    current_type = type_
    numbers: fibws.Publisher[Any, ...] | None = None
    a, b = 0, 1
    async for _ in node.rate(rate):
        try:
            if numbers is None:
                numbers = await node.advertise("fibonacci", current_type, queue_size=10)
            await numbers.publish(a)
            node.log.info("%d", a)
            a, b = b, a + b
        except (fibws.InvalidMessage, fibws.OperationRejected) as error:
            is_full = isinstance(error, fibws.InvalidMessage)
            new_type = next_type(error, current_type, type_, on_overflow)
            if is_full:
                reason = f"{a} does not fit a {current_type}"
            else:
                reason = f"{current_type} was refused ({error})"
            if new_type is None:
                node.log.warning("%s: stopping.", reason)
                return
            changes = new_type != current_type
            if is_full and changes:
                node.log.warning("%s: continuing with %s.", reason, new_type)
            else:
                node.log.warning("%s: starting over with %s.", reason, new_type)
                a, b = 0, 1
            if changes and numbers is not None:
                numbers.close()
                numbers = None
            current_type = new_type


@click.command(context_settings=node_program.SETTINGS)
@node_program.node("fibonacci_broadcaster")
@node_program.rate
@node_program.number_type
@click.option(
    "--on-overflow",
    type=click.Choice(["restart", "stop", "widen"]),
    default="restart",
    show_default=True,
    help="What to do at the first number that does not fit the type (for Int32: 2971215073)."
    "  restart: start over at 0.  stop: exit.  widen: continue with the next wider type, up to"
    " UInt64, or start over if the topic has subscribers of the old type.",
)
def command(node: fibws.Node, type_: str, rate: float, on_overflow: str) -> None:
    """Publish the Fibonacci numbers on the topic fibonacci.

    FROM:=TO renames the topic (fibonacci:=numbers), the node (__name:=counter) or its namespace
    (__ns:=/robot), as in ROS. A float type rounds large numbers.
    """

    async def program() -> None:
        async with node:
            await broadcast(node, type_, rate, on_overflow)

    node_program.run(program())


if __name__ == "__main__":
    command(prog_name="python -m fibws.programs.broadcaster")
