"""Answers are made once for each state of the graph."""

from __future__ import annotations

from fibws.hub.rosapi.kept import KeptAnswers

from ..fakes import INT32, FakeHub


def test_an_answer_is_made_once_until_the_graph_changes() -> None:
    hub = FakeHub()
    made: list[int] = []

    def make() -> bytes:
        made.append(hub.graph.revision)
        return b"%d" % len(made)

    kept = KeptAnswers(hub.graph)
    assert [kept.of(make), kept.of(make)] == [b"1", b"1"]
    client = hub.client()
    assert [kept.of(make), kept.of(make)] == [b"2", b"2"]
    client.says("advertise", "/fib", type=INT32)
    assert kept.of(make) == b"3"


def test_answers_to_different_questions_are_kept_apart() -> None:
    kept = KeptAnswers(FakeHub().graph)
    assert [kept.of(make) for make in (_one, _two, _one)] == [b"1", b"2", b"1"]


def _one() -> bytes:
    return b"1"


def _two() -> bytes:
    return b"2"
