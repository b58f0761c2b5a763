"""``fibws core``: a hub, run as roscore is."""

from __future__ import annotations

import sys
from urllib.parse import SplitResult, urlsplit

import click

from fibws.cli.exit_handling import ending
from fibws.command_names import command_name
from fibws.errors import FibwsError
from fibws.node import address
from fibws.processes import become


@click.command()
@click.option(
    "-p",
    "--port",
    metavar="PORT",
    type=click.IntRange(0, 65535),
    envvar="FIBWS_PORT",
    help="Port to listen on.  [default: that of $FIBWS_HUB, else 9090]",
)
@click.option("-v", "--verbose", is_flag=True, help="Changes nothing; roscore has it.")
@click.option("-w", "--workers", "--numworkers", metavar="N", help="Changes nothing, either.")
@click.option("-t", "--timeout", metavar="SECONDS", help="Nor does this.")
def command(port: int | None, verbose: bool, workers: str | None, timeout: str | None) -> None:
    """Run a hub as roscore does: one is enough for all nodes, and a second one does not start.

    Start it first and let it run. Nodes find it at $FIBWS_HUB, or at ws://127.0.0.1:9090. `fibws
    hub` has all its settings.
    """
    with ending():
        if port is None:
            _warn_of_another_machine()
            port = _told_port() or address.DEFAULT_PORT
        url = f"ws://{address.LOOPBACK[0]}:{port}"
        if port and _is_there(url):
            raise click.ClickException(
                f"{command_name('core')} cannot run as another roscore/master is already running: "
                f"the hub at {url}. One is enough for all nodes. To end it, press Ctrl-C where it "
                "was started."
            )
        if port and port != _told_port():
            click.echo(f"Tell the other terminals: export {address.ENVIRONMENT}={url}")
        become([sys.executable, "-P", "-m", "fibws.hub", "--port", str(port)])


def _told() -> SplitResult:
    """Where nodes look for the hub."""
    return urlsplit(address.hub_url())


def _told_port() -> int | None:
    """The port there, if a hub can listen there: it speaks no TLS, which is a proxy's."""
    told = _told()
    return (told.port or 80) if told.scheme == "ws" else None


def _warn_of_another_machine() -> None:
    told = _told()
    if told.hostname not in address.LOOPBACK:
        text = f"WARNING: {address.ENVIRONMENT} has nodes look for the hub at {told.hostname}"
        click.echo(f"{text}, and this one is for this machine alone", err=True)


def _is_there(url: str) -> bool:
    from fibws.client.hub_client import HubClient

    try:
        HubClient("core", url).close()
    except FibwsError:
        return False
    return True
