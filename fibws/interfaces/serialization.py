"""ROS 1's serialization (http://wiki.ros.org/msg), compiled for each message type.

`Serializer` converts between bytes and the dicts that `MessageValidator.validate` returns;
`class_codec` converts between bytes and objects of a message class, without a dict in between.

All numbers are little-endian. A string or an array without a fixed size has its length before it as
a uint32; fields follow each other without padding. For every type, functions are generated as
Python source when they are first needed, as `dataclasses` does it: one that checks, one that writes
and one that reads. Adjacent numbers share one `struct.Struct`, small nested messages are inlined.

The generated functions only notice that bytes are invalid. `_Diagnosis` then walks through the
fields again to find out where and why.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import cached_property, lru_cache
from math import nan
from struct import Struct, calcsize, pack, unpack_from
from struct import error as StructError
from typing import Any, Final, Generic, NamedTuple, TypeAlias, TypeVar

from fibws.errors import InvalidMessage
from fibws.interfaces import base64text, builtin
from fibws.interfaces.catalogue import Interfaces
from fibws.interfaces.definition import Field, MessageDefinition
from fibws.interfaces.linker import MOST_VALUES
from fibws.interfaces.message import Message, ObjectStyle
from fibws.interfaces.validators import Validators

M = TypeVar("M", bound=Message)

Buffer: TypeAlias = bytes | bytearray | memoryview
"""The bytes of a message. A memoryview must be contiguous and of format ``B``."""

_LETTERS: Final = {
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

_INLINED = 32
"""A nested message with more values than this has functions of its own."""

_DIAGNOSED = 100_000
"""How many fields and elements are visited to find out which one is invalid."""

_Function: TypeAlias = Callable[..., Any]
"""A compiled function."""


class Serializers:
    """The serializers of all types, each made when first asked for."""

    def __init__(self, interfaces: Interfaces) -> None:
        self.interfaces = interfaces
        self._by_name: dict[str, Serializer] = {}

    def of(self, name: str) -> Serializer:
        """The serializer of a message type; raises as `Interfaces.message` does."""
        definition = self.interfaces.message(name)
        found = self._by_name.get(definition.type)
        if found is None or found.definition is not definition:
            self._by_name[definition.type] = found = self.of_definition(definition)
        return found

    def of_definition(self, definition: MessageDefinition) -> Serializer:
        """A new serializer of a message without a name of its own, such as a service's request."""
        return Serializer(definition, self)


class Serializer:
    """Checks, serializes and deserializes the messages of one type.

    Attributes:
        type: the type's name, ``package/Type``.
        size: the number of bytes of every message, or None if it varies.
    """

    def __init__(self, definition: MessageDefinition, serializers: Serializers) -> None:
        self.type = definition.type
        self.definition = definition
        self.serializers = serializers
        self.layout = _Layout.of(definition, serializers)
        self.size = self.layout.size

    def check(self, data: Buffer) -> None:
        """Check that the bytes can be deserialized, without decoding them.

        Strings need not be UTF-8, and the bounds of ROS 2 are not checked.

        Raises:
            InvalidMessage: the text names the field and says what was expected.
        """
        if len(data) == self.size:
            return
        try:
            end = self._check(data, 0)
        except (StructError, ValueError, OverflowError):
            raise self._fault(data) from None
        if end < len(data):
            raise InvalidMessage(f"invalid bytes for {self.type}: {len(data) - end} bytes too many")
        if end > len(data):
            raise self._fault(data)

    def serialize(self, values: dict[str, Any]) -> bytes:
        """The bytes of a message as returned by `MessageValidator.validate`."""
        pieces: list[Any] = []
        try:
            self._write(values, pieces)
        except StructError:  # None stands for NaN.
            pieces = []
            self._write(_with_nan(values), pieces)
        return b"".join(pieces)

    def deserialize(self, data: Buffer, errors: str = "strict") -> dict[str, Any]:
        """The message as returned by `MessageValidator.validate`; NaN is NaN.

        Args:
            data: the bytes.
            errors: what to do about strings that are not UTF-8, as in `bytes.decode`.

        Raises:
            InvalidMessage: the text names the field and says what was expected.
            UnicodeDecodeError: ``errors`` is ``strict``, and a string is not UTF-8. Everything else
                is valid, so that another call with ``replace`` succeeds.
        """
        message: dict[str, Any] = self.read(self._read, data, errors)
        return message

    def to_cbor(self, data: Buffer, errors: str = "strict") -> bytes:
        """The message as CBOR, as `CborEncoder.encode` writes it; raises as `deserialize` does."""
        import cbor2

        return cbor2.dumps(self.read(self._read_for_cbor, data, errors))

    def read(self, function: _Function, data: Buffer, errors: str) -> Any:
        """The message as a compiled function reads it; raises as `deserialize` does."""
        if type(data) is not bytes:
            data = memoryview(data)
        try:
            message, end = function(data, 0, errors)
        except (StructError, ValueError, OverflowError):
            self.check(data)
            raise  # a UnicodeDecodeError
        if end != len(data):
            self.check(data)
        return message

    def _fault(self, data: Buffer) -> InvalidMessage:
        """The error for invalid bytes."""
        try:
            _Diagnosis(data, self.serializers).message(self.definition)
        except _Fault as fault:
            return InvalidMessage(f"invalid bytes for {self.type}: {fault.path}: {fault}")
        raise AssertionError(f"found nothing wrong with these bytes of {self.type}")

    @cached_property
    def _check(self) -> _Function:
        checker = _Checker(self.layout, self.serializers)
        checker.message(self.definition)
        return checker.function(self.type, f"o + {checker.skip}")

    @cached_property
    def _write(self) -> _Function:
        return _compile_write(self, _Dicts(self.serializers))

    @cached_property
    def _read(self) -> _Function:
        return _compile_read(self, _Dicts(self.serializers))

    @cached_property
    def _read_for_cbor(self) -> _Function:
        return _compile_read(self, _CborDicts(self.serializers))


