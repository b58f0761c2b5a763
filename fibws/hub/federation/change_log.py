"""All that a hub has announced, in the order of the last changes.

A hub that has missed some changes asks for those after the last one that it knows, and a hub that
joins for those after 0: both read the log in pieces, while it grows.
"""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Iterator
from itertools import islice
from typing import Any, NamedTuple

from fibws.hub.federation.records import KINDS, Announcement, Kind, Record

MOST_REMOVED = 10_000
"""Names of removed records that are kept when the log is tidied up."""
SLACK = 1000
"""Entries beyond twice as many as stay, from which on the log is tidied up."""
PIECE = 500
"""Records, users of topics, and hundreds of characters of parameters in a piece of the log."""


class Piece(NamedTuple):
    """Changes that follow one another.

    Attributes:
        counter: of the last one.
        is_last: whether no more follow at present.
    """

    announcement: Announcement
    counter: int
    is_last: bool


class _Entry(NamedTuple):
    counter: int
    kind: Kind
    name: str


class ChangeLog:
    """The records of a hub, each with the number of the announcement that has changed it last.

    Args:
        counter: the number of the last announcement of an earlier log, of which nothing is left.
    """

    def __init__(self, counter: int = 0) -> None:
        self.counter = counter
        """The number of the last announcement."""
        self._records: dict[tuple[Kind, str], Record | None] = {}
        """The newest records; None for removed ones."""
        self._counters: dict[tuple[Kind, str], int] = {}
        self._entries: list[_Entry] = []
        self._present = 0
        """Records that were not removed."""
        self._forgotten = counter
        """The number of the last announcement whose removals may be forgotten."""

    def find(self, kind: Kind, name: str) -> Record | None:
        """Return a record, unless it was removed."""
        return self._records.get((kind, name))

    def add(self, announcement: Announcement) -> int:
        """Add changes, and return their number."""
        self.counter += 1
        for kind in KINDS:
            for name, record in announcement.of(kind).items():
                self._present += (record is not None) - (self.find(kind, name) is not None)
                self._records[kind, name] = record
                self._counters[kind, name] = self.counter
                self._entries.append(_Entry(self.counter, kind, name))
        if len(self._entries) > 2 * (self._present + MOST_REMOVED) + SLACK:
            self._tidy_up()
        return self.counter

    def covers(self, counter: int) -> bool:
        """Return whether all that was removed after an announcement is known."""
        return counter == 0 or self._forgotten <= counter <= self.counter

    def piece(self, after: int, most: int = PIECE) -> Piece:
        """Return what has changed after an announcement: whole announcements, one at least."""
        changes: dict[str, dict[str, Any]] = {kind: {} for kind in KINDS}
        begin = bisect_right(self._entries, after, key=_counter_of)
        weight, reached = 0, after
        for entry in islice(self._entries, begin, None):
            if weight >= most and entry.counter > reached:
                return Piece(Announcement.model_construct(None, **changes), reached, False)
            reached = entry.counter
            if self._counters.get((entry.kind, entry.name)) == entry.counter:
                record = self._records[entry.kind, entry.name]
                if record is not None or after:
                    changes[entry.kind][entry.name] = record
                    weight += _weight(record)
        return Piece(Announcement.model_construct(None, **changes), self.counter, True)

    def _tidy_up(self) -> None:
        """Forget entries that are no longer valid, and the oldest removed names."""
        valid = list(self._valid())
        removed = [each for each in valid if self._records[each.kind, each.name] is None]
        old = set(removed[:-MOST_REMOVED])
        for entry in old:
            del self._records[entry.kind, entry.name], self._counters[entry.kind, entry.name]
            self._forgotten = max(self._forgotten, entry.counter)
        self._entries = [each for each in valid if each not in old]

    def _valid(self) -> Iterator[_Entry]:
        for entry in self._entries:
            if self._counters[entry.kind, entry.name] == entry.counter:
                yield entry


def _counter_of(entry: _Entry) -> int:
    return entry.counter


def _weight(record: Any) -> int:
    users = len(getattr(record, "publishers", ())) + len(getattr(record, "subscribers", ()))
    return 1 + users + len(getattr(record, "value", None) or "") // 100
