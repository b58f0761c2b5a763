"""The topics of ROS 2 nodes: their publishers and subscribers in the graph, and the messages.

Messages travel on demand. The hub subscribes to a key while a node of the graph that is not ROS 2's
subscribes to the topic, and publishes while a ROS 2 node does. What has come from ROS 2 never goes
back.
"""

from __future__ import annotations

import logging
import time
from collections.abc import Callable, Mapping
from contextlib import suppress
from functools import partial
from itertools import chain
from typing import Any

from fibws.errors import FibwsError
from fibws.hub.delivery.clock import Loop, Timer
from fibws.hub.errors import LimitReached
from fibws.hub.foreign.topics import (
    LINGER,
    ForeignPublisher,
    ForeignSubscriber,
    ForeignTopics,
    ForeignUsers,
)
from fibws.hub.foreign.warnings import OneTimeWarnings
from fibws.hub.foreign.worklist import Worklist
from fibws.hub.graph.graph import Graph
from fibws.hub.graph.publication import Publication
from fibws.hub.graph.topic import Source, Topic
from fibws.hub.graph.type_group import TypeGroup
from fibws.hub.graph.types import MessageType
from fibws.hub.ros2.key_layout import Attachment, Entity, Qos, data_key
from fibws.hub.ros2.network import Declared, DeclaredPublisher, Ros2Network
from fibws.hub.ros2.nodes import CLIENT, Ros2Node, Ros2Nodes
from fibws.hub.ros2.own_nodes import HUB, OwnEntity, Ros2Tokens
from fibws.hub.ros2.types import Ros2Message, Ros2Types, check_hash
from fibws.interfaces.catalogue import Definitions

logger = logging.getLogger("fibws.hub")

UNLIMITED = 1000
"""Messages that wait for ROS 2, of a publisher whose queue_size sets no limit."""
MOST_HISTORY = 1000
"""Earlier messages that are asked for of a publisher that keeps more."""
ROS2_NAMES = {"tf/tfMessage": "tf2_msgs/TFMessage"}
"""Types of ROS 1 that have another name in ROS 2."""
LEFT_OUT = frozenset({"/rosout"})
"""Topics that both have, with other types."""


class Ros2Publisher(ForeignPublisher):
    """A ROS 2 node as a publisher of a topic, with its source in the graph.

    Attributes:
        qos: latched if one of its publishers is.
        message: None while the fields of the type are unknown.
    """

    __slots__ = ("message", "qos")

    type: tuple[str, str]

    def __init__(self, node: Ros2Node, type_: tuple[str, str], qos: Qos) -> None:
        super().__init__(node, type_, qos)
        self.qos = qos
        self.message: Ros2Message | None = None


class Ros2Subscriber(ForeignSubscriber):
    """A ROS 2 node as a subscriber of a topic.

    Attributes:
        message: None while the fields of the type are unknown.
    """

    __slots__ = ("message",)

    type: tuple[str, str]

    def __init__(self, owner: Ros2Node, type_: tuple[str, str], outlet: Ros2Outlet) -> None:
        super().__init__(owner, type_, outlet)
        self.message: Ros2Message | None = None


class OwnPublisher:
    """A publisher of this hub as ROS 2 sees it.

    Args:
        matched: called once messages of another type reach a subscriber.

    Attributes:
        matching: the types of which messages reach a subscriber.
        declared: what sends its messages, by the name and the hash of the type in the key, and the
            type.
    """

    __slots__ = (
        "_matched",
        "_network",
        "declared",
        "matching",
        "message",
        "own",
        "sequence",
        "source",
    )

    def __init__(
        self,
        source: Source,
        message: Ros2Message,
        own: OwnEntity,
        network: Ros2Network,
        matched: Callable[[], object],
    ) -> None:
        self.source = source
        self.message = message
        self.own = own
        self.sequence = 0
        self.declared: dict[tuple[str, str], tuple[DeclaredPublisher, Ros2Message]] = {}
        self.matching: set[tuple[str, str]] = set()
        self._network = network
        self._matched = matched

    def settle(self, wanted: Mapping[tuple[str, str], Ros2Message]) -> None:
        """Publish for subscribers with these types, and for no others."""
        for gone in self.declared.keys() - wanted.keys():
            self.declared.pop(gone)[0].close()
            self.matching.discard(gone)
        for new in wanted.keys() - self.declared.keys():
            network = self._network
            key = data_key(network.domain, self.own.entity.name, "msg", *new)
            declared = network.declare_publisher(
                key, int(self.source.latch), partial(self._reached, new)
            )
            self.declared[new] = declared, wanted[new]
            latched = self.source.recall()
            if latched is not None:
                self._send(latched, *self.declared[new])

    def _reached(self, type_: tuple[str, str]) -> None:
        if type_ in self.declared:
            self.matching.add(type_)
            self._matched()

    def send(self, publication: Publication) -> None:
        """Send a message; raises `OperationError` if it has no bytes."""
        for declared, message in self.declared.values():
            self._send(publication, declared, message)

    def _send(
        self, publication: Publication, declared: DeclaredPublisher, message: Ros2Message
    ) -> None:
        data = publication.ros1()
        self.sequence += 1
        attachment = Attachment(self.sequence, time.time_ns(), self.own.gid).pack()
        convert = message.converter.to_cdr
        queue_size = self.source.queue_size
        limit = queue_size if queue_size > 0 else UNLIMITED
        declared.send(len(data), limit, lambda: (convert(data), attachment))

    def close(self) -> None:
        """Undeclare everything."""
        self.settle({})
        self.own.close()


