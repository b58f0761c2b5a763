"""Services across both worlds: those of ROS 2 nodes for the graph, and the reverse."""

from __future__ import annotations

import logging
import os
import time
from collections.abc import Callable
from functools import partial

from fibws.errors import FibwsError, InterfaceError
from fibws.hub.delivery.clock import Loop
from fibws.hub.errors import UnknownDefinition
from fibws.hub.foreign.worklist import Worklist
from fibws.hub.graph.body import Body
from fibws.hub.graph.graph import Graph
from fibws.hub.graph.service import Call, InternalServer, Service
from fibws.hub.graph.types import read_values
from fibws.hub.log.text import printable
from fibws.hub.ros2.key_layout import GID_SIZE, NO_HASH, Attachment, Entity, Qos, data_key
from fibws.hub.ros2.network import Declared, Ros2Network
from fibws.hub.ros2.nodes import CLIENT, Ros2Node, Ros2Nodes
from fibws.hub.ros2.own_nodes import OwnEntity, Ros2Tokens
from fibws.hub.ros2.types import Ros2Service, Ros2Types, check_hash

logger = logging.getLogger("fibws.hub")

CALL_TIMEOUT = 24 * 3600.0
"""Seconds, which zenoh needs to know; the hub ends calls much earlier."""
MOST_REQUESTS = 1000
"""Calls of ROS 2 clients that may wait for a response at once."""
MOST_CLIENTS = 100
"""Callers of a service that ROS 2 sees as its clients."""
SERVICE_QOS = Qos(depth=10)


class Ros2Server:
    """A service of a ROS 2 node, which the graph calls; a `ServiceServer`.

    Attributes:
        type: the name and the hash of its type.
        service: the service of the graph; None while it cannot be attached.
        is_refused: whether it can never be attached.
    """

    def __init__(self, owner: Ros2Node, entity: Entity, services: Ros2Services) -> None:
        self.owner = owner
        self.node = owner.name
        self.name = entity.name
        self.type = entity.type, entity.type_hash
        self.service: Service | None = None
        self.is_refused = False
        self._services = services
        self._open: dict[Call, Callable[[], None]] = {}
        self._clients: dict[str, OwnEntity] = {}
        """The service clients that ROS 2 sees for callers, by node."""
        self._gid = os.urandom(GID_SIZE)
        self._sequence = 0
        network = services.network
        key = data_key(network.domain, self.name, "srv", *self.type)
        self._client = network.declare_client(key, CALL_TIMEOUT)

    def handle(self, call: Call) -> None:
        """Pass a call to the node."""
        network, type_ = self._services.network, call.service.type
        try:
            service = self._services.ros2_type(call.service)
            if type_.codecs is None or service is None:
                raise UnknownDefinition(type_.name, type_.fault)
            _, back = type_.codecs.service_serializers(type_.name)
            request = call.request.ros1()
        except FibwsError as error:
            call.fail(str(error), error.code)
            return
        self._sequence += 1
        attachment = Attachment(self._sequence, time.time_ns(), self._gid_of(call.caller)).pack()
        convert = service.request.to_cdr

        def responded(data: bytearray | None, error: str) -> None:
            if self._open.pop(call, None) is None:
                return
            if data is None:
                call.fail(f"Service {self.name} of ROS 2 node {self.node} failed: {error}")
                return
            try:
                call.respond(read_values(back, data, "strict"))
            except FibwsError as found:
                call.fail(f"Service {self.name} returned an invalid response: {found}")

        self._open[call] = network.call(
            self._client,
            lambda: (convert(request), attachment),
            service.response.from_cdr,
            responded,
        )

    def cancel(self, call: Call) -> None:
        """Forget a call, which needs no response any more."""
        cancel = self._open.pop(call, None)
        if cancel is not None:
            cancel()

    def displaced(self, service: Service) -> None:
        """Called when another server has the service; calls that wait may still be answered."""
        self.service = None

    def close(self) -> None:
        """Fail the calls that wait, as the node has left."""
        for call, cancel in list(self._open.items()):
            del self._open[call]
            cancel()
            call.fail(f"Service {self.name}: the ROS 2 node {self.node} has left", "server_lost")
        for client in self._clients.values():
            client.close()
        self._clients.clear()
        self._client.close()

    def forget(self, caller: str) -> None:
        """Stop showing a caller that has left."""
        client = self._clients.pop(caller, None)
        if client is not None:
            client.close()

    def _gid_of(self, caller: str) -> bytes:
        """Return the gid of a caller; show it to ROS 2 unless that sees it already."""
        own = self._services.own
        if caller not in self._clients and own.is_shown(caller):
            if len(self._clients) < MOST_CLIENTS:
                self._clients[caller] = own.declare(
                    "SC", caller, self.name, *self.type, SERVICE_QOS
                )
        client = self._clients.get(caller)
        return client.gid if client is not None else self._gid


