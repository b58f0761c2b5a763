"""The source of the functions that `fibws.interfaces.serialization` compiles.

For each message type there is one function that checks bytes, one that writes and one that reads
messages. Adjacent numbers share one `struct.Struct`, and small nested messages are written out in
place. For ``geometry_msgs/PointStamped`` as a dict, the function that reads is

    def function(data, o, errors):
        v4, v6, v7, v9, = v10(data, o)              # seq, secs, nsecs, length of frame_id
        begin = o + 16
        o = begin + v9
        v8 = str(data[begin:o], "utf-8", errors)
        v11, v12, v13, = v14(data, o)
        o += 24
        return {'header': {...}, 'point': {'x': v11, 'y': v12, 'z': v13}}, o

Offsets only grow, so the caller finds out by one comparison whether a slice went past the end.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import lru_cache
from math import nan
from struct import Struct, calcsize, pack, unpack_from
from struct import error as StructError
from typing import Any, Final, NamedTuple, Protocol, TypeAlias

from fibws.interfaces import base64text, builtin
from fibws.interfaces.definition import Array, Field, MessageDefinition
from fibws.interfaces.message import Message, ObjectStyle

Function: TypeAlias = Callable[..., Any]
"""A compiled function."""

LETTERS: Final = {
    "bool": "?",
    "int8": "b",
    "uint8": "B",
    "int16": "h",
    "uint16": "H",
    "int32": "i",
    "uint32": "I",
    "int64": "q",
    "uint64": "Q",
    "byte": "b",
    "char": "B",
    "float32": "f",
    "float64": "d",
}
"""The format character of `struct` for each builtin type of a fixed size."""

MOST_WITHOUT_BYTES: Final = 2**16
"""How many values without bytes, such as empty messages, a message's arrays may hold in all: a few
bytes could fill the memory."""

WEIGHT_OF_MESSAGE: Final = 500
WEIGHT_OF_STRING: Final = 150
WEIGHT_OF_NUMBER: Final = {1: 18, 2: 60, 4: 60, 8: 60}
"""By the size of an integer: those of one byte make no new objects in Python."""
WEIGHT_OF_FLOAT: Final = 120
"""Nanoseconds to make an object of each kind, and then its JSON."""

_INLINED: Final = 32
"""A nested message with more values than this has functions of its own."""


class Type(Protocol):
    """A message type whose functions are compiled."""

    definition: MessageDefinition
    layout: Layout

    def weigh_function(self, *, numbers: bool) -> Function:
        """The compiled function that raises ValueError if messages weigh too much."""

    @property
    def check_function(self) -> Function:
        """Takes bytes and an offset; returns the offset behind the message."""

    @property
    def write_function(self) -> Function:
        """Takes a dict and a list; appends bytes to the list."""

    @property
    def read_function(self) -> Function:
        """Takes bytes, an offset and an error handler; returns a dict and the offset behind it."""

    @property
    def cbor_function(self) -> Function:
        """The same, except that arrays of numbers are as `CborDicts` says."""


class CodecTypes(Protocol):
    """All message types."""

    def of(self, name: str) -> Type:
        """The message type of that name."""


class Layout(NamedTuple):
    """How many bytes and values a message, a field or an element of an array has.

    Attributes:
        size: the number of bytes, if it is fixed.
        least: the smallest number of bytes.
        values: the number of values; the elements of an array count as one.
        free: the number of values that need no bytes, without those of arrays of no fixed size.
        counted: whether there are arrays of no fixed size whose elements have an ``excess``.
        loops: whether there are arrays whose elements are visited one by one.
    """

    size: int | None
    least: int
    values: int = 1
    free: int = 0
    counted: bool = False
    loops: bool = False

    @property
    def excess(self) -> int:
        """The number of values that is not in proportion to the number of bytes."""
        return max(0, self.free - self.least)

    @classmethod
    def of(cls, definition: MessageDefinition, types: CodecTypes) -> Layout:
        """The layout of a message."""
        layouts = [cls.of_field(field, types) for field in definition.fields]
        least = sum(layout.least for layout in layouts)
        return cls(
            None if any(layout.size is None for layout in layouts) else least,
            least,
            sum(layout.values for layout in layouts),
            sum(layout.free for layout in layouts) if layouts else 1,
            any(layout.counted for layout in layouts),
            any(layout.loops for layout in layouts),
        )

    @classmethod
    def of_field(cls, field: Field, types: CodecTypes) -> Layout:
        """The layout of a field."""
        element = cls.of_element(field, types)
        if field.array is None:
            return element
        count, loops = field.array.fixed, field.type not in LETTERS
        if count is None:
            return cls(None, 4, 1, 0, element.counted or element.excess > 0, loops)
        size = None if element.size is None and count else count * element.least
        free = count * element.free or int(count == 0)
        return cls(size, count * element.least, 1, free, element.counted, loops)

    @classmethod
    def of_element(cls, field: Field, types: CodecTypes) -> Layout:
        """The layout of a field, or of one of its elements if it is an array."""
        if field.is_nested:
            return types.of(field.type).layout
        if field.type in builtin.STRINGS:
            return cls(None, 4)
        if field.type in builtin.TIMES:
            return cls(8, 8, 2)
        size = calcsize(f"<{LETTERS[field.type]}")
        return cls(size, size)


class _Code:
    """The source of one function, which is written line by line.

    In a generated function ``data`` are the bytes, ``o`` is the offset of the next value, and
    ``left`` holds the number of values without bytes that are still allowed.
    """

    parameters = ""

    def __init__(self, layout: Layout, types: CodecTypes) -> None:
        self.types = types
        self.lines: list[str] = []
        self._indent = "    "
        self._names: dict[str, Any] = {
            "limit": _limit,
            "new": object.__new__,
            "read_uint32": Struct("<I").unpack_from,
            "spend": _spend,
            "unpack_from": unpack_from,
        }
        self._counted = layout.counted
        if layout.counted:
            self.add("if left is None:")
            self.add(f"    left = [{MOST_WITHOUT_BYTES}]")

    def add(self, line: str) -> None:
        """Add a line."""
        self.lines.append(self._indent + line)

    @contextmanager
    def block(self) -> Iterator[None]:
        """Indent the lines that are added inside."""
        indent, self._indent = self._indent, f"{self._indent}    "
        yield
        self._indent = indent

    def local(self) -> str:
        """A new local variable."""
        return self.constant(None)

    def constant(self, value: Any) -> str:
        """A new name for a value."""
        name = f"v{len(self._names)}"
        self._names[name] = value
        return name

    def inlines(self, layout: Layout) -> bool:
        """Whether a nested message is written out here, rather than by a call."""
        is_in_loop = len(self._indent) > 4  # Python limits how deep loops may be nested.
        return layout.values <= _INLINED and not (is_in_loop and layout.loops)

    def guard(self, count: str | int, element: Layout) -> None:
        """Refuse a count of elements that cannot fit, before any memory is used for them."""
        if isinstance(count, int):
            return
        if element.least:
            self.add(f"if {count} * {element.least} > len(data) - o:")
            self.add("    raise ValueError")
        self.spend(count, element)

    def bound(self, count: str | int, array: Array) -> None:
        """Refuse more elements than a bound of ROS 2 allows."""
        if array.bounded:
            self.add(f"if {count} > {array.size}:")
            self.add("    raise ValueError")

    def spend(self, count: str, element: Layout) -> None:
        """Count the values of elements that need no bytes."""
        if element.excess:
            self.add(f"spend(left, {count} * {element.excess})")

    def function(self, type_: str, result: str = "") -> Function:
        """Compile the function; ``result`` is the expression that it returns."""
        left = ", left=None" if self._counted else ""
        if result:
            self.add(f"return {result}")
        lines = self.lines or ["    pass"]
        source = "\n".join([f"def function({self.parameters}{left}):", *lines])
        exec(compile(source, f"<serialization of {type_}>", "exec"), self._names)
        function: Function = self._names["function"]
        return function


class _Checker(_Code):
    """The source of a function that finds out where a message ends."""

    parameters = "data, o"
    skip = 0
    """The number of bytes behind ``o`` that are already accounted for."""

    def message(self, definition: MessageDefinition) -> None:
        """Check the fields of a message."""
        for field in definition.fields:
            self._field(field)

    def _field(self, field: Field) -> None:
        layout = Layout.of_field(field, self.types)
        if layout.size is not None:
            self.skip += layout.size
            return
        if field.array is None:
            self._element(field)
            return
        element = Layout.of_element(field, self.types)
        count: str | int | None = field.array.fixed
        if count is None:
            count = self.local()
            self.add(f"{count} = {self._length()}")
            self.bound(count, field.array)
            self.weigh(count, field)
            if element.size is not None:
                self.spend(count, element)
                self.add(f"o += {count} * {element.size} + {self.skip}")
                self.skip = 0
                return
        self.settle()
        self.guard(count, element)
        self.add(f"for _ in range({count}):")
        with self.block():
            self._element(field)
            self.settle()

    def _element(self, field: Field) -> None:
        if not field.is_nested:
            length = self._length()
            if field.limit is not None:
                expression, length = length, self.local()
                self.add(f"{length} = {expression}")
                self.add(f"if {length} > {field.limit}:")
                self.add(f"    limit(data, o + {self.skip}, {length}, {field.limit})")
            self.add(f"o += {length} + {self.skip}")
            self.skip = 0
            return
        nested = self.types.of(field.type)
        if self.inlines(nested.layout):
            self.message(nested.definition)
            return
        self.settle()
        self.call(nested)

    def call(self, nested: Type) -> None:
        """Check a nested message by its own function."""
        left = ", left" if nested.layout.counted else ""
        self.add(f"o = {self.constant(nested.check_function)}(data, o{left})")

    def weigh(self, count: str, field: Field) -> None:
        """Add lines that weigh the elements of an array of no fixed size."""

    def _length(self) -> str:
        """The expression for the length that comes next."""
        self.skip += 4
        offset = f"o + {self.skip - 4}" if self.skip > 4 else "o"
        return f"read_uint32(data, {offset})[0]"

    def settle(self) -> None:
        """Let ``o`` be the offset of the next value."""
        if self.skip:
            self.add(f"o += {self.skip}")
        self.skip = 0


class _Scales(_Checker):
    """The source of a function that raises ValueError for checked bytes of too much weight.

    It takes the weight off ``left`` as in `weight`, that of arrays of no fixed size only.

    Args:
        numbers: whether numbers have any weight: in CBOR, arrays of them stay bytes.
    """

    parameters = "data, o, left"

    def __init__(self, layout: Layout, types: CodecTypes, *, numbers: bool) -> None:
        super().__init__(layout._replace(counted=False), types)
        self._numbers = numbers

    def call(self, nested: Type) -> None:
        """Weigh a nested message by its own function."""
        function = nested.weigh_function(numbers=self._numbers)
        self.add(f"o = {self.constant(function)}(data, o, left)")

    def weigh(self, count: str, field: Field) -> None:
        """Subtract the weight of an array's elements from the remaining budget."""
        each = 0 if field.is_bytes else weight(field.type, self.types, numbers=self._numbers)
        if each:
            self.add(f"spend(left, {count} * {each})")

    def spend(self, count: str, element: Layout) -> None:
        """Do nothing: elements without bytes have been weighed."""


