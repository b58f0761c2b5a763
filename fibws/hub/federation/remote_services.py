"""Services and actions of other hubs in this hub's graph."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any, NamedTuple

from fibws.errors import FibwsError
from fibws.hub.federation.announced import Announced, PeerGraph
from fibws.hub.federation.calls import RemoteCalls
from fibws.hub.federation.definitions import DefinitionPending, RemoteDefinitions
from fibws.hub.federation.precedence import Ages
from fibws.hub.federation.records import ActionRecord, Kind, ServiceRecord
from fibws.hub.federation.remote_nodes import RemoteNode, attached_node
from fibws.hub.graph.graph import Graph


class Served(NamedTuple):
    """A service or an action of another hub that is attached.

    Attributes:
        node: the node that serves it.
        since: when it was advertised, by the clock of this hub.
        served: the `Service` or the `Action`; None if it could not be attached.
    """

    home: PeerGraph
    record: ServiceRecord | ActionRecord
    node: RemoteNode
    since: int
    served: Any


class RemoteServices:
    """Attaches the services and actions that other hubs announce; the newest of each name.

    Args:
        hub: the id of this one.
        warn: logs a warning, once.
    """

    def __init__(
        self,
        graph: Graph,
        hub: str,
        announced: Announced,
        ages: Ages,
        definitions: RemoteDefinitions,
        calls: RemoteCalls,
        *,
        warn: Callable[[str], None],
    ) -> None:
        self._graph = graph
        self._hub = hub
        self._announced = announced
        self._ages = ages
        self._definitions = definitions
        self._calls = calls
        self._warn = warn
        self._served: dict[tuple[Kind, str], Served] = {}

    def find(self, kind: Kind, name: str) -> Served | None:
        """Return the service or action of another hub that is attached."""
        return self._served.get((kind, name))

    def note_change(self, kind: Kind, name: str) -> bool:
        """Record a change in the graph; return whether its name must be settled."""
        found, attached = self._present(kind, name), self._served.get((kind, name))
        is_remote = attached is not None and attached.served is found
        self._ages.note(kind, name, None if is_remote else found, is_remote=is_remote)
        if attached is not None and attached.served is not None and found and not is_remote:
            self._ages.replaced(kind, name, attached.node.hub.id, attached.record.since)
        return attached is not None or bool(self._announced.of(kind, name))

    def settle(self, kind: Kind, name: str) -> None:
        """Attach the newest service or action of a name, if it is a remote one."""
        best = self._newest(kind, name)
        attached = self._served.get((kind, name))
        if attached is not None:
            present = self._present(kind, name)
            if best is not None and (attached.home, attached.record) == best[1:]:
                if attached.served is not None and present not in (None, attached.served):
                    best = None  # A newer server has taken it over.
                elif self._graph.nodes.get(attached.record.node) is attached.node:
                    return
            self._detach(kind, name)
        if best is not None:
            self._attach(kind, name, *best)

    def served_by(self, node: RemoteNode) -> Iterator[Any]:
        """Yield the services and actions of a node that are attached."""
        for key in node.served:
            attached = self._served.get(key)
            if attached is not None and attached.node is node:
                yield attached.served

    def _newest(self, kind: Kind, name: str) -> tuple[int, PeerGraph, Any] | None:
        best: tuple[int, PeerGraph, Any] | None = None
        for home, record in self._announced.of(kind, name).items():
            since = home.local_time(record.since)
            if attached_node(self._graph, record.node, home) and (best is None or since > best[0]):
                best = since, home, record
        return best

    def _attach(self, kind: Kind, name: str, since: int, home: PeerGraph, record: Any) -> None:
        node = attached_node(self._graph, record.node, home)
        if node is None or not self._takes_over(kind, name, since, record, node):
            return
        type_kind: Any = "srv" if kind == "services" else "action"
        md5sum = record.md5sum if kind == "services" else "".join(record.md5sums or ())
        served: Any = None
        try:
            text = self._definitions.find(home.peer, type_kind, record.type, md5sum, (kind, name))
            served = self._calls.serve(home.peer, kind, name, record, text)
        except DefinitionPending:
            return
        except FibwsError as error:
            self._warn(f"{record.node} cannot serve {name} here: {error}")
        self._served[kind, name] = Served(home, record, node, since, served)
        if served is not None:
            node.served[kind, name] = None

    def _takes_over(self, kind: Kind, name: str, since: int, record: Any, node: RemoteNode) -> bool:
        """Return whether this hub has no service or action of the name that is newer."""
        if self._ages.was_replaced(kind, name, node.hub.id, record.since):
            return False
        if record.replaces == self._hub:
            return True
        return not self._ages.is_own_newer(kind, name, since)

    def _detach(self, kind: Kind, name: str) -> None:
        attached = self._served.pop((kind, name))
        attached.node.served.pop((kind, name), None)
        if attached.served is not None:
            self._calls.remove(kind, attached.served)

    def _present(self, kind: Kind, name: str) -> Any:
        found: Any = self._graph.services if kind == "services" else self._graph.actions
        return found.get(name)
