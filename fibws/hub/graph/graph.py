"""The graph: nodes, topics, services, actions, parameters, types, and the policy on their use.

It does what ROS's master does, and it relays. It knows no sockets, frames or operations: clients,
bridges and recorders attach to it as nodes, sources and sinks of topics, and as servers and clients
of services and actions. Only the methods here add and remove these, each of which asks the policy.
A topic is kept while it is used, so that a client which makes up thousands of names leaves nothing.
"""

from __future__ import annotations

import logging
import secrets
from abc import ABC, abstractmethod
from collections.abc import Callable, Hashable, Iterable, Iterator, Mapping
from functools import cache, partial
from typing import Any, Literal, Protocol, TypeAlias
from uuid import uuid4
from weakref import WeakValueDictionary

from fibws import names
from fibws.access.rights import Principal, Right
from fibws.errors import InterfaceError, OperationError
from fibws.hub.errors import (
    CallFailed,
    DefinitionMismatch,
    LimitReached,
    NotAllowed,
    TypeConflict,
    UnknownDefinition,
)
from fibws.hub.graph.action import (
    Action,
    ActionClient,
    ActionServer,
    Goal,
    Goals,
    cancel_goals,
    cancel_service,
)
from fibws.hub.graph.body import Body
from fibws.hub.graph.clock import GraphClock
from fibws.hub.graph.conflicts import MOST_TYPES, describe, summary
from fibws.hub.graph.latched import LatchQuota, LatchTotal
from fibws.hub.graph.numbers import Numbers
from fibws.hub.graph.parameters import Parameters, Prepared, canonical, names_in, prepare
from fibws.hub.graph.policy import AllowAll, Policy
from fibws.hub.graph.service import Call, Function, InternalServer, Service, ServiceServer
from fibws.hub.graph.topic import (
    QUEUE_SIZE,
    Conflict,
    Guard,
    GuardedSource,
    Receiver,
    Sink,
    Source,
    Topic,
)
from fibws.hub.graph.totals import CallTotals, TopicTotals
from fibws.hub.graph.type_group import TypeGroup
from fibws.hub.graph.types import ANY_TYPE, MessageType, ServiceType, Types, unknown_service
from fibws.hub.graph.view import GraphView
from fibws.interfaces import Interfaces

logger = logging.getLogger("fibws.hub")

CANCEL_GOAL = "action_msgs/CancelGoal"
ROSBRIDGE = "/rosbridge_websocket"
"""The hub's own node that stands for the real rosbridge server."""


ConflictReport: TypeAlias = Callable[[str], object]
"""Takes the reason why messages do not pass to others, or an empty text once they do."""
Watched: TypeAlias = Literal["node", "service", "action"]
"""The kinds of changes that `Graph.watch` reports."""


def _type_name(group: TypeGroup | None) -> str:
    return group.type.name if group is not None and group.type is not None else ""


def exhaust(work: Iterator[None]) -> None:
    """Do all steps of some work at once."""
    for _ in work:
        pass


class GraphNode(Protocol):
    """A node of the graph: a client, or a part of the hub itself."""

    def replaced(self) -> None:
        """Take note that another client has taken its name."""

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
        """Ask it to end; otherwise as `ping`."""


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