class ClassCodec(Generic[M]):
    """Serializes and deserializes the objects of one message class.

    Args:
        message_class: the class.
        interfaces: where the definitions of its type and of nested types are looked up.
        style: how objects of the class look.
    """

    def __init__(self, message_class: type[M], interfaces: Interfaces, style: ObjectStyle) -> None:
        self.message_class = message_class
        self._interfaces = interfaces
        self._style = style

    def serialize(self, message: M) -> bytes:
        """The message's bytes.

        Arrays of numbers may be lists, tuples, or anything with a buffer (`array.array`, numpy's
        arrays, memoryviews); a buffer whose elements have the field's type is copied as it is.

        Raises:
            InvalidMessage: a value does not fit its field; the text names the field.
        """
        pieces: list[Any] = []
        try:
            self._write(message, pieces)
            return b"".join(pieces)
        except Exception:
            # Validation names the field, unless it accepts the value: numpy's bools, for example.
            return self._serializer.serialize(self._validate(message.to_dict()))

    def deserialize(self, data: Buffer) -> M:
        """The message. In strings that are not UTF-8, U+FFFD replaces what is invalid.

        Arrays of uint8 are `bytes`, other arrays of numbers as the class's `ObjectStyle` says.

        Raises:
            InvalidMessage: the text names the field and says what was expected.
        """
        read = self._serializer.read
        try:
            message: M = read(self._read, data, "strict")
        except UnicodeDecodeError as error:
            if self._style.on_invalid_text is not None:
                self._style.on_invalid_text(self.message_class, error)
            message = read(self._read, data, "replace")
        return message

    @cached_property
    def _serializer(self) -> Serializer:
        definition = self.message_class._definition_in(self._interfaces)
        return _serializers_of(self._interfaces).of_definition(definition)

    @cached_property
    def _validate(self) -> Callable[[object], dict[str, Any]]:
        # `to_dict` returns all fields, so no time is ever needed.
        validators = Validators(self._interfaces, now=int)
        return validators.of_definition(self._serializer.definition).validate

    @cached_property
    def _form(self) -> _Objects:
        return _Objects(self.message_class, self._interfaces, self._style)

    @cached_property
    def _write(self) -> _Function:
        return _compile_write(self._serializer, self._form)

    @cached_property
    def _read(self) -> _Function:
        return _compile_read(self._serializer, self._form)


