"""The graph: nodes, topics, services, actions, parameters, types, and the policy on their use.

It does what ROS's master does, and it relays. It knows no sockets, frames or operations: clients,
bridges and recorders attach to it as nodes, sources and sinks of topics, and as servers and clients
of services and actions. Only the methods here add and remove these, each of which asks the policy.
A topic is kept while it is used, so that a client which makes up thousands of names leaves nothing.
"""

from __future__ import annotations

import logging
import secrets
from collections.abc import Callable, Hashable, Iterable, Iterator, Mapping
from functools import partial
from typing import Any, Literal, TypeAlias
from uuid import uuid4
from weakref import WeakValueDictionary

from fibws import names
from fibws.access.rights import Principal
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
from fibws.hub.graph.conflicts import MOST_TYPES, ConflictReport, ConflictReports
from fibws.hub.graph.latched import LatchQuota, LatchTotal
from fibws.hub.graph.nodes import GraphNode
from fibws.hub.graph.parameters import Parameters, Prepared, canonical, names_in, prepare
from fibws.hub.graph.policy import AllowAll, Policy
from fibws.hub.graph.rights import GraphRights
from fibws.hub.graph.service import Call, Function, InternalServer, Service, ServiceServer
from fibws.hub.graph.topic import (
    QUEUE_SIZE,
    Conflict,
    Receiver,
    Sink,
    Source,
    Topic,
)
from fibws.hub.graph.topic_groups import TopicGroups, type_name
from fibws.hub.graph.totals import CallTotals, TopicTotals
from fibws.hub.graph.type_group import TypeGroup
from fibws.hub.graph.types import ServiceType, Types, unknown_service
from fibws.hub.graph.view import GraphView
from fibws.interfaces import Interfaces

logger = logging.getLogger("fibws.hub")

CANCEL_GOAL = "action_msgs/CancelGoal"
ROSBRIDGE = "/rosbridge_websocket"
"""The hub's own node that stands for the real rosbridge server."""


Watched: TypeAlias = Literal["node", "service", "action"]
"""The kinds of changes that `Graph.watch` reports."""
ONE_TYPE = (
    "a node publishes a topic with one type: end its other publisher first, or take another topic"
)
"""The advice to a node that publishes a topic with a second type."""