class OwnService:
    """A service of this hub as ROS 2 sees it.

    Attributes:
        declared: what takes requests, by the hash in the key.
    """

    def __init__(self, service: Service, type_: Ros2Service) -> None:
        self.service = service
        self.type = type_
        self.token: OwnEntity | None = None
        self.declared: dict[str, Declared] = {}

    def close(self) -> None:
        """Undeclare everything."""
        if self.token is not None:
            self.token.close()
        for declared in self.declared.values():
            declared.close()
        self.declared.clear()


class Ros2Services:
    """Connects the services of the graph with those of ROS 2 nodes.

    Args:
        timeout: seconds in which a service must answer; 0 for no limit.
    """

    def __init__(
        self,
        graph: Graph,
        network: Ros2Network,
        nodes: Ros2Nodes,
        own: Ros2Tokens,
        types: Ros2Types,
        loop: Loop,
        timeout: float,
    ) -> None:
        self.network = network
        self.own = own
        self._graph = graph
        self._nodes = nodes
        self._types = types
        self._loop = loop
        self._timeout = timeout
        self._servers: dict[str, Ros2Server] = {}
        self._own_services: dict[str, OwnService] = {}
        self._requests: set[Call] = set()
        """Calls of ROS 2 clients that wait for a response."""
        self._left = Worklist[str](loop.call_soon, {})
        """The services of nodes that have left, which are still to be ended."""
        self._is_closed = False
        graph.watch("service", self.changed)
        graph.watch("node", self._node_changed)

    def start(self) -> None:
        """Show all services to ROS 2."""
        for name in list(self._graph.services):
            self.changed(name)

    def close(self) -> None:
        """Stop serving ROS 2; the ROS 2 nodes have left."""
        self._is_closed = True
        self._left.finish()
        for service in self._own_services.values():
            service.close()
        self._own_services.clear()

    def ros2_type(self, service: Service) -> Ros2Service | None:
        """Return the type of a service in ROS 2; None if its fields are unknown.

        Raises:
            Ros2Error: it cannot be converted.
        """
        type_ = service.type
        if type_.codecs is None or not type_.is_known:
            return None
        return self._types.service(type_.codecs.definitions, type_.name)

    # Changes: see `Endpoints`.

    def changed(self, name: str) -> None:
        """Attach the service of a ROS 2 node, or show that of the graph to ROS 2."""
        if self._is_closed:
            return
        self._settle_server(name)
        self._settle_own(name)

    def detach(self, node: Ros2Node) -> None:
        """Detach, one by one, what a node serves that has left."""
        left = []
        for name in list(node.served):
            server = self._servers.get(name)
            if server is not None and server.owner is node:
                self._forget(server)
                if server.service is not None:
                    self._graph.abandon([server.service])
                left.append(server)
        self._left.add_steps(map(self._end, left))

    def withdraw_forbidden(self) -> None:
        """End the calls of ROS 2 clients that their rights do not allow any more.

        They are at most `MOST_REQUESTS`.
        """
        for call in list(self._requests):
            if not self._graph.rights.allows(call.caller, "call", call.service.name):
                call.withdraw()

    def _node_changed(self, name: str) -> None:
        if name not in self._graph.nodes:
            for server in self._servers.values():
                server.forget(name)

    # Services of ROS 2.

    def _settle_server(self, name: str) -> None:
        entities = [
            entity for entity in self._nodes.entities(name, is_topic=False) if entity.kind == "SS"
        ]
        newest = entities[-1] if entities else None
        server = self._servers.get(name)
        if server is not None:
            is_same = newest is not None and (
                server.owner is self._nodes.attached.get(newest.node)
                and server.type == (newest.type, newest.type_hash)
            )
            if is_same:
                is_free = server.service is None and name not in self._graph.services
                if is_free and not server.is_refused:
                    self._serve(server)  # The one that had displaced it is gone.
                return
            self._detach(server)
        if newest is not None:
            new = Ros2Server(self._nodes.attached[newest.node], newest, self)
            self._servers[name] = new
            new.owner.served[name] = None
            self._serve(new)

    def _serve(self, server: Ros2Server) -> None:
        type_, type_hash = server.type
        try:
            self._check_hash(type_, type_hash)
            server.service = self._graph.serve(server.name, type_, None, server)
        except FibwsError as error:
            server.is_refused = True
            text = f"{server.node} cannot serve {server.name} here: {error}"
            logger.warning("%s", printable(text))

    def _check_hash(self, type_: str, type_hash: str) -> None:
        """Raise `Ros2Error` if a service in ROS 2 has other fields, or cannot be converted."""
        try:
            definitions = self._graph.definitions.known_to(CLIENT, "srv", type_)
            found = self._types.service(definitions, type_)
        except InterfaceError:
            return  # It is shown, and cannot be called.
        check_hash(type_, found.type_hash, type_hash)

    def _detach(self, server: Ros2Server) -> None:
        self._forget(server)
        self._end(server)

    def _forget(self, server: Ros2Server) -> None:
        del self._servers[server.name]
        server.owner.served.pop(server.name, None)

    def _end(self, server: Ros2Server) -> None:
        service, server.service = server.service, None
        if service is not None:
            self._graph.remove_service(service)
        server.close()

    # Services of this hub.

    def _settle_own(self, name: str) -> None:
        service = self._graph.services.get(name)
        type_ = self._shown_type(service)
        present = self._own_services.get(name)
        if present is not None and (present.service is not service or present.type is not type_):
            del self._own_services[name]
            present.close()
            present = None
        if service is None or type_ is None:
            return
        if present is None:
            present = self._own_services[name] = OwnService(service, type_)
        hashes = {type_.type_hash}
        if any(each.type_hash == NO_HASH for each in self._nodes.entities(name, is_topic=False)):
            hashes.add(NO_HASH)
        for gone in present.declared.keys() - hashes:
            present.declared.pop(gone).close()
        for new in hashes - present.declared.keys():
            present.declared[new] = self.network.serve(
                data_key(self.network.domain, name, "srv", type_.name, new),
                type_.request.from_cdr,
                partial(self._requested, present),
            )
        if present.token is None:  # Whoever sees it may call at once.
            present.token = self.own.declare(
                "SS", service.node, name, type_.name, type_.type_hash, SERVICE_QOS
            )

    def _shown_type(self, service: Service | None) -> Ros2Service | None:
        """Return the type of a service in ROS 2 if it is to be shown there."""
        if service is None or isinstance(service.server, InternalServer | Ros2Server):
            return None
        may_call = self._graph.rights.allows(CLIENT, "call", service.name)
        if not may_call or not self.own.may_show(service.name):
            return None
        if not self.own.is_shown(service.node):
            return None
        try:
            return self.ros2_type(service)
        except FibwsError:
            return None

    def _requested(
        self, own: OwnService, attachment: Attachment, data: bytearray, respond: Callable[..., None]
    ) -> None:
        """Call a service for a ROS 2 client."""
        name = own.service.name
        if len(self._requests) >= MOST_REQUESTS:
            respond(None, f"too many requests wait for this hub (limit {MOST_REQUESTS})")
            return
        entity = self._nodes.of_gid(attachment.gid)
        is_known = entity is not None and entity.node in self._nodes.attached
        caller = entity.node if entity is not None and is_known else CLIENT
        try:
            self._call(own, name, caller, attachment, data, respond)
        except FibwsError as error:
            respond(None, str(error))

    def _call(
        self,
        own: OwnService,
        name: str,
        caller: str,
        attachment: Attachment,
        data: bytearray,
        respond: Callable[..., None],
    ) -> None:
        type_ = own.service.type
        if type_.codecs is None:
            raise UnknownDefinition(type_.name, type_.fault)
        into, _ = type_.codecs.service_serializers(type_.name)
        convert = own.type.response.to_cdr

        def succeeded(call: Call, body: Body) -> None:
            self._requests.discard(call)
            try:
                response = body.ros1()
            except (FibwsError, ValueError) as error:
                respond(None, f"{name} returned an invalid response: {error}")
                return
            echo = attachment._replace(stamp=time.time_ns()).pack()
            respond(lambda: (convert(response), echo))

        def failed(call: Call, text: str, code: str) -> None:
            self._requests.discard(call)
            respond(None, text)

        values = read_values(into, data, "strict")
        call = self._graph.call(name, values, caller, succeeded, failed)
        self._requests.add(call)
        call.start(self._timeout, self._loop.call_later)
