"""Follows nested types to their definitions, and refuses what has no end.

Whatever is linked is finite: its types exist, none holds itself, and its size is bounded. The rest
of fibws relies on that, since a client may bring its own definitions.
"""

from __future__ import annotations

from collections.abc import Callable

from fibws.errors import DefinitionError, UnknownPackage, UnknownType
from fibws.interfaces.definition import Field, MessageDefinition

DEEPEST = 50
"""How many messages may be nested in each other."""
MOST_FIELDS = 10_000
"""How many fields a message may have, those of nested messages included."""
MOST_VALUES = 2**22
"""How many values a message may have when its fixed arrays are full and the others empty, and how
many a list of messages may have in all: a few bytes of JSON for each could fill the memory."""


class Linker:
    """Reads definitions and, with each, those of the types nested in it.

    Args:
        read: gives the definition of a type, not linked.
    """

    def __init__(self, read: Callable[[str], MessageDefinition]) -> None:
        self._read = read
        self.known: dict[str, MessageDefinition] = {}
        self._sizes: dict[str, tuple[int, int]] = {}

    def message(self, name: str) -> MessageDefinition:
        """The definition of the type, linked.

        Raises:
            DefinitionError: it, or a type nested in it, is wrong.
            UnknownType, UnknownPackage: there is no such type.
        """
        return self.known.get(name) or self._add(self._read(name), ())

    def values(self, name: str) -> int:
        """How many values a message of a linked type has when its arrays of any size are empty."""
        return self._sizes[name][1]

    def check(self, definition: MessageDefinition) -> None:
        """Link the types nested in a definition that is no message of its own, as a request."""
        self._measure(definition, ())

    def _add(self, definition: MessageDefinition, above: tuple[str, ...]) -> MessageDefinition:
        self._sizes[definition.type] = self._measure(definition, above)
        self.known[definition.type] = definition
        return definition

    def _measure(self, definition: MessageDefinition, above: tuple[str, ...]) -> tuple[int, int]:
        """How many fields and values the definition has; ``above`` are those it is nested in."""
        path = (*above, definition.type)
        fields = values = 0
        for field in definition.fields:
            inner = self._nested(definition, field, path) if field.is_nested else (1, 1)
            repeat = 1 if field.array is None else field.array.fixed or 0
            fields += max(1, inner[0])
            values += max(1, repeat * inner[1])
            if fields > MOST_FIELDS or values > MOST_VALUES:
                raise _error(definition, field, "the message becomes too large")
        return fields, values

    def _nested(
        self, definition: MessageDefinition, field: Field, path: tuple[str, ...]
    ) -> tuple[int, int]:
        if field.type in path:
            raise _error(definition, field, f"{field.type} would hold itself")
        if len(path) >= DEEPEST:
            raise _error(definition, field, f"more than {DEEPEST} messages in each other")
        if field.type not in self.known:
            try:
                nested = self._read(field.type)
            except (UnknownType, UnknownPackage) as error:
                raise _error(definition, field, str(error)) from None
            self._add(nested, path)
        return self._sizes[field.type]


def _error(definition: MessageDefinition, field: Field, fault: str) -> DefinitionError:
    text = f"{field.full_type} {field.name}"
    return DefinitionError(definition.source or definition.type, field.line, text, fault)
