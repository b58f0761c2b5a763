"""rosnode's functions for scripts: list, ping, describe and kill nodes."""

from __future__ import annotations

import sys
from collections.abc import Iterable
from time import sleep
from typing import Any

import rosgraph
from rosgraph.masterapi import reporting_no_master
from rosgraph.names import make_global_ns, script_resolve_name

__all__ = [
    "ID",
    "ROSNodeException",
    "ROSNodeIOException",
    "get_api_uri",
    "get_node_info_description",
    "get_node_names",
    "kill_nodes",
    "rosnode_ping",
    "rosnode_ping_all",
]

ID = "/rosnode"

PATIENCE = 3.0
"""Seconds that the hub waits for a node to answer a ping."""


class ROSNodeException(Exception):
    """The base of rosnode's errors."""


class ROSNodeIOException(ROSNodeException):
    """The hub cannot be reached."""


def get_node_names(namespace: str | None = None) -> list[str]:
    """Return the global names of the nodes that have topics or services, sorted.

    Args:
        namespace: a global namespace; None for all nodes.

    Raises:
        ROSNodeIOException: the hub cannot be reached.
    """
    with reporting_no_master(ROSNodeIOException):
        state = rosgraph.Master(ID).getSystemState()
    found = {node for role in state for _, nodes in role for node in nodes}
    if namespace:
        above = make_global_ns(namespace)
        found = {node for node in found if node.startswith(above) or node == namespace}
    return sorted(found)


def rosnode_ping(
    node_name: str, max_count: int | None = None, verbose: bool = False, skip_cache: bool = False
) -> bool:
    """Ping a node, once a second.

    Args:
        node_name: the node.
        max_count: number of pings; None to ping until Ctrl-C.
        verbose: print each answer; failures are always printed.
        skip_cache: has no effect: there is no cache.

    Returns:
        Whether the node answered each time.

    Raises:
        ROSNodeIOException: the hub cannot be reached.
    """
    name = script_resolve_name("rosnode", node_name)
    master = rosgraph.Master(ID)
    with reporting_no_master(ROSNodeIOException):
        uri = get_api_uri(master, name)
    if uri is None:
        print(f"cannot ping [{name}]: unknown node", file=sys.stderr)
        return False
    if verbose:
        print(f"pinging {name} with a timeout of {PATIENCE}s")
    took: list[float] = []
    try:
        while True:
            with reporting_no_master(ROSNodeIOException):
                answer = master.ask("ping_node", node=name)
            if not answer["success"]:
                print(f"connection to [{name}] failed: {answer['message']}", file=sys.stderr)
                return False
            took.append(1000 * answer["seconds"])
            if verbose:
                print(f"reply from {uri}\ttime={took[-1]:f}ms")
            if max_count and len(took) >= max_count:
                break
            sleep(1.0)
    except KeyboardInterrupt:
        pass
    if verbose and len(took) > 1:
        print(f"ping average: {sum(took) / len(took):f}ms")
    return True


def rosnode_ping_all(
    verbose: bool = False, skip_cache: bool = False
) -> tuple[list[str], list[str]]:
    """Ping all nodes, once.

    Returns:
        The names of the nodes that answered, and of the others.

    Raises:
        ROSNodeIOException: the hub cannot be reached.
    """
    nodes = get_node_names()
    if verbose:
        print("\n".join(["Will ping the following nodes: ", *(f" * {node}" for node in nodes), ""]))
    answers = {node: rosnode_ping(node, max_count=1, verbose=verbose) for node in nodes}
    return (
        [node for node, answered in answers.items() if answered],
        [node for node, answered in answers.items() if not answered],
    )


def kill_nodes(node_names: Iterable[str]) -> tuple[list[str], list[str]]:
    """Kill nodes; those of other libraries, such as web pages, may connect again.

    Returns:
        The names of the nodes that were killed, and of the others.

    Raises:
        ROSNodeIOException: the hub cannot be reached.
    """
    killed: list[str] = []
    left: list[str] = []
    for name in node_names:
        with reporting_no_master(ROSNodeIOException):
            answer = rosgraph.Master(ID).ask("kill_node", node=script_resolve_name("rosnode", name))
        (killed if answer["success"] else left).append(name)
    return killed, left


def get_api_uri(master: rosgraph.Master, caller_id: str, skip_cache: bool = False) -> str | None:
    """Return a node's URI, which cannot be used for calls; None if the node is unknown.

    Raises:
        ROSNodeIOException: the hub cannot be reached.
    """
    with reporting_no_master(ROSNodeIOException):
        try:
            return master.lookupNode(caller_id)
        except rosgraph.MasterError:
            return None


def get_node_info_description(node_name: str) -> str:
    """Return a node's topics and services, in the format of ``rosnode info``.

    Raises:
        ROSNodeIOException: the hub cannot be reached.
    """
    master = rosgraph.Master(ID)
    with reporting_no_master(ROSNodeIOException):
        publications, subscriptions, services = master.getSystemState()
        types: dict[str, str] = dict(master.getTopicTypes())
    sections = (
        ("Publications", _typed(publications, node_name, types)),
        ("Subscriptions", _typed(subscriptions, node_name, types)),
        ("Services", sorted(name for name, nodes in services if node_name in nodes)),
    )
    return f"Node [{node_name}]" + "".join(_section(*section) for section in sections)


def _typed(topics: list[Any], node: str, types: dict[str, str]) -> list[str]:
    names = sorted(name for name, nodes in topics if node in nodes)
    return [f"{name} [{types.get(name, 'unknown type')}]" for name in names]


def _section(head: str, lines: list[str]) -> str:
    if not lines:
        return f"\n{head}: None\n"
    listed = "\n".join(f" * {line}" for line in lines)
    return f"\n{head}: \n{listed}\n"
