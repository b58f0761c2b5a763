"""The state that all subscribers of one topic in the process share."""

from __future__ import annotations

import threading
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from genpy.message import get_message_class

from rospy import core, statistics
from rospy.callback_queue import CallbackQueue, call
from rospy.exceptions import ROSException
from rospy.msg import Message, serialized
from rospy.names import ANYTYPE

if TYPE_CHECKING:
    import asyncio

    import fibws
    from fibws.node.subscription import Received
    from rospy.statistics import TopicMeasurement

MOST = 10_000
MOST_BYTES = 64 << 20
FEW = 50
"""Messages, and bytes, that wait for slow callbacks of subscribers without a queue size, and
messages that always may. In ROS the socket would be full long before, and messages dropped."""

POLL_INTERVAL = 0.1
"""Seconds between two requests for a topic's type, to a rosbridge_suite server."""

MOST_HEADERS = 100
"""Most connection headers to keep parsed."""


class Subscription:
    """One topic's subscription at the hub, from the node's start on or later.

    Messages are decoded, and passed to all callbacks, in one thread of the topic's own.

    Args:
        resolved_name: the topic's global name.
        data_class: the class of its messages.
    """

    def __init__(self, resolved_name: str, data_class: type[Message]) -> None:
        self.resolved_name = resolved_name
        self.data_class = data_class
        self._received_class = data_class
        """The class of received messages. For `AnyMsg`, a server that sends JSON needs the topic's
        real class; its messages are then serialized again."""
        self._queue_size: int | None = None
        self._lock = threading.RLock()
        """Held to add a callback, or a latched message: each callback is passed the message once.
        """
        self._callbacks: list[tuple[Callable[..., object], Any]] = []
        self._latched: dict[str, Message] = {}
        """The last message that was passed to the callbacks, by the publisher that latches it."""
        self._queue: CallbackQueue[Received] = CallbackQueue(resolved_name, self._handle)
        self._source: fibws.Subscription[Any] | None = None
        self._task: asyncio.Task[None] | None = None
        self._measurement: TopicMeasurement | None = None
        self._headers: dict[tuple[str, bytes], dict[str, str]] = {}
        """Connection headers by the type and the JSON that they were made from."""
        self._has_warned = False
        self._closed = False

    def set_queue_size(self, queue_size: int) -> None:
        """Limit how many messages wait for the callbacks; -1 for no limit.

        Raises:
            ROSException: it is 0, or not an int.
        """
        if queue_size == 0:
            raise ROSException("queue size may not be set to zero")
        if type(queue_size) is not int:
            raise ROSException("queue size must be an integer")
        self._queue_size = queue_size if queue_size > 0 else None

    def register(self) -> None:
        """Subscribe at the hub."""
        if core.is_initialized() and not self._closed and self._task is None:
            core.register("subscription", self.resolved_name, self._register())

    def close(self) -> None:
        """Unsubscribe."""
        with self._lock:
            self._closed = True
            self._callbacks = []
        self._queue.close()
        if self._measurement is not None:
            self._measurement.close()
        core.background.soon(self._unregister)

    def get_num_connections(self) -> int:
        """Return how many nodes publish."""
        return len(self.connections)

    @property
    def connections(self) -> list[core.Connection]:
        """The nodes that publish; ROS's actionlib looks for its server among them."""
        if self._source is None:
            return []
        question = core.background.node.graph.publishers(self.resolved_name)
        names = core.peer_names(self._source.peers, question)
        return [core.Connection(endpoint_id=name, callerid_pub=name) for name in names]

    def add_callback(self, callback: Callable[..., object], callback_args: Any) -> None:
        """Call a function with each message, and with ``callback_args`` if that is not None.

        It is called at once, in this thread, with latched messages that others were passed.
        """
        with self._lock:
            self._callbacks = [*self._callbacks, (callback, callback_args)]
            latched = list(self._latched.values())
        for message in latched:
            _invoke(callback, message, callback_args)

    def remove_callback(self, callback: Callable[..., object], callback_args: Any) -> None:
        """Undo one `add_callback`; do nothing once the subscription is closed.

        Raises:
            KeyError: there is no such callback.
        """
        with self._lock:
            if self._closed:
                return
            callbacks = list(self._callbacks)
            try:
                callbacks.remove((callback, callback_args))
            except ValueError:
                raise KeyError("no matching cb") from None
            self._callbacks = callbacks

    # In the loop

    async def _register(self) -> None:
        import asyncio

        core.background.node.resolve(self.resolved_name)  # It raises if the name is not legal.
        self._task = asyncio.create_task(self._listen(), name=f"listen {self.resolved_name}")
        # Run its first step, which subscribes.
        await asyncio.sleep(0)

    def _unregister(self) -> None:
        if self._task is not None:
            self._task.cancel()
        if self._source is not None:
            self._source.close()

    async def _listen(self) -> None:
        from fibws.errors import FibwsError, NodeClosed, NodeKilled, NodeReplaced

        try:
            node = core.background.node
            if self.data_class._type == ANYTYPE and not node.serialized:
                self._received_class = await self._find_class(node)
            self._source = source = node.subscribe(
                self.resolved_name,
                self._received_class,
                queue_size=self._queue_size,
                headers=True,
                peers=True,
            )
            source._hand_undecoded_to(self._take)
            self._measurement = await statistics.measurement(self.resolved_name)
            async for _ in source:
                pass
        except (NodeClosed, NodeKilled, NodeReplaced):
            pass  # The end of the node is reported elsewhere.
        except FibwsError as fault:
            from rospy import logerr

            logerr(f"unable to subscribe to {self.resolved_name}: {fault}")

    async def _find_class(self, node: fibws.Node) -> type[Message]:
        """Wait until the topic has a type, and return the class of that."""
        import asyncio

        from fibws.errors import UnknownPackage

        while True:
            type_ = await node.graph.topic_type(self.resolved_name)
            if type_:
                break
            await asyncio.sleep(POLL_INTERVAL)
        found: type[Message] | None = get_message_class(type_)
        if found is None:
            raise UnknownPackage(type_.partition("/")[0])
        return found

    def _take(self, received: Received) -> None:
        """Queue a message for the callbacks."""
        limit = self._queue_size or self._limit(received)
        if self._queue.put(received, limit) and not (self._queue_size or self._has_warned):
            from rospy import logwarn

            self._has_warned = True
            logwarn(
                f"the callbacks of {self.resolved_name} are too slow: "
                "the oldest messages that wait for them are dropped"
            )

    def _limit(self, received: Received) -> int:
        """Return how many messages like this one may wait if the program sets no queue size."""
        if len(self._queue) < FEW:
            return MOST
        return max(FEW, min(MOST, MOST_BYTES // _size(received[0])))

    # In the thread of the callbacks

    def _handle(self, received: Received) -> None:
        """Decode a message and call the callbacks."""
        assert self._source is not None
        message = self._source._decode(received)
        if message is None:
            return
        if self._received_class is not self.data_class:
            message = self.data_class().deserialize(serialized(message))
        message._connection_header = self._header(self._source, received[1])
        if self._measurement is not None:
            content = received[0]
            is_binary = isinstance(content, memoryview)
            size = content.nbytes if is_binary else len(serialized(message))
            self._measurement.add(message, size)
        self._call_back(message)

    def _call_back(self, message: Message) -> None:
        header = message._connection_header
        with self._lock:
            callbacks = self._callbacks
            if header.get("latching") == "1":
                self._latched[header.get("callerid", "")] = message
        for callback, callback_args in callbacks:
            _invoke(callback, message, callback_args)

    def _header(
        self, source: fibws.Subscription[Any], sent: bytes | dict[str, str] | None
    ) -> dict[str, str]:
        """Return a message's connection header; the same one for the same publisher."""
        if not isinstance(sent, bytes):
            return self._full_header(source, sent or {})
        key = (source.type, sent)
        header = self._headers.get(key)
        if header is None:
            import json

            if len(self._headers) == MOST_HEADERS:
                self._headers.clear()
            header = self._full_header(source, json.loads(sent) if sent else {})
            self._headers[key] = header
        return header

    def _full_header(self, source: fibws.Subscription[Any], sent: dict[str, str]) -> dict[str, str]:
        """Return the hub's header with the other fields of TCPROS."""
        if self._received_class._type == ANYTYPE:
            type_, md5sum = source.type, source.md5sum or ANYTYPE
            definition = _definition(self.resolved_name, type_, md5sum)
        else:
            found = self._received_class
            type_, md5sum, definition = found._type, found._md5sum, found._full_text
        return {
            "topic": self.resolved_name,
            "type": type_,
            "md5sum": md5sum,
            "message_definition": definition,
            **sent,
        }


def _definition(topic: str, type_: str, md5sum: str) -> str:
    """Return the text of a topic's type: the local one if that is the same, or else the hub's."""
    from fibws.errors import InterfaceError
    from fibws.msg import default_interfaces

    interfaces = default_interfaces()
    try:
        if interfaces.md5(type_) == md5sum:
            return interfaces.full_text(type_)
    except InterfaceError:
        pass
    return core.ask(_definition_at_hub(topic), "")


async def _definition_at_hub(topic: str) -> str:
    node = core.background.node
    found = await node.call("/rosapi/topics_and_raw_types", "rosapi/TopicsAndRawTypes")
    texts: dict[str, str] = dict(zip(found.topics, found.typedefs_full_text, strict=False))
    return texts.get(topic, "")


def _invoke(callback: Callable[..., object], message: Message, callback_args: Any) -> None:
    if callback_args is None:
        call(callback, message)
    else:
        call(callback, message, callback_args)


def _size(content: Any) -> int:
    """Return about how many bytes of memory a message takes that is not decoded."""
    if isinstance(content, memoryview):
        return 500 + content.nbytes
    values = content.values() if isinstance(content, dict) else ()
    return 500 + sum(32 + len(each) for each in values if isinstance(each, str | list | dict))
