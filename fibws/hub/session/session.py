"""A session: what one client does, operation by operation.

Synchronous and without a socket: text comes in by `Session.receive`, frames go out by the outbox.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, assert_never

from fibws import names
from fibws.errors import FibwsError, OperationError
from fibws.hub.clock import Clock
from fibws.hub.graph.graph import Graph, Unchecked
from fibws.hub.graph.subscription import Subscription
from fibws.hub.graph.topic import Publisher, Topic
from fibws.hub.outbox import Outbox
from fibws.hub.session.statuses import Statuses
from fibws.hub.settings import Settings
from fibws.protocol.closing import REPLACED, Closing
from fibws.protocol.fragments import Reassembly
from fibws.protocol.operations import (
    Advertise,
    Fragment,
    Publish,
    Request,
    SetLevel,
    Subscribe,
    Unadvertise,
    Unsubscribe,
)
from fibws.protocol.parsing import REQUESTS, parse_request
from fibws.protocol.text import objects

MAX_OBJECTS = 1000
"""Operations in one text: a megabyte of ``{}{}{}`` would keep all others waiting."""


class Session:
    """One client's part in the graph, from its handshake to its leaving.

    Args:
        node: the client's global name, or None for one of the hub's making.
        close: closes the client's connection.
    """

    __slots__ = (
        "_clock",
        "_close",
        "_graph",
        "_outbox",
        "_reassembly",
        "_settings",
        "_statuses",
        "node",
        "publishers",
        "subscriptions",
    )

    def __init__(
        self,
        node: str | None,
        graph: Graph,
        outbox: Outbox,
        clock: Clock,
        settings: Settings,
        close: Callable[[Closing], None],
    ) -> None:
        self._graph = graph
        self._outbox = outbox
        self._clock = clock
        self._settings = settings
        self._close = close
        self._reassembly: Reassembly | None = None
        self.publishers: dict[str, Publisher] = {}
        """By the spelling of the topic's name that the client used."""
        self.subscriptions: dict[str, Subscription] = {}
        """By the spelling of the topic's name that the client used."""
        self.node = graph.enter(self, node)
        self._statuses = Statuses(self.node, outbox)

    def receive(self, data: bytes) -> None:
        """Do what a text asks for; what is wrong with it is answered by a status.

        Raises:
            InvalidUtf8: the bytes are no text.
        """
        try:
            self._perform_all(data)
        except OperationError as error:
            self._statuses.error(None, str(error))

    def refuse(self, fault: str) -> None:
        """Tell the client that what it sent was no operation at all."""
        self._statuses.error(None, fault)

    def replaced(self) -> None:
        """Another client has taken this one's name."""
        self.leave()
        self._close(REPLACED)

    def leave(self) -> None:
        """Take the client's registrations back; the second time nothing happens."""
        for publisher in {id(each): each for each in self.publishers.values()}.values():
            self._graph.remove_publisher(publisher)
        self.publishers.clear()
        for subscription in self.subscriptions.values():
            self._graph.unsubscribe(subscription, None)
        self.subscriptions.clear()
        self._graph.leave(self, self.node)

    def _perform_all(self, data: bytes, *, reassembled: bool = False) -> None:
        for number, fields in enumerate(objects(data)):
            if number == MAX_OBJECTS:
                raise OperationError(f"Expected at most {MAX_OBJECTS} operations in one text")
            if reassembled and fields.get("op") == "fragment":
                raise OperationError("fragments within fragments are not put together")
            self._perform(fields)

    def _perform(self, fields: dict[str, Any]) -> None:
        try:
            topic = fields.get("topic")
            if fields.get("op") == "publish" and isinstance(topic, str):
                # Nearly every operation is this one. With a publisher at hand it needs no model:
                # but for its topic and its message, its fields mean nothing any more.
                publisher = self.publishers.get(topic)
                if publisher is not None:
                    self._publish(publisher, fields.get("msg"), fields.get("id"))
                    return
            self._handle(parse_request(fields))
        except FibwsError as error:
            operation = fields.get("op")
            prefix = f"{operation}: " if operation in REQUESTS else ""
            self._statuses.error(fields.get("id"), f"{prefix}{error}")

    def _handle(self, request: Request) -> None:
        match request:
            case Publish():
                publisher = self._advertise_by_publishing(request)
                self._publish(publisher, request.msg, request.id)
            case Subscribe():
                self._subscribe(request)
            case Unsubscribe():
                self._unsubscribe(request)
            case Advertise():
                self._advertise(request)
            case Unadvertise():
                self._unadvertise(request)
            case Fragment():
                self._reassemble(request)
            case SetLevel():
                self._statuses.set_level(request.level)
            case _:
                assert_never(request)

    def _publish(self, publisher: Publisher, msg: object, id_: object) -> None:
        publisher.publish(msg)
        if self._statuses.wants_info:
            missing = publisher.type.missing(msg if isinstance(msg, dict) else {})
            if missing:
                self._statuses.info(id_, f"publish: defaults stand for {', '.join(missing)}")

    def _advertise(self, request: Advertise) -> None:
        publisher = self._register(request, request.type, request.definition)
        publisher.advertise(request.id)
        name, type_ = publisher.topic.name, publisher.type.type
        if isinstance(publisher.type, Unchecked):
            self._statuses.warning(request.id, f"{name}: messages of type {type_} are not checked")
        self._statuses.info(request.id, f"{self.node} publishes {name} ({type_})")

    def _advertise_by_publishing(self, request: Publish) -> Publisher:
        topic = self._topic(request.topic)
        if topic.type is None:
            raise OperationError(
                f"Cannot infer topic type for topic {request.topic} as it is not yet advertised"
            )
        return self._register(request, topic.type.type, None)

    def _register(
        self, request: Advertise | Publish, type_: str, definition: str | None
    ) -> Publisher:
        if request.topic not in self.publishers:
            self._check_room()
        publisher = self._graph.add_publisher(
            self._topic(request.topic), self.node, type_, definition, latch=request.latch
        )
        self.publishers[request.topic] = publisher
        return publisher

    def _unadvertise(self, request: Unadvertise) -> None:
        publisher = self.publishers.get(request.topic)
        if publisher is None or publisher.unadvertise(request.id):
            return
        for spelling, other in list(self.publishers.items()):
            if other is publisher:
                del self.publishers[spelling]
        self._graph.remove_publisher(publisher)

    def _subscribe(self, request: Subscribe) -> None:
        subscription = self.subscriptions.get(request.topic)
        if subscription is None:
            self._check_room()
            subscription = Subscription(
                self.node,
                self._topic(request.topic),
                request.topic,
                self._outbox,
                self._clock,
                queue_length=self._settings.queue_length,
            )
        self._graph.subscribe(subscription, request)
        self.subscriptions[request.topic] = subscription
        topic = subscription.topic
        if topic.type is None:
            self._statuses.info(request.id, f"{topic.name} waits for a publisher to have a type")
        if request.compression != "none" or request.fragment_size is not None:
            self._statuses.warning(request.id, "subscribe: messages come as JSON, in one piece")
        if topic.replay(subscription):
            # The one answer that is larger than what asked for it: written at once, so that a
            # client that asks and asks is paused, and its queues bound what is kept.
            self._outbox.flush()

    def _unsubscribe(self, request: Unsubscribe) -> None:
        subscription = self.subscriptions.get(request.topic)
        if subscription is not None:
            self._graph.unsubscribe(subscription, request.id)
            if not subscription.requests:
                del self.subscriptions[request.topic]

    def _reassemble(self, fragment: Fragment) -> None:
        if self._reassembly is None:
            self._reassembly = Reassembly(max_size=self._settings.max_message_size)
        text = self._reassembly.add(fragment, self._clock.time())
        if text is not None:
            self._perform_all(text.encode(), reassembled=True)

    def _topic(self, spelling: str) -> Topic:
        return self._graph.topic(names.resolve(spelling, node=self.node))

    def _check_room(self) -> None:
        most = self._settings.max_topics
        if len(self.publishers) + len(self.subscriptions) >= most:
            raise OperationError(f"One client may have to do with {most} topics, not with more")
