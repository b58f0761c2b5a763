"""Answers are made once for each state of the graph."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from fibws.hub.graph.graph import Graph
from fibws.hub.rosapi.kept import GOOD_FOR, LARGE, KeptAnswers
from fibws.interfaces import Interfaces

from ..fakes import INT32, FakeHub


@pytest.mark.parametrize("way", [KeptAnswers.of, KeptAnswers.lately])
def test_an_answer_is_made_once_until_the_graph_changes(
    way: Callable[[KeptAnswers, Callable[[], bytes]], bytes],
) -> None:
    hub = FakeHub()
    made: list[int] = []

    def make() -> bytes:
        made.append(hub.graph.revision)
        return b"%d" % len(made)

    kept = KeptAnswers(hub.graph)
    assert [way(kept, make), way(kept, make)] == [b"1", b"1"]
    client = hub.client()
    assert [way(kept, make), way(kept, make)] == [b"2", b"2"]
    client.says("advertise", "/fib", type=INT32)
    assert way(kept, make) == b"3"


def test_answers_to_different_questions_are_kept_apart() -> None:
    kept = KeptAnswers(FakeHub().graph)
    assert [kept.of(make) for make in (_one, _two, _one)] == [b"1", b"2", b"1"]


class Making:
    """Answers of one size, about a graph whose clock the test sets."""

    def __init__(self, size: int) -> None:
        self.now = 0
        self.made = 0
        self.size = size
        self.graph = Graph(Interfaces(), lambda: self.now)
        self.kept = KeptAnswers(self.graph)

    def make(self) -> bytes:
        self.made += 1
        return b" " * self.size


def test_a_large_answer_is_good_for_a_while_though_the_graph_changes() -> None:
    making = Making(LARGE)
    for now, made in ((0, 1), (LARGE * GOOD_FOR - 1, 1), (LARGE * GOOD_FOR, 2)):
        making.now = now
        making.graph.revision += 1
        making.kept.lately(making.make)
        assert making.made == made


def test_what_does_not_say_its_revision_is_of_the_newest() -> None:
    making = Making(LARGE)
    for made in (1, 2, 3):
        making.graph.revision += 1
        making.kept.of(making.make)
        assert making.made == made


def test_what_changes_though_the_graph_does_not_is_made_again() -> None:
    for size, made in ((LARGE - 1, [1, 2, 3]), (LARGE, [1, 1, 2])):
        making = Making(size)
        for now, times in zip((0, 1, LARGE * GOOD_FOR), made, strict=True):
            making.now = now
            making.kept.just_now(making.make)
            assert making.made == times


def test_a_clock_that_is_set_back_keeps_no_answer_for_long() -> None:
    making = Making(LARGE)
    for now in (10**18, 0):
        making.now = now
        making.kept.just_now(making.make)
    assert making.made == 2


def _one() -> bytes:
    return b"1"


def _two() -> bytes:
    return b"2"
