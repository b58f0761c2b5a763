"""The goals that a server keeps, and how their statuses change, by actionlib's rules.

Sources: http://wiki.ros.org/actionlib/DetailedDescription (the server's state machine) and
actionlib's action_server.py.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum, auto

from fibws.protocol.goals import GoalStatus

KEPT = 5.0
"""Seconds that an ended goal stays in the status list (actionlib's status_list_timeout)."""

KEPT_COUNT = 100
"""Most ended goals in the status list. Ids that were canceled before their goal came count, too."""

OUTDATED = (
    "This goal handle was canceled by the action server because its timestamp is before the "
    "timestamp of the last cancel request"
)


class Transition(Enum):
    """An event that changes a goal's status."""

    ACCEPT = auto()
    REJECT = auto()
    CANCEL_REQUEST = auto()
    CANCEL = auto()
    SUCCEED = auto()
    ABORT = auto()


_TRANSITIONS = {
    Transition.ACCEPT: {
        GoalStatus.PENDING: GoalStatus.ACTIVE,
        GoalStatus.RECALLING: GoalStatus.PREEMPTING,
    },
    Transition.REJECT: {
        GoalStatus.PENDING: GoalStatus.REJECTED,
        GoalStatus.RECALLING: GoalStatus.REJECTED,
    },
    Transition.CANCEL_REQUEST: {
        GoalStatus.PENDING: GoalStatus.RECALLING,
        GoalStatus.ACTIVE: GoalStatus.PREEMPTING,
    },
    Transition.CANCEL: {
        GoalStatus.PENDING: GoalStatus.RECALLED,
        GoalStatus.RECALLING: GoalStatus.RECALLED,
        GoalStatus.ACTIVE: GoalStatus.PREEMPTED,
        GoalStatus.PREEMPTING: GoalStatus.PREEMPTED,
    },
    Transition.SUCCEED: {
        GoalStatus.ACTIVE: GoalStatus.SUCCEEDED,
        GoalStatus.PREEMPTING: GoalStatus.SUCCEEDED,
    },
    Transition.ABORT: {
        GoalStatus.ACTIVE: GoalStatus.ABORTED,
        GoalStatus.PREEMPTING: GoalStatus.ABORTED,
    },
}


def next_status(status: GoalStatus, transition: Transition) -> GoalStatus | None:
    """Return the status after a transition; None if the transition is not allowed."""
    return _TRANSITIONS[transition].get(status)


@dataclass(slots=True, eq=False)
class GoalRecord:
    """A goal's public state on its server; ``stamp`` is in nanoseconds since 1970."""

    id: str
    stamp: int = 0
    status: GoalStatus = GoalStatus.PENDING
    text: str = ""

    def go(self, transition: Transition, text: str = "") -> bool:
        """Apply a transition and set the text; return False, without changes, if not allowed."""
        status = next_status(self.status, transition)
        if status is None:
            return False
        self.status, self.text = status, text
        return True


class Records:
    """The goals of one server: which ones its status list has, and which ones a cancel concerns.

    ``now`` is in seconds of any monotonic clock.

    Args:
        kept: the seconds that an ended goal stays in the status list.
    """

    def __init__(self, kept: float = KEPT) -> None:
        self.kept = kept
        self._records: dict[str, GoalRecord] = {}
        self._ended: dict[str, float] = {}
        """When each ended goal ended, by its id."""
        self._last_cancel = 0

    def listed(self, now: float) -> list[GoalRecord]:
        """Return the goals of the status list; forget those that ended too long ago."""
        while self._ended and next(iter(self._ended.values())) + self.kept < now:
            self._forget_oldest()
        return list(self._records.values())

    def add(self, id_: str, stamp: int, now: float) -> GoalRecord | None:
        """Return the record of a goal that has come, or None if it is a duplicate.

        The record is RECALLED already if the goal was canceled before it came.
        """
        record = self._records.get(id_)
        if record is None:
            record = self._records[id_] = GoalRecord(id_, stamp)
            if stamp > self._last_cancel:
                return record
            record.go(Transition.CANCEL, OUTDATED)
        elif record.status is GoalStatus.RECALLING:
            record.go(Transition.CANCEL)
        else:
            return None
        self.ended(record, now)
        return record

    def cancel(self, id_: str, stamp: int, now: float) -> list[GoalRecord]:
        """Return the goals that a cancel message concerns.

        These are the goal ``id_``, and all goals up to ``stamp`` unless that is 0; without either,
        all goals. If the goal ``id_`` has not come yet, it is canceled when it comes.
        """
        everything = not id_ and not stamp
        concerned = [
            record
            for record in self._records.values()
            if everything or record.id == id_ or 0 < record.stamp <= stamp
        ]
        if id_ and id_ not in self._records:
            record = self._records[id_] = GoalRecord(id_, status=GoalStatus.RECALLING)
            self.ended(record, now)
        self._last_cancel = max(self._last_cancel, stamp)
        return concerned

    def ended(self, record: GoalRecord, now: float) -> None:
        """Note that a goal has ended, so that it leaves the status list later."""
        self._ended.pop(record.id, None)
        self._ended[record.id] = now
        if len(self._ended) > KEPT_COUNT:
            self._forget_oldest()

    def _forget_oldest(self) -> None:
        id_ = next(iter(self._ended))
        del self._ended[id_], self._records[id_]
