"""The announcements of this hub to other hubs."""

from __future__ import annotations

import logging
from collections.abc import Callable, Iterable
from functools import partial
from typing import Any

from fibws.access.rights import Right
from fibws.hub.federation.backplane import Backplane
from fibws.hub.federation.outlets import Outlets
from fibws.hub.federation.records import (
    KINDS,
    LONGEST_PATH,
    ActionRecord,
    Announcement,
    HubInfo,
    Kind,
    NodeRecord,
    ParameterRecord,
    PublisherRecord,
    Record,
    ServiceRecord,
    TopicRecord,
    TypeUsers,
)
from fibws.hub.federation.remote import RemoteGraph
from fibws.hub.federation.remote_logs import LogReader
from fibws.hub.federation.remote_nodes import RemoteNode
from fibws.hub.federation.shared_parameters import SharedParameters
from fibws.hub.foreign.worklist import Worklist
from fibws.hub.graph.graph import Graph
from fibws.hub.graph.nodes import NodeOfLink
from fibws.hub.graph.service import InternalServer
from fibws.hub.graph.topic import Topic
from fibws.hub.graph.type_group import TypeGroup

logger = logging.getLogger("fibws.hub")


class LinkNode(NodeOfLink):
    """The node of this graph that stands for a backplane; a `GraphNode`."""

    def __init__(self, backplane: Backplane) -> None:
        self.backplane = backplane

    def publishing(self) -> tuple[str, ...]:
        """Return nothing: the nodes of other hubs publish themselves."""
        return ()

    def subscribing(self) -> tuple[str, ...]:
        """Return nothing."""
        return ()

    def providing(self) -> tuple[str, ...]:
        """Return nothing."""
        return ()

    def replaced(self) -> None:
        """Close the backplane: a newer one, or another client, has its name."""
        self.backplane.replaced()


