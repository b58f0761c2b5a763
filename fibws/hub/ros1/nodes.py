"""The ROS 1 nodes that have registered at the hub's master, as nodes of the graph.

A node's name and address, whether it still runs, and what a later hub needs to know about it. What
nodes publish and subscribe to is in `fibws.hub.ros1.topic_registrations`.
"""

from __future__ import annotations

import asyncio
import errno
import logging
import os
import sys
from collections.abc import Callable, Coroutine, Iterable, Iterator, Mapping
from contextlib import suppress
from functools import partial
from itertools import chain
from socket import gethostname
from typing import Any, NamedTuple, Protocol
from urllib.parse import urlsplit

from fibws.access.rights import Principal
from fibws.hub.errors import NodeUnreachable, NotAllowed, Ros1Error
from fibws.hub.foreign.worklist import Worklist
from fibws.hub.graph.graph import Graph
from fibws.hub.graph.latched import LatchQuota
from fibws.hub.graph.service import InternalServer
from fibws.hub.ros1.http import NodeCalls
from fibws.hub.ros1.topic_registrations import MASTER, Registrant, TopicRegistrations

logger = logging.getLogger("fibws.hub")

CHECK_INTERVAL = 10.0
"""Seconds between two checks of a node that is reachable."""
CHECKS_AT_ONCE = 10
"""Nodes that are checked in a second at most."""


class RegisteredServices(Protocol):
    """The connections by which ROS 1 nodes' services are called."""

    def register(self, node: Ros1Node, service: str, uri: str) -> None:
        """Add a service of a ROS 1 node to the graph."""

    def unregister(self, node: Ros1Node, service: str) -> None:
        """Remove it."""

    def withdraw_forbidden(self) -> Iterator[None]:
        """End, one by one, the calls of ROS 1 clients that their rights do not allow any more."""


class SavedNode(NamedTuple):
    """A node and its registrations, for a hub that starts later."""

    name: str
    api: str
    hub_host: str
    pid: int | None
    publishers: Mapping[str, str]
    """Topics with their types, as with the subscribers."""
    subscribers: Mapping[str, str]
    services: Mapping[str, str]
    """Services with their URIs."""


class Ros1Node(Registrant):
    """A ROS 1 node; a `GraphNode` of the graph.

    Args:
        name: its global name.
        api: the URI of its XML-RPC server.
        hub_host: the address by which it reached the hub.
        since: when it registered, in nanoseconds since 1970.

    Attributes:
        pid: its process id; None while unknown.
        served: the URIs of its services, by their names.
    """

    def __init__(self, name: str, api: str, hub_host: str, since: int, nodes: Ros1Nodes) -> None:
        super().__init__(name, since, nodes.replaced)
        self.api = api
        self.hub_host = hub_host
        self.pid: int | None = None
        self.served: dict[str, str]
        self.fault = ""
        self._nodes = nodes

    @property
    def is_empty(self) -> bool:
        """Whether it has no registration left."""
        return not (self.published or self.subscribed or self.served)

    def ping(self, done: Callable[[str], object]) -> Callable[[], object]:
        """Ask whether it answers; see `ExternalNode`."""
        return self._nodes.run(self._nodes.ping(self), done)

    def shut_down(self, reason: str, done: Callable[[str], object]) -> Callable[[], object]:
        """Ask it to end; see `ExternalNode`."""
        return self._nodes.run(self._nodes.shut_down(self, reason), done)

    def unregister(self) -> None:
        """Remove it; see `ExternalNode`."""
        self._nodes.remove(self)


