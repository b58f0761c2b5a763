"""``fibws topic list``: which topics there are."""

from __future__ import annotations

import click

from fibws.cli import completers, output
from fibws.cli.common_options import json_option, with_hub
from fibws.client.graph_snapshot import Entry, GraphSnapshot, in_namespace
from fibws.client.hub_client import HubClient


@click.command()
@click.argument("namespace", required=False, shell_complete=completers.topics)
@click.option("-v", "--verbose", is_flag=True, help="Say of each topic what type it has.")
@click.option("-p", "publishers", is_flag=True, help="Only what is published.")
@click.option("-s", "subscribers", is_flag=True, help="Only what is subscribed to.")
@json_option
@with_hub()
def command(
    client: HubClient,
    namespace: str | None,
    verbose: bool,
    publishers: bool,
    subscribers: bool,
    as_json: bool,
) -> None:
    """List the topics, or those in NAMESPACE."""
    if publishers and subscribers:
        raise click.UsageError("you may only specify one of -p, -s")
    topics = in_namespace(namespace and client.resolve_namespace(namespace), _all(client))
    published = [topic for topic in topics if topic["publishers"]]
    subscribed = [topic for topic in topics if topic["subscribers"]]
    chosen = published if publishers else subscribed if subscribers else topics
    if as_json:
        for topic in chosen:
            output.as_json(topic)
    elif verbose:
        if not subscribers:
            output.line("\nPublished topics:")
            _print_numbers(published, "publisher")
        if not publishers:
            output.line("\nSubscribed topics:")
            _print_numbers(subscribed, "subscriber")
        output.line()
    else:
        output.names(topic["name"] for topic in chosen)


def _all(client: HubClient) -> list[Entry]:
    """All topics, with the names of the nodes at both ends."""
    return [
        {
            "name": topic["name"],
            "type": topic["type"],
            "publishers": [each["node"] for each in topic["publishers"]],
            "subscribers": sorted({each["node"] for each in topic["subscriptions"]}),
        }
        for topic in GraphSnapshot(client).topics
        if topic["publishers"] or topic["subscriptions"]
    ]


def _print_numbers(topics: list[Entry], end: str) -> None:
    for topic in topics:
        number = output.counted(len(topic[f"{end}s"]), end)
        type_ = topic["type"] or "unknown type"
        output.line(f" * {topic['name']} [{type_}] {number}")
