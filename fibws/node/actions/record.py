"""One goal as its server keeps it, and all of those that it tells about over topics.

Source: actionlib's action_server.py and http://wiki.ros.org/actionlib/DetailedDescription.
"""

from __future__ import annotations

from dataclasses import dataclass

from fibws.node.actions.status import GoalStatus, Transition, following

KEPT = 5.0
"""Seconds that a goal is told about after its end (actionlib's status_list_timeout)."""

KEPT_COUNT = 100
"""How many such goals there are at most; they count in that nobody knows yet but to cancel them."""

OUTDATED = (
    "This goal handle was canceled by the action server because its timestamp is before the "
    "timestamp of the last cancel request"
)


@dataclass(slots=True, eq=False)
class Record:
    """What the graph may know of a goal; ``stamp`` is in nanoseconds since 1970."""

    id: str
    stamp: int = 0
    status: GoalStatus = GoalStatus.PENDING
    text: str = ""

    def go(self, transition: Transition, text: str = "") -> bool:
        """Go on to the status that follows; tell whether there is one."""
        status = following(self.status, transition)
        if status is None:
            return False
        self.status, self.text = status, text
        return True


class Records:
    """The goals of one server, by actionlib's rules of which are told about and which canceled.

    ``now`` is in seconds, of any clock that never goes back.

    Args:
        kept: the seconds that a goal is told about after its end.
    """

    def __init__(self, kept: float = KEPT) -> None:
        self.kept = kept
        self._records: dict[str, Record] = {}
        self._ended: dict[str, float] = {}
        self._last_cancel = 0

    def listed(self, now: float) -> list[Record]:
        """The goals to tell about; those that ended too long ago are forgotten."""
        while self._ended and next(iter(self._ended.values())) + self.kept < now:
            self._forget_oldest()
        return list(self._records.values())

    def add(self, id_: str, stamp: int, now: float) -> Record | None:
        """The record of a goal that came, or None if it had come before.

        It may have ended already, RECALLED by a cancel that came first.
        """
        record = self._records.get(id_)
        if record is None:
            record = self._records[id_] = Record(id_, stamp)
            if stamp > self._last_cancel:
                return record
            record.go(Transition.CANCEL, OUTDATED)
        elif record.status is GoalStatus.RECALLING:
            record.go(Transition.CANCEL)
        else:
            return None
        self.ended(record, now)
        return record

    def cancel(self, id_: str, stamp: int, now: float) -> list[Record]:
        """The goals that a cancel message means: this one, and all up to ``stamp`` unless it is 0.

        Without either it means all of them. A goal that is not there yet is canceled when it comes.
        """
        everything = not id_ and not stamp
        meant = [
            record
            for record in self._records.values()
            if everything or record.id == id_ or 0 < record.stamp <= stamp
        ]
        if id_ and id_ not in self._records:
            record = self._records[id_] = Record(id_, status=GoalStatus.RECALLING)
            self.ended(record, now)
        self._last_cancel = max(self._last_cancel, stamp)
        return meant

    def ended(self, record: Record, now: float) -> None:
        """Begin to count the seconds that ``record`` is still told about."""
        self._ended.pop(record.id, None)
        self._ended[record.id] = now
        if len(self._ended) > KEPT_COUNT:
            self._forget_oldest()

    def _forget_oldest(self) -> None:
        id_ = next(iter(self._ended))
        del self._ended[id_], self._records[id_]