def weight(type_: str, types: CodecTypes, *, numbers: bool) -> int:
    """Return about how many nanoseconds it takes to make a value of a type, and then its text.

    Arrays of no fixed size count as empty.

    Args:
        type_: of a field, or of one element of its array.
        numbers: whether numbers count.
    """
    if type_ in builtin.STRINGS:
        return WEIGHT_OF_STRING
    if type_ in builtin.TIMES:
        return WEIGHT_OF_MESSAGE
    if type_ in builtin.FLOATS:
        return numbers * WEIGHT_OF_FLOAT
    if type_ in LETTERS:
        return numbers * WEIGHT_OF_NUMBER[calcsize(f"<{LETTERS[type_]}")]
    total = WEIGHT_OF_MESSAGE
    for field in types.of(type_).definition.fields:
        count = 1 if field.array is None else field.fixed_size
        total += 0 if field.is_bytes else count * weight(field.type, types, numbers=numbers)
    return total


class Dicts:
    """The source of how dicts stand for messages, as `MessageValidator.validate` returns them."""

    checked = False
    """Whether a value that is written may be of a wrong type."""

    def __init__(self, types: CodecTypes) -> None:
        self._types = types

    def nested(self, field: Field) -> Dicts:
        """How the messages in a field are represented."""
        return self

    def nested_function(self, field: Field, name: str) -> Function:
        """The function that reads or writes a message in the field."""
        function: Function = getattr(self._types.of(field.type), name)
        return function

    def expect(self, code: _Code, value: str, type_: str | None = None) -> None:
        """Add lines that refuse a value of another class, for a message or a type of time."""

    def member(self, message: str, field: Field) -> str:
        """The expression for a field of a message."""
        return f"{message}[{field.name!r}]"

    def parts(self, time: str) -> tuple[str, str]:
        """The expressions for the two numbers of a time."""
        return f"{time}['secs']", f"{time}['nsecs']"

    def packer(self, field: Field) -> Callable[[Any], Any]:
        """The function that makes bytes of an array of numbers."""
        return base64text.decode if field.is_bytes else _list_packer(LETTERS[field.type])

    def message(self, code: _Code, values: list[tuple[Field, str]]) -> str:
        """Add lines that make a message of its fields; return the expression for it."""
        return f"{{{', '.join(f'{field.name!r}: {value}' for field, value in values)}}}"

    def time(self, code: _Code, type_: str, secs: str, nsecs: str) -> str:
        """Add lines that make a time; return the expression for it."""
        return f"{{'secs': {secs}, 'nsecs': {nsecs}}}"

    def numbers(self, code: _Code, field: Field, count: str | int) -> str:
        """The expression for an array of numbers, whose bytes are ``data[begin:o]``."""
        if field.is_bytes:
            return f"{code.constant(base64text.encode)}(data[begin:o])"
        return f"list({_unpacked(field, count)})"


