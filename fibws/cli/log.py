"""``fibws log``: print the log messages of all nodes."""

from __future__ import annotations

from typing import Any

import click

from fibws.cli import completers, output
from fibws.cli.common_options import json_option, with_hub
from fibws.client.hub_client import HubClient
from fibws.client.rosapi_schemas import LOG, schema_error

TOPIC = "/rosout_agg"
QUEUE = 1000
"""Messages that the hub keeps for a slow terminal, as rosconsole's tools do."""

LEVELS = {"debug": 1, "info": 2, "warn": 4, "error": 8, "fatal": 16}
"""The levels of rosgraph_msgs/Log."""
COLOURS = {"debug": "green", "info": None, "warn": "yellow", "error": "red", "fatal": "red"}
"""The colours of rosconsole."""


@click.command()
@click.option(
    "-l",
    "--level",
    type=click.Choice(list(LEVELS), case_sensitive=False),
    default="debug",
    show_default=True,
    help="Show only messages of at least this level.",
)
@click.option(
    "--node",
    "wanted",
    metavar="NAME",
    multiple=True,
    shell_complete=completers.nodes,
    help="Show only messages of this node or namespace; may be repeated.",
)
@click.option("--grep", "text", metavar="TEXT", help="Show only messages containing TEXT.")
@click.option(
    "-n", "count", metavar="COUNT", type=click.IntRange(1), help="Stop after COUNT messages."
)
@json_option
@with_hub("log", endless=True)
def command(
    client: HubClient,
    level: str,
    wanted: tuple[str, ...],
    text: str | None,
    count: int | None,
    as_json: bool,
) -> None:
    """Print the log messages of all nodes (/rosout_agg) as they arrive, until Ctrl-C.

    With --json, each message is printed as one line of JSON, a rosgraph_msgs/Log.
    """
    namespaces = [client.resolve_namespace(name).rstrip("/") + "/" for name in wanted]
    client.send({"op": "subscribe", "topic": TOPIC, "queue_length": QUEUE})
    shown = 0
    for message in client.messages(TOPIC):
        if error := schema_error(message, LOG, "message"):
            raise click.ClickException(
                f"received a message on {TOPIC} that is not a rosgraph_msgs/Log: {error}"
            )
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
    """Return a message in rosconsole's format, with the node's name.

    Further lines of its text are indented, so that none looks like another message.
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
    """Return the name of a level; of the next lower one for numbers between levels."""
    return next((name for name, least in reversed(LEVELS.items()) if number >= least), "debug")
