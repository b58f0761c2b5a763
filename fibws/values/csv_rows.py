"""Comma-separated values of messages, as ``rostopic echo -p`` prints them for plots."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, NamedTuple

from fibws.values.typedefs import FLOATS, STRINGS, TIMES, TypedefField, Typedefs


class Cell(NamedTuple):
    """One value of a row, and the name of its column."""

    head: str
    text: str


class Rows:
    """The rows of whole messages, or of one field of them.

    Args:
        typedefs: the definition of the messages' type.
        field: the field, or the whole message.
        noarr: leave out arrays.
        nostr: leave out strings.
    """

    def __init__(
        self, typedefs: Typedefs, field: TypedefField, *, noarr: bool = False, nostr: bool = False
    ) -> None:
        self._typedefs = typedefs
        self._field = field
        self._noarr = noarr
        self._nostr = nostr

    def head(self, value: Any) -> str:
        """Return the first line: the names of the columns of ``value``."""
        return f"%time,{','.join(cell.head for cell in self._cells(value))}"

    def row(self, value: Any, *, now: int, relative: bool = False, by_header: bool = True) -> str:
        """Return a line of values; the first one is the header's time, or ``now`` without a header.

        Args:
            now: nanoseconds since 1970.
            relative: subtract ``now`` from times.
            by_header: whether to use the header's time; if not, the first value is ``now``.
        """
        stamp = now
        if by_header and self._field.length is None and self._typedefs.has_header(self._field.type):
            stamp = _nanoseconds(value["header"]["stamp"])
        zero = now if relative else 0
        cells = self._cells(value, zero)
        return f"{stamp - zero},{','.join(cell.text for cell in cells)}"

    def _cells(self, value: Any, zero: int = 0) -> Iterator[Cell]:
        return self._cells_of(value, self._field, "field", zero)

    def _cells_of(self, value: Any, field: TypedefField, head: str, zero: int) -> Iterator[Cell]:
        if field.length is not None:
            element = TypedefField("", field.type)
            for i, each in enumerate(field.elements(value)):
                yield from self._cells_of(each, element, f"{head}{i}", zero)
        elif field.type in TIMES:
            start = zero if field.type == "time" else 0
            yield Cell(head, str(_nanoseconds(value) - start))
        elif field.type in self._typedefs:
            for each in self._typedefs.fields(field.type):
                if not self._is_left_out(each):
                    yield from self._cells_of(value[each.name], each, f"{head}.{each.name}", zero)
        elif isinstance(value, dict):
            for name, each in value.items():
                length = 0 if isinstance(each, list) else None
                yield from self._cells_of(
                    each, TypedefField(name, "", length), f"{head}.{name}", zero
                )
        else:
            yield Cell(head, _text(value, field.type))

    def _is_left_out(self, field: TypedefField) -> bool:
        return (self._noarr and field.length is not None) or (self._nostr and field.type in STRINGS)


def _nanoseconds(time: dict[str, int]) -> int:
    return time["secs"] * 10**9 + time["nsecs"]


def _text(value: Any, type_: str) -> str:
    if type_ in FLOATS:
        return str(float("nan") if value is None else float(value))
    if isinstance(value, bool):
        return "1" if value else "0"
    return str(value)
