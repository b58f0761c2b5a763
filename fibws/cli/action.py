"""``fibws action``: list and inspect actions, send goals."""

from __future__ import annotations

import sys

import click

from fibws.cli import arguments, completers, output
from fibws.cli.common_options import examples, json_option, with_hub
from fibws.cli.exit_handling import INTERRUPTED, end_line
from fibws.cli.type_names import is_type
from fibws.cli.types import show
from fibws.client.actions import (
    End,
    Feedback,
    OpenGoal,
    OperationGoal,
    StatusChange,
    TopicGoal,
    Update,
)
from fibws.client.graph_snapshot import Entry, GraphSnapshot, in_namespace
from fibws.client.hub_client import HubClient
from fibws.protocol.goals import GoalStatus
from fibws.values import parsing
from fibws.values.typedefs import Typedefs, if_known
from fibws.values.yaml_text import message_text

POLL = 0.1
"""Seconds between two checks for an action that --wait waits for."""

CANCEL_PATIENCE = 5.0
"""Seconds to wait for the end of a canceled goal."""

_action = click.argument("action", shell_complete=completers.actions)


@click.group()
def command() -> None:
    """List and inspect actions, send goals."""


command.add_command(show("action"))


@command.command("list")
@click.argument("namespace", required=False, shell_complete=completers.actions)
@click.option("-t", "--types", is_flag=True, help="Also print the types.")
@json_option
@with_hub("action")
def list_(client: HubClient, namespace: str | None, types: bool, as_json: bool) -> None:
    """List all actions, or those in NAMESPACE."""
    found = in_namespace(
        namespace and client.resolve_namespace(namespace), GraphSnapshot(client).actions
    )
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
@with_hub("action")
def info(client: HubClient, action: str, as_json: bool) -> None:
    """Show the type, the clients and the servers of ACTION.

    An action is over topics, as in ROS 1, over operations, as rosbridge has them for ROS 2, or
    both. Clients are shown for topics only.
    """
    snapshot = GraphSnapshot(client)
    for entry in snapshot.actions_named(client.resolve(action)):
        clients = _publishers(snapshot, f"{entry['name']}/goal") if entry["over_topics"] else []
        if as_json:
            address = snapshot.address(entry["node"])
            output.as_json({**entry, "address": address, "clients": clients})
            continue
        output.line(f"Type: {entry['type'] or 'unknown type'}")
        output.line(f"Over: {'topics' if entry['over_topics'] else 'operations'}\n")
        if entry["over_topics"]:
            _print_nodes("Clients", clients, snapshot)
        _print_nodes("Servers", [entry["node"]] if entry["node"] else [], snapshot)


@command.command("type")
@_action
@with_hub("action")
def type_(client: HubClient, action: str) -> None:
    """Print the type of ACTION.

    An action over both topics and operations may have two types.
    """
    for entry in GraphSnapshot(client).actions_named(client.resolve(action)):
        output.line(entry["type"])