def class_codec(
    message_class: type[M], interfaces: Interfaces | None = None, style: ObjectStyle | None = None
) -> ClassCodec[M]:
    """The codec of a message class; it is made once, and compiled when it is first used.

    Args:
        message_class: a class that fibws generated, or one of genpy.
        interfaces: where the definition is looked up; by default where the class says.
        style: how objects of the class look; by default as the class says.
    """
    codecs: dict[Any, ClassCodec[M]] | None = message_class.__dict__.get("_codecs")
    if codecs is None:
        message_class._codecs = codecs = {}
    if interfaces is None:
        interfaces = message_class._find_interfaces()
    key = (interfaces, style)
    if key not in codecs:
        codecs[key] = message_class._make_codec(interfaces, style or message_class._style)
    return codecs[key]


@lru_cache(maxsize=8)
def _serializers_of(interfaces: Interfaces) -> Serializers:
    return Serializers(interfaces)


class _Layout(NamedTuple):
    """How many bytes and values a message, a field or an element of an array has.

    Attributes:
        size: the number of bytes, if it is fixed.
        least: the smallest number of bytes.
        values: the number of values; the elements of an array count as one.
        free: the number of values that need no bytes, without those of arrays of no fixed size.
        counted: whether there are arrays of no fixed size whose elements have ``free`` values.
        loops: whether there are arrays whose elements are visited one by one.
    """

    size: int | None
    least: int
    values: int = 1
    free: int = 0
    counted: bool = False
    loops: bool = False

    @classmethod
    def of(cls, definition: MessageDefinition, serializers: Serializers) -> _Layout:
        """The layout of a message."""
        layouts = [cls.of_field(field, serializers) for field in definition.fields]
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
    def of_field(cls, field: Field, serializers: Serializers) -> _Layout:
        """The layout of a field."""
        element = cls.of_element(field, serializers)
        if field.array is None:
            return element
        count, loops = field.array.fixed, field.type not in _LETTERS
        if count is None:
            return cls(None, 4, 1, 0, element.counted or element.free > 0, loops)
        size = None if element.size is None and count else count * element.least
        free = count * element.free or int(count == 0)
        return cls(size, count * element.least, 1, free, element.counted, loops)

    @classmethod
    def of_element(cls, field: Field, serializers: Serializers) -> _Layout:
        """The layout of a field, or of one of its elements if it is an array."""
        if field.is_nested:
            return serializers.of(field.type).layout
        if field.type in builtin.STRINGS:
            return cls(None, 4)
        if field.type in builtin.TIMES:
            return cls(8, 8, 2)
        size = calcsize(f"<{_LETTERS[field.type]}")
        return cls(size, size)


class _Code:
    """The source of one function, which is written line by line.

    In a generated function ``data`` are the bytes, ``o`` is the offset of what comes next, and
    ``left`` holds the number of values without bytes that are still allowed.
    """

    parameters = ""

    def __init__(self, layout: _Layout, serializers: Serializers) -> None:
        self.serializers = serializers
        self.lines: list[str] = []
        self._indent = "    "
        self._names: dict[str, Any] = {
            "new": object.__new__,
            "read_uint32": Struct("<I").unpack_from,
            "spend": _spend,
            "unpack_from": unpack_from,
        }
        self._counted = layout.counted
        if layout.counted:
            self.add("if left is None:")
            self.add(f"    left = [{MOST_VALUES}]")

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

    def inlines(self, layout: _Layout) -> bool:
        """Whether a nested message is written out here, rather than by a call."""
        is_in_loop = len(self._indent) > 4  # Python limits how deep loops may be nested.
        return layout.values <= _INLINED and not (is_in_loop and layout.loops)

    def guard(self, count: str | int, element: _Layout) -> None:
        """Refuse a count of elements that cannot fit, before any memory is used for them."""
        if isinstance(count, int):
            return
        if element.least:
            self.add(f"if {count} * {element.least} > len(data) - o:")
            self.add("    raise ValueError")
        self.spend(count, element)

    def spend(self, count: str, element: _Layout) -> None:
        """Count the values of elements that need no bytes."""
        if element.free:
            self.add(f"spend(left, {count} * {element.free})")

    def function(self, type_: str, result: str = "") -> _Function:
        """Compile the function; ``result`` is the expression that it returns."""
        left = ", left=None" if self._counted else ""
        if result:
            self.add(f"return {result}")
        lines = self.lines or ["    pass"]
        source = "\n".join([f"def function({self.parameters}{left}):", *lines])
        exec(compile(source, f"<serialization of {type_}>", "exec"), self._names)
        function: _Function = self._names["function"]
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
        layout = _Layout.of_field(field, self.serializers)
        if layout.size is not None:
            self.skip += layout.size
            return
        if field.array is None:
            self._element(field)
            return
        element = _Layout.of_element(field, self.serializers)
        count: str | int | None = field.array.fixed
        if count is None:
            count = self.local()
            self.add(f"{count} = {self._length()}")
            if element.size is not None:
                self.spend(count, element)
                self.add(f"o += {count} * {element.size} + {self.skip}")
                self.skip = 0
                return
        self._settle()
        self.guard(count, element)
        self.add(f"for _ in range({count}):")
        with self.block():
            self._element(field)
            self._settle()

    def _element(self, field: Field) -> None:
        if not field.is_nested:
            length = self._length()
            self.add(f"o += {length} + {self.skip}")
            self.skip = 0
            return
        nested = self.serializers.of(field.type)
        if self.inlines(nested.layout):
            self.message(nested.definition)
            return
        self._settle()
        left = ", left" if nested.layout.counted else ""
        self.add(f"o = {self.constant(nested._check)}(data, o{left})")

    def _length(self) -> str:
        """The expression for the length that comes next."""
        self.skip += 4
        return f"read_uint32(data, o + {self.skip - 4})[0]"

    def _settle(self) -> None:
        if self.skip:
            self.add(f"o += {self.skip}")
        self.skip = 0


