"""``fibws client``: the hub's clients, with their rates and drops."""

from __future__ import annotations

import time
from collections.abc import Iterator
from itertools import count

import click

from fibws.cli import completers, output
from fibws.cli.common_options import json_option, with_hub
from fibws.cli.top.tables import amount
from fibws.client.graph_snapshot import Entry, GraphSnapshot
from fibws.client.hub_client import HubClient
from fibws.command_names import command_name
from fibws.errors import UnknownName
from fibws.suggestions import suggestion

STATISTICS = "/rosapi/statistics"
RATES = {
    "messages_received": "messages_received_per_second",
    "bytes_received": "bytes_received_per_second",
    "messages_sent": "messages_sent_per_second",
    "bytes_sent": "bytes_sent_per_second",
}
"""The totals of clients that have rates, with the names of these."""
REGISTRATIONS = ("subscription", "advertisement")
HEADS = ("NODE", "PRINCIPAL", "ADDRESS", "PROTOCOL", "SINCE", "IN", "OUT", "DROPPED", "LIMITED")

delay_option = click.option(
    "-d",
    "delay",
    metavar="SECONDS",
    type=click.FloatRange(0.1, 3600),
    default=1.0,
    show_default=True,
    help="Time in which rates are measured.",
)


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
        found = [each for each in measured(before, now) if each["node"] != client.node]
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
    details = _find({"clients": measured(before, now)}, name) | _topics(before, now, name)
    snapshot = GraphSnapshot(client)
    details["services"] = [each["name"] for each in snapshot.services if each["node"] == name]
    details["actions"] = [each["name"] for each in snapshot.actions if each["node"] == name]
    if as_json:
        output.as_json(details)
    else:
        for line in _description(details):
            output.line(line)


def measured(before: Entry, now: Entry) -> list[Entry]:
    """Return the clients of a response of /rosapi/statistics with their rates, sorted by node.

    Args:
        before: an older response.
        now: the newer one.
    """
    seconds = seconds_of(now) - seconds_of(before)
    older = {each["node"]: each for each in before["clients"]}
    return [
        {**each, **_rates(older.get(each["node"]), each, seconds)}
        for each in sorted(now["clients"], key=lambda each: str(each["node"]))
    ]


def _rates(before: Entry | None, now: Entry, seconds: float) -> dict[str, float]:
    is_same = before is not None and before["since"] == now["since"]
    return {
        rate: per_second(
            before[total] if before is not None and is_same else 0, now[total], seconds
        )
        for total, rate in RATES.items()
    }


def per_second(before: int, now: int, seconds: float) -> float:
    """Return the growth of a total in a second."""
    return round(max(0, now - before) / seconds, 3) if seconds > 0 else 0.0


def seconds_of(response: Entry) -> float:
    """Return the time of a response, in seconds since 1970."""
    stamp = response["stamp"]
    return float(stamp["secs"] + stamp["nsecs"] / 1e9)


def _find(response: Entry, node: str) -> Entry:
    found: dict[str, Entry] = {each["node"]: each for each in response["clients"]}
    if node not in found:
        hint = suggestion(node, found) or f"; {command_name('client list')} prints all"
        raise UnknownName(f"Unknown client {node}{hint}")
    return found[node]


def _topics(before: Entry, now: Entry, node: str) -> Entry:
    """Return what a client publishes and subscribes to, with rates."""
    seconds = seconds_of(now) - seconds_of(before)
    older = {each["topic"]: each for each in before["topics"]}
    publications, subscriptions = [], []
    for topic in now["topics"]:
        name = topic["topic"]
        was = older.get(name, {"publishers": [], "subscriptions": []})
        for each in topic["publishers"]:
            if each["node"] == node:
                past = _totals(was["publishers"], node, "messages", "bytes")
                publications.append(
                    {
                        "topic": name,
                        "messages": each["messages"],
                        "bytes": each["bytes"],
                        "messages_per_second": per_second(
                            past["messages"], each["messages"], seconds
                        ),
                        "bytes_per_second": per_second(past["bytes"], each["bytes"], seconds),
                    }
                )
        mine = _totals(topic["subscriptions"], node, "messages", "dropped", "throttled")
        if any(each["node"] == node for each in topic["subscriptions"]):
            past = _totals(was["subscriptions"], node, "messages")
            rate = per_second(past["messages"], mine["messages"], seconds)
            subscriptions.append({"topic": name, **mine, "messages_per_second": rate})
    return {"published": publications, "subscribed": subscriptions}


def _totals(entries: list[Entry], node: str, *names: str) -> dict[str, int]:
    """Return the sums of a node's entries."""
    own = [each for each in entries if each["node"] == node]
    return {name: sum(each[name] for each in own) for name in names}


# Texts


def _cells(client: Entry) -> tuple[str, ...]:
    return (
        client["node"],
        client["principal"] or "-",
        client["address"] or "-",
        client["protocol"],
        date(client["since"]),
        _flow(client, "received"),
        _flow(client, "sent"),
        str(client["dropped"]),
        str(client["limited"]),
    )


def _flow(client: Entry, direction: str) -> str:
    messages = client[f"messages_{direction}_per_second"]
    return f"{messages:.1f}/s {amount(client[f'bytes_{direction}_per_second'])}/s"


def date(since: Entry) -> str:
    """Return a time of ROS as text, in local time."""
    return time.strftime("%Y-%m-%d %H:%M:%S", time.localtime(since["secs"]))


def _description(client: Entry) -> Iterator[str]:
    yield f"Node: {client['node']}"
    yield f"Principal: {client['principal'] or '-'}"
    yield f"Address: {client['address'] or '-'}"
    yield f"Protocol: {client['protocol']}"
    yield f"Since: {date(client['since'])}"
    for text, direction in (("Received from it", "received"), ("Sent to it", "sent")):
        messages, size = client[f"messages_{direction}"], client[f"bytes_{direction}"]
        yield f"{text}: {messages} messages, {amount(size)} ({_flow(client, direction)})"
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