class CborDicts(Dicts):
    """The same, except that arrays of numbers are encoded as byte strings."""

    def nested_function(self, field: Field, name: str) -> Function:
        return self._types.of(field.type).cbor_function

    def numbers(self, code: _Code, field: Field, count: str | int) -> str:
        from cbor2 import CBORTag

        from fibws.interfaces.cbor import TYPED_ARRAYS

        if field.is_bytes:
            return "bytes(data[begin:o])"
        if field.type not in TYPED_ARRAYS:
            return super().numbers(code, field, count)
        tag, _ = TYPED_ARRAYS[field.type]
        return f"{code.constant(CBORTag)}({tag}, bytes(data[begin:o]))"


class Objects(Dicts):
    """The source of how objects of a message class stand for messages."""

    checked = True

    def __init__(
        self,
        message_class: type[Message],
        style: ObjectStyle,
        codec_of: Callable[[type[Message]], Any],
    ) -> None:
        self._class = message_class
        self._style = style
        self._codec_of = codec_of

    def nested(self, field: Field) -> Objects:
        nested = self._class._nested_class(field.name)
        return Objects(nested, self._style, self._codec_of)

    def nested_function(self, field: Field, name: str) -> Function:
        codec = self._codec_of(self._class._nested_class(field.name))
        function: Function = getattr(codec, name)
        return function

    def member(self, message: str, field: Field) -> str:
        attribute = self._style.attribute(field.name)
        assert attribute.isidentifier(), attribute
        return f"{message}.{attribute}"

    def parts(self, time: str) -> tuple[str, str]:
        return f"{time}.secs", f"{time}.nsecs"

    def packer(self, field: Field) -> Callable[[Any], Any]:
        return _as_bytes if field.is_bytes else _number_packer(LETTERS[field.type])

    def expect(self, code: _Code, value: str, type_: str | None = None) -> None:
        if self._style.exact:
            expected = self._class if type_ is None else self._style.times[type_]
            code.add(f"if {value}.__class__ is not {code.constant(expected)}:")
            code.add("    raise TypeError")

    def message(self, code: _Code, values: list[tuple[Field, str]]) -> str:
        message = code.local()
        code.add(f"{message} = new({code.constant(self._class)})")
        for field, value in values:
            code.add(f"{self.member(message, field)} = {value}")
        return message

    def time(self, code: _Code, type_: str, secs: str, nsecs: str) -> str:
        time = code.local()
        code.add(f"{time} = new({code.constant(self._style.times[type_])})")
        code.add(f"{time}.secs = {secs}")
        code.add(f"{time}.nsecs = {nsecs}")
        code.add(f"if not 0 <= {nsecs} < 1000000000:")
        code.add(f"    {time}.{self._style.carry}()")
        return time

    def numbers(self, code: _Code, field: Field, count: str | int) -> str:
        if field.is_bytes:
            return "bytes(data[begin:o])"
        if self._style.arrays == "numpy":
            import numpy

            name = code.constant(numpy.frombuffer)
            return f'{name}(bytes(data[begin:o]), "<{LETTERS[field.type]}")'
        if self._style.arrays == "tuple" and field.type != "bool":
            return _unpacked(field, count)
        return f"list({_unpacked(field, count)})"


