"""Finds what hubs and nodes still hold of a name that should be gone."""

from __future__ import annotations

import gc
from collections import deque
from collections.abc import Iterable
from pathlib import Path
from types import CoroutineType, FunctionType

import fibws
from fibws.hub.graph.totals import CallTotals, TopicTotals
from fibws.hub.log.text import LineLimit

LONGEST_CHAIN = 8
SOURCES = str(Path(fibws.__file__).parent)
LIBRARIES = {"builtins", "fibws", "asyncio", "_asyncio", "collections", "contextlib", "functools"}
"""The packages whose objects are looked into; others belong to the tests, or to the system."""
BOUNDED = (CallTotals, LineLimit, TopicTotals, memoryview)
"""What remembers some names of the past on purpose; memoryviews are the buffers of sockets."""


def leftovers(text: str, *roots: object) -> list[str]:
    """Return what still holds a text with this part, each as a chain of types towards the root.

    Objects are followed as the garbage collector follows them, also into tasks and timers.
    """
    data = text.encode()
    holders: dict[int, object | None] = {id(root): None for root in roots}
    waiting: deque[object] = deque(roots)
    alive: list[object] = []  # An id may be another object's once the object has gone.
    found: list[str] = []
    while waiting:
        holder = waiting.popleft()
        for each in _held_by(holder):
            if id(each) in holders:
                continue
            holders[id(each)] = holder
            alive.append(each)
            is_found = text in each if isinstance(each, str) else False
            is_found |= data in each if isinstance(each, bytes | bytearray) else False
            if is_found:
                found.append(_chain(each, holders))
            elif _is_followed(each):
                waiting.append(each)
    return sorted(found)


def _held_by(holder: object) -> Iterable[object]:
    if isinstance(holder, FunctionType):  # Not the names of its module.
        return holder.__closure__ or (), holder.__defaults__, holder.__kwdefaults__
    return gc.get_referents(holder)


def _is_followed(each: object) -> bool:
    if isinstance(each, (type, str, bytes, bytearray, *BOUNDED)):
        return False
    if isinstance(each, CoroutineType):
        return str(each.cr_code.co_filename).startswith(SOURCES)
    if isinstance(each, FunctionType):
        return (each.__module__ or "").startswith("fibws.")
    name = type(each).__name__
    is_system = name in ("module", "frame", "code", "_lru_cache_wrapper")
    return type(each).__module__.partition(".")[0] in LIBRARIES and not is_system


def _chain(text: object, holders: dict[int, object | None]) -> str:
    parts = [repr(text)[:60]]
    each = holders[id(text)]
    while each is not None and len(parts) < LONGEST_CHAIN:
        parts.append(type(each).__name__)
        each = holders[id(each)]
    return " in ".join(parts)
