"""A node's publishers and subscriptions, as its hub knows them."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from functools import partial
from itertools import count
from typing import Any, TypeVar

from fibws.errors import MessageTooLarge, NodeError, OperationError, OperationRejected
from fibws.interfaces import Message
from fibws.node.outgoing_queue import PublisherLane
from fibws.node.publisher import Publisher
from fibws.node.session import OperationHandler, Session
from fibws.node.subscription import ReportedType, Subscription, TakeSerialized
from fibws.node.types import ANY_TYPE, MessageCodec
from fibws.protocol.operations import (
    Advertise,
    Operation,
    Peers,
    Publish,
    Reply,
    Subscribe,
    Subscribed,
    Unadvertise,
    Unsubscribe,
)
from fibws.protocol.serialized import read_delivery, read_topic
from fibws.protocol.websocket import Payload

M = TypeVar("M", bound=Message)

UNBOUNDED_QUEUE = 10_000
"""The queue_length that a subscription without a limit asks the hub for: a second of the fastest
topics. The hub limits the bytes anyway (--max-queued-bytes)."""

RECORDED_QUEUE = 1_000_000
"""That of a subscription whose messages are recorded: the bytes alone bound it."""


class NodeTopics(OperationHandler):
    """Handles the operations and the messages of topics."""

    def __init__(self, session: Session) -> None:
        self._session = session
        self._publishers: dict[str, Publisher[Any, ...]] = {}
        self._subscriptions: dict[str, Subscription[Any]] = {}
        """By the ids of their operations, both."""
        self._readers: dict[str, list[Subscription[Any]]] = {}
        """Subscriptions by topic."""
        self._confirmed: dict[int, list[tuple[Subscription[Any], ReportedType]]] = {}
        """By the topics' numbers on the current connection, if that is one of `fibws.v1`: the
        subscriptions that the hub has answered, and the type of the messages of this number."""
        self._topic_numbers: dict[str, set[int]] = {}
        """The same numbers by topic, which has several if its type has changed."""
        self._numbers = count(1)
        session.add_handler(self)
        session.set_message_handlers(self._on_json, self._on_binary)

    # Called by the node

    def advertise(
        self,
        topic: str,
        codec: MessageCodec[M],
        *,
        queue_size: int,
        latch: bool = False,
        headers: Mapping[str, str] | None = None,
        peers: bool = False,
        keep_seq: bool = False,
        refused: Callable[[NodeError], None] | None = None,
    ) -> Publisher[M, ...]:
        """Register a publisher; see `Node.advertise`.

        Args:
            topic: the topic's global name.
            codec: the codec of its messages.
            refused: is called if the hub refuses the topic; without it, that is logged.
        """
        self._session.check()
        operation = Advertise(
            id=self._session.id("advertise", topic),
            topic=topic,
            type=codec.type,
            latch=latch,
            queue_size=queue_size,
            definition=codec.definition,
            headers=dict(headers) if headers else None,
            peers=peers or None,
            peer_changes=peers or None,
            keep_seq=keep_seq or None,
        )
        publisher: Publisher[M, ...] = Publisher(
            self._session,
            operation,
            next(self._numbers),
            codec,
            self._unadvertise,
            refused or partial(self._log_refusal, topic),
        )
        self._publishers[publisher._id] = publisher
        self._session.send(publisher._registration())
        return publisher

    def subscribe(
        self,
        topic: str,
        codec: MessageCodec[M],
        *,
        queue_size: int | None,
        headers: bool = False,
        peers: bool = False,
        take: Callable[[M], object] | None = None,
        take_serialized: TakeSerialized | None = None,
        refused: Callable[[OperationRejected], None] | None = None,
    ) -> Subscription[M]:
        """Register a subscription; see `Node.subscribe`.

        Args:
            topic: the topic's global name.
            codec: the codec of its messages.
            take: is called with each message instead of queueing it; see `Subscription._hand_to`.
            take_serialized: as ``take``; see `Subscription._hand_serialized_to`.
            refused: is called if the hub refuses the subscription.
        """
        self._session.check()
        operation = Subscribe(
            id=self._session.id("subscribe", topic),
            topic=topic,
            type=codec.type if codec.type != ANY_TYPE else None,
            queue_length=queue_size
            or (UNBOUNDED_QUEUE if take_serialized is None else RECORDED_QUEUE),
            headers=headers or None,
            peers=peers or None,
            peer_changes=peers or None,
        )
        subscription = Subscription(
            operation, codec, queue_size, self._unsubscribe, self._session.log, refused
        )
        if take is not None:
            subscription._hand_to(take)
        if take_serialized is not None:
            subscription._hand_serialized_to(take_serialized)
        self._subscriptions[subscription._id] = subscription
        self._readers[topic] = [*self._readers.get(topic, ()), subscription]
        self._session.send(subscription._registration(serialized=self._session.serialized))
        return subscription

    @property
    def over(self) -> bool:
        """Whether the node has ended."""
        return self._session.over

    def names(self) -> list[str]:
        """Return the topics that the node publishes or subscribes to."""
        published = {publisher.topic for publisher in self._publishers.values()}
        return sorted(published | self._readers.keys())

    # Called by the session

    def _registrations(self) -> Iterator[Operation]:
        """Yield all advertisements and subscriptions."""
        for publisher in self._publishers.values():
            yield publisher._registration()
            if publisher._will is not None:
                yield publisher._will
        for subscription in self._subscriptions.values():
            yield subscription._registration(serialized=self._session.serialized)

    def _retained(self) -> Iterator[tuple[bytes, PublisherLane]]:
        """Yield the latched messages, except those that wait to be sent anyway.

        One that the hub does not take is forgotten.
        """
        waiting: set[int] | None = None
        for publisher in self._publishers.values():
            latched = publisher._latched
            if latched is not None:
                try:
                    self._session.outgoing.check_size(latched, publisher.topic)
                except MessageTooLarge as fault:
                    self._session.log.error("Dropped: %s", fault)
                    publisher._latched = None
                    continue
                waiting = self._session.outgoing.waiting() if waiting is None else waiting
                if id(latched) not in waiting:
                    yield latched, publisher._lane

    def _on_reply(self, reply: Reply) -> bool:
        """Handle an operation; it may arrive after its topic's last reader has left."""
        match reply:
            case Publish():
                self._on_json(reply.topic, reply.msg, reply.header)
            case Subscribed():
                subscription = self._subscriptions.get(str(reply.id))
                if subscription is not None:
                    self._confirm(subscription, reply)
            case Peers():
                id_ = str(reply.id)
                owner = self._publishers.get(id_) or self._subscriptions.get(id_)
                if owner is None:
                    pass
                elif reply.nodes is not None:
                    owner.peers._update(reply.nodes)
                else:
                    owner.peers._change(reply.removed, reply.added)
            case _:
                return False
        return True

    def _on_refusal(self, id_: str, error: OperationRejected) -> bool:
        """End a publisher or a subscription that the hub refuses."""
        if (publisher := self._publishers.pop(id_, None)) is not None:
            publisher._refuse(error)
            return True
        if (subscription := self._forget(id_)) is not None:
            subscription._refuse(error)
            return True
        return False

    def _on_skipped(self, beginning: bytes, size: int, fault: str) -> bool:
        """Count a message that was too long to be read as dropped by its readers."""
        readers = self._confirmed.get(read_topic(beginning), ())
        for subscription, _ in readers:
            subscription._skip()
        if readers and (count := readers[0][0]._skipped) == 10 ** (len(str(count)) - 1):
            text = "Dropped a message on %s: %s; %d so far"
            self._session.log.error(text, readers[0][0].topic, fault, count)
        return bool(readers)

    def _on_disconnect(self) -> None:
        """Forget what the lost hub reported: the topics' numbers, and peers."""
        self._confirmed.clear()
        self._topic_numbers.clear()
        for publisher in self._publishers.values():
            publisher.peers._on_disconnect()
        for subscription in self._subscriptions.values():
            subscription.peers._on_disconnect()

    def _on_end(self, error: Exception | None) -> None:
        """End all iterations."""
        for publisher in self._publishers.values():
            publisher.peers._end()
        for subscription in self._subscriptions.values():
            subscription._end(error)

    def _confirm(self, subscription: Subscription[Any], reply: Subscribed) -> None:
        """Deliver the messages of a topic's number to a subscription from now on.

        Not before: another subscription of the node may hear the topic already, whose messages
        this one could not tell the type of.
        """
        number = reply.topic_id
        type_ = ReportedType(reply.type, reply.md5sum, reply.definition or "")
        subscription._found(type_)
        # A new list, as in `_forget`. The hub may give a topic's number to another topic.
        others = (
            each
            for each in self._confirmed.get(number, ())
            if each[0] is not subscription and each[0].topic == subscription.topic
        )
        self._confirmed[number] = [*others, (subscription, type_)]
        self._topic_numbers.setdefault(subscription.topic, set()).add(number)

    def _on_binary(self, data: Payload) -> None:
        """Queue a serialized message for its readers."""
        try:
            number, received, header, message = read_delivery(data)
        except OperationError as error:
            self._session.log.warning("The hub sent an %s", error)
            return
        for subscription, type_ in self._confirmed.get(number, ()):
            if subscription._offer_serialized(message, header, received, type_):
                self._session.give_readers_a_turn()

    def _on_json(self, topic: str, message: Any, header: dict[str, str] | None) -> bool:
        """Queue a message for its readers; return whether there are any."""
        readers = self._readers.get(topic, ())
        for subscription in readers:
            if subscription._offer(message, header):
                self._session.give_readers_a_turn()
        return bool(readers)

    def _log_refusal(self, topic: str, error: NodeError) -> None:
        # Its publisher may not publish for a long time, or never again.
        self._session.log.error("The hub refused the publisher of %s: %s", topic, error)

    def _unadvertise(self, publisher: Publisher[Any, ...]) -> None:
        if self._publishers.pop(publisher._id, None) is not None:
            self._session.send(Unadvertise(id=publisher._id, topic=publisher.topic))

    def _unsubscribe(self, subscription: Subscription[Any]) -> None:
        if self._forget(subscription._id) is not None:
            self._session.send(Unsubscribe(id=subscription._id, topic=subscription.topic))

    def _forget(self, id_: str) -> Subscription[Any] | None:
        subscription = self._subscriptions.pop(id_, None)
        if subscription is not None:
            # A new list: a subscription may be closed while the old one is iterated over.
            topic = subscription.topic
            others = [each for each in self._readers[topic] if each is not subscription]
            if others:
                self._readers[topic] = others
            else:
                del self._readers[topic]
            numbers = self._topic_numbers.get(topic, ())
            if not others:
                self._topic_numbers.pop(topic, None)
            for number in numbers:
                readers = self._confirmed.get(number, [])
                self._confirmed[number] = [each for each in readers if each[0] is not subscription]
                if not self._confirmed[number]:
                    del self._confirmed[number]
        return subscription
