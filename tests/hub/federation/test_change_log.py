"""The log of what a hub has announced: read from anywhere it leads to the same records."""

from __future__ import annotations

import random

import pytest

from fibws.hub.federation import change_log
from fibws.hub.federation.change_log import ChangeLog
from fibws.hub.federation.records import Announcement, ServiceRecord

SERVED = ServiceRecord(node="/node", type="std_srvs/Empty", since=0)


class Reader:
    """A hub that reads a log in pieces."""

    def __init__(self, log: ChangeLog) -> None:
        self.log = log
        self.counter = 0
        self.names: set[str] = set()

    def read(self, most: int = 5) -> bool:
        """Read a piece; return whether it was the last one."""
        piece = self.log.piece(self.counter, most)
        assert piece.counter > self.counter or piece.is_last
        self.counter = piece.counter
        for name, record in piece.announcement.services.items():
            (self.names.discard if record is None else self.names.add)(name)
        return piece.is_last

    def read_all(self) -> set[str]:
        while not self.read():
            pass
        return self.names


def announce(log: ChangeLog, *names: str, gone: tuple[str, ...] = ()) -> None:
    log.add(Announcement(services={**dict.fromkeys(names, SERVED), **dict.fromkeys(gone)}))


def test_readers_that_begin_and_stop_anywhere_have_the_same_records() -> None:
    dice = random.Random(1)
    log, present, readers = ChangeLog(), set[str](), list[Reader]()
    for _ in range(200):
        names = {f"/name_{dice.randrange(40)}" for _ in range(dice.randint(1, 8))}
        gone = tuple(name for name in names if dice.random() < 0.5)
        announce(log, *names.difference(gone), gone=gone)
        present = (present | names).difference(gone)
        readers.append(Reader(log))
        for reader in dice.sample(readers, min(3, len(readers))):
            reader.read()
    for reader in readers:
        assert reader.read_all() == present
        assert reader.counter == log.counter == 200


def test_a_piece_has_whole_announcements_alone() -> None:
    log = ChangeLog()
    announce(log, *(f"/{letter}" for letter in "abcdefgh"))
    announce(log, "/i")
    piece = log.piece(0, 5)
    assert (len(piece.announcement.services), piece.counter, piece.is_last) == (8, 1, False)


def test_the_log_of_names_that_come_and_go_does_not_grow(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(change_log, "SLACK", 10)
    monkeypatch.setattr(change_log, "MOST_REMOVED", 10)
    log = ChangeLog()
    announce(log, "/stays")
    early, late = Reader(log), Reader(log)
    early.read_all()
    for number in range(200):
        announce(log, f"/name_{number}")
        announce(log, gone=(f"/name_{number}",))
        late.read_all()
    assert len(log._entries) < 80 and len(log._records) < 80
    # Not all that was removed is known any longer.
    assert not log.covers(early.counter)
    assert log.covers(late.counter) and log.covers(0)
    assert Reader(log).read_all() == late.read_all() == {"/stays"}


def test_a_log_covers_no_announcement_that_was_not_made() -> None:
    log = ChangeLog()
    assert log.covers(0) and not log.covers(1)
