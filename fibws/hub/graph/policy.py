"""The policy of a graph: what its nodes may do, and what they may know of each other.

The graph asks it when a node enters, advertises, subscribes, calls, serves, or uses a parameter; a
message asks nothing. What a node may neither use nor offer it may not see, either: such names are
missing from every list, and look unknown.
"""

from __future__ import annotations

from collections.abc import Hashable
from typing import Literal, Protocol, TypeAlias

from fibws.access.rights import Principal, Right

Kind: TypeAlias = Literal["topic", "service", "action", "parameter"]
"""The kinds of names whose visibility follows from the rights to use them."""

RIGHTS_OF: dict[Kind, tuple[Right, Right]] = {
    "topic": ("subscribe", "publish"),
    "service": ("call", "provide"),
    "action": ("call", "provide"),
    "parameter": ("param_read", "param_write"),
}
"""The rights of which one is enough to see a name of each kind."""


class Policy(Protocol):
    """Decides what nodes may do, by their principals."""

    allows_all: bool
    """Whether every node may do everything, so that listings need no filter and can be shared."""

    def enter(
        self, node: str, principal: Principal | None, *, is_chosen: bool, is_taken: bool
    ) -> None:
        """Let a principal's client be a node from now on.

        Args:
            node: its global name.
            principal: who the client is; None on a hub without authentication.
            is_chosen: whether the client chose the name, and not the hub.
            is_taken: whether a living node has the name, which this one would replace.

        Raises:
            NotAllowed: it may not have this name.
        """

    def leave(self, node: str) -> None:
        """Called when a node has left, or has lost all rights."""

    def may(self, node: str, right: Right, name: str) -> bool:
        """Return whether a node may do this with a topic, service, action or parameter."""

    def is_admin(self, node: str) -> bool:
        """Return whether a node may do what is the operator's alone."""

    def owner(self, node: str) -> str:
        """Return the name of who has a node: its principal, or itself."""

    def is_same_owner(self, node: str, other: str) -> bool:
        """Return whether two nodes belong to one principal."""

    def view(self, node: str) -> Hashable:
        """Return a value that is equal for nodes that may see the same of the graph."""


class AllowAll:
    """The policy that lets every node do everything."""

    allows_all = True

    def enter(
        self, node: str, principal: Principal | None, *, is_chosen: bool, is_taken: bool
    ) -> None:
        """Allow it."""

    def leave(self, node: str) -> None:
        """Do nothing."""

    def may(self, node: str, right: Right, name: str) -> bool:
        """Return True."""
        return True

    def is_admin(self, node: str) -> bool:
        """Return True."""
        return True

    def owner(self, node: str) -> str:
        """Return the node."""
        return node

    def is_same_owner(self, node: str, other: str) -> bool:
        """Return True: all clients of the hub trust each other."""
        return True

    def view(self, node: str) -> Hashable:
        """Return one view for all nodes; a policy that hides names has several."""
        return None if self.allows_all else node
