"""Values of a fixed size, which one `struct` packs when they stand side by side."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import islice
from typing import Any, Protocol

from fibws.interfaces import base64text


class Fixed(Protocol):
    """A value whose bytes are as many each time."""

    format: str
    """What `struct` calls it, in one letter or more."""
    free: int
    """How many values it holds that need no bytes."""

    def flatten(self, value: Any, to: list[Any]) -> None:
        """Append what `struct` packs for the value."""

    def build(self, values: Iterator[Any]) -> Any:
        """The value, from what `struct` unpacked."""


class Scalar:
    """A number or a bool, by `struct`'s letter for it."""

    free = 0

    def __init__(self, letter: str) -> None:
        self.format = letter

    def flatten(self, value: Any, to: list[Any]) -> None:
        to.append(value)

    def build(self, values: Iterator[Any]) -> Any:
        return next(values)


class Row:
    """An array of so many numbers or bools."""

    def __init__(self, letter: str, count: int) -> None:
        self._count = count
        self.format = f"{count}{letter}"
        self.free = 0 if count else 1

    def flatten(self, value: list[Any], to: list[Any]) -> None:
        to += value

    def build(self, values: Iterator[Any]) -> list[Any]:
        return list(islice(values, self._count))


class Bytes:
    """So many bytes: base64 in a message."""

    def __init__(self, count: int) -> None:
        self.format = f"{count}s"
        self.free = 0 if count else 1

    def flatten(self, value: str, to: list[Any]) -> None:
        to.append(base64text.decode(value))

    def build(self, values: Iterator[Any]) -> str:
        return base64text.encode(next(values))


class Layout:
    """Fields of a fixed size side by side: some of a message's, or all of them."""

    def __init__(self, fields: Sequence[tuple[str, Fixed]]) -> None:
        self._fields = fields
        self._names = [name for name, _ in fields]
        self._are_scalars = all(isinstance(fixed, Scalar) for _, fixed in fields)
        self.format = "".join(fixed.format for _, fixed in fields)
        self.free = sum(fixed.free for _, fixed in fields) if fields else 1

    def flatten(self, value: dict[str, Any], to: list[Any]) -> None:
        if self._are_scalars:
            to.extend(map(value.__getitem__, self._names))
            return
        for name, fixed in self._fields:
            fixed.flatten(value[name], to)

    def build(self, values: Iterator[Any]) -> dict[str, Any]:
        if self._are_scalars:
            # The names come first: when they end, nothing more is taken from the values.
            return dict(zip(self._names, values, strict=False))
        return {name: fixed.build(values) for name, fixed in self._fields}
