"""``fibws node``: which nodes there are, what each has to do with the others; ping and kill."""

from __future__ import annotations

import time
from collections.abc import Iterable, Iterator
from urllib.parse import urlsplit

import click

from fibws.cli import complete, output
from fibws.cli.common_options import json_option, linked
from fibws.cli.exit_handling import end_line
from fibws.client.graph_snapshot import Entry, Snapshot, within
from fibws.client.hub_client import HubClient
from fibws.errors import UnknownName

PATIENCE = 3.0
"""Seconds in which a node must answer a ping: the hub waits for no longer."""

PING_INTERVAL = 1.0
"""Seconds between two pings."""


@click.group()
def command() -> None:
    """Look at nodes, ping them, kill them."""


@command.command("list")
@click.argument("namespace", required=False, shell_complete=complete.nodes)
@click.option("-u", "addresses", is_flag=True, help="List addresses, IP:PORT, not names.")
@click.option("-a", "--all", "everything", is_flag=True, help="List addresses and names.")
@json_option
@linked("node")
def list_(
    client: HubClient, namespace: str | None, addresses: bool, everything: bool, as_json: bool
) -> None:
    """List all nodes, or those in NAMESPACE.

    Those that are part of the hub have the hub's address.
    """
    snapshot = Snapshot(client)
    for node in within(namespace and client.resolve_namespace(namespace), snapshot.nodes):
        name, address = node["name"], snapshot.address(node["name"])
        if as_json:
            output.as_json({**node, "address": address})
        elif everything:
            output.line(f"{address} \t{name}")
        else:
            output.line(address if addresses else name)


@command.command()
@click.argument("nodes", nargs=-1, required=True, metavar="NODE...", shell_complete=complete.nodes)
@click.option("-q", "--quiet", is_flag=True, help="Leave out the address and the connections.")
@json_option
@linked("node")
def info(client: HubClient, nodes: tuple[str, ...], quiet: bool, as_json: bool) -> None:
    """Show what each NODE publishes, hears and provides.

    Also where it is, since when, and with whom it is connected.
    """
    snapshot = Snapshot(client)
    for node in [snapshot.node(client.resolve(name)) for name in nodes]:
        if as_json:
            output.as_json(_all_of(snapshot, node))
        else:
            for line in _description(snapshot, node, quiet=quiet):
                output.line(line)


@command.command()
@click.argument("node", required=False, shell_complete=complete.nodes)
@click.option("-a", "--all", "everyone", is_flag=True, help="Ping all nodes, once.")
@click.option("-c", "count", type=click.IntRange(1), metavar="COUNT", help="Pings to send.")
@linked("node")
def ping(client: HubClient, node: str | None, everyone: bool, count: int | None) -> None:
    """Show how long NODE takes to answer a ping.

    It is pinged once a second until Ctrl-C. The time is that from the hub to the node and back.
    """
    if everyone:
        if node or count:
            raise click.UsageError("--all goes with neither a node nor -c: it pings each one once.")
        _ping_all(client)
        return
    if not node:
        raise click.UsageError("Name the node to ping, or give --all. fibws node list has them.")
    name = client.resolve(node)
    snapshot = Snapshot(client)
    snapshot.node(name)
    output.line(f"pinging {name} with a timeout of {PATIENCE}s")
    took: list[float] = []
    try:
        while True:
            took.append(_ping(client, name, snapshot.address(name)))
            if len(took) == count:
                break
            client.process(PING_INTERVAL)
    except KeyboardInterrupt:
        end_line()  # That is how it ends.
    if len(took) > 1:
        output.line(f"ping average: {sum(took) / len(took):.2f}ms")


@command.command()
@click.argument("machine", required=False)
@linked("node")
def machine(client: HubClient, machine: str | None) -> None:
    """List the machines that nodes are on by their IPs, or the nodes on MACHINE."""
    snapshot = Snapshot(client)
    names = [node["name"] for node in snapshot.nodes]
    hosts = {name: urlsplit(f"//{snapshot.address(name)}").hostname or "" for name in names}
    if machine is None:
        output.names(set(hosts.values()))
    elif machine in hosts.values():
        output.names(name for name, host in hosts.items() if host == machine)
    else:
        there = ", ".join(sorted(set(hosts.values())))
        raise click.ClickException(f"No node is on {machine}; all nodes are on {there}")


@command.command()
def cleanup() -> None:
    """Do nothing: a hub forgets nodes by itself as soon as they are unreachable."""
    output.line("There is nothing to clean up: a hub forgets a node that cannot be reached.")


@command.command()
@click.argument("nodes", nargs=-1, metavar="[NODE]...", shell_complete=complete.nodes)
@click.option("-a", "--all", "everyone", is_flag=True, help="Kill all nodes.")
@linked("node")
def kill(client: HubClient, nodes: tuple[str, ...], everyone: bool) -> None:
    """End each NODE; without one, ask which.

    The hub closes a node's connection with a reason, which nodes of fibws heed. Others, such as web
    pages, may connect again.
    """
    if everyone and nodes:
        raise click.UsageError("--all goes with no nodes.")
    snapshot = Snapshot(client)
    if nodes:
        names = [snapshot.node(client.resolve(name))["name"] for name in nodes]
    else:
        names = [node["name"] for node in snapshot.nodes if not node["own"]]
        if not names:
            click.echo("No nodes running", err=True)
            return
        if not everyone:
            names = [_chosen(names)]
    if len(names) > 1:
        output.line("\n".join(["killing:", *(f" * {name}" for name in names)]))
    else:
        output.line(f"killing {names[0]}")
    answers = [client.call("/rosapi/kill_node", {"node": name}) for name in names]
    failures = [str(answer["message"]) for answer in answers if not answer["success"]]
    if failures:
        raise click.ClickException(f"Failed to kill: {output.visible('; '.join(failures))}")
    output.line("killed")


