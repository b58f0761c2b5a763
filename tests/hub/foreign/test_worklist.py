"""Names that have changed, each handled once."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterator

import pytest

from fibws.hub.foreign import worklist
from fibws.hub.foreign.worklist import Worklist


class Handled:
    """A worklist of two kinds, and what was handled in each turn."""

    def __init__(self) -> None:
        self.due: deque[Callable[[], None]] = deque()
        self.turns: list[list[str]] = [[]]
        self.is_paused = False
        self.work = Worklist[str](
            self.due.append,
            {"nodes": self.handle, "topics": self.handle},
            turn_ended=lambda: self.turns.append([]),
            is_paused=lambda: self.is_paused,
        )

    def handle(self, name: str) -> None:
        self.turns[-1].append(name)
        if name == "/broken":
            raise ValueError(name)

    def run(self) -> list[str]:
        """Run what is due; return the names that were handled."""
        self.turns = [[]]
        while self.due:
            self.due.popleft()()
        return [name for turn in self.turns for name in turn]


def test_each_name_is_handled_once_and_nodes_come_first() -> None:
    handled = Handled()
    for kind, name in ("topics", "/t"), ("nodes", "/n"), ("topics", "/t"), ("topics", "/broken"):
        handled.work.add(kind, name)
    handled.work.add("topics", "/u")
    assert handled.run() == ["/n", "/t", "/broken", "/u"]
    assert handled.run() == []


def test_turn_ends_after_its_time(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(worklist, "TURN", -1.0)
    handled = Handled()
    for name in "/a", "/b":
        handled.work.add("topics", name)
    handled.run()
    assert [turn for turn in handled.turns if turn] == [["/a"], ["/b"]]


def test_steps_come_before_names_and_one_that_fails_ends_no_other() -> None:
    handled = Handled()

    def steps() -> Iterator[None]:
        handled.handle("/step")
        yield
        handled.handle("/broken")

    handled.work.add("topics", "/t")
    handled.work.add_steps(steps())
    handled.work.add_steps(map(handled.handle, ["/broken", "/last"]))
    assert handled.run() == ["/step", "/broken", "/broken", "/last", "/t"]


def test_steps_at_once_wait_for_work_that_is_due() -> None:
    handled = Handled()
    handled.work.add_steps(map(handled.handle, ["/a"]), at_once=True)
    assert handled.turns[0] == ["/a"]
    handled.work.add_steps(map(handled.handle, ["/b"]))
    handled.work.add_steps(map(handled.handle, ["/c"]), at_once=True)
    assert handled.turns[1] == []
    assert handled.run() == ["/b", "/c"]


def test_paused_work_waits_for_resume() -> None:
    handled = Handled()
    handled.is_paused = True
    handled.work.add("topics", "/t")
    assert handled.run() == []
    handled.is_paused = False
    handled.work.resume()
    assert handled.run() == ["/t"]


def test_closed_worklist_handles_no_names() -> None:
    handled = Handled()
    handled.work.add("topics", "/t")
    handled.work.close()
    handled.work.add("topics", "/u")
    assert handled.run() == []