class _Dicts:
    """The source of how dicts stand for messages, as `MessageValidator.validate` returns them."""

    checked = False
    """Whether a value that is written may be of a wrong type."""

    def __init__(self, serializers: Serializers) -> None:
        self._serializers = serializers

    def nested(self, field: Field) -> _Dicts:
        """How the messages in a field are represented."""
        return self

    def nested_function(self, field: Field, name: str) -> _Function:
        """The function that reads or writes a message in the field."""
        function: _Function = getattr(self._serializers.of(field.type), name)
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
        return base64text.decode if field.is_bytes else _list_packer(_LETTERS[field.type])

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


class _CborDicts(_Dicts):
    """The same, except that arrays of numbers are encoded as byte strings."""

    def nested_function(self, field: Field, name: str) -> _Function:
        return super().nested_function(field, f"{name}_for_cbor")

    def numbers(self, code: _Code, field: Field, count: str | int) -> str:
        from cbor2 import CBORTag

        from fibws.interfaces.cbor import TYPED_ARRAYS

        if field.is_bytes:
            return "bytes(data[begin:o])"
        if field.type not in TYPED_ARRAYS:
            return super().numbers(code, field, count)
        tag, _ = TYPED_ARRAYS[field.type]
        return f"{code.constant(CBORTag)}({tag}, bytes(data[begin:o]))"


class _Objects(_Dicts):
    """The source of how objects of a message class stand for messages."""

    checked = True

    def __init__(
        self, message_class: type[Message], interfaces: Interfaces, style: ObjectStyle
    ) -> None:
        self._class = message_class
        self._interfaces = interfaces
        self._style = style

    def nested(self, field: Field) -> _Objects:
        nested = self._class._nested_class(field.name)
        return _Objects(nested, self._interfaces, self._style)

    def nested_function(self, field: Field, name: str) -> _Function:
        codec = class_codec(self._class._nested_class(field.name), self._interfaces, self._style)
        function: _Function = getattr(codec, name)
        return function

    def member(self, message: str, field: Field) -> str:
        return f"{message}.{self._style.attribute(field.name)}"

    def parts(self, time: str) -> tuple[str, str]:
        return f"{time}.secs", f"{time}.nsecs"

    def packer(self, field: Field) -> Callable[[Any], Any]:
        return _as_bytes if field.is_bytes else _number_packer(_LETTERS[field.type])

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
            return f'{name}(bytes(data[begin:o]), "<{_LETTERS[field.type]}")'
        if self._style.arrays == "tuple" and field.type != "bool":
            return _unpacked(field, count)
        return f"list({_unpacked(field, count)})"


def _unpacked(field: Field, count: str | int) -> str:
    """The expression for the tuple of an array's numbers."""
    return f'unpack_from(f"<{{{count}}}{_LETTERS[field.type]}", data, begin)'


