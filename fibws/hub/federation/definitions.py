"""Definitions of types that this hub lacks, and other hubs describe."""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Callable, Hashable

from fibws.errors import InterfaceError
from fibws.hub.federation.backplane import Peer
from fibws.hub.federation.records import Kind, Reply, Request
from fibws.hub.graph.graph import Graph
from fibws.interfaces.folders import Kind as TypeKind

MOST_KNOWN = 10_000
"""Definitions that are kept."""


class DefinitionPending(Exception):
    """A hub is asked for a definition."""


class RemoteDefinitions:
    """Finds the definitions of types, and asks other hubs for those that are unknown.

    Args:
        arrived: called with the kind and the name of what waits for a definition that is there now.
    """

    def __init__(self, graph: Graph, arrived: Callable[[Kind, str], None]) -> None:
        self._graph = graph
        self._arrived = arrived
        self._texts: OrderedDict[Hashable, str | None] = OrderedDict()
        """By kind, name and md5; None while a hub is asked."""
        self._waiting: dict[Hashable, set[tuple[Kind, str]]] = {}

    def find(
        self, peer: Peer, kind: TypeKind, type_: str, md5sum: str, user: tuple[Kind, str]
    ) -> str | None:
        """Return the text of a type; None if it is known to the peer's node, or nobody knows it.

        Args:
            peer: the hub to ask.
            user: what needs it.

        Raises:
            DefinitionPending: the hub is asked for it.
        """
        if md5sum and self._known_md5sum(peer.backplane.node, kind, type_) == md5sum:
            return None
        key = kind, type_, md5sum
        if self._texts.get(key) is None:
            self._waiting.setdefault(key, set()).add(user)
            if key not in self._texts:
                self._ask(peer, key, kind, type_)
            raise DefinitionPending
        return self._texts[key] or None

    def _ask(self, peer: Peer, key: Hashable, kind: TypeKind, type_: str) -> None:
        self._texts[key] = None
        if len(self._texts) > MOST_KNOWN:
            self._texts.popitem(last=False)

        def described(reply: Reply) -> None:
            text = reply.fields.get("text")
            self._texts[key] = text if isinstance(text, str) else ""
            if reply.fields.get("code") == "server_lost":
                self._texts.pop(key, None)  # Another hub may be asked.
            for user in self._waiting.pop(key, ()):
                self._arrived(*user)

        request = Request("describe", {"kind": kind, "type": type_})
        peer.backplane.request(peer, request, described)

    def _known_md5sum(self, node: str, kind: TypeKind, type_: str) -> str | None:
        """Return the md5 of a type as a node knows it; those of an action's parts in one text."""
        try:
            known = self._graph.definitions.known_to(node, kind, type_)
            if kind == "msg":
                return known.md5(type_)
            if kind == "srv":
                return known.service_md5(type_)
            action = known.action(type_)
            parts = action.goal, action.feedback, action.result
            return "".join(known.md5(part.type) for part in parts)
        except InterfaceError:
            return None
