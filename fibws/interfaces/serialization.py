"""ROS 1's serialization (http://wiki.ros.org/msg), compiled for each message type.

`Serializer` converts between bytes and the dicts that `MessageValidator.validate` returns;
`class_codec` converts between bytes and objects of a message class, without a dict in between.

All numbers are little-endian. A string or an array without a fixed size has its length before it as
a uint32; fields follow each other without padding. `serialization_code` writes the functions for
each type, which are compiled when they are first needed. They only notice that bytes are invalid:
`_Diagnosis` then walks through the fields again to find out where and why.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property, lru_cache
from struct import error as StructError
from typing import Any, Final, Generic, TypeAlias, TypeVar

from fibws.errors import InvalidMessage
from fibws.interfaces import builtin
from fibws.interfaces.catalogue import Definitions
from fibws.interfaces.definition import Field, MessageDefinition
from fibws.interfaces.message import Message, ObjectStyle
from fibws.interfaces.serialization_code import (
    MOST_WITHOUT_BYTES,
    CborDicts,
    Dicts,
    Function,
    Layout,
    Objects,
    characters,
    compile_check,
    compile_read,
    compile_weigh,
    compile_write,
    with_nan,
)
from fibws.interfaces.validators import Validators

M = TypeVar("M", bound=Message)

Buffer: TypeAlias = bytes | bytearray | memoryview
"""The bytes of a message. A memoryview must be contiguous and of format ``B``."""

MOST_WEIGHT: Final = 300_000_000
"""Nanoseconds: a map of 4000 by 4000 cells is less, a cloud of 360,000 points in JSON is more."""
FEWEST_BYTES: Final = 2**19
"""The bytes of a message that may weigh more than that."""

_DIAGNOSED: Final = 100_000
"""How many fields and elements are visited to find out which one is invalid."""


class Serializers:
    """The serializers of all types, each made on first use."""

    def __init__(self, interfaces: Definitions) -> None:
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
        self._types = serializers
        self.layout = Layout.of(definition, serializers)
        self.size = self.layout.size
        self._weigh_functions: dict[bool, Function] = {}

    def check(self, data: Buffer) -> None:
        """Check that the bytes can be deserialized, without decoding them.

        Strings need not be UTF-8.

        Raises:
            InvalidMessage: the text names the field and the expected value.
        """
        if len(data) == self.size:
            return
        try:
            end = self.check_function(data, 0)
        except (StructError, ValueError, OverflowError):
            raise self._fault(data) from None
        if end < len(data):
            raise InvalidMessage(f"invalid bytes for {self.type}: {len(data) - end} bytes too many")
        if end > len(data):
            raise self._fault(data)

    def is_heavy(self, data: Buffer, *, numbers: bool) -> bool:
        """Whether it takes longer than `MOST_WEIGHT` to make a dict of checked bytes, and its text.

        Args:
            data: the bytes.
            numbers: whether there are arrays of numbers in the text; in CBOR they stay bytes.

        Shorter ones than `FEWEST_BYTES` need not be asked about.
        """
        try:
            self.weigh_function(numbers=numbers)(data, 0, [MOST_WEIGHT])
        except ValueError:
            return True
        return False

    def serialize(self, values: dict[str, Any]) -> bytes:
        """The bytes of a message as returned by `MessageValidator.validate`."""
        pieces: list[Any] = []
        try:
            self.write_function(values, pieces)
        except StructError:  # None stands for NaN.
            pieces = []
            self.write_function(with_nan(values), pieces)
        return b"".join(pieces)

    def deserialize(self, data: Buffer, errors: str = "strict") -> dict[str, Any]:
        """The message as returned by `MessageValidator.validate`; NaN is NaN.

        Args:
            data: the bytes.
            errors: the handling of strings that are not UTF-8, as in `bytes.decode`.

        Raises:
            InvalidMessage: the text names the field and the expected value.
            UnicodeDecodeError: ``errors`` is ``strict``, and a string is not UTF-8. Everything else
                is valid, so that another call with ``replace`` succeeds.
        """
        message: dict[str, Any] = self.read(self.read_function, data, errors)
        return message

    def to_cbor(self, data: Buffer, errors: str = "strict") -> bytes:
        """The message as CBOR, as `CborEncoder.encode` writes it; raises as `deserialize` does."""
        import cbor2

        return cbor2.dumps(self.read(self.cbor_function, data, errors))

    def read(self, function: Function, data: Buffer, errors: str) -> Any:
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
            _Diagnosis(data, self._types).message(self.definition)
        except _EncodingFault as fault:
            return InvalidMessage(f"invalid bytes for {self.type}: {fault.path}: {fault}")
        raise AssertionError(f"found nothing wrong with these bytes of {self.type}")

    def weigh_function(self, *, numbers: bool) -> Function:
        """The compiled function that raises ValueError if messages weigh too much."""
        if numbers not in self._weigh_functions:
            self._weigh_functions[numbers] = compile_weigh(self, self._types, numbers=numbers)
        return self._weigh_functions[numbers]

    @cached_property
    def check_function(self) -> Function:
        """The compiled function that returns where a message ends."""
        return compile_check(self, self._types)

    @cached_property
    def write_function(self) -> Function:
        """The compiled function that appends a dict's bytes to a list."""
        return compile_write(self, self._types, Dicts(self._types))

    @cached_property
    def read_function(self) -> Function:
        """The compiled function that returns a dict, and where it ends."""
        return compile_read(self, self._types, Dicts(self._types))

    @cached_property
    def cbor_function(self) -> Function:
        """The compiled function that returns the values to encode as CBOR, and the end offset."""
        return compile_read(self, self._types, CborDicts(self._types))


