"""A publisher: what one client sends on one topic."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from fibws.errors import OperationError
from fibws.hub.budget import Budget
from fibws.hub.graph.encoding import Publication
from fibws.hub.graph.subscription import MAX_REGISTRATIONS
from fibws.hub.graph.types import MessageType
from fibws.protocol.operations import Id, json_of

if TYPE_CHECKING:
    from fibws.hub.graph.topic import Topic


class Publisher:
    """One client's right to publish on one topic, kept while an advertisement of its stands.

    Args:
        node: the client's name.
        now: gives the nanoseconds since 1970.
        latch: keep the last message for those who subscribe later (ROS's latched topics).
        latches: the bytes of JSON that all latched messages of the client may have together.
    """

    __slots__ = (
        "_advertisements",
        "_latches",
        "_now",
        "_sequence",
        "bytes",
        "current",
        "header",
        "latch",
        "latched",
        "messages",
        "node",
        "topic",
        "type",
    )

    def __init__(
        self,
        node: str,
        topic: Topic,
        type_: MessageType,
        now: Callable[[], int],
        *,
        latch: bool,
        latches: Budget,
    ) -> None:
        self.node = node
        self.topic = topic
        self.type = type_
        self.latch = latch
        self.header = b""
        """What is said beside its messages to those who ask, as JSON text."""
        self.introduce({})
        self.latched: Publication | None = None
        self.current: Callable[[], dict[str, Any]] | None = None
        """Gives the message for late subscribers, where keeping the last one is a waste."""
        self._now = now
        self._latches = latches
        self._advertisements: set[Id] = set()
        self._sequence = 0
        self.messages = 0
        """How many it has published."""
        self.bytes = 0
        """How many bytes those had when they came."""

    def introduce(self, headers: dict[str, str]) -> None:
        """From now on say these headers beside each message."""
        latching = "1" if self.latch else "0"
        self.header = json_of({"callerid": self.node, "latching": latching, **headers})

    def advertise(self, id_: Id) -> None:
        """Add an advertisement.

        Raises:
            OperationError: there are too many.
        """
        if len(self._advertisements) >= MAX_REGISTRATIONS and id_ not in self._advertisements:
            raise OperationError(f"{MAX_REGISTRATIONS} advertisements of one topic are enough")
        self._advertisements.add(id_)

    def unadvertise(self, id_: Id) -> bool:
        """Take back the advertisement of this id, or all if it is None; tell whether one stands."""
        if id_ is None:
            self._advertisements.clear()
        self._advertisements.discard(id_)
        return bool(self._advertisements)

    def publish(self, msg: object, size: int | None = None, to: str | None = None) -> None:
        """Check a message and send it on; None stands for the default.

        Args:
            size: the bytes in which it came; None counts those of its JSON text.
            to: the only node that is to hear it, upon which it is not latched.

        Raises:
            InvalidMessage: it does not fit the topic's type.
            OperationError: it was sent, but is too large to be latched with all the others.
        """
        message = self.type.validate({} if msg is None else msg)
        if self.type.sequenced:
            self._sequence += 1
            message["header"]["seq"] = self._sequence & 0xFFFFFFFF
        publication = Publication(message, self.type, self._now(), self.header)
        if to is None:
            self.topic.deliver(publication)
        else:
            self.topic.deliver_to(to, publication)
        self.messages += 1
        self.bytes += len(publication.json()) if size is None else size
        if self.latch and to is None:
            self._keep(publication)

    def recall(self) -> Publication | None:
        """What late subscribers are to hear."""
        if self.current is not None:
            message = self.type.validate(self.current())
            return Publication(message, self.type, self._now(), self.header)
        return self.latched

    def forget(self) -> None:
        """Keep no latched message any more."""
        if self.latched is not None:
            self._latches.used -= len(self.latched.json())
            for channel in self.topic.channels.values():
                channel.forget(self.latched)
            self.latched = None

    def _keep(self, publication: Publication) -> None:
        self.forget()
        publication.settle()
        self._latches.used += len(publication.json())
        self.latched = publication
        if self._latches.exceeded:
            self.forget()
            raise OperationError(
                f"a latched message of {self.topic.name} was sent but not kept: those of one client"
                f" may have {self._latches.limit} bytes together (--max-latched-bytes)"
            )