class Offers:
    """Announces this hub's graph on one backplane.

    Args:
        outlets: gives sources their numbers.
    """

    def __init__(
        self,
        backplane: Backplane,
        hub: HubInfo,
        graph: Graph,
        remote: RemoteGraph,
        parameters: SharedParameters,
        outlets: Outlets,
        call_soon: Callable[[Callable[[], None]], object],
    ) -> None:
        self.backplane = backplane
        self.graph = graph
        self._hub = hub
        self._remote = remote
        self._parameters = parameters
        self._outlets = outlets
        self._view = graph.view(backplane.node)
        self._announced: dict[Kind, dict[str, Record]] = {kind: {} for kind in KINDS}
        """The last records, by the names on the backplane."""
        self._users: dict[tuple[Kind, str], set[str]] = {}
        """The nodes of each topic, service and action, where only those make nodes visible."""
        self._changes: dict[Kind, dict[str, Any]] = {kind: {} for kind in KINDS}
        """The records that were made in this turn."""
        self._work = Worklist[Kind](
            call_soon,
            {kind: partial(self._compare, kind) for kind in KINDS},
            turn_ended=self._announce,
            is_paused=lambda: backplane.is_busy,
        )
        self._make: dict[Kind, Callable[[str], Record | None]] = {
            "nodes": self._node,
            "topics": self._topic,
            "services": self._service,
            "actions": self._action,
            "parameters": self._parameter,
        }

    def offer_all(self) -> None:
        """Announce everything."""
        self._announced = {kind: {} for kind in KINDS}
        graph = self.graph
        names: dict[Kind, Iterable[str]] = {
            **{"nodes": graph.nodes, "topics": graph.topics, "services": graph.services},
            **{"actions": graph.actions, "parameters": self._parameters.records},
        }
        for kind, each in names.items():
            for name in each:
                self._work.add(kind, name)

    def changed(self, kind: Kind, name: str) -> None:
        """Announce the change of a node, topic, service or action of this graph soon."""
        self._work.add(kind, name)

    def resume(self) -> None:
        """Announce changes again, now that the backplane is not busy."""
        self._work.resume()

    def close(self) -> None:
        """Announce nothing more."""
        self._work.close()

    # Announcing.

    def _announce(self) -> None:
        """Announce what was found to have changed."""
        changes: dict[Any, dict[str, Any]] = self._changes
        if any(changes.values()):
            self._changes = {kind: {} for kind in KINDS}
            self.backplane.announce(Announcement.model_construct(None, **changes))

    def _compare(self, kind: Kind, name: str) -> None:
        view, announced = self.backplane.view, self._announced[kind]
        outward = view.node_outward(name) if kind == "nodes" else view.outward(name)
        if outward is None:
            return
        record = self._make[kind](name)
        if record != announced.get(outward):
            if kind == "nodes" and (record is None or outward not in announced):
                self._note_sight()
            self._changes[kind][outward] = record
            if record is None:
                del announced[outward]
            else:
                announced[outward] = record

    def _node(self, name: str) -> NodeRecord | None:
        node: Any = self._view.node(name)
        if node is None or not self._may_offer(name) or not self._is_of_use(node):
            return None
        if isinstance(node, RemoteNode):
            path = (*node.record.path, self._hub)
            if len(path) > LONGEST_PATH:
                return None
            return NodeRecord.model_construct(
                path=path, since=node.since, replaces=node.record.replaces
            )
        return NodeRecord.model_construct(
            path=(self._hub,),
            since=self._remote.ages.since("nodes", name),
            replaces=self._remote.ages.replaced_hub("nodes", name),
        )

    def _is_of_use(self, node: Any) -> bool:
        """Return whether the other hubs have use for a node."""
        view = self.backplane.view
        if not view.is_filtered and (not view.prefix or view.is_below):
            return True
        used = (
            *((topic, view.may_export) for topic in (*node.publishing(), *node.providing())),
            *((topic, view.may_import) for topic in node.subscribing()),
        )
        return any(view.outward(topic) is not None and may(topic) for topic, may in used)

    def _topic(self, name: str) -> TopicRecord | None:
        topic = self._view.topic(name)
        if topic is None or name in self.graph.reserved:
            self._note_users("topics", name, set())
            return None
        main, *others = (self._users_of(topic, each) for each in topic.groups)
        self._note_users("topics", name, {*topic.publishers, *topic.all_subscribers()})
        used = tuple(each for each in others if each.publishers or each.subscribers)
        if not main.publishers and not main.subscribers and not used:
            return None
        return TopicRecord.model_construct(
            type=main.type,
            md5sum=main.md5sum,
            publishers=main.publishers,
            subscribers=main.subscribers,
            others=used,
        )

    def _users_of(self, topic: Topic, group: TypeGroup) -> TypeUsers:
        """Return the users of a topic with one type; nodes that name no type use all types."""
        name, view = topic.name, self._view
        publishers: tuple[PublisherRecord, ...] = ()
        if self._may(name, "subscribe", exports=True):
            publishers = self._publishers(topic, group)
        subscribers: tuple[str, ...] = ()
        if self._may(name, "publish", exports=False):
            seen = (each for each in group.listeners if view.sees_user(topic, each))
            subscribers = tuple(filter(self._may_offer, seen))
        type_ = topic.type if group is topic.main else group.type
        return TypeUsers.model_construct(
            type=type_.name if type_ is not None else "",
            md5sum=(type_.md5sum or "") if type_ is not None else "",
            publishers=publishers,
            subscribers=tuple(map(self.backplane.view.node_outward, subscribers)),
        )

    def _publishers(self, topic: Topic, group: TypeGroup) -> tuple[PublisherRecord, ...]:
        found = []
        for source in sorted(group.sources.values(), key=lambda each: each.node):
            node = source.node
            if not self._view.sees_user(topic, node):
                continue
            if self._may_offer(node):
                remote, number = (
                    self._remote.topics.by_source.get(source),
                    self._outlets.number(source),
                )
                found.append(
                    PublisherRecord.model_construct(
                        node=self.backplane.view.node_outward(node),
                        number=number,
                        origin=remote.publisher.origin if remote is not None else number,
                        latch=source.latch,
                        queue_size=source.queue_size,
                    )
                )
        return tuple(found)

    def _note_sight(self) -> None:
        """Announce topics again whose users are announced as far as the other hubs see them."""
        if not self.graph.policy.allows_all:
            for name in self.graph.rights.guards:
                self.changed("topics", name)

    def _note_users(self, kind: Kind, name: str, users: set[str]) -> None:
        """Announce nodes that began or ceased to use a name, if only that makes them visible."""
        view = self.backplane.view
        shows_all = not view.is_filtered and (not view.prefix or view.is_below)
        if shows_all and self.graph.policy.allows_all:
            return
        for node in users ^ self._users.get((kind, name), set()):
            self.changed("nodes", node)
        if users:
            self._users[kind, name] = users
        else:
            self._users.pop((kind, name), None)

    def _service(self, name: str) -> ServiceRecord | None:
        service = self._view.service(name)
        self._note_users("services", name, set() if service is None else {service.node})
        if service is None or isinstance(service.server, InternalServer):
            return None
        if service.type.codecs is None or not self._is_served("services", name, service.node):
            return None
        return ServiceRecord.model_construct(
            node=self.backplane.view.node_outward(service.node),
            type=service.type.name,
            md5sum=service.type.md5sum or "",
            since=self._served_since("services", name),
            replaces=self._remote.ages.replaced_hub("services", name),
        )

    def _action(self, name: str) -> ActionRecord | None:
        action = self._view.action(name)
        self._note_users("actions", name, set() if action is None else {action.node})
        if action is None or action.type.codecs is None:
            return None
        if not self._is_served("actions", name, action.node):
            return None
        return ActionRecord.model_construct(
            node=self.backplane.view.node_outward(action.node),
            type=action.type.name,
            md5sums=action.type.md5sums,
            since=self._served_since("actions", name),
            replaces=self._remote.ages.replaced_hub("actions", name),
        )

    def _parameter(self, name: str) -> ParameterRecord | None:
        if not self._may(name, "param_read", exports=True):
            return None
        return self._parameters.record(name, self.backplane.view)

    def _is_served(self, kind: Kind, name: str, node: str) -> bool:
        return self._may_offer(node) and self._may(name, "call", exports=True)

    def _served_since(self, kind: Kind, name: str) -> int:
        remote = self._remote.services.find(kind, name)
        return remote.since if remote is not None else self._remote.ages.since(kind, name)

    def _may_offer(self, node: str) -> bool:
        """Return whether a node can be offered: not to where it has come from."""
        found = self.graph.nodes.get(node)
        if found is None or isinstance(found, LinkNode):
            return False
        if node in self.graph.rights.internal and not isinstance(found, LogReader):
            return False
        return not isinstance(found, RemoteNode) or found.home.peer.backplane is not self.backplane

    def _may(self, name: str, right: Right, *, exports: bool) -> bool:
        view = self.backplane.view
        passes = view.may_export(name) if exports else view.may_import(name)
        return passes and self.graph.rights.allows(self.backplane.node, right, name)
