"""Last wills: messages that the hub publishes for a client that has gone, such as a robot's stop.

The idea is MQTT's (version 5, section 3.1.2.5), with two differences. A will is published however
its client leaves, because a closed tab ends its connection in good order as well; whoever does not
want that clears it first. And a will may have a timeout: then it is also published when the client
is still connected but has published nothing on the topic for so long, which is what stops a robot
while a network or a page hangs.
"""

from __future__ import annotations

import logging
from dataclasses import dataclass
from typing import Any

from fibws.errors import FibwsError, LimitReached
from fibws.hub.delivery.clock import Clock, Timer
from fibws.hub.graph.topic import LatchQuota, Source
from fibws.protocol.operations import json_of

logger = logging.getLogger("fibws.hub")

MOST_WILLS = 100
"""Wills of one client; each may have a timer."""
CHECKS = 4
"""How often within its timeout a will looks for new messages: it is late by a quarter at most."""


@dataclass(slots=True, eq=False)
class Will:
    """A message for the time after the client's last one on a topic.

    Attributes:
        size: bytes of its JSON.
        timeout: seconds without a message after which it is published; None for when the client
            leaves.
        seen: the client's messages on the topic, as of the last check.
        checks: those that have found no new message; the topic is silent from `CHECKS` on.
        is_waiting: whether the client must publish before the timeout begins.
    """

    source: Source
    msg: Any
    size: int
    timeout: float | None
    seen: int
    checks: int = 0
    is_waiting: bool = True
    timer: Timer | None = None


class Wills:
    """The wills of one client, at most one for each topic.

    Args:
        quota: bounds their bytes, together with those of the client's latched messages.
    """

    __slots__ = ("_clock", "_node", "_quota", "_wills")

    def __init__(self, node: str, quota: LatchQuota, clock: Clock) -> None:
        self._node = node
        self._quota = quota
        self._clock = clock
        self._wills: dict[Source, Will] = {}

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
        will = self._wills[source] = Will(source, msg, size, timeout, source.messages)
        self._quota.used += size
        self._watch(will)

    def clear(self, source: Source) -> None:
        """Forget the will of a topic, if there is one."""
        will = self._wills.pop(source, None)
        if will is not None:
            self._quota.used -= will.size
            if will.timer is not None:
                will.timer.cancel()

    def publish(self) -> None:
        """Publish all wills, as the client has left, and forget them."""
        for source, will in list(self._wills.items()):
            self.clear(source)
            if will.checks < CHECKS or source.messages != will.seen:  # It is not published yet.
                self._publish(will, "it has left")

    def _watch(self, will: Will) -> None:
        if will.timeout is not None:
            will.timer = self._clock.call_later(will.timeout / CHECKS, lambda: self._check(will))

    def _check(self, will: Will) -> None:
        """Publish a will if its topic has been silent for so long."""
        messages = will.source.messages
        if messages != will.seen:
            will.seen = messages
            will.checks = 0
            will.is_waiting = False
        elif not will.is_waiting and will.checks < CHECKS:
            will.checks += 1
            if will.checks == CHECKS:
                self._publish(will, f"nothing was published for {will.timeout:g} s")
                will.seen = will.source.messages
        self._watch(will)

    def _publish(self, will: Will, why: str) -> None:
        logger.warning(
            "%s: the will for %s is published: %s.", self._node, will.source.topic.name, why
        )
        try:
            will.source.publish(will.msg)
        except FibwsError as error:
            # The topic's type may have become known meanwhile.
            logger.error("%s: the will cannot be published: %s.", self._node, error)