class Graph:
    """The graph of one hub.

    Args:
        now: returns the nanoseconds since 1970, for messages that ask for the time.
        strict_types: refuse types of unknown packages, rather than relay them unchecked.
        max_parameter_bytes: most bytes of JSON of all parameters together.
        policy: decides what nodes may do.
        ticks: returns the nanoseconds since some moment, to measure how long calls take; None
            uses ``now``, which may be set back.
    """

    def __init__(
        self,
        interfaces: Interfaces,
        now: Callable[[], int],
        *,
        strict_types: bool = False,
        max_parameter_bytes: int = 2**22,
        policy: Policy | None = None,
        ticks: Callable[[], int] | None = None,
    ) -> None:
        self.nodes: dict[str, GraphNode] = {}
        self.topics: dict[str, Topic] = {}
        self.services: dict[str, Service] = {}
        self.actions: dict[str, Action] = {}
        self.parameters = Parameters(max_parameter_bytes)
        self.policy: Policy = policy or AllowAll()
        self.latched = LatchTotal()
        """The bytes of all latched messages and wills."""
        self.internal: set[str] = set()
        """The hub's own nodes, for which the policy is not asked."""
        self.permanent: set[str] = set()
        """The hub's own nodes whose names no client may take. With a policy, all are."""
        self.reserved: set[str] = set()
        """The topics that only the hub's own nodes may publish."""
        self.guards: dict[str, Guard] = {}
        """By topics: further checks of what nodes publish there that are not admins."""
        self.finish: Callable[[Iterator[None]], object] = exhaust
        """Does work step by step, some of it possibly later."""
        self.on_refused: Callable[[NotAllowed], object] = lambda error: None
        """Takes each refusal of the policy, but those of a node's name."""
        self._topic_watchers: list[Callable[[Topic], None]] = []
        self._watchers: dict[Watched, list[Callable[[str], None]]] = {}
        self.now = now
        self.clock = GraphClock(now)
        """The time of messages, which may be simulated."""
        self.messages = TopicTotals(self.topics)
        """The messages of all topics so far."""
        self.calls = CallTotals(ticks or now)
        """The calls of all services so far."""
        self.revision = 0
        """Another number whenever something but the parameters has changed."""
        self._types = Types(interfaces, self.clock.now, strict=strict_types, shows=self._shows_type)
        self.definitions = self._types.definitions
        """The definitions of all types: the installed ones, and those that clients brought."""
        self._unnamed: set[str] = set()
        """The names given to nodes that requested none."""
        self._clients = 0
        self._left: set[object] = set()
        """The sources, sinks, services and actions of nodes that have left, which are removed one
        by one: to those that come meanwhile it is as if they were not there."""
        self._goals: WeakValueDictionary[str, Goals] = WeakValueDictionary()
        """The goals of each action's name, while it has a server or goals that have not ended."""
        self._topic_numbers = Numbers()

    def latch_quota(
        self, limit: int, node: str = "", report: Callable[[str], object] = lambda text: None
    ) -> LatchQuota:
        """Return what bounds the latched messages of a node; arguments as of `LatchQuota`."""
        return LatchQuota(limit, self.latched, node, report)

    # What nodes may do and see.

    def check_allowed(self, node: str, right: Right, name: str) -> None:
        """Raise `NotAllowed` unless the policy lets a node do this."""
        if not self.is_allowed(node, right, name):
            raise self.refused(NotAllowed(node, right, name))

    def refused(self, error: NotAllowed) -> NotAllowed:
        """Report an error that is about to be raised, and return it."""
        self.on_refused(error)
        return error

    def is_allowed(self, node: str, right: Right, name: str) -> bool:
        """Return whether a node may do this with a topic, service, action or parameter."""
        return node in self.internal or self.policy.may(node, right, name)

    def is_source_allowed(self, source: Source) -> bool:
        """Return whether a source may still publish as it does."""
        name = source.topic.name
        is_guarded = isinstance(source, GuardedSource) or name not in self.guards
        is_free = is_guarded or self.policy.is_admin(source.node)
        return is_free and self.is_allowed(source.node, "publish", name)

    def view(self, caller: str) -> GraphView:
        """Return the graph as a node sees it, from which that node gets all its answers."""
        return GraphView(self, caller)

    def _shows_type(self, node: str, holder: Hashable) -> bool:
        return not node or self.view(node).sees_holder(holder)

    # Nodes.

    def enter(
        self,
        node: GraphNode,
        name: str | None,
        principal: Principal | None = None,
        *,
        internal: bool = False,
    ) -> str:
        """Add a node under the requested name, or a generated one; return the name.

        An older node of that name is informed that it is replaced, as by ROS's master.

        Args:
            principal: who the node is, for the policy.
            internal: whether it is the hub's own, for which the policy is not asked.

        Raises:
            NotAllowed: the policy forbids the name, or it is the hub's own.
        """
        is_chosen = name is not None
        name = self._new_name() if name is None else name
        if not internal:
            is_replaceable = self.policy.allows_all and name not in self.permanent
            if name in self.internal and not is_replaceable:
                raise NotAllowed(name, "node", name, f"{name} is the hub's own node")
            is_taken = name in self.nodes
            self.policy.enter(name, principal, is_chosen=is_chosen, is_taken=is_taken)
        if is_chosen:
            self._unnamed.discard(name)
        else:
            self._unnamed.add(name)
        older = self.nodes.pop(name, None)
        self.nodes[name] = node
        if older is not None:
            try:
                older.replaced()
            except Exception:
                # The new node must not suffer from an error of the older one.
                logger.exception("%s: the older node of this name could not leave.", name)
        self._report("node", name)
        return name

    def _new_name(self) -> str:
        while True:
            self._clients += 1
            # Random digits: a name from before the hub's restart must not be another client's now.
            name = f"/client_{self._clients}_{secrets.token_hex(3)}"
            if name not in self.nodes:
                return name

    def leave(self, node: GraphNode, name: str) -> None:
        """Remove a node, unless another one has taken its name."""
        if self.nodes.get(name) is node:
            del self.nodes[name]
            self._unnamed.discard(name)
            self.policy.leave(name)
            self.definitions.forget_refusals(name)
            self._report("node", name)

    def abandon(self, registrations: Iterable[object]) -> None:
        """Take note that sources, sinks, services or actions are about to be removed.

        A node may leave many, and others have their turns meanwhile. Whoever comes under its name,
        or uses one of its names, finds them gone.
        """
        self._left.update(registrations)

    def has_left(self, registration: object) -> bool:
        """Return whether the node of a source, sink, service or action has left, as `abandon`."""
        return registration in self._left

    def _remove_left(self, topic: Topic) -> None:
        """Remove the users of a topic whose nodes have left, before another one comes."""
        left = self._left
        if left:
            for source in [each for each in topic.publishers.values() if each in left]:
                self.remove_source(source)
            for sink in [each for each in topic.all_sinks() if each in left]:
                self.unsubscribe(topic, sink)

    def _service(self, name: str) -> Service | None:
        """Return the service of this name, unless its node has left."""
        service = self.services.get(name)
        if service is not None and service in self._left:
            self.remove_service(service)
            return None
        return service

    def _action(self, name: str) -> Action | None:
        """Return the action of this name, unless its node has left."""
        action = self.actions.get(name)
        if action is not None and action in self._left:
            self.remove_action(action)
            return None
        return action

    def authorize(self, node: GraphNode, name: str, principal: Principal) -> None:
        """Give a living node the rights of a principal.

        Raises:
            NotAllowed: the principal may not have its name, or another node has it by now.
        """
        if self.nodes.get(name) is not node:
            raise NotAllowed(name, "node", name, f"another client is {name} now")
        is_chosen = name not in self._unnamed
        self.policy.enter(name, principal, is_chosen=is_chosen, is_taken=False)
        self.revision += 1

    def revoke(self, node: GraphNode, name: str) -> None:
        """Take all rights from a node that is about to leave, as its token is gone.

        Nothing is taken from another one that has its name by now.
        """
        if self.nodes.get(name) is node:
            self.policy.leave(name)
            self.revision += 1

    def resolve(self, name: str, node: str) -> str:
        """Return the global name of a topic, a service, an action or a node that a node means.

        The private names of nodes that did not choose their own name are `ROSBRIDGE`'s, as all
        clients of the real rosbridge server are that one node.

        Raises:
            InvalidName: as `names.resolve_any`.
        """
        return names.resolve_any(name, node=ROSBRIDGE if node in self._unnamed else node)

    def header(self, node: str, headers: Mapping[str, str]) -> dict[str, str]:
        """Return a node's connection header.

        A node may choose its ``callerid``, as in ROS, unless there are principals to tell apart.
        """
        own = {"callerid": node}
        return {**own, **headers} if self.policy.allows_all else {**own, **headers, **own}

    # Topics.

    def watch_topics(self, changed: Callable[[Topic], None]) -> None:
        """Call a function whenever the sources, the sinks or the type of a topic have changed."""
        self._topic_watchers.append(changed)

    def watch(self, kind: Watched, changed: Callable[[str], None]) -> None:
        """Call a function, with the name, when a node, service or action is added or removed."""
        self._watchers.setdefault(kind, []).append(changed)

    def _report(self, kind: Watched, name: str) -> None:
        self.revision += 1
        for changed in self._watchers.get(kind, ()):
            changed(name)

    def _changed(self, topic: Topic) -> None:
        self.revision += 1
        for changed in self._topic_watchers:
            changed(topic)

    def type_name(self, type_: str) -> str:
        """Return ``package/Type`` for either spelling of a type; raise `InvalidTypeName`."""
        return Interfaces.canonical(type_)

    def topic(self, name: str) -> Topic:
        """Return the topic of this global name; a new one is kept once it has a user."""
        return self.topics.get(name) or Topic(name)

    def advertise(
        self,
        topic: Topic,
        node: str,
        type_: str,
        definition: str | None = None,
        *,
        latch: bool = False,
        quota: LatchQuota | None = None,
        queue_size: int = QUEUE_SIZE,
        serialized: bool = False,
        md5sum: str | None = None,
        linked: bool = True,
        on_conflict: ConflictReport | None = None,
    ) -> Source:
        """Return the node's source; the first call decides ``latch`` and ``queue_size``.

        Args:
            definition: the text of the type, if the client brought one.
            quota: bounds the node's latched messages; None bounds nothing.
            queue_size: as in `Source`.
            serialized: whether the node publishes messages in ROS 1's serialization.
            md5sum: the md5 of the type as the client knows it.
            linked: False if messages arrive only after `Source.link`.
            on_conflict: takes the reason, whenever others use the topic with types with which no
                messages are exchanged, and an empty text when that ends.

        Raises:
            NotAllowed: the policy forbids it.
            OperationError: the topic is the hub's own.
            TypeConflict: the node publishes it with another type, or the topic is the hub's own.
            DefinitionMismatch: the md5 is another one.
            UnknownDefinition: messages are serialized, but there is no room for the definition.
            InterfaceError: the type's name is not valid, or its package does not have it.
        """
        if topic.name in self.reserved and node not in self.internal:
            raise OperationError(f"{topic.name} is published by the hub alone")
        self.check_allowed(node, "publish", topic.name)
        self._remove_left(topic)
        try:
            group, named, type_was = self._join_type(topic, type_, definition, md5sum, node)
            if serialized and named.fault:
                named.check_known()
            source = topic.publishers.get(node)
            if source is not None and source.group is not group:
                raise TypeConflict(topic.name, named.name, source.type.name, node)
            if topic.name in self.guards and topic.main is not group and topic.type is not None:
                raise TypeConflict(topic.name, named.name, topic.type.name, topic.main.members()[0])
        except Exception:
            self._settle(topic)
            raise
        if source is None:
            make = self._source_class(node, topic)
            source = make(
                node,
                group,
                named,
                self.clock.now,
                latch=latch,
                quota=quota or LatchQuota(),
                queue_size=queue_size,
            )
            self._keep(topic)
            topic.add(source, linked=linked)
            self._settle(topic)
        elif named is not type_was:
            self._changed(topic)
        self._report_to(group, source, on_conflict)
        return source

    def _source_class(self, node: str, topic: Topic) -> Callable[..., Source]:
        guard = self.guards.get(topic.name)
        is_free = guard is None or node in self.internal or self.policy.is_admin(node)
        return Source if guard is None or is_free else partial(GuardedSource, guard)

    def remove_source(self, source: Source) -> None:
        """Remove a source from its topic."""
        self._left.discard(source)
        source.forget_latched()
        if source.is_attached:
            self.messages.source_left(source)
        source.topic.remove(source)
        self._settle(source.topic)

    def subscribe(
        self,
        topic: Topic,
        sink: Sink,
        type_: str | None = None,
        *,
        receiver: Callable[[TypeGroup | None], Receiver] | None = None,
        follow: Callable[[], object] | None = None,
        keeps_type: bool = False,
        takes_all: bool = False,
        needs_definition: bool = False,
        serialized: bool = False,
        definition: str | None = None,
        md5sum: str | None = None,
        linked: bool = True,
        on_conflict: ConflictReport | None = None,
    ) -> None:
        """Add a sink to a topic, or change how it is subscribed.

        Args:
            type_: the type of its messages, if the sink names one; else it gets those of all types.
            receiver: returns what takes the messages of a group, or of all, for the sink; see
                `Topic.attach`.
            follow: called when publishers have another type of the name that the sink has given,
                without a definition or an md5, and those of its own type have gone; it subscribes
                the sink again.
            keeps_type: whether the sink still names the type that it has named before.
            takes_all: whether it gets the messages of all types although it names one.
            needs_definition: whether the topic keeps the definition of its type, too, and not only
                the name.
            serialized: whether the sink needs messages in ROS 1's serialization.
            definition: the text of the type, if the client brought one.
            md5sum: the md5 of the type as the client knows it.
            linked: False if messages pass only after `Topic.sink_linked`.
            on_conflict: as of `advertise`.

        Raises:
            TypeConflict: the sink keeps another type.
            OperationError: messages cannot be serialized, as the fields of the type are unknown;
                others as `advertise`. The sink is subscribed as before.
        """
        self.check_allowed(sink.node, "subscribe", topic.name)
        self._remove_left(topic)
        try:
            present = topic.named_by(sink)
            group = present if keeps_type else None
            if type_ is not None:
                own = present if keeps_type else None
                group, named, _ = self._join_type(topic, type_, definition, md5sum, sink.node, own)
                if keeps_type and present not in (None, group):
                    raise TypeConflict(topic.name, named.name, _type_name(present), sink.node)
                if not group.is_used and len(topic.groups) > MOST_TYPES:
                    raise LimitReached(f"too many types of {topic.name} (limit {MOST_TYPES})")
            wanted = topic.type if group is None or takes_all else group.type
            if serialized and wanted is not None:
                wanted.check_known()
            topic.attach(
                sink,
                sink if receiver is None else receiver(None if takes_all else group),
                group,
                follow=follow,
                takes_all=takes_all,
                # A node without the right to publish must not fix the type for those that have it.
                holds_type=self.is_allowed(sink.node, "publish", topic.name),
                needs_definition=needs_definition,
                linked=linked,
            )
            self._keep(topic)
        finally:
            # It may have failed, or replace a request that named the type.
            self._settle(topic)
        if group is not None:
            self._report_to(group, sink, on_conflict)

    def unsubscribe(self, topic: Topic, sink: Sink) -> None:
        """Remove a sink from a topic."""
        self._left.discard(sink)
        if topic.has_sink(sink):
            self.messages.sink_left(topic, sink.report())
        topic.detach(sink)
        self._settle(topic)

    def _join_type(
        self,
        topic: Topic,
        type_: str,
        definition: str | None,
        md5sum: str | None,
        node: str,
        own: TypeGroup | None = None,
    ) -> tuple[TypeGroup, MessageType, MessageType | None]:
        """Return the group of the type that a node names, its type, and that which it had before.

        A group keeps its type when a node names another type with equal fields: as in ROS 1, where
        the md5 counts when nodes connect.

        Args:
            own: the group that the node is in already and may not leave.
        """
        name = Interfaces.canonical(type_)
        known = cache(partial(self._known_type, name, definition, md5sum, node))
        is_exact = definition is not None or md5sum not in (None, ANY_TYPE)
        group = _named_group(topic, name, own) if not is_exact else None
        group = group or self._find_group(topic, name, known)
        present = group.type if group is not None else None
        if group is not None and present is not None and (group.is_held or group is own):
            wanted = present
            if present.name == name and not present.checked:
                wanted = _updated(present, known, needs_definition=definition is not None)
        else:
            wanted = known()
        _check_md5sum(wanted, md5sum)
        if group is None:
            group = topic.add_group()
            if topic.main.number:
                self._number(group)
        if wanted is not present:
            self._change_type(group, wanted)
        return group, wanted, present

    def _known_type(
        self, name: str, definition: str | None, md5sum: str | None, node: str
    ) -> MessageType:
        """Return the type that a node means."""
        if node in self.internal:
            return self._types.own_message(name)
        return self._types.message(name, definition, node, md5sum)

    def _find_group(
        self, topic: Topic, name: str, known: Callable[[], MessageType]
    ) -> TypeGroup | None:
        """Return the group of a type, or one whose fields are unknown, or that has no type.

        Types of one name with other fields are other types.
        """
        try:
            md5sum = known().md5sum
        except InterfaceError:
            md5sum = None
        named = [each for each in topic.groups if each.type is not None and each.type.name == name]
        for group in (*named, *topic.groups):
            if md5sum is not None and group.type is not None and group.type.md5sum == md5sum:
                return group
        for group in named:
            if group.type is not None and not group.type.checked:
                return group
        return next((each for each in topic.groups if each.type is None), None)

    def _change_type(self, group: TypeGroup, type_: MessageType | None) -> None:
        """Set a group's type, or None, and hold its definition."""
        self.revision += 1
        older, group.type = group.type, type_
        if type_ is not None and type_.checked:
            sort = (type_.name, type_.md5sum)
            if group.number and group.last_type not in (None, sort):
                # Messages of both types may be on their way to one client.
                self._number(group)
            group.last_type = sort
            for source in group.sources.values():
                source.type = type_
        if older is not None:
            self._types.release(older, group)
        if type_ is not None:
            self._types.hold(type_, group)

    def _keep(self, topic: Topic) -> None:
        """Add a topic to the graph, since it has a user."""
        if self.topics.get(topic.name) is not topic:
            self.topics[topic.name] = topic
            for group in topic.groups:
                self._number(group)

    def _number(self, group: TypeGroup) -> None:
        """Give a group of a topic of the graph another number."""
        self._topic_numbers.give_back(group.number)
        group.number = self._topic_numbers.take()

    def _take_number(self, group: TypeGroup) -> None:
        self._topic_numbers.give_back(group.number)
        group.number = 0

    def _remove_idle(self, topic: Topic) -> None:
        """Remove a topic that has no user left."""
        if topic.idle and self.topics.get(topic.name) is topic:
            del self.topics[topic.name]
            for group in topic.groups:
                self._take_number(group)

    def _settle(self, topic: Topic) -> None:
        """Remove the topic, its types, or their definitions if they have no holder left."""
        self._remove_idle(topic)
        for group in tuple(topic.groups):
            if group.type is not None and not group.needs_definition:
                type_ = self._types.without_definition(group.type) if group.is_used else None
                if type_ is not group.type:
                    self._change_type(group, type_)
        if len(topic.groups) > 1:
            self._settle_groups(topic)
            self._move_followers(topic)
        self._tell_conflicts(topic)
        self._changed(topic)

    def _settle_groups(self, topic: Topic) -> None:
        """Remove the groups that nobody uses any more, and choose the main one."""
        used = [each for each in topic.groups if each.is_used] or topic.groups[:1]
        for group in topic.groups:
            if group not in used:
                self._take_number(group)
        main = next((each for each in used if each.sources), None)
        main = main or next((each for each in used if each.is_held), used[0])
        topic.groups = [main, *(each for each in used if each is not main)]

    def _move_followers(self, topic: Topic) -> None:
        """Let sinks follow the publishers of the type that they name to another definition."""
        for group in topic.groups:
            if group.followers and not group.sources and not group.is_left:
                name = group.type.name if group.type is not None else ""
                others = (each for each in topic.groups if each.sources and each.type is not None)
                if any(each.type.name == name for each in others if each.type is not None):
                    group.is_left = True
                    self.finish(_leave(group))

    def _tell_conflicts(self, topic: Topic) -> None:
        """Tell the members of each group when the types have changed with which it conflicts."""
        groups = topic.groups
        if len(groups) == 1 and not groups[0].told:
            return
        for group in groups:
            news = summary(topic, group)
            if news != group.told:
                group.told = news
                if group.reports:
                    self.finish(self._tell(group, news))

    def _tell(self, group: TypeGroup, news: tuple[tuple[str, bool], ...]) -> Iterator[None]:
        for member in tuple(group.reports):
            if group.told is not news:
                return  # They are told of something newer.
            self._report_conflict(group, member)
            yield

    def _report_conflict(self, group: TypeGroup, member: Source | Sink) -> None:
        report = group.reports.get(member)
        if report is not None:
            topic = group.topic
            is_over = not group.told
            report("" if is_over else describe(topic, group, self.view(member.node)))

    def _report_to(
        self, group: TypeGroup, member: Source | Sink, report: ConflictReport | None
    ) -> None:
        """Have a member of a group told of conflicts from now on."""
        if report is not None:
            group.reports[member] = report
            if group.told:
                self._report_conflict(group, member)

    def add_conflict(self, topic: Topic, conflict: Conflict) -> None:
        """Note on a topic that a node outside the hub uses it as the graph cannot."""
        self._keep(topic)
        topic.unattached.append(conflict)
        self.revision += 1

    def remove_conflict(self, topic: Topic, node: str, *, publishes: bool) -> None:
        """Remove a conflict, if it is listed."""
        kept = [
            each
            for each in topic.unattached
            if each.node != node or each.publishes is not publishes
        ]
        if len(kept) < len(topic.unattached):
            topic.unattached[:] = kept
            self._remove_idle(topic)
            self.revision += 1

    # Services.

    def serve(
        self, name: str, type_: str | None, definition: str | None, server: ServiceServer
    ) -> Service:
        """Let a client serve a service; an older server is informed that it is displaced.

        Args:
            type_: the service's type; None until `learn_service_type`, which the server calls
                before it asks for a call's request.

        Raises:
            NotAllowed: the policy forbids it.
            OperationError: the service is the hub's own.
            InterfaceError: the type's name is not valid, or its package does not have it.
        """
        self.check_allowed(server.node, "provide", name)
        if type_ is None:
            service_type = unknown_service()
        else:
            service_type = self._types.service(Interfaces.canonical(type_), definition, server.node)
        older = self._service(name)
        if older is not None and isinstance(older.server, InternalServer):
            raise OperationError(f"Service {name} is the hub's own ({older.node})")
        self._check_free("Service", name, older, server.node)
        return self._serve(Service(name, service_type, server))

    def learn_service_type(
        self, service: Service, type_: str, definition: str | None, md5sum: str
    ) -> None:
        """Give a service its type, which its server has told.

        If the definition is unknown or another one, the service has a type by name only, and its
        server is to refuse calls.

        Args:
            definition: the text of the type; None for the one that the hub knows.
            md5sum: the md5 of the type as the server knows it.

        Raises:
            InterfaceError: the type's name is not valid, or its package does not have it.
            DefinitionMismatch: the md5 is another one.
            UnknownDefinition: the fields are unknown.
        """
        name = Interfaces.canonical(type_)
        try:
            found = self._types.service(name, definition, service.node, md5sum)
            if found.codecs is None:
                raise UnknownDefinition(name, found.fault)
            if found.md5sum != md5sum:
                raise DefinitionMismatch(name, md5sum, found.md5sum or "")
        except (InterfaceError, OperationError) as error:
            self._set_service_type(service, unknown_service(name, md5sum, str(error)))
            raise
        self._set_service_type(service, found)

    def _set_service_type(self, service: Service, type_: ServiceType) -> None:
        if self.services.get(service.name) is service:
            self._types.hold(type_, service)
            if type_.codecs is not service.type.codecs:
                self._types.release(service.type, service)
            service.type = type_
            self._report("service", service.name)
        service.type = type_

    def serve_internally(self, name: str, type_: str, node: str, function: Function) -> None:
        """Let the hub itself serve a service, as one of its own nodes."""
        self._serve(Service(name, self._types.own_service(type_), InternalServer(node, function)))

    def _serve(self, service: Service) -> Service:
        older = self._service(service.name)
        self.services[service.name] = service
        self._types.hold(service.type, service)
        if older is not None:
            self._types.release(older.type, older)
            older.server.displaced(older)
        self._report("service", service.name)
        return service

    def _check_free(self, kind: str, name: str, older: Service | Action | None, node: str) -> None:
        """Refuse to take a service or an action away from another principal's node."""
        if older is not None and not self.policy.is_same_owner(node, older.node):
            fault = f"{kind} {name} belongs to another principal"
            raise self.refused(NotAllowed(node, "provide", name, fault))

    def remove_service(self, service: Service) -> None:
        """Remove a service, unless another server has taken it over."""
        self._left.discard(service)
        if self.services.get(service.name) is service:
            del self.services[service.name]
            self._types.release(service.type, service)
            self._report("service", service.name)

    def call(
        self,
        name: str,
        args: object,
        caller: str,
        succeeded: Callable[[Call, Body], None],
        failed: Callable[[Call, str, str], None],
        headers: dict[str, str] | None = None,
    ) -> Call:
        """Return a new call of a service, which is still to be started; arguments as in `Call`.

        Raises:
            CallFailed: the service is unknown, or has another type than the caller expects.
            NotAllowed: the policy forbids it.
            InvalidMessage: the request does not fit the type.
        """
        try:
            self.check_allowed(caller, "call", name)
            service = self._service(name)
            if service is None:
                raise CallFailed(f"Service {name} does not exist", "unknown_service")
            return Call(service, args, caller, succeeded, failed, headers, self.calls)
        except OperationError as error:
            self.calls.refused(name, error.code)
            raise

    # Actions.

    def serve_action(
        self, name: str, type_: str, definition: str | None, server: ActionServer
    ) -> Action:
        """Let a client serve an action; otherwise as `serve`.

        Goals of earlier advertisements of the name go on at their servers. All can be cancelled by
        a service beside the action, too, as in ROS 2.
        """
        self.check_allowed(server.node, "provide", name)
        action_type = self._types.action(Interfaces.canonical(type_), definition, server.node)
        older = self._action(name)
        self._check_free("Action", name, older, server.node)
        cancelling = cancel_service(name)
        self._check_free("Service", cancelling, self._service(cancelling), server.node)
        if older is not None:
            self.remove_action(older)
        goals = self._goals.setdefault(name, Goals())
        action = self.actions[name] = Action(name, action_type, server, goals)
        self._types.hold(action_type, action)
        self.serve_internally(
            cancel_service(action.name),
            CANCEL_GOAL,
            server.node,
            lambda request, caller: cancel_goals(action, request, partial(self._may_end, caller)),
        )
        if older is not None:
            older.server.displaced(older)
        self._report("action", name)
        return action

    def send_goal(
        self, name: str, type_: str, args: object, client: ActionClient, caller: str
    ) -> Goal:
        """Return a new goal, which is still to be started.

        Raises:
            CallFailed: the action is unknown, or has another type.
            NotAllowed: the policy forbids it.
            InvalidMessage: the goal does not fit the type.
        """
        self.check_allowed(caller, "call", name)
        action = self._action(name)
        if action is None:
            raise CallFailed(f"Action {name} does not exist", "unknown_action")
        wanted = Interfaces.canonical(type_)
        if wanted != action.type.name and not self._is_same_action(action, wanted, caller):
            text = f"Action {name} is of type {action.type.name}, not {wanted}"
            raise CallFailed(text, "type_conflict")
        uuid = uuid4().bytes  # A client may still mean a goal of a hub that was restarted.
        return Goal(action, args, client, caller, uuid, self.clock.now())

    def _may_end(self, caller: str, goal: Goal) -> bool:
        """Return whether a node may cancel a goal: its own, or its principal's."""
        return self.policy.is_same_owner(caller, goal.caller) or self.policy.is_admin(caller)

    def _is_same_action(self, action: Action, type_: str, caller: str) -> bool:
        """Return whether an action's type and the one of this name have the same fields."""
        try:
            md5sums = self._types.action(type_, None, caller).md5sums
        except InterfaceError:
            return False
        return md5sums is not None and md5sums == action.type.md5sums

    def remove_action(self, action: Action) -> None:
        """Remove an action, unless another server has taken it over."""
        self._left.discard(action)
        if self.actions.get(action.name) is action:
            del self.actions[action.name]
            self._types.release(action.type, action)
            self.remove_service(self.services[cancel_service(action.name)])
            self._report("action", action.name)

    # Parameters.

    def set_parameter(
        self, node: str, name: str, value: Any, prepared: Prepared | None = None
    ) -> None:
        """Set a parameter; raises `NotAllowed`, and as `Parameters.set`.

        The node must have the right for everything that it sets or replaces.

        Args:
            prepared: the value as `prepare` returns it, if that was called before.
        """
        name = canonical(name)
        if not self.policy.allows_all:
            new = names_in(name, value) if isinstance(value, dict) else (name,)
            self._check_writable(node, name, (*new, *self.parameters.replaced_by(name)))
        self.parameters.put(prepared or prepare(name, value), node)

    def delete_parameter(self, node: str, name: str) -> None:
        """Delete a parameter if there is one; raises `NotAllowed`, and as `Parameters.delete`."""
        name = canonical(name)
        self._check_writable(node, name, self.parameters.below(name))
        if self.parameters.has(name):
            self.parameters.delete(name, node)

    def _check_writable(self, node: str, name: str, others: Iterable[str]) -> None:
        """Check the right to write a parameter and others, whose names the error does not hold."""
        if self.policy.allows_all:
            return
        affected = tuple(others) or (name,)
        if not all(self.is_allowed(node, "param_write", each) for each in affected):
            raise self.refused(NotAllowed(node, "param_write", name))