class ClassCodec(Generic[M]):
    """Serializes and deserializes the objects of one message class.

    Args:
        message_class: the class.
        interfaces: where the definitions of its type and of nested types are looked up.
        style: how objects of the class look.
    """

    def __init__(self, message_class: type[M], interfaces: Definitions, style: ObjectStyle) -> None:
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
            self.write_function(message, pieces)
            return b"".join(pieces)
        except Exception:
            # Validation names the field, unless it accepts the value: numpy's bools, for example.
            return self._serializer.serialize(self._validate(message.to_dict()))

    def serialize_after(self, head: Callable[[int], bytes], message: M) -> bytes:
        """The message's bytes behind others, without a copy of the message in between.

        Args:
            head: returns the bytes in front of a message of a number of bytes.
            message: the message.

        Raises:
            InvalidMessage: as `serialize`.
        """
        pieces: list[Any] = [b""]
        try:
            self.write_function(message, pieces)
            pieces[0] = head(sum(map(len, pieces)))
            return b"".join(pieces)
        except Exception:
            data = self.serialize(message)
            return head(len(data)) + data

    def deserialize(self, data: Buffer) -> M:
        """The message. In strings that are not UTF-8, U+FFFD replaces what is invalid.

        Arrays of uint8 are `bytes`, other arrays of numbers as the class's `ObjectStyle` says.

        Raises:
            InvalidMessage: the text names the field and the expected value.
        """
        view = data if type(data) is bytes else memoryview(data)
        try:
            message: M
            message, end = self.read_function(view, 0, "strict")
            if end == len(view):
                return message
        except Exception:
            pass  # It is read again for the error.
        read = self._serializer.read
        try:
            message = read(self.read_function, data, "strict")
        except UnicodeDecodeError as error:
            if self._style.on_invalid_text is not None:
                self._style.on_invalid_text(self.message_class, error)
            message = read(self.read_function, data, "replace")
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
    def _form(self) -> Objects:
        return Objects(
            self.message_class,
            self._style,
            lambda nested: class_codec(nested, self._interfaces, self._style),
        )

    @cached_property
    def write_function(self) -> Function:
        """The compiled function that appends an object's bytes to a list."""
        return compile_write(self._serializer, _serializers_of(self._interfaces), self._form)

    @cached_property
    def read_function(self) -> Function:
        """The compiled function that returns an object, and where it ends."""
        return compile_read(self._serializer, _serializers_of(self._interfaces), self._form)


def class_codec(
    message_class: type[M], interfaces: Definitions | None = None, style: ObjectStyle | None = None
) -> ClassCodec[M]:
    """The codec of a message class; it is made once, and compiled when it is first used.

    Args:
        message_class: a class that fibws generated, or one of genpy.
        interfaces: where the definition is looked up; by default the class's own.
        style: how objects of the class look; by default the class's own.
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
def _serializers_of(interfaces: Definitions) -> Serializers:
    return Serializers(interfaces)


class _EncodingFault(Exception):
    """An error in the bytes; ``path`` is the field, which is completed on the way out."""

    path = ""

    def inside(self, step: str) -> _EncodingFault:
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
        self._left = MOST_WITHOUT_BYTES

    def message(self, definition: MessageDefinition) -> None:
        """Walk through a message."""
        for field in definition.fields:
            try:
                self._field(field)
            except _EncodingFault as fault:
                raise fault.inside(field.name) from None

    def _field(self, field: Field) -> None:
        if field.array is None:
            self._element(field)
            return
        element = Layout.of_element(field, self._serializers)
        count = field.array.fixed
        if count is None:
            count = self._length()
            if field.array.bounded and field.array.size is not None and count > field.array.size:
                raise _EncodingFault(f"expected at most {field.array.size} elements, got {count}")
            rest = len(self._data) - self._offset
            if count * element.least > rest:
                wanted = f"{count} elements of at least {element.least} bytes"
                raise _EncodingFault(f"expected {wanted}, got {rest} bytes")
            self._left -= count * element.excess
            if self._left < 0:
                raise _EncodingFault(
                    f"too many values that need no bytes (limit is {MOST_WITHOUT_BYTES})"
                )
        if element.size is not None:
            self._take(count * element.size)
            return
        for index in range(count):
            try:
                self._element(field)
            except _EncodingFault as fault:
                raise fault.inside(f"[{index}]") from None

    def _element(self, field: Field) -> None:
        self._visits -= 1
        if self._visits < 0:
            raise _EncodingFault("invalid length of this or a later field")
        if field.is_nested:
            self.message(self._serializers.of(field.type).definition)
        elif field.type in builtin.STRINGS:
            size = self._length()
            begin = self._offset
            self._take(size)
            count = characters(memoryview(self._data)[begin : begin + size]) if field.limit else 0
            if field.limit is not None and count > field.limit:
                raise _EncodingFault(f"expected at most {field.limit} characters, got {count}")
        else:
            self._take(Layout.of_element(field, self._serializers).least)

    def _length(self) -> int:
        begin = self._offset
        self._take(4)
        return int.from_bytes(self._data[begin : self._offset], "little")

    def _take(self, size: int) -> None:
        rest = len(self._data) - self._offset
        if size > rest:
            raise _EncodingFault(f"expected {size} bytes, got {rest}")
        self._offset += size
