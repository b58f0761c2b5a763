"""Which goals a server tells about, and which ones a cancel message means."""

from __future__ import annotations

from fibws.node.actions.record import KEPT, KEPT_COUNT, OUTDATED, Record, Records
from fibws.node.actions.status import GoalStatus, Transition


def added(records: Records, id_: str, stamp: int = 1) -> Record:
    record = records.add(id_, stamp, now=0)
    assert record is not None
    return record


def ids(records: list[Record]) -> list[str]:
    return [record.id for record in records]


def test_a_goal_is_pending_when_it_comes_and_counts_once() -> None:
    records = Records()
    record = added(records, "a", stamp=5)
    assert (record.id, record.stamp, record.status) == ("a", 5, GoalStatus.PENDING)
    assert records.add("a", 6, now=0) is None
    assert records.listed(now=0) == [record]


def test_a_transition_that_cannot_be_taken_leaves_text_and_status() -> None:
    record = Record("a")
    assert record.go(Transition.CANCEL, "why not")
    assert not record.go(Transition.SUCCEED, "too late")
    assert (record.status, record.text) == (GoalStatus.RECALLED, "why not")


def test_a_cancel_means_the_goal_that_it_names() -> None:
    records = Records()
    a = added(records, "a")
    added(records, "b")
    assert records.cancel("a", 0, now=0) == [a]


def test_a_cancel_without_name_and_time_means_all() -> None:
    records = Records()
    added(records, "a", stamp=1)
    added(records, "b", stamp=2)
    assert ids(records.cancel("", 0, now=0)) == ["a", "b"]


def test_a_cancel_with_a_time_means_all_up_to_that_and_the_one_it_names() -> None:
    records = Records()
    for id_, stamp in (("a", 1), ("b", 2), ("c", 3), ("d", 4)):
        added(records, id_, stamp)
    assert ids(records.cancel("", 2, now=0)) == ["a", "b"]
    assert ids(records.cancel("d", 2, now=0)) == ["a", "b", "d"]


def test_a_goal_from_before_the_last_cancel_is_recalled_when_it_comes() -> None:
    records = Records()
    records.cancel("", 10, now=0)
    records.cancel("", 5, now=0)
    late = added(records, "late", stamp=10)
    assert (late.status, late.text) == (GoalStatus.RECALLED, OUTDATED)
    assert added(records, "new", stamp=11).status is GoalStatus.PENDING


def test_a_goal_that_was_canceled_before_it_came_is_recalled_once() -> None:
    records = Records()
    assert records.cancel("a", 0, now=0) == []
    assert [record.status for record in records.listed(now=0)] == [GoalStatus.RECALLING]
    assert added(records, "a").status is GoalStatus.RECALLED
    assert records.add("a", 1, now=0) is None


def test_a_cancel_of_a_goal_that_never_comes_is_no_goal_to_a_cancel_by_time() -> None:
    records = Records()
    records.cancel("never", 0, now=0)
    assert records.cancel("", 99, now=0) == []


def test_a_goal_is_told_about_for_a_while_after_its_end() -> None:
    records = Records()
    a, b = added(records, "a"), added(records, "b")
    records.ended(a, now=10)
    assert records.listed(now=10 + KEPT) == [a, b]
    assert records.listed(now=10.1 + KEPT) == [b]
    assert added(records, "a") is not a


def test_how_long_that_is_may_be_said() -> None:
    records = Records(kept=1)
    records.ended(added(records, "a"), now=10)
    assert ids(records.listed(now=11)) == ["a"]
    records.kept = 0.5
    assert records.listed(now=11) == []


def test_goals_that_have_ended_do_not_fill_the_memory() -> None:
    records = Records()
    running = added(records, "running")
    for number in range(2 * KEPT_COUNT):
        records.ended(added(records, f"ended {number}"), now=0)
        records.cancel(f"never {number}", 0, now=0)
    listed = records.listed(now=0)
    assert len(listed) == 1 + KEPT_COUNT
    assert listed[0] is running
    assert listed[-1].id == f"never {2 * KEPT_COUNT - 1}"