def _unpacked(field: Field, count: str | int) -> str:
    """The expression for the tuple of an array's numbers."""
    return f'unpack_from(f"<{{{count}}}{LETTERS[field.type]}", data, begin)'


class _Writer(_Code):
    """The source of a function that appends a message's bytes to a list."""

    parameters = "m, out"

    def __init__(self, layout: Layout, types: CodecTypes) -> None:
        super().__init__(layout._replace(counted=False), types)
        self._numbers: list[tuple[str, str]] = []
        self._pieces: list[str] = []

    def message(self, definition: MessageDefinition, form: Dicts, value: str) -> None:
        """Write the fields of a message."""
        form.expect(self, value)
        for field in definition.fields:
            self._field(field, form, form.member(value, field))

    def _field(self, field: Field, form: Dicts, value: str) -> None:
        if field.array is None:
            self._element(field, form, value)
            return
        array, size = self.local(), 1
        if field.type in LETTERS:
            size = calcsize(f"<{LETTERS[field.type]}")
            value = f"{self.constant(form.packer(field))}({value})"
        self.add(f"{array} = {value}")
        if form.checked and field.type not in LETTERS:
            self.add(f"if {array}.__class__ is not list and {array}.__class__ is not tuple:")
            self.add("    raise TypeError")
        if form.checked and field.array.size is not None:
            compare = ">" if field.array.bounded else "!="
            self.add(f"if len({array}) {compare} {field.array.size * size}:")
            self.add("    raise ValueError")
        if field.array.fixed is None:
            self._numbers.append(("I", f"len({array})" + (f" // {size}" if size > 1 else "")))
        if field.type in LETTERS:
            self._piece(array)
            return
        self.flush()
        element = self.local()
        self.add(f"for {element} in {array}:")
        with self.block():
            start = len(self.lines)
            self._element(field, form, element)
            self.flush()
            if len(self.lines) == start:
                self.add("pass")

    def _element(self, field: Field, form: Dicts, value: str) -> None:
        if field.is_nested:
            self._nested(field, form, value)
        elif field.type in builtin.STRINGS:
            text = self.local()
            if form.checked and field.limit is not None:
                self.add(f"if len({value}) > {field.limit}:")
                self.add("    raise ValueError")
            self.add(f"{text} = {value}.encode()")
            self._numbers.append(("I", f"len({text})"))
            self._piece(text)
        elif field.type in builtin.TIMES:
            time, letter = self.local(), LETTERS[builtin.TIMES[field.type]]
            self.add(f"{time} = {value}")
            form.expect(self, time, field.type)
            self._numbers += [(letter, part) for part in form.parts(time)]
        else:
            if form.checked and field.type == "bool":  # struct takes anything for a bool.
                flag = self.local()
                self.add(f"{flag} = {value}")
                self.add(f"if {flag} is not True and {flag} is not False:")
                self.add("    raise TypeError")
                value = flag
            self._numbers.append((LETTERS[field.type], value))

    def _nested(self, field: Field, form: Dicts, value: str) -> None:
        nested = self.types.of(field.type)
        if self.inlines(nested.layout):
            message = self.local()
            self.add(f"{message} = {value}")
            self.message(nested.definition, form.nested(field), message)
        else:
            self.flush()
            self.add(
                f"{self.constant(form.nested_function(field, 'write_function'))}({value}, out)"
            )

    def _piece(self, value: str) -> None:
        """Write bytes as they are."""
        self._pack()
        self._pieces.append(value)

    def _pack(self) -> None:
        if self._numbers:
            struct = Struct("<" + "".join(letter for letter, _ in self._numbers))
            values = ", ".join(value for _, value in self._numbers)
            self._pieces.append(f"{self.constant(struct.pack)}({values})")
            self._numbers = []

    def flush(self) -> None:
        """Append the lines written so far."""
        self._pack()
        if len(self._pieces) == 1:
            self.add(f"out.append({self._pieces[0]})")
        elif self._pieces:
            self.add(f"out += ({', '.join(self._pieces)})")
        self._pieces = []


