"""``fibws node``: list, inspect, ping and kill nodes."""

from __future__ import annotations

import time
from collections.abc import Iterable, Iterator
from urllib.parse import urlsplit

import click

from fibws.cli import completers, output
from fibws.cli.common_options import json_option, with_hub
from fibws.cli.exit_handling import end_line
from fibws.client.graph_snapshot import Entry, GraphSnapshot, conflict_text, in_namespace
from fibws.client.hub_client import HubClient
from fibws.command_names import command_name
from fibws.errors import UnknownName

PATIENCE = 3.0
"""Seconds that the hub waits for a node's answer to a ping."""

PING_INTERVAL = 1.0
"""Seconds between two pings of a node."""


@click.group()
def command() -> None:
    """List, inspect, ping and kill nodes."""


@command.command("list")
@click.argument("namespace", required=False, shell_complete=completers.nodes)
@click.option("-u", "addresses", is_flag=True, help="List addresses instead of names.")
@click.option("-a", "--all", "everything", is_flag=True, help="List addresses and names.")
@json_option
@with_hub("node")
def list_(
    client: HubClient, namespace: str | None, addresses: bool, everything: bool, as_json: bool
) -> None:
    """List all nodes, or those in NAMESPACE.

    The hub's own nodes have the hub's address, and ROS 1 nodes a URI.
    """
    snapshot = GraphSnapshot(client)
    for node in in_namespace(namespace and client.resolve_namespace(namespace), snapshot.nodes):
        name, address = node["name"], snapshot.address(node["name"])
        if as_json:
            output.as_json({**node, "address": address})
        elif everything:
            output.line(f"{address} \t{name}")
        else:
            output.line(address if addresses else name)


@command.command()
@click.argument(
    "nodes", nargs=-1, required=True, metavar="NODE...", shell_complete=completers.nodes
)
@click.option("-q", "--quiet", is_flag=True, help="Omit the address and the connections.")
@json_option
@with_hub("node")
def info(client: HubClient, nodes: tuple[str, ...], quiet: bool, as_json: bool) -> None:
    """Show the topics, services and actions of each NODE.

    Also its address, the time since which it is connected, and its connections.
    """
    snapshot = GraphSnapshot(client)
    for node in [snapshot.node(client.resolve(name)) for name in nodes]:
        if as_json:
            output.as_json(_details(snapshot, node))
        else:
            for line in _description(snapshot, node, quiet=quiet):
                output.line(line)


@command.command()
@click.argument("node", required=False, shell_complete=completers.nodes)
@click.option("-a", "--all", "everyone", is_flag=True, help="Ping all nodes once.")
@click.option(
    "-c", "count", type=click.IntRange(1), metavar="COUNT", help="Stop after COUNT pings."
)
@with_hub("node")
def ping(client: HubClient, node: str | None, everyone: bool, count: int | None) -> None:
    """Ping NODE once a second until Ctrl-C.

    The printed time is that from the hub to the node and back.
    """
    if everyone:
        if node or count:
            raise click.UsageError("--all pings each node once, without NODE or -c")
        _ping_all(client)
        return
    if not node:
        raise click.UsageError(
            f"missing NODE or --all; {command_name('node list')} prints all nodes"
        )
    name = client.resolve(node)
    snapshot = GraphSnapshot(client)
    snapshot.node(name)
    output.line(f"pinging {name} with a timeout of {PATIENCE}s")
    times: list[float] = []
    try:
        while True:
            times.append(_ping(client, name, snapshot.address(name)))
            if len(times) == count:
                break
            client.process(PING_INTERVAL)
    except KeyboardInterrupt:
        end_line()  # The normal end.
    if len(times) > 1:
        output.line(f"ping average: {sum(times) / len(times):.2f}ms")


@command.command()
@click.argument("machine", required=False)
@with_hub("node")
def machine(client: HubClient, machine: str | None) -> None:
    """List the IP addresses of the nodes' machines, or the nodes on MACHINE."""
    snapshot = GraphSnapshot(client)
    names = [node["name"] for node in snapshot.nodes]
    hosts = {name: _host(snapshot.address(name)) for name in names}
    if machine is None:
        output.names(set(hosts.values()))
    elif machine in hosts.values():
        output.names(name for name, host in hosts.items() if host == machine)
    else:
        known = ", ".join(sorted(set(hosts.values())))
        raise click.ClickException(f"no nodes on {machine}; machines with nodes: {known}")


