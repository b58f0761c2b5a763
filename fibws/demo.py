"""The first tutorial in one process: ``fibws demo``, or ``python -m fibws.demo``."""

from __future__ import annotations

import asyncio
import errno
from contextlib import AsyncExitStack

import click

import fibws
from fibws.broadcaster import broadcast
from fibws.cli import node_program
from fibws.client.hub_client import is_hub_running
from fibws.errors import HubError
from fibws.hub import Hub, Settings
from fibws.hub.__main__ import environment_settings
from fibws.hub.server import local_url
from fibws.hub_address import page_url
from fibws.listener import listen

TYPE = "std_msgs/Int32"
LINE = "[${severity}] [${time}]: ${message}"


async def demo(settings: Settings, rate: float) -> None:
    """Run the tutorial's two nodes, and a hub with these settings unless one is running."""
    async with AsyncExitStack() as stack:
        try:
            hub = await stack.enter_async_context(Hub(settings))
            url = hub.url
            click.echo(f"The hub listens at {url}.")
        except HubError as error:
            if not _is_taken(error):
                raise
            url = local_url(settings, settings.port)
            if not await asyncio.to_thread(_is_hub, url):
                raise HubError(
                    f"port {settings.port} is in use by another program; choose another with --port"
                ) from None
            click.echo(f"Using the hub that is running at {url}.")
        click.echo(f"To see the graph, open {page_url(url)} in a browser.")
        click.echo("Below, a broadcaster publishes numbers to a listener. Press Ctrl-C to stop.")
        await _run_nodes(url, rate)


async def _run_nodes(url: str, rate: float) -> None:
    listener = _node("fibonacci_listener", url, f"listener    {LINE}")
    broadcaster = _node("fibonacci_broadcaster", url, f"broadcaster {LINE}")
    try:
        async with listener, asyncio.TaskGroup() as tasks:
            tasks.create_task(listen(listener, TYPE))
            async with broadcaster:
                await broadcast(broadcaster, TYPE, rate, "restart")
    except ExceptionGroup as group:
        raise group.exceptions[0] from None


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
@click.option(
    "--port",
    metavar="PORT",
    type=click.IntRange(0, 65535),
    help="Port of the hub on this machine.  [default: $FIBWS_PORT, or 9090]",
)
@node_program.rate
def command(port: int | None, rate: float) -> None:
    """Run the first tutorial: a hub, a broadcaster of Fibonacci numbers, and a listener.

    The hub has the same environment variables as the command hub: $FIBWS_HOST, $FIBWS_CONFIG ...
    """
    try:
        settings = environment_settings([] if port is None else ["--port", str(port)])
    except HubError as error:
        raise click.UsageError(str(error)) from None
    node_program.run(demo(settings, rate))


if __name__ == "__main__":
    command(prog_name="python -m fibws.demo")
