"""``fibws topic info``: who publishes a topic and who hears it."""

from __future__ import annotations

import click

from fibws.cli import completers, output
from fibws.cli.common_options import json_option, with_hub
from fibws.client.graph_snapshot import Entry, GraphSnapshot
from fibws.client.hub_client import HubClient


@click.command()
@click.argument("topic", shell_complete=completers.topics)
@json_option
@with_hub()
def command(client: HubClient, topic: str, as_json: bool) -> None:
    """Show the type of TOPIC, who publishes it and who hears it."""
    snapshot = GraphSnapshot(client)
    found = snapshot.topic(client.resolve(topic))
    publishers, subscribers = (
        [
            {"node": node, "address": snapshot.address(node)}
            for node in sorted({each["node"] for each in found[end]})
        ]
        for end in ("publishers", "subscriptions")
    )
    if as_json:
        output.as_json(
            {
                "name": found["name"],
                "type": found["type"],
                "publishers": publishers,
                "subscribers": subscribers,
            }
        )
        return
    output.line(f"Type: {found['type'] or 'unknown type'}\n")
    _print_nodes("Publishers", publishers)
    _print_nodes("Subscribers", subscribers)
    output.line()


def _print_nodes(head: str, nodes: list[Entry]) -> None:
    # Behind the colon rostopic has a space.
    output.line(f"{head}: " if nodes else f"{head}: None")
    for node in nodes:
        output.line(f" * {node['node']} ({node['address']})")
    output.line()
