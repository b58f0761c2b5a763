"""The state that all publishers of one topic in the process share."""

from __future__ import annotations

import threading
from collections.abc import Callable
from contextlib import suppress
from functools import partial
from typing import TYPE_CHECKING, Any, NamedTuple, Protocol

from genpy.message import SerializationError, get_message_class

from fibws.errors import MessageTooLarge
from rospy import core
from rospy.callback_queue import CallbackQueue, call
from rospy.exceptions import ROSException, ROSInterruptException, ROSSerializationException
from rospy.msg import Message, number_header
from rospy.names import ANYTYPE
from rospy.outgoing_queue import OutgoingQueue

if TYPE_CHECKING:
    import asyncio

    import fibws

INFINITE = 10_000
"""Messages to keep without a hub, for a publisher without a queue or with an unlimited one."""


class Listener(Protocol):
    """A `rospy.SubscribeListener`."""

    def peer_subscribe(
        self,
        topic_name: str,
        topic_publish: Callable[[Any], None],
        peer_publish: Callable[[Any], None],
    ) -> None: ...

    def peer_unsubscribe(self, topic_name: str, num_peers: int) -> None: ...


class RawType(NamedTuple):
    """The type of messages that are published as bytes (`AnyMsg`)."""

    name: str
    md5sum: str | None = None
    definition: str | None = None