def _check_md5sum(type_: MessageType, md5sum: str | None) -> None:
    """Refuse a client whose definition of a type is another one."""
    if md5sum is not None and type_.md5sum is not None and md5sum not in (type_.md5sum, ANY_TYPE):
        raise DefinitionMismatch(type_.name, md5sum, type_.md5sum)


def _named_group(topic: Topic, name: str, own: TypeGroup | None) -> TypeGroup | None:
    """Return the group of a type that is only named: the node's own, or one that publishes."""
    named = [each for each in topic.groups if each.type is not None and each.type.name == name]
    if own in named:
        return own
    held = [each for each in named if each.is_held]
    return next((each for each in held if each.sources), held[0] if held else None)


def _updated(
    type_: MessageType, known: Callable[[], MessageType], *, needs_definition: bool
) -> MessageType:
    """Return a type of unknown fields, or the one in its place if they have become known."""
    try:
        found = known()
    except InterfaceError:
        if needs_definition:
            raise
        return type_
    return found if found.checked or found.fault else type_


def _leave(group: TypeGroup) -> Iterator[None]:
    """Let the followers of a group subscribe again, one by one."""
    for sink in tuple(group.followers):
        follow = group.followers.get(sink)
        if follow is not None and not group.sources:
            follow()
        yield
    group.is_left = False
