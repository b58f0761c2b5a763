"""The graph: which nodes there are, which topics, services and actions, and of which type.

What ROS's master keeps. A topic knows its publishers and subscriptions; only the methods here add
and remove them. A topic is kept while it has any, so that a client which makes up names by the
thousand leaves nothing behind.
"""

from __future__ import annotations

import logging
import sys
from collections.abc import Callable, Iterable
from itertools import count
from typing import Any, Protocol

from fibws.errors import OperationError, TypeConflict
from fibws.hub.budget import Budget
from fibws.hub.graph.action import (
    Action,
    ActionClient,
    ActionServer,
    Goal,
    cancel_goals,
    cancel_service,
)
from fibws.hub.graph.parameters import Parameters
from fibws.hub.graph.publisher import Publisher
from fibws.hub.graph.service import Function, OwnProvider, Provider, Service
from fibws.hub.graph.subscription import Subscription
from fibws.hub.graph.topic import Topic
from fibws.hub.graph.types import MessageType, Types
from fibws.interfaces import Interfaces
from fibws.protocol.operations import Id, Subscribe

logger = logging.getLogger("fibws.hub")

CANCEL_GOAL = "action_msgs/CancelGoal"


class Node(Protocol):
    """A node of the graph: a client, or a part of the hub itself."""

    def replaced(self) -> None:
        """Another client has taken its name."""

    def publishing(self) -> Iterable[str]:
        """The global names of the topics that it publishes."""

    def subscribing(self) -> Iterable[str]:
        """The global names of the topics that it subscribes to."""

    def providing(self) -> Iterable[str]:
        """The global names of the services that it provides."""


