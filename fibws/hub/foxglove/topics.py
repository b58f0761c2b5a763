"""The topics that one client subscribes to and publishes."""

from __future__ import annotations

import logging
from functools import partial

from pydantic_core import from_json

from fibws.errors import FibwsError, InterfaceError, OperationError
from fibws.hub.delivery.send_queue import Flusher, Frame, SendQueue, frame_of
from fibws.hub.errors import LimitReached
from fibws.hub.foxglove.client import FoxgloveClient
from fibws.hub.foxglove.feeds import Channel
from fibws.hub.foxglove.messages import (
    ENCODINGS,
    JSON,
    MESSAGE_HEAD_SIZE,
    ROS1,
    ROS1_TEXT,
    ROS2_IDL,
    ROS2_TEXTS,
    WARNING,
    ClientChannel,
    message_head,
    text_frame,
)
from fibws.hub.graph.graph import Graph
from fibws.hub.graph.publication import Publication
from fibws.hub.graph.topic import SinkReport, Source, Topic
from fibws.hub.graph.types import MessageType
from fibws.hub.log.text import is_power_of_ten
from fibws.hub.websocket.endpoint import Removals, Work
from fibws.interfaces import Interfaces, idl
from fibws.interfaces.client_definitions import LONGEST_TEXT
from fibws.interfaces.ros2_definitions import Ros2Definitions
from fibws.protocol.frame_queue import Lane
from fibws.protocol.value_limits import check_json
from fibws.protocol.websocket import BINARY, server_header

logger = logging.getLogger("fibws.hub")

WARN_AGAIN = 5.0
"""Least seconds between two statuses about dropped messages."""
MOST_TOPICS = 5
"""Topics that such a status names."""
BEHIND = "Send buffer limit reached"
"""How it begins: the application explains it to its users by these words."""
BEHIND_ID = "send buffer"

GroupKey = tuple[Channel, int]
Groups = dict[GroupKey, "FoxgloveGroup"]
"""All groups of a hub."""


class FoxgloveGroup:
    """Subscriptions of one channel under equal ids; a `Receiver` of the topic.

    Clients number their subscriptions from 0 on, so that many get the same bytes. A message is
    serialized once for all groups, and a large one is never joined with what precedes it.
    """

    __slots__ = ("_failures", "_flusher", "_groups", "_key", "_lanes", "_members", "_sent", "_type")

    def __init__(self, key: GroupKey, groups: Groups, flusher: Flusher) -> None:
        self._key = key
        self._groups = groups
        self._flusher = flusher
        self._type: MessageType | None = None
        """Of the last message."""
        self._members: dict[FoxgloveSubscription, int] = {}
        """Each with the value of `_sent` when it came."""
        self._lanes: dict[SendQueue, Lane] = {}
        self._sent = 0
        self._failures = 0

    def receive(self, publication: Publication) -> None:
        """Send a message to every subscription."""
        if publication.type is not self._type and not self._take(publication.type):
            return  # The topic has another type, too, or the clients will be told of it.
        try:
            frame = self.frame(publication)
        except Exception as fault:
            self._failures += 1
            if is_power_of_ten(self._failures):
                name = self._key[0].topic
                logger.error("%s cannot be serialized: %s", name, fault, exc_info=fault)
            return
        self._sent += 1
        self._flusher.broadcast(frame, self._lanes)
        for member in self._members:
            if member.client.queue.paused:
                member.behind()

    def fits(self, type_: MessageType) -> bool:
        """Return whether messages of a type are those of the channel."""
        return type_ is self._type or self._take(type_)

    def frame(self, publication: Publication) -> Frame:
        """Return the frame of a message."""
        message = publication.ros1()
        head = message_head(self._key[1], publication.received)
        return frame_of(server_header(BINARY, MESSAGE_HEAD_SIZE + len(message)) + head, message)

    def sent_to(self, member: FoxgloveSubscription) -> int:
        """Return how many messages a member was sent, except for latched ones."""
        return self._sent - self._members[member]

    def add(self, member: FoxgloveSubscription) -> None:
        """Add a subscription."""
        self._groups[self._key] = self
        self._members[member] = self._sent
        self._lanes[member.client.queue] = member.lane

    def remove(self, member: FoxgloveSubscription) -> None:
        """Remove a subscription."""
        del self._members[member], self._lanes[member.client.queue]
        if not self._members:
            self._groups.pop(self._key, None)

    def _take(self, type_: MessageType) -> bool:
        """Return whether messages of a type are those of the channel."""
        channel = self._key[0]
        if (type_.name, type_.md5sum) != (channel.type, channel.md5sum):
            return False
        self._type = type_
        return True


