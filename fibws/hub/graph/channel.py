"""A channel: the subscriptions of one topic that hear the same frames."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import chain

from fibws.hub.graph.encoding import Encoding, Publication
from fibws.hub.graph.subscription import Subscription
from fibws.hub.outbox import Outbox


class Channel:
    """The subscriptions that spelled the topic's name alike and want the same encoding."""

    def __init__(self, spelling: str, encoding: Encoding) -> None:
        self.key = (spelling, encoding)
        self.frame = encoding.framer(spelling)
        """Makes the frame of a publication; raises `OperationError` if it cannot be encoded so."""
        self.sent = 0
        """Messages that its direct subscriptions were sent since it is there."""
        self._replayed: tuple[Publication, bytes] | None = None
        self._direct: dict[Outbox, Subscription] = {}
        self._throttled: dict[Outbox, Subscription] = {}

    def __bool__(self) -> bool:
        return bool(self._direct or self._throttled)

    def subscriptions(self) -> Iterator[Subscription]:
        """All of them."""
        return chain(self._direct.values(), self._throttled.values())

    def add(self, subscription: Subscription) -> None:
        """Add a subscription, or take note that it changed."""
        self.remove(subscription)
        if subscription.direct:
            self._direct[subscription.outbox] = subscription
            subscription.sent -= self.sent  # Those before are not its own.
        else:
            self._throttled[subscription.outbox] = subscription

    def remove(self, subscription: Subscription) -> None:
        """Take a subscription out."""
        if self._direct.pop(subscription.outbox, None) is not None:
            subscription.sent += self.sent
        self._throttled.pop(subscription.outbox, None)

    def replay(self, publication: Publication) -> bytes:
        """The frame of a latched message, made once however many come late."""
        if self._replayed is None or self._replayed[0] is not publication:
            self._replayed = (publication, self.frame(publication))
        return self._replayed[1]

    def forget(self, publication: Publication) -> None:
        """A message is latched no more."""
        if self._replayed is not None and self._replayed[0] is publication:
            self._replayed = None

    def send(self, publication: Publication) -> None:
        """Send a message to every subscription; they share the bytes of its frame."""
        frame: bytes | None = None
        if self._direct:
            frame = self.frame(publication)
            self.sent += 1  # For all of them: `Subscription.messages`.
            # The hub's innermost loop: `Outbox.put`, written out.
            for outbox, subscription in self._direct.items():
                if outbox.paused:
                    outbox.keep(frame, subscription.queue)
                    continue
                if not outbox.frames:
                    outbox.flusher.add(outbox)
                outbox.frames.append(frame)
            outbox.flusher.count(len(frame) * len(self._direct))  # All have the same flusher.
        if self._throttled:
            wanting = [each for each in self._throttled.values() if each.wants_more]
            if wanting:
                frame = self.frame(publication) if frame is None else frame
                for subscription in wanting:
                    subscription.offer(frame)