@command.command()
@click.option("-y", "--yes", is_flag=True, help="Unregister without asking.")
@with_hub("node")
def cleanup(client: HubClient, yes: bool) -> None:
    """Unregister ROS 1 nodes that do not answer.

    Other nodes are connected to the hub, which removes them when they disconnect.
    """
    nodes = [each["name"] for each in GraphSnapshot(client).nodes if each["api"]]
    responses = {name: client.call("/rosapi/ping_node", {"node": name}) for name in nodes}
    silent = {
        name: str(response["message"])
        for name, response in responses.items()
        if not response["success"]
    }
    if not silent:
        output.line(f"Nothing to clean up: {output.counted(len(nodes), 'ROS 1 node')}, all answer.")
        return
    output.line("Unable to contact the following nodes:")
    for message in silent.values():
        output.line(f" * {message}")
    output.line(
        "Warning: these might include alive and functioning nodes, e.g. in unstable networks."
    )
    output.line("Cleanup will purge all information about these nodes from the master.")
    if not yes and not _confirmed():
        output.line("aborting")
        return
    failures = []
    for name in silent:
        output.line(f"Unregistering {name}")
        response = client.call("/rosapi/unregister_node", {"node": name})
        if not response["success"]:
            failures.append(str(response["message"]))
    if failures:
        raise click.ClickException(f"Failed to unregister: {output.visible('; '.join(failures))}")
    output.line("done")


@command.command()
@click.argument("nodes", nargs=-1, metavar="[NODE]...", shell_complete=completers.nodes)
@click.option("-a", "--all", "everyone", is_flag=True, help="Kill all nodes.")
@with_hub("node")
def kill(client: HubClient, nodes: tuple[str, ...], everyone: bool) -> None:
    """Kill each NODE; without a NODE, ask for one.

    The hub closes a node's connection. Nodes of fibws and rospy end then; web pages may reconnect.
    ROS 1 nodes are asked to end.
    """
    if everyone and nodes:
        raise click.UsageError("--all cannot be combined with NODE")
    snapshot = GraphSnapshot(client)
    if nodes:
        names = [snapshot.node(client.resolve(name))["name"] for name in nodes]
    else:
        names = [node["name"] for node in snapshot.nodes if not node["own"]]
        if not names:
            click.echo("No nodes running", err=True)
            return
        if not everyone:
            names = [_ask_for_one(names)]
    if len(names) > 1:
        output.line("\n".join(["killing:", *(f" * {name}" for name in names)]))
    else:
        output.line(f"killing {names[0]}")
    responses = [client.call("/rosapi/kill_node", {"node": name}) for name in names]
    failures = [str(each["message"]) for each in responses if not each["success"]]
    if failures:
        raise click.ClickException(f"Failed to kill: {output.visible('; '.join(failures))}")
    output.line("killed")


# Details of a node


def _details(snapshot: GraphSnapshot, node: Entry) -> Entry:
    name = node["name"]
    return {
        **node,
        "address": snapshot.address(name),
        "publications": {topic["name"]: topic["type"] for topic in _published(snapshot, name)},
        "subscriptions": {topic["name"]: topic["type"] for topic in _subscribed(snapshot, name)},
        "conflicts": dict(_conflicts(snapshot, name)),
        "services": {
            each["name"]: each["type"] for each in snapshot.services if each["node"] == name
        },
        "actions": {
            each["name"]: each["type"] for each in snapshot.actions if each["node"] == name
        },
    }


def _description(snapshot: GraphSnapshot, node: Entry, *, quiet: bool) -> Iterator[str]:
    name = node["name"]
    yield "-" * 80
    yield f"Node [{name}]"
    yield from _section("Publications", map(_typed, _published(snapshot, name)))
    yield from _section("Subscriptions", map(_typed, _subscribed(snapshot, name)))
    conflicts = [f"{topic}: {text}" for topic, text in _conflicts(snapshot, name)]
    if conflicts:
        yield from _section("Conflicts", conflicts)
    provided = [each["name"] for each in snapshot.services if each["node"] == name]
    yield from _section("Services", provided)
    actions = [_typed(each) for each in snapshot.actions if each["node"] == name]
    if actions:
        yield from _section("Actions", actions)
    if quiet:
        return
    since = time.localtime(node["since"]["secs"])
    if node["hub"]:
        yield f"Hub: {node['hub']}"
    else:
        yield f"Address: {snapshot.address(name)}"
    if node["fault"]:
        yield f"Unreachable: {node['fault']}"
    yield f"Since: {time.strftime('%Y-%m-%d %H:%M:%S', since)}"
    connections = list(_connections(snapshot, name))
    if connections:
        yield "Connections:"
        yield from connections
    yield ""


