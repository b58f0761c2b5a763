"""Looks up the definitions of nested types, and refuses types that are recursive or too large.

Whatever is linked is finite: its types exist, none holds itself, and its size is bounded. The rest
of fibws relies on that, since a client may bring its own definitions.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

from fibws.errors import DefinitionError, UnknownPackage, UnknownType
from fibws.interfaces import builtin
from fibws.interfaces.definition import Field, MessageDefinition
from fibws.suggestions import nearest

DEEPEST = 50
"""How deep messages may be nested."""
MOST_FIELDS = 10_000
"""How many fields a message may have, those of nested messages included: each needs a validator."""
MOST_VALUES = 2**22
"""How many values a message may have when its fixed arrays are full and the others empty, and how
many a list of messages may have in all: a few bytes of JSON for each could fill the memory."""


class Size(NamedTuple):
    """How large a message is.

    ``fields`` are its own and those of nested messages. ``values`` are how many it has when its
    fixed arrays are full and the others empty. ``has_floats`` is true if there are floats.
    """

    fields: int
    values: int
    has_floats: bool = False


_SCALAR, _FLOAT, _TIME = Size(0, 1), Size(0, 1, has_floats=True), Size(2, 1)


class Resolver:
    """Looks up definitions together with those of nested types.

    Args:
        read: returns the definition of a type, not linked.
    """

    def __init__(self, read: Callable[[str], MessageDefinition]) -> None:
        self._read = read
        self.known: dict[str, MessageDefinition] = {}
        self._sizes: dict[str, Size] = {}

    def message(self, name: str) -> MessageDefinition:
        """The definition of the type; all nested types have been looked up.

        Raises:
            DefinitionError: it, or a type nested in it, is wrong.
            UnknownType, UnknownPackage: there is no such type.
        """
        return self.known.get(name) or self._add(self._read(name), ())

    def size(self, name: str) -> Size:
        """The size of a message of a type that has been looked up."""
        return self._sizes[name]

    def check(self, definition: MessageDefinition) -> Size:
        """Look up the types nested in any definition, such as a service's request."""
        return self._measure(definition, ())

    def _add(self, definition: MessageDefinition, above: tuple[str, ...]) -> MessageDefinition:
        self._sizes[definition.type] = self._measure(definition, above)
        self.known[definition.type] = definition
        return definition

    def _measure(self, definition: MessageDefinition, above: tuple[str, ...]) -> Size:
        """The size of a definition; ``above`` are the types that it is nested in."""
        path = (*above, definition.type)
        fields = values = 0
        has_floats = False
        for field in definition.fields:
            if field.is_nested:
                inner = self._nested(definition, field, path)
            elif field.type in builtin.TIMES:
                inner = _TIME
            else:
                inner = _FLOAT if field.type in builtin.FLOATS else _SCALAR
            has_floats = has_floats or inner.has_floats
            repeat = 1 if field.array is None else field.array.fixed or 0
            fields += 1 + inner.fields
            values += max(1, repeat * inner.values)
            if fields > MOST_FIELDS or values > MOST_VALUES:
                raise _error(definition, field, "the message becomes too large")
        return Size(fields, values, has_floats)

    def _nested(self, definition: MessageDefinition, field: Field, path: tuple[str, ...]) -> Size:
        if field.type in path:
            raise _error(definition, field, f"{field.type} contains itself")
        if len(path) >= DEEPEST:
            raise _error(definition, field, f"nested too deeply (limit is {DEEPEST})")
        if field.type not in self.known:
            try:
                nested = self._read(field.type)
            except (UnknownType, UnknownPackage) as error:
                raise _error(definition, field, _unknown(definition, field, error)) from None
            self._add(nested, path)
        return self._sizes[field.type]


def _unknown(
    definition: MessageDefinition, field: Field, error: UnknownType | UnknownPackage
) -> str:
    """Return what is wrong with a field's type, with what may have been meant."""
    name, meant = f"type {field.type}", error.nearest
    if error.package == definition.type.partition("/")[0]:
        # Most likely it was written without its package: a builtin type may be meant.
        short = field.type.partition("/")[2]
        name, meant = f"type {short}", nearest(short, builtin.NAMES, 0.7) or meant
    elif isinstance(error, UnknownPackage):
        name = f"package {error.package}"
    return f"unknown {name}{f' (did you mean {meant}?)' if meant else ''}"


def _error(definition: MessageDefinition, field: Field, fault: str) -> DefinitionError:
    package = definition.type.partition("/")[0]
    text = f"{field.full_type.removeprefix(f'{package}/')} {field.name}"
    return DefinitionError(definition.source or definition.type, field.line, text, fault)
