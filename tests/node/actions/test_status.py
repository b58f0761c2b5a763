"""The states of a goal, the status list of a server, and the goals that a cancel concerns."""

from __future__ import annotations

import pytest

from fibws.node.actions.status import (
    KEPT,
    KEPT_COUNT,
    OUTDATED,
    GoalRecord,
    Records,
    Transition,
    next_status,
)
from fibws.protocol.goals import GoalStatus

FINAL = {
    GoalStatus.PREEMPTED,
    GoalStatus.SUCCEEDED,
    GoalStatus.ABORTED,
    GoalStatus.REJECTED,
    GoalStatus.RECALLED,
    GoalStatus.LOST,
}


@pytest.mark.parametrize("status", GoalStatus)
def test_only_final_statuses_have_no_next_status(status: GoalStatus) -> None:
    has_next = any(next_status(status, transition) is not None for transition in Transition)
    assert status.is_final == (status in FINAL) == (not has_next)


@pytest.mark.parametrize(
    ("transitions", "end"),
    [
        ([Transition.ACCEPT, Transition.SUCCEED], GoalStatus.SUCCEEDED),
        ([Transition.ACCEPT, Transition.ABORT], GoalStatus.ABORTED),
        ([Transition.ACCEPT, Transition.CANCEL], GoalStatus.PREEMPTED),
        ([Transition.ACCEPT, Transition.CANCEL_REQUEST], GoalStatus.PREEMPTING),
        ([Transition.ACCEPT, Transition.CANCEL_REQUEST, Transition.CANCEL], GoalStatus.PREEMPTED),
        ([Transition.ACCEPT, Transition.CANCEL_REQUEST, Transition.SUCCEED], GoalStatus.SUCCEEDED),
        ([Transition.ACCEPT, Transition.CANCEL_REQUEST, Transition.ABORT], GoalStatus.ABORTED),
        ([Transition.REJECT], GoalStatus.REJECTED),
        ([Transition.CANCEL], GoalStatus.RECALLED),
        ([Transition.CANCEL_REQUEST], GoalStatus.RECALLING),
        ([Transition.CANCEL_REQUEST, Transition.CANCEL], GoalStatus.RECALLED),
        ([Transition.CANCEL_REQUEST, Transition.REJECT], GoalStatus.REJECTED),
        ([Transition.CANCEL_REQUEST, Transition.ACCEPT], GoalStatus.PREEMPTING),
    ],
)
def test_transitions_lead_through_the_states_of_actionlib(
    transitions: list[Transition], end: GoalStatus
) -> None:
    status: GoalStatus | None = GoalStatus.PENDING
    for transition in transitions:
        assert status is not None
        status = next_status(status, transition)
    assert status is end


@pytest.mark.parametrize(
    ("status", "transition"),
    [
        (GoalStatus.PENDING, Transition.SUCCEED),
        (GoalStatus.PENDING, Transition.ABORT),
        (GoalStatus.ACTIVE, Transition.REJECT),
        (GoalStatus.ACTIVE, Transition.ACCEPT),
        (GoalStatus.PREEMPTING, Transition.CANCEL_REQUEST),
    ],
)
def test_forbidden_transition_has_no_next_status(
    status: GoalStatus, transition: Transition
) -> None:
    assert next_status(status, transition) is None


def test_forbidden_transition_leaves_status_and_text() -> None:
    record = GoalRecord("a")
    assert record.go(Transition.CANCEL, "why not")
    assert not record.go(Transition.SUCCEED, "too late")
    assert (record.status, record.text) == (GoalStatus.RECALLED, "why not")


# The status list


def added(records: Records, id_: str, stamp: int = 1) -> GoalRecord:
    record = records.add(id_, stamp, now=0)
    assert record is not None
    return record


def ids(records: list[GoalRecord]) -> list[str]:
    return [record.id for record in records]


def test_new_goal_is_pending_and_a_duplicate_is_ignored() -> None:
    records = Records()
    record = added(records, "a", stamp=5)
    assert (record.id, record.stamp, record.status) == ("a", 5, GoalStatus.PENDING)
    assert records.add("a", 6, now=0) is None
    assert records.listed(now=0) == [record]


def test_ended_goal_stays_listed_for_some_seconds() -> None:
    records = Records()
    a, b = added(records, "a"), added(records, "b")
    records.ended(a, now=10)
    assert records.listed(now=10 + KEPT) == [a, b]
    assert records.listed(now=10.1 + KEPT) == [b]
    assert added(records, "a") is not a


def test_time_that_ended_goals_stay_listed_is_configurable() -> None:
    records = Records(kept=1)
    records.ended(added(records, "a"), now=10)
    assert ids(records.listed(now=11)) == ["a"]
    records.kept = 0.5
    assert records.listed(now=11) == []


def test_number_of_ended_goals_is_limited() -> None:
    records = Records()
    running = added(records, "running")
    for number in range(2 * KEPT_COUNT):
        records.ended(added(records, f"ended {number}"), now=0)
        records.cancel(f"never {number}", 0, now=0)
    listed = records.listed(now=0)
    assert len(listed) == 1 + KEPT_COUNT
    assert listed[0] is running
    assert listed[-1].id == f"never {2 * KEPT_COUNT - 1}"


# Cancel messages


def test_cancel_with_an_id_concerns_that_goal() -> None:
    records = Records()
    a = added(records, "a")
    added(records, "b")
    assert records.cancel("a", 0, now=0) == [a]


def test_cancel_without_id_and_time_concerns_all_goals() -> None:
    records = Records()
    added(records, "a", stamp=1)
    added(records, "b", stamp=2)
    assert ids(records.cancel("", 0, now=0)) == ["a", "b"]


def test_cancel_with_a_time_concerns_older_goals_and_the_one_of_its_id() -> None:
    records = Records()
    for id_, stamp in (("a", 1), ("b", 2), ("c", 3), ("d", 4)):
        added(records, id_, stamp)
    assert ids(records.cancel("", 2, now=0)) == ["a", "b"]
    assert ids(records.cancel("d", 2, now=0)) == ["a", "b", "d"]


def test_goal_older_than_the_last_cancel_time_is_recalled_on_arrival() -> None:
    records = Records()
    records.cancel("", 10, now=0)
    records.cancel("", 5, now=0)
    late = added(records, "late", stamp=10)
    assert (late.status, late.text) == (GoalStatus.RECALLED, OUTDATED)
    assert added(records, "new", stamp=11).status is GoalStatus.PENDING


def test_goal_canceled_before_its_arrival_is_recalled_once() -> None:
    records = Records()
    assert records.cancel("a", 0, now=0) == []
    assert [record.status for record in records.listed(now=0)] == [GoalStatus.RECALLING]
    assert added(records, "a").status is GoalStatus.RECALLED
    assert records.add("a", 1, now=0) is None


def test_cancel_by_time_ignores_canceled_ids_without_a_goal() -> None:
    records = Records()
    records.cancel("never", 0, now=0)
    assert records.cancel("", 99, now=0) == []
