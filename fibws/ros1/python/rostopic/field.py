"""A field of a message, by the way to it: ``/pose/position/x``, ``/points[0]/x``, ``/data[2:]``."""

from __future__ import annotations

import re
import sys
from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

_STEP = re.compile(r"(\w+)(?:\[(-?\d+|-?\d*:-?\d*(?::-?\d*)?)\])?")


class Step(NamedTuple):
    """One step of the way: a field, and what is chosen of an array in it."""

    name: str
    chosen: int | slice | None


def msgevalgen(pattern: str) -> Callable[[Any], Any] | None:
    """What takes a field out of a message; None for the whole message.

    What it gives is None, with a word on the standard error, if a message lacks the field.

    Args:
        pattern: the way to the field. One through several elements of an array gives a list.
    """
    steps: list[Step] = []
    for text in filter(None, pattern.split("/")):
        found = _STEP.fullmatch(text)
        if found is None:
            print(f"'{text}' is no field, as in position, points[0] or data[2:4]", file=sys.stderr)
            return None
        steps.append(Step(found[1], _chosen(found[2])))

    def evaluate(message: Any) -> Any:
        try:
            return _follow(message, steps)
        except AttributeError as error:
            print(f"no field named {error.name} in {pattern}", file=sys.stderr)
        except IndexError as error:
            print(f"{error}: {pattern}", file=sys.stderr)
        return None

    return evaluate if steps else None


def has_field(message: Any, pattern: str) -> bool:
    """Whether a message has the field, whatever is in the arrays on the way."""
    names = [text.partition("[")[0] for text in pattern.split("/") if text]
    for name in names:
        if not hasattr(message, name):
            return False
        message = getattr(message, name)
        if isinstance(message, Sequence):  # What is in it, an empty one cannot tell.
            return True
    return True


def _chosen(text: str | None) -> int | slice | None:
    if text is None:
        return None
    if ":" not in text:
        return int(text)
    return slice(*(int(part) if part else None for part in text.split(":")))


def _follow(message: Any, steps: list[Step]) -> Any:
    for number, (name, chosen) in enumerate(steps, 1):
        message = getattr(message, name)
        if chosen is not None:
            message = message[chosen]
            if isinstance(chosen, slice) and steps[number:]:
                return [_follow(each, steps[number:]) for each in message]
    return message