class _Writer(_Code):
    """The source of a function that appends a message's bytes to a list."""

    parameters = "m, out"

    def __init__(self, layout: _Layout, serializers: Serializers) -> None:
        super().__init__(layout._replace(counted=False), serializers)
        self._numbers: list[tuple[str, str]] = []
        self._pieces: list[str] = []

    def message(self, definition: MessageDefinition, form: _Dicts, value: str) -> None:
        """Write the fields of a message."""
        form.expect(self, value)
        for field in definition.fields:
            self._field(field, form, form.member(value, field))

    def _field(self, field: Field, form: _Dicts, value: str) -> None:
        if field.array is None:
            self._element(field, form, value)
            return
        array, size = self.local(), 1
        if field.type in _LETTERS:
            size = calcsize(f"<{_LETTERS[field.type]}")
            value = f"{self.constant(form.packer(field))}({value})"
        self.add(f"{array} = {value}")
        if form.checked and field.type not in _LETTERS:
            self.add(f"if {array}.__class__ is not list and {array}.__class__ is not tuple:")
            self.add("    raise TypeError")
        if form.checked and field.array.size is not None:
            compare = ">" if field.array.bounded else "!="
            self.add(f"if len({array}) {compare} {field.array.size * size}:")
            self.add("    raise ValueError")
        if field.array.fixed is None:
            self._numbers.append(("I", f"len({array})" + (f" // {size}" if size > 1 else "")))
        if field.type in _LETTERS:
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

    def _element(self, field: Field, form: _Dicts, value: str) -> None:
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
            time, letter = self.local(), _LETTERS[builtin.TIMES[field.type]]
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
            self._numbers.append((_LETTERS[field.type], value))

    def _nested(self, field: Field, form: _Dicts, value: str) -> None:
        nested = self.serializers.of(field.type)
        if self.inlines(nested.layout):
            message = self.local()
            self.add(f"{message} = {value}")
            self.message(nested.definition, form.nested(field), message)
        else:
            self.flush()
            self.add(f"{self.constant(form.nested_function(field, '_write'))}({value}, out)")

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
        """Append what has been written so far."""
        self._pack()
        if len(self._pieces) == 1:
            self.add(f"out.append({self._pieces[0]})")
        elif self._pieces:
            self.add(f"out += ({', '.join(self._pieces)})")
        self._pieces = []


_Make: TypeAlias = Callable[[], str]
"""Adds the lines that make a value of what has been read; returns the expression for it."""


class _Reader(_Code):
    """The source of a function that reads a message, and finds out where it ends."""

    parameters = "data, o, errors"

    def __init__(self, layout: _Layout, serializers: Serializers) -> None:
        super().__init__(layout, serializers)
        self._numbers: list[tuple[str, str]] = []
        self._skip = 0

    def message(self, definition: MessageDefinition, form: _Dicts) -> _Make:
        """Read the fields of a message."""
        fields = [(field, self._field(field, form)) for field in definition.fields]
        return lambda: form.message(self, [(field, make()) for field, make in fields])

    def _field(self, field: Field, form: _Dicts) -> _Make:
        if field.array is None:
            return self._element(field, form)
        count: str | int = self._number("I") if field.array.fixed is None else field.array.fixed
        values = self.local()
        if field.type in _LETTERS:
            self._take(f"{count} * {calcsize('<' + _LETTERS[field.type])}")
            self.add(f"{values} = {form.numbers(self, field, count)}")
            return lambda: values
        self.settle()
        element = _Layout.of_element(field, self.serializers)
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

    def _element(self, field: Field, form: _Dicts) -> _Make:
        if field.is_nested:
            return self._nested(field, form)
        value = self.local()
        if field.type in builtin.STRINGS:
            self._take(self._number("I"))
            self.add(f'{value} = str(data[begin:o], "utf-8", errors)')
            return lambda: value
        if field.type in builtin.TIMES:
            letter = _LETTERS[builtin.TIMES[field.type]]
            secs, nsecs = self._number(letter), self._number(letter)
            return lambda: form.time(self, field.type, secs, nsecs)
        number = self._number(_LETTERS[field.type])
        return lambda: number

    def _nested(self, field: Field, form: _Dicts) -> _Make:
        nested = self.serializers.of(field.type)
        if self.inlines(nested.layout):
            return self.message(nested.definition, form.nested(field))
        self.settle()
        value, function = self.local(), self.constant(form.nested_function(field, "_read"))
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
        """Let ``begin`` and ``o`` be the offsets of the next bytes and of those behind them."""
        self._unpack(*self._group())
        self.add(f"begin = o + {self._skip}")
        self.add(f"o = begin + {size}")
        self._skip = 0

    def settle(self) -> None:
        """Let ``o`` be the offset of what comes next."""
        self._unpack(*self._group())
        if self._skip:
            self.add(f"o += {self._skip}")
        self._skip = 0


