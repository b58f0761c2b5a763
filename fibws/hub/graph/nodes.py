"""The nodes of the graph: of clients, of ROS 1, of other hubs, and of links."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable
from typing import Protocol


class GraphNode(Protocol):
    """A node of the graph: a client, or a part of the hub itself."""

    def replaced(self) -> None:
        """Called when another client has taken its name."""

    def publishing(self) -> Iterable[str]:
        """Return the global names of the topics that it publishes."""

    def subscribing(self) -> Iterable[str]:
        """Return the global names of the topics that it subscribes to."""

    def providing(self) -> Iterable[str]:
        """Return the global names of the services that it provides."""


class DistantNode(ABC):
    """A `GraphNode` that is not connected to this hub, and answers in another way.

    Attributes:
        since: when it registered, or connected to its own hub, in nanoseconds since 1970.
    """

    __slots__ = ()

    since: int

    @abstractmethod
    def ping(self, done: Callable[[str], object]) -> Callable[[], object]:
        """Ask whether it answers.

        Args:
            done: called once with why it did not answer; with an empty text if it did. It may be
                called before this returns.

        Returns:
            A function that cancels.
        """

    @abstractmethod
    def shut_down(self, reason: str, done: Callable[[str], object]) -> Callable[[], object]:
        """Ask the node to end; arguments and result are those of `ping`."""


class ExternalNode(DistantNode):
    """A node that answers at an address of its own: a ROS 1 node.

    Attributes:
        api: the URI of its address.
        fault: why it did not answer last; empty if it did.
    """

    api: str
    fault: str

    @abstractmethod
    def unregister(self) -> None:
        """Remove it from the graph, with everything that it has registered."""


class NodeOfHub(DistantNode):
    """A node that is connected to another hub."""

    __slots__ = ()

    @property
    @abstractmethod
    def hub_name(self) -> str:
        """The name of its hub."""


class NodeOfLink:
    """A `GraphNode` that stands for a link to other hubs, and uses nothing itself."""

    __slots__ = ()
