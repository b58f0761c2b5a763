"""The sending end of a topic."""

from __future__ import annotations

from typing import Any, Generic, Self, TypeVar, overload

from typing_extensions import ParamSpec

from fibws.interfaces import Message
from fibws.node.outbox import Advertisement
from fibws.node.topics import Topics
from fibws.node.wire import Wire
from fibws.protocol.operations import Publish, encode

M = TypeVar("M", bound=Message)
P = ParamSpec("P", default=...)
"""The fields of the messages, as their class takes them; any, if they are not known."""


class Publisher(Generic[M, P]):
    """Publishes messages of one type on one topic.

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
        message = self._wire.write(self._message(fields, named))
        text = encode(Publish(topic=self.topic, msg=message))
        await self._topics.room()
        self._topics.publish(self._advertisement, text)

    def close(self) -> None:
        """Publish no more. Does nothing when called again."""
        self._topics.unadvertise(self._advertisement)

    async def __aenter__(self) -> Self:
        return self

    async def __aexit__(self, *error: object) -> None:
        self.close()

    def _message(self, fields: tuple[Any, ...], named: dict[str, Any]) -> Any:
        if fields and named:
            raise TypeError("publish() can be called with arguments or keywords, but not both.")
        if len(fields) == 1 and isinstance(fields[0], Message):
            return fields[0]
        return self._wire.message_class(*fields, **named)