class FoxgloveSubscription:
    """One subscription of a client to a channel; a `Sink` of the topic."""

    __slots__ = (
        "_group",
        "_replayed",
        "_subscriptions",
        "channel",
        "client",
        "id",
        "lane",
        "topic",
    )

    def __init__(
        self,
        subscriptions: Subscriptions,
        id_: int,
        channel: Channel,
        topic: Topic,
        group: FoxgloveGroup,
    ) -> None:
        self._subscriptions = subscriptions
        self._group = group
        self._replayed = 0
        self.client = subscriptions.client
        self.id = id_
        self.channel = channel
        self.topic = topic
        self.lane = Lane(self.client.settings.queue_length)

    @property
    def node(self) -> str:
        """The name of the client's node."""
        return self.client.node

    def join(self) -> None:
        """Subscribe; raises as `Graph.subscribe`."""
        self.client.graph.subscribe(
            self.topic, self, receiver=lambda group: self._group, serialized=True
        )
        self._group.add(self)

    def leave(self) -> None:
        """Unsubscribe; messages that wait are dropped."""
        self.client.graph.unsubscribe(self.topic, self)
        self._group.remove(self)
        self.client.queue.forget(self.lane)

    def receive(self, publication: Publication) -> None:
        """Take a message that is for this client alone."""
        if not self._group.fits(publication.type):
            return  # The topic is used with another type, too.
        self._replayed += 1
        self.client.queue.put(self._group.frame(publication), self.lane)

    def replay(self, publication: Publication) -> None:
        """Take a latched message."""
        self.receive(publication)

    def behind(self) -> None:
        """Called when messages wait for the client, and may be dropped."""
        self._subscriptions.behind()

    def report(self) -> SinkReport:
        """Return the settings and totals."""
        return SinkReport(
            queue_length=self.lane.limit,
            encoding=ROS1,
            messages=self._replayed + self._group.sent_to(self),
            dropped=self.lane.dropped,
        )


