"""The tutorial's first node: it broadcasts the Fibonacci numbers."""

from __future__ import annotations

import click

import fibws
from fibws.cli import options
from fibws.cli.program import run

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


async def broadcast(node: fibws.Node, type_: str, rate: float, on_overflow: str) -> None:
    """Publish 0, 1, 1, 2, 3, 5 ... on ``fibonacci``."""
    numbers = await node.advertise("fibonacci", type_, queue_size=10)
    a, b = 0, 1
    async for _ in node.rate(rate):
        try:
            await numbers.publish(a)
        except fibws.InvalidMessage:
            wider = WIDER.get(numbers.type)
            if on_overflow == "stop":
                node.log.warning("%d does not fit a %s: the series ends.", a, numbers.type)
                return
            if on_overflow == "widen" and wider is not None:
                node.log.warning("%d does not fit a %s: on with %s.", a, numbers.type, wider)
                numbers.close()
                numbers = await node.advertise("fibonacci", wider, queue_size=10)
            else:
                node.log.warning("%d does not fit a %s: the series starts over.", a, numbers.type)
                a, b = 0, 1
        except fibws.OperationRejected as refusal:
            if numbers.type == type_:
                raise
            node.log.warning("%s: the series starts over with %s.", refusal, type_)
            numbers = await node.advertise("fibonacci", type_, queue_size=10)
            a, b = 0, 1
        else:
            node.log.info("%d", a)
            a, b = b, a + b


@click.command(context_settings=options.SETTINGS)
@options.node("fibonacci_broadcaster")
@options.rate
@options.number_type
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

    run(program())


if __name__ == "__main__":
    command(prog_name="python -m fibws.broadcaster")
