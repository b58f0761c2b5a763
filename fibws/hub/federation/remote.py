"""Nodes, topics, services and actions of other hubs, attached to this hub's graph.

Hubs announce records, and each record may come by several ways. A node is attached once: by the
shortest way, and its topics, services and actions with it. Everything is brought up to date by
comparing what should be attached with what is, so that any order of announcements, losses and
changes of the graph leads to the same state.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from itertools import chain

from fibws.hub.delivery.clock import Clock
from fibws.hub.federation.announced import Announced, PeerGraph
from fibws.hub.federation.backplane import Peer
from fibws.hub.federation.calls import RemoteCalls
from fibws.hub.federation.definitions import RemoteDefinitions
from fibws.hub.federation.outlets import Outlets
from fibws.hub.federation.precedence import Ages
from fibws.hub.federation.records import Announcement, HubInfo, Kind
from fibws.hub.federation.remote_nodes import RemoteNode, RemoteNodes
from fibws.hub.federation.remote_services import RemoteServices
from fibws.hub.federation.remote_topics import RemotePublisher, RemoteTopics
from fibws.hub.foreign.warnings import OneTimeWarnings
from fibws.hub.foreign.worklist import Worklist
from fibws.hub.graph.graph import Graph
from fibws.hub.graph.topic import Topic


class RemoteGraph:
    """Attaches what other hubs announce.

    Args:
        hub: this one.
        max_latched_bytes: most bytes of the latched messages of one hub.
        flowing: called when messages of a remote publisher pass.
    """

    def __init__(
        self,
        graph: Graph,
        hub: HubInfo,
        clock: Clock,
        call_soon: Callable[[Callable[[], None]], object],
        outlets: Outlets,
        calls: RemoteCalls,
        *,
        max_latched_bytes: int,
        flowing: Callable[[RemotePublisher], None],
    ) -> None:
        self._graph = graph
        self._max_latched_bytes = max_latched_bytes
        self._homes: dict[Peer, PeerGraph] = {}
        warn = OneTimeWarnings()
        self._work = Worklist[Kind](
            call_soon,
            {
                "nodes": lambda name: self._nodes.settle(name),
                "topics": lambda name: self.topics.settle(name),
                "services": lambda name: self.services.settle("services", name),
                "actions": lambda name: self.services.settle("actions", name),
            },
        )
        self._announced = Announced(self._work.add)
        self.ages = Ages(hub.id, graph.now)
        self._definitions = definitions = RemoteDefinitions(graph, clock, self._definition_arrived)
        self._nodes = RemoteNodes(
            graph,
            hub,
            self._announced,
            self.ages,
            entered=self._entered,
            leaving=self._leaving,
            warn=warn,
        )
        self.topics = RemoteTopics(
            graph, self._announced, definitions, outlets, clock, flowing=flowing, warn=warn
        )
        self.services = RemoteServices(
            graph, hub.id, self._announced, self.ages, definitions, calls, warn=warn
        )
        graph.watch("node", self._node_changed)
        graph.watch("service", lambda name: self._served_changed("services", name))
        graph.watch("action", lambda name: self._served_changed("actions", name))
        graph.watch_topics(self._topic_changed)

    def home(self, peer: Peer) -> PeerGraph:
        """Return what a hub has announced."""
        return self._homes[peer]

    def homes(self) -> Iterable[PeerGraph]:
        """Return what all hubs have announced that are reached."""
        return self._homes.values()

    def joined(self, peer: Peer) -> None:
        """Add a hub that is reached."""
        self._homes[peer] = PeerGraph(peer, self._graph.latch_quota(self._max_latched_bytes))

    def lost(self, peer: Peer) -> None:
        """Detach everything of a hub that is not reached any more, unless it comes another way."""
        self.finish(self._announced.forget(self._homes.pop(peer)))
        self.finish(self._definitions.forget(peer))

    def finish(self, steps: Iterator[None]) -> None:
        """Take some steps in turns, before names are settled."""
        self._work.add_steps(steps)

    def announced(self, home: PeerGraph, announcement: Announcement) -> Iterator[None]:
        """Take changes of what a hub has, a record with each step."""
        return self._announced.take(home, announcement)

    def reported_older(self, node: str, hub: str) -> None:
        """Called when another hub has closed a node, as one of this name is older."""
        self._nodes.reported_older(node, hub)

    def interest_changed(self, topic: str) -> None:
        """Begin or cease to ask for the messages of a topic's publishers, as other hubs want."""
        self._work.add("topics", topic)

    def close(self) -> None:
        """Detach what is left of hubs that are lost."""
        self._work.finish()

    # Changes of the graph.

    def _node_changed(self, name: str) -> None:
        found = self._graph.nodes.get(name)
        is_remote = isinstance(found, RemoteNode)
        self.ages.note("nodes", name, None if is_remote else found, is_remote=is_remote)
        if self._announced.of("nodes", name):
            self._work.add("nodes", name)

    def _topic_changed(self, topic: Topic) -> None:
        if self.topics.uses(topic.name):
            self._work.add("topics", topic.name)

    def _served_changed(self, kind: Kind, name: str) -> None:
        if self.services.note_change(kind, name):
            self._work.add(kind, name)

    def _entered(self, node: RemoteNode) -> None:
        """Attach what a node uses and serves that has been attached."""
        for topic in node.home.topics_of.get(node.name, ()):
            self._work.add("topics", topic)
        for kind, served in node.home.served_by.get(node.name, ()):
            self._work.add(kind, served)

    def _leaving(self, node: RemoteNode) -> None:
        """Detach, name by name, what a node uses and serves that is about to leave."""
        self.topics.abandon(node.published.values(), chain(*node.subscribed.values()))
        self._graph.abandon(self.services.served_by(node))
        used = node.home.topics_of.get(node.name, ())
        for topic in {*used, *node.published, *node.subscribed}:
            self._work.add("topics", topic)
        for kind, served in {*node.home.served_by.get(node.name, ()), *node.served}:
            self._work.add(kind, served)

    def _definition_arrived(self, kind: Kind, name: str) -> None:
        if kind == "topics":
            self.topics.try_again(name)
        self._work.add(kind, name)
