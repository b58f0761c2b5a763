"""What scripts ask about nodes: who is there, who answers; and who is to end."""

from __future__ import annotations

import sys
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from time import sleep
from typing import Any

import rosgraph
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
"""Seconds in which a node must answer a ping: the hub waits for no longer."""


class ROSNodeException(Exception):
    """The base of what goes wrong here."""


class ROSNodeIOException(ROSNodeException):
    """There is no hub."""


def get_node_names(namespace: str | None = None) -> list[str]:
    """The global names of all nodes, sorted; those without a topic and a service are left out.

    Args:
        namespace: the global namespace that is asked about; else all are.

    Raises:
        ROSNodeIOException: there is no hub.
    """
    with _communicating():
        state = rosgraph.Master(ID).getSystemState()
    found = {node for ends in state for _, nodes in ends for node in nodes}
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
        max_count: how often; else until Ctrl-C.
        verbose: whether what comes of each is printed. That none came always is.
        skip_cache: has no effect: nothing is kept.

    Returns:
        Whether it has answered each time.

    Raises:
        ROSNodeIOException: there is no hub.
    """
    name = script_resolve_name("rosnode", node_name)
    master = rosgraph.Master(ID)
    with _communicating():
        uri = get_api_uri(master, name)
    if uri is None:
        print(f"cannot ping [{name}]: unknown node", file=sys.stderr)
        return False
    if verbose:
        print(f"pinging {name} with a timeout of {PATIENCE}s")
    took: list[float] = []
    try:
        while True:
            with _communicating():
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
        The names of those that have answered, and of those that have not.

    Raises:
        ROSNodeIOException: there is no hub.
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
    """End nodes; those of other libraries, such as web pages, may come back.

    Returns:
        The names of those that were told to end, and of those that were not.

    Raises:
        ROSNodeIOException: there is no hub.
    """
    killed: list[str] = []
    left: list[str] = []
    for name in node_names:
        with _communicating():
            answer = rosgraph.Master(ID).ask("kill_node", node=script_resolve_name("rosnode", name))
        (killed if answer["success"] else left).append(name)
    return killed, left


def get_api_uri(master: rosgraph.Master, caller_id: str, skip_cache: bool = False) -> str | None:
    """The URI of a node, by which nobody can talk to it here; None if there is no such node.

    Raises:
        ROSNodeIOException: there is no hub.
    """
    with _communicating():
        try:
            return master.lookupNode(caller_id)
        except rosgraph.MasterError:
            return None


def get_node_info_description(node_name: str) -> str:
    """What a node publishes, hears and provides, in the lines of ``rosnode info``.

    Raises:
        ROSNodeIOException: there is no hub.
    """
    master = rosgraph.Master(ID)
    with _communicating():
        publications, subscriptions, services = master.getSystemState()
        types: dict[str, str] = dict(master.getTopicTypes())
    sections = (
        ("Publications", _typed(publications, node_name, types)),
        ("Subscriptions", _typed(subscriptions, node_name, types)),
        ("Services", sorted(name for name, nodes in services if node_name in nodes)),
    )
    return f"Node [{node_name}]" + "".join(_section(*section) for section in sections)


def _typed(ends: list[Any], node: str, types: dict[str, str]) -> list[str]:
    topics = sorted(name for name, nodes in ends if node in nodes)
    return [f"{name} [{types.get(name, 'unknown type')}]" for name in topics]


def _section(head: str, lines: list[str]) -> str:
    if not lines:
        return f"\n{head}: None\n"
    listed = "\n".join(f" * {line}" for line in lines)
    return f"\n{head}: \n{listed}\n"


@contextmanager
def _communicating() -> Iterator[None]:
    try:
        yield
    except OSError as error:
        raise ROSNodeIOException(f"Unable to communicate with master! {error}") from None
