"""The port for ROS 1: XML-RPC for master and nodes, and TCPROS, told apart by their first bytes.

One port means one rule in a firewall, and one number to know: 11311, as for roscore.
"""

from __future__ import annotations

import asyncio
import logging
import os
import socket
from collections.abc import Awaitable, Callable, Iterator, Sequence
from contextlib import AsyncExitStack, suppress
from functools import partial
from ipaddress import ip_address
from pathlib import Path
from typing import Any, Protocol, TypeAlias, cast

from fibws.access.rights import Principal
from fibws.errors import SettingError
from fibws.files import state_folder
from fibws.hub.errors import NodeUnreachable, XmlRpcError
from fibws.hub.graph.graph import Graph
from fibws.hub.log.audit import Audit
from fibws.hub.memory.account import Bound, Holding
from fibws.hub.ros1 import api
from fibws.hub.ros1.api import Answer, Method
from fibws.hub.ros1.connection import Acceptor, TcprosConnection
from fibws.hub.ros1.definition_search import DefinitionSearch
from fibws.hub.ros1.http import NodeCalls, XmlRpcCaller, XmlRpcConnection
from fibws.hub.ros1.inlet import TcprosInlet
from fibws.hub.ros1.master import Master, is_loopback
from fibws.hub.ros1.nodes import Ros1Nodes
from fibws.hub.ros1.services import ServiceLinks
from fibws.hub.ros1.slave import Slave
from fibws.hub.ros1.state import StateFile
from fibws.hub.ros1.topic_registrations import CLIENT
from fibws.hub.ros1.topics import TopicLinks
from fibws.hub.settings import Settings
from fibws.origins import OwnHosts, machine_names

logger = logging.getLogger("fibws.hub")

Connection: TypeAlias = "XmlRpcConnection | TcprosConnection"

NODE_PATH = "/node"
"""Where the paths of the hub's nodes begin; a node's global name follows."""
NAME_TIMEOUT = 1.0
"""Seconds that the hub waits at its start for this machine's full name, which DNS may know."""
BODIES = 4
"""A call may have this many times the bytes that all parameters may have: XML has long tags."""


class ConnectionLimits(Protocol):
    """The limits of all of the hub's connections."""

    def admit(self, descriptor: int) -> bool:
        """Return whether a socket that was accepted may stay open."""

    def refuse(self, reason: str) -> None:
        """Count and log a refused connection."""


