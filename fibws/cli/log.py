"""``fibws log``: what the nodes log, as it comes."""

from __future__ import annotations

from typing import Any

import click

from fibws.cli import output
from fibws.cli.common_options import json_option, linked
from fibws.cli.complete import nodes
from fibws.client.hub_client import HubClient
from fibws.client.rosapi_schemas import LOG, fault

TOPIC = "/rosout_agg"
QUEUE = 1000
"""Messages that the hub keeps for a terminal that is too slow, as for tools of rosconsole."""

LEVELS = {"debug": 1, "info": 2, "warn": 4, "error": 8, "fatal": 16}
"""rosgraph_msgs/Log's levels."""
COLOURS = {"debug": "green", "info": None, "warn": "yellow", "error": "red", "fatal": "red"}
"""Those of rosconsole."""


@click.command()
@click.option(
    "-l",
    "--level",
    type=click.Choice(list(LEVELS), case_sensitive=False),
    default="debug",
    show_default=True,
    help="The least level to show.",
)
@click.option(
    "--node",
    "wanted",
    metavar="NAME",
    multiple=True,
    shell_complete=nodes,
    help="Show this node alone, or those of this namespace; may be repeated.",
)
@click.option("--grep", "text", metavar="TEXT", help="Show what has this in its text alone.")
@click.option("-n", "count", metavar="COUNT", type=click.IntRange(1), help="End after so many.")
@json_option
@linked("log", endless=True)
def command(
    client: HubClient,
    level: str,
    wanted: tuple[str, ...],
    text: str | None,
    count: int | None,
    as_json: bool,
) -> None:
    """Show what the nodes log (/rosout_agg), from now on, until Ctrl-C.

    With --json, each is a line: the message as it is, a rosgraph_msgs/Log.
    """
    namespaces = [client.resolve_namespace(name).rstrip("/") + "/" for name in wanted]
    client.send({"op": "subscribe", "topic": TOPIC, "queue_length": QUEUE})
    shown = 0
    for message in client.messages(TOPIC):
        if wrong := fault(message, LOG, "message"):
            raise click.ClickException(f"{TOPIC} has what is no rosgraph_msgs/Log: {wrong}")
        if not _is_wanted(message, LEVELS[level], namespaces, text):
            continue
        if as_json:
            output.as_json(message)
        else:
            name = _level(message["level"])
            output.line(log_line(message), colour=COLOURS[name], bold=name == "fatal")
        shown += 1
        if shown == count:
            return


def log_line(message: dict[str, Any]) -> str:
    """A message of the log as rosconsole prints it, with the node that it is from.

    Further lines of its text stand below the first one's beginning, so that none of them looks
    like a message of somebody else's.
    """
    stamp = message["header"]["stamp"]
    head = f"[{_level(message['level']).upper()}] "
    head += f"[{stamp['secs']}.{stamp['nsecs'] // 1000:06}] [{message['name']}]: "
    first, *others = output.visible(message["msg"], keep="\n\t").split("\n")
    return "\n".join([output.visible(head + first, keep="\t"), *(f"    {line}" for line in others)])


def _is_wanted(
    message: dict[str, Any], level: int, namespaces: list[str], text: str | None
) -> bool:
    if message["level"] < level or (text is not None and text not in message["msg"]):
        return False
    name = f"{message['name']}/"
    return not namespaces or any(name.startswith(namespace) for namespace in namespaces)


def _level(number: int) -> str:
    """The name of a level, also of one between those that there are."""
    return next((name for name, least in reversed(LEVELS.items()) if number >= least), "debug")
