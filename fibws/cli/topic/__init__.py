"""``fibws topic``: the counterpart of rostopic."""

from __future__ import annotations

import click

from fibws.cli.lazy import Command, LazyGroup

LISTING = "fibws.cli.topic.listing"
RATES = "fibws.cli.topic.rates"
COMMANDS = {
    "bw": Command(RATES, "Show the bandwidth of a topic.", attribute="bw"),
    "delay": Command(RATES, "Show the delay of a topic, by header stamps.", attribute="delay"),
    "echo": Command("fibws.cli.topic.echo", "Print the messages of a topic."),
    "find": Command(LISTING, "List the topics of a type.", attribute="find"),
    "hz": Command(RATES, "Show the publishing rate of topics.", attribute="hz"),
    "info": Command(LISTING, "Show the publishers and subscribers of a topic.", attribute="info"),
    "list": Command(LISTING, "List the topics.", attribute="list_"),
    "pub": Command("fibws.cli.topic.pub", "Publish messages."),
    "type": Command(LISTING, "Show the type of a topic or of a field.", attribute="type_"),
}


@click.group(cls=LazyGroup, modules=COMMANDS)
def command() -> None:
    """List, show, measure and publish topics, as rostopic does in ROS."""
