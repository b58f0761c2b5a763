"""The parts that ROS 1's serialization of a message is made of (http://wiki.ros.org/msg).

All is little-endian. A string, or an array of no fixed size, has its length before it as a uint32;
the rest is put side by side.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import nan
from struct import Struct
from struct import error as StructError
from typing import Any, Protocol

from fibws.interfaces import base64text
from fibws.interfaces.layout import Layout
from fibws.interfaces.linker import MOST_VALUES


class Fault(Exception):
    """What is wrong with the bytes, and where: the path to there grows on the way out."""

    path = ""

    def inside(self, step: str) -> Fault:
        """The fault, as the message or the array that holds the place sees it."""
        dot = "." if self.path and not self.path.startswith("[") else ""
        self.path = f"{step}{dot}{self.path}"
        return self


class Reader:
    """The bytes of a message, and how far they are read."""

    __slots__ = ("_free", "data", "offset")

    def __init__(self, data: bytes) -> None:
        self.data = data
        self.offset = 0
        self._free = MOST_VALUES

    def skip(self, size: int) -> int:
        """Where the next ``size`` bytes begin, which count as read."""
        begin = self.offset
        left = len(self.data) - begin
        if size > left:
            raise Fault(f"{size} bytes are needed, {left} are left")
        self.offset = begin + size
        return begin

    def length(self) -> int:
        """The length of what follows."""
        begin = self.skip(4)
        return int.from_bytes(self.data[begin : begin + 4], "little")

    def take(self) -> bytes:
        """As many bytes as the length before them says."""
        size = self.length()
        begin = self.skip(size)
        return self.data[begin : begin + size]

    def expect(self, count: int, element: Part) -> None:
        """Make sure that so many elements can follow, before they take up memory."""
        left = len(self.data) - self.offset
        if count * element.least > left:
            raise Fault(f"{count} elements need {count * element.least} bytes, {left} are left")
        self._free -= count * element.free
        if self._free < 0:
            raise Fault(f"more than {MOST_VALUES} values need no bytes")


class Part(Protocol):
    """A field, an element, or a whole message."""

    least: int
    """How many bytes it needs at least."""
    free: int
    """How many values it holds at least that need no bytes."""

    def write(self, value: Any, to: list[bytes]) -> None:
        """Append the value's bytes."""

    def read(self, reader: Reader) -> Any:
        """The value of the next bytes."""


class Text:
    """A string."""

    least = 4
    free = 0

    def write(self, value: str, to: list[bytes]) -> None:
        data = value.encode()
        to += (_length(data), data)

    def read(self, reader: Reader) -> str:
        try:
            return reader.take().decode()
        except UnicodeDecodeError as error:
            raise Fault(f"{error.reason} of UTF-8 at byte {error.start}") from None


class Blob:
    """A byte string of any length: base64 in a message."""

    least = 4
    free = 0

    def write(self, value: str, to: list[bytes]) -> None:
        data = base64text.decode(value)
        to += (_length(data), data)

    def read(self, reader: Reader) -> str:
        return base64text.encode(reader.take())


class Numbers:
    """An array of any number of numbers or bools, by `struct`'s letter for them."""

    least = 4
    free = 0

    def __init__(self, letter: str) -> None:
        self._letter = letter
        self._size = Struct(f"<{letter}").size

    def write(self, value: list[Any], to: list[bytes]) -> None:
        to += (_length(value), _packed(Struct(f"<{len(value)}{self._letter}"), value))

    def read(self, reader: Reader) -> list[Any]:
        count = reader.length()
        begin = reader.skip(count * self._size)
        return list(Struct(f"<{count}{self._letter}").unpack_from(reader.data, begin))


class Several:
    """An array of anything else.

    Args:
        element: what each element is.
        count: how many there are, if their number is fixed.
    """

    def __init__(self, element: Part, count: int | None) -> None:
        self._element = element
        self._count = count
        self.least = 4 if count is None else count * element.least
        self.free = 1 if count == 0 else (count or 0) * element.free

    def write(self, value: list[Any], to: list[bytes]) -> None:
        if self._count is None:
            to.append(_length(value))
        for element in value:
            self._element.write(element, to)

    def read(self, reader: Reader) -> list[Any]:
        count = self._count
        if count is None:
            count = reader.length()
            reader.expect(count, self._element)
        values: list[Any] = []
        try:
            while len(values) < count:
                values.append(self._element.read(reader))
        except Fault as fault:
            raise fault.inside(f"[{len(values)}]") from None
        return values


class Packed:
    """A message, or a time, all of whose fields are of a fixed size."""

    def __init__(self, layout: Layout) -> None:
        self._layout = layout
        self._struct = Struct(f"<{layout.format}")
        self.least = self._struct.size
        self.free = layout.free

    def write(self, value: dict[str, Any], to: list[bytes]) -> None:
        values: list[Any] = []
        self._layout.flatten(value, values)
        to.append(_packed(self._struct, values))

    def read(self, reader: Reader) -> dict[str, Any]:
        begin = reader.skip(self.least)
        return self._layout.build(iter(self._struct.unpack_from(reader.data, begin)))


class Mixed:
    """A message that has fields of both kinds.

    Args:
        members: its parts in order: by a field's name, or by "" those fields of it that are packed.
    """

    def __init__(self, members: Sequence[tuple[str, Part]]) -> None:
        self._members = members
        self.least = sum(part.least for _, part in members)
        self.free = sum(part.free for _, part in members)

    def write(self, value: dict[str, Any], to: list[bytes]) -> None:
        for name, part in self._members:
            part.write(value[name] if name else value, to)

    def read(self, reader: Reader) -> dict[str, Any]:
        message: dict[str, Any] = {}
        for name, part in self._members:
            try:
                found = part.read(reader)
            except Fault as fault:
                raise (fault.inside(name) if name else fault) from None
            if name:
                message[name] = found
            else:
                message.update(found)
        return message


def _length(value: Sequence[Any]) -> bytes:
    return len(value).to_bytes(4, "little")


def _packed(struct: Struct, values: list[Any]) -> bytes:
    try:
        return struct.pack(*values)
    except StructError:  # a None among them, which stands for NaN
        return struct.pack(*(nan if value is None else value for value in values))
