"""Feeds: what a client is told of the channels, the services and the connections of the graph.

A feed remembers what its client was sent, and sends what has changed since: soon, however often it
changed, in turns with those of other clients, and not before the client reads. What the client may
not see, or what has no definition, does not exist for it.
"""

from __future__ import annotations

import logging
from abc import ABC, abstractmethod
from collections import OrderedDict
from collections.abc import Callable, Hashable, Iterable, Sequence
from dataclasses import dataclass
from typing import Generic, TypeVar
from weakref import WeakKeyDictionary

from pydantic_core import to_json

from fibws.hub.foxglove.client import FoxgloveClient
from fibws.hub.foxglove.messages import ROS1, ROS1_TEXT, WARNING, list_frame, text_frame
from fibws.hub.foxglove.turns import TURN
from fibws.hub.graph.graph import Graph
from fibws.hub.graph.nodes import ExternalNode
from fibws.hub.graph.numbers import Numbers
from fibws.hub.graph.publication import Publication
from fibws.hub.graph.service import Service
from fibws.hub.graph.topic import SinkReport, Topic
from fibws.hub.graph.types import MessageType, ServiceType
from fibws.interfaces import full_text
from fibws.interfaces.catalogue import Definitions

logger = logging.getLogger("fibws.hub")

BATCH = 2**20
"""Bytes of texts that are sent in one turn of the event loop."""

MOST_PROBES = 20
"""Topics that ROS 1 nodes are asked about at once for one client."""
PROBE_SECONDS = 5.0

K = TypeVar("K", bound=Hashable)
"""The key of an entry."""
E = TypeVar("E")
"""An entry."""


class Feed(ABC, Generic[K, E]):
    """Sends one client the entries that it may see, and then their changes."""

    def __init__(self, client: FoxgloveClient) -> None:
        self.client = client
        self.known: dict[K, E] = {}
        """The entries that were sent to the client."""
        self._pending: OrderedDict[K, None] = OrderedDict()
        """The entries that may have changed since."""

    @abstractmethod
    def view(self, key: K) -> E | None:
        """Return an entry as the client may see it now; None if there is none."""

    @abstractmethod
    def encode(self, removed: Sequence[E], added: Sequence[E]) -> bytes:
        """Return the frames of a change; an entry in both lists replaces one of its name."""

    def size(self, entry: E) -> int:
        """Return about how many bytes an entry takes in a frame."""
        return 0

    def changed(self, *keys: K) -> None:
        """Called when entries may have changed."""
        self._pending.update(dict.fromkeys(keys))
        if self._pending:
            self.client.turns.wait(self._send)

    def open(self, keys: Iterable[K]) -> None:
        """Send what there is, the first part at once."""
        self._pending.update(dict.fromkeys(keys))
        self._send()

    def close(self) -> None:
        """Send nothing more, and forget what was sent."""
        self.client.turns.cancel(self._send)
        self._pending.clear()
        self.known.clear()

    def _send(self) -> None:
        self.client.queue.reply_fresh(self._next_frames)

    def _next_frames(self) -> bytes:
        """Return the frames of some changes, and come back for the others in another turn."""
        removed: list[E] = []
        added: list[E] = []
        size = 0
        until = self.client.clock.time() + TURN
        while self._pending and size < BATCH and self.client.clock.time() < until:
            key, _ = self._pending.popitem(last=False)
            older, newer = self.known.get(key), self._view(key)
            if older == newer:
                continue
            if older is not None:
                del self.known[key]
                removed.append(older)
            if newer is not None:
                self.known[key] = newer
                added.append(newer)
                size += self.size(newer)
        self.changed()
        return self.encode(removed, added) if removed or added else b""

    def _view(self, key: K) -> E | None:
        """Return what `view` does; an entry that fails must not hide the others."""
        try:
            return self.view(key)
        except Exception:
            logger.exception("%s cannot be described to %s.", key, self.client.node)
            return None


class Application:
    """The base of the clients of this protocol: what they alone subscribe to is no channel."""

    __slots__ = ()


class Schemas:
    """The texts of the types of topics, as the JSON strings of descriptions, each made once."""

    def __init__(self) -> None:
        self._texts: WeakKeyDictionary[MessageType, bytes] = WeakKeyDictionary()

    def find(self, type_: MessageType) -> bytes | None:
        """Return the schema of a type; None if its fields are unknown."""
        if type_ not in self._texts:
            if type_.codecs is None:
                return None
            self._texts[type_] = to_json(type_.codecs.definitions.full_text(type_.name))
        return self._texts[type_]


