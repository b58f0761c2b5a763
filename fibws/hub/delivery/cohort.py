"""Cohorts: subscriptions of one topic that are sent each frame at the same moment."""

from __future__ import annotations

from collections.abc import Collection
from typing import Any, Generic, NamedTuple, Protocol, TypeVar

from fibws.hub.delivery.send_queue import SendQueue
from fibws.protocol.frame_queue import Lane

M = TypeVar("M", bound="Member")
"""The kind of subscriptions."""


class Throttling(NamedTuple):
    """At most one message in a period: rosbridge's throttle_rate and queue_length.

    ``period`` is in seconds. ``queue_length`` frames wait for their turn; 0 drops all that come too
    early. With a ``credit``, at most so many messages are unacknowledged, and the newest frames
    wait for their turn: one, or ``queue_length``.
    """

    period: float
    queue_length: int
    credit: int = 0


class Member(Protocol):
    """A subscription in a group; all but the first three are for the group to set."""

    queue: SendQueue
    """Its client's."""
    lane: Lane
    throttling: Throttling | None
    """None while every message is sent at once; it must not change while in a group."""
    cohort: Cohort[Any] | None
    sent: int
    """Messages that it was sent, except those that its cohort counts."""
    throttled: int
    """Messages that its throttle left out, once it has none any more."""
    unacknowledged: int
    """Messages sent on credit that its client has not acknowledged."""


class Cohort(Generic[M]):
    """Members that are sent each frame at the same moment."""

    __slots__ = ("_sharing", "_since", "due", "next", "sent", "targets")

    def __init__(self) -> None:
        self.targets: dict[SendQueue, Lane] = {}
        """Where its frames go: each client gets a frame once, however many members it has."""
        self.sent = 0
        """Frames sent since the cohort exists."""
        self.due = 0.0
        """When a throttle may send it the next frame."""
        self.next = 0
        """The number of that frame, unless it was dropped."""
        self._since: dict[M, int] = {}
        """The value of `sent` when each member came."""
        self._sharing: dict[SendQueue, list[M]] = {}
        """Further members of the same clients."""

    def __len__(self) -> int:
        return len(self._since)

    def members(self) -> Collection[M]:
        """Return all members."""
        return self._since.keys()

    def sent_to(self, member: M) -> int:
        """Return how many messages one of its members was sent in all."""
        return member.sent + self.sent - self._since[member]

    def add(self, member: M) -> None:
        """Add a member that is in no cohort."""
        member.cohort = self
        self._since[member] = self.sent
        if member.queue in self.targets:
            self._sharing.setdefault(member.queue, []).append(member)
        else:
            self.targets[member.queue] = member.lane

    def remove(self, member: M) -> None:
        """Remove one of its members."""
        member.sent += self.sent - self._since.pop(member)
        member.cohort = None
        sharing = self._sharing.get(member.queue)
        if sharing is None:
            del self.targets[member.queue]
            return
        if member in sharing:
            sharing.remove(member)
        else:
            self.targets[member.queue] = sharing.pop(0).lane
        if not sharing:
            del self._sharing[member.queue]

    def joined(self, other: Cohort[M]) -> Cohort[M]:
        """Return the larger of two cohorts, with the members of both; the other one is empty."""
        large, small = (self, other) if len(self) >= len(other) else (other, self)
        for member in list(small.members()):
            small.remove(member)
            large.add(member)
        return large