class Ros1Server:
    """ROS 1's master, nodes and topics on one port.

    Args:
        limits: of the hub's connections.
        principal: whose rights ROS 1 nodes have; None on a hub without authentication.
        kill: ends a client of the hub by the name of its node, for a reason.
        shut_down: ends the hub, for a reason.
        state: the file of the registered nodes; None for none.
    """

    def __init__(
        self,
        graph: Graph,
        settings: Settings,
        audit: Audit,
        *,
        limits: ConnectionLimits,
        principal: Principal | None,
        kill: Callable[[str, str], bool],
        shut_down: Callable[[str], object],
    ) -> None:
        self.port = 0
        """The port that it listens on, once it does."""
        self._graph = graph
        self._settings = settings
        self._audit = audit
        self._limits = limits
        self._networks = settings.ros1_networks
        self._hosts = OwnHosts([])
        self._connections: set[Connection | _Sniffer] = set()
        self._owner = principal.title if principal is not None else ""
        self._calls = NodeCalls(self._failed)
        self.nodes = Ros1Nodes(
            graph,
            self._calls,
            principal=principal,
            quota=lambda: graph.latch_quota(settings.max_latched_bytes),
            port=lambda: self.port,
        )
        """The nodes that are registered."""
        loop = asyncio.get_running_loop()
        self._topics = TopicLinks(graph, self.nodes, self._calls, loop, settings)
        search = DefinitionSearch(settings.interfaces, os.environ)
        self._services = ServiceLinks(graph, self.nodes, settings, search)
        self.nodes.topics.links, self.nodes.service_links = self._topics, self._services
        self._master = Master(graph, self.nodes, self._calls, audit, shut_down)
        self.nodes.gone = self._master.forget
        self._slave = Slave(graph, self.nodes, self._topics, kill, lambda: self.port)
        self._of_hub = self._slave.methods("") | self._master.methods
        self._server: asyncio.Server
        self._end = AsyncExitStack()
        """What ends the parts that have been started, in reverse order."""
        if principal is not None:
            graph.policy.enter(CLIENT, principal, is_chosen=False, is_taken=False)

    def set_principal(self, principal: Principal) -> None:
        """Give ROS 1 nodes the rights of a principal."""
        self._graph.policy.enter(CLIENT, principal, is_chosen=False, is_taken=False)
        self.nodes.set_principal(principal)

    async def start(self) -> None:
        """Listen, and restore the nodes of an earlier hub; raises `HubError`."""
        loop = asyncio.get_running_loop()
        settings = self._settings
        host = None if self._networks else "127.0.0.1"
        self._end.push_async_callback(self._calls.close)
        self._end.callback(self._abort_connections)
        self._end.push_async_callback(self._services.close)
        self._end.push_async_callback(self._topics.close)
        self._end.push_async_callback(self.nodes.close)
        try:
            self._server = server = await loop.create_server(
                lambda: _Sniffer(self), host, settings.ros1 or 0, start_serving=False
            )
        except OSError as error:
            # asyncio's text has the address and its own words before the reason.
            reason = (error.strerror or str(error)).rpartition(": ")[2]
            raise SettingError(
                f"--ros1: cannot listen on port {settings.ros1}: {reason}; a roscore may be running"
            ) from error
        self._end.callback(server.close)
        self.port = server.sockets[0].getsockname()[1]
        self._hosts = OwnHosts([settings.ros1_host, *await own_names()], short=True)
        path = settings.ros1_state or (default_state_file(self.port) if settings.ros1 else None)
        if path is not None:
            state = StateFile(path, self.nodes.saved)
            if settings.ros1_state is not None:
                state.check()
            self._end.enter_context(state.reserved())
            for saved in state.nodes():
                self.nodes.restore(saved)
            self._end.callback(self._forget_state)
            self._end.push_async_callback(state.close)
            self.nodes.changed = state.changed
        await server.start_serving()
        self._end.push_async_callback(
            self._stop_watching, loop.create_task(self.nodes.watch(), name="ROS 1 nodes")
        )
        self._end.callback(server.close)

    async def close(self) -> None:
        """Close all connections; the nodes are left as they are, for the next hub."""
        await self._end.aclose()

    async def _stop_watching(self, watching: asyncio.Task[None]) -> None:
        watching.cancel()
        await asyncio.gather(watching, return_exceptions=True)

    def _forget_state(self) -> None:
        self.nodes.changed = lambda: None

    def _abort_connections(self) -> None:
        for connection in list(self._connections):
            connection.abort()

    def _failed(self, uri: str, error: NodeUnreachable) -> None:
        """Called when a notification has failed; a node that is registered is sent it again."""
        if self.nodes.at(uri):
            self.nodes.set_fault(uri, error.fault)
        else:
            self._master.forget(uri)
            self._calls.forget(uri)

    @property
    def uri(self) -> str:
        """The master's URI for programs on this machine: their ROS_MASTER_URI."""
        return f"http://{self._settings.ros1_host or 'localhost'}:{self.port}/"

    # What is held for ROS 1 nodes.

    def queued(self) -> Iterator[Holding]:
        """Yield what waits for each connection."""
        for each in self._open():
            if each.waiting_bytes:
                yield Holding(
                    self._owner or each.peer,
                    partial(_waiting_bytes, each),
                    shorten=partial(_shorten, each),
                    end=partial(_abort, each),
                )

    def incoming(self) -> Iterator[Holding]:
        """Yield what has come in part."""
        for each in self._open():
            if each.incomplete_bytes:
                yield Holding(
                    self._owner or each.peer,
                    partial(_incomplete_bytes, each),
                    end=partial(_abort, each),
                )
        for inlet in self._topics.inlets():
            if inlet.incomplete_bytes:
                yield Holding(
                    self._owner or inlet.publisher.node.name,
                    partial(_incomplete_bytes, inlet),
                    end=partial(_interrupt, inlet),
                )

    def _open(self) -> Iterator[TcprosConnection | XmlRpcConnection]:
        return (each for each in self._connections if not isinstance(each, _Sniffer))

    # Connections.

    def has_room(self, descriptor: int) -> bool:
        """Return whether one more connection may stay open.

        Args:
            descriptor: that of its socket.
        """
        if len(self._connections) < (most := self._settings.max_connections):
            return self._limits.admit(descriptor)
        self._limits.refuse(
            f"the limit of {most} connections to the ROS 1 port is reached (--max-connections)"
        )
        return False

    def admit(self, host: str) -> bool:
        """Return whether a machine may connect."""
        if is_loopback(host):
            return True
        try:
            address = ip_address(host.partition("%")[0])
        except ValueError:
            return False
        address = getattr(address, "ipv4_mapped", None) or address
        if any(address in network for network in self._networks):
            return True
        text = f"{host} may not use the ROS 1 master: not in --ros1-allow"
        self._audit.refused("address", text, ip=host)
        return False

    def opened(self, connection: Connection | _Sniffer) -> None:
        """Count a connection."""
        self._connections.add(connection)

    def closed(self, connection: Connection | _Sniffer) -> None:
        """Forget a connection."""
        self._connections.discard(connection)

    def speak_http(self) -> XmlRpcConnection:
        """Return the protocol of a connection that begins with an HTTP request."""
        most = BODIES * self._settings.max_parameter_bytes
        return XmlRpcConnection(self._answer, self._page_refusal, most, self.closed)

    def speak_tcpros(self) -> TcprosConnection:
        """Return the protocol of a connection that begins with a TCPROS header."""
        acceptors: dict[str, Acceptor] = {"topic": self._topics, "service": self._services}
        loop, timeout = asyncio.get_running_loop(), self._settings.open_timeout
        return TcprosConnection(acceptors, loop, timeout, self.closed)

    @property
    def open_timeout(self) -> float:
        """Seconds in which the first bytes must arrive."""
        return self._settings.open_timeout

    # Calls.

    def _page_refusal(
        self, origin: str | None, host: str | None, caller: XmlRpcCaller
    ) -> str | None:
        """Return why a request is refused that a web page may have sent."""
        if origin is not None:
            text = f"Web pages may not call the ROS master: this request has the origin {origin}"
        elif host is not None and not self._hosts.has(host):
            name = host.rpartition(":")[0] or host
            text = (
                f"{name} is not known to be a name of this machine. Start the hub with "
                f"--ros1-host {name}, or write its address in ROS_MASTER_URI"
            )
        else:
            return None
        self._audit.refused("origin", text, ip=caller.host)
        return text

    def _answer(self, path: str, name: str, params: list[Any], caller: XmlRpcCaller) -> object:
        methods, host = self._methods(path), self._settings.ros1_host
        if host:
            caller = caller._replace(hub_host=host)

        def call(method: str, arguments: Sequence[Any]) -> Answer | Awaitable[Answer]:
            found = methods.get(method)
            if found is None:
                raise XmlRpcError(f'method "{method}" is not supported')
            return found.call(method, arguments, caller)

        if name == "system.multicall":
            return api.multicall(params, call, BODIES * self._settings.max_parameter_bytes)
        return call(name, params)

    def _methods(self, path: str) -> dict[str, Method]:
        if not path.startswith(f"{NODE_PATH}/"):
            return self._of_hub
        node = path.removeprefix(NODE_PATH)
        if not self._slave.has(node):
            raise XmlRpcError(f"unknown node [{node}]")
        return self._slave.methods(node)


