"""No operation takes longer the more there is: steps of the interpreter are counted, not time."""

from __future__ import annotations

import sys
from collections.abc import Callable
from types import FrameType
from typing import Any

from .fakes import INT32, FakeHub

FEW, MANY = 25, 200
LIMIT = 1.2
"""How many times as many steps an operation may take when there is eight times as much."""


def steps(function: Callable[[], object]) -> int:
    """Return how many instructions Python executes in a function and those that it calls.

    Loops in C, such as ``list.remove``, count as one.
    """
    count = 0

    def trace(frame: FrameType, event: str, arg: Any) -> Any:
        nonlocal count
        if event == "call":
            frame.f_trace_opcodes = True
            frame.f_trace_lines = False
        else:
            count += event == "opcode"
        return trace

    before = sys.gettrace()
    sys.settrace(trace)
    try:
        function()
    finally:
        sys.settrace(before)
    return count


def growth(prepare: Callable[[int], Callable[[], object]]) -> float:
    """Return how many times as many steps an operation takes on average when there is more.

    Args:
        prepare: given how much there is to be, makes it; returns a function that performs the
            operation so many times, and can be called again.
    """
    few, many = (_steps_each(prepare(count), count) for count in (FEW, MANY))
    return many / few


def _steps_each(perform: Callable[[], object], count: int) -> float:
    perform()  # What is compiled and cached at the first time does not count.
    return steps(perform) / count


def names(count: int, of: str = "/name") -> list[str]:
    return [f"{of}_{each}" for each in range(count)]


def test_steps_are_counted_in_calls_and_loops() -> None:
    assert steps(lambda: [each for each in range(1000)]) > 1000
    assert growth(lambda count: lambda: [each in names(count) for each in names(count)]) > 2


def test_advertising_and_unadvertising_take_the_same_however_many_topics() -> None:
    def prepare(count: int) -> Callable[[], object]:
        client = FakeHub().client()

        def perform() -> None:
            for name in names(count):
                client.send("advertise", name, type=INT32)
            for name in reversed(names(count)):
                client.send("unadvertise", name)
            assert client.forgotten

        return perform

    assert growth(prepare) < LIMIT
