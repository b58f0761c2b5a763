"""Who is on the graph and what they do there, as a node can ask."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from fibws.node.rosapi import Rosapi
from fibws.srv import rosapi


@dataclass(frozen=True, slots=True)
class NodeDetails:
    """What one node does: the names of its topics and services."""

    publishing: list[str]
    subscribing: list[str]
    services: list[str]


class Graph:
    """The graph as it is at the moment. Names are resolved as all others.

    What the hub does not know has no type, no node and empty lists. While there is no hub, all of
    these wait.

    Raises:
        InvalidName: the name that is asked about is not legal.
        ServiceError: the hub refuses, or is lost, as the text says.
        NodeClosed: the node has ended.
    """

    def __init__(self, rosapi: Rosapi, resolve: Callable[[str], str]) -> None:
        self._ask = rosapi.ask
        self._resolve = resolve

    async def nodes(self) -> list[str]:
        """The names of all nodes."""
        return (await self._ask("nodes", rosapi.Nodes)).nodes

    async def node(self, name: str) -> NodeDetails:
        """What one node does."""
        answer = await self._ask("node_details", rosapi.NodeDetails, node=self._resolve(name))
        return NodeDetails(answer.publishing, answer.subscribing, answer.services)

    async def topics(self) -> dict[str, str]:
        """The types of all topics by name: ``""`` where nobody said it yet."""
        answer = await self._ask("topics", rosapi.Topics)
        return dict(zip(answer.topics, answer.types, strict=True))

    async def topics_of_type(self, type_: str) -> list[str]:
        """The names of the topics of a type, such as ``std_msgs/Int32``."""
        return (await self._ask("topics_for_type", rosapi.TopicsForType, type=type_)).topics

    async def topic_type(self, topic: str) -> str | None:
        """A topic's type."""
        answer = await self._ask("topic_type", rosapi.TopicType, topic=self._resolve(topic))
        return answer.type or None

    async def publishers(self, topic: str) -> list[str]:
        """The nodes that publish on a topic."""
        answer = await self._ask("publishers", rosapi.Publishers, topic=self._resolve(topic))
        return answer.publishers

    async def subscribers(self, topic: str) -> list[str]:
        """The nodes that subscribe to a topic."""
        answer = await self._ask("subscribers", rosapi.Subscribers, topic=self._resolve(topic))
        return answer.subscribers

    async def services(self) -> list[str]:
        """The names of all services."""
        return (await self._ask("services", rosapi.Services)).services

    async def services_of_type(self, type_: str) -> list[str]:
        """The names of the services of a type, such as ``std_srvs/Trigger``."""
        return (await self._ask("services_for_type", rosapi.ServicesForType, type=type_)).services

    async def service_type(self, service: str) -> str | None:
        """A service's type."""
        name = self._resolve(service)
        return (await self._ask("service_type", rosapi.ServiceType, service=name)).type or None

    async def service_node(self, service: str) -> str | None:
        """The node that answers a service's calls."""
        name = self._resolve(service)
        return (await self._ask("service_node", rosapi.ServiceNode, service=name)).node or None

    async def action_servers(self) -> list[str]:
        """The names of the actions that are served over topics."""
        return (await self._ask("action_servers", rosapi.GetActionServers)).action_servers
