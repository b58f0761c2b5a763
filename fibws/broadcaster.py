"""The tutorial's first node: it broadcasts the Fibonacci numbers."""

from __future__ import annotations

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
"""The next type that holds more whole numbers. None follows UInt64: a Float64 would round them."""


def following(fault: fibws.FibwsError, now: str, first: str, on_overflow: str) -> str | None:
    """The type to go on with once ``now`` was of no use; None to end.

    Raises:
        OperationRejected: not even the first type was wanted.
    """
    if isinstance(fault, fibws.OperationRejected):
        # Somebody listens with the narrower type.
        if now == first:
            raise fault
        return first
    if on_overflow == "stop":
        return None
    return WIDER.get(now, now) if on_overflow == "widen" else now


async def broadcast(node: fibws.Node, type_: str, rate: float, on_overflow: str) -> None:
    """Publish 0, 1, 1, 2, 3, 5 ... on ``fibonacci``."""
    numbers = await node.advertise("fibonacci", type_, queue_size=10)
    a, b = 0, 1
    async for _ in node.rate(rate):
        try:
            await numbers.publish(a)
            node.log.info("%d", a)
            a, b = b, a + b
        except (fibws.InvalidMessage, fibws.OperationRejected) as fault:
            full = isinstance(fault, fibws.InvalidMessage)
            # The node has logged the hub's reason.
            reason = f"{a} does not fit a {numbers.type}" if full else f"{numbers.type} was refused"
            next_type = following(fault, numbers.type, type_, on_overflow)
            if next_type is None:
                node.log.warning("%s: the series ends.", reason)
                return
            changes = next_type != numbers.type
            if full and changes:
                node.log.warning("%s: on with %s.", reason, next_type)
            else:
                again = f"over with {next_type}" if changes else "over"
                node.log.warning("%s: the series starts %s.", reason, again)
                a, b = 0, 1
            if changes:
                numbers.close()
                numbers = await node.advertise("fibonacci", next_type, queue_size=10)


@click.command(context_settings=node_program.SETTINGS)
@node_program.node("fibonacci_broadcaster")
@node_program.rate
@node_program.number_type
@click.option(
    "--on-overflow",
    type=click.Choice(["restart", "stop", "widen"]),
    default="restart",
    show_default=True,
    help="What to do at the first number that the type cannot hold (for Int32: 2971215073)."
    "  restart: begin at 0 again.  stop: end.  widen: go on with the next wider type on the same"
    " topic, up to UInt64; the hub refuses that while somebody listens with the old type, upon"
    " which the series begins again.",
)
def command(node: fibws.Node, type_: str, rate: float, on_overflow: str) -> None:
    """Broadcast the Fibonacci numbers on the topic fibonacci.

    FROM:=TO renames a topic (fibonacci:=numbers), the node (__name:=counter) or its namespace
    (__ns:=/robot), as in ROS. A float type rounds large numbers.
    """

    async def program() -> None:
        async with node:
            await broadcast(node, type_, rate, on_overflow)

    node_program.run(program())


if __name__ == "__main__":
    command(prog_name="python -m fibws.broadcaster")
