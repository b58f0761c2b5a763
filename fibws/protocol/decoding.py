"""Decoding: from JSON text or CBOR to the fields of an operation, and from these to the operation.

    JSON text ── decode_json ─┐
                              ├─ fields ── parse_request or parse_reply ── operation
    CBOR ─────── decode_cbor ─┘

Everything that is wrong raises OperationError. Where rosbridge_suite has a text for it (in
rosbridge_library's capability.py and protocol.py), clients get that text.
"""

from __future__ import annotations

import re
from codecs import getincrementaldecoder
from collections.abc import Callable, Iterable, Iterator, Sequence
from functools import partial
from io import BytesIO
from itertools import islice
from struct import calcsize, unpack
from typing import Annotated, Any, Final, NoReturn, TypeVar, get_args

import cbor2
from pydantic import Field, TypeAdapter, ValidationError
from pydantic_core import from_json, to_json

from fibws.errors import InvalidUtf8, OperationError
from fibws.interfaces.serialized_values import SerializedValues
from fibws.protocol.operations import LONGEST_ID, Reply, Request
from fibws.protocol.serialized import VALUES, read_operation
from fibws.protocol.value_limits import MOST_CONTAINERS, check_cbor

T = TypeVar("T")

QUOTED_LENGTH = 200
"""Most characters of an invalid value that an error quotes."""

_SLICE: Final = 2**20
"""Bytes of a text that are looked at together, where that bounds memory."""

_BRACES = re.compile(rb"\}\}*[ \t\r\n]*([^ \t\r\n,\]}]?)")
"""Closing braces and, as a group, what follows them if that is neither a comma nor a bracket: in
valid JSON they are then the end of the whole text, or within a string."""

_TRAILING: Final = "trailing characters"
"""The beginning of `from_json`'s error for further text after a value."""

_MOST_BRACES: Final = MOST_CONTAINERS + 100_000
"""How often `_BRACES` may be found in a text of several objects: also in strings."""


def decode_json(data: bytes | bytearray) -> Iterable[dict[str, Any]]:
    """Return the JSON objects of a text: usually one; rosbridge_suite accepts several in a row.

    Of several, only the one that is returned is in memory.

    Raises:
        OperationError: the text is not JSON, or has a value that is not an object. The objects
            before an error are returned.
        InvalidUtf8: the text is not UTF-8.
    """
    try:
        value = from_json(data)
    except ValueError as error:
        return _several(data, str(error))
    return (_object(value),)


def _several(data: bytes | bytearray, first_error: str) -> Iterator[dict[str, Any]]:
    """Yield the objects of a text that is not a single JSON value."""
    _check_utf8(data)
    if not first_error.startswith(_TRAILING):
        if data.strip():
            raise _not_json(data, first_error)
        return
    start = counted = 0
    inside = False
    for number, braces in enumerate(_BRACES.finditer(data)):
        if number > _MOST_BRACES:
            raise OperationError("too many braces in the strings of several objects in one text")
        if not braces[1]:
            continue
        following = braces.start(1)
        inside ^= _quotes(data, counted, following) % 2 == 1
        counted = following
        if not inside:
            yield _object(_decode(data[start:following], first_error))
            start = following
    if data[start:].strip():
        yield _object(_decode(data[start:], first_error))


def _check_utf8(data: bytes | bytearray) -> None:
    decoder = getincrementaldecoder("utf-8")()
    try:
        for start in range(0, len(data), _SLICE):
            decoder.decode(data[start : start + _SLICE])
        decoder.decode(b"", True)
    except UnicodeDecodeError as error:
        raise InvalidUtf8(str(error)) from None


def _quotes(data: bytes | bytearray, start: int, end: int) -> int:
    """Count the quotation marks that begin or end a string."""
    if data.find(b"\\", start, end) < 0:
        return data.count(b'"', start, end)
    return data[start:end].replace(rb"\\", b"").replace(rb"\"", b"").count(b'"')


def _decode(text: bytes | bytearray, first_error: str) -> Any:
    try:
        return from_json(text)
    except ValueError:
        raise _not_json(text, first_error) from None


def _not_json(text: bytes | bytearray, error: str) -> OperationError:
    begin = text[: 5 * QUOTED_LENGTH].decode(errors="ignore").lstrip()
    return OperationError(f"Expected JSON objects: {error}. Original message was: {quoted(begin)}")


def _object(value: object) -> dict[str, Any]:
    if isinstance(value, dict):
        return value
    raise OperationError(f"Expected a JSON object. Original message was: {quoted(value)}")