class Ros1Nodes:
    """All ROS 1 nodes of the hub's master.

    Args:
        principal: whose rights they have; None on a hub without authentication.
        quota: returns the bound of a node's latched messages.
        port: returns the port of the hub's master.

    Attributes:
        by_name: the nodes.
        service_links: set before the first node registers, as are the links of `topics`.
        changed: called after each change of what the state file holds.
    """

    def __init__(
        self,
        graph: Graph,
        calls: NodeCalls,
        *,
        principal: Principal | None,
        quota: Callable[[], LatchQuota],
        port: Callable[[], int],
    ) -> None:
        self.by_name: dict[str, Ros1Node] = {}
        self.service_links: RegisteredServices
        self.changed: Callable[[], object] = lambda: None
        self.principal = principal
        self._graph = graph
        self._calls = calls
        self.topics = TopicRegistrations(
            graph, calls, self.by_name, quota=quota, port=port, changed=lambda: self.changed()
        )
        """Their publishers and subscribers."""
        self._services: dict[str, Ros1Node] = {}
        self._left = Worklist[str](lambda run: asyncio.get_running_loop().call_soon(run), {})
        """What is still to be removed of nodes that are gone."""
        self._tasks: set[asyncio.Task[None]] = set()
        self.gone: Callable[[str], object] = lambda api: None
        """Called with an address at which no node is registered any more."""

    # Looking up.

    def service(self, name: str) -> tuple[Ros1Node, str] | None:
        """Return the node of a service, and the service's URI."""
        node = self._services.get(name)
        return None if node is None or not self._is_there(node) else (node, node.served[name])

    def services(self) -> Iterable[tuple[str, Ros1Node]]:
        """Yield all services with their nodes."""
        return (each for each in self._services.items() if self._is_there(each[1]))

    def _is_there(self, node: Ros1Node) -> bool:
        """Return whether a node has not left, though not all of it is removed yet."""
        return self.by_name.get(node.name) is node

    # Registering.

    def add_publisher(self, name: str, topic: str, type_: str, api: str, hub_host: str) -> bool:
        """Register a publisher; return whether the node may have its name."""
        node = self._enter(name, api, hub_host)
        if node is not None:
            self.topics.add_publisher(node, topic, type_)
        return node is not None

    def add_subscriber(self, name: str, topic: str, type_: str, api: str, hub_host: str) -> bool:
        """Register a subscriber; return whether the node may have its name."""
        node = self._enter(name, api, hub_host)
        if node is not None:
            self.topics.add_subscriber(node, topic, type_)
        return node is not None

    def add_service(self, name: str, service: str, uri: str, api: str, hub_host: str) -> bool:
        """Register a service, which another node may have had before; return whether it may."""
        present = self._graph.services.get(service)
        if present is not None and isinstance(present.server, InternalServer):
            logger.warning("%s cannot serve %s, which is the hub's own.", name, service)
            return False
        node = self._enter(name, api, hub_host)
        if node is None:
            return False
        older = self._services.get(service)
        if older is not None and (older is not node or node.served[service] != uri):
            self.remove_service(service, older.served[service])
            node = self._enter(name, api, hub_host) or node  # It may have been its last one.
        node.served[service] = uri
        self._services[service] = node
        self.service_links.register(node, service, uri)
        self.changed()
        return True

    def remove_publisher(self, name: str, topic: str, api: str) -> bool:
        """Remove a registration; return whether it was there."""
        node = self.by_name.get(name)
        if node is None or node.api != api or topic not in node.published:
            return False
        self.topics.remove_publisher(node.published[topic])
        self._settle(node)
        return True

    def remove_subscriber(self, name: str, topic: str, api: str) -> bool:
        """Remove a registration; return whether it was there."""
        node = self.by_name.get(name)
        if node is None or node.api != api or topic not in node.subscribed:
            return False
        self.topics.remove_subscriber(node.subscribed[topic])
        self._settle(node)
        return True

    def remove_service(self, service: str, uri: str) -> bool:
        """Remove a service, unless another URI has taken its place; return whether it was there."""
        node = self._services.get(service)
        if node is None or node.served[service] != uri:
            return False
        self._remove_service(node, service)
        self._settle(node)
        return True

    def service_displaced(self, service: str) -> None:
        """Forget a service that a client of the hub has taken over."""
        node = self._services.pop(service, None)
        if node is not None:
            del node.served[service]
            self._settle(node)

    def remove(self, node: Ros1Node) -> None:
        """Remove a node that is gone, with all its registrations."""
        self._drop(node)
        self._graph.leave(node, node.name)

    def set_fault(self, api: str, fault: str) -> None:
        """Set why the nodes at an address do not answer; empty if they do."""
        for node in self.by_name.values():
            if node.api == api and node.fault != fault:
                if bool(node.fault) != bool(fault):
                    state = f"is unreachable at {api}: {fault}" if fault else "is reachable again"
                    logger.warning("%s %s.", node.name, state)
                node.fault = fault
                self._graph.revision += 1

    # Names.

    def set_principal(self, principal: Principal) -> None:
        """Give the nodes the rights of a principal instead of those that they had."""
        self.principal = principal
        self._graph.revision += 1
        for node in self.by_name.values():
            self._graph.policy.enter(node.name, principal, is_chosen=False, is_taken=False)
        self._start(self._apply_rights())

    async def _apply_rights(self) -> None:
        """Attach what the nodes may use now, and detach what they may not, in slices."""
        graph = self._graph
        for _ in self.service_links.withdraw_forbidden():
            await asyncio.sleep(0)
        for node in list(self.by_name.values()):
            await asyncio.sleep(0)
            if self.by_name.get(node.name) is not node:
                continue
            self.topics.apply_rights(node)
            for service, uri in node.served.items():
                if not graph.rights.allows(node.name, "provide", service):
                    self.service_links.unregister(node, service)
                self.service_links.register(node, service, uri)

    def replaced(self, node: Ros1Node) -> None:
        """Remove a node whose name another one has taken, and end its process."""
        self._drop(node)
        self._start(self._end(node, f"[{node.name}] Reason: new node registered with same name"))

    async def shut_down(self, node: Ros1Node, reason: str) -> None:
        """Ask a node to end; raises `Ros1Error` if it does not answer."""
        await self._calls.call(node.api, "shutdown", MASTER, reason)

    async def _end(self, node: Ros1Node, reason: str) -> None:
        """End a node's process, unless another process has its address by now."""
        try:
            pid = await self._calls.call(node.api, "getPid", MASTER)
            is_known = node.pid is not None
            if (is_known and pid != node.pid) or (not is_known and self.at(node.api)):
                return
            await self.shut_down(node, reason)
        except Ros1Error as error:
            logger.info("%s, which was replaced, did not end: %s.", node.name, error)

    def at(self, api: str) -> list[Ros1Node]:
        """Return the nodes at an address; a process may have several."""
        return [each for each in self.by_name.values() if each.api == api]

    def _enter(self, name: str, api: str, hub_host: str) -> Ros1Node | None:
        """Return the node of this name and address, which may be new; None if it may not be."""
        node = self.by_name.get(name)
        if node is not None and node.api == api:
            node.hub_host = hub_host
            return node
        node = Ros1Node(name, api, hub_host, self._graph.now(), self)
        try:
            self._graph.enter(node, name, self.principal)
        except NotAllowed as error:
            logger.warning("%s at %s may not register: %s.", name, api, error)
            return None
        self.by_name[name] = node
        self._start(self._identify(node))
        return node

    async def _identify(self, node: Ros1Node) -> None:
        """Get a node's process, and remove nodes that had its address before."""
        with suppress(Ros1Error):
            await self.ping(node)

    async def ping(self, node: Registrant) -> None:
        """Get the process that answers at a node's address; raises `Ros1Error`."""
        try:
            pid = await self._calls.call(node.api, "getPid", MASTER)
        except Ros1Error as error:
            self.set_fault(node.api, _fault(error))
            raise
        self._set_pid(node, pid)

    def restore(self, saved: SavedNode) -> None:
        """Register a node that was registered at an earlier hub, and ask it what it has now.

        It stays registered if it does not answer, unless another process has its address.
        """
        node = self._enter(saved.name, saved.api, saved.hub_host)
        if node is None:
            return
        node.pid = saved.pid
        for topic, type_ in saved.publishers.items():
            self.add_publisher(node.name, topic, type_, node.api, node.hub_host)
        for topic, type_ in saved.subscribers.items():
            self.add_subscriber(node.name, topic, type_, node.api, node.hub_host)
        for service, uri in saved.services.items():
            self.add_service(node.name, service, uri, node.api, node.hub_host)
        self._start(self._compare(node))

    def saved(self) -> list[SavedNode]:
        """Return all nodes as `restore` takes them."""
        return [
            SavedNode(
                node.name,
                node.api,
                node.hub_host,
                node.pid,
                {topic: each.type for topic, each in node.published.items()},
                {topic: each.type for topic, each in node.subscribed.items()},
                dict(node.served),
            )
            for node in self.by_name.values()
        ]

    async def _compare(self, node: Ros1Node) -> None:
        """Bring a node's registrations in line with its own lists."""
        name, api, host = node.name, node.api, node.hub_host
        try:
            publications = dict(await self._calls.call(api, "getPublications", MASTER))
            subscriptions = dict(await self._calls.call(api, "getSubscriptions", MASTER))
        except (Ros1Error, TypeError, ValueError) as error:
            logger.info("%s keeps its registrations unchanged: %s.", name, error)
            return
        if self.by_name.get(name) is not node:
            return
        for topic, type_ in publications.items():
            self.add_publisher(name, str(topic), str(type_), api, host)
        for topic, type_ in subscriptions.items():
            self.add_subscriber(name, str(topic), str(type_), api, host)
        for topic in node.published.keys() - publications.keys():
            self.remove_publisher(name, topic, api)
        for topic in node.subscribed.keys() - subscriptions.keys():
            self.remove_subscriber(name, topic, api)

    def _set_pid(self, registrant: Registrant, pid: object) -> None:
        """Set the process that answers at a node's address."""
        if not isinstance(pid, int) or not 0 < pid < 2**31:
            pid = None  # Invalid, but the node is reachable.
        node = self.by_name.get(registrant.name)
        if node is None or node is not registrant:
            return
        self.set_fault(node.api, "")
        for each in self.at(node.api):
            if pid is not None and each.pid not in (None, pid):
                logger.info("%s is gone: another process has its address.", each.name)
                self.remove(each)
        if node.pid is None and pid is not None:
            node.pid = pid
            self.changed()

    # Checking that nodes are alive.

    async def watch(self) -> None:
        """Check periodically whether the nodes answer."""
        refused: dict[Ros1Node, int] = {}
        while True:
            nodes = list(self.by_name.values())
            pause = max(1 / CHECKS_AT_ONCE, CHECK_INTERVAL / max(1, len(nodes)))
            for node in nodes:
                await asyncio.sleep(pause)
                if self.by_name.get(node.name) is node:
                    try:
                        await self._check(node, refused)
                    except Exception:
                        logger.exception("%s could not be checked.", node.name)
            refused = {node: times for node, times in refused.items() if node in nodes}
            if not nodes:
                await asyncio.sleep(CHECK_INTERVAL)

    async def _check(self, node: Ros1Node, refused: dict[Ros1Node, int]) -> None:
        """Check a node; remove it once it is certain that its process is gone."""
        try:
            await self.ping(node)
            refused.pop(node, None)
        except NodeUnreachable as error:
            is_refused = error.fault == os.strerror(errno.ECONNREFUSED)
            refused[node] = refused.get(node, 0) + 1 if is_refused else 0
            if refused[node] > 1 and self.by_name.get(node.name) is node and _has_ended(node):
                logger.info("%s is gone: its process has ended.", node.name)
                self.remove(node)
        except Ros1Error:
            pass  # It answers, if only with an error.

    # Removing.

    def _remove_service(self, node: Ros1Node, service: str) -> None:
        if node.served.pop(service, None) is None:
            return  # Another node has taken it meanwhile.
        self._services.pop(service, None)
        self.service_links.unregister(node, service)
        self.changed()

    def _settle(self, node: Ros1Node) -> None:
        """Remove a node without registrations, as ROS's master does."""
        if node.is_empty and self.by_name.get(node.name) is node:
            self.remove(node)

    def _drop(self, node: Ros1Node) -> None:
        """Forget a node, and remove its registrations, in slices if they are many."""
        removals: Iterator[Callable[[], None]] = chain(
            self.topics.removals(node),
            (partial(self._remove_service, node, service) for service in list(node.served)),
        )
        services = [self._graph.services.get(service) for service in node.served]
        self._graph.abandon(each for each in services if each and each.node == node.name)
        if self._is_there(node):
            del self.by_name[node.name]
        self._left.add_steps(map(_call, removals), at_once=True)
        if not self.at(node.api):
            self._calls.forget(node.api)
            self.gone(node.api)
        self.changed()

    def run(
        self, coroutine: Coroutine[Any, Any, None], done: Callable[[str], object]
    ) -> Callable[[], object]:
        """Run a coroutine, and call ``done`` with the text of its `Ros1Error`, or an empty one.

        Returns:
            A function that cancels it; ``done`` is not called then.
        """

        async def run() -> None:
            try:
                await coroutine
            except Ros1Error as error:
                done(str(error))
            else:
                done("")

        return self._start(run()).cancel

    def _start(self, coroutine: Coroutine[Any, Any, None]) -> asyncio.Task[None]:
        task = asyncio.get_running_loop().create_task(coroutine)
        self._tasks.add(task)
        task.add_done_callback(self._tasks.discard)
        return task

    async def close(self) -> None:
        """Remove the nodes from the graph; the next hub finds them by the state file."""
        self.topics.close()
        for node in list(self.by_name.values()):
            self.remove(node)
        self._left.finish()
        tasks = list(self._tasks)
        for task in tasks:
            task.cancel()
        await asyncio.gather(*tasks, return_exceptions=True)


def is_api(uri: str) -> bool:
    """Return whether a URI can be that of a node's XML-RPC server."""
    try:
        url = urlsplit(uri)
        return url.scheme == "http" and bool(url.hostname) and url.port is not None
    except ValueError:
        return False


def _call(function: Callable[[], None]) -> None:
    """Call a function; that it fails does not end `map`, as it would a generator."""
    function()


def _fault(error: Ros1Error) -> str:
    return error.fault if isinstance(error, NodeUnreachable) else str(error)


def _has_ended(node: Ros1Node) -> bool:
    """Return whether a node ran on this machine and its process has ended."""
    host = urlsplit(node.api).hostname
    if node.pid is None or host not in (node.hub_host, "localhost", "127.0.0.1", gethostname()):
        return False
    if sys.platform == "win32":
        return False  # There, this signal is Ctrl-C, and ends the process.
    try:
        os.kill(node.pid, 0)
    except ProcessLookupError:
        return True
    except OSError:
        return False
    return False
