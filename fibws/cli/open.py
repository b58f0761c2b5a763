"""``fibws open``: open the hub's page in a browser, as rqt opens a window."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator, Sequence
from urllib.parse import quote

import click

from fibws.cli import completers, output
from fibws.cli.common_options import examples, with_hub
from fibws.client.hub_client import HubClient
from fibws.errors import InvalidName
from fibws.hub_address import page_url
from fibws.suggestions import suggestion
from fibws.values.field_paths import splits

PARTS = {
    "graph": ("{open graph}", "nodes and topics, live"),
    "topics": ("{open topics} /fibonacci", "echo, plot, publish"),
    "plot": ("{open plot} /fibonacci/data", "numbers over time"),
    "services": ("{open services} /add_two_ints", "call"),
    "actions": ("{open actions} /fibonacci", "send goals"),
    "console": ("{open console}", "what nodes log"),
    "parameters": ("{open parameters}", "get and set"),
    "reconfigure": ("{open reconfigure} /camera", "change parameters of running nodes"),
    "turtlesim": ("{open turtlesim}", "turtles, driven by the arrow keys"),
}
"""The parts of the page, each with an example for the help."""
WITH_NAMES = {"topics", "plot", "services", "actions", "reconfigure"}
DISPLAYS = ("DISPLAY", "WAYLAND_DISPLAY", "BROWSER")
"""Without any of these variables, Linux would open a browser inside the terminal."""


@click.command(context_settings={"ignore_unknown_options": True})
@click.argument("words", metavar="[PART] [NAME]...", nargs=-1, shell_complete=completers.topics)
@with_hub("open")
@examples(("{open}", "the page, at its graph"), *PARTS.values())
def command(client: HubClient, words: tuple[str, ...]) -> None:
    """Open the hub's page in a browser and print its address.

    The options of rqt are ignored.
    """
    # Launch files pass remappings to it, as to a node.
    words = tuple(word for word in words if not word.startswith("-") and ":=" not in word)
    part, *names = words or ("graph",)
    part = part.removeprefix("rqt_")
    if part == "gui":
        part = "graph"
    if part.startswith("/"):
        part, names = "topics", [part, *names]
    if part not in PARTS:
        hint = suggestion(part, PARTS) or "."
        raise click.UsageError(f"Unknown part {part!r}{hint} Parts are {', '.join(PARTS)}.")
    if names and part not in WITH_NAMES:
        raise click.UsageError(f"{part} takes no names, got {names[0]!r}.")
    for address in addresses(client, part, names):
        output.line(address)
        _open(address)


def addresses(client: HubClient, part: str, names: Sequence[str]) -> Iterator[str]:
    """Yield the addresses of a part of the page, one for each name."""
    base = page_url(client.url)
    tab, *more = ("topics", "plot") if part == "plot" else (part,)
    found = list(dict.fromkeys(_names(client, part, names)))
    if not found:
        yield f"{base}#/{tab}"
    for name in found:
        yield f"{base}#/{'/'.join([tab, quote(name, safe=''), *more])}"


def _names(client: HubClient, part: str, names: Sequence[str]) -> Iterator[str]:
    topics = client.call("/rosapi/topics")["topics"] if part == "plot" and names else []
    for name in names:
        try:
            # rqt_plot also accepts /turtle1/pose/x:y and elements of arrays.
            wanted = client.resolve(name.partition(":")[0].partition("[")[0].rstrip("/"))
        except InvalidName as error:
            raise click.UsageError(str(error)) from None
        topic = next((topic for topic, _ in splits(wanted, topics)), wanted)
        if part == "plot" and topic not in topics:
            click.echo(f"WARNING: topic [{topic}] does not appear to be published yet", err=True)
        yield topic


def _open(address: str) -> None:
    if os.environ.get("SSH_CONNECTION") and "BROWSER" not in os.environ:
        return  # The browser would open on the remote machine.
    if sys.platform not in ("win32", "darwin") and not any(map(os.environ.get, DISPLAYS)):
        return
    import webbrowser  # 20 ms

    webbrowser.open(address)