class _Sniffer(asyncio.Protocol):
    """A connection whose protocol is not known yet."""

    def __init__(self, server: Ros1Server) -> None:
        self._server = server
        self._received = b""

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        # Not checked: uvloop's transports are not subclasses of asyncio's.
        self._transport = transport = cast(asyncio.Transport, transport)
        self._timer = asyncio.get_running_loop().call_later(
            self._server.open_timeout, transport.abort
        )
        peer = transport.get_extra_info("peername")
        descriptor = transport.get_extra_info("socket").fileno()
        if not (self._server.has_room(descriptor) and self._server.admit(peer[0] if peer else "")):
            transport.abort()
        self._server.opened(self)

    def data_received(self, data: bytes) -> None:
        self._received += data
        if len(self._received) < 4:
            return
        # The length of a header is less than 2**24, and a request begins with four letters.
        is_http = self._received[3] != 0
        server = self._server
        protocol = server.speak_http() if is_http else server.speak_tcpros()
        self._end()
        server.opened(protocol)
        self._transport.set_protocol(protocol)
        protocol.connection_made(self._transport)
        protocol.data_received(self._received)

    def connection_lost(self, error: Exception | None) -> None:
        self._end()

    def abort(self) -> None:
        self._transport.abort()

    def _end(self) -> None:
        self._timer.cancel()
        self._server.closed(self)


async def own_names() -> set[str]:
    """Return the names of this machine, with its full one if that is found in time."""
    name = socket.gethostname()
    found = machine_names(name)
    with suppress(OSError, UnicodeError, TimeoutError):
        async with asyncio.timeout(NAME_TIMEOUT):
            loop = asyncio.get_running_loop()
            addresses = await loop.getaddrinfo(name, None, flags=socket.AI_CANONNAME)
            found |= {canonical.lower() for *_, canonical, _ in addresses if canonical}
    return found


def default_state_file(port: int) -> Path:
    """Return the state file of a port."""
    return state_folder() / f"ros1-{port}.json"


def _waiting_bytes(connection: Connection) -> int:
    return connection.waiting_bytes


def _incomplete_bytes(holder: Connection | TcprosInlet) -> int:
    return holder.incomplete_bytes


def _shorten(connection: Connection, size: int, least: int, bound: Bound) -> None:
    connection.shorten(size, least)


def _abort(connection: Connection, bound: Bound) -> None:
    connection.abort()


def _interrupt(inlet: TcprosInlet, bound: Bound) -> None:
    inlet.interrupt()
