"""What looks odd in the graph: types, loose ends, names, clients that do not keep up."""

from __future__ import annotations

import re
from collections import defaultdict
from collections.abc import Iterable, Iterator
from typing import Any, TypeAlias

from fibws.cli.doctor.finding import Finding, listed, ok, warning
from fibws.cli.graph.view import Topic, View
from fibws.cli.output import counted
from fibws.suggestions import misspelled

Look: TypeAlias = tuple[dict[str, Any], dict[str, Any]]
"""What /rosapi/graph and /rosapi/statistics said at one time."""


def checks(before: Look, now: Look, *, but: str) -> Iterator[Finding]:
    """All that the hub's answers tell.

    Args:
        before: what they were a moment ago.
        now: what they are now.
        but: the node that asks, which is no part of it.
    """
    view = View.of(now[0], but=but)
    nodes, topics = counted(len(view.nodes), "node"), counted(len(view.topics), "topic")
    yield ok("graph", f"{nodes}, {topics} of theirs")
    yield from _or(ok("types", "Every topic's type is defined"), types(view))
    yield from _or(ok("ends", "Every topic has publishers and subscribers"), ends(view))
    everything = View.of(now[0], but=but, everything=True)
    clashes = [*same_names(everything), *twins(view), *replaced(before[0], now[0])]
    yield from _or(ok("names", "No two things have one name"), clashes)
    yield from _or(ok("clients", "All keep up"), clients(before[1], now[1], but=but))


def types(view: View) -> Iterator[Finding]:
    """Topics whose messages nobody checks."""
    unchecked = [
        f"{each.name} ({each.type})" for each in view.topics if each.type and not each.checked
    ]
    if unchecked:
        yield warning(
            "types",
            f"No definition is known of the types of {listed(unchecked)}; messages go unchecked",
            "Start the hub with the folder of the definitions: fibws hub --interfaces DIR",
        )


def ends(view: View) -> Iterator[Finding]:
    """Topics that one end of is missing, most of all those that are one topic misspelled."""
    published = [each for each in view.topics if each.publishers]
    silent = [each for each in view.topics if not each.publishers and each.subscribers]
    unheard = [each.name for each in published if not each.subscribers]
    explained: set[str] = set()
    for topic in silent:
        others = [each.name for each in published if _may_be_one(topic, each)]
        guess = misspelled(topic.name, others)
        if guess is not None:
            explained |= {topic.name, guess}
            yield warning(
                "ends",
                f"{topic.name} has a subscriber ({listed(topic.subscribers, 2)}) and no publisher, "
                f"while {guess} is published",
                f"If they are to be one, mend the name, or remap it: {topic.name}:={guess}",
            )
    waiting = [each.name for each in silent if each.name not in explained]
    if waiting:
        yield warning(
            "ends",
            f"Nobody publishes {listed(waiting)}, which somebody waits for",
            "Is a node not started yet, or its topic called otherwise? See: fibws graph",
        )
    loose = [name for name in unheard if name not in explained]
    if loose:
        yield warning(
            "ends",
            f"Nobody hears {listed(loose)}",
            "That may be as it should be. To hear: fibws topic echo " + loose[0],
        )


def same_names(view: View) -> Iterator[Finding]:
    """Topics and services of one name, which ROS allows and people confuse.

    An action is no clash: it has its topics in the namespace of its name.
    """
    services = {each.name for each in view.services}
    for name in sorted(each.name for each in view.topics if each.name in services):
        yield warning(
            "names",
            f"{name} is a topic and a service",
            "Both work, but give one of them a name of its own.",
        )


def twins(view: View) -> Iterator[Finding]:
    """Topics that one program publishes twice, as its copies' names tell: ``talker_1``."""
    for topic in view.topics:
        copies: defaultdict[str, list[str]] = defaultdict(list)
        for node in topic.publishers:
            copies[re.sub(r"(_\d+)+$", "", node)].append(node)
        for nodes in copies.values():
            if len(nodes) > 1:
                yield warning(
                    "names",
                    f"{topic.name} is published by what looks like one program, "
                    f"{len(nodes)} times: {listed(nodes)}",
                    f"If that is one too many: fibws node kill {nodes[-1]}",
                )


def replaced(before: dict[str, Any], now: dict[str, Any]) -> Iterator[Finding]:
    """Nodes that another one of their name took the place of while this looked."""
    older = {each["name"]: each["address"] for each in before["nodes"]}
    for node in now["nodes"]:
        if older.get(node["name"], node["address"]) != node["address"]:
            yield warning(
                "names",
                f"{node['name']} came anew within a second, from {node['address']}: most likely "
                "two programs of one name shut each other down",
                "Give each a name of its own, by --node-name or __name:=",
            )


def clients(before: dict[str, Any], now: dict[str, Any], *, but: str) -> Iterator[Finding]:
    """Clients that do not take what is sent to them."""
    older = {each["node"]: each["dropped"] for each in before["clients"]}
    for client in now["clients"]:
        name, dropped = client["node"], client["dropped"]
        if name == but:
            continue
        more = dropped - older.get(name, dropped)
        if client["slow"] or more > 0:
            yield warning(
                "clients",
                f"{name} ({client['address']}) is too slow: {client['kept_bytes']} bytes wait for "
                f"it, {counted(dropped, 'message')} dropped in all, {max(0, more)} just now",
                "Subscribe with a throttle_rate, or to less. Live: fibws top",
            )
        elif dropped:
            yield ok("clients", f"{name} keeps up now; it once lost {counted(dropped, 'message')}")


def _may_be_one(topic: Topic, other: Topic) -> bool:
    return topic.type == other.type or not topic.type or not other.type


def _or(fine: Finding, found: Iterable[Finding]) -> Iterator[Finding]:
    yield from list(found) or [fine]
