"""The sending end of a topic."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any, ClassVar, Generic, Self, TypeVar, overload

from typing_extensions import ParamSpec

from fibws.errors import InvalidMessage, NodeClosed, NodeError, OperationRejected
from fibws.interfaces import Message
from fibws.interfaces.json_text import exact_json_of
from fibws.node.checks import check_seconds
from fibws.node.outgoing_queue import PublisherLane
from fibws.node.peers import Peers
from fibws.node.session import Registration, Session, throw
from fibws.node.types import MessageCodec
from fibws.protocol.headers import check_headers
from fibws.protocol.operations import (
    LONGEST_WILL,
    SHORTEST_WILL,
    Advertise,
    ClearWill,
    SetWill,
    encode_fields,
    json_of,
)
from fibws.protocol.serialized import publish_head, read_publish
from fibws.protocol.websocket import BINARY, client_header, client_payload
from fibws.public_classes import made_by

M = TypeVar("M", bound=Message)
P = ParamSpec("P", default=...)
"""The fields of the messages, as their class takes them; any, if they are not known."""


@made_by("Node.advertise")
class Publisher(Registration, Generic[M, P]):
    """Publishes messages of one type on one topic.

    Leave it with `close`, or by ``async with``, to stop publishing before the node does.
    """

    _other_names: ClassVar = {
        "get_num_connections": "await node.graph.subscribers(topic)",
        "unadvertise": "publisher.close()",
        "unregister": "publisher.close()",
    }

    # session: the node's.
    # operation: the advertisement, as for a server without `fibws.v1`.
    # number: the publisher's number on connections of `fibws.v1`.
    # codec: the codec of its messages.
    # withdraw: takes the advertisement back.
    # refused: is called if the hub refuses the advertisement and `Node` does not raise that.
    def __init__(
        self,
        session: Session,
        operation: Advertise,
        number: int,
        codec: MessageCodec[M],
        withdraw: Callable[[Publisher[Any, ...]], None],
        refused: Callable[[NodeError], None] | None = None,
    ) -> None:
        self._session = session
        self._outgoing = session.outgoing
        self._operation = operation
        self._number = number
        self._codec = codec
        self._class: type[Any] = codec.message_class
        self._serialize_after = codec.serialize_after
        self._withdraw = withdraw
        self._refused = refused
        self._head = publish_head(number)
        self._prefix = (-1, b"")
        """The bytes before a message of a size, and this size: that of the last message."""
        self._lane = PublisherLane(operation.queue_size, operation.topic, self._to_json)
        self._peers = Peers()
        self._latched: bytes | None = None
        """The frame of the message to send again on each new connection."""
        self._will: SetWill | None = None
        self._closed = False
        self._fault: NodeError | None = None

    def __repr__(self) -> str:
        return f"<Publisher {self.topic} [{self.type}]>"

    @property
    def topic(self) -> str:
        """The topic's global name."""
        return self._operation.topic

    @property
    def type(self) -> str:
        """The type of its messages, such as ``std_msgs/Int32``."""
        return self._operation.type

    @property
    def dropped(self) -> int:
        """How many of its messages were dropped before they were sent."""
        return self._lane.dropped

    @property
    def fault(self) -> NodeError | None:
        """The hub's refusal of the topic, because of which nothing is published; usually None."""
        return self._fault

    @property
    def peers(self) -> Peers:
        """The nodes that subscribe to the topic, if ``peers=True`` was given."""
        return self._peers

    @overload
    async def publish(self, message: M | Mapping[str, Any], /) -> None: ...

    @overload
    async def publish(self, *fields: P.args, **named: P.kwargs) -> None: ...

    async def publish(self, *fields: Any, **named: Any) -> None:
        """Publish a message: one of the class, or its fields in order, by name, or as a dict.

        Waits while the connection is slower than the program. Without a hub the newest
        ``queue_size`` messages are kept for the next connection. Messages arrive at most once, in
        order. A header's stamp is 0 unless given, as in rospy; `Node.now` is the time of day.

        Raises:
            InvalidMessage: a field does not fit the type.
            MessageTooLarge: the hub does not take messages of this size.
            TypeError: an unknown field, fields both in order and by name, or a message of another
                class.
            OperationRejected: the hub refused the topic.
            NodeClosed: the publisher or its node was closed.
        """
        frame = self._frame_of(fields, named)
        outgoing = self._outgoing
        if not outgoing.ready:
            await outgoing.room()
        if self._closed or self._session.over:
            self._raise()
        if self._operation.latch:
            self._retain(frame)
        outgoing.put(frame, self._lane)

    # `publish` is three steps, for fibws's programs with threads to take one by one: `_encode` in
    # any of them, and in the loop `_room`, which may be left out, and `_send`.

    @overload
    def _encode(self, message: M | Mapping[str, Any], /) -> bytes: ...

    @overload
    def _encode(self, *fields: P.args, **named: P.kwargs) -> bytes: ...

    def _encode(self, *fields: Any, **named: Any) -> bytes:
        """Return the frame of a message, given as to `publish`, for `_send`.

        It changes nothing, waits for nothing, and may be called in any thread.

        Raises:
            InvalidMessage: a field does not fit the type.
            MessageTooLarge: the hub does not take messages of this size.
            TypeError: fields both in order and by name, or a message of another class.
        """
        return self._frame_of(fields, named)

    @overload
    def _encode_to(self, node: str, message: M | Mapping[str, Any], /) -> bytes: ...

    @overload
    def _encode_to(self, node: str, /, *fields: P.args, **named: P.kwargs) -> bytes: ...

    def _encode_to(self, node: str, /, *fields: Any, **named: Any) -> bytes:
        """Return a frame for one subscriber alone: a node's global name, such as `peers` has it.

        It is discarded if that node does not subscribe, and never latched. A rosbridge_suite server
        sends it to all subscribers.

        Raises:
            InvalidMessage, TypeError: as `_encode`.
        """
        return self._frame_of(fields, named, node)

    def _encode_serialized(self, message: bytes, node: str | None = None) -> bytes:
        """Return the frame of a serialized message, of which only the size is checked.

        Args:
            message: ROS 1's serialization.
            node: the only subscriber to send it to; None for all.

        Raises:
            MessageTooLarge: the hub does not take messages of this size.
        """
        return self._checked(self._prefix_to(node)(len(message)) + message)

    @property
    def _has_room(self) -> bool:
        """Whether `_room` returns at once, in the node's loop."""
        return self._outgoing.has_room

    @property
    def _is_idle(self) -> bool:
        """Whether everything that the node sent has been given to its socket."""
        return not self._outgoing.size

    async def _room(self) -> None:
        """Wait while the connection is slower than the program, and give other tasks their turns.

        Without a hub it only does the latter.
        """
        await self._outgoing.room()

    def _send(self, frame: bytes) -> None:
        """Send what `_encode` returned, in the node's loop, without waiting.

        While there is no `_room`, or no hub, the newest ``queue_size`` messages are kept.

        Raises:
            OperationRejected: the hub refused the topic.
            NodeClosed: the publisher or its node was closed.
        """
        if self._closed or self._session.over:
            self._raise()
        if self._operation.latch:
            self._retain(frame)
        self._outgoing.put(frame, self._lane)

    def _send_while_open(self, frame: bytes) -> None:
        """Send a frame, as `_send`, even while the node ends; do nothing once this is closed."""
        if not self._closed:
            if self._operation.latch:
                self._retain(frame)
            self._outgoing.put(frame, self._lane)

    @overload
    def set_will(
        self, message: M | Mapping[str, Any], /, *, timeout: float | None = None
    ) -> None: ...

    @overload
    def set_will(self, *, timeout: float | None = None, **fields: Any) -> None: ...

    def set_will(self, *message: Any, timeout: float | None = None, **fields: Any) -> None:
        """Have the hub publish a message once this node has gone, such as a robot's stop.

        It is published however the node leaves the hub: when it ends, crashes, is killed, or loses
        the network, which the hub notices by its pings. `close` and `clear_will` prevent it. Each
        new connection has it, too. A rosbridge_suite server does not know wills and ignores it.

        Args:
            message: of the topic's class, or its fields by name.
            timeout: seconds, 0.05 to 3600: if the node publishes something on the topic and then
                nothing for so long, the message is published although the node is connected.

        Raises:
            InvalidMessage: a field does not fit the type.
            MessageTooLarge: the hub does not take messages of this size.
            TypeError: a message of another class, or not exactly one.
            ValueError: the timeout is out of range.
            OperationRejected: the hub refused the topic.
            NodeClosed: the publisher or its node was closed.
        """
        if self._closed or self._session.over:
            self._raise()
        check_seconds(timeout)
        if timeout is not None and not SHORTEST_WILL <= timeout <= LONGEST_WILL:
            raise ValueError(
                f"timeout must be between {SHORTEST_WILL:g} and {LONGEST_WILL:g} s, got {timeout:g}"
            )
        frame = self._frame_of(message, fields)
        _, _, payload = read_publish(client_payload(frame))
        values = self._codec.write(self._codec.deserialize(payload))
        self._will = SetWill(
            id=self._session.id("set_will", self.topic),
            topic=self.topic,
            msg=values,
            timeout=timeout,
        )
        self._session.send(self._will)

    def clear_will(self) -> None:
        """Take the will back: nothing is published when this node has gone."""
        if self._will is not None:
            self._will = None
            if not self._closed:
                self._session.send(ClearWill(topic=self.topic))

    def _introduce(self, headers: Mapping[str, str]) -> None:
        """From now on send subscribers other headers; see `Node.advertise`.

        Raises:
            ValueError: the headers are not short strings.
        """
        checked = check_headers(headers)
        if checked == (self._operation.headers or {}):
            return
        self._operation = self._operation.model_copy(update={"headers": checked})
        if not self._closed:
            self._session.send(self._registration())

    def close(self) -> None:
        """Stop publishing. Does nothing when called again."""
        if not self._closed:
            self._close()
            self._withdraw(self)

    async def __aenter__(self) -> Self:
        return self

    async def __aexit__(self, *error: object) -> None:
        self.close()

    # Called by `Topics`

    @property
    def _id(self) -> str:
        """The id of the advertisement."""
        return str(self._operation.id)

    def _registration(self) -> Advertise:
        """Return the advertisement for the current connection."""
        if not self._session.serialized:
            return self._operation
        return self._operation.model_copy(
            update={"publisher": self._number, "md5sum": self._codec.md5sum}
        )

    def _refuse(self, fault: OperationRejected) -> None:
        """Handle the hub's refusal of the topic."""
        self._fault = fault
        self._close()
        if self._refused is not None and not self._is_awaited:
            self._refused(fault)

    def _close(self) -> None:
        self._closed = True
        self._lane.limit = 0  # The next hub is sent nothing more of it.
        self._peers._end()

    def _raise(self) -> None:
        self._session.check()
        if self._fault is not None:
            throw(self._fault)
        raise NodeClosed(f"the publisher of {self.topic} was closed")

    def _frame_of(
        self, fields: tuple[Any, ...], named: dict[str, Any], node: str | None = None
    ) -> bytes:
        message_class = self._class
        if len(fields) == 1 and not named and isinstance(fields[0], Message):
            message = fields[0]
            if not isinstance(message, message_class):
                raise self._codec.mismatch(message)
        elif fields and isinstance(fields[0], type):
            raise self._codec.mismatch(fields[0])
        elif fields and named:
            raise TypeError("publish() can be called with arguments or keywords, but not both.")
        else:
            message = self._codec.make(fields, named)
        return self._checked(self._serialize_after(self._prefix_to(node), message))

    def _checked(self, frame: bytes) -> bytes:
        """Return a frame; raise `MessageTooLarge` if the hub does not take it."""
        # A server without `fibws.v1` gets other frames.
        if len(frame) > self._outgoing.largest:
            self._outgoing.check_size(frame, self.topic)
        return frame

    def _prefix_to(self, node: str | None) -> Callable[[int], bytes]:
        """Return the function that returns the bytes before a message of a size."""
        if node is None:
            return self._prefix_of
        head = publish_head(self._number, node)
        return lambda size: client_header(BINARY, len(head) + size) + head

    def _prefix_of(self, size: int) -> bytes:
        prefix = self._prefix
        if prefix[0] != size:
            header = client_header(BINARY, len(self._head) + size)
            prefix = self._prefix = (size, header + self._head)
        return prefix[1]

    def _retain(self, frame: bytes) -> None:
        if read_publish(client_payload(memoryview(frame))).node is None:
            self._latched = frame

    def _to_json(self, frame: bytes) -> bytes:
        """Return a frame's message as rosbridge's operation; nothing if its bytes are invalid."""
        _, node, payload = read_publish(client_payload(frame))
        try:
            values = self._codec.write(self._codec.deserialize(payload))
        except InvalidMessage as error:
            self._session.log.error("Dropped a message for %s: %s", self.topic, error)
            return b""
        message = exact_json_of(values, self._codec.has_floats)
        if node is not None:
            return encode_fields({"op": "publish", "topic": self.topic, "to": node}, msg=message)
        return b'{"op":"publish","topic":%b,"msg":%b}' % (json_of(self.topic), message)