@command.command(context_settings=arguments.VALUES)
@_action
@click.argument(
    "goal",
    nargs=-1,
    metavar="[TYPE] [GOAL]...",
    callback=arguments.check,
    shell_complete=completers.goal,
)
@click.option("-f", "--feedback", is_flag=True, help="Also print feedback.")
@click.option("--wait", is_flag=True, help="Wait until the action has a server.")
@json_option
@with_hub("action")
@examples("{action send} -f /fibonacci 5", '{action send} /fibonacci "{order: 5}"')
def send(
    client: HubClient, action: str, goal: tuple[str, ...], feedback: bool, wait: bool, as_json: bool
) -> None:
    """Send a goal to ACTION and print its result.

    The goal's status is printed on standard error.

    GOAL is the value of each field in order, or all as one object, in YAML: 5 or "{order: 5}".
    TYPE is needed only if the action has two types or an unknown one. Ctrl-C cancels the goal. The
    exit code is 0 if the goal SUCCEEDED.
    """
    name = client.resolve(action)
    if wait:
        _wait(client, name)
    entry, type_, words = _choose(GraphSnapshot(client).actions_named(name), goal)
    values = parsing.message(words, if_known(Typedefs.of_message, client, f"{type_}Goal"))
    kind = TopicGoal if entry["over_topics"] else OperationGoal
    printer = _GoalPrinter(client, type_, feedback=feedback, as_json=as_json)
    sent: OpenGoal = kind(client, name, type_, values)
    try:
        end = _follow(sent, printer)
    except KeyboardInterrupt:
        sent.cancel()
        end_line()
        click.echo("canceling the goal", err=True)
        _follow(sent, printer, timeout=CANCEL_PATIENCE)
        sys.exit(INTERRUPTED)
    assert end is not None, "without a timeout, the updates end with the goal"
    if end.status is not GoalStatus.SUCCEEDED:
        reason = f": {output.visible(end.text)}" if end.text else ""
        raise click.ClickException(f"{name}: {end.status}{reason}")


class _GoalPrinter:
    """Prints the updates of a goal."""

    def __init__(self, client: HubClient, type_: str, *, feedback: bool, as_json: bool) -> None:
        self._feedback = if_known(Typedefs.of_message, client, f"{type_}Feedback")
        self._result = if_known(Typedefs.of_message, client, f"{type_}Result")
        self._prints_feedback = feedback
        self._as_json = as_json

    def print(self, update: Update) -> None:
        match update:
            case StatusChange(status):
                click.echo(status.name, err=True)
            case Feedback(values) if self._prints_feedback and self._as_json:
                output.as_json({"feedback": values})
            case Feedback(values) if self._prints_feedback:
                output.line(message_text(values, self._feedback))
                output.line("---")
            case End(status, text, result):
                click.echo(status.name, err=True)
                if self._as_json:
                    output.as_json({"status": status.name, "text": text, "result": result})
                elif result is not None:
                    output.line(message_text(result, self._result))


def _follow(goal: OpenGoal, printer: _GoalPrinter, timeout: float | None = None) -> End | None:
    """Print the updates of a goal and return its end; None if it has not ended in time."""
    for update in goal.updates(timeout):
        printer.print(update)
        if isinstance(update, End):
            return update
    return None


def _choose(entries: list[Entry], goal: tuple[str, ...]) -> tuple[Entry, str, tuple[str, ...]]:
    """Choose between an action over topics and over operations; topics are preferred.

    The first word of the goal is a TYPE only if it is one of the action's types, or if the action
    has an unknown type: a string in a goal may look like a type.

    Returns:
        The action's entry, its type, and the words of the goal.
    """
    entries = sorted(entries, key=lambda entry: not entry["over_topics"])
    types = [entry["type"] for entry in entries]
    named = goal[0].replace("/action/", "/", 1) if goal else ""
    if named in types or ("" in types and is_type(named)):
        exact = [entry for entry in entries if entry["type"] == named]
        unknown = [entry for entry in entries if not entry["type"]]
        return (exact or unknown)[0], named, goal[1:]
    if not types[0]:
        name = entries[0]["name"]
        raise click.UsageError(f"the type of {name} is unknown; give TYPE before the goal")
    return entries[0], types[0], goal


def _wait(client: HubClient, name: str) -> None:
    while all(action["name"] != name for action in GraphSnapshot(client).actions):
        client.process(POLL)


def _publishers(snapshot: GraphSnapshot, name: str) -> list[str]:
    return [
        publisher["node"]
        for topic in snapshot.topics
        if topic["name"] == name
        for publisher in topic["publishers"]
    ]


def _print_nodes(head: str, nodes: list[str], snapshot: GraphSnapshot) -> None:
    if not nodes:
        output.line(f"{head}: None\n")
        return
    output.line(f"{head}: ")
    for node in nodes:
        output.line(f" * {node} ({snapshot.address(node)})")
    output.line()
