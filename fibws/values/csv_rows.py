"""Messages as comma-separated values, as ``rostopic echo -p`` prints them for plots."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, NamedTuple

from fibws.values.printing import elements
from fibws.values.typedefs import FLOATS, STRINGS, TIMES, Field, Typedefs


class Cell(NamedTuple):
    """One value of a row, and what the head of its column is."""

    head: str
    text: str


class Rows:
    """The rows of one field of messages, or of whole messages.

    Args:
        typedefs: those of the messages' type.
        field: what is printed.
        noarr: leave out arrays.
        nostr: leave out texts.
    """

    def __init__(
        self, typedefs: Typedefs, field: Field, *, noarr: bool = False, nostr: bool = False
    ) -> None:
        self._typedefs = typedefs
        self._field = field
        self._noarr = noarr
        self._nostr = nostr

    def head(self, value: Any) -> str:
        """The first line: what is in the columns of a row as that of ``value``."""
        return f"%time,{','.join(cell.head for cell in self._cells(value))}"

    def row(self, value: Any, *, now: int, relative: bool = False) -> str:
        """A line of values, the first of which is the time of the header, or else now.

        Args:
            now: nanoseconds since 1970.
            relative: count times from ``now``.
        """
        stamp = now
        if self._field.length is None and self._typedefs.has_header(self._field.type):
            stamp = _nanoseconds(value["header"]["stamp"])
        zero = now if relative else 0
        cells = self._cells(value, zero)
        return f"{stamp - zero},{','.join(cell.text for cell in cells)}"

    def _cells(self, value: Any, zero: int = 0) -> Iterator[Cell]:
        return self._of(value, self._field, "field", zero)

    def _of(self, value: Any, field: Field, head: str, zero: int) -> Iterator[Cell]:
        if field.length is not None:
            element = Field("", field.type)
            for i, each in enumerate(elements(value, field)):
                yield from self._of(each, element, f"{head}{i}", zero)
        elif field.type in TIMES:
            start = zero if field.type == "time" else 0
            yield Cell(head, str(_nanoseconds(value) - start))
        elif field.type in self._typedefs:
            for each in self._typedefs.fields(field.type):
                if not self._is_left_out(each):
                    yield from self._of(value[each.name], each, f"{head}.{each.name}", zero)
        elif isinstance(value, dict):
            for name, each in value.items():
                length = 0 if isinstance(each, list) else None
                yield from self._of(each, Field(name, "", length), f"{head}.{name}", zero)
        else:
            yield Cell(head, _text(value, field.type))

    def _is_left_out(self, field: Field) -> bool:
        return (self._noarr and field.length is not None) or (self._nostr and field.type in STRINGS)


def _nanoseconds(time: dict[str, int]) -> int:
    return time["secs"] * 10**9 + time["nsecs"]


def _text(value: Any, type_: str) -> str:
    if type_ in FLOATS:
        return str(float("nan") if value is None else float(value))
    if isinstance(value, bool):
        return "1" if value else "0"
    return str(value)