@dataclass(frozen=True, slots=True)
class Channel:
    """A topic that others use with one type, whose fields are known.

    ``id`` is the number of the topic and this type.
    """

    id: int
    topic: str
    type: str
    md5sum: str | None
    schema: bytes
    """As JSON."""

    def text(self) -> bytes:
        """Return its description as JSON."""
        head = {"id": self.id, "topic": self.topic, "encoding": ROS1, "schemaName": self.type}
        return b'%b,"schemaEncoding":"%b","schema":%b}' % (
            to_json(head)[:-1],
            ROS1_TEXT.encode(),
            self.schema,
        )


class ChannelFeed(Feed[str, tuple[Channel, ...]]):
    """The channels that a client may subscribe to, by the topics' names: one for each type.

    Args:
        removed: takes each channel that the client is told to be gone.
    """

    def __init__(
        self, client: FoxgloveClient, schemas: Schemas, removed: Callable[[Channel], object]
    ) -> None:
        super().__init__(client)
        self._schemas = schemas
        self._removed = removed
        self._by_id: dict[int, Channel] = {}

    def find(self, id_: int) -> Channel | None:
        """Return the channel of an id that the client has been told."""
        return self._by_id.get(id_)

    def close(self) -> None:
        """Send nothing more."""
        super().close()
        self._by_id.clear()

    def view(self, key: str) -> tuple[Channel, ...] | None:
        """Return a topic's channels, if there are any that the client may subscribe to."""
        topic = _used(self.client, key)
        if topic is None:
            return None
        found = []
        for group in [each for each in topic.groups if each.sources] or topic.groups[:1]:
            type_ = group.type
            schema = self._schemas.find(type_) if type_ is not None else None
            if type_ is not None and schema is not None:
                found.append(Channel(group.number, key, type_.name, type_.md5sum, schema))
        return tuple(found) or None

    def size(self, entry: tuple[Channel, ...]) -> int:
        """Return about how many bytes the channels of a topic take in a frame."""
        return sum(len(each.schema) for each in entry)

    def encode(
        self, removed: Sequence[tuple[Channel, ...]], added: Sequence[tuple[Channel, ...]]
    ) -> bytes:
        """Return the frames that take channels back, and then offer others."""
        frames = []
        gone = {channel.id: channel for entry in removed for channel in entry}
        new = {channel.id: channel for entry in added for channel in entry}
        for id_ in gone.keys() & new.keys():
            if gone[id_] == new[id_]:  # The topic has got, or lost, another type.
                del gone[id_], new[id_]
        if gone:
            for channel in gone.values():
                del self._by_id[channel.id]
                self._removed(channel)
            frames.append(text_frame("unadvertise", channelIds=list(gone)))
        if new:
            self._by_id.update(new)
            texts = (each.text() for each in new.values())
            frames.append(list_frame("advertise", "channels", texts))
        return b"".join(frames)


class Probe:
    """A `Sink` that drops what it gets: a ROS 1 node tells its type's definition once it is asked.

    Args:
        end: called when that has taken too long.
    """

    def __init__(self, client: FoxgloveClient, topic: Topic, end: Callable[[], object]) -> None:
        self.node = client.node
        self._client = client
        self._topic = topic
        self._timer = client.clock.call_later(PROBE_SECONDS, end)
        client.graph.subscribe(topic, self)

    def receive(self, publication: Publication) -> None:
        """Drop a message."""

    def replay(self, publication: Publication) -> None:
        """Drop a latched message."""

    def report(self) -> SinkReport:
        """Return the totals of a subscription that gets nothing."""
        return SinkReport()

    def close(self) -> None:
        """Stop asking."""
        self._timer.cancel()
        self._client.graph.unsubscribe(self._topic, self)


