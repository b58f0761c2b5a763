"""``fibws client``: the hub's clients, with their rates and drops."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import count

import click

from fibws.cli import completers, output
from fibws.cli.common_options import delay_option, json_option, with_hub
from fibws.cli.quantities import amount, date, flow
from fibws.client import statistics
from fibws.client.graph_snapshot import Entry, GraphSnapshot
from fibws.client.hub_client import HubClient
from fibws.command_names import command_name
from fibws.errors import UnknownName
from fibws.suggestions import suggestion

STATISTICS = "/rosapi/statistics"
REGISTRATIONS = ("subscription", "advertisement")
HEADS = ("NODE", "PRINCIPAL", "ADDRESS", "PROTOCOL", "SINCE", "IN", "OUT", "DROPPED", "LIMITED")


@click.group()
def command() -> None:
    """List the clients of the hub, with their rates.

    A client is a connection to the hub, of a node or a web page. Rates and totals are counted by
    the hub: IN is what it receives from the client.
    """


@command.command("list")
@delay_option
@click.option("--watch", is_flag=True, help="Repeat until Ctrl-C.")
@json_option
@with_hub("client", endless=True)
def list_(client: HubClient, delay: float, watch: bool, as_json: bool) -> None:
    """List all clients with their rates.

    DROPPED are messages for a client that was too slow, LIMITED messages of a client that sent more
    than its limits allow. Addresses and principals of others are visible to admins only.
    """
    before = client.call(STATISTICS)
    for _ in count() if watch else range(1):
        client.process(delay)
        now = client.call(STATISTICS)
        found = [each for each in statistics.clients(before, now) if each["node"] != client.node]
        before = now
        if as_json:
            for each in found:
                output.as_json(each)
            continue
        if watch and output.has_control_sequences():
            click.clear()
        output.table(HEADS, map(_cells, found))
        if watch and not output.has_control_sequences():
            output.line()


@command.command()
@click.argument("node", shell_complete=completers.nodes)
@delay_option
@json_option
@with_hub("client")
def info(client: HubClient, node: str, delay: float, as_json: bool) -> None:
    """Show all about the client that is NODE: its rates, totals and topics."""
    name = client.resolve(node)
    before = client.call(STATISTICS)
    _find(before, name)  # A wrong name gets its error at once.
    client.process(delay)
    now = client.call(STATISTICS)
    details = _find({"clients": statistics.clients(before, now)}, name) | statistics.topics_of(
        before, now, name
    )
    snapshot = GraphSnapshot(client)
    details["services"] = [each["name"] for each in snapshot.services if each["node"] == name]
    details["actions"] = [each["name"] for each in snapshot.actions if each["node"] == name]
    if as_json:
        output.as_json(details)
    else:
        for line in _description(details):
            output.line(line)


def _find(response: Entry, node: str) -> Entry:
    found: dict[str, Entry] = {each["node"]: each for each in response["clients"]}
    if node not in found:
        hint = suggestion(node, found) or f"; {command_name('client list')} prints all"
        raise UnknownName(f"Unknown client {node}{hint}")
    return found[node]


# Texts


def _cells(client: Entry) -> tuple[str, ...]:
    return (
        client["node"],
        client["principal"] or "-",
        client["address"] or "-",
        client["protocol"],
        date(client["since"]),
        flow(client, "received"),
        flow(client, "sent"),
        str(client["dropped"]),
        str(client["limited"]),
    )


def _description(client: Entry) -> Iterator[str]:
    yield f"Node: {client['node']}"
    yield f"Principal: {client['principal'] or '-'}"
    yield f"Address: {client['address'] or '-'}"
    yield f"Protocol: {client['protocol']}"
    yield f"Since: {date(client['since'])}"
    for text, direction in (("Received from it", "received"), ("Sent to it", "sent")):
        messages, size = client[f"messages_{direction}"], client[f"bytes_{direction}"]
        yield f"{text}: {messages} messages, {amount(size)} ({flow(client, direction)})"
    state = ", slow: its socket accepts no data now" if client["slow"] else ""
    yield f"Queue: {amount(client['kept_bytes'])}{state}"
    yield f"Dropped, as it was too slow: {client['dropped']} messages"
    yield f"Dropped, as it sent more than its limits: {client['limited']} messages"
    registered = [output.counted(client[f"{each}s"], each) for each in REGISTRATIONS]
    yield f"Registered: {', '.join(registered)}"
    yield ""
    yield from _section("Publishes", map(_publication, client["published"]))
    yield from _section("Subscribes to", map(_subscription, client["subscribed"]))
    yield from _section("Services", client["services"])
    yield from _section("Actions", client["actions"])


def _section(head: str, items: Iterator[str] | list[str]) -> Iterator[str]:
    found = [f" * {item}" for item in items]
    if found:
        yield f"{head}:"
        yield from found


def _publication(topic: Entry) -> str:
    rates = f"{topic['messages_per_second']:.1f}/s, {amount(topic['bytes_per_second'])}/s"
    return f"{topic['topic']}: {output.counted(topic['messages'], 'message')} ({rates})"


def _subscription(topic: Entry) -> str:
    losses = [f"{topic[name]} {name}" for name in ("dropped", "throttled") if topic[name]]
    rate = f"{topic['messages_per_second']:.1f}/s"
    text = f"{topic['topic']}: {output.counted(topic['messages'], 'message')} ({rate})"
    return ", ".join([text, *losses])
