"""Work that code does, counted instead of timed: no machine is too slow or too busy for it."""

from __future__ import annotations

import sys
from collections.abc import Callable
from types import FrameType
from typing import Any


def executed_lines(function: Callable[[], object]) -> int:
    """Call a function; return how many lines of Python that executed, loops included."""
    return _traced(function, "line")


def executed_instructions(function: Callable[[], object]) -> int:
    """Call a function; return how many instructions of Python that executed.

    Loops in C, such as ``list.remove``, count as one.
    """
    return _traced(function, "opcode")


def _traced(function: Callable[[], object], counted: str) -> int:
    count = 0

    def trace(frame: FrameType, event: str, argument: Any) -> Any:
        nonlocal count
        if event == "call":
            frame.f_trace_lines = counted == "line"
            frame.f_trace_opcodes = counted == "opcode"
        count += event == counted
        return trace

    before = sys.gettrace()
    sys.settrace(trace)
    try:
        function()
    finally:
        sys.settrace(before)
    return count