def _compile_write(serializer: Serializer, form: _Dicts) -> _Function:
    writer = _Writer(serializer.layout, serializer.serializers)
    writer.message(serializer.definition, form, "m")
    writer.flush()
    return writer.function(serializer.type)


def _compile_read(serializer: Serializer, form: _Dicts) -> _Function:
    reader = _Reader(serializer.layout, serializer.serializers)
    make = reader.message(serializer.definition, form)
    reader.settle()
    return reader.function(serializer.type, f"{make()}, o")


# The functions that the generated code calls.


def _spend(left: list[int], count: int) -> None:
    left[0] -= count
    if left[0] < 0:
        raise ValueError


def _with_nan(value: Any) -> Any:
    """The value with NaN for every None in it."""
    if isinstance(value, dict):
        return {name: _with_nan(member) for name, member in value.items()}
    if isinstance(value, list):
        return [_with_nan(element) for element in value]
    return nan if value is None else value


@lru_cache
def _list_packer(letter: str) -> Callable[[list[Any]], bytes]:
    """What makes bytes of valid lists of numbers; None stands for NaN."""

    def packed(values: list[Any]) -> bytes:
        try:
            return pack(f"<{len(values)}{letter}", *values)
        except StructError:
            filled = [nan if value is None else value for value in values]
            return pack(f"<{len(values)}{letter}", *filled)

    return packed


@lru_cache
def _number_packer(letter: str) -> Callable[[Any], bytes | memoryview]:
    """What makes bytes of arrays of numbers, or raises an exception."""
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


class _Fault(Exception):
    """What is wrong with the bytes; ``path`` is the field, which grows on the way out."""

    path = ""

    def inside(self, step: str) -> _Fault:
        """The fault as seen from the message or the array that holds the place."""
        dot = "." if self.path and not self.path.startswith("[") else ""
        self.path = f"{step}{dot}{self.path}"
        return self


class _Diagnosis:
    """A walk through bytes that have been found invalid, to find the field where they are."""

    def __init__(self, data: Buffer, serializers: Serializers) -> None:
        self._data = data
        self._serializers = serializers
        self._offset = 0
        self._visits = _DIAGNOSED
        self._left = MOST_VALUES

    def message(self, definition: MessageDefinition) -> None:
        """Walk through a message."""
        for field in definition.fields:
            try:
                self._field(field)
            except _Fault as fault:
                raise fault.inside(field.name) from None

    def _field(self, field: Field) -> None:
        if field.array is None:
            self._element(field)
            return
        element = _Layout.of_element(field, self._serializers)
        count = field.array.fixed
        if count is None:
            count = self._length()
            rest = len(self._data) - self._offset
            if count * element.least > rest:
                wanted = f"{count} elements of at least {element.least} bytes"
                raise _Fault(f"expected {wanted}, got {rest} bytes")
            self._left -= count * element.free
            if self._left < 0:
                raise _Fault(f"too many values that need no bytes (limit is {MOST_VALUES})")
        if element.size is not None:
            self._take(count * element.size)
            return
        for index in range(count):
            try:
                self._element(field)
            except _Fault as fault:
                raise fault.inside(f"[{index}]") from None

    def _element(self, field: Field) -> None:
        self._visits -= 1
        if self._visits < 0:
            raise _Fault("invalid length of this or a later field")
        if field.is_nested:
            self.message(self._serializers.of(field.type).definition)
        elif field.type in builtin.STRINGS:
            self._take(self._length())
        else:
            self._take(_Layout.of_element(field, self._serializers).least)

    def _length(self) -> int:
        begin = self._offset
        self._take(4)
        return int.from_bytes(self._data[begin : self._offset], "little")

    def _take(self, size: int) -> None:
        rest = len(self._data) - self._offset
        if size > rest:
            raise _Fault(f"expected {size} bytes, got {rest}")
        self._offset += size
