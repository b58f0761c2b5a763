"""Checks of the hub as the master of ROS 1 nodes: whether they and it reach each other."""

from __future__ import annotations

import os
import socket
from collections import defaultdict
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from http.client import HTTPConnection, HTTPException
from typing import Any
from urllib.parse import urlsplit
from xmlrpc.client import Error as XmlRpcError
from xmlrpc.client import ServerProxy, Transport

from fibws import hub_address
from fibws.cli.doctor.finding import Finding, join_names, ok, warning, wrong
from fibws.cli.output import counted
from fibws.client.graph_snapshot import Entry
from fibws.command_names import command_name

VARIABLE = "ROS_MASTER_URI"
PORT = 11311
"""The port of ROS's master."""
DEFAULT = f"http://localhost:{PORT}/"
"""Where rospy looks for the master without the variable."""
CALLER = "/fibws_doctor"
PATIENCE = 2.0
"""Seconds to wait for an answer."""
CALLS_AT_ONCE = 16
MAX_CALLED = 100
"""Nodes that are asked whether they answer here."""
DIRECTLY = "ROS 1 nodes connect to each other directly, at the addresses that they register."
SET_HOST = (
    "set ROS_IP or ROS_HOSTNAME at its machine to an address that others reach, and restart it"
)


def checks(graph: dict[str, Any], hub: str, run_id: str, port: int | None) -> Iterator[Finding]:
    """Yield the findings; none if nobody uses ROS 1.

    Args:
        graph: the response of /rosapi/graph.
        hub: the hub's URL.
        run_id: the hub's parameter of this name, by which its master is recognized.
        port: the port of its master; None if it has none, or does not show it.
    """
    nodes = [each for each in graph["nodes"] if each["api"]]
    yield from master(hub, run_id, port, has_nodes=bool(nodes))
    if nodes:
        host = urlsplit(hub).hostname or ""
        yield from reachability(nodes, is_hub_here=hub_address.is_loopback(host))


def master(hub: str, run_id: str, port: int | None, *, has_nodes: bool) -> Iterator[Finding]:
    """Check whether ROS 1 nodes that start in this shell find the hub's master."""
    given = os.environ.get(VARIABLE, "")
    uri, source = given or DEFAULT, f"{VARIABLE}={given}" if given else f"{VARIABLE} is not set"
    is_master = port is not None or has_nodes
    if not given and not is_master:
        return
    try:
        found = _run_id(uri)
    except (OSError, ValueError) as error:
        cause = f"no ROS 1 master answers at {uri}: {_text(error)}"
    else:
        if found == run_id:
            needed = "" if given else f"; nodes of roscpp need: export {VARIABLE}={uri}"
            yield ok("master", f"{uri} is this hub's ROS 1 master{needed}")
            return
        cause = f"the ROS 1 master at {uri} is not this hub"
    text = f"{source}, and {cause}" if given else f"{source}: {cause}"
    yield warning("master", text, _advice(hub, run_id, port, is_master=is_master))


def _advice(hub: str, run_id: str, port: int | None, *, is_master: bool) -> str:
    """Return how a shell finds the hub's master, as far as it can be found out."""
    host = urlsplit(hub).hostname or ""
    is_here = hub_address.is_loopback(host)
    host = "localhost" if is_here else f"[{host}]" if ":" in host else host
    uri = f"http://{host}:{port or PORT}/"
    try:
        if _run_id(uri) == run_id:
            return f"For the hub's graph: export {VARIABLE}={uri}"
        fault, first = "another master answers", "Stop that master, and start"
    except (OSError, ValueError) as error:
        fault, first = _text(error), "Start"
    if not is_master:
        return f"{first} the hub with --ros1 {PORT}, as {command_name('core')} does."
    if is_here:
        return f"The hub has printed its {VARIABLE} when it started."
    return (
        f"The hub's master is not reached at {uri} ({fault}). Start the hub with --ros1-allow "
        "and the address of this machine."
    )


def reachability(nodes: list[Entry], *, is_hub_here: bool) -> Iterator[Finding]:
    """Find nodes that do not answer, at the hub or here, and hosts that do not resolve here."""
    unresolved: defaultdict[str, list[str]] = defaultdict(list)
    found: list[Finding] = []
    with ThreadPoolExecutor(CALLS_AT_ONCE) as pool:
        errors = list(pool.map(partial(_trial, is_hub_here=is_hub_here), nodes[:MAX_CALLED]))
    for node, error in zip(nodes, errors, strict=False):
        name, api = node["name"], node["api"]
        if isinstance(error, socket.gaierror):
            unresolved[urlsplit(api).hostname or ""].append(name)
        elif isinstance(error, _OtherMachine):
            text = f"{name} has registered {api}, whose host is a loopback address on this machine"
            found.append(wrong("ros1 nodes", text, f"{DIRECTLY} To fix it, {SET_HOST}."))
        elif node["fault"]:
            text = f"{name} does not answer the hub at {api}: {node['fault']}"
            advice = f"If it has ended: {command_name('node cleanup')}. If it runs: {SET_HOST}."
            found.append(warning("ros1 nodes", text, advice))
        elif error is not None:
            text = f"{name} answers the hub, but not this machine, at {api}: {_text(error)}"
            advice = f"{DIRECTLY} Is there a firewall, a container or NAT between? Else {SET_HOST}."
            found.append(wrong("ros1 nodes", text, advice))
    for host, names in unresolved.items():
        text = f"The host {host} of {join_names(names)} does not resolve on this machine"
        advice = f"{DIRECTLY} Add {host} to /etc/hosts or DNS here. Or {SET_HOST}."
        found.append(wrong("ros1 nodes", text, advice.replace("its machine", "that machine")))
    number = counted(min(len(nodes), MAX_CALLED), "ROS 1 node")
    yield from found or [ok("ros1 nodes", f"{number}: the hub and this machine reach all")]


class _OtherMachine(Exception):
    """The address is this machine's own, and the node runs on another one."""


def _trial(node: Entry, *, is_hub_here: bool) -> Exception | None:
    """Return why a node does not answer here; None if it does."""
    try:
        host = urlsplit(node["api"]).hostname or ""
        addresses = {str(each[4][0]) for each in socket.getaddrinfo(host, None)}
        if not is_hub_here and all(map(hub_address.is_loopback, addresses)):
            return _OtherMachine()
        _call(node["api"], "getPid", CALLER)
    except (OSError, ValueError) as error:
        return error
    return None


def _run_id(uri: str) -> object:
    """Return the run_id of the graph of a master; raises `OSError` or `ValueError`."""
    return _call(uri, "getParam", CALLER, "/run_id")


def _call(uri: str, method: str, *arguments: object) -> object:
    """Call a method of a ROS 1 node or master; raises `OSError`, or `ValueError` for its answer."""
    if urlsplit(uri).scheme != "http":
        raise ValueError(f"expected http://HOST:PORT/, got {uri}")
    with ServerProxy(uri, _Transport()) as server:
        try:
            answer: Any = getattr(server, method)(*arguments)
        except (XmlRpcError, HTTPException) as error:
            raise ValueError(f"unexpected answer: {error}") from error
    if not isinstance(answer, list) or len(answer) != 3:
        raise ValueError("unexpected answer: not one of ROS")
    return answer[2]


class _Transport(Transport):
    """A transport that ends a call without an answer after some time."""

    def make_connection(self, host: Any) -> HTTPConnection:
        connection = super().make_connection(host)
        connection.timeout = PATIENCE
        return connection


def _text(error: Exception) -> str:
    return (error.strerror if isinstance(error, OSError) else None) or str(error)
