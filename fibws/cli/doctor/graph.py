"""Checks of the graph: types, missing publishers and subscribers, names, slow clients."""

from __future__ import annotations

import re
from collections import defaultdict
from collections.abc import Iterable, Iterator
from typing import Any, TypeAlias

from fibws.cli.doctor.finding import Finding, join_names, ok, warning
from fibws.cli.output import counted
from fibws.client.graph_snapshot import OTHER_FIELDS, Entry, conflict_text, is_of_other_type
from fibws.client.graph_view import DrawnTopic, View
from fibws.command_names import command_name
from fibws.suggestions import misspelled

Snapshot: TypeAlias = tuple[dict[str, Any], dict[str, Any]]
"""The responses of /rosapi/graph and /rosapi/statistics at one moment."""


def checks(before: Snapshot, now: Snapshot, *, but: str) -> Iterator[Finding]:
    """Yield the findings about the graph.

    Args:
        before: an older snapshot.
        now: the newest snapshot.
        but: the node to exclude, which is the doctor's own.
    """
    view = View.of(now[0], exclude=but)
    nodes, topics = counted(len(view.nodes), "node"), counted(len(view.topics), "topic")
    yield ok("graph", f"{nodes}, {topics}")
    yield from _or(ok("types", "All topics have defined types"), types(view))
    fine = ok("conflicts", "All topics are used with their own types")
    yield from _or(fine, conflicts(now[0]["topics"]))
    yield from _or(ok("ends", "All topics have publishers and subscribers"), ends(view))
    everything = View.of(now[0], exclude=but, everything=True)
    clashes = [*same_names(everything), *twins(view), *replaced(before[0], now[0])]
    yield from _or(ok("names", "No name is used twice"), clashes)
    yield from _or(ok("clients", "No client is too slow"), clients(before[1], now[1], but=but))


def types(view: View) -> Iterator[Finding]:
    """Find topics whose types are undefined, so that messages are not checked."""
    unchecked = {each.name: each.type for each in view.topics if each.type and not each.checked}
    if not unchecked:
        return
    from fibws.interfaces import Interfaces

    installed = Interfaces()
    undefined = []
    for name, type_ in unchecked.items():
        if meant := installed.meant("msg", type_):
            text = f"{name} has a type of an unknown package, {type_}: its messages are not checked"
            yield warning("types", text, f"Did you mean {meant}?")
        else:
            undefined.append(f"{name} ({type_})")
    if undefined:
        yield warning(
            "types",
            f"Topics of undefined types, whose messages are not checked: {join_names(undefined)}",
            f"Start the hub with their folder: {command_name('hub')} --interfaces DIR",
        )


def conflicts(topics: list[Entry]) -> Iterator[Finding]:
    """Find nodes that use a topic with another type, or otherwise as the hub cannot."""
    for topic in topics:
        for each in topic["conflicts"]:
            yield warning(
                "conflicts",
                f"{each['node']} on {topic['name']}: {conflict_text(each, topic)}",
                _advice(each, topic),
            )


def _advice(conflict: Entry, topic: Entry) -> str:
    """Return what to do about a conflict."""
    if is_of_other_type(conflict, topic):
        return (
            "It exchanges messages only with nodes that use its type. Correct the type, or "
            f"give it another topic: {topic['name']}:=/OTHER"
        )
    if OTHER_FIELDS in conflict["fault"]:
        return (
            "It exchanges messages only with nodes that have its definition of the type. Start all "
            f"with the same version of the package {conflict['type'].partition('/')[0]}."
        )
    return (
        "It exchanges no messages with the hub's clients there. The section [ros1] of "
        "the hub's file of tokens has the rights of ROS 1 nodes."
    )


def ends(view: View) -> Iterator[Finding]:
    """Find topics without a publisher or without subscribers, and misspelled ones among them."""
    published = [each for each in view.topics if each.publishers]
    unpublished = [each for each in view.topics if not each.publishers and each.subscribers]
    unsubscribed = [each.name for each in published if not each.subscribers]
    explained: set[str] = set()
    for topic in unpublished:
        others = [each.name for each in published if _may_be_one(topic, each)]
        guess = misspelled(topic.name, others)
        if guess is not None:
            explained |= {topic.name, guess}
            yield warning(
                "ends",
                f"{topic.name} has a subscriber ({join_names(topic.subscribers, 2)}) but no "
                f"publisher; {guess} has a publisher",
                f"If they should be one topic, fix the name or remap it: {topic.name}:={guess}",
            )
    waiting = [each.name for each in unpublished if each.name not in explained]
    if waiting:
        yield warning(
            "ends",
            f"Topics with subscribers but no publisher: {join_names(waiting)}",
            f"Is a node not running, or has its topic another name? See: {command_name('graph')}",
        )
    unread = [name for name in unsubscribed if name not in explained]
    if unread:
        yield warning(
            "ends",
            f"Topics without subscribers: {join_names(unread)}",
            f"This may be intended. To print it: {command_name('topic echo')} {unread[0]}",
        )


def same_names(view: View) -> Iterator[Finding]:
    """Find topics and services of the same name, which ROS allows.

    Actions are not compared: their topics are in the namespace of their name.
    """
    services = {each.name for each in view.services}
    for name in sorted(each.name for each in view.topics if each.name in services):
        yield warning(
            "names",
            f"{name} is a topic and a service",
            "Both work; rename one of them to avoid confusion.",
        )


def twins(view: View) -> Iterator[Finding]:
    """Find topics that two copies of a program publish, by their names: ``talker_1``."""
    for topic in view.topics:
        copies: defaultdict[str, list[str]] = defaultdict(list)
        for node in topic.publishers:
            copies[re.sub(r"(_\d+)+$", "", node)].append(node)
        for nodes in copies.values():
            if len(nodes) > 1:
                yield warning(
                    "names",
                    f"{topic.name} is published by {len(nodes)} copies of a program: "
                    f"{join_names(nodes)}",
                    f"If one is too many: {command_name('node kill')} {nodes[-1]}",
                )


def replaced(before: dict[str, Any], now: dict[str, Any]) -> Iterator[Finding]:
    """Find nodes that another node of the same name replaced between the snapshots."""
    older = {each["name"]: each["address"] for each in before["nodes"]}
    for node in now["nodes"]:
        if older.get(node["name"], node["address"]) != node["address"]:
            yield warning(
                "names",
                f"{node['name']} reconnected within a second, from {node['address']}: probably two "
                "programs with the same node name replace each other",
                "Give each its own name with --node-name or __name:=",
            )


def clients(before: dict[str, Any], now: dict[str, Any], *, but: str) -> Iterator[Finding]:
    """Find clients that read too slowly."""
    older = {each["node"]: each["dropped"] for each in before["clients"]}
    for client in now["clients"]:
        name, dropped = client["node"], client["dropped"]
        if name == but:
            continue
        more = dropped - older.get(name, dropped)
        if client["slow"] or more > 0:
            yield warning(
                "clients",
                f"{name} ({client['address']}) is too slow: {client['kept_bytes']} bytes queued, "
                f"{counted(dropped, 'message')} dropped, {max(0, more)} in the last second",
                f"Subscribe with a throttle_rate, or to fewer topics. See: {command_name('top')}",
            )
        elif dropped:
            yield ok(
                "clients",
                f"{name} is fast enough now; {counted(dropped, 'message')} dropped before",
            )


def _may_be_one(topic: DrawnTopic, other: DrawnTopic) -> bool:
    return topic.type == other.type or not topic.type or not other.type


def _or(fine: Finding, found: Iterable[Finding]) -> Iterator[Finding]:
    yield from list(found) or [fine]
