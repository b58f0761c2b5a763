"""What the sessions of clients have in common that are nodes of the graph, whatever they speak."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Collection, Iterable
from contextlib import ExitStack
from itertools import chain
from typing import Generic, Protocol, TypeVar

from fibws.hub.graph.graph import Graph
from fibws.hub.websocket.endpoint import Part, Removals, Work, remove_all, withdraw_all
from fibws.protocol.websocket import REPLACED, RESTART, CloseReason


class _Client(Protocol):
    @property
    def graph(self) -> Graph:
        """The graph that the client is a node of."""


C = TypeVar("C", bound=_Client)


class _Judged(Protocol):
    """A part of a session whose registrations depend on rights."""

    def withdraw_forbidden(self) -> Work:
        """Remove what the rights do not allow."""


class RegisteringPart(Part, _Judged, Protocol):
    """A part of a session with registrations that end with the rights, or with the session."""


class NodeSession(ABC, Generic[C]):
    """A client's session, and its node: how it loses rights, and leaves."""

    __slots__ = ("_client", "_close", "node")

    node: str
    """The global name of the node."""
    _client: C
    _close: Callable[[CloseReason], object]

    @abstractmethod
    def publishing(self) -> Collection[str]:
        """Return the global names of the topics that the client publishes."""

    @abstractmethod
    def subscribing(self) -> Collection[str]:
        """Return the global names of the topics that the client subscribes to."""

    @abstractmethod
    def providing(self) -> Collection[str]:
        """Return the global names of the services that the client provides."""

    def revoke(self) -> None:
        """Take all rights from the client, which is about to leave."""
        self._client.graph.revoke(self, self.node)

    def replaced(self) -> None:
        """Close the connection, and so leave: another client has taken this one's name."""
        self._close(REPLACED)

    def _withdraw_forbidden(self, parts: Iterable[_Judged]) -> Work:
        """Return the steps that remove what the rights do not allow any more."""
        return withdraw_all((part.withdraw_forbidden() for part in parts), self._fail)

    def _fail(self) -> None:
        """Close the connection, which may be opened again: some rights could not be withdrawn."""
        self.revoke()
        self._close(RESTART)

    def _leave(self, parts: Iterable[Part], ends: Iterable[Callable[[], object]] = ()) -> Work:
        """Take the node back, and return the steps that remove what it has registered.

        Args:
            ends: called, too.
        """
        removals: list[Removals] = []

        def leave(part: Part) -> None:
            removals.append(part.leave())

        with ExitStack() as stack:  # Whatever fails of this, the rest is done.
            stack.callback(self._client.graph.leave, self, self.node)
            for each in parts:
                stack.callback(leave, each)
            for end in ends:
                stack.callback(end)
        return remove_all([*chain(*removals)])
