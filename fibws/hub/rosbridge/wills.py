"""Last wills: messages that the hub publishes for a client that has gone, such as a robot's stop.

The idea is MQTT's (version 5, section 3.1.2.5), with two differences. A will is published however
its client leaves, because a closed tab ends its connection in good order as well; whoever does not
want that clears it first. And a will may have a timeout: then it is also published when the client
is still connected but has published nothing on the topic for so long, which is what stops a robot
while a network or a page hangs.

A will is published only if the client may still publish on its topic: the will of a token that was
revoked or has expired is dropped, and so is one whose right was withdrawn. Of a node that is killed
or replaced it is published: its rights are the same as before, and its robot has to stop.
"""

from __future__ import annotations

import logging
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Any

from fibws.errors import FibwsError
from fibws.hub.delivery.clock import Clock, Timer
from fibws.hub.errors import LimitReached
from fibws.hub.graph.latched import LatchQuota
from fibws.hub.graph.topic import Source
from fibws.protocol.operations import json_of

logger = logging.getLogger("fibws.hub")

MOST_WILLS = 100
"""Wills of one client: each check of their topics takes time."""
CHECKS = 4
"""How often within the shortest timeout the topics are checked for new messages: a will is late by
a quarter of its timeout at most."""
ROUNDING = 1e-6
"""Part of a timeout by which a clock's rounding may make it shorter."""


@dataclass(slots=True, eq=False)
class Will:
    """A message for the time after the client's last one on a topic.

    Attributes:
        size: bytes of its JSON.
        timeout: seconds without a message after which it is published; None for when the client
            leaves.
        seen: the client's messages on the topic, as of the last check.
        silent_since: when a check last found new ones.
        is_published: whether it was published since the client's last message.
    """

    source: Source
    msg: Any
    size: int
    timeout: float | None
    seen: int = 0
    silent_since: float = 0.0
    is_published: bool = False


class Wills:
    """The wills of one client, at most one for each topic.

    Timeouts begin with the next message on the topic, and one timer serves all that have begun.

    Args:
        quota: bounds their bytes, together with those of the client's latched messages.
        is_allowed: returns whether the client may still publish.
    """

    __slots__ = ("_begun", "_clock", "_due", "_is_allowed", "_node", "_quota", "_timer", "_wills")

    def __init__(
        self,
        node: str,
        quota: LatchQuota,
        clock: Clock,
        is_allowed: Callable[[Source], bool] = lambda source: True,
    ) -> None:
        self._node = node
        self._quota = quota
        self._clock = clock
        self._is_allowed = is_allowed
        self._wills: dict[Source, Will] = {}
        self._begun: dict[Will, float] = {}
        """The timeouts that have begun."""
        self._timer: Timer | None = None
        self._due = 0.0

    def __len__(self) -> int:
        return len(self._wills)

    def set(self, source: Source, msg: object, timeout: float | None) -> None:
        """Set the will of a topic, or replace it.

        Args:
            source: the client's, on the topic.

        Raises:
            InvalidMessage: the message does not fit the topic's type.
            LimitReached: there is no room for it.
        """
        values = source.type.validate({} if msg is None else msg)
        size = len(json_of(values))
        older = self._wills.get(source)
        if self._quota.limit is not None:
            used = self._quota.used + size - (older.size if older is not None else 0)
            if used > self._quota.limit:
                raise LimitReached(
                    f"no room for a will: the wills and latched messages of one client may take "
                    f"{self._quota.limit} bytes (--max-latched-bytes)"
                )
        if older is None and len(self._wills) >= MOST_WILLS:
            raise LimitReached(f"too many wills of one client (limit {MOST_WILLS})")
        self.clear(source)
        will = self._wills[source] = Will(source, msg, size, timeout)
        self._quota.add(size)
        if timeout is not None:
            source.on_next = partial(self._begin, will, timeout)

    def clear(self, source: Source) -> None:
        """Forget the will of a topic, if there is one."""
        will = self._wills.pop(source, None)
        if will is not None:
            self._quota.add(-will.size)
            source.on_next = None
            self._end(will)

    def publish(self) -> None:
        """Publish all wills, as the client has left, and forget them."""
        for source, will in list(self._wills.items()):
            self.clear(source)
            if not will.is_published:
                self._publish(will, "it has left")

    def _begin(self, will: Will, timeout: float) -> None:
        """Called when a client publishes on a topic that was silent before."""
        will.is_published = False
        will.seen = will.source.messages
        will.silent_since = self._clock.time()
        self._begun[will] = timeout
        self._watch()

    def _end(self, will: Will) -> None:
        if self._begun.pop(will, None) is not None and not self._begun:
            self._stop()

    def _watch(self) -> None:
        """Make sure that the timer is due when the next check is."""
        due = self._clock.time() + min(self._begun.values()) / CHECKS
        if self._timer is None or due < self._due:
            self._stop()
            self._due = due
            self._timer = self._clock.call_later(due - self._clock.time(), self._check)

    def _stop(self) -> None:
        if self._timer is not None:
            self._timer.cancel()
            self._timer = None

    def _check(self) -> None:
        """Publish the wills whose topics have been silent for too long."""
        self._timer = None
        now = max(self._due, self._clock.time())  # The timer may be a little early.
        for will, timeout in list(self._begun.items()):
            messages = will.source.messages
            if will not in self._begun:
                continue  # A message of another will has made the client leave.
            if messages != will.seen:
                will.seen, will.silent_since = messages, now
            elif now - will.silent_since >= timeout * (1 - ROUNDING):
                del self._begun[will]
                self._publish(will, f"nothing was published for {timeout:g} s")
                will.is_published = True
                if will.source in self._wills:
                    will.source.on_next = partial(self._begin, will, timeout)
        if self._begun:
            self._watch()

    def _publish(self, will: Will, why: str) -> None:
        topic = will.source.topic.name
        if not self._is_allowed(will.source):
            logger.warning(
                "%s: the will for %s is dropped: missing right publish.", self._node, topic
            )
            return
        logger.warning("%s: the will for %s is published: %s.", self._node, topic, why)
        try:
            will.source.publish(will.msg)
        except FibwsError as error:
            # The topic's type may have become known meanwhile.
            logger.error("%s: the will cannot be published: %s.", self._node, error)