class Graph:
    """The nodes, topics, services, actions and parameters of one hub.

    Args:
        now: gives the nanoseconds since 1970, for messages that ask for the time.
        strict_types: refuse types of unknown packages, rather than relay them unchecked.
        max_parameter_bytes: the bytes of JSON that all parameters may have together.
    """

    def __init__(
        self,
        interfaces: Interfaces,
        now: Callable[[], int],
        *,
        strict_types: bool = False,
        max_parameter_bytes: int = 2**22,
    ) -> None:
        self.nodes: dict[str, Node] = {}
        self.topics: dict[str, Topic] = {}
        self.services: dict[str, Service] = {}
        self.actions: dict[str, Action] = {}
        self.parameters = Parameters(max_parameter_bytes)
        self.interfaces = interfaces
        self.now = now
        self.revision = 0
        """Another number whenever something but the parameters has changed."""
        self._types = Types(interfaces, now, strict=strict_types)
        self._clients = 0
        self._goals = count(1)

    # Nodes.

    def enter(self, node: Node, name: str | None) -> str:
        """Give a node the name it asked for, or one of the hub's making; return it.

        Whoever had the name is told that it lost it, as ROS's master shuts down the older node.
        """
        self.revision += 1
        if name is None:
            name = self._new_name()
        older = self.nodes.pop(name, None)
        self.nodes[name] = node
        if older is not None:
            try:
                older.replaced()
            except Exception:
                # The newcomer must not pay for what is wrong with the older one.
                logger.exception("%s: the older node of this name could not leave.", name)
        return name

    def _new_name(self) -> str:
        while True:
            self._clients += 1
            name = f"/client_{self._clients}"
            if name not in self.nodes:
                return name

    def leave(self, node: Node, name: str) -> None:
        """Forget a node, unless its name has gone to another."""
        if self.nodes.get(name) is node:
            del self.nodes[name]
            self.revision += 1

    # Topics.

    def topic(self, name: str) -> Topic:
        """The topic of this global name; a new one is kept once somebody has to do with it."""
        return self.topics.get(name) or Topic(name)

    def add_publisher(
        self,
        topic: Topic,
        node: str,
        type_: str,
        definition: str | None = None,
        *,
        latch: bool,
        latches: Budget | None = None,
    ) -> Publisher:
        """The node's publisher of a topic; the first call decides ``latch``.

        Args:
            definition: the text of the type, if the client brought one.
            latches: what the node's latched messages may take; None bounds nothing.

        Raises:
            TypeConflict: the topic has another type, and nodes that hold it to that.
            InterfaceError: the type's name is not valid, or its package does not have it.
        """
        message_type = self._establish(topic, type_, definition)
        publisher = topic.publishers.get(node)
        if publisher is None:
            publisher = Publisher(
                node,
                topic,
                message_type,
                self.now,
                latch=latch,
                latches=latches or Budget(sys.maxsize),
            )
            topic.add(publisher)
            self.topics[topic.name] = topic
            self.revision += 1
        return publisher

    def remove_publisher(self, publisher: Publisher) -> None:
        """Let a publisher go."""
        publisher.forget()
        publisher.topic.remove(publisher)
        self._settle(publisher.topic)

    def subscribe(self, subscription: Subscription, request: Subscribe) -> None:
        """Add a request to a subscription, which may be a new one; raises as `add_publisher`."""
        if request.type is not None:
            self._establish(subscription.topic, request.type)
        try:
            type_ = subscription.topic.type
            if request.compression == "cbor-raw" and type_ is not None:
                type_.check_binary()
            subscription.request(request)
            subscription.topic.update(subscription)
            self.topics[subscription.topic.name] = subscription.topic
        finally:
            # A request may be one too many, or take the place of one that named the type.
            self._settle(subscription.topic)

    def unsubscribe(self, subscription: Subscription, id_: Id) -> None:
        """Take back one request of a subscription, or all if ``id_`` is None."""
        subscription.cancel(id_)
        subscription.topic.update(subscription)
        self._settle(subscription.topic)

    def _establish(self, topic: Topic, type_: str, definition: str | None = None) -> MessageType:
        """Give a topic its type; return what checks its messages."""
        name = self.interfaces.canonical(type_)
        if topic.type is not None and topic.type.name == name and definition is None:
            return topic.type
        if topic.type is not None and topic.type.name != name and topic.held:
            raise TypeConflict(topic.name, name, topic.type.name, topic.holder())
        wanted = self._types.message(name, definition)
        self.revision += 1
        if topic.type is None or topic.type.name != name:
            topic.type = wanted
        elif wanted.checked and not topic.type.checked:
            # Somebody has brought the definition: it is for those who came before, too.
            topic.type = wanted
            for publisher in topic.publishers.values():
                publisher.type = wanted
        return topic.type

    def _settle(self, topic: Topic) -> None:
        """Forget what nobody holds any more: the topic, or its type."""
        self.revision += 1
        if topic.idle:
            self.topics.pop(topic.name, None)
        elif topic.type is not None and not topic.held:
            topic.type = None

    # Services.

    def add_service(
        self, name: str, type_: str, definition: str | None, provider: Provider
    ) -> Service:
        """Have a client provide a service; whoever did until now is told that it is displaced.

        Raises:
            OperationError: the service is the hub's own.
            InterfaceError: the type's name is not valid, or its package does not have it.
        """
        service_type = self._types.service(self.interfaces.canonical(type_), definition)
        older = self.services.get(name)
        if older is not None and isinstance(older.provider, OwnProvider):
            raise OperationError(f"Service {name} is the hub's own ({older.node})")
        return self._provide(Service(name, service_type, provider))

    def offer(self, name: str, type_: str, node: str, function: Function) -> None:
        """Have the hub itself answer a service, as one of its own nodes."""
        provider = OwnProvider(node, function)
        self._provide(Service(name, self._types.service(type_), provider))

    def _provide(self, service: Service) -> Service:
        older = self.services.get(service.name)
        self.services[service.name] = service
        self.revision += 1
        if older is not None:
            older.provider.displaced(older)
        return service

    def remove_service(self, service: Service) -> None:
        """Let a service go, unless another provider has taken it over."""
        if self.services.get(service.name) is service:
            del self.services[service.name]
            self.revision += 1

    # Actions.

    def add_action(
        self, name: str, type_: str, definition: str | None, server: ActionServer
    ) -> Action:
        """Have a client pursue an action's goals; otherwise as `add_service`.

        Its goals can be cancelled by a service beside it, too, as in ROS 2.
        """
        action_type = self._types.action(self.interfaces.canonical(type_), definition)
        older = self.actions.get(name)
        if older is not None:
            self.remove_action(older)
        action = self.actions[name] = Action(name, action_type, server)
        self.offer(
            cancel_service(action.name),
            CANCEL_GOAL,
            server.node,
            lambda request, caller: cancel_goals(action, request),
        )
        if older is not None:
            older.server.displaced(older)
        return action

    def new_goal(self, action: Action, request: dict[str, Any], client: ActionClient) -> Goal:
        """A new goal, which is not started yet."""
        uuid = next(self._goals).to_bytes(16, "big")
        return Goal(action, request, client, uuid, self.now())

    def remove_action(self, action: Action) -> None:
        """Let an action go, unless another server has taken it over."""
        if self.actions.get(action.name) is action:
            del self.actions[action.name]
            self.services.pop(cancel_service(action.name), None)
            self.revision += 1
