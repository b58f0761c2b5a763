"""A session: what one client does, operation by operation.

Synchronous and without a socket: text comes in by `Session.receive`, frames go out by the outbox.
"""

from __future__ import annotations

import logging
from collections.abc import Callable
from typing import Any, assert_never

from fibws import names
from fibws.errors import FibwsError, OperationError
from fibws.hub.clock import Clock
from fibws.hub.framing import text_frame
from fibws.hub.graph import Graph, Unchecked
from fibws.hub.outbox import Outbox
from fibws.hub.settings import Settings
from fibws.hub.subscription import Subscription
from fibws.hub.topic import Channel, Publisher, Topic
from fibws.protocol.closing import REPLACED, Closing
from fibws.protocol.fragments import Reassembly
from fibws.protocol.operations import (
    REQUESTS,
    Advertise,
    Fragment,
    Id,
    Level,
    Publish,
    Request,
    SetLevel,
    Status,
    Subscribe,
    Unadvertise,
    Unsubscribe,
    encode,
    parse_request,
)
from fibws.protocol.text import objects

logger = logging.getLogger("fibws.hub")

_GRAVITY: dict[Level, int] = {"none": 0, "error": 1, "warning": 2, "info": 3}
_INFO = _GRAVITY["info"]

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
        "_complaints",
        "_graph",
        "_level",
        "_outbox",
        "_reassembly",
        "_settings",
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
        self._level = _GRAVITY["error"]
        self._reassembly: Reassembly | None = None
        self._complaints = 0
        self.publishers: dict[str, Publisher] = {}
        """By the spelling of the topic's name that the client used."""
        self.subscriptions: dict[str, Subscription] = {}
        """By the spelling of the topic's name that the client used."""
        self.node = graph.enter(self, node)

    def receive(self, text: bytes) -> None:
        """Do what a text asks for; what is wrong with it is answered by a status.

        Raises:
            InvalidUtf8: the bytes are no text.
        """
        try:
            for number, fields in enumerate(objects(text)):
                if number == MAX_OBJECTS:
                    raise OperationError(f"Expected at most {MAX_OBJECTS} operations in one text")
                self._perform(fields)
        except OperationError as error:
            self._complain(str(error), None)

    def refuse(self, fault: str) -> None:
        """Tell the client that what it sent was no operation at all."""
        self._complain(fault, None)

    def replaced(self) -> None:
        """Another client has taken this one's name."""
        self.leave()
        self._close(REPLACED)

    def leave(self) -> None:
        """Take the client's registrations back; the second time nothing happens."""
        for publisher in {id(each): each for each in self.publishers.values()}.values():
            self._end_publisher(publisher)
        self.publishers.clear()
        for spelling in list(self.subscriptions):
            self._cancel(spelling, None)
        self._graph.leave(self, self.node)

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
            self._complain(f"{prefix}{error}", fields.get("id"))

    def _handle(self, request: Request) -> None:
        match request:
            case Publish():
                publisher = self._advertise_by_publishing(request)
                self._publish(publisher, request.msg, request.id)
            case Subscribe():
                self._subscribe(request)
            case Unsubscribe():
                self._cancel(request.topic, request.id)
            case Advertise():
                self._advertise(request)
            case Unadvertise():
                self._unadvertise(request)
            case Fragment():
                self._reassemble(request)
            case SetLevel():
                self._level = _GRAVITY[request.level]
            case _:
                assert_never(request)

    def _publish(self, publisher: Publisher, msg: object, id_: object) -> None:
        publisher.publish(msg)
        if self._level == _INFO:
            missing = publisher.type.missing(msg if isinstance(msg, dict) else {})
            if missing:
                self._say("info", id_, f"publish: defaults stand for {', '.join(missing)}")

    def _advertise(self, request: Advertise) -> None:
        topic = self._topic(request.topic)
        publisher = self._register(topic, request, request.type, request.definition)
        if isinstance(publisher.type, Unchecked):
            self._say("warning", request.id, f"nobody defined {request.type}: not checked")
        self._say("info", request.id, f"{self.node} publishes {topic.name} ({publisher.type.type})")

    def _advertise_by_publishing(self, request: Publish) -> Publisher:
        topic = self._topic(request.topic)
        if topic.type is None:
            self._graph.settle(topic)
            raise OperationError(
                f"Cannot infer topic type for topic {request.topic} as it is not yet advertised"
            )
        return self._register(topic, request, topic.type.type, None)

    def _register(
        self, topic: Topic, request: Advertise | Publish, type_: str, definition: str | None
    ) -> Publisher:
        message_type = self._graph.establish(topic, type_, definition)
        publisher = topic.publishers.get(self.node)
        if publisher is None:
            publisher = Publisher(topic, message_type, latch=request.latch)
            topic.publishers[self.node] = publisher
        publisher.advertisements.add(request.id)
        self.publishers[request.topic] = publisher
        return publisher

    def _unadvertise(self, request: Unadvertise) -> None:
        publisher = self.publishers.get(request.topic)
        if publisher is None:
            return
        publisher.advertisements.discard(request.id)
        if request.id is None or not publisher.advertisements:
            for spelling, other in list(self.publishers.items()):
                if other is publisher:
                    del self.publishers[spelling]
            self._end_publisher(publisher)

    def _end_publisher(self, publisher: Publisher) -> None:
        publisher.topic.publishers.pop(self.node, None)
        self._graph.settle(publisher.topic)

    def _subscribe(self, request: Subscribe) -> None:
        topic = self._topic(request.topic)
        if request.type is not None:
            self._graph.establish(topic, request.type)
        subscription = self.subscriptions.get(request.topic)
        if subscription is None:
            subscription = Subscription(
                self.node, self._outbox, self._clock, queue_length=self._settings.queue_length
            )
            self.subscriptions[request.topic] = subscription
        subscription.request(request)
        channel = topic.channels.get(request.topic)
        if channel is None:
            channel = topic.channels[request.topic] = Channel(request.topic)
        channel.set(subscription)
        if topic.type is None:
            self._say("info", request.id, f"{topic.name} has no type yet: waiting for a publisher")
        if request.compression != "none":
            self._say("warning", request.id, f"no {request.compression} yet: messages come as JSON")
        for publisher in topic.publishers.values():
            if publisher.latched is not None:
                subscription.send(channel.frame(publisher.latched))

    def _cancel(self, spelling: str, id_: Id) -> None:
        subscription = self.subscriptions.get(spelling)
        if subscription is None:
            return
        subscription.cancel(id_)
        topic = self._topic(spelling)
        topic.channels[spelling].set(subscription)
        if not subscription.requests:
            del self.subscriptions[spelling]
        self._graph.settle(topic)

    def _reassemble(self, fragment: Fragment) -> None:
        if self._reassembly is None:
            self._reassembly = Reassembly(max_size=self._settings.max_message_size)
        text = self._reassembly.add(fragment, self._clock.time())
        if text is None:
            return
        for fields in objects(text.encode()):
            if fields.get("op") == "fragment":
                raise OperationError("fragments within fragments are not put together")
            self._perform(fields)

    def _topic(self, spelling: str) -> Topic:
        return self._graph.topic(names.resolve(spelling, node=self.node))

    def _complain(self, fault: str, id_: object) -> None:
        self._complaints += 1
        # A client that errs a thousand times in a second must not fill the disk.
        if str(self._complaints).strip("0") == "1":
            logger.warning(
                "%s: %s (error %d of this client)", self.node, _printable(fault), self._complaints
            )
        self._say("error", id_, fault)

    def _say(self, level: Level, id_: object, text: str) -> None:
        if _GRAVITY[level] <= self._level:
            status = Status(
                id=id_ if isinstance(id_, str | int | float) else None,
                level=level,
                msg=_shortened(text),
            )
            self._outbox.reply(text_frame(encode(status)))


def _printable(text: str) -> str:
    """What may be written to a log of a text that may hold line ends and terminal codes."""
    return "".join(c if c.isprintable() else ascii(c)[1:-1] for c in _shortened(text))


def _shortened(text: str) -> str:
    """What is fit to be read of a text that repeats names of the client's making."""
    return text if len(text) <= 1000 else f"{text[:1000]}..."
