"""``fibws topic``: the counterpart of rostopic."""

from __future__ import annotations

import click

from fibws.cli.lazy import Command, LazyGroup

COMMANDS = {
    "bw": Command("fibws.cli.topic.bw", "Show the bandwidth of a topic."),
    "delay": Command(
        "fibws.cli.topic.delay", "Show the delay of a topic, by the stamps in its headers."
    ),
    "echo": Command("fibws.cli.topic.echo", "Print the messages of a topic."),
    "find": Command("fibws.cli.topic.find", "List the topics of a type."),
    "hz": Command("fibws.cli.topic.hz", "Show the publishing rate of topics."),
    "info": Command("fibws.cli.topic.info", "Show the publishers and subscribers of a topic."),
    "list": Command("fibws.cli.topic.list", "List the topics."),
    "pub": Command("fibws.cli.topic.pub", "Publish messages."),
    "type": Command("fibws.cli.topic.type_", "Show the type of a topic or of a field."),
}


@click.group(cls=LazyGroup, modules=COMMANDS)
def command() -> None:
    """List, show, measure and publish topics, as rostopic does in ROS."""