def _section(head: str, items: Iterable[str]) -> Iterator[str]:
    found = [f" * {item}" for item in items]
    if found:
        yield f"{head}: "  # rosnode prints the trailing blank, too.
        yield from found
    else:
        yield f"{head}: None"
    yield ""


def _connections(snapshot: GraphSnapshot, name: str) -> Iterator[str]:
    for topic in _published(snapshot, name):
        for each in topic["subscriptions"]:
            encoding = each["compression"]
            yield from _connection(snapshot, topic, name, each["node"], "outbound", encoding)
    for topic in _subscribed(snapshot, name):
        encodings = {each["compression"] for each in topic["subscriptions"] if each["node"] == name}
        for each in topic["publishers"]:
            encoding = ", ".join(sorted(encodings))
            yield from _connection(snapshot, topic, name, each["node"], "inbound", encoding)


def _connection(
    snapshot: GraphSnapshot, topic: Entry, node: str, other: str, direction: str, encoding: str
) -> Iterator[str]:
    yield f" * topic: {topic['name']}"
    yield f"    * to: {other} ({snapshot.address(other)})"
    yield f"    * direction: {direction}"
    if any(each["api"] for each in snapshot.nodes if each["name"] in (node, other)):
        yield "    * transport: TCPROS"
    else:
        yield f"    * transport: WebSocket{'' if encoding == 'none' else f' ({encoding})'}"


def _published(snapshot: GraphSnapshot, node: str) -> list[Entry]:
    return [
        topic
        for topic in snapshot.topics
        if any(each["node"] == node for each in topic["publishers"])
    ]


def _subscribed(snapshot: GraphSnapshot, node: str) -> list[Entry]:
    return [
        topic
        for topic in snapshot.topics
        if any(each["node"] == node for each in topic["subscriptions"])
    ]


def _conflicts(snapshot: GraphSnapshot, node: str) -> Iterator[tuple[str, str]]:
    """Yield topics that a node uses in conflict with others, and why."""
    for topic in snapshot.topics:
        for conflict in topic["conflicts"]:
            if conflict["node"] == node:
                yield topic["name"], conflict_text(conflict, topic)


def _host(address: str) -> str:
    return urlsplit(address if "://" in address else f"//{address}").hostname or ""


def _typed(entry: Entry) -> str:
    return f"{entry['name']} [{entry['type'] or 'unknown type'}]"


# Pings


def _ping_all(client: HubClient) -> None:
    snapshot = GraphSnapshot(client)
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
    """Ping a node, print the time in milliseconds and return it."""
    response = client.call("/rosapi/ping_node", {"node": name})
    if not response["success"]:
        raise click.ClickException(output.visible(str(response["message"])))
    milliseconds = 1000 * float(response["seconds"])
    output.line(f"reply from {name} at {address}: time={milliseconds:.2f}ms")
    return milliseconds


def _confirmed() -> bool:
    try:
        return click.confirm("Please type y or n to continue", default=None)
    except (click.Abort, RuntimeError) as error:  # RuntimeError: standard input is closed.
        if isinstance(error.__context__, KeyboardInterrupt):
            raise
        raise click.UsageError("standard input is closed; give --yes") from None


def _ask_for_one(names: list[str]) -> str:
    """Let the user choose a node."""
    output.line("\n".join(f"{number}. {name}" for number, name in enumerate(names, 1)))
    text = "\nPlease enter the number of the node you wish to kill.\n>"
    try:
        number: int = click.prompt(text, type=click.IntRange(1, len(names)), prompt_suffix=" ")
    except (click.Abort, RuntimeError) as error:  # RuntimeError: standard input is closed.
        if isinstance(error.__context__, KeyboardInterrupt):
            raise
        raise click.UsageError("standard input is closed; give NODE or --all") from None
    return names[number - 1]
