"""``fibws hub``: run a hub, and show the other hubs that it is joined to."""

from __future__ import annotations

from collections.abc import Iterator
from importlib import import_module
from itertools import count
from typing import Any

import click

from fibws.cli import output
from fibws.cli.common_options import delay_option, json_option, with_hub
from fibws.cli.quantities import amount, date, flow
from fibws.client import statistics
from fibws.client.graph_snapshot import Entry, GraphSnapshot
from fibws.client.hub_client import HubClient
from fibws.command_names import command_name
from fibws.errors import UnknownName
from fibws.suggestions import suggestion

HUBS = "/rosapi/hubs"
LIST = "hub list"
HEADS = ("HUB", "LINK", "ADDRESS", "SINCE", "RTT", "CLOCK", "IN", "OUT", "DROPPED", "LOST")


class HubCommands(click.Group):
    """Runs a hub, unless its first argument is one of its commands."""

    def make_context(
        self,
        info_name: str | None,
        args: list[str],
        parent: click.Context | None = None,
        **extra: Any,
    ) -> click.Context:
        """Return the context of a command, or of running a hub, for which alone the hub loads."""
        if args and (args[0] in ("-h", "--help") or not args[0].startswith("-")):
            return super().make_context(info_name, args, parent, **extra)
        return _run().make_context(info_name, args, parent, **extra)

    def format_help(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """Write the help of running a hub, and the list of the commands."""
        run = _run()
        formatter.write_usage(ctx.command_path, "[OPTIONS] | COMMAND [ARGS]...")
        run.format_help_text(ctx, formatter)
        click.Command.format_options(run, ctx, formatter)
        self.format_commands(ctx, formatter)

    def resolve_command(
        self, ctx: click.Context, args: list[str]
    ) -> tuple[str | None, click.Command | None, list[str]]:
        """Return the command that arguments call; raise `UsageError` if it is unknown."""
        if args[0] not in self.commands:
            hint = suggestion(args[0], self.commands) or "."
            raise click.UsageError(f"No such command {args[0]!r}{hint}", ctx)
        return super().resolve_command(ctx, args)


def _run() -> click.Command:
    command: click.Command = import_module("fibws.hub.__main__").command
    return command


@click.group(cls=HubCommands)
def command() -> None:
    """Run a hub, or show the other hubs that it is joined to."""


@command.command("list")
@delay_option
@click.option("--watch", is_flag=True, help="Repeat until Ctrl-C.")
@json_option
@with_hub("hub", endless=True)
def list_(client: HubClient, delay: float, watch: bool, as_json: bool) -> None:
    """List the links to other hubs, and the hubs behind them.

    RTT is the time to the other hub and back, CLOCK the seconds by which its clock is ahead.
    DROPPED are messages that were not sent as the link was too slow, LOST those that have not
    arrived.
    """
    before = client.call(HUBS)
    for _ in count() if watch else range(1):
        client.process(delay)
        now = client.call(HUBS)
        links = statistics.links(before, now)
        before = now
        if as_json:
            for each in links:
                output.as_json(each)
            continue
        if watch and output.has_control_sequences():
            click.clear()
        output.line(f"This hub: {now['hub']['name']} (id {now['hub']['id']})")
        if not links:
            output.line(f"It is joined to no other hub; see {command_name('hub')} --help, --join.")
            continue
        output.table(HEADS, map(_cells, links))
        for hub in now["hubs"]:
            if hub["distance"] > 1:
                output.line(_behind(hub))


@command.command()
@click.argument("name", required=False)
@delay_option
@json_option
@with_hub("hub")
def info(client: HubClient, name: str | None, delay: float, as_json: bool) -> None:
    """Show this hub, or the hub called NAME: its link, totals and nodes."""
    before = client.call(HUBS)
    _find(before, name)  # A wrong name gets its error at once.
    client.process(delay)
    now = client.call(HUBS)
    hub = _find(now, name)
    snapshot = GraphSnapshot(client)
    is_own = hub["id"] == now["hub"]["id"]
    wanted = "" if is_own else hub["name"]
    details = {
        **hub,
        "links": [
            each for each in statistics.links(before, now) if is_own or each["id"] == hub["id"]
        ],
        "nodes": [each["name"] for each in snapshot.nodes if each["hub"] == wanted],
    }
    if as_json:
        output.as_json(details)
    else:
        for line in _description(details):
            output.line(line)


def _find(response: Entry, name: str | None) -> Entry:
    own: Entry = {**response["hub"], "link": "", "distance": 0}
    if name is None:
        return own
    known: list[Entry] = [own, *response["hubs"]]
    for hub in known:
        if name in (hub["name"], hub["id"]):
            return hub
    hint = suggestion(name, [each["name"] for each in known])
    raise UnknownName(f"Unknown hub {name}{hint or f'; {command_name(LIST)} prints all'}")


# Texts


def _cells(link: Entry) -> tuple[str, ...]:
    if link["fault"]:
        return ("-", link["kind"], link["address"] or "-", f"down: {link['fault']}", *[""] * 6)
    return (
        link["name"],
        link["kind"],
        link["address"] or "-",
        date(link["since"]),
        f"{1000 * link['round_trip']:.1f} ms",
        f"{link['clock_offset']:+.3f} s",
        flow(link, "received"),
        flow(link, "sent"),
        str(link["dropped"]),
        str(link["lost"]),
    )


def _behind(hub: Entry) -> str:
    nodes = output.counted(hub["nodes"], "node")
    return f"{hub['name']}: {nodes}, by way of {hub['link']} (distance {hub['distance']})"


def _description(hub: Entry) -> Iterator[str]:
    yield f"Hub: {hub['name']}"
    yield f"Id: {hub['id']}"
    yield f"Version: {hub['version']}"
    if hub["distance"] > 1:
        yield f"Reached by way of: {hub['link']} (distance {hub['distance']})"
    for link in hub["links"]:
        yield ""
        if link["fault"]:
            yield f"Link: {link['kind']} {link['address']}, down: {link['fault']}"
            continue
        yield f"Link: {link['kind']} {link['name']} {link['address']}".rstrip()
        yield f" * Round trip: {1000 * link['round_trip']:.1f} ms"
        yield f" * Clock: {link['clock_offset']:+.3f} s ahead of this hub's"
        for text, direction in (("Received", "received"), ("Sent", "sent")):
            messages, size = link[f"messages_{direction}"], link[f"bytes_{direction}"]
            yield f" * {text}: {messages} messages, {amount(size)} ({flow(link, direction)})"
        yield f" * Dropped, as it was too slow: {link['dropped']} messages"
        yield f" * Lost on the way: {link['lost']} messages"
    yield ""
    yield f"Nodes: {len(hub['nodes'])}"
    for node in hub["nodes"]:
        yield f" * {node}"
