"""The sending end of a topic."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Generic, Self, TypeVar, overload

from typing_extensions import ParamSpec

from fibws.errors import NodeError
from fibws.interfaces import Message
from fibws.interfaces.json_text import exact_json_of
from fibws.node.advertisement import Advertisement
from fibws.node.peers import Peers
from fibws.node.topics import Topics
from fibws.node.wire import Wire
from fibws.protocol.headers import check_headers
from fibws.protocol.operations import encode_fields, json_of

M = TypeVar("M", bound=Message)
P = ParamSpec("P", default=...)
"""The fields of the messages, as their class takes them; any, if they are not known."""


class _ToOne(bytes):
    """A message for one node alone, which those who come later are not to hear."""


class Publisher(Generic[M, P]):
    """Publishes messages of one type on one topic.

    `publish` is three steps, for programs with threads to take one by one: `encode` in any of them,
    and in the loop `room`, which may be left out, and `send`.

    Leave it with `close`, or by ``async with``, to stop publishing before the node does.
    """

    def __init__(
        self,
        topics: Topics,
        advertisement: Advertisement,
        wire: Wire[M],
    ) -> None:
        self._topics = topics
        self._advertisement = advertisement
        self._wire = wire
        self._before = b'{"op":"publish","topic":%b,"msg":' % json_of(self.topic)
        """What each message's operation begins with."""

    def __repr__(self) -> str:
        return f"<Publisher {self.topic} [{self.type}]>"

    @property
    def topic(self) -> str:
        """The topic's global name."""
        return self._advertisement.operation.topic

    @property
    def type(self) -> str:
        """The type of its messages, such as ``std_msgs/Int32``."""
        return self._advertisement.operation.type

    @property
    def dropped(self) -> int:
        """How many of its messages were dropped before they were sent."""
        return self._advertisement.dropped

    @property
    def fault(self) -> NodeError | None:
        """Why nobody can hear this publisher: the hub has refused it. Usually None."""
        return self._advertisement.fault

    @property
    def peers(self) -> Peers:
        """The nodes that subscribe to the topic, if `Node.advertise` was told to ask for them."""
        return self._advertisement.peers

    @overload
    async def publish(self, message: M, /) -> None: ...

    @overload
    async def publish(self, *fields: P.args, **named: P.kwargs) -> None: ...

    async def publish(self, *fields: Any, **named: Any) -> None:
        """Publish a message: one of the topic's class, or its fields in order, or by name.

        Waits while the connection is slower than the program. Without a hub it waits for nothing:
        the newest ``queue_size`` messages are kept for when there is one again. Messages arrive at
        most once, in order. A header's stamp is 0 unless given, as in rospy; `Node.now` is the
        time of day.

        Raises:
            InvalidMessage: a field does not fit the type.
            TypeError: fields both in order and by name, or a message of another class.
            OperationRejected: the hub refused the topic, so that nobody can hear this.
            NodeClosed: the publisher or its node was closed.
        """
        text = self._encode(fields, named)
        await self.room()
        self.send(text)

    @overload
    def encode(self, message: M, /) -> bytes: ...

    @overload
    def encode(self, *fields: P.args, **named: P.kwargs) -> bytes: ...

    def encode(self, *fields: Any, **named: Any) -> bytes:
        """Check a message, given as to `publish`, and make of it what `send` takes.

        It changes nothing and waits for nothing, and may be called in any thread.

        Raises:
            InvalidMessage: a field does not fit the type.
            TypeError: fields both in order and by name, or a message of another class.
        """
        return self._encode(fields, named)

    @overload
    def encode_to(self, node: str, message: M, /) -> bytes: ...

    @overload
    def encode_to(self, node: str, /, *fields: P.args, **named: P.kwargs) -> bytes: ...

    def encode_to(self, node: str, /, *fields: Any, **named: Any) -> bytes:
        """As `encode`, for one subscriber: its global name, such as ``peers`` has it.

        If that node does not subscribe, nobody hears the message. It is never latched. Hubs of
        others send it to all.
        """
        return _ToOne(self._encode(fields, named, to=node))

    @property
    def has_room(self) -> bool:
        """Whether `room` waits for nothing, in the node's loop."""
        return self._topics.has_room

    @property
    def is_idle(self) -> bool:
        """Whether all that the node had to say has been written to its socket."""
        return self._topics.is_idle

    async def room(self) -> None:
        """Wait while the connection is slower than the program; without a hub for nothing."""
        await self._topics.room()

    def send(self, text: bytes) -> None:
        """Send what `encode` made, in the node's loop, and wait for nothing.

        While there is no `room`, or no hub, the newest ``queue_size`` messages are kept.

        Raises:
            OperationRejected: the hub refused the topic, so that nobody can hear this.
            NodeClosed: the publisher or its node was closed.
        """
        to_all = not isinstance(text, _ToOne)
        self._topics.publish(self._advertisement, text, to_all=to_all)

    def introduce(self, headers: Mapping[str, str]) -> None:
        """From now on have subscribers told these headers, as `Node.advertise` has it.

        Raises:
            ValueError: the headers are no short strings.
        """
        self._topics.introduce(self._advertisement, check_headers(headers))

    def close(self) -> None:
        """Publish no more. Does nothing when called again."""
        self._topics.unadvertise(self._advertisement)

    async def __aenter__(self) -> Self:
        return self

    async def __aexit__(self, *error: object) -> None:
        self.close()

    def _encode(
        self, fields: tuple[Any, ...], named: dict[str, Any], to: str | None = None
    ) -> bytes:
        message = exact_json_of(self._wire.write(self._message(fields, named)))
        if to is None:
            return b"%b%b}" % (self._before, message)
        return encode_fields({"op": "publish", "topic": self.topic, "to": to}, msg=message)

    def _message(self, fields: tuple[Any, ...], named: dict[str, Any]) -> Any:
        if fields and named:
            raise TypeError("publish() can be called with arguments or keywords, but not both.")
        if len(fields) == 1 and isinstance(fields[0], Message):
            return fields[0]
        return self._wire.message_class(*fields, **named)
