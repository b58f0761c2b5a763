"""What leads to a field of a topic's messages: ``/topic/field/sub[3]``."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from typing import Any, NamedTuple

from fibws.errors import InvalidValue, UnknownField
from fibws.values.printing import elements
from fibws.values.typedefs import TIMES, Field, Typedefs

_STEP = re.compile(r"(\w+)(?:\[([^\]]*)\])?")
_TIME = [Field("secs", "int32"), Field("nsecs", "int32")]


class Step(NamedTuple):
    """One part of a path: a field, and which of its elements."""

    name: str
    which: int | slice | None = None


class Path:
    """The way to a field: ``poses[0]/position/x``, or nothing for the whole message.

    Elements are counted as in Python: ``[-1]`` is the last, ``[2:4]`` are two of them.

    Raises:
        UsageError: it is not written so.
    """

    def __init__(self, text: str) -> None:
        self._parts = [part for part in text.split("/") if part]
        self.steps = [_step(part) for part in self._parts]

    def __bool__(self) -> bool:
        return bool(self.steps)

    def __str__(self) -> str:
        return "/".join(self._parts)

    def field(self, typedefs: Typedefs) -> Field:
        """What it leads to, in messages of a type.

        Raises:
            UnknownField: there is no such field.
        """
        field = Field("", typedefs.root)
        is_list = False
        for step in self.steps:
            if field.length is not None:
                raise UnknownField(f"{field.name} has several elements: write {field.name}[0]")
            fields = _TIME if field.type in TIMES else []
            if field.type in typedefs:
                fields = typedefs.fields(field.type)
            field = _named(step.name, fields, field.type)
            if step.which is None:
                continue
            if field.length is None:
                raise UnknownField(f"{step.name} is a {field.type}, no array")
            field = Field(step.name, field.type)
            is_list = is_list or isinstance(step.which, slice)
        return Field(field.name, field.type, 0) if is_list else field

    def pick(self, message: Any, typedefs: Typedefs) -> Any:
        """The value in a message; it raises `UnknownField` if an array is too short."""
        return _pick(message, Field("", typedefs.root), self.steps, typedefs)


def splits(name: str, topics: Iterable[str]) -> Iterator[tuple[str, str]]:
    """The ways to take a name for a topic and a path, the longest topic first.

    Args:
        name: a global name, with or without a path behind it.
        topics: the global names of all topics.
    """
    name = name.rstrip("/")
    found = [topic for topic in topics if name == topic or name.startswith(f"{topic}/")]
    for topic in sorted(found, key=len, reverse=True):
        yield topic, name[len(topic) + 1 :]


def _pick(value: Any, field: Field, steps: list[Step], typedefs: Typedefs) -> Any:
    for i, step in enumerate(steps):
        fields = _TIME if field.type in TIMES else typedefs.fields(field.type)
        field = _named(step.name, fields, field.type)
        value = value[step.name]
        if step.which is None:
            continue
        several = elements(value, field)
        field = Field(step.name, field.type)
        try:
            value = several[step.which]
        except IndexError:
            raise UnknownField(f"{step.name} has only {len(several)} elements") from None
        if isinstance(step.which, slice):
            return [_pick(each, field, steps[i + 1 :], typedefs) for each in value]
    return value


def _named(name: str, fields: list[Field], type_: str) -> Field:
    for field in fields:
        if field.name == name:
            return field
    there = ", ".join(each.name for each in fields) or "no fields that are known"
    raise UnknownField(f"no field named {name} in {type_}, which has {there}")


def _step(part: str) -> Step:
    found = _STEP.fullmatch(part)
    if found is None:
        raise InvalidValue(f"{part!r} is no field: write name, name[0] or name[2:4]")
    name, inside = found.groups()
    if inside is None:
        return Step(name)
    try:
        numbers = [int(each) if each else None for each in inside.split(":")]
        if len(numbers) == 1 and numbers[0] is not None:
            return Step(name, numbers[0])
        if not 2 <= len(numbers) <= 3 or numbers[2:] == [0]:
            raise ValueError
    except ValueError:
        raise InvalidValue(f"{part!r} picks no elements: write {name}[0] or {name}[2:4]") from None
    return Step(name, slice(*numbers))