_Make: TypeAlias = Callable[[], str]
"""Adds the lines that convert a value that was read; returns the expression for it."""


class _ReaderCode(_Code):
    """The source of a function that reads a message, and finds out where it ends."""

    parameters = "data, o, errors"

    def __init__(self, layout: Layout, types: CodecTypes) -> None:
        super().__init__(layout, types)
        self._numbers: list[tuple[str, str]] = []
        self._skip = 0

    def message(self, definition: MessageDefinition, form: Dicts) -> _Make:
        """Read the fields of a message."""
        fields = [(field, self._field(field, form)) for field in definition.fields]
        return lambda: form.message(self, [(field, make()) for field, make in fields])

    def _field(self, field: Field, form: Dicts) -> _Make:
        if field.array is None:
            return self._element(field, form)
        count: str | int = self._number("I") if field.array.fixed is None else field.array.fixed
        values = self.local()
        if field.type in LETTERS:
            self._take(f"{count} * {calcsize('<' + LETTERS[field.type])}")
            self.bound(count, field.array)
            self.add(f"{values} = {form.numbers(self, field, count)}")
            return lambda: values
        self.settle()
        self.bound(count, field.array)
        element = Layout.of_element(field, self.types)
        self.guard(count, element)
        self.add(f"{values} = []")
        lines, self.lines = self.lines, []
        with self.block():
            make = self._element(field, form)
            struct, targets = self._group()
            flat = struct.size > 0 and not self.lines
            if not flat:
                self._unpack(struct, targets)
                self.settle()
            self.add(f"{values}.append({make()})")
        body, self.lines = self.lines, lines
        if flat:  # One call unpacks all elements.
            self._take(f"{count} * {struct.size}")
            self.add(f"for {targets} in {self.constant(struct.iter_unpack)}(data[begin:o]):")
        else:
            self.add(f"for _ in range({count}):")
        self.lines += body
        return lambda: values

    def _element(self, field: Field, form: Dicts) -> _Make:
        if field.is_nested:
            return self._nested(field, form)
        value = self.local()
        if field.type in builtin.STRINGS:
            self._take(self._number("I"))
            self.add(f'{value} = str(data[begin:o], "utf-8", errors)')
            if field.limit is not None:
                self.add(f"if len({value}) > {field.limit}:")
                self.add("    raise ValueError")
            return lambda: value
        if field.type in builtin.TIMES:
            letter = LETTERS[builtin.TIMES[field.type]]
            secs, nsecs = self._number(letter), self._number(letter)
            return lambda: form.time(self, field.type, secs, nsecs)
        number = self._number(LETTERS[field.type])
        return lambda: number

    def _nested(self, field: Field, form: Dicts) -> _Make:
        nested = self.types.of(field.type)
        if self.inlines(nested.layout):
            return self.message(nested.definition, form.nested(field))
        self.settle()
        value, function = self.local(), self.constant(form.nested_function(field, "read_function"))
        left = ", left" if nested.layout.counted else ""
        self.add(f"{value}, o = {function}(data, o, errors{left})")
        return lambda: value

    def _number(self, letter: str) -> str:
        """Read a number into a new variable."""
        number = self.local()
        self._numbers.append((letter, number))
        return number

    def _group(self) -> tuple[Struct, str]:
        """The struct of the numbers to be unpacked next, and the variables for them."""
        struct = Struct("<" + "".join(letter for letter, _ in self._numbers))
        targets = "".join(f"{variable}, " for _, variable in self._numbers)
        self._numbers = []
        return struct, targets

    def _unpack(self, struct: Struct, targets: str) -> None:
        if targets:
            self.add(f"{targets}= {self.constant(struct.unpack_from)}(data, o)")
            self._skip = struct.size

    def _take(self, size: str) -> None:
        """Let ``begin`` and ``o`` be the offsets of the beginning and the end of the next bytes."""
        self._unpack(*self._group())
        self.add(f"begin = o + {self._skip}")
        self.add(f"o = begin + {size}")
        self._skip = 0

    def settle(self) -> None:
        """Let ``o`` be the offset of the next value."""
        self._unpack(*self._group())
        if self._skip:
            self.add(f"o += {self._skip}")
        self._skip = 0


