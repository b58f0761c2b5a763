"""Conversion between ROS 1's serialization and that of ROS 2, which is CDR.

CDR (Common Data Representation, little endian) begins with 4 bytes that name it. Each number is
aligned to its size, counted from behind these; a string has a NUL behind it that its length counts;
a message without fields has one byte. Otherwise the bytes are those of ROS 1, so that a converter
copies pieces that are as long as possible: an image is a few of them.

For each type two functions are compiled when they are first needed, in any thread, as in
`fibws.interfaces.serialization_code`. For ``geometry_msgs/PointStamped`` the one that makes CDR is,
in short,

    def function(data, o, p, out):
        v1, n1, = unpack(data, o)       # "<4x8sI": seq, the stamp, the length of frame_id
        a = p & 7
        out.append(packs[a](v1, n1 + 1))
        ...
        return o, p

where ``o`` is the offset in ``data`` and ``p`` the position in the CDR. What may stand where
depends on ``p & 7`` alone, so that there are 8 structs for each piece.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from functools import cached_property
from struct import Struct
from struct import error as StructError
from typing import Any, Final, NamedTuple, TypeAlias

from fibws.errors import InvalidMessage, Ros2Error
from fibws.interfaces import builtin
from fibws.interfaces.definition import Field, MessageDefinition
from fibws.interfaces.ros2_definitions import Find, ros2_fields
from fibws.interfaces.serialization_code import LETTERS, MOST_WITHOUT_BYTES

Buffer: TypeAlias = bytes | bytearray | memoryview
Function: TypeAlias = Callable[..., Any]

HEADER: Final = b"\x00\x01\x00\x00"
"""CDR, little endian, without options."""
MOST_PADDING: Final = 3
"""Bytes that may follow a message."""
VIEWED: Final = 4096
"""Bytes of a message from which on slices are not copied twice."""
MOST_ELEMENTS: Final = MOST_WITHOUT_BYTES
"""Elements without bytes in an array."""
MOST_FIXED_ELEMENTS: Final = 2**8
"""Elements without bytes in the fixed arrays of a message: in CDR, each has one."""

_SIZES: Final = {name: Struct(f"<{letter}").size for name, letter in LETTERS.items()}
_INLINED: Final = 40
"""A message with more pieces than this has functions of its own."""


class _Chunk(NamedTuple):
    """Bytes that are equal in both serializations.

    Attributes:
        align: what their position in CDR is a multiple of.
    """

    size: int
    align: int


class _Skip(NamedTuple):
    """Bytes that only one of both serializations has, and that are zero."""

    ros1: int
    cdr: int


_Piece: TypeAlias = "_Chunk | _Skip | Field"
"""A field is one whose size varies."""


class Converters:
    """The converters of all types of some definitions; each is made on first use.

    Args:
        find: returns the definition of a message by its name.
    """

    def __init__(self, find: Find) -> None:
        self._find = find
        self._by_name: dict[str, Converter] = {}

    def of(self, type_: str) -> Converter:
        """Return the converter of a message.

        Raises:
            InterfaceError: the message is unknown.
            Ros2Error: a field cannot be converted.
        """
        found = self._by_name.get(type_)
        if found is None:
            found = self._by_name[type_] = self.of_definition(self._find(type_))
        return found

    def of_definition(self, definition: MessageDefinition) -> Converter:
        """Return a new converter of a message without a name, such as a request; as `of`."""
        return Converter(definition, self)


class Converter:
    """Converts the messages of one type.

    Attributes:
        pieces: what it consists of.
        least: the fewest bytes of it in ROS 1's serialization; in CDR it has 1 at least.
        without_bytes: how many elements its fixed arrays have that have no bytes in ROS 1.

    Raises:
        InterfaceError: a type in it is unknown.
        Ros2Error: a field cannot be converted.
    """

    def __init__(self, definition: MessageDefinition, converters: Converters) -> None:
        self.type = definition.type
        self.converters = converters
        self.pieces: list[_Piece] = []
        fields = ros2_fields(definition)
        if fields != definition.fields:
            self.pieces.append(_Skip(4, 0))
        if not fields:
            self.pieces.append(_Skip(0, 1))
        for field in fields:
            self._add(field)
        if not self.pieces:  # Hostile counts of it would cost time without bytes.
            raise Ros2Error(f"{self.type}: a message without bytes cannot be converted")
        self.least = sum(map(self._least, self.pieces))
        self.without_bytes = sum(map(self._without_bytes, self.pieces))
        if self.without_bytes > MOST_FIXED_ELEMENTS:
            raise Ros2Error(f"{self.type}: more than {MOST_FIXED_ELEMENTS} elements without fields")

    def to_cdr(self, data: Buffer) -> bytes:
        """Return a valid message of ROS 1 as CDR, with its header.

        Raises:
            InvalidMessage: it is not valid.
        """
        out: list[Buffer] = [HEADER]
        view = data if len(data) < VIEWED and type(data) is bytes else memoryview(data)
        try:
            end, _ = self.to_cdr_function(view, 0, 0, out)
        except (StructError, ValueError, IndexError, OverflowError):
            end = -1
        if end != len(data):
            raise InvalidMessage(f"invalid bytes for {self.type}")
        return b"".join(out)

    def from_cdr(self, data: bytes) -> bytearray:
        """Return a message of ROS 2 in ROS 1's serialization.

        Raises:
            InvalidMessage: it is truncated, has invalid lengths, or is not CDR, little endian.
        """
        if data[:2] != HEADER[:2] or len(data) < len(HEADER):
            raise InvalidMessage(
                f"invalid CDR for {self.type}: expected the header 00 01, got {data[:4].hex(' ')}"
            )
        out: list[Buffer] = []
        view = memoryview(data)[4:] if len(data) >= VIEWED else data[4:]
        try:
            end = self.from_cdr_function(view, 0, out)
        except (StructError, ValueError, IndexError, OverflowError):
            raise InvalidMessage(f"invalid CDR for {self.type}") from None
        if not 0 <= len(view) - end <= MOST_PADDING:
            raise InvalidMessage(
                f"invalid CDR for {self.type}: expected {end} bytes, got {len(view)}"
            )
        return bytearray().join(out)

    @cached_property
    def to_cdr_function(self) -> Function:
        """The compiled function that makes CDR; see the module."""
        return _ToCdr(self).function()

    @cached_property
    def from_cdr_function(self) -> Function:
        """The compiled function that reads CDR: it takes data, offset and output."""
        return _FromCdr(self).function()

    @cached_property
    def chunk(self) -> _Chunk | None:
        """The bytes of a message if all are equal in both, also of many behind each other."""
        match self.pieces:
            case [_Chunk() as only] if only.size % only.align == 0:
                return only
        return None

    @property
    def is_inlined(self) -> bool:
        """Whether it is written out where it is nested."""
        return len(self.pieces) <= _INLINED and not any(
            isinstance(piece, Field) and piece.array is not None and self._is_looped(piece)
            for piece in self.pieces
        )

    def _is_looped(self, field: Field) -> bool:
        return field.type in builtin.STRINGS or field.is_nested

    def _add(self, field: Field) -> None:
        """Add the pieces of a field."""
        if field.type == "wstring":
            raise Ros2Error(f"{self.type}: {field.name}: wstring cannot be converted")
        count = 1 if field.array is None else field.array.fixed
        if field.is_nested:
            nested = self.converters.of(field.type)
            if field.array is None and nested.is_inlined:
                for piece in nested.pieces:
                    self._add_piece(piece)
                return
            element = nested.chunk
        else:
            element = _element(field.type)
        if count == 0:
            return
        if element is None or count is None:
            self.pieces.append(field)
        else:
            self._add_piece(_Chunk(count * element.size, element.align))

    def _add_piece(self, piece: _Piece) -> None:
        last = self.pieces[-1] if self.pieces else None
        if isinstance(piece, _Chunk) and isinstance(last, _Chunk):
            if piece.align <= last.align and last.size % piece.align == 0:
                self.pieces[-1] = _Chunk(last.size + piece.size, last.align)
                return
        self.pieces.append(piece)

    def _least(self, piece: _Piece) -> int:
        if isinstance(piece, _Chunk):
            return piece.size
        if isinstance(piece, _Skip):
            return piece.ros1
        if piece.array is not None and piece.array.fixed is None:
            return 4
        count = 1 if piece.array is None else piece.fixed_size
        return count * (4 if piece.type == "string" else self.converters.of(piece.type).least)

    def _without_bytes(self, piece: _Piece) -> int:
        if not isinstance(piece, Field) or not piece.is_nested:
            return 0
        nested = self.converters.of(piece.type)
        count = 1 if piece.array is None else piece.fixed_size
        return count * (nested.without_bytes if nested.least else max(1, nested.without_bytes))


def _element(type_: str) -> _Chunk | None:
    """Return the bytes of a value of a builtin type; None for strings."""
    if type_ in builtin.STRINGS:
        return None
    if type_ in builtin.TIMES:
        return _Chunk(8, 4)
    return _Chunk(_SIZES[type_], _SIZES[type_])


class _CdrCode(ABC):
    """The source of one function."""

    parameters = ""
    result = ""

    def __init__(self, converter: Converter) -> None:
        self.converter = converter
        self.converters = converter.converters
        self.lines: list[str] = []
        self.indent = "    "
        self.names: dict[str, Any] = {"PADS": tuple(bytes(size) for size in range(8))}
        self.chunks: list[tuple[_Chunk | _Skip | None, str]] = []
        """The next pieces, None for a length, each with its variable."""
        self.lengths: list[tuple[str, bool]] = []
        """The variables of the lengths, and whether they are of strings."""

    def function(self) -> Function:
        """Compile the function."""
        self.message(self.converter.pieces)
        self.flush()
        self.add(f"return {self.result}")
        source = "\n".join([f"def function({self.parameters}):", *self.lines])
        exec(compile(source, f"<CDR of {self.converter.type}>", "exec"), self.names)
        function: Function = self.names["function"]
        return function

    def message(self, pieces: list[_Piece]) -> None:
        """Add lines that convert all pieces of a message."""
        for piece in pieces:
            if isinstance(piece, Field):
                self.field(piece)
            else:
                self.chunks.append((piece, self.local()))

    def field(self, field: Field) -> None:
        """Add lines that convert a field whose size varies."""
        if field.array is None:
            self.element(field)
            return
        count: str | int
        element = self.converters.of(field.type).chunk if field.is_nested else _element(field.type)
        if field.array.fixed is not None:
            count = field.array.fixed
            self.flush()
        else:
            count = self.length(is_string=False)
            if element is not None:
                self.copy(count, element)
                return
            self.guard(count, field)
        loop, self.indent = self.indent, f"{self.indent}    "
        self.lines.append(f"{loop}for _ in range({count}):")
        self.element(field)
        self.flush()
        self.indent = loop

    def element(self, field: Field) -> None:
        """Add lines that convert a string, or a message with a function of its own."""
        if field.is_nested:
            nested = self.converters.of(field.type)
            if field.array is not None and nested.is_inlined and len(self.indent) < 16:
                self.message(nested.pieces)
            else:
                self.flush()
                self.call(nested)
        else:
            self.string()

    def add(self, line: str) -> None:
        """Add a line."""
        self.lines.append(self.indent + line)

    def local(self) -> str:
        """Return a new local variable."""
        return self.constant(None)

    def constant(self, value: Any) -> str:
        """Return a new name for a value."""
        name = f"v{len(self.names)}"
        self.names[name] = value
        return name

    def length(self, *, is_string: bool) -> str:
        """Convert a length, and all that comes before it; return its variable."""
        name = self.local()
        self.chunks.append((None, name))
        self.lengths.append((name, is_string))
        self.flush()
        return name

    def formats(self) -> tuple[str, list[str]]:
        """Return the format of the next pieces in ROS 1, and those in CDR by their alignment."""
        ros1 = "<"
        for piece, _ in self.chunks:
            if piece is None:
                ros1 += "I"
            elif isinstance(piece, _Chunk):
                ros1 += f"{piece.size}s"
            elif piece.ros1:
                ros1 += f"{piece.ros1}x"
        return ros1, [self._cdr_format(start) for start in range(8)]

    def _cdr_format(self, start: int) -> str:
        text, position = "<", start
        for piece, _ in self.chunks:
            if isinstance(piece, _Skip):
                size, align, letter = piece.cdr, 1, f"{piece.cdr}x"
            elif piece is None:
                size, align, letter = 4, 4, "I"
            else:
                size, align, letter = piece.size, piece.align, f"{piece.size}s"
            if not size:
                continue
            padding = -position % align
            text += f"{padding}x{letter}" if padding else letter
            position += padding + size
        return text

    def targets(self) -> str:
        """Return the variables of the next pieces."""
        return "".join(f"{name}, " for piece, name in self.chunks if not isinstance(piece, _Skip))

    @abstractmethod
    def flush(self) -> None:
        """Add lines that convert the pieces so far."""

    @abstractmethod
    def string(self) -> None:
        """Add lines that convert a string."""

    @abstractmethod
    def copy(self, count: str, element: _Chunk) -> None:
        """Add lines that copy elements which are equal in both."""

    @abstractmethod
    def guard(self, count: str, field: Field) -> None:
        """Add lines that refuse a count of elements that cannot fit."""

    @abstractmethod
    def call(self, nested: Converter) -> None:
        """Add lines that convert a message by its own function."""


class _ToCdr(_CdrCode):
    """The source of a function from ROS 1's serialization to CDR."""

    parameters = "data, o, p, out"
    result = "o, p"

    def flush(self) -> None:
        if not self.chunks:
            return
        ros1, cdr = self.formats()
        source, structs = Struct(ros1), [Struct(each) for each in cdr]
        packs = self.constant(tuple(each.pack for each in structs))
        sizes = self.constant(tuple(each.size for each in structs))
        targets = self.targets()
        if targets:
            self.add(f"{targets}= {self.constant(source.unpack_from)}(data, o)")
        for name, is_string in self.lengths:
            if is_string:  # With the NUL.
                targets = targets.replace(f"{name}, ", f"{name} + 1, ")
        self.add("a = p & 7")
        self.add(f"out.append({packs}[a]({targets}))")
        self.add(f"o += {source.size}")
        self.add(f"p += {sizes}[a]")
        self.chunks, self.lengths = [], []

    def string(self) -> None:
        length = self.length(is_string=True)
        self.add(f"out += (data[o:o + {length}], b'\\0')")
        self.add(f"o += {length}")
        self.add(f"p += {length} + 1")

    def copy(self, count: str, element: _Chunk) -> None:
        self.add(f"if {count}:")
        if element.align > 4:
            self.add("    a = -p & 7")
            self.add("    out.append(PADS[a])")
            self.add("    p += a")
        self.add(f"    {count} *= {element.size}")
        self.add(f"    out.append(data[o:o + {count}])")
        self.add(f"    o += {count}")
        self.add(f"    p += {count}")

    def guard(self, count: str, field: Field) -> None:
        least = 4 if field.type == "string" else self.converters.of(field.type).least
        limit = f"(len(data) - o) // {least}" if least else str(MOST_ELEMENTS)
        self.add(f"if {count} > {limit}:")
        self.add("    raise ValueError")

    def call(self, nested: Converter) -> None:
        self.add(f"o, p = {self.constant(nested.to_cdr_function)}(data, o, p, out)")