# What a node has to do with others


def _all_of(snapshot: Snapshot, node: Entry) -> Entry:
    name = node["name"]
    return {
        **node,
        "address": snapshot.address(name),
        "publications": {topic["name"]: topic["type"] for topic in _published(snapshot, name)},
        "subscriptions": {topic["name"]: topic["type"] for topic in _heard(snapshot, name)},
        "services": {
            each["name"]: each["type"] for each in snapshot.services if each["node"] == name
        },
        "actions": {
            each["name"]: each["type"] for each in snapshot.actions if each["node"] == name
        },
    }


def _description(snapshot: Snapshot, node: Entry, *, quiet: bool) -> Iterator[str]:
    name = node["name"]
    yield "-" * 80
    yield f"Node [{name}]"
    yield from _section("Publications", map(_typed, _published(snapshot, name)))
    yield from _section("Subscriptions", map(_typed, _heard(snapshot, name)))
    provided = [each["name"] for each in snapshot.services if each["node"] == name]
    yield from _section("Services", provided)
    actions = [_typed(each) for each in snapshot.actions if each["node"] == name]
    if actions:
        yield from _section("Actions", actions)
    if quiet:
        return
    since = time.localtime(node["since"]["secs"])
    yield f"Address: {snapshot.address(name)}"
    yield f"Since: {time.strftime('%Y-%m-%d %H:%M:%S', since)}"
    connections = list(_connections(snapshot, name))
    if connections:
        yield "Connections:"
        yield from connections
    yield ""


def _section(head: str, items: Iterable[str]) -> Iterator[str]:
    found = [f" * {item}" for item in items]
    if found:
        yield f"{head}: "  # The blank is rosnode's.
        yield from found
    else:
        yield f"{head}: None"
    yield ""


def _connections(snapshot: Snapshot, name: str) -> Iterator[str]:
    for topic in _published(snapshot, name):
        for each in topic["subscriptions"]:
            yield from _connection(snapshot, topic, each["node"], "outbound", each["compression"])
    for topic in _heard(snapshot, name):
        ways = {each["compression"] for each in topic["subscriptions"] if each["node"] == name}
        for each in topic["publishers"]:
            way = ", ".join(sorted(ways))
            yield from _connection(snapshot, topic, each["node"], "inbound", way)


def _connection(
    snapshot: Snapshot, topic: Entry, other: str, direction: str, way: str
) -> Iterator[str]:
    yield f" * topic: {topic['name']}"
    yield f"    * to: {other} ({snapshot.address(other)})"
    yield f"    * direction: {direction}"
    yield f"    * transport: WebSocket{'' if way == 'none' else f' ({way})'}"


def _published(snapshot: Snapshot, node: str) -> list[Entry]:
    return [
        topic
        for topic in snapshot.topics
        if any(each["node"] == node for each in topic["publishers"])
    ]


def _heard(snapshot: Snapshot, node: str) -> list[Entry]:
    return [
        topic
        for topic in snapshot.topics
        if any(each["node"] == node for each in topic["subscriptions"])
    ]


def _typed(entry: Entry) -> str:
    return f"{entry['name']} [{entry['type'] or 'unknown type'}]"


# Pings


def _ping_all(client: HubClient) -> None:
    snapshot = Snapshot(client)
    names = [node["name"] for node in snapshot.nodes]
    output.line("\n".join(["Will ping the following nodes: ", *(f" * {name}" for name in names)]))
    output.line()
    failures = []
    for name in names:
        try:
            _ping(client, name, snapshot.address(name))
        except (click.ClickException, UnknownName) as error:
            click.echo(f"Error: {error}", err=True)
            failures.append(name)
    if failures:
        raise click.ClickException(f"{len(failures)} of {len(names)} nodes did not answer")


def _ping(client: HubClient, name: str, address: str) -> float:
    """Ping a node, print what comes of it and return the milliseconds that it took."""
    answer = client.call("/rosapi/ping_node", {"node": name})
    if not answer["success"]:
        raise click.ClickException(output.visible(str(answer["message"])))
    milliseconds = 1000 * float(answer["seconds"])
    output.line(f"reply from {name} at {address}: time={milliseconds:.2f}ms")
    return milliseconds


def _chosen(names: list[str]) -> str:
    """The node that the user chooses."""
    output.line("\n".join(f"{number}. {name}" for number, name in enumerate(names, 1)))
    text = "\nPlease enter the number of the node you wish to kill.\n>"
    try:
        number: int = click.prompt(text, type=click.IntRange(1, len(names)), prompt_suffix=" ")
    except (click.Abort, RuntimeError) as error:  # The latter: standard input is closed.
        if isinstance(error.__context__, KeyboardInterrupt):
            raise
        raise click.UsageError("Nobody answers: name the nodes to kill, or give --all.") from None
    return names[number - 1]
