"""What all subscribers of one topic in the process share."""

from __future__ import annotations

import threading
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from rospy import core
from rospy.arguments import serialized
from rospy.exceptions import ROSException
from rospy.foreign import count_nodes
from rospy.inbox import Inbox, call
from rospy.names import ANYTYPE
from rospy.registration import register

if TYPE_CHECKING:
    import asyncio

    from genpy import Message

    import fibws

MOST = 10_000
MOST_BYTES = 64 << 20
FEW = 50
"""Messages, and bytes, that wait for slow callbacks where nobody says how many may, and messages
that always may. Under ROS the socket would be full long before, and the publisher drop them."""

LOOK = 0.1
"""Seconds between two looks for a topic's type."""


class Subscription:
    """One topic's subscription at the hub, from the node's start on or later.

    Its messages go to all callbacks, in one thread.

    Args:
        resolved_name: the topic's global name.
        data_class: the class of its messages.
    """

    def __init__(self, resolved_name: str, data_class: type[Message]) -> None:
        self.resolved_name = resolved_name
        self.data_class = data_class
        self._found = data_class
        """Another class than that, if it leaves open what comes."""
        self._queue_size: int | None = None
        self._lock = threading.RLock()
        """Keeps who comes and a message that comes apart: each message is told once to each."""
        self._callbacks: list[tuple[Callable[..., object], Any]] = []
        self._latched: dict[str, Message] = {}
        """The last one of each publisher that keeps it, and that the callbacks were told."""
        self._inbox: Inbox[Message] = Inbox(resolved_name, self._handle)
        self._source: fibws.Subscription[Any] | None = None
        self._task: asyncio.Task[None] | None = None
        self._said: dict[str, str] | None = None
        self._header: dict[str, str] = {}
        self._has_told = False
        self._closed = False

    def set_queue_size(self, queue_size: int) -> None:
        """Bound how many messages wait for the callbacks; -1 is for no bound.

        Raises:
            ROSException: it is 0, or no int.
        """
        if queue_size == 0:
            raise ROSException("queue size may not be set to zero")
        if type(queue_size) is not int:
            raise ROSException("queue size must be an integer")
        self._queue_size = queue_size if queue_size > 0 else None

    def register(self) -> None:
        """Ask the hub for the topic."""
        if core.is_initialized() and not self._closed and self._task is None:
            register("subscription", self.resolved_name, self._register())

    def close(self) -> None:
        """Listen no more."""
        with self._lock:
            self._closed = True
            self._callbacks = []
        self._inbox.close()
        core.background.soon(self._leave)

    def get_num_connections(self) -> int:
        """How many nodes publish."""
        if self._source is None:
            return 0
        peers = self._source.peers
        if peers.told:
            return len(peers.names)
        return count_nodes(core.background.node.graph.publishers(self.resolved_name))

    def add_callback(self, callback: Callable[..., object], callback_args: Any) -> None:
        """Call a function with each message, and with ``callback_args`` if that is not None.

        What is latched it is told at once, in this thread.
        """
        with self._lock:
            self._callbacks = [*self._callbacks, (callback, callback_args)]
            latched = list(self._latched.values())
        for message in latched:
            _invoke(callback, message, callback_args)

    def remove_callback(self, callback: Callable[..., object], callback_args: Any) -> None:
        """Take back one `add_callback`; a closed subscription has none left.

        Raises:
            KeyError: there was none of these arguments.
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

    def _handle(self, message: Message) -> None:
        header = message._connection_header
        with self._lock:
            callbacks = self._callbacks
            if header.get("latching") == "1":
                self._latched[header.get("callerid", "")] = message
        for callback, callback_args in callbacks:
            _invoke(callback, message, callback_args)

    async def _register(self) -> None:
        import asyncio

        core.background.node.resolve(self.resolved_name)  # It raises if the name is not legal.
        self._task = asyncio.create_task(self._listen(), name=f"listen {self.resolved_name}")
        # Its first step, which subscribes.
        await asyncio.sleep(0)

    def _leave(self) -> None:
        if self._task is not None:
            self._task.cancel()
        if self._source is not None:
            self._source.close()

    async def _listen(self) -> None:
        from fibws.errors import FibwsError, NodeClosed, NodeKilled, NodeReplaced

        try:
            node = core.background.node
            if self.data_class._type == ANYTYPE:
                self._found = await self._find(node)
            self._source = source = node.subscribe(
                self.resolved_name,
                self._found,
                queue_size=self._queue_size,
                headers=True,
                peers=True,
            )
            source.hand_to(self._take)
            async for _ in source:
                pass
        except (NodeClosed, NodeKilled, NodeReplaced):
            pass  # The whole node ends, and says why.
        except FibwsError as fault:
            from rospy import logerr

            logerr(f"unable to subscribe to {self.resolved_name}: {fault}")

    async def _find(self, node: fibws.Node) -> type[Message]:
        """The class of the topic's messages, once the graph knows their type."""
        import asyncio

        from genpy.message import get_message_class

        from fibws.errors import UnknownPackage

        while True:
            type_ = await node.graph.topic_type(self.resolved_name)
            if type_:
                break
            await asyncio.sleep(LOOK)
        found: type[Message] | None = get_message_class(type_)
        if found is None:
            raise UnknownPackage(type_.partition("/")[0])
        return found

    def _take(self, message: Message) -> None:
        assert self._source is not None
        said = self._source.connection_header
        if said != self._said:
            self._said = said
            self._header = self._connection_header(said)
        if self._found is not self.data_class:
            message = self.data_class().deserialize(serialized(message))
        message._connection_header = self._header
        if self._inbox.put(message, self._queue_size or self._bound(message)):
            self._tell_of_drops()

    def _bound(self, message: Message) -> int:
        """How many messages like this one may wait where nobody has bounded that."""
        if len(self._inbox) < FEW:
            return MOST
        return max(FEW, min(MOST, MOST_BYTES // _size(message)))

    def _tell_of_drops(self) -> None:
        if self._queue_size is None and not self._has_told:
            from rospy import logwarn

            self._has_told = True
            logwarn(
                f"the callbacks of {self.resolved_name} are too slow: "
                "the oldest messages that wait for them are dropped"
            )

    def _connection_header(self, said: dict[str, str]) -> dict[str, str]:
        """What TCPROS tells beside what the hub said."""
        return {
            "topic": self.resolved_name,
            "type": self._found._type,
            "md5sum": self._found._md5sum,
            "message_definition": self._found._full_text,
            **said,
        }


def _invoke(callback: Callable[..., object], message: Message, callback_args: Any) -> None:
    if callback_args is None:
        call(callback, message)
    else:
        call(callback, message, callback_args)


def _size(message: Message) -> int:
    """About how many bytes of memory a message takes."""
    size = 500
    for name in message.__slots__:
        value = getattr(message, name)
        if isinstance(value, str | bytes):
            size += len(value)
        elif hasattr(value, "__len__"):
            size += 32 * len(value)
    return size