class Ros2Outlet:
    """Sends the messages of one topic; the `Receiver` that all its ROS 2 subscribers share."""

    __slots__ = ("_links", "_topics")

    def __init__(self, links: Ros2Links, topics: Ros2Topics) -> None:
        self._links = links
        self._topics = topics

    def receive(self, publication: Publication) -> None:
        """Send a message of a node that is not ROS 2's."""
        try:
            self._topics.publish(self._links, publication)
        except FibwsError as error:
            self._topics.network.report(f"{self._links.topic}: {error}")


class Ros2Inlet:
    """A subscription to one key.

    Attributes:
        history: how many earlier messages it asked for.
        learned: the nodes of gids that are in no token.
        proven: the nodes whose gids are those of their tokens.
        is_ready: whether messages arrive.
        token: by which ROS 2 sees it, unless that of a node of the graph does.
    """

    __slots__ = ("declared", "history", "is_ready", "learned", "proven", "token")

    def __init__(self, history: int) -> None:
        self.declared: Declared
        self.history = history
        self.learned: dict[bytes, str] = {}
        self.proven: set[str] = set()
        self.is_ready = False
        self.token: OwnEntity | None = None

    def hide(self) -> None:
        """Undeclare the token."""
        if self.token is not None:
            self.token.close()
            self.token = None

    def close(self) -> None:
        """Undeclare the subscription and its token."""
        self.hide()
        self.declared.close()


class Ros2Links(ForeignUsers[Ros2Publisher, Ros2Subscriber]):
    """The connections of a topic with ROS 2; publishers and subscribers by node."""

    def __init__(self, topic: str, topics: Ros2Topics) -> None:
        super().__init__()
        self.topic = topic
        self.outlet = Ros2Outlet(self, topics)
        self.inlets: dict[tuple[str, str], Ros2Inlet] = {}
        """By the name and the hash of the type."""
        self.lingering: Timer | None = None
        self.own_publishers: dict[str, OwnPublisher] = {}
        self.own_subscribers: dict[tuple[str, str, str], OwnEntity] = {}
        """By node, and the name and the hash of the type."""

    @property
    def is_empty(self) -> bool:
        """Whether nothing is connected."""
        return not (
            self.publishers
            or self.subscribers
            or self.inlets
            or self.own_publishers
            or self.own_subscribers
        )