class Subscriptions:
    """All subscriptions of one client.

    Args:
        groups: those of the hub.
    """

    def __init__(self, client: FoxgloveClient, groups: Groups) -> None:
        self.client = client
        self._groups = groups
        self.by_id: dict[int, FoxgloveSubscription] = {}
        self._channels: dict[int, FoxgloveSubscription] = {}
        """By the channels' ids."""
        self._reported = 0
        """Dropped messages that the client knows of."""
        self._ended = 0
        """Dropped messages of subscriptions that have ended."""
        self._due = 0.0

    def add(self, id_: int, channel: Channel) -> None:
        """Subscribe to a channel.

        Raises:
            LimitReached: there are too many subscriptions.
            OperationError: the topic has another channel by now; others as `Graph.subscribe`, and
                as `Topic.replay`, with the client subscribed.
        """
        if id_ in self.by_id:
            text = f"subscription {id_} exists already; it is for {self.by_id[id_].topic.name}"
            self.client.statuses.warning(text)
            return
        if channel.id in self._channels:
            self.client.statuses.warning(f"{channel.topic} has a subscription already")
            return
        self.client.check_room("subscriptions", len(self.by_id))
        topic = self.client.graph.topic(channel.topic)
        if not topic.has_number(channel.id):
            raise unknown_channel(channel.id)
        key = channel, id_
        group = self._groups.get(key)
        if group is None:
            group = FoxgloveGroup(key, self._groups, self.client.queue.flusher)
        subscription = FoxgloveSubscription(self, id_, channel, topic, group)
        subscription.join()
        self.by_id[id_] = self._channels[channel.id] = subscription
        topic.replay(subscription)

    def remove(self, id_: int) -> None:
        """End a subscription; an unknown one may have ended with its channel."""
        subscription = self.by_id.pop(id_, None)
        if subscription is not None:
            del self._channels[subscription.channel.id]
            self._ended += subscription.lane.dropped
            subscription.leave()

    def end(self, channel: Channel) -> None:
        """End the subscription of a channel that is gone."""
        subscription = self._channels.get(channel.id)
        if subscription is not None:
            self.remove(subscription.id)

    def names(self) -> set[str]:
        """Return the topics' global names."""
        return {each.topic.name for each in self.by_id.values()}

    def withdraw_forbidden(self) -> Work:
        """End, one by one, the subscriptions that the client's rights do not allow any more."""
        for id_, subscription in list(self.by_id.items()):
            name = subscription.topic.name
            if id_ in self.by_id and not self.client.is_allowed("subscribe", name):
                self.remove(id_)
                self.client.report_withdrawn("subscribe", name)
            yield

    def leave(self) -> Removals:
        """Return the subscriptions that are to be ended."""
        self.client.graph.abandon(self.by_id.values())
        return ((self.remove, list(self.by_id)),)

    def behind(self) -> None:
        """Let the client know, once it reads again, that messages were dropped."""
        self.client.queue.reply_fresh(self._drops_frame)

    def _drops_frame(self) -> bytes:
        """Return the status about dropped messages; nothing if the client knows of them."""
        now = self.client.clock.time()
        drops = {each.topic.name: each.lane.dropped for each in self.by_id.values()}
        total = self._ended + sum(drops.values())
        if total == self._reported or now < self._due:
            return b""
        self._reported = total
        self._due = now + WARN_AGAIN
        most = sorted(drops.items(), key=lambda item: -item[1])[:MOST_TOPICS]
        named = ", ".join(f"{name}: {number}" for name, number in most if number)
        text = f"{BEHIND}: this client reads too slowly, messages dropped so far: {total}"
        text = f"{text} ({named})" if named else text
        return text_frame("status", level=WARNING, message=text, id=BEHIND_ID)


