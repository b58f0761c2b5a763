"""``fibws topic list``, ``info``, ``type`` and ``find``."""

from __future__ import annotations

import click

from fibws.cli import completers, output
from fibws.cli.common_options import json_option, with_hub
from fibws.cli.type_names import check_short_name
from fibws.client.graph_snapshot import Entry, GraphSnapshot, conflict_text, in_namespace
from fibws.client.hub_client import HubClient
from fibws.suggestions import suggestion


@click.command("list")
@click.argument("namespace", required=False, shell_complete=completers.topics)
@click.option("-v", "--verbose", is_flag=True, help="Show the type of each topic.")
@click.option("-p", "publishers", is_flag=True, help="List published topics only.")
@click.option("-s", "subscribers", is_flag=True, help="List topics with subscribers only.")
@json_option
@with_hub()
def list_(
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
    topics = in_namespace(namespace and client.resolve_namespace(namespace), _topics(client))
    published = [topic for topic in topics if _is_used(topic, "publishers", publishes=True)]
    subscribed = [topic for topic in topics if _is_used(topic, "subscribers", publishes=False)]
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


def _topics(client: HubClient) -> list[Entry]:
    """Return all topics, with the names of their publishers and subscribers."""
    return [
        {
            "name": topic["name"],
            "type": topic["type"],
            "publishers": [each["node"] for each in topic["publishers"]],
            "subscribers": sorted({each["node"] for each in topic["subscriptions"]}),
            "conflicts": topic["conflicts"],
        }
        for topic in GraphSnapshot(client).topics
        if topic["publishers"] or topic["subscriptions"] or topic["conflicts"]
    ]


def _is_used(topic: Entry, end: str, *, publishes: bool) -> bool:
    """Return whether a topic has publishers or subscribers, if only of another type."""
    return bool(topic[end]) or any(each["publishes"] == publishes for each in topic["conflicts"])


def _print_numbers(topics: list[Entry], end: str) -> None:
    for topic in topics:
        number = output.counted(len(topic[f"{end}s"]), end)
        type_ = topic["type"] or "unknown type"
        others = [each for each in topic["conflicts"] if each["publishes"] == (end == "publisher")]
        more = f", {output.counted(len(others), 'conflict')}" if others else ""
        output.line(f" * {topic['name']} [{type_}] {number}{more}")


@click.command()
@click.argument("topic", shell_complete=completers.topics)
@json_option
@with_hub()
def info(client: HubClient, topic: str, as_json: bool) -> None:
    """Show the type, the publishers and the subscribers of TOPIC.

    Conflicts are nodes that use it with another type, and exchange messages only with those that
    use the same one.
    """
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
        ends = {"publishers": publishers, "subscribers": subscribers}
        conflicts = {"conflicts": found["conflicts"]}
        output.as_json({"name": found["name"], "type": found["type"]} | ends | conflicts)
        return
    output.line(f"Type: {found['type'] or 'unknown type'}\n")
    _print_nodes("Publishers", publishers)
    _print_nodes("Subscribers", subscribers)
    if found["conflicts"]:
        output.line("Conflicts: ")
        for each in found["conflicts"]:
            address = snapshot.address(each["node"])
            output.line(f" * {each['node']} ({address}) {conflict_text(each, found)}")
        output.line()
    output.line()


def _print_nodes(head: str, nodes: list[Entry]) -> None:
    output.line(f"{head}: " if nodes else f"{head}: None")  # The space is rostopic's.
    for node in nodes:
        output.line(f" * {node['node']} ({node['address']})")
    output.line()


@click.command("type")
@click.argument("topic", metavar="TOPIC[/FIELD]", shell_complete=completers.topics)
@json_option
@with_hub()
def type_(client: HubClient, topic: str, as_json: bool) -> None:
    """Show the type of TOPIC; with FIELD, the topic's type, the field and the field's type."""
    from fibws.cli.topic.topic_argument import all_types, find_topic, global_name

    name = global_name(client, topic)
    found = find_topic(client, name)
    if found is None:
        known = [topic for topic, type_ in all_types(client).items() if type_]
        raise click.ClickException(f"unknown topic type [{name}]{suggestion(name, known)}")
    if as_json:
        value = {"topic": found.topic, "type": found.type}
        if found.path:
            value |= {"field": str(found.path), "field_type": found.field.written_type}
        output.as_json(value)
    elif found.path:
        output.line(f"{found.type} {found.path} {found.field.written_type}")
    else:
        output.line(found.type)


@click.command()
@click.argument("type_", metavar="TYPE", shell_complete=completers.types)
@json_option
@with_hub()
def find(client: HubClient, type_: str, as_json: bool) -> None:
    """List the topics of TYPE, such as sensor_msgs/Imu, or Imu in any package."""
    if "/" in type_:
        found = client.call("/rosapi/topics_for_type", {"type": type_})["topics"]
    else:
        found = [each["name"] for each in _topics(client) if each["type"].endswith(f"/{type_}")]
        if not found:
            check_short_name(type_)
    output.names(found, json_=as_json)
