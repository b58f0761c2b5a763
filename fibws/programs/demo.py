"""A hub and nodes in one process, for ``fibws demo``: numbers, turtlesim or a robot."""

from __future__ import annotations

import asyncio
import errno
import os
import sys
from collections.abc import Awaitable, Callable
from contextlib import AsyncExitStack
from functools import partial

import click

import fibws
from fibws.cli import node_program
from fibws.client.hub_client import is_hub_running
from fibws.errors import HubError, SettingError
from fibws.hub import Hub, Settings
from fibws.hub.__main__ import environment_settings
from fibws.hub.listening import local_url
from fibws.hub_address import ENVIRONMENT, page_url
from fibws.programs.broadcaster import broadcast
from fibws.programs.demo_robot import robot_node
from fibws.programs.listener import listen
from fibws.programs.turtlesim.teleop_key import drive
from fibws.programs.turtlesim.turtlesim_node import simulate

TYPE = "std_msgs/Int32"
FIBONACCI = "Below, a broadcaster publishes numbers to a listener. Press Ctrl-C to stop."
ROBOT = "Below is the log of a simulated robot. Press Ctrl-C to stop."
TURTLESIM = "Below is the log of turtlesim. Press Ctrl-C to stop."
LINE = "[${severity}] [${time}]: ${message}"


async def demo(
    settings: Settings, page: str, introduction: str, run: Callable[[str], Awaitable[None]]
) -> None:
    """Run nodes, and a hub with these settings unless one is running.

    Args:
        settings: those of the hub.
        page: what to open in a browser, with {} for the address of the page.
        introduction: what the terminal shows below.
        run: runs the nodes; takes the hub's address.
    """
    async with AsyncExitStack() as stack:
        try:
            hub = await stack.enter_async_context(Hub(settings))
            url = hub.url
            click.echo(f"The hub listens at {url}.")
        except HubError as error:
            url = local_url(settings, settings.port)
            if not _is_taken(error) or not await asyncio.to_thread(_is_hub, url):
                if isinstance(error, SettingError):
                    raise HubError(error.named(str)) from None  # by its flags
                raise
            click.echo(f"Using the hub that is running at {url}.")
        if os.environ.get(ENVIRONMENT):
            click.echo(f"The demo does not use {ENVIRONMENT}; --port chooses its hub.", err=True)
        click.echo(f"To see {page.format(page_url(url))} in a browser.")
        click.echo(introduction)
        await run(url)


async def _run_fibonacci(rate: float, url: str) -> None:
    listener = _node("fibonacci_listener", url, f"listener    {LINE}")
    broadcaster = _node("fibonacci_broadcaster", url, f"broadcaster {LINE}")
    try:
        async with listener, asyncio.TaskGroup() as tasks:
            tasks.create_task(listen(listener, TYPE))
            async with broadcaster:
                await broadcast(broadcaster, TYPE, rate, "restart")
    except ExceptionGroup as group:
        raise group.exceptions[0] from None


async def _run_turtlesim(url: str) -> None:
    async with fibws.Node("turtlesim", hub=url, log_format=LINE) as simulator:
        simulation = asyncio.create_task(simulate(simulator), name="turtlesim")
        if not sys.stdin.isatty():
            await simulation
            return
        async with fibws.Node("teleop_turtle", hub=url) as keyboard:
            driving = asyncio.create_task(drive(keyboard), name="turtle_teleop_key")
            ended, _ = await asyncio.wait(
                (simulation, driving), return_when=asyncio.FIRST_COMPLETED
            )
        for task in ended:
            task.result()


async def _run_robot(url: str) -> None:
    async with fibws.Node("robot", hub=url, log_format=LINE) as node:
        await robot_node.simulate(node)


def _node(name: str, url: str, log_format: str) -> fibws.Node:
    return fibws.Node(name, hub=url, anonymous=True, log_format=log_format)


def _is_taken(error: HubError) -> bool:
    return isinstance(error.__cause__, OSError) and error.__cause__.errno == errno.EADDRINUSE


def _is_hub(url: str) -> bool:
    try:
        return is_hub_running(url, "demo")
    except fibws.HubUnreachable:
        return False


@click.command(context_settings=node_program.SETTINGS)
@click.argument(
    "name",
    default="fibonacci",
    type=click.Choice(["fibonacci", "turtlesim", "robot"]),
    required=False,
)
@click.option(
    "--port",
    metavar="PORT",
    type=click.IntRange(0, 65535),
    help="Port of the hub on this machine.  [default: $FIBWS_PORT, or 9090]",
)
@node_program.rate
def command(name: str, port: int | None, rate: float) -> None:
    """Run a hub and nodes that use it.

    fibonacci is the first tutorial: a broadcaster of Fibonacci numbers, and a listener.
    turtlesim is ROS's simulator, whose turtle the arrow keys drive; the page shows it. robot is a
    simulated one with a camera, a laser, a map, diagnostics and an action.

    The hub has the same environment variables as the command hub: $FIBWS_HOST, $FIBWS_CONFIG ...
    """
    settings = environment_settings([] if port is None else ["--port", str(port)])
    if name == "turtlesim":
        page, text = "the turtle, open {}#/turtlesim", TURTLESIM
        node_program.run(demo(settings, page, text, _run_turtlesim))
    elif name == "robot":
        page, text = "its dashboard, open {}#/dashboard", ROBOT
        node_program.run(demo(settings, page, text, _run_robot))
    else:
        page, text = "the graph, open {}", FIBONACCI
        node_program.run(demo(settings, page, text, partial(_run_fibonacci, rate)))


if __name__ == "__main__":
    command(prog_name="python -m fibws.programs.demo")