class Publications:
    """The topics that one client publishes, by the ids that it gave them."""

    def __init__(self, client: FoxgloveClient) -> None:
        self._client = client
        self._quota = client.graph.latch_quota(
            client.settings.max_latched_bytes, client.node, client.statuses.error
        )
        self._channels: dict[int, tuple[Source, str]] = {}
        """The source and the encoding of each."""
        self._uses: dict[Source, int] = {}
        """How many channels share each source."""
        self._strays = 0

    def __len__(self) -> int:
        return len(self._uses)

    def names(self) -> set[str]:
        """Return the topics' global names."""
        return {source.topic.name for source in self._uses}

    def add(self, channel: ClientChannel) -> None:
        """Publish a topic.

        Raises:
            OperationError: the id is taken or the encoding unknown; others as `Graph.advertise`.
            LimitReached: there are too many.
            InterfaceError: as `Graph.advertise`.
            InvalidName: the topic's name is invalid.
        """
        if channel.id in self._channels:
            name = self._channels[channel.id][0].topic.name
            raise OperationError(f"channel {channel.id} is advertised already, for {name}")
        if channel.encoding not in ENCODINGS:
            known = " or ".join(ENCODINGS)
            raise OperationError(f"encoding must be {known}, got {channel.encoding!r}")
        client = self._client
        client.check_room("advertisements", len(self._channels))
        source = client.graph.advertise(
            client.graph.topic(client.resolve(channel.topic)),
            client.node,
            channel.schema_name,
            _definition(channel, client.graph),
            quota=self._quota,
            serialized=channel.encoding == ROS1,
            on_conflict=partial(client.statuses.state, f"conflict of channel {channel.id}"),
        )
        if channel.encoding == ROS1 and not source.type.checked:
            if source not in self._uses:
                client.graph.remove_source(source)
            source.type.check_known()
        if source.type.meant:
            text = f"{source.topic.name}: messages of type {source.type.name} are not checked"
            meant = f"the package is unknown; did you mean {source.type.meant}?"
            client.statuses.misspelled(f"{text}: {meant}")
        self._channels[channel.id] = source, channel.encoding
        self._uses[source] = self._uses.get(source, 0) + 1

    def remove(self, id_: int) -> None:
        """Stop publishing a topic; an unknown id may be of one that was refused."""
        if id_ not in self._channels:
            return
        source, _ = self._channels.pop(id_)
        self._uses[source] -= 1
        if not self._uses[source]:
            del self._uses[source]
            self._client.graph.remove_source(source)

    def publish(self, id_: int, data: memoryview) -> None:
        """Publish a message; raises as `Source.publish` does, with the topic's name in the text."""
        if id_ not in self._channels:
            self._strays += 1
            if is_power_of_ten(self._strays):
                text = f"channel {id_} is not advertised (messages dropped: {self._strays})"
                self._client.statuses.error(text)
            return
        source, encoding = self._channels[id_]
        try:
            if encoding == JSON:
                source.publish(_read_json(data), len(data))
            else:
                source.publish_serialized(data)
        except LimitReached:
            raise
        except FibwsError as error:
            raise OperationError(f"{source.topic.name}: {error}") from None

    def withdraw_forbidden(self) -> Work:
        """Take back, one by one, what the client's rights do not allow any more."""
        for id_, (source, _) in list(self._channels.items()):
            if id_ in self._channels and not self._client.graph.rights.allows_source(source):
                self.remove(id_)
                if source not in self._uses:
                    self._client.report_withdrawn("publish", source.topic.name)
            yield

    def leave(self) -> Removals:
        """Publish nothing any more, and return the sources that are to be removed."""
        sources, self._uses = list(self._uses), {}
        self._channels.clear()
        self._client.graph.abandon(sources)
        return ((self._client.graph.remove_source, sources),)


def _definition(channel: ClientChannel, graph: Graph) -> str | None:
    """Return the definition of a type that a client brings, as ROS 1 would have it.

    A type of ROS 2 that ROS 1 has with the same fields is ROS 1's, which the hub knows.

    Raises:
        InterfaceError: it is invalid.
    """
    text, name = channel.schema_text, channel.schema_name
    if not text or channel.schema_encoding not in (None, "", ROS1_TEXT, *ROS2_TEXTS):
        return None
    if channel.schema_encoding not in ROS2_TEXTS:
        return text
    if len(text) > LONGEST_TEXT:
        raise InterfaceError(f"the schema of {name} is too long (limit {LONGEST_TEXT} characters)")
    if channel.schema_encoding == ROS2_IDL:
        text = idl.full_text(Interfaces.canonical(name), text)
    return Ros2Definitions(name, text, graph.definitions.base).full_text(name)


def unknown_channel(id_: int) -> OperationError:
    """Return the error for a subscription to a channel that is not, or no longer, there."""
    return OperationError(f"Unknown channel ID: {id_}")


def _read_json(data: memoryview) -> object:
    """Return the value of a JSON text; raise `OperationError`."""
    text = bytes(data)
    check_json(text)
    try:
        return from_json(text)
    except ValueError as error:
        raise OperationError(f"invalid JSON: {error}") from None