class UndefinedFeed(Feed[str, tuple[str, str]]):
    """Topics and their types that could be channels if the types' fields were known.

    The client is warned once of each, and the warning goes when the topic does, or gets a
    definition. ROS 1 nodes are asked for it before.
    """

    def __init__(self, client: FoxgloveClient) -> None:
        super().__init__(client)
        self._probes: dict[str, Probe] = {}
        self._delayed: dict[str, None] = {}
        """Topics that are asked about once there are fewer probes."""
        self._asked: set[str] = set()
        """Topics that were asked about in vain."""

    def view(self, key: str) -> tuple[str, str] | None:
        """Return the topic and its type if its definition is missing for good."""
        topic = _published(self.client, key)
        type_ = topic.type if topic is not None else None
        if topic is None or type_ is None or type_.checked:
            self._asked.discard(key)
            self._delayed.pop(key, None)
            self._end_probe(key)
            return None
        if key in self._asked or not self._can_be_asked(topic):
            return key, type_.name
        if len(self._probes) >= MOST_PROBES:
            self._delayed[key] = None
        elif key not in self._probes:
            self._probes[key] = Probe(self.client, topic, lambda: self._give_up(key))
        return None

    def encode(self, removed: Sequence[tuple[str, str]], added: Sequence[tuple[str, str]]) -> bytes:
        """Return the frames of the warnings."""
        frames = []
        if removed:
            ids = [_id(topic) for topic, _ in removed]
            frames.append(text_frame("removeStatus", statusIds=ids))
        for topic, type_ in added:
            text = (
                f"no definition of {type_}: {topic} cannot be shown. Start the hub with "
                "--interfaces and a folder that has it, or let a publisher bring it"
            )
            frames.append(text_frame("status", level=WARNING, message=text, id=_id(topic)))
        return b"".join(frames)

    def close(self) -> None:
        """Send nothing more."""
        self._delayed.clear()
        for key in list(self._probes):
            self._end_probe(key)
        super().close()

    def _can_be_asked(self, topic: Topic) -> bool:
        view = self.client.view
        return any(isinstance(view.node(each), ExternalNode) for each in view.publishers(topic))

    def _give_up(self, key: str) -> None:
        self._asked.add(key)
        self._end_probe(key)
        self.changed(key)

    def _end_probe(self, key: str) -> None:
        probe = self._probes.pop(key, None)
        if probe is not None:
            probe.close()
            delayed, self._delayed = self._delayed, {}
            self.changed(*delayed)


@dataclass(frozen=True, slots=True)
class ServiceEntry:
    """A service whose type is known."""

    id: int
    name: str
    type: str
    md5sum: str
    request: bytes
    """The request's schema, as JSON."""
    response: bytes

    def text(self) -> bytes:
        """Return its description as JSON; programs older than 2024 read its last two fields."""
        head = to_json({"id": self.id, "name": self.name, "type": self.type})[:-1]
        parts = [
            b'"%b":{"encoding":"%b","schemaName":%b,"schemaEncoding":"%b","schema":%b}'
            % (name, ROS1.encode(), to_json(self.type + suffix), ROS1_TEXT.encode(), schema)
            for name, suffix, schema in (
                (b"request", "Request", self.request),
                (b"response", "Response", self.response),
            )
        ]
        return b'%b,%b,"requestSchema":%b,"responseSchema":%b}' % (
            head,
            b",".join(parts),
            self.request,
            self.response,
        )


class ServiceFeeds:
    """The descriptions of the graph's services, each made once."""

    def __init__(self, graph: Graph) -> None:
        self._graph = graph
        self._numbers = Numbers()
        self._made: dict[str, tuple[Service, ServiceType, ServiceEntry]] = {}
        graph.watch("service", self._changed)

    def find(self, name: str) -> ServiceEntry | None:
        """Return a service's description; None for an unknown service or type.

        Its number is another one once the service has another server or type.
        """
        service = self._graph.services.get(name)
        if service is None:
            return None
        type_, codecs = service.type, service.type.codecs
        if codecs is None:
            return None
        made = self._made.get(name)
        if made is None or made[0] is not service or made[1] is not type_:
            schemas = _service_schemas(codecs.definitions, type_.name)
            md5sum = type_.md5sum or ""
            self._forget(name)
            entry = ServiceEntry(self._numbers.take(), name, type_.name, md5sum, *schemas)
            made = self._made[name] = service, type_, entry
        return made[2]

    def _changed(self, name: str) -> None:
        """Forget a service that has left."""
        if name not in self._graph.services:
            self._forget(name)

    def _forget(self, name: str) -> None:
        made = self._made.pop(name, None)
        if made is not None:
            self._numbers.give_back(made[2].id)


def _service_schemas(definitions: Definitions, type_: str) -> tuple[bytes, bytes]:
    """Return the schemas of a service's request and response, as JSON."""
    service = definitions.service(type_)
    request, response = (
        to_json(full_text.write_message(part, definitions.message))
        for part in (service.request, service.response)
    )
    return request, response