def compile_check(type_: Type, types: CodecTypes) -> Function:
    """Compile the function that checks messages."""
    checker = _Checker(type_.layout, types)
    checker.message(type_.definition)
    checker.settle()
    return checker.function(type_.definition.type, "o")


def compile_weigh(type_: Type, types: CodecTypes, *, numbers: bool) -> Function:
    """Compile the function that weighs checked messages; see `weight`."""
    scales = _Scales(type_.layout, types, numbers=numbers)
    scales.message(type_.definition)
    scales.settle()
    return scales.function(type_.definition.type, "o")


def compile_write(type_: Type, types: CodecTypes, form: Dicts) -> Function:
    """Compile the function that writes messages of a form."""
    writer = _Writer(type_.layout, types)
    writer.message(type_.definition, form, "m")
    writer.flush()
    return writer.function(type_.definition.type)


def compile_read(type_: Type, types: CodecTypes, form: Dicts) -> Function:
    """Compile the function that reads messages of a form."""
    reader = _ReaderCode(type_.layout, types)
    make = reader.message(type_.definition, form)
    reader.settle()
    return reader.function(type_.definition.type, f"{make()}, o")


# The functions that the generated code calls.


def characters(data: Any) -> int:
    """Return how many characters a string's bytes are, whose validity does not matter."""
    return len(str(data, "utf-8", "replace"))


