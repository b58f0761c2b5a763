"""Protocols read the graph through a view of whoever is answered."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from pathlib import Path

import fibws.hub

HUB = Path(fibws.hub.__file__).parent
PROTOCOLS = ("rosapi", "foxglove", "rosbridge", "ros1", "ros2", "federation")
OF_GRAPH = {"topics", "nodes", "services", "actions"}
OF_TOPIC = {
    "sources",
    "publishers",
    "sinks",
    "all_sinks",
    "has_sinks",
    "subscribers",
    "all_subscribers",
    "groups",
    "nodes",
    "unattached",
}
OF_PARAMETERS = {"names", "text", "below", "leaves", "has", "search"}

OWN = "what nodes of its own, or of the foreign graph, use; nobody is answered"
KEYS = "names to look at: a view decides of each"
DIRECT = {
    "rosapi/nodes.py": "the hub's own nodes remove what is theirs",
    "rosapi/clients.py": "whether anybody hears one of the hub's own topics",
    "foxglove/session.py": KEYS,
    "foxglove/feeds.py": "descriptions of services, made once for all: the feeds ask the right",
    "rosbridge/actions.py": "who has taken a server's place: a node of the same principal",
    "rosbridge/services.py": "who has taken a server's place: a node of the same principal",
    "ros1/nodes.py": OWN,
    "ros1/outlet.py": OWN,
    "ros1/topic_registrations.py": f"{OWN}; the hub's address is given if the right is there",
    "ros1/topics.py": OWN,
    "ros2/nodes.py": OWN,
    "ros2/own_nodes.py": "is asked for nodes that use what ROS 2 may use",
    "ros2/services.py": "asks the right to call before it shows a service",
    "ros2/topics.py": "asks the rights before it shows the users; leaves the log out",
    "federation/offers.py": f"{KEYS}; which of the users have changed",
    "federation/federation.py": OWN,
    "federation/outlets.py": OWN,
    "federation/remote.py": OWN,
    "federation/remote_logs.py": OWN,
    "federation/remote_nodes.py": OWN,
    "federation/remote_services.py": OWN,
    "federation/remote_topics.py": OWN,
    "federation/shared_parameters.py": "records of parameters: the offers ask the right to read",
}
"""The modules that read the graph past the views, and why nobody learns hidden names by that."""


def reads(path: Path) -> Iterator[str]:
    """Yield what a module reads of a graph, of a topic or of the parameters without a view."""
    for node in ast.walk(ast.parse(path.read_text("utf-8"))):
        if not isinstance(node, ast.Attribute):
            continue
        value = node.value
        owner = getattr(value, "attr", getattr(value, "id", ""))
        is_read = (
            (node.attr in OF_GRAPH and owner in ("graph", "_graph"))
            or (
                node.attr in OF_TOPIC
                and owner in ("topic", "group", "found", "status", "aggregated")
            )
            or (node.attr in OF_PARAMETERS and owner in ("parameters", "_parameters"))
        )
        if is_read:
            yield ast.unparse(node)


def modules() -> dict[str, Path]:
    found = (path for name in PROTOCOLS for path in sorted((HUB / name).glob("*.py")))
    return {path.relative_to(HUB).as_posix(): path for path in found}


def test_protocols_read_the_graph_through_views() -> None:
    found = {name: sorted(set(reads(path))) for name, path in modules().items()}
    assert {name: each for name, each in found.items() if each and name not in DIRECT} == {}


def test_each_exception_is_needed() -> None:
    found = modules()
    assert {name for name in DIRECT if not any(reads(found[name]))} == set()


def test_types_are_looked_up_for_somebody() -> None:
    """A type that a client has brought is unknown to those who see nothing that has it."""
    for path in sorted(HUB.glob("**/*.py")):
        for node in ast.walk(ast.parse(path.read_text("utf-8"))):
            is_lookup = isinstance(node, ast.Attribute) and node.attr in ("known", "message")
            if is_lookup:
                assert isinstance(node, ast.Attribute)
                of = ast.unparse(node.value)
                assert not of.endswith("graph.definitions"), f"{path}: {of}.{node.attr}"