class ServiceFeed(Feed[str, ServiceEntry]):
    """The services that a client may call, by their names."""

    def __init__(self, client: FoxgloveClient, services: ServiceFeeds) -> None:
        super().__init__(client)
        self._services = services
        self._by_id: dict[int, ServiceEntry] = {}

    def find(self, id_: int) -> ServiceEntry | None:
        """Return the service of an id that the client has been told."""
        return self._by_id.get(id_)

    def close(self) -> None:
        """Send nothing more."""
        super().close()
        self._by_id.clear()

    def view(self, key: str) -> ServiceEntry | None:
        """Return a service that the client may call."""
        return self._services.find(key) if self.client.is_allowed("call", key) else None

    def size(self, entry: ServiceEntry) -> int:
        """Return about how many bytes a service takes in a frame."""
        return 2 * (len(entry.request) + len(entry.response))

    def encode(self, removed: Sequence[ServiceEntry], added: Sequence[ServiceEntry]) -> bytes:
        """Return the frames that take services back, and then offer others."""
        frames = []
        if removed:
            for entry in removed:
                del self._by_id[entry.id]
            frames.append(
                text_frame("unadvertiseServices", serviceIds=[each.id for each in removed])
            )
        if added:
            self._by_id.update((entry.id, entry) for entry in added)
            texts = (each.text() for each in added)
            frames.append(list_frame("advertiseServices", "services", texts))
        return b"".join(frames)


GraphKey = tuple[bool, str]
"""Whether it is a service, and the name."""


@dataclass(frozen=True, slots=True)
class Users:
    """The nodes that use a topic, or serve a service."""

    key: GraphKey
    publishers: tuple[str, ...]
    """Of a topic; of a service the node that serves it."""
    subscribers: tuple[str, ...] = ()


class GraphFeed(Feed[GraphKey, Users]):
    """The nodes that publish, subscribe and serve, by topics and services."""

    def view(self, key: GraphKey) -> Users | None:
        """Return the users of a topic or a service that the client may see."""
        view = self.client.view
        is_service, name = key
        if is_service:
            service = view.service(name)
            return Users(key, (service.node,)) if service is not None else None
        topic = view.topic(name)
        if topic is None:
            return None
        users = (view.publishers(topic), view.subscribers(topic))
        return Users(key, *(tuple(sorted(nodes)) for nodes in users))

    def encode(self, removed: Sequence[Users], added: Sequence[Users]) -> bytes:
        """Return the frame of a change; users that have changed need not be removed before."""
        gone = {each.key for each in removed}.difference(each.key for each in added)
        older = {each.key: each for each in removed}
        topics = [(older.get(each.key), each) for each in added if not each.key[0]]
        # A topic is not there for the client until it has users of a kind.
        published = [
            {"name": newer.key[1], "publisherIds": list(newer.publishers)}
            for known, newer in topics
            if newer.publishers != (known.publishers if known is not None else ())
        ]
        subscribed = [
            {"name": newer.key[1], "subscriberIds": list(newer.subscribers)}
            for known, newer in topics
            if newer.subscribers != (known.subscribers if known is not None else ())
        ]
        return text_frame(
            "connectionGraphUpdate",
            publishedTopics=published,
            subscribedTopics=subscribed,
            advertisedServices=[
                {"name": each.key[1], "providerIds": list(each.publishers)}
                for each in added
                if each.key[0]
            ],
            removedTopics=[name for is_service, name in gone if not is_service],
            removedServices=[name for is_service, name in gone if is_service],
        )


def _used(client: FoxgloveClient, name: str) -> Topic | None:
    """Return a topic that has a publisher, or waits for one, and that the client may subscribe to.

    An application can publish what others wait for, such as a robot for its velocity.
    """
    view = client.view
    topic = view.topic(name)
    if topic is None or not client.is_allowed("subscribe", name):
        return None
    is_used = bool(view.publishers(topic)) or any(
        not isinstance(view.node(each), Application) for each in view.subscribers(topic)
    )
    return topic if is_used else None


def _published(client: FoxgloveClient, name: str) -> Topic | None:
    """Return a topic that has a publisher and that the client may subscribe to."""
    view = client.view
    topic = view.topic(name)
    is_published = topic is not None and view.publishers(topic)
    return topic if is_published and client.is_allowed("subscribe", name) else None


def _id(topic: str) -> str:
    """Return the id of the warning about a topic."""
    return f"no definition: {topic}"