def decode_operation(data: bytes | bytearray) -> dict[str, Any]:
    """Return the fields of an operation with serialized values (see `protocol.serialized`).

    The values are `SerializedValues` in their field.

    Raises:
        OperationError: the frame is invalid, or its operation has no values.
        InvalidUtf8: its text is not UTF-8.
    """
    text, values = read_operation(data)
    objects = list(decode_json(text))
    operation = objects[0].get("op") if objects else None
    name = VALUES.get(operation) if isinstance(operation, str) else None
    if len(objects) != 1 or name is None:
        raise OperationError(f"{quoted(operation)} has no serialized values")
    fields = objects[0]
    md5sum = fields.pop("md5sum", "") if name == "args" else None
    if md5sum is not None and not isinstance(md5sum, str):
        raise OperationError(f"md5sum must be a string, got {quoted(md5sum)}")
    fields[name] = SerializedValues(values, md5sum)
    return fields


# CBOR (RFC 8949)

DEEPEST: Final = 200
"""Most levels of nested arrays and maps: as many as pydantic_core allows in JSON."""

_UINT8: Final = "<B"
_TYPED_ARRAYS: Final = {
    **{
        64: _UINT8,
        68: _UINT8,
        69: "<H",
        70: "<I",
        71: "<Q",
        72: "<b",
        77: "<h",
        78: "<i",
        79: "<q",
    },
    **{65: ">H", 66: ">I", 67: ">Q", 73: ">h", 74: ">i", 75: ">q"},
    **{80: ">e", 81: ">f", 82: ">d", 84: "<e", 85: "<f", 86: "<d"},
}
"""`struct` formats of typed arrays by tag (RFC 8746, section 2.1); `struct` has no float128."""

_KNOWN_TO_CBOR2: Final = (
    *(0, 1, 2, 3, 4, 5, 25, 28, 29, 30, 35, 36, 37, 52, 54, 100),
    *(256, 258, 260, 261, 1004, 43000, 55799),
)
"""The tags that cbor2 decodes by default."""

_SELF_DESCRIBED: Final = b"\xd9\xd9\xf7"
"""The tag 55799, which CBOR data may begin with (RFC 8949, section 3.4.6)."""

_SCALARS: Final = {str, int, float, bool, bytes, type(None)}


def decode_cbor(data: bytes) -> dict[str, Any]:
    """Return a CBOR map as a dict of JSON's types and bytes; undefined becomes None.

    Typed arrays (RFC 8746) become lists, those of uint8 bytes. All other tags are refused: JSON has
    no equivalent, and with some of them a few bytes keep a decoder busy for minutes.

    Raises:
        OperationError: the data is not one CBOR map, has a value of another type, or has too many.
    """
    check_cbor(data)
    encoded = data.removeprefix(_SELF_DESCRIBED)
    source = BytesIO(encoded)  # It shares these bytes, unless one asks for its buffer.
    decoder = cbor2.CBORDecoder(
        source,
        tag_hook=_refuse_unknown,
        semantic_decoders=_TAG_DECODERS,
        max_depth=DEEPEST,
        strict_hashable_types=True,
    )
    try:
        value = decoder.decode()
    except cbor2.CBORError as error:
        raise OperationError(f"Expected a map in CBOR: {error.__cause__ or error}") from None
    if not isinstance(value, dict):
        raise OperationError(f"Expected a map in CBOR, got {type(value).__name__}")
    rest = len(encoded) - source.tell()
    if rest:
        raise OperationError(f"Expected one map in CBOR, got {rest} more bytes after it")
    return _checked_map(value)


def _checked_map(value: dict[Any, Any]) -> dict[str, Any]:
    for key, member in value.items():
        if type(key) is not str:
            kind = type(key).__name__
            raise OperationError(f"Expected text as the keys of maps in CBOR, got {kind}")
        if type(member) not in _SCALARS:
            value[key] = _checked(member)
    return value


def _checked(value: Any) -> Any:
    if type(value) is dict:
        return _checked_map(value)
    if type(value) is list:
        # Most lists have only scalars: comparing sets of types is faster than a loop.
        if _SCALARS.issuperset(map(type, value)):
            return value
        return [member if type(member) in _SCALARS else _checked(member) for member in value]
    if value is cbor2.undefined:
        return None
    kind = type(value).__name__
    raise OperationError(f"Expected bytes or values that JSON has in CBOR, got {kind}")