def exhaust(work: Iterator[None]) -> None:
    """Do all steps of some work at once."""
    for _ in work:
        pass


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
        self.rights = GraphRights(self.policy)
        """What nodes may do, by the policy."""
        self.latched = LatchTotal()
        """The bytes of all latched messages and wills."""
        self.permanent: set[str] = set()
        """The hub's own nodes whose names no client may take. With a policy, all are."""
        self.reserved: set[str] = set()
        """The topics that only the hub's own nodes may publish."""
        self.finish: Callable[[Iterator[None]], object] = exhaust
        """Does work step by step, some of it possibly later."""
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
        """Incremented on every change except those of parameters."""
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
        self._conflicts = ConflictReports(self.view, lambda work: self.finish(work))
        self._groups = TopicGroups(
            self.topics,
            self._types,
            self.rights.internal,
            self._conflicts,
            later=lambda work: self.finish(work),
            touch=self._touch,
            changed=self._changed,
        )

    def latch_quota(
        self, limit: int, node: str = "", report: Callable[[str], object] = lambda text: None
    ) -> LatchQuota:
        """Return what bounds the latched messages of a node; arguments as of `LatchQuota`."""
        return LatchQuota(limit, self.latched, node, report)

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
            if name in self.rights.internal and not is_replaceable:
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
        """Mark sources, sinks, services or actions that are about to be removed.

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

    def _touch(self) -> None:
        self.revision += 1

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
        if topic.name in self.reserved and node not in self.rights.internal:
            raise OperationError(f"{topic.name} is published by the hub alone")
        self.rights.check(node, "publish", topic.name)
        self._remove_left(topic)
        try:
            group, named, type_was = self._groups.join(topic, type_, definition, md5sum, node)
            if serialized and named.fault:
                named.check_known()
            source = topic.publishers.get(node)
            if source is not None and source.group is not group:
                raise TypeConflict(topic.name, named.name, source.type.name, node, ONE_TYPE)
            if (
                topic.name in self.rights.guards
                and topic.main is not group
                and topic.type is not None
            ):
                raise TypeConflict(topic.name, named.name, topic.type.name, topic.main.members()[0])
        except Exception:
            self._groups.settle(topic)
            raise
        if source is None:
            make = self.rights.source_class(node, topic)
            source = make(
                node,
                group,
                named,
                self.clock.now,
                latch=latch,
                quota=quota or LatchQuota(),
                queue_size=queue_size,
            )
            self._groups.keep(topic)
            topic.add(source, linked=linked)
            self._groups.settle(topic)
        elif named is not type_was:
            self._changed(topic)
        self._conflicts.report_to(group, source, on_conflict)
        return source

    def remove_source(self, source: Source) -> None:
        """Remove a source from its topic."""
        self._left.discard(source)
        source.forget_latched()
        if source.is_attached:
            self.messages.source_left(source)
        source.topic.remove(source)
        self._groups.settle(source.topic)

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
        self.rights.check(sink.node, "subscribe", topic.name)
        self._remove_left(topic)
        try:
            present = topic.named_by(sink)
            group = present if keeps_type else None
            if type_ is not None:
                own = present if keeps_type else None
                group, named, _ = self._groups.join(
                    topic, type_, definition, md5sum, sink.node, own
                )
                if keeps_type and present not in (None, group):
                    raise TypeConflict(topic.name, named.name, type_name(present), sink.node)
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
                holds_type=self.rights.allows(sink.node, "publish", topic.name),
                needs_definition=needs_definition,
                linked=linked,
            )
            self._groups.keep(topic)
        finally:
            # It may have failed, or replace a request that named the type.
            self._groups.settle(topic)
        if group is not None:
            self._conflicts.report_to(group, sink, on_conflict)

    def unsubscribe(self, topic: Topic, sink: Sink) -> None:
        """Remove a sink from a topic."""
        self._left.discard(sink)
        if topic.has_sink(sink):
            self.messages.sink_left(topic, sink.report())
        topic.detach(sink)
        self._groups.settle(topic)

    def add_conflict(self, topic: Topic, conflict: Conflict) -> None:
        """Note on a topic that a node outside the hub uses it as the graph cannot."""
        self._groups.keep(topic)
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
            self._groups.remove_idle(topic)
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
        self.rights.check(server.node, "provide", name)
        if type_ is None:
            service_type = unknown_service()
        else:
            service_type = self._types.service(Interfaces.canonical(type_), definition, server.node)
        older = self._service(name)
        if older is not None and isinstance(older.server, InternalServer):
            raise OperationError(f"Service {name} is the hub's own ({older.node})")
        self.rights.check_free("Service", name, older, server.node)
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
            self.rights.check(caller, "call", name)
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
        """Let a client serve an action; arguments and errors are those of `serve`.

        Goals of earlier advertisements of the name go on at their servers. All can be cancelled by
        a service beside the action, too, as in ROS 2.
        """
        self.rights.check(server.node, "provide", name)
        action_type = self._types.action(Interfaces.canonical(type_), definition, server.node)
        older = self._action(name)
        self.rights.check_free("Action", name, older, server.node)
        cancelling = cancel_service(name)
        self.rights.check_free("Service", cancelling, self._service(cancelling), server.node)
        if older is not None:
            self.remove_action(older)
        goals = self._goals.setdefault(name, Goals())
        action = self.actions[name] = Action(name, action_type, server, goals)
        self._types.hold(action_type, action)
        self.serve_internally(
            cancel_service(action.name),
            CANCEL_GOAL,
            server.node,
            lambda request, caller: cancel_goals(
                action, request, partial(self.rights.may_end, caller)
            ),
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
        self.rights.check(caller, "call", name)
        action = self._action(name)
        if action is None:
            raise CallFailed(f"Action {name} does not exist", "unknown_action")
        wanted = Interfaces.canonical(type_)
        if wanted != action.type.name and not self._is_same_action(action, wanted, caller):
            text = f"Action {name} is of type {action.type.name}, not {wanted}"
            raise CallFailed(text, "type_conflict")
        uuid = uuid4().bytes  # A client may still mean a goal of a hub that was restarted.
        return Goal(action, args, client, caller, uuid, self.clock.now())

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
            self.rights.check_writable(node, name, (*new, *self.parameters.replaced_by(name)))
        self.parameters.put(prepared or prepare(name, value), node)

    def delete_parameter(self, node: str, name: str) -> None:
        """Delete a parameter if there is one; raises `NotAllowed`, and as `Parameters.delete`."""
        name = canonical(name)
        self.rights.check_writable(node, name, self.parameters.below(name))
        if self.parameters.has(name):
            self.parameters.delete(name, node)
