"""Messages whose 64-bit integers are decimal strings.

JavaScript's numbers are doubles, which hold no integers beyond 2**53 exactly.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any, Final, TypeAlias

from fibws.interfaces.catalogue import Definitions
from fibws.interfaces.cbor import convert_all, convert_members
from fibws.interfaces.definition import Field, MessageDefinition

Convert: TypeAlias = Callable[[Any], Any]
"""Returns a value with strings for 64-bit integers; it leaves the given one as it is."""

LONG: Final = ("int64", "uint64")
"""The types of these integers. All values of such a field become strings, also small ones."""


class LongIntegers:
    """The converters of all message types, each made on first use."""

    def __init__(self, interfaces: Definitions) -> None:
        self._interfaces = interfaces
        self._converters: dict[str, Convert | None] = {}

    def of(self, name: str) -> Convert | None:
        """Return the converter for messages of a type; None if it has no such integers.

        Raises as `Definitions.message` does.
        """
        if name not in self._converters:
            self._converters[name] = self._message(self._interfaces.message(name))
        return self._converters[name]

    def _message(self, definition: MessageDefinition) -> Convert | None:
        converters = {field.name: self._field(field) for field in definition.fields}
        needed = {name: convert for name, convert in converters.items() if convert is not None}
        return partial(convert_members, tuple(needed.items())) if needed else None

    def _field(self, field: Field) -> Convert | None:
        if field.is_nested:
            convert = self.of(field.type)
        else:
            convert = str if field.type in LONG else None
        if field.array is None or convert is None:
            return convert
        return partial(convert_all, convert)
