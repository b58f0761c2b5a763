"""The account of all bytes that the hub holds: who loses when it is full."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from fibws.hub.memory.account import RESERVED, Account, AccountPart, Bound, Holding
from fibws.protocol.websocket import CloseReason

LIMIT = 16_000
FITS = LIMIT - LIMIT // 16


class Held:
    """Bytes of one kind: messages that may be dropped, and others that may not."""

    def __init__(
        self,
        owner: str,
        *messages: int,
        kept: int = 0,
        least: int = 1,
        is_stranger: bool = False,
    ) -> None:
        self.least = least
        """Messages that may not be dropped before others have lost some."""
        self.owner = owner
        self.messages = list(messages)
        self.kept = kept
        self.bounds: list[Bound] = []
        """The bounds because of which something was dropped or has ended."""
        self.has_ended = False
        self.holding = Holding(
            owner,
            lambda: sum(self.messages) + self.kept,
            shorten=self._shorten,
            end=self._end,
            is_stranger=is_stranger,
        )

    def _shorten(self, size: int, least: int, bound: Bound) -> None:
        self.bounds.append(bound)
        while len(self.messages) > min(least, self.least) and sum(self.messages) + self.kept > size:
            self.messages.pop(0)

    def _end(self, bound: Bound) -> None:
        self.bounds.append(bound)
        self.has_ended = True
        self.messages, self.kept = [], 0

    @property
    def size(self) -> int:
        return self.holding.measure()


class Hub:
    """An account with some parts, and the loop that checks it."""

    def __init__(self, **parts: list[Held]) -> None:
        self.checks: list[Callable[[], None]] = []
        self.account = Account(LIMIT, self.checks.append)
        for name, held in parts.items():
            self.account.add(name, part(held))

    def check(self) -> bool:
        due, self.checks[:] = self.checks[:], []
        for check in due:
            check()
        return bool(due)


def part(held: list[Held]) -> AccountPart:
    return AccountPart(lambda: [each.holding for each in held if each.size])


def test_nothing_goes_while_all_fits() -> None:
    robot = Held("robot", *[100] * (FITS // 100))
    hub = Hub(queues=[robot])
    hub.account.check()
    assert robot.bounds == []


def test_largest_owner_loses_its_oldest_messages_in_all_parts() -> None:
    robot = Held("robot", *[100] * 40)
    latched, queue = Held("pages", *[100] * 100), Held("pages", *[100] * 60)
    hub = Hub(latched=[latched], queues=[queue, robot])
    hub.account.check()
    assert robot.bounds == []
    assert hub.account.total() <= FITS
    assert (latched.size, queue.size) == (5000, 5000)
    assert [bound.setting for bound in (*latched.bounds, *queue.bounds)] == ["--max-memory"] * 2
    assert not latched.has_ended


def test_no_more_goes_than_must_if_messages_are_large() -> None:
    held = [Held(f"/{number}", 2000 + number, least=0) for number in range(8)]
    hub = Hub(latched=held)
    hub.account.check()
    assert [each.size > 0 for each in held] == [True] * 7 + [False]


def test_what_cannot_be_dropped_ends_with_the_largest_of_the_largest_owner() -> None:
    robot = Held("robot", kept=4000)
    pages = [Held("pages", kept=size) for size in (3000, 5000, 4000)]
    hub = Hub(incoming=[*pages, robot])
    hub.account.check()
    assert [each.has_ended for each in (robot, *pages)] == [False, False, True, False]
    assert "--max-memory" in pages[1].bounds[-1].reason.reason


def test_strangers_go_first() -> None:
    strangers = [Held("", kept=size, is_stranger=True) for size in (300, 800, 700)]
    robot = Held("robot", *[100] * (FITS // 100 - 10))
    hub = Hub(incoming=strangers, queues=[robot])
    hub.account.check()
    assert [each.has_ended for each in strangers] == [False, True, False]
    assert robot.bounds == []


def test_part_that_bounds_itself_loses_nothing_and_has_its_bytes_reserved() -> None:
    robot = Held("robot", *[100] * 150)
    hub = Hub(queues=[robot])
    hub.account.add_fixed("files", lambda: 3000, 4000)
    hub.account.check()
    assert robot.size <= FITS - 4000
    assert not robot.has_ended
    assert hub.account.held() == {"queues": robot.size, "files": 3000}
    assert hub.account.reserved == LIMIT // RESERVED


def test_bound_of_a_part_counts_for_that_part_alone() -> None:
    bound = Bound(1000, "--most", "bytes", CloseReason(1013, "too many"))
    queue, latched = Held("robot", *[100] * 20), Held("robot", *[100] * 20)
    hub = Hub(latched=[latched])
    hub.account.add("queues", AccountPart(lambda: [queue.holding], bound))
    hub.account.check()
    assert (queue.size, latched.size) == (900, 2000)
    assert queue.bounds == [bound]


def test_bytes_are_counted_once_so_many_have_come_that_they_may_be_too_many() -> None:
    robot = Held("robot", *[100] * 10)
    hub = Hub(latched=[robot])
    hub.account.check()
    hub.account.grow(FITS - 1000)
    assert not hub.check()
    hub.account.grow(1)
    assert hub.check()
    assert robot.bounds == []


def test_sum_never_exceeds_the_limit() -> None:
    clients = [Held(f"/{number}") for number in range(20)]
    hub = Hub(queues=clients[:10], latched=clients[10:])
    for number in range(5000):
        clients[number % 20].messages.append(number % 97)
        hub.account.grow(number % 97)
        hub.check()
        assert sum(each.size for each in clients) <= LIMIT
    assert min(each.size for each in clients) > 0
    assert not any(each.has_ended for each in clients)


def test_parts_that_are_not_metered_are_counted_each_second() -> None:
    quiet, other = Held("robot"), Held("robot", 100)
    hub = Hub(queues=[quiet])
    hub.account.add("latched", AccountPart(lambda: [other.holding], is_metered=True))
    hub.account.check()
    quiet.messages = [100] * 1000
    hub.account.sweep()
    assert hub.check()
    assert hub.account.total() <= FITS


def test_log_names_the_setting_once(caplog: pytest.LogCaptureFixture) -> None:
    hub = Hub(queues=[Held("robot", *[100] * 1000)])
    hub.account.check()
    hub.account.sweep()
    hub.account.sweep()
    [record] = caplog.records
    assert "16000" in record.message and "(--max-memory)" in record.message


def test_reason_fits_a_close_frame() -> None:
    assert len(Account(LIMIT).bound.reason.reason.encode()) <= 123