class Publication:
    """One topic's registration with the hub, from the node's start on or later.

    Args:
        resolved_name: the topic's global name.
        data_class: the class of its messages; that of `AnyMsg` is registered with the type of the
            first message.
    """

    def __init__(self, resolved_name: str, data_class: type[Message]) -> None:
        self.resolved_name = resolved_name
        self.data_class = data_class
        self._type: type[Message] | RawType | None = _plain_class(data_class._type)
        """The type to register: the class without numpy's arrays, or the type of the bytes."""
        self.latch = False
        self.headers: dict[str, str] = {}
        self.queue_size: int | None = None
        self.listeners: list[Listener] = []
        self._lock = threading.RLock()
        self._publisher: fibws.Publisher[Any, ...] | None = None
        self._outgoing: OutgoingQueue | None = None
        self._latches = False
        """Whether the registered publisher latches."""
        self._watching: asyncio.Task[None] | None = None
        self._peers: list[str] = []
        self._events: CallbackQueue[Callable[[], None]] = CallbackQueue(
            resolved_name, lambda event: event()
        )
        self._closed = False
        self._counts = False
        self._seq = 0

    def register(self) -> None:
        """Register the topic with the hub, or change its latch or its headers."""
        if core.is_initialized() and not self._closed:
            core.register("publication", self.resolved_name, self._register())

    def close(self) -> None:
        """Stop publishing once all published messages have been sent."""
        self._closed = True
        self._events.close()
        with suppress(ROSInterruptException):
            core.background.begin(self._unregister())

    def get_num_connections(self) -> int:
        """Return how many nodes subscribe."""
        return len(self._subscribers())

    def has_connection(self, endpoint_id: str) -> bool:
        """Return whether a node subscribes; ROS's actionlib asks for this."""
        return endpoint_id in self._subscribers()

    def _subscribers(self) -> list[str]:
        if self._publisher is None:
            return []
        question = core.background.node.graph.subscribers(self.resolved_name)
        return core.peer_names(self._publisher.peers, question)

    def publish(self, message: Message, peer: str | None = None) -> None:
        """Publish a message, in any thread but the loop's.

        As in ROS, fields that do not fit raise no error while the topic has no subscribers.

        Args:
            message: one of the topic's class, or of `AnyMsg`, whose bytes are sent as they are.
            peer: the only node that is to receive it; None for all.

        Raises:
            ROSSerializationException: a field does not fit the type, or the message is larger than
                the hub takes.
            ROSException: the topic was closed, or the type of an `AnyMsg` is unknown.
        """
        if core.is_shutdown():
            core.background.give_way()  # A loop without a check would take all the CPU time.
            return
        if self._closed:
            raise ROSException("publish() to a closed topic")
        with self._lock:  # Messages are sent in the order of their sequence numbers.
            try:
                if message._type == ANYTYPE:
                    self._publish_bytes(message, peer)
                    return
                self._number(message)
                if self._publisher is not None and self._outgoing is not None:
                    self._outgoing.put(_encode(self._publisher, message, peer))
            except MessageTooLarge as error:
                raise ROSSerializationException(str(error)) from None
            except ROSSerializationException:
                if self.get_num_connections():
                    raise

    def _publish_bytes(self, message: Message, peer: str | None) -> None:
        """Publish an `AnyMsg`."""
        if self._type is None:
            self._type = self._find_type(message)
            self.register()
        if message._buff is None:
            raise ROSException("AnyMsg is not initialized")
        if self._publisher is not None and self._outgoing is not None:
            self._outgoing.put(self._publisher._encode_serialized(message._buff, peer))

    def _find_type(self, message: Message) -> RawType:
        """Return the type of an `AnyMsg`: that of its header, or else the topic's."""
        header = getattr(message, "_connection_header", None) or {}
        type_ = header.get("type", ANYTYPE)
        if type_ != ANYTYPE:
            return RawType(type_, header.get("md5sum"), header.get("message_definition"))
        type_ = core.ask(core.background.node.graph.topic_type(self.resolved_name), "")
        if not type_:
            raise ROSException(
                f"unknown type of the messages for {self.resolved_name}: "
                "a received AnyMsg has it in its _connection_header"
            )
        return RawType(type_)

    def _number(self, message: Message) -> None:
        """Set the sequence number of a message's header, from the first subscriber on, as rospy."""
        if not self._counts:
            self._counts = self.latch or bool(self._peers)
            if not self._counts:
                return
        self._seq += 1
        if getattr(message, "_has_header", False):
            number_header(message.header, self._seq)

    async def _register(self) -> None:
        if self._type is None:
            return
        headers = {name: str(value) for name, value in self.headers.items()}
        lossless = self.queue_size is None
        if self._publisher is None or self.latch != self._latches:
            # Up to the end this waits for nothing, so that no message is sent in between.
            self._publisher = await self._advertise(self._type, headers)
            if self._outgoing is None:
                self._outgoing = OutgoingQueue(self._publisher, lossless=lossless)
        else:
            # A new publisher would not have the latched message.
            self._publisher._introduce(headers)
        if self._outgoing is not None:
            self._outgoing.use(self._publisher, lossless=lossless)

    async def _advertise(
        self, type_: type[Message] | RawType, headers: dict[str, str]
    ) -> fibws.Publisher[Any, ...]:
        """Register a publisher, the first one or one that latches."""
        import asyncio

        if self._publisher is not None:
            # The hub takes `latch` from a node's first advertisement of a topic.
            self._publisher.close()
        if self._watching is not None:
            self._watching.cancel()
        self._latches = self.latch
        options: dict[str, Any] = {
            "queue_size": self.queue_size if self.queue_size and self.queue_size > 0 else INFINITE,
            "latch": self.latch,
            "headers": headers or None,
            "peers": True,
            "wait": False,  # See `_register`; a refusal is logged.
        }
        node = core.background.node
        publisher: fibws.Publisher[Any, ...]
        if isinstance(type_, RawType):
            publisher = await node.advertise_serialized(
                self.resolved_name,
                type_.name,
                md5sum=type_.md5sum,
                definition=type_.definition,
                **options,
            )
        else:
            publisher = await node.advertise(self.resolved_name, type_, **options)
        self._watching = asyncio.create_task(self._watch(publisher), name=f"watch {publisher}")
        return publisher

    async def _unregister(self) -> None:
        if self._publisher is not None and self._outgoing is not None:
            await self._outgoing.flush()
            self._publisher.close()

    async def _watch(self, publisher: fibws.Publisher[Any, ...]) -> None:
        """Report subscribers that come and leave to the listeners; stop if the hub refuses."""
        async for names in publisher.peers.changes():
            before, self._peers = set(self._peers), names
            for _ in before.difference(names):
                self._events.put(partial(self._report, None, len(names)))
            for name in sorted(set(names) - before):
                self._events.put(partial(self._report, name, len(names)))
        if publisher.fault is not None:
            self._outgoing = None  # The node has logged why.

    def _report(self, new: str | None, count: int) -> None:
        """Call the listeners.

        Args:
            new: the new subscriber; None if one has left.
            count: how many subscribers there are.
        """
        for listener in list(self.listeners):
            if new is None:
                call(listener.peer_unsubscribe, self.resolved_name, count)
            else:
                to_one = partial(self.publish, peer=new)
                call(listener.peer_subscribe, self.resolved_name, self.publish, to_one)


def _plain_class(type_: str) -> type[Message] | None:
    """Return the class of a type without numpy's arrays; None for `AnyMsg`."""
    return get_message_class(type_) if type_ != ANYTYPE else None


def _encode(publisher: fibws.Publisher[Any, ...], message: Message, peer: str | None) -> bytes:
    try:
        if peer is not None:
            return publisher._encode_to(peer, message)
        return publisher._encode(message)
    except MessageTooLarge:
        raise
    except (ValueError, TypeError, AttributeError) as error:
        try:
            message._check_types(error)
        except SerializationError as fault:
            raise ROSSerializationException(str(fault)) from None
        raise
