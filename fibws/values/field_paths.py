"""Paths to fields of messages, as in ``/topic/field/sub[3]``."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from typing import Any, NamedTuple

from fibws.errors import InvalidValue, UnknownField
from fibws.values.typedefs import TIMES, TypedefField, Typedefs

_STEP = re.compile(r"(\w+)(?:\[([^\]]*)\])?")
_TIME = [TypedefField("secs", "int32"), TypedefField("nsecs", "int32")]


class Step(NamedTuple):
    """One part of a path: a field, and the elements of its array to choose."""

    name: str
    chosen: int | slice | None = None


class Path:
    """A path to a field: ``poses[0]/position/x``; an empty one is that of the whole message.

    Elements are counted as in Python: ``[-1]`` is the last one, ``[2:4]`` are two.

    Raises:
        InvalidValue: the text is not a path.
    """

    def __init__(self, text: str) -> None:
        self._parts = [part for part in text.split("/") if part]
        self.steps = [_step(part) for part in self._parts]

    def __bool__(self) -> bool:
        return bool(self.steps)

    def __str__(self) -> str:
        return "/".join(self._parts)

    def field(self, typedefs: Typedefs) -> TypedefField:
        """Return the field of a type; the field of several elements' fields is an array.

        Raises:
            UnknownField: the type has no such field.
        """
        field = TypedefField("", typedefs.root)
        is_list = False
        for step in self.steps:
            if field.length is not None:
                raise UnknownField(f"{field.name} is an array: choose an element, {field.name}[0]")
            fields = _TIME if field.type in TIMES else []
            if field.type in typedefs:
                fields = typedefs.fields(field.type)
            field = _field(step.name, fields, field.type)
            if step.chosen is None:
                continue
            if field.length is None:
                raise UnknownField(f"{step.name} is a {field.type}, not an array")
            field = TypedefField(step.name, field.type)
            is_list = is_list or isinstance(step.chosen, slice)
        return TypedefField(field.name, field.type, 0) if is_list else field

    def pick(self, message: Any, typedefs: Typedefs) -> Any:
        """Return the value in a message; raise `UnknownField` if an array is too short."""
        return _pick(message, TypedefField("", typedefs.root), self.steps, typedefs)


def splits(name: str, topics: Iterable[str]) -> Iterator[tuple[str, str]]:
    """Yield the topics and paths that a name may mean, the longest topic first.

    Args:
        name: a global name, perhaps followed by a path.
        topics: the global names of all topics.
    """
    name = name.rstrip("/")
    candidates = [topic for topic in topics if name == topic or name.startswith(f"{topic}/")]
    for topic in sorted(candidates, key=len, reverse=True):
        yield topic, name[len(topic) + 1 :]


def _pick(value: Any, field: TypedefField, steps: list[Step], typedefs: Typedefs) -> Any:
    for i, step in enumerate(steps):
        fields = _TIME if field.type in TIMES else typedefs.fields(field.type)
        field = _field(step.name, fields, field.type)
        value = value[step.name]
        if step.chosen is None:
            continue
        elements = field.elements(value)
        field = TypedefField(step.name, field.type)
        try:
            value = elements[step.chosen]
        except IndexError:
            raise UnknownField(f"{step.name} has only {len(elements)} elements") from None
        if isinstance(step.chosen, slice):
            return [_pick(each, field, steps[i + 1 :], typedefs) for each in value]
    return value


def _field(name: str, fields: list[TypedefField], type_: str) -> TypedefField:
    for field in fields:
        if field.name == name:
            return field
    known = ", ".join(each.name for each in fields)
    expected = f"expected {known}" if known else "it has no known fields"
    raise UnknownField(f"no field named {name} in {type_}: {expected}")


def _step(part: str) -> Step:
    found = _STEP.fullmatch(part)
    if found is None:
        raise InvalidValue(f"invalid field {part!r}; examples: name, name[0], name[2:4]")
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
        raise InvalidValue(f"invalid index in {part!r}; examples: {name}[0], {name}[2:4]") from None
    return Step(name, slice(*numbers))
