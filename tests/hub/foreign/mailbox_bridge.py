"""A bridge to a graph that is a few lists: all that a further bridge has to bring."""

from __future__ import annotations

from collections.abc import Callable
from itertools import chain
from typing import Any, TypeAlias

from fibws.hub.foreign.nodes import ForeignNode
from fibws.hub.foreign.topics import (
    ForeignPublisher,
    ForeignSubscriber,
    ForeignTopics,
    ForeignUsers,
)
from fibws.hub.foreign.worklist import Worklist
from fibws.hub.graph.body import Body
from fibws.hub.graph.graph import Graph
from fibws.hub.graph.publication import Publication
from fibws.hub.graph.service import Call, CallLater, Service
from fibws.hub.graph.topic import Source, Topic

Serve: TypeAlias = Callable[[dict[str, Any]], dict[str, Any]]
Users: TypeAlias = ForeignUsers[ForeignPublisher, ForeignSubscriber]


class MailNode(ForeignNode):
    """A node of the mailbox, which always answers, and also serves its services."""

    def ping(self, done: Callable[[str], object]) -> Callable[[], object]:
        done("")
        return lambda: None

    def shut_down(self, reason: str, done: Callable[[str], object]) -> Callable[[], object]:
        done("nodes of a mailbox do not end")
        return lambda: None


class MailServer:
    """A service of the mailbox."""

    def __init__(self, node: str, function: Serve) -> None:
        self.node = node
        self._function = function

    def handle(self, call: Call) -> None:
        call.respond(self._function(call.request.values()))

    def cancel(self, call: Call) -> None:
        """Do nothing: the response was immediate."""

    def displaced(self, service: Service) -> None:
        """Do nothing."""


class MailBridge(ForeignTopics[ForeignPublisher, ForeignSubscriber]):
    """Joins a mailbox with a graph."""

    def __init__(self, graph: Graph, call_soon: Callable[[Callable[[], None]], object]) -> None:
        super().__init__(graph, lambda text: self.warnings.append(text))
        self.warnings: list[str] = []
        self.delivered: list[tuple[str, Any]] = []
        self.nodes: dict[str, MailNode] = {}
        self.publishes: dict[str, dict[str, tuple[str, str]]] = {}
        """The nodes of each topic, with the type and its md5; the same of subscribers."""
        self.subscribes: dict[str, dict[str, tuple[str, str]]] = {}
        self._users: dict[str, Users] = {}
        self.work = Worklist[str](call_soon, {"topics": self._settle})
        graph.watch_topics(lambda topic: self.work.add("topics", topic.name))

    def join(self, name: str) -> None:
        self.nodes[name] = node = MailNode(name, 0, lambda node: self.leave(node.name))
        self._graph.enter(node, name)

    def leave(self, name: str) -> None:
        node = self.nodes.pop(name)
        for service in node.served.values():
            self._graph.remove_service(service)
        self.abandon(node.published.values(), chain(*node.subscribed.values()))
        for topic in (*node.published, *node.subscribed):
            self.work.add("topics", topic)
        self._graph.leave(node, name)

    def serve(self, node: str, name: str, type_: str, function: Serve) -> None:
        served = self._graph.serve(name, type_, None, MailServer(node, function))
        self.nodes[node].served[name] = served

    def call(self, name: str, values: object, caller: str, call_later: CallLater) -> None:
        def succeeded(call: Call, response: Body) -> None:
            self.delivered.append((name, response.values()))

        def failed(call: Call, text: str, code: str) -> None:
            self.delivered.append((name, code))

        self._graph.call(name, values, caller, succeeded, failed).start(1.0, call_later)

    def send(self, topic: str, node: str, values: object) -> None:
        """Take a message from the mailbox."""
        source = self._users[topic].publishers[node].source
        if source is not None:
            source.publish(values)

    def receive(self, publication: Publication) -> None:
        """Put a message into the mailbox, unless it has come from there; the outlet of topics."""
        if publication.node not in self.nodes:
            self.delivered.append((publication.type.name, publication.values()))

    def _settle(self, name: str) -> None:
        users = self._users.setdefault(name, ForeignUsers())
        publishers, subscribers = (
            {node: (self.nodes[node], type_) for node, type_ in each.items() if node in self.nodes}
            for each in (self.publishes.get(name, {}), self.subscribes.get(name, {}))
        )
        self.settle_users(
            *(name, users, publishers, subscribers, ForeignPublisher),
            lambda owner, type_: ForeignSubscriber(owner, type_, self),
        )

    def advertise(self, topic: Topic, publisher: ForeignPublisher) -> Source:
        type_, md5sum = publisher.type
        report = self.reporter(publisher)
        return self._graph.advertise(
            topic, publisher.name, type_, md5sum=md5sum, linked=False, on_conflict=report
        )

    def subscribe(self, topic: Topic, subscriber: ForeignSubscriber) -> None:
        type_, _ = subscriber.type
        report = self.reporter(subscriber)
        self._graph.subscribe(
            topic, subscriber, type_, receiver=lambda group: self, on_conflict=report
        )