def _typed_array(layout: str, data: object, immutable: bool) -> Sequence[float]:
    if not isinstance(data, bytes):
        raise ValueError("a typed array must be a byte string")
    if layout == _UINT8:
        return data
    count, rest = divmod(len(data), calcsize(layout))
    if rest:
        raise ValueError(f"a typed array of {len(data)} bytes ends within an element")
    return list(unpack(f"{layout[0]}{count}{layout[1]}", data))


def _refuse(tag: int, value: object, immutable: bool) -> NoReturn:
    raise ValueError(f"unsupported tag {tag}; only typed arrays (RFC 8746) are supported")


def _refuse_unknown(tagged: cbor2.CBORTag, immutable: bool) -> NoReturn:
    _refuse(tagged.tag, tagged.value, immutable)


_TAG_DECODERS: dict[int, Callable[[Any, bool], Any]] = {
    **{tag: partial(_refuse, tag) for tag in _KNOWN_TO_CBOR2},
    **{tag: partial(_typed_array, layout) for tag, layout in _TYPED_ARRAYS.items()},
}


# From fields to operations

_REQUEST: TypeAdapter[Request] = TypeAdapter(Annotated[Request, Field(discriminator="op")])
_REPLY: TypeAdapter[Reply] = TypeAdapter(Annotated[Reply, Field(discriminator="op")])
REQUESTS = sorted(model.model_fields["op"].default for model in get_args(Request))
"""The names of the operations that clients send."""
REPLIES = sorted(model.model_fields["op"].default for model in get_args(Reply))
"""The names of the operations that the hub sends."""


def parse_request(fields: dict[str, Any]) -> Request:
    """Return the operation that a client sent.

    A field that is null counts as absent, as in rosbridge_suite.

    Raises:
        OperationError: the operation is unknown, or a field is missing or of a wrong type.
    """
    return _parse(_REQUEST, REQUESTS, fields)


def parse_reply(fields: dict[str, Any]) -> Reply:
    """Return the operation that the hub sent; see `parse_request`."""
    return _parse(_REPLY, REPLIES, fields)


def _parse(adapter: TypeAdapter[T], known: list[str], fields: dict[str, Any]) -> T:
    if None in fields.values():
        fields = {name: value for name, value in fields.items() if value is not None}
    try:
        return adapter.validate_python(fields)
    except ValidationError as error:
        raise OperationError(_error_text(error, known, fields)) from None


_EXPECTED = {
    "string_type": "str",
    "bool_type": "bool",
    "int_type": "int",
    "int_from_float": "int",
    "float_type": "int, float",
    "finite_number": "a finite number",
    "greater_than_equal": "a number >= {ge}",
    "less_than_equal": "a number <= {le}",
    "less_than": "a number < {lt}",
}
"""The types that an error of pydantic's asks for, as rosbridge_suite calls them."""


def _error_text(error: ValidationError, known: list[str], fields: dict[str, Any]) -> str:
    """Return the text of the first error."""
    first = error.errors(include_url=False, include_context=True)[0]
    operation = fields.get("op")
    if first["type"] == "union_tag_not_found" or not isinstance(operation, str):
        return (
            "Received a message without an op.  All messages require 'op' field with value one of: "
            f"{known}.  Original message was: {quoted(fields)}"
        )
    if first["type"] == "union_tag_invalid":
        return f"Unknown operation: {operation}.  Allowed operations: {known}"
    name = str(first["loc"][1])
    if first["type"] == "missing":
        return f"Expected a {name} field but none was found."
    long = first["type"] == "string_too_long"
    context = first.get("ctx", {})
    expected = (
        f"str{f' of at most {LONGEST_ID} characters' * long}, int"
        if name == "id"
        else _EXPECTED.get(first["type"], "").format_map(context)
        or context.get("expected", first["msg"])
    )
    return f"Expected field {name} to be one of {expected}. Invalid value: {quoted(first['input'])}"


def quoted(value: Any) -> str:
    """Return an invalid value as JSON text, truncated to a readable length."""
    start = _start(value, QUOTED_LENGTH)
    text = to_json(start, inf_nan_mode="constants", bytes_mode="base64").decode()
    return text if len(text) <= QUOTED_LENGTH else f"{text[:QUOTED_LENGTH]}..."


def _start(value: Any, most: int) -> Any:
    """Return the start of a value, which may have millions of elements, before it becomes text."""
    if isinstance(value, list):
        return [_start(each, most // 2) for each in value[: most + 1]]
    if isinstance(value, dict):
        items = islice(value.items(), most + 1)
        return {name[: most + 1]: _start(each, most // 2) for name, each in items}
    return value[: QUOTED_LENGTH + 1] if isinstance(value, str | bytes) else value
