"""A subscription: what one client wants of one topic, under the spelling it used."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

from fibws.errors import OperationError
from fibws.hub.clock import Clock
from fibws.hub.graph.encoding import PLAIN, Encoding
from fibws.hub.graph.throttle import Throttle
from fibws.hub.outbox import Outbox, Queue
from fibws.protocol.operations import Id, Subscribe

if TYPE_CHECKING:
    from fibws.hub.graph.channel import Channel
    from fibws.hub.graph.topic import Topic

MAX_REGISTRATIONS = 100
"""Ids under which one client may subscribe to one topic, or advertise it."""


class Subscription:
    """The requests of one client for one topic, merged as rosbridge's subscribe.py merges them.

    Args:
        node: the client's name.
        spelling: the topic's name as the client wrote it, and will read it.
        outbox: where the client's frames go.
        complain: tells the client what is wrong with a request.
        queue_length: messages kept for a client that falls behind and named no queue_length.
    """

    __slots__ = (
        "_clock",
        "_complain",
        "_complained",
        "_default",
        "_throttle",
        "_throttled_by",
        "channel",
        "encoding",
        "node",
        "outbox",
        "queue",
        "requests",
        "sent",
        "spelling",
        "topic",
        "typed",
    )

    def __init__(
        self,
        node: str,
        topic: Topic,
        spelling: str,
        outbox: Outbox,
        clock: Clock,
        complain: Callable[[Id, str], None],
        *,
        queue_length: int,
    ) -> None:
        self._complain = complain
        self._complained = False
        self.node = node
        self.topic = topic
        self.spelling = spelling
        self.outbox = outbox
        self.queue = Queue(queue_length)
        self.requests: dict[Id, Subscribe] = {}
        self.typed = False
        """Whether a request named the type, and so holds the topic to it."""
        self.encoding = PLAIN
        self.channel: Channel | None = None
        """Which of the topic's channels it is in."""
        self.sent = 0
        """Messages that it was sent, but for those that its channel counts while it is direct."""
        self._clock = clock
        self._default = queue_length
        self._throttle: Throttle | None = None
        self._throttled_by = (0.0, 0)

    @property
    def direct(self) -> bool:
        """Whether each message goes straight to the outbox."""
        return self._throttle is None

    @property
    def messages(self) -> int:
        """How many messages its outbox was given, whatever became of them there."""
        if self.channel is not None and self.direct:
            return self.sent + self.channel.sent
        return self.sent

    @property
    def throttle_rate(self) -> float:
        """Milliseconds between two messages at least; 0 if all go straight out."""
        return self._throttled_by[0] * 1000

    @property
    def wants_more(self) -> bool:
        """Whether a message that came now would not be passed over by the throttle."""
        return self._throttle is None or self._throttle.wants_more

    def request(self, request: Subscribe) -> None:
        """Add a request; one of the same id replaces the older.

        Raises:
            OperationError: there are too many.
        """
        if len(self.requests) >= MAX_REGISTRATIONS and request.id not in self.requests:
            raise OperationError(f"{MAX_REGISTRATIONS} subscriptions to one topic are enough")
        self.requests[request.id] = request
        self._merge()

    def cancel(self, id_: Id) -> None:
        """Take back the request of this id, or all if it is None; an unknown id changes nothing."""
        if id_ is None:
            self.requests.clear()
        elif self.requests.pop(id_, None) is None:
            return
        self._merge()

    def refuse(self, fault: OperationError) -> None:
        """Say, once, that messages cannot be had in the encoding that was asked for."""
        if not self._complained:
            self._complained = True
            id_ = next(each.id for each in self.requests.values() if each.compression == "cbor-raw")
            self._complain(id_, f"subscribe: {fault}")

    def send(self, frame: bytes) -> None:
        """Send a frame at once, whatever the throttle."""
        self.sent += 1
        self.outbox.put(frame, self.queue)

    def offer(self, frame: bytes) -> None:
        """Send a frame when the throttle lets it through."""
        if self._throttle is None:
            self.send(frame)
        else:
            self._throttle.offer(frame)

    def _merge(self) -> None:
        requests = self.requests.values()
        self.typed = any(request.type is not None for request in requests)
        if not requests:
            self.outbox.forget(self.queue)
            self._throttle_by(0, 0)
            return
        throttle_rate = min(max(0, request.throttle_rate) for request in requests)
        queue_length = min(max(0, request.queue_length) for request in requests)
        self.queue.limit = queue_length or self._default
        self._throttle_by(throttle_rate / 1000, queue_length)
        self.encoding = Encoding.merged(requests)

    def _throttle_by(self, period: float, queue_length: int) -> None:
        if (period, queue_length) == self._throttled_by:
            return
        self._throttled_by = period, queue_length
        if self._throttle is not None:
            self._throttle.cancel()
            self._throttle = None
        if period:
            self._throttle = Throttle(
                self.send,
                self._clock,
                period=period,
                queue_length=queue_length,
                budget=self.outbox.budget,
            )
