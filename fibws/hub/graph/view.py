"""The graph as one node sees it: what the policy hides from it looks as if it were not there.

Whatever answers a client reads the graph by a view of that client's node, so that nothing has to
remember to ask.
"""

from __future__ import annotations

from collections.abc import Collection, Hashable, Iterable
from operator import attrgetter
from typing import TYPE_CHECKING

from fibws.errors import ParameterNotSet
from fibws.hub.graph.action import Action
from fibws.hub.graph.conflicts import list_conflicts
from fibws.hub.graph.parameters import canonical
from fibws.hub.graph.policy import RIGHTS_OF, Kind
from fibws.hub.graph.service import Service
from fibws.hub.graph.topic import Conflict, Sink, Source, Topic
from fibws.hub.graph.type_group import TypeGroup

if TYPE_CHECKING:
    from fibws.hub.graph.graph import Graph
    from fibws.hub.graph.nodes import GraphNode

_node_of = attrgetter("node")


class GraphView:
    """The graph as one node sees it.

    A view is made for each answer and keeps nothing. Names of others are global, and lists sorted.

    Args:
        caller: the node that sees it.
    """

    __slots__ = ("_graph", "_sees_all", "caller")

    def __init__(self, graph: Graph, caller: str) -> None:
        self._graph = graph
        self._sees_all = graph.policy.allows_all
        self.caller = caller

    # What it sees.

    def sees(self, kind: Kind, name: str) -> bool:
        """Return whether it may learn that something of this name exists."""
        if self._sees_all:
            return True
        graph, caller = self._graph, self.caller
        return any(graph.rights.allows(caller, right, name) for right in RIGHTS_OF[kind])

    def sees_node(self, name: str) -> bool:
        """Return whether it may learn that another node exists.

        It sees the nodes of its own principal, and those that use anything that it sees.
        """
        graph, policy = self._graph, self._graph.policy
        if self._sees_all or self.caller in graph.rights.internal:
            return True
        node = graph.nodes.get(name)
        if node is None:
            return False
        if policy.is_same_owner(self.caller, name) or policy.is_admin(self.caller):
            return True
        # Nearly every node publishes the log: that alone must not show it to everybody.
        topics = {*node.publishing(), *node.subscribing()}.difference(graph.rights.guards)
        return any(self.sees("topic", each) for each in topics) or any(
            self.sees("service", each) for each in node.providing()
        )

    def sees_user(self, topic: Topic, node: str) -> bool:
        """Return whether it may learn that a node uses a topic that it sees.

        It may, except for the log: every node sees that topic, as it may write to it.
        """
        return not self.hides_users(topic) or self.sees_node(node)

    def hides_users(self, topic: Topic) -> bool:
        """Return whether some users of a topic that it sees may be hidden from it."""
        return not self._sees_all and topic.name in self._graph.rights.guards

    def sees_address(self, node: str) -> bool:
        """Return whether it may learn from where a node has connected."""
        policy = self._graph.policy
        return policy.is_admin(self.caller) or policy.is_same_owner(self.caller, node)

    def sees_holder(self, holder: Hashable) -> bool:
        """Return whether it sees what has a type that a client brought, and so may learn it."""
        if self._sees_all:
            return True
        match holder:
            case TypeGroup(name=name):
                return self.sees("topic", name)
            case Service(name=name):
                return self.sees("service", name)
            case Action(name=name):
                return self.sees("action", name)
        return False

    # Topics.

    def topics(self) -> list[str]:
        """Return the names of all topics."""
        return self._visible("topic", self._graph.topics)

    def all_topics(self) -> list[Topic]:
        """Return all topics, sorted by their names."""
        return [self._graph.topics[name] for name in self.topics()]

    def topic(self, name: str) -> Topic | None:
        """Return a topic; read its users by the methods here."""
        topic = self._graph.topics.get(name)
        return topic if topic is not None and self.sees("topic", name) else None

    def publishers(self, topic: Topic) -> Collection[str]:
        """Return the nodes that publish on a topic, in no order."""
        return self._shown(topic.sources) if self.hides_users(topic) else topic.sources

    def subscribers(self, topic: Topic) -> Collection[str]:
        """Return the nodes that subscribe to a topic, in no order."""
        nodes = topic.subscribers()
        return self._shown(nodes) if self.hides_users(topic) else nodes

    def sources(self, topic: Topic) -> list[Source]:
        """Return the sources of a topic by their nodes' names."""
        sources = topic.sources
        return [sources[node] for node in sorted(self.publishers(topic))]

    def sinks(self, topic: Topic) -> list[Sink]:
        """Return the sinks of a topic by their nodes' names."""
        sinks: Iterable[Sink] = topic.sinks()
        if self.hides_users(topic):
            seen = set(self.subscribers(topic))
            sinks = (each for each in sinks if each.node in seen)
        return sorted(sinks, key=_node_of)

    def conflicts(self, topic: Topic) -> list[Conflict]:
        """Return the nodes that use a topic with another type than it has."""
        if len(topic.groups) == 1 and not topic.unattached:
            return []
        return sorted(set(list_conflicts(topic, self)))

    def _shown(self, nodes: Iterable[str]) -> list[str]:
        return [each for each in nodes if self.sees_node(each)]

    # Services and actions.

    def services(self) -> list[str]:
        """Return the names of all services."""
        return self._visible("service", self._graph.services)

    def all_services(self) -> list[Service]:
        """Return all services, sorted by their names."""
        return [self._graph.services[name] for name in self.services()]

    def service(self, name: str) -> Service | None:
        """Return a service."""
        service = self._graph.services.get(name)
        return service if service is not None and self.sees("service", name) else None

    def actions(self) -> list[str]:
        """Return the names of all actions."""
        return self._visible("action", self._graph.actions)

    def all_actions(self) -> list[Action]:
        """Return all actions, sorted by their names."""
        return [self._graph.actions[name] for name in self.actions()]

    def action(self, name: str) -> Action | None:
        """Return an action."""
        action = self._graph.actions.get(name)
        return action if action is not None and self.sees("action", name) else None

    # Nodes.

    def nodes(self) -> list[str]:
        """Return the names of all nodes."""
        return sorted(self._shown(self._graph.nodes))

    def all_nodes(self) -> list[tuple[str, GraphNode]]:
        """Return all nodes with their names, sorted by these."""
        return [(name, self._graph.nodes[name]) for name in self.nodes()]

    def node(self, name: str) -> GraphNode | None:
        """Return a node; read what it uses by the methods here."""
        node = self._graph.nodes.get(name)
        return node if node is not None and self.sees_node(name) else None

    def published_by(self, node: GraphNode) -> list[str]:
        """Return the topics that a node publishes."""
        return self._visible("topic", node.publishing())

    def subscribed_by(self, node: GraphNode) -> list[str]:
        """Return the topics that a node subscribes to."""
        return self._visible("topic", node.subscribing())

    def provided_by(self, node: GraphNode) -> list[str]:
        """Return the services that a node provides."""
        return self._visible("service", node.providing())

    # Parameters.

    def parameters(self) -> list[str]:
        """Return the names of all parameters."""
        return self._visible("parameter", self._graph.parameters.names())

    def has_parameter(self, name: str) -> bool:
        """Return whether there is a parameter or a namespace of this name; raises `InvalidName`."""
        return self._graph.parameters.has(name) and self._sees_parameter(name)

    def search_parameter(self, name: str, node: str) -> str | None:
        """Return the parameter of a name that is nearest to a node; see `Parameters.search`."""
        return self._graph.parameters.search(name, node, self._sees_parameter)

    def _sees_parameter(self, name: str) -> bool:
        """Return whether it may learn that there is a parameter, or anything in a namespace."""
        if self._sees_all:
            return True
        below = self._graph.parameters.below(name) or (canonical(name),)
        return any(self.sees("parameter", each) for each in below)

    def may_read(self, name: str) -> bool:
        """Return whether it may read a parameter, or anything of a namespace."""
        graph, caller = self._graph, self.caller
        if self._sees_all or graph.rights.allows(caller, "param_read", name):
            return True
        below = graph.parameters.below(name)
        return any(graph.rights.allows(caller, "param_read", each) for each in below)

    def parameter(self, name: str) -> bytes:
        """Return a parameter's value as JSON; of a namespace, what may be read of it.

        Raises:
            NotAllowed: the policy forbids it, or would, if there were such a parameter.
            ParameterNotSet, InvalidName: as `Parameters.text`.
        """
        name, graph, caller = canonical(name), self._graph, self.caller
        if self._sees_all:
            return graph.parameters.text(name)
        below = [each for each in graph.parameters.below(name) if each != name]
        readable = [each for each in below if graph.rights.allows(caller, "param_read", each)]
        if not readable:
            graph.rights.check(caller, "param_read", name)
        if below and not readable:
            raise ParameterNotSet(name)
        if len(readable) == len(below):
            return graph.parameters.text(name)
        return graph.parameters.text(name, readable)

    def _visible(self, kind: Kind, names: Iterable[str]) -> list[str]:
        if self._sees_all:
            return sorted(names)
        return sorted(name for name in names if self.sees(kind, name))
