"""The topics that one client publishes and subscribes to."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from fibws.errors import FibwsError, OperationError
from fibws.hub.budget import Budget
from fibws.hub.frames import text_frame
from fibws.hub.graph.encoding import COMPRESSIONS
from fibws.hub.graph.peers import Peers
from fibws.hub.graph.publisher import Publisher
from fibws.hub.graph.subscription import Subscription
from fibws.hub.graph.topic import Topic
from fibws.hub.session.client import Client, check_room
from fibws.hub.session.early import GRACE, EarlyMessages
from fibws.protocol.operations import (
    Advertise,
    Publish,
    Subscribe,
    Unadvertise,
    Unsubscribe,
    encode_fields,
)


class Topics:
    """One client's publishers and subscriptions."""

    __slots__ = (
        "_client",
        "_early",
        "_grace_ends",
        "_latches",
        "publishers",
        "subscriptions",
    )

    def __init__(self, client: Client) -> None:
        self._client = client
        self._latches: Budget | None = None
        self._grace_ends = client.clock.time() + GRACE
        self._early: EarlyMessages | None = None
        self.publishers: dict[str, Publisher] = {}
        """By the spelling of the topic's name that the client used."""
        self.subscriptions: dict[str, Subscription] = {}
        """By the spelling of the topic's name that the client used."""

    def publish(
        self,
        publisher: Publisher,
        msg: object,
        id_: Any,
        size: int | None = None,
        to: str | None = None,
    ) -> None:
        """Publish a message with a publisher at hand; otherwise as `Publisher.publish`."""
        publisher.publish(msg, size, to)
        statuses = self._client.statuses
        if statuses.wants_info:
            missing = publisher.type.missing(msg if isinstance(msg, dict) else {})
            if missing:
                statuses.info(id_, f"publish: defaults stand for {', '.join(missing)}")

    def advertise(self, request: Advertise) -> None:
        """Register a publisher, or another advertisement of one."""
        known = self.publishers.get(request.topic)
        if known is not None and request.peers:
            known.topic.to_publishers.check_room(known, request.id)
        publisher = self._register(request, request.type, request.definition)
        publisher.advertise(request.id)
        if request.headers is not None:
            publisher.introduce(request.headers)
        name, type_ = publisher.topic.name, publisher.type
        statuses = self._client.statuses
        if not type_.checked:
            statuses.warning(request.id, f"{name}: messages of type {type_.name} are not checked")
        statuses.info(request.id, f"{self._client.node} publishes {name} ({type_.name})")
        topic = publisher.topic
        self._ask(request, topic.to_publishers, publisher, topic.subscribers())
        self._publish_early(topic)

    def publish_parsed(self, request: Publish) -> None:
        """Publish a message that is for one node alone, or that nothing announced.

        The latter waits until its topic has a type.
        """
        publisher = self.publishers.get(request.topic)
        if publisher is not None:
            self._publish(publisher, request)
            return
        topic = self._topic(request.topic)
        if topic.type is None and self._is_early(topic, request):
            return
        self._publish_early(topic)
        self._advertise_by_publishing(request)

    def _is_early(self, topic: Topic, request: Publish) -> bool:
        """Whether a message may wait for its topic's type."""
        if self._early is None:
            if self._client.clock.time() >= self._grace_ends:
                return False
            self._early = EarlyMessages(self._client.clock, self._grace_ends, self._publish_late)
        return self._early.put(topic.name, request)

    def _publish_early(self, topic: Topic) -> None:
        """Publish what waited for the topic's type."""
        if self._early is not None:
            for message in self._early.take(topic.name):
                self._publish_late(message)

    def _advertise_by_publishing(self, request: Publish) -> None:
        topic = self._topic(request.topic)
        if topic.type is None:
            raise OperationError(
                f"Cannot infer topic type for topic {request.topic} as it is not yet advertised"
            )
        publisher = self._register(request, topic.type.name, None)
        self._publish(publisher, request)

    def _publish(self, publisher: Publisher, request: Publish) -> None:
        to = None if request.to is None else self._client.resolve(request.to)
        self.publish(publisher, request.msg, request.id, to=to)

    def _publish_late(self, request: Publish) -> None:
        """Publish a message that waited for its topic's type, or say why that cannot be."""
        try:
            self._advertise_by_publishing(request)
        except FibwsError as error:
            self._client.statuses.error(request.id, f"publish: {error}")

    def unadvertise(self, request: Unadvertise) -> None:
        """Take back an advertisement; the publisher goes with the last."""
        publisher = self.publishers.get(request.topic)
        if publisher is None:
            return
        publisher.topic.to_publishers.cancel(publisher, request.id)
        if publisher.unadvertise(request.id):
            return
        for spelling, other in list(self.publishers.items()):
            if other is publisher:
                del self.publishers[spelling]
        self._client.graph.remove_publisher(publisher)

    def subscribe(self, request: Subscribe) -> None:
        """Add a request to the subscription of the topic that is spelled so."""
        client = self._client
        subscription = self.subscriptions.get(request.topic)
        if subscription is None:
            check_room(len(self.subscriptions), client.settings.max_subscriptions, "subscriptions")
            subscription = Subscription(
                client.node,
                self._topic(request.topic),
                request.topic,
                client.outbox,
                client.clock,
                client.statuses.error,
                queue_length=client.settings.queue_length,
            )
        if request.peers:
            subscription.topic.to_subscribers.check_room(subscription, request.id)
        client.graph.subscribe(subscription, request)
        self.subscriptions[request.topic] = subscription
        topic = subscription.topic
        if request.compression not in COMPRESSIONS:
            client.statuses.warning(
                request.id, f"{topic.name}: compression is one of {', '.join(COMPRESSIONS)}"
            )
        if topic.type is None:
            client.statuses.info(request.id, f"{topic.name} waits for a publisher to have a type")
        self._ask(request, topic.to_subscribers, subscription, topic.publishers)
        topic.replay(subscription)

    def unsubscribe(self, request: Unsubscribe) -> None:
        """Take back one request, or all; the subscription goes with the last."""
        subscription = self.subscriptions.get(request.topic)
        if subscription is not None:
            subscription.topic.to_subscribers.cancel(subscription, request.id)
            self._client.graph.unsubscribe(subscription, request.id)
            if not subscription.requests:
                del self.subscriptions[request.topic]

    def leave(self) -> None:
        """Take all back."""
        if self._early is not None:
            self._early.close()
        for publisher in {id(each): each for each in self.publishers.values()}.values():
            self._client.graph.remove_publisher(publisher)
        self.publishers.clear()
        for subscription in self.subscriptions.values():
            self._client.graph.unsubscribe(subscription, None)
        self.subscriptions.clear()

    def _ask(
        self, request: Advertise | Subscribe, peers: Peers, owner: object, nodes: Iterable[str]
    ) -> None:
        """Tell the client of its peers, if a request asks for that."""
        peers.cancel(owner, request.id)
        if not request.peers:
            return
        fields = {"op": "peers", "id": request.id, "topic": request.topic}
        before = encode_fields(fields, nodes=b"")[:-1]  # There may be thousands who are told.
        outbox = self._client.outbox

        def tell(nodes: bytes) -> None:
            # Only the newest is of use, and it must not be others who make the client overfull.
            outbox.latest(tell, text_frame(b"%b%b}" % (before, nodes)))

        peers.ask(owner, request.id, tell, nodes)

    def _register(
        self, request: Advertise | Publish, type_: str, definition: str | None
    ) -> Publisher:
        if request.topic not in self.publishers:
            limit = self._client.settings.max_advertisements
            check_room(len(self.publishers), limit, "advertisements")
        if self._latches is None:
            self._latches = Budget(self._client.settings.max_latched_bytes)
        publisher = self._client.graph.add_publisher(
            self._topic(request.topic),
            self._client.node,
            type_,
            definition,
            latch=request.latch,
            latches=self._latches,
        )
        self.publishers[request.topic] = publisher
        return publisher

    def _topic(self, spelling: str) -> Topic:
        return self._client.graph.topic(self._client.resolve(spelling))