class Ros2Topics(ForeignTopics[Ros2Publisher, Ros2Subscriber]):
    """Connects the topics of the graph with those of ROS 2 nodes.

    Args:
        max_latched: bytes that the latched messages of a ROS 2 publisher may take.
    """

    def __init__(
        self,
        graph: Graph,
        network: Ros2Network,
        nodes: Ros2Nodes,
        own: Ros2Tokens,
        types: Ros2Types,
        loop: Loop,
        max_latched: int,
    ) -> None:
        super().__init__(graph, OneTimeWarnings())
        self.network = network
        self._nodes = nodes
        self._own = own
        self._types = types
        self._loop = loop
        self._max_latched = max_latched
        self._links: dict[str, Ros2Links] = {}
        self._work = Worklist(loop.call_soon, {"topics": self._settle})
        graph.watch_topics(lambda topic: self.changed(topic.name))

    def start(self) -> None:
        """Show all topics to ROS 2."""
        for name in self._graph.topics:
            self.changed(name)

    def close(self) -> None:
        """End all connections; the ROS 2 nodes have left."""
        self._work.close()
        for links in self._links.values():
            for user in (*links.publishers.values(), *links.subscribers.values()):
                self.drop_user(links.topic, user)
        for links in self._links.values():
            self._stop_lingering(links)
            for publisher in links.own_publishers.values():
                publisher.close()
            for subscriber in links.own_subscribers.values():
                subscriber.close()
            self._close_inlets(links)
        self._links.clear()

    # Changes: see `Endpoints`.

    def changed(self, name: str) -> None:
        """Update a topic soon."""
        if name not in LEFT_OUT:
            self._work.add("topics", name)

    def detach(self, node: Ros2Node) -> None:
        """Detach, topic by topic, what a node that has left publishes and subscribes to."""
        self.abandon(node.published.values(), chain(*node.subscribed.values()))
        for name in {**node.published, **node.subscribed}:
            self.changed(name)

    def _settle(self, name: str) -> None:
        """Attach what should be attached to a topic, and detach what should not."""
        links = self._links.get(name)
        if links is None:
            links = self._links[name] = Ros2Links(name, self)
        publishers: dict[str, list[Entity]] = {}
        subscribers: dict[str, list[Entity]] = {}
        for entity in self._nodes.entities(name, is_topic=True):
            users = publishers if entity.kind == "MP" else subscribers
            users.setdefault(entity.node, []).append(entity)
        nodes = self._nodes.attached
        self.settle_users(
            name,
            links,
            {node: (nodes[node], *_type_and_qos(each)) for node, each in publishers.items()},
            {node: (nodes[node], _type_and_qos(each)[0]) for node, each in subscribers.items()},
            Ros2Publisher,
            lambda owner, type_: Ros2Subscriber(owner, type_, links.outlet),
        )
        self._settle_inlets(links)
        self._settle_own(links)
        if links.is_empty:
            self._links.pop(name, None)

    # Publishers and subscribers of ROS 2.

    def type_of(self, topic: Topic, user: Ros2Publisher | Ros2Subscriber) -> Any:
        """Return the type of what is attached, which somebody may define, or those of the topic."""
        if isinstance(user, Ros2Subscriber):
            return topic.type_for(user)
        return user.source.type if user.source is not None else topic.types()

    def advertise(self, topic: Topic, publisher: Ros2Publisher) -> Source:
        """See `ForeignTopics`; without the fields of its type it has no messages."""
        publisher.source = self._graph.advertise(
            topic,
            publisher.name,
            publisher.type_name,
            latch=publisher.qos.is_latched,
            quota=self._graph.latch_quota(self._max_latched),
            queue_size=publisher.qos.depth,
            linked=False,
            on_conflict=self.reporter(publisher),
        )
        publisher.message = self._message(publisher.source.type, *publisher.type)
        return publisher.source

    def subscribe(self, topic: Topic, subscriber: Ros2Subscriber) -> None:
        """See `ForeignTopics`."""
        self._graph.subscribe(
            topic,
            subscriber,
            subscriber.type_name,
            receiver=lambda group: subscriber.outlet,
            needs_definition=True,
            linked=False,
            on_conflict=self.reporter(subscriber),
        )
        subscriber.is_attached = True
        subscriber.message = self._message(topic.type_for(subscriber), *subscriber.type)

    def _message(
        self, type_: MessageType | None, name: str, type_hash: str | None
    ) -> Ros2Message | None:
        """Return a type in ROS 2; None if its fields are unknown.

        Args:
            name: that of the type in ROS 2; the hub may have another one with the same fields.

        Raises:
            Ros2Error: it has another hash than ROS 2 has, or it cannot be converted.
        """
        if type_ is None or type_.codecs is None:
            return None
        definitions: Definitions = type_.codecs.definitions
        if name != type_.name:
            definitions = self._graph.definitions.known_to(CLIENT, "msg", name)
            if definitions.md5(name) != type_.md5sum:
                return None
        message = self._types.message(definitions, name)
        if type_hash is not None:
            check_hash(message.name, message.type_hash, type_hash)
        return message

    # Messages of ROS 2.

    def _settle_inlets(self, links: Ros2Links) -> None:
        """Open the subscriptions that are needed; close the others after `LINGER`."""
        wanted: dict[tuple[str, str], int] = {}
        for publisher in links.publishers.values():
            if publisher.message is not None:
                depth = publisher.qos.depth if publisher.qos.is_latched else 0
                history = max(wanted.get(publisher.type, 0), min(depth, MOST_HISTORY))
                wanted[publisher.type] = history
        for type_ in links.inlets.keys() - wanted.keys():
            self._close_inlet(links, type_)
        topic = self._graph.topic(links.topic)
        if any(node not in self._nodes.attached for node in topic.all_subscribers()):
            self._stop_lingering(links)
            for type_, history in wanted.items():
                self._open_inlet(links, type_, history)
        elif links.inlets and links.lingering is None:
            links.lingering = self._loop.call_later(LINGER, partial(self._lingered, links))

    def _lingered(self, links: Ros2Links) -> None:
        links.lingering = None
        self._close_inlets(links)
        self.changed(links.topic)

    def _stop_lingering(self, links: Ros2Links) -> None:
        if links.lingering is not None:
            links.lingering.cancel()
            links.lingering = None

    def _open_inlet(self, links: Ros2Links, type_: tuple[str, str], history: int) -> None:
        inlet = links.inlets.get(type_)
        if inlet is not None and inlet.history < history:
            self._close_inlet(links, type_)
            inlet = None
        if inlet is not None:
            if inlet.is_ready:
                self._link(links, type_)
            return
        message = next(
            each.message
            for each in links.publishers.values()
            if each.type == type_ and each.message is not None
        )
        inlet = links.inlets[type_] = Ros2Inlet(history)
        inlet.declared = self.network.subscribe(
            data_key(self.network.domain, links.topic, "msg", *type_),
            history,
            message.converter.from_cdr,
            partial(self._received, links, type_, inlet),
            partial(self._ready, links, type_, inlet),
        )

    def _close_inlets(self, links: Ros2Links) -> None:
        for type_ in list(links.inlets):
            self._close_inlet(links, type_)

    def _close_inlet(self, links: Ros2Links, type_: tuple[str, str]) -> None:
        links.inlets.pop(type_).close()
        for publisher in links.publishers.values():
            if publisher.type == type_ and publisher.source is not None:
                publisher.source.forget_latched()
                publisher.source.unlink()

    def _ready(self, links: Ros2Links, type_: tuple[str, str], inlet: Ros2Inlet) -> None:
        if links.inlets.get(type_) is inlet:
            inlet.is_ready = True
            self._link(links, type_)

    def _link(self, links: Ros2Links, type_: tuple[str, str]) -> None:
        """Called when messages of all publishers of a type arrive."""
        for publisher in links.publishers.values():
            if publisher.type == type_ and publisher.source is not None:
                publisher.source.link()

    def _received(
        self,
        links: Ros2Links,
        type_: tuple[str, str],
        inlet: Ros2Inlet,
        attachment: Attachment,
        data: bytearray,
    ) -> None:
        """Publish a message of a ROS 2 node."""
        if links.inlets.get(type_) is not inlet:
            return
        publisher = self._publisher(links, type_, inlet, attachment.gid)
        if publisher is None or publisher.source is None:
            self.network.report(f"{links.topic}: a message of an unknown publisher")
            return
        try:
            publisher.source.publish_serialized(memoryview(data))
        except LimitReached as error:
            logger.warning("%s: %s", publisher.node.name, error)
        except FibwsError as error:
            self.network.report(f"{links.topic}: {publisher.node.name}: {error}")

    def _publisher(
        self, links: Ros2Links, type_: tuple[str, str], inlet: Ros2Inlet, gid: bytes
    ) -> Ros2Publisher | None:
        """Return the publisher with a gid.

        Some programs have gids that do not follow from their tokens: each of these is taken for a
        publisher whose gid is not known yet.
        """
        entity = self._nodes.of_gid(gid)
        if entity is not None and entity.name == links.topic:
            inlet.proven.add(entity.node)
            return links.publishers.get(entity.node)
        known = links.publishers.get(inlet.learned.get(gid, ""))
        if known is not None:
            return known
        there = [each for each in links.publishers.values() if each.type == type_]
        if len(there) == 1:
            return there[0]
        names = {each.node.name for each in there}
        inlet.learned = {old: node for old, node in inlet.learned.items() if node in names}
        inlet.proven &= names
        taken = {*inlet.proven, *inlet.learned.values()}
        for publisher in there:
            if publisher.node.name not in taken:
                inlet.learned[gid] = publisher.node.name
                return publisher
        return None

    # Nodes of this hub, for ROS 2.

    def publish(self, links: Ros2Links, publication: Publication) -> None:
        """Send a message of a topic to ROS 2, unless it has come from there."""
        node = publication.node
        if node in self._nodes.attached:
            return
        publisher = links.own_publishers.get(node)
        topic = self._graph.topics.get(links.topic)
        if topic is None or publisher is None or publisher.source is not topic.publishers.get(node):
            self._settle_own(links)  # It has only just advertised.
            publisher = links.own_publishers.get(node)
        if publisher is not None:
            publisher.send(publication)

    def _settle_own(self, links: Ros2Links) -> None:
        """Show the publishers and subscribers of this hub to ROS 2."""
        topic = self._graph.topics.get(links.topic)
        messages = self._own_messages(topic)
        wanted = self._wanted(links, topic)
        sources = {
            node: (source, message)
            for group, message in messages.items()
            for node, source in group.sources.items()
        }
        may_publish = self._graph.rights.allows(CLIENT, "subscribe", links.topic)
        for node, old in list(links.own_publishers.items()):
            is_same = sources.get(node) == (old.source, old.message)
            if not is_same or not self._own.is_shown(node) or not may_publish:
                del links.own_publishers[node]
                old.close()
        for node, (source, message) in sources.items():
            if not may_publish or not self._own.is_shown(node):
                continue
            publisher = links.own_publishers.get(node)
            if publisher is None:
                qos = Qos(is_latched=source.latch, depth=max(1, source.queue_size))
                own = self._own.declare(
                    "MP", node, links.topic, message.name, message.type_hash, qos
                )
                matched = partial(self.changed, links.topic)
                publisher = OwnPublisher(source, message, own, self.network, matched)
                links.own_publishers[node] = publisher
            publisher.settle(wanted.get(source.group, {}))
        if topic is not None:
            reached = {each for own in links.own_publishers.values() for each in own.matching}
            for subscriber in links.subscribers.values():
                if subscriber.is_attached and subscriber.type in reached:
                    topic.sink_linked(subscriber)
        self._settle_own_subscribers(links, messages)

    def _wanted(
        self, links: Ros2Links, topic: Topic | None
    ) -> dict[TypeGroup | None, dict[tuple[str, str], Ros2Message]]:
        """Return the types in which ROS 2's subscribers want the messages of each type group."""
        wanted: dict[TypeGroup | None, dict[tuple[str, str], Ros2Message]] = {}
        for each in links.subscribers.values():
            if topic is not None and each.is_attached and each.message is not None:
                wanted.setdefault(topic.named_by(each), {})[each.type] = each.message
        return wanted

    def _settle_own_subscribers(
        self, links: Ros2Links, messages: dict[TypeGroup, Ros2Message]
    ) -> None:
        may_subscribe = self._graph.rights.allows(CLIENT, "publish", links.topic)
        wanted = {
            (node, message.name, message.type_hash)
            for group, message in messages.items()
            if may_subscribe
            for node in group.listeners
            if self._own.is_shown(node)
        }
        present = links.own_subscribers
        gone = [present.pop(key) for key in present.keys() - wanted]
        for key in sorted(wanted - present.keys()):
            node, name, type_hash = key
            present[key] = self._own.declare("MS", node, links.topic, name, type_hash, Qos())
        self._settle_inlet_tokens(links)
        for old in gone:
            old.close()

    def _settle_inlet_tokens(self, links: Ros2Links) -> None:
        """Show each subscription to ROS 2, whose publishers may send only what tokens ask for."""
        shown = {(own.entity.type, own.entity.type_hash) for own in links.own_subscribers.values()}
        for type_, inlet in links.inlets.items():
            if type_ in shown:
                inlet.hide()
            elif inlet.token is None:
                inlet.token = self._own.declare("MS", HUB, links.topic, *type_, Qos())

    def _own_messages(self, topic: Topic | None) -> dict[TypeGroup, Ros2Message]:
        """Return the types of a topic in ROS 2 that can be shown there."""
        found: dict[TypeGroup, Ros2Message] = {}
        if topic is None or not self._own.may_show(topic.name) or topic.name in LEFT_OUT:
            return found
        for group in topic.groups:
            if group.type is not None and (group.is_held or group is not topic.main):
                name = group.type.name
                with suppress(FibwsError):  # Conflicts say so where it matters.
                    message = self._message(group.type, ROS2_NAMES.get(name, name), None)
                    if message is not None:
                        found[group] = message
        return found


def _type_and_qos(entities: list[Entity]) -> tuple[tuple[str, str], Qos]:
    """Return the type of a node's publishers or subscribers of a topic, and their QoS."""
    first = entities[0]
    is_latched = any(each.qos.is_latched for each in entities)
    depth = max(each.qos.depth for each in entities)
    return (first.type, first.type_hash), Qos(is_latched=is_latched, depth=depth)
