"""Nodes of other hubs in this hub's graph."""

from __future__ import annotations

import logging
from collections.abc import Callable, Iterable

from fibws.hub.errors import NotAllowed
from fibws.hub.federation.announced import Announced, PeerGraph
from fibws.hub.federation.backplane import Peer
from fibws.hub.federation.precedence import Ages, NodeOffer, choose
from fibws.hub.federation.records import HubInfo, Kind, NodeRecord, Request
from fibws.hub.foreign.nodes import ForeignNode
from fibws.hub.graph.graph import Graph
from fibws.hub.graph.nodes import NodeOfHub
from fibws.hub.log.text import printable

logger = logging.getLogger("fibws.hub")


class RemoteNode(ForeignNode, NodeOfHub):
    """A node of another hub; a `GraphNode` of this graph.

    Attributes:
        home: the hub that announced it, on the shortest way to it.
        since: when it connected to its hub, by the clock of this hub.
        served: the services and actions that it provides here, with their kinds.
    """

    __slots__ = ("home", "record")

    def __init__(
        self,
        name: str,
        record: NodeRecord,
        home: PeerGraph,
        since: int,
        on_replaced: Callable[[RemoteNode], None],
    ) -> None:
        super().__init__(name, since, on_replaced)
        self.record = record
        self.home = home
        self.served: dict[tuple[Kind, str], None]

    @property
    def hub(self) -> HubInfo:
        """The hub that it is connected to."""
        return self.record.hub

    @property
    def hub_name(self) -> str:
        """The name of that hub."""
        return self.record.hub.name

    def providing(self) -> Iterable[str]:
        """Return the services that it provides."""
        return [name for kind, name in self.served if kind == "services"]

    def ping(self, done: Callable[[str], object]) -> Callable[[], object]:
        """Ask its hub to ping it; see `DistantNode`."""
        return self._ask("ping_node", done)

    def shut_down(self, reason: str, done: Callable[[str], object]) -> Callable[[], object]:
        """Ask its hub to end it; see `DistantNode`."""
        return self._ask("kill_node", done)

    def _ask(self, op: str, done: Callable[[str], object]) -> Callable[[], object]:
        peer = self.home.peer
        view = peer.backplane.view
        name = view.outward(self.name) or self.name
        request = Request(op, {"node": name})
        return peer.backplane.request(
            peer, request, lambda reply: done(str(reply.fields.get("error", "")))
        )


def attached_node(graph: Graph, name: str, home: PeerGraph) -> RemoteNode | None:
    """Return a remote node if it is attached by the way of a hub."""
    found = graph.nodes.get(name)
    if isinstance(found, RemoteNode) and found.home is home:
        return found
    return None


class RemoteNodes:
    """Attaches the nodes that other hubs announce.

    Args:
        hub: this one.
        entered: called with a node that has been attached.
        leaving: called with a node before it is detached.
        warn: logs a warning, once.
    """

    def __init__(
        self,
        graph: Graph,
        hub: HubInfo,
        announced: Announced,
        ages: Ages,
        *,
        entered: Callable[[RemoteNode], None],
        leaving: Callable[[RemoteNode], None],
        warn: Callable[[str], None],
    ) -> None:
        self._graph = graph
        self._hub = hub
        self._announced = announced
        self._ages = ages
        self._entered = entered
        self._leaving = leaving
        self._warn = warn

    def settle(self, name: str) -> None:
        """Attach the node of this name that is the right one, if it is a remote one."""
        present = self._graph.nodes.get(name)
        attached = present if isinstance(present, RemoteNode) else None
        offer = choose(list(self._offers(name)))
        if offer is None:
            if attached is not None:
                self._detach(attached)
            return
        if attached is not None:
            if attached.home is offer.home and attached.hub == offer.record.hub:
                attached.record = offer.record
                return
            self._detach(attached)
        elif present is not None and not self._gives_way(name, offer):
            return
        home, record, since = offer
        node = RemoteNode(name, record, home, since, self._replaced)
        try:
            self._graph.enter(node, name, home.peer.backplane.principal)
        except NotAllowed as error:
            self._warn(f"{name} of hub {printable(record.hub.name)} may not join: {error}")
            return
        self._ages.forget_replaced("nodes", name)
        self._entered(node)

    def _offers(self, name: str) -> Iterable[NodeOffer]:
        for home, record in self._announced.of("nodes", name).items():
            if all(hub.id != self._hub.id for hub in record.path):
                yield NodeOffer(home, record, home.local_time(record.since))

    def _gives_way(self, name: str, offer: NodeOffer) -> bool:
        """Return whether a node of this hub has to leave for a remote one of its name."""
        record = offer.record
        if self._ages.was_replaced("nodes", name, record.hub.id, record.since):
            return False
        if name in self._graph.rights.internal:
            return False
        hub = printable(record.hub.name)
        if record.replaces == self._hub.id:
            logger.info("%s: new node registered with same name at hub %s.", name, hub)
            return True
        is_older = self._ages.is_own_older(offer, name)
        self._warn_of_two(name, hub, "this one" if is_older else "that one")
        if not is_older:
            # The other hub may have no other sign of it, as this one's node leaves at once.
            self._report_older(offer.home.peer, name, self._hub.name)
        return not is_older

    def reported_older(self, name: str, hub: str) -> None:
        """Log that another hub has closed its node of a name, as this one's is older."""
        found = self._graph.nodes.get(name)
        if isinstance(found, RemoteNode):
            self._report_older(found.home.peer, name, hub)
        elif found is not None:
            self._warn_of_two(name, printable(hub), "this one")

    def _report_older(self, peer: Peer, name: str, hub: str) -> None:
        fields = {"node": peer.backplane.view.outward(name) or name, "closed_at": hub}
        peer.backplane.request(peer, Request("older_node", fields), lambda reply: None)

    def _warn_of_two(self, name: str, hub: str, older: str) -> None:
        self._warn(
            f"{name} is connected here and at hub {hub}: {older} is older and stays, the other "
            "one is closed"
        )

    def _replaced(self, node: RemoteNode) -> None:
        """Called when another node has taken the name of a remote node."""
        self._ages.replaced("nodes", node.name, node.hub.id, node.record.since)
        self._leaving(node)

    def _detach(self, node: RemoteNode) -> None:
        self._leaving(node)
        self._graph.leave(node, node.name)
