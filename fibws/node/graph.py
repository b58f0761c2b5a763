"""Which nodes, topics and services the graph has, as a node can ask."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from fibws.node.calls import Calls
from fibws.public_classes import Public, made_by
from fibws.srv import rosapi


def _type_name(name: str) -> str:
    if not isinstance(name, str):
        raise TypeError(f"expected the name of a type, such as std_msgs/Int32, got {name!r}")
    return name


@dataclass(frozen=True, slots=True)
class NodeDetails:
    """The names of one node's topics and services."""

    publishing: list[str]
    subscribing: list[str]
    services: list[str]


@made_by("Node.graph")
class Graph(Public):
    """The current state of the graph. Names are resolved as everywhere.

    Unknown names give None or empty lists. While there is no hub, all methods wait, at
    most ``timeout`` seconds if it is given.

    Raises:
        ServiceTimeout: the time is over (a TimeoutError, too).
        InvalidName: the name is not legal.
        ServiceError: the hub refuses, as the text says.
        NodeClosed: the node has ended.
    """

    # calls: the node's.
    # resolve: returns the global name of a name.
    def __init__(self, calls: Calls, resolve: Callable[[str], str]) -> None:
        self._ask = calls.query_rosapi
        self._resolve = resolve

    async def nodes(self, *, timeout: float | None = None) -> list[str]:
        """Return the names of all nodes."""
        return (await self._ask("nodes", rosapi.Nodes, timeout)).nodes

    async def node(self, name: str, *, timeout: float | None = None) -> NodeDetails:
        """Return one node's topics and services."""
        answer = await self._ask(
            "node_details", rosapi.NodeDetails, timeout, node=self._resolve(name)
        )
        return NodeDetails(answer.publishing, answer.subscribing, answer.services)

    async def topics(self, *, timeout: float | None = None) -> dict[str, str]:
        """Return the types of all topics by name: ``""`` if a type is not known yet."""
        answer = await self._ask("topics", rosapi.Topics, timeout)
        return dict(zip(answer.topics, answer.types, strict=True))

    async def topics_of_type(self, type_: str, *, timeout: float | None = None) -> list[str]:
        """Return the names of the topics of a type, such as ``std_msgs/Int32``."""
        return (
            await self._ask(
                "topics_for_type", rosapi.TopicsForType, timeout, type=_type_name(type_)
            )
        ).topics

    async def topic_type(self, topic: str, *, timeout: float | None = None) -> str | None:
        """Return a topic's type, such as ``std_msgs/Int32``."""
        answer = await self._ask(
            "topic_type", rosapi.TopicType, timeout, topic=self._resolve(topic)
        )
        return answer.type or None

    async def publishers(self, topic: str, *, timeout: float | None = None) -> list[str]:
        """Return the nodes that publish a topic."""
        answer = await self._ask(
            "publishers", rosapi.Publishers, timeout, topic=self._resolve(topic)
        )
        return answer.publishers

    async def subscribers(self, topic: str, *, timeout: float | None = None) -> list[str]:
        """Return the nodes that subscribe to a topic."""
        answer = await self._ask(
            "subscribers", rosapi.Subscribers, timeout, topic=self._resolve(topic)
        )
        return answer.subscribers

    async def services(self, *, timeout: float | None = None) -> list[str]:
        """Return the names of all services."""
        return (await self._ask("services", rosapi.Services, timeout)).services

    async def services_of_type(self, type_: str, *, timeout: float | None = None) -> list[str]:
        """Return the names of the services of a type, such as ``std_srvs/Trigger``."""
        return (
            await self._ask(
                "services_for_type", rosapi.ServicesForType, timeout, type=_type_name(type_)
            )
        ).services

    async def service_type(self, service: str, *, timeout: float | None = None) -> str | None:
        """Return a service's type."""
        name = self._resolve(service)
        return (
            await self._ask("service_type", rosapi.ServiceType, timeout, service=name)
        ).type or None

    async def service_node(self, service: str, *, timeout: float | None = None) -> str | None:
        """Return the node that provides a service."""
        name = self._resolve(service)
        return (
            await self._ask("service_node", rosapi.ServiceNode, timeout, service=name)
        ).node or None

    async def action_servers(self, *, timeout: float | None = None) -> list[str]:
        """Return the names of the actions that are served over topics."""
        return (await self._ask("action_servers", rosapi.GetActionServers, timeout)).action_servers
