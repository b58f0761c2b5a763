"""``fibws action``: which actions there are, of what types; goals to send."""

from __future__ import annotations

import re
import sys

import click

from fibws.cli import arguments, complete, output
from fibws.cli.common_options import examples, json_option, linked
from fibws.cli.exit_handling import INTERRUPTED, end_line
from fibws.cli.types import show
from fibws.client.actions import End, Feedback, Goal, News, OperationGoal, Status, TopicGoal
from fibws.client.graph_snapshot import Entry, Snapshot, within
from fibws.client.hub_client import HubClient
from fibws.values import parsing, printing
from fibws.values.typedefs import Typedefs, if_known

POLL = 0.1
"""Seconds between two looks for an action that is waited for."""

CANCEL_PATIENCE = 5.0
"""Seconds in which a server must say what becomes of a goal that is to be cancelled."""

_TYPE = re.compile(r"[A-Za-z]\w*/(action/)?[A-Za-z]\w*", re.ASCII)

_action = click.argument("action", shell_complete=complete.actions)


@click.group()
def command() -> None:
    """Look at actions, send them goals."""


command.add_command(show("action"))


@command.command("list")
@click.argument("namespace", required=False, shell_complete=complete.actions)
@click.option("-t", "--types", is_flag=True, help="Name the type of each.")
@json_option
@linked("action")
def list_(client: HubClient, namespace: str | None, types: bool, as_json: bool) -> None:
    """List all actions, or those in NAMESPACE."""
    found = within(namespace and client.resolve_namespace(namespace), Snapshot(client).actions)
    if as_json:
        for action in found:
            output.as_json(action)
    elif types:
        for action in found:
            output.line(f"{action['name']} [{action['type'] or 'unknown type'}]")
    else:
        output.names({action["name"] for action in found})


@command.command()
@_action
@json_option
@linked("action")
def info(client: HubClient, action: str, as_json: bool) -> None:
    """Show the type, the clients and the servers of ACTION.

    Goals may go over topics, as in ROS 1, over operations, as rosbridge has them for ROS 2, or
    both; clients are known of topics alone.
    """
    snapshot = Snapshot(client)
    for way in snapshot.ways(client.resolve(action)):
        clients = _publishers(snapshot, f"{way['name']}/goal") if way["over_topics"] else []
        if as_json:
            address = snapshot.address(way["node"])
            output.as_json({**way, "address": address, "clients": clients})
            continue
        output.line(f"Type: {way['type'] or 'unknown type'}")
        output.line(f"Over: {'topics' if way['over_topics'] else 'operations'}\n")
        if way["over_topics"]:
            _nodes("Clients", clients, snapshot)
        _nodes("Servers", [way["node"]] if way["node"] else [], snapshot)


@command.command("type")
@_action
@linked("action")
def type_(client: HubClient, action: str) -> None:
    """Print the type of ACTION.

    It may have two, if goals may go over topics and over operations.
    """
    for way in Snapshot(client).ways(client.resolve(action)):
        output.line(way["type"])


@command.command(context_settings=arguments.VALUES)
@_action
@click.argument("goal", nargs=-1, metavar="[TYPE] [GOAL]...", callback=arguments.check)
@click.option("-f", "--feedback", is_flag=True, help="Print the feedback, too.")
@click.option("--wait", is_flag=True, help="Wait until somebody serves the action.")
@json_option
@linked("action")
@examples("{action send} -f /fibonacci 5", '{action send} /fibonacci "{order: 5}"')
def send(
    client: HubClient, action: str, goal: tuple[str, ...], feedback: bool, wait: bool, as_json: bool
) -> None:
    """Send ACTION a goal and print its result.

    The goal's status goes to standard error.

    GOAL is a value for each field in order, or all as one object, in YAML: 5 or "{order: 5}".
    TYPE is needed only where an action has two. Ctrl-C cancels the goal. The exit code is 0 if the
    goal has SUCCEEDED.
    """
    name = client.resolve(action)
    named, goal = (goal[0], goal[1:]) if goal and _TYPE.fullmatch(goal[0]) else (None, goal)
    if wait:
        _wait(client, name)
    way, type_ = _way(Snapshot(client).ways(name), named)
    values = parsing.message(goal, if_known(Typedefs.of_message, client, f"{type_}Goal"))
    kind = TopicGoal if way["over_topics"] else OperationGoal
    printer = _Printer(client, type_, feedback=feedback, as_json=as_json)
    sent: Goal = kind(client, name, type_, values)
    try:
        end = _follow(sent, printer)
    except KeyboardInterrupt:
        sent.cancel()
        end_line()
        click.echo("canceling the goal", err=True)
        _follow(sent, printer, timeout=CANCEL_PATIENCE)
        sys.exit(INTERRUPTED)
    assert end is not None  # There is one, if one waits for it.
    if end.status != "SUCCEEDED":
        reason = f": {output.visible(end.text)}" if end.text else ""
        raise click.ClickException(f"{name}: {end.status}{reason}")


class _Printer:
    """Prints what is heard of a goal."""

    def __init__(self, client: HubClient, type_: str, *, feedback: bool, as_json: bool) -> None:
        self._feedback = if_known(Typedefs.of_message, client, f"{type_}Feedback")
        self._result = if_known(Typedefs.of_message, client, f"{type_}Result")
        self._prints_feedback = feedback
        self._as_json = as_json

    def print(self, news: News) -> None:
        match news:
            case Status(status):
                click.echo(status, err=True)
            case Feedback(values) if self._prints_feedback and self._as_json:
                output.as_json({"feedback": values})
            case Feedback(values) if self._prints_feedback:
                output.line(printing.text(values, self._feedback))
                output.line("---")
            case End(status, text, result):
                click.echo(status, err=True)
                if self._as_json:
                    output.as_json({"status": status, "text": text, "result": result})
                elif result is not None:
                    output.line(printing.text(result, self._result))


def _follow(goal: Goal, printer: _Printer, timeout: float | None = None) -> End | None:
    """Print the news of a goal until its end, which is returned, or None if it comes too late."""
    for news in goal.news(timeout):
        printer.print(news)
        if isinstance(news, End):
            return news
    return None


def _way(ways: list[Entry], named: str | None) -> tuple[Entry, str]:
    """How to send a goal, and the action's type, which may have been named; topics if in doubt."""
    ways = sorted(ways, key=lambda way: not way["over_topics"])
    type_: str = named.replace("/action/", "/", 1) if named else ways[0]["type"]
    if not type_:
        text = f"The type of {ways[0]['name']} is not known: name it before the goal."
        raise click.UsageError(text)
    for way in ways:
        if way["type"] in (type_, ""):
            return way, type_
    there = " and ".join(way["type"] for way in ways)
    raise click.ClickException(f"{ways[0]['name']} is of type {there}, not {type_}")


def _wait(client: HubClient, name: str) -> None:
    while all(action["name"] != name for action in Snapshot(client).actions):
        client.process(POLL)


def _publishers(snapshot: Snapshot, name: str) -> list[str]:
    return [
        publisher["node"]
        for topic in snapshot.topics
        if topic["name"] == name
        for publisher in topic["publishers"]
    ]


def _nodes(head: str, nodes: list[str], snapshot: Snapshot) -> None:
    if not nodes:
        output.line(f"{head}: None\n")
        return
    output.line(f"{head}: ")
    for node in nodes:
        output.line(f" * {node} ({snapshot.address(node)})")
    output.line()