def _limit(data: Any, offset: int, size: int, most: int) -> None:
    """Raise ValueError for a string of more characters than its bound."""
    if characters(memoryview(data)[offset : offset + size]) > most:
        raise ValueError


def _spend(left: list[int], count: int) -> None:
    left[0] -= count
    if left[0] < 0:
        raise ValueError


def with_nan(value: Any) -> Any:
    """The value with NaN for every None in it."""
    if isinstance(value, dict):
        return {name: with_nan(member) for name, member in value.items()}
    if isinstance(value, list):
        return [with_nan(element) for element in value]
    return nan if value is None else value


@lru_cache
def _list_packer(letter: str) -> Callable[[list[Any]], bytes]:
    """Return a function from valid lists of numbers to bytes; None stands for NaN."""

    def packed(values: list[Any]) -> bytes:
        try:
            return pack(f"<{len(values)}{letter}", *values)
        except StructError:
            filled = [nan if value is None else value for value in values]
            return pack(f"<{len(values)}{letter}", *filled)

    return packed


@lru_cache
def _number_packer(letter: str) -> Callable[[Any], bytes | memoryview]:
    """Return a function from arrays of numbers to bytes, which refuses other values."""
    kind = next(kind for kind in ("bhilq", "BHILQ", "fd", "?") if letter in kind)
    alike = {other for other in kind if calcsize(other) == calcsize(f"<{letter}")}
    native = alike if sys.byteorder == "little" else set[str]()

    def packed(values: Any) -> bytes | memoryview:
        if values.__class__ is not list and values.__class__ is not tuple:
            view = memoryview(values)
            if view.ndim != 1 or view.format not in native:
                raise TypeError
            return view.cast("B") if view.c_contiguous else view.tobytes()
        if letter == "?" and not all(value is True or value is False for value in values):
            raise TypeError
        return pack(f"<{len(values)}{letter}", *values)

    return packed


def _as_bytes(values: Any) -> bytes | memoryview:
    if values.__class__ is bytes:
        return values
    view = memoryview(values)
    if view.format != "B":  # The bytes of other arrays are not their elements.
        raise TypeError
    return view.cast("B") if view.c_contiguous else view.tobytes()
