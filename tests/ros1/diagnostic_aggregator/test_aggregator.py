"""The tree of diagnostics; beside ROS's program it is tested in tests/programs."""

from __future__ import annotations

from typing import Any

import pytest
from diagnostic_aggregator.aggregator import AnalyzerGroup, GenericAnalyzer, InvalidAnalyzer, Item
from diagnostic_msgs.msg import DiagnosticStatus

OK, WARN, ERROR, STALE = range(4)


def analyzer(**parameters: Any) -> GenericAnalyzer:
    return GenericAnalyzer({"path": "Branch", **parameters})


def item(name: str, time: float, level: int = OK) -> Item:
    return Item(DiagnosticStatus(level=level, name=name, message="m"), time)


def rows(branch: GenericAnalyzer | AnalyzerGroup, now: float) -> list[tuple[int, str, str]]:
    return [(each.level, each.name, each.message) for each in branch.report("", now)[1]]


def test_items_that_are_not_repeated_are_stale() -> None:
    branch = analyzer(contains="a", timeout=2)
    branch.take(item("a", 10))
    branch.take(item("ab", 11, WARN))
    assert rows(branch, 11) == [
        (WARN, "/Branch", "Warning"),
        (OK, "/Branch/a", "m"),
        (WARN, "/Branch/ab", "m"),
    ]
    assert [level for level, *_ in rows(branch, 12.5)] == [ERROR, STALE, WARN]
    assert rows(branch, 14)[0] == (STALE, "/Branch", "Stale")


def test_stale_items_can_be_discarded() -> None:
    branch = analyzer(contains="a", timeout=2, discard_stale=True)
    assert rows(branch, 10) == [(STALE, "/Branch", "Stale")]
    assert rows(branch, 12.5) == []
    branch.take(item("a", 13))
    assert len(rows(branch, 14)) == 2
    assert rows(branch, 15.5) == []


def test_timeout_of_zero_is_none() -> None:
    branch = analyzer(name="a", timeout=0)
    branch.take(item("a", 0))
    assert rows(branch, 1e9)[0] == (OK, "/Branch", "OK")


@pytest.mark.parametrize(
    ("count", "found", "summary"),
    [
        (2, 2, (OK, "OK")),
        (2, 1, (ERROR, "Expected 2, found 1")),
        (2, 0, (STALE, "No items found, expected 2")),
        (0, 0, (OK, "OK")),
        (0, 1, (OK, "OK")),
    ],
)
def test_items_are_counted(count: int, found: int, summary: tuple[int, str]) -> None:
    branch = analyzer(startswith="a", num_items=count)
    for number in range(found):
        branch.take(item(f"a{number}", 0))
    level, _, message = rows(branch, 0)[0]
    assert (level, message) == summary


@pytest.mark.parametrize(
    ("parameters", "matching", "others"),
    [
        ({"name": ["a", "b"]}, ["a", "b"], ["ab", "c"]),
        ({"expected": "a"}, ["a"], ["ab"]),
        ({"startswith": "ab"}, ["ab", "abc"], ["a", "xab"]),
        ({"contains": ["b", "c"]}, ["abd", "c"], ["a"]),
        ({"regex": r"a\d+"}, ["a1", "a22"], ["xa1", "a1x", "a"]),
        ({"find_and_remove_prefix": "dev"}, ["dev: x"], ["x dev"]),
        ({"remove_prefix": "dev"}, [], ["dev: x"]),
    ],
)
def test_names_choose_the_items(
    parameters: dict[str, Any], matching: list[str], others: list[str]
) -> None:
    branch = analyzer(**parameters)
    assert all(branch.matches(name) for name in matching)
    assert not any(branch.matches(name) for name in others)


@pytest.mark.parametrize(
    ("parameters", "fact"),
    [({"path": ""}, "path"), ({"path": "/"}, "path"), ({"regex": "("}, "invalid regex")],
)
def test_invalid_parameters_are_errors(parameters: dict[str, Any], fact: str) -> None:
    with pytest.raises(InvalidAnalyzer, match=fact):
        analyzer(**parameters)
