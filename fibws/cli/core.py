"""``fibws core``: a hub as a replacement for roscore."""

from __future__ import annotations

import os
import sys
from urllib.parse import urlsplit

import click

from fibws import hub_address
from fibws.cli.exit_handling import clean_exit
from fibws.command_names import command_name
from fibws.errors import FibwsError
from fibws.processes import exec_command
from fibws.ros1.master_port import master_options

_IGNORED = "Ignored; accepted for compatibility with roscore."


@click.command()
@click.option(
    "-p",
    "--port",
    metavar="PORT",
    type=click.IntRange(0, 65535),
    envvar="FIBWS_PORT",
    help="Port to listen on; 0 chooses a free one.  [default: that of $FIBWS_HUB, else 9090]",
)
@click.option(
    "--ros1/--no-ros1",
    default=True,
    help="Be the master of ROS 1 nodes, too, at the port of $ROS_MASTER_URI, else 11311. "
    "[default: ros1]",
)
@click.option("-v", "--verbose", is_flag=True, help=_IGNORED)
@click.option("-w", "--workers", "--numworkers", metavar="N", help=_IGNORED)
@click.option("-t", "--timeout", metavar="SECONDS", help=_IGNORED)
def command(
    port: int | None, ros1: bool, verbose: bool, workers: str | None, timeout: str | None
) -> None:
    """Run a hub, as roscore runs a master: one for all nodes; a second one does not start.

    Start it first and leave it running. Nodes look for it at $FIBWS_HUB, or else at
    ws://127.0.0.1:9090. Nodes of an installed ROS 1 find it at $ROS_MASTER_URI, as they would find
    roscore. `fibws hub` has more settings.
    """
    with clean_exit():
        if port is None:
            _warn_if_nodes_look_elsewhere()
            port = _port_of_nodes() or hub_address.DEFAULT_PORT
        url = f"ws://{hub_address.LOOPBACK[0]}:{port}"
        if port and _is_hub_running(url):
            raise click.ClickException(
                f"{command_name('core')} cannot run as another roscore/master is already running: "
                f"the hub at {url}. One hub is enough for all nodes. To stop it, press Ctrl-C "
                "where it was started."
            )
        if port and port != _port_of_nodes():
            click.echo(f"In the other terminals, type: export {hub_address.ENVIRONMENT}={url}")
        words = [sys.executable, "-P", "-m", "fibws.hub", "--port", str(port)]
        if ros1 and "FIBWS_ROS1" not in os.environ:
            words += master_options(lambda text: click.echo(text, err=True))
        exec_command(words)


def _port_of_nodes() -> int | None:
    """Return the port at which nodes look for the hub; None if that is a proxy's, with TLS."""
    url = urlsplit(hub_address.hub_url())
    return (url.port or 80) if url.scheme == "ws" else None


def _warn_if_nodes_look_elsewhere() -> None:
    host = urlsplit(hub_address.hub_url()).hostname
    if host not in hub_address.LOOPBACK:
        text = f"WARNING: {hub_address.ENVIRONMENT} sends nodes to the hub at {host}"
        click.echo(f"{text}, but this hub is only for this machine", err=True)


def _is_hub_running(url: str) -> bool:
    from fibws.client.hub_client import is_hub_running

    try:
        return is_hub_running(url, "core")
    except FibwsError:
        return False  # The hub itself reports why it cannot listen.