class _FromCdr(_CdrCode):
    """The source of a function from CDR to ROS 1's serialization."""

    parameters = "data, o, out"
    result = "o"

    def flush(self) -> None:
        if not self.chunks:
            return
        ros1, cdr = self.formats()
        target, structs = Struct(ros1), [Struct(each) for each in cdr]
        unpacks = self.constant(tuple(each.unpack_from for each in structs))
        sizes = self.constant(tuple(each.size for each in structs))
        targets = self.targets()
        self.add("a = o & 7")
        if targets:
            self.add(f"{targets}= {unpacks}[a](data, o)")
        self.add(f"o += {sizes}[a]")
        if not targets:
            self.add("if o > len(data):")
            self.add("    raise ValueError")
        for name, is_string in self.lengths:
            if is_string:  # Without the NUL; some writers leave it out of empty strings.
                self.add(f"n = {name}")
                self.add(f"if {name}:")
                self.add(f"    {name} -= 1")
        if target.size:
            self.add(f"out.append({self.constant(target.pack)}({targets}))")
        self.chunks, self.lengths = [], []

    def string(self) -> None:
        length = self.length(is_string=True)
        self.add("if n:")
        self.add(f"    if data[o + {length}]:")
        self.add("        raise ValueError")
        self.add(f"    out.append(data[o:o + {length}])")
        self.add("    o += n")

    def copy(self, count: str, element: _Chunk) -> None:
        self.add(f"if {count}:")
        if element.align > 4:
            self.add("    o += -o & 7")
        self.add(f"    {count} *= {element.size}")
        self.add(f"    out.append(data[o:o + {count}])")
        self.add(f"    o += {count}")

    def guard(self, count: str, field: Field) -> None:
        least = 4 if field.type == "string" else self.converters.of(field.type).least // 2
        limit = f"(len(data) - o) // {least}" if least else str(MOST_ELEMENTS)
        self.add(f"if {count} > {limit}:")
        self.add("    raise ValueError")

    def call(self, nested: Converter) -> None:
        self.add(f"o = {self.constant(nested.from_cdr_function)}(data, o, out)")
