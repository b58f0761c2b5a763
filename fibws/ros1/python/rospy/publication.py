"""What all publishers of one topic in the process share."""

from __future__ import annotations

import threading
from collections.abc import Callable
from contextlib import suppress
from functools import partial
from typing import TYPE_CHECKING, Any, Protocol

from rospy import core
from rospy.exceptions import ROSException, ROSInterruptException, ROSSerializationException
from rospy.foreign import count_nodes
from rospy.handover import Handover
from rospy.inbox import Inbox, call
from rospy.names import ANYTYPE
from rospy.registration import register

if TYPE_CHECKING:
    import asyncio

    from genpy import Message

    import fibws

INFINITE = 10_000
"""Messages that a queue without a bound, or no queue, keeps while there is no hub."""


class Listener(Protocol):
    """What is told of subscribers: a `rospy.SubscribeListener`."""

    def peer_subscribe(
        self,
        topic_name: str,
        topic_publish: Callable[[Any], None],
        peer_publish: Callable[[Any], None],
    ) -> None: ...

    def peer_unsubscribe(self, topic_name: str, num_peers: int) -> None: ...


class Publication:
    """One topic's registration with the hub, from the node's start on or later.

    Args:
        resolved_name: the topic's global name.
        data_class: the class of its messages.
    """

    def __init__(self, resolved_name: str, data_class: type[Message]) -> None:
        self.resolved_name = resolved_name
        self.data_class = data_class
        self._class = _class(data_class._type)
        """What is sent: the class as the definition has it; None as long as that is not known."""
        self.latch = False
        self.headers: dict[str, str] = {}
        self.queue_size: int | None = None
        self.listeners: list[Listener] = []
        self._lock = threading.RLock()
        self._publisher: fibws.Publisher[Any, ...] | None = None
        self._handover: Handover | None = None
        self._latches = False
        """Whether the publisher that is registered latches."""
        self._watching: asyncio.Task[None] | None = None
        self._peers: list[str] = []
        self._events: Inbox[Callable[[], None]] = Inbox(resolved_name, lambda event: event())
        self._closed = False
        self._counts = False
        self._seq = 0

    def register(self) -> None:
        """Tell the hub of the topic, or that its latch or its headers are others now."""
        if core.is_initialized() and not self._closed:
            register("publication", self.resolved_name, self._register())

    def close(self) -> None:
        """Publish no more, once what was published has been sent."""
        self._closed = True
        self._events.close()
        with suppress(ROSInterruptException):
            core.background.begin(self._leave())

    def get_num_connections(self) -> int:
        """How many nodes subscribe."""
        if self._publisher is None:
            return 0
        peers = self._publisher.peers
        if peers.told:
            return len(peers.names)
        return count_nodes(core.background.node.graph.subscribers(self.resolved_name))

    def publish(self, message: Message, peer: str | None = None) -> None:
        """Publish a message, in any thread but the loop's.

        As in ROS nobody looks at what is wrong with it as long as nobody subscribes.

        Args:
            message: one of the topic's class, or of `AnyMsg`.
            peer: the only node that is to hear it, if not all are.

        Raises:
            ROSSerializationException: a field does not fit the type.
            ROSException: the topic was closed.
        """
        if core.is_shutdown():
            core.background.give_way()  # Loops that do not look would take all the node's time.
            return
        if self._closed:
            raise ROSException("publish() to a closed topic")
        with self._lock:  # The sequence numbers go out in order.
            try:
                if message._type == ANYTYPE:
                    message = self._open(message)
                else:
                    self._number(message)
                if self._publisher is None or self._handover is None:
                    return
                self._handover.put(_encode(self._publisher, message, peer))
            except ROSSerializationException:
                if self.get_num_connections():
                    raise

    def _number(self, message: Message) -> None:
        """Number a message that has a header as rospy does, from the first one that is heard on."""
        if not self._counts:
            self._counts = self.latch or bool(self._peers)
            if not self._counts:
                return
        self._seq += 1
        if getattr(message, "_has_header", False):
            header = message.header
            header.seq = self._seq
            if header.frame_id is None:
                header.frame_id = "0"

    def _open(self, message: Message) -> Message:
        """The message whose bytes an `AnyMsg` holds."""
        from genpy import DeserializationError

        if self._class is None:
            header = getattr(message, "_connection_header", None) or {}
            self._class = _class(header.get("type"))
            if self._class is None:
                raise ROSException(
                    f"the type of what is published on {self.resolved_name} is not known: "
                    "an AnyMsg that was received has it in its _connection_header"
                )
            self.register()
        if message._buff is None:
            raise ROSException("AnyMsg is not initialized")
        try:
            return self._class().deserialize(message._buff)
        except DeserializationError as error:
            raise ROSSerializationException(str(error)) from None

    async def _register(self) -> None:
        if self._class is None:
            return
        headers = {name: str(value) for name, value in self.headers.items()}
        lossless = self.queue_size is None
        if self._publisher is None or self.latch != self._latches:
            # Up to the end this waits for nothing, so that no message is sent in between.
            self._publisher = await self._advertise(self._class, headers)
            if self._handover is None:
                self._handover = Handover(self._publisher, lossless=lossless)
        else:
            # Another publisher would not have what this one has latched.
            self._publisher.introduce(headers)
        if self._handover is not None:
            self._handover.use(self._publisher, lossless=lossless)

    async def _advertise(
        self, message_class: type[Message], headers: dict[str, str]
    ) -> fibws.Publisher[Any, ...]:
        """Register a publisher, the first one or one that latches."""
        import asyncio

        if self._publisher is not None:
            # For the hub a node's first advertisement of a topic says whether it latches.
            self._publisher.close()
        if self._watching is not None:
            self._watching.cancel()
        self._latches = self.latch
        publisher = await core.background.node.advertise(
            self.resolved_name,
            message_class,
            queue_size=self.queue_size if self.queue_size and self.queue_size > 0 else INFINITE,
            latch=self.latch,
            headers=headers or None,
            peers=True,
        )
        self._watching = asyncio.create_task(self._watch(publisher), name=f"watch {publisher}")
        return publisher

    async def _leave(self) -> None:
        if self._publisher is not None and self._handover is not None:
            await self._handover.finish()
            self._publisher.close()

    async def _watch(self, publisher: fibws.Publisher[Any, ...]) -> None:
        """Tell the listeners who comes and goes, and the log if the hub will not have the topic."""
        async for names in publisher.peers.changes():
            before, self._peers = self._peers, names
            for name in before:
                if name not in names:
                    self._events.put(partial(self._tell, None, len(names)))
            for name in names:
                if name not in before:
                    self._events.put(partial(self._tell, name, len(names)))
        if publisher.fault is not None:
            from rospy import logerr

            self._handover = None
            logerr(f"unable to publish on {self.resolved_name}: {publisher.fault}")

    def _tell(self, came: str | None, count: int) -> None:
        for listener in list(self.listeners):
            if came is None:
                call(listener.peer_unsubscribe, self.resolved_name, count)
            else:
                to_one = partial(self.publish, peer=came)
                call(listener.peer_subscribe, self.resolved_name, self.publish, to_one)


def _class(type_: str | None) -> type[Message] | None:
    from genpy.message import get_message_class

    return get_message_class(type_) if type_ and type_ != ANYTYPE else None


def _encode(publisher: fibws.Publisher[Any, ...], message: Message, peer: str | None) -> bytes:
    from genpy import SerializationError

    try:
        if peer is not None:
            return publisher.encode_to(peer, message)
        return publisher.encode(message)
    except (ValueError, TypeError, AttributeError) as error:
        try:
            message._check_types(error)
        except SerializationError as fault:
            raise ROSSerializationException(str(fault)) from None
        raise
