"""An action server: it computes the Fibonacci numbers, one per second."""

from __future__ import annotations

import asyncio
from typing import TypeAlias

import click

import fibws
from fibws.action import actionlib_tutorials, example_interfaces
from fibws.cli import node_program
from fibws.msg import actionlib_tutorials as ros1
from fibws.msg import example_interfaces as ros2

Ros1Goal: TypeAlias = fibws.ServerGoal[
    ros1.FibonacciGoal, ros1.FibonacciResult, ros1.FibonacciFeedback
]
Ros2Goal: TypeAlias = fibws.ServerGoal[
    ros2.FibonacciGoal, ros2.FibonacciResult, ros2.FibonacciFeedback
]

MAX_INDEX = 46
"""F(46) = 1836311903 is the last Fibonacci number that fits an int32."""


def check(order: int, last: int) -> str | None:
    """Return why a sequence that ends with F(``last``) cannot be computed; None if it can."""
    if order < 0:
        return f"order {order} is negative"
    if last > MAX_INDEX:
        return f"order {order} is too large: F({last}) does not fit an int32"
    return None


async def serve_ros1(node: fibws.Node, rate: float) -> None:
    """Serve ``fibonacci`` as actionlib's fibonacci_server.cpp: n + 2 numbers for order n."""

    async def execute(goal: Ros1Goal) -> ros1.FibonacciResult:
        order = goal.request.order
        if (reason := check(order, last=order + 1)) is not None:
            node.log.warning("fibonacci: Aborted, %s", reason)
            return goal.aborted(text=reason)
        sequence = [0, 1]
        node.log.info(
            "fibonacci: Executing, creating fibonacci sequence of order %d with seeds %d, %d",
            *(order, *sequence),
        )
        for _ in range(order):
            if goal.cancel_requested:
                node.log.info("fibonacci: Preempted")
                return goal.canceled()
            sequence.append(sequence[-1] + sequence[-2])
            await goal.publish_feedback(ros1.FibonacciFeedback(sequence))
            await goal.cancellation(timeout=1 / rate)
        node.log.info("fibonacci: Succeeded")
        return ros1.FibonacciResult(sequence)

    server = await node.action_server(
        "fibonacci", actionlib_tutorials.Fibonacci, execute, over="topics"
    )
    await server.spin()


async def serve_ros2(node: fibws.Node, rate: float) -> None:
    """Serve ``fibonacci`` as ROS 2's action_tutorials_py: n + 1 numbers for order n."""

    async def execute(goal: Ros2Goal) -> ros2.FibonacciResult:
        order = goal.request.order
        if (reason := check(order, last=order)) is not None:
            node.log.warning("Goal aborted: %s", reason)
            return goal.aborted(text=reason)
        node.log.info("Executing goal...")
        sequence = [0, 1]
        for _ in range(1, order):
            if goal.cancel_requested:
                node.log.info("Goal canceled")
                return goal.canceled()
            sequence.append(sequence[-1] + sequence[-2])
            node.log.info("Feedback: %s", sequence)
            await goal.publish_feedback(ros2.FibonacciFeedback(sequence))
            await goal.cancellation(timeout=1 / rate)
        return ros2.FibonacciResult(sequence)

    server = await node.action_server(
        "fibonacci", example_interfaces.Fibonacci, execute, over="operations"
    )
    await server.spin()


@click.command(context_settings=node_program.SETTINGS)
@node_program.node("fibonacci_action_server", anonymous=False)
@node_program.rate
def command(node: fibws.Node, rate: float) -> None:
    """Compute Fibonacci numbers for the goals of the action fibonacci.

    Goals over topics, as in ROS 1: actionlib_tutorials/Fibonacci, n + 2 numbers for order n; a new
    goal cancels the previous one. Goals over operations, as in ROS 2: example_interfaces/Fibonacci,
    n + 1 numbers for order n; goals are executed concurrently.

    FROM:=TO renames the action (fibonacci:=numbers), the node (__name:=counter) or its namespace
    (__ns:=/robot), as in ROS.
    """

    async def program() -> None:
        async with node:
            await asyncio.gather(serve_ros1(node, rate), serve_ros2(node, rate))

    node_program.run(program())


if __name__ == "__main__":
    command(prog_name="python -m fibws.examples.action_server")
