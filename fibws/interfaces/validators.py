"""Validates messages: takes a dict and returns one with all fields.

How JSON becomes a message is ROS's own rule, as rosbridge_library's ``message_conversion.py`` has
it. The result is ready for ``pydantic_core.to_json(..., inf_nan_mode="null")``: byte strings are
base64, and NaN is either itself or None, since JSON has null for both.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial
from itertools import islice, repeat
from typing import Any, NamedTuple, TypeAlias

from pydantic_core import SchemaValidator, ValidationError, core_schema

from fibws.errors import InvalidMessage
from fibws.interfaces import base64text, builtin
from fibws.interfaces.catalogue import Definitions
from fibws.interfaces.definition import Array, Field, MessageDefinition
from fibws.interfaces.schema import (
    array_schema,
    rounded_columns,
    scalar_schema,
    time_schema,
    zero_time,
)
from fibws.interfaces.validation_errors import MOST_EXPLAINED, explain

Validate: TypeAlias = Callable[[object], dict[str, Any]]
"""Returns a message with every field filled; raises `InvalidMessage`."""

MOST_ABSENT = 2**16
"""Most values that a message may leave to their defaults, besides one for each four that it has: an
array of 300,000 ``{}`` must not become millions of values."""

MOST_MISSING = 100
"""Most paths of absent fields that are listed."""
MOST_SEARCHED = 10_000
"""Most elements of arrays that are searched for absent fields."""


class Validators:
    """The validators of all types, each made on first use.

    Args:
        interfaces: where the types are looked up.
        now: returns the nanoseconds since 1970, for stamps and the word "now".
        lenient: whether to take numbers in other spellings, too; see `schema.scalar_schema`.
    """

    def __init__(
        self, interfaces: Definitions, now: Callable[[], int], *, lenient: bool = False
    ) -> None:
        self._interfaces = interfaces
        self._schemas = _Schemas(interfaces, now, lenient=False)
        self._lenient = _Schemas(interfaces, now, lenient=True) if lenient else None
        self._by_name: dict[str, MessageValidator] = {}

    def of(self, name: str) -> MessageValidator:
        """The validator of a message type; raises as `Definitions.message` does."""
        found = self._by_name.get(name)
        if found is None:
            definition = self._interfaces.message(name)
            found = self._by_name.get(definition.type) or self.of_definition(definition)
            self._by_name[name] = self._by_name[definition.type] = found
        return found

    def of_definition(self, definition: MessageDefinition) -> MessageValidator:
        """A new validator of a message without a name of its own, such as a service's request."""
        return MessageValidator(definition, self._schemas, self._lenient, self._interfaces)


class _Schemas:
    """The schemas of all types.

    Args:
        lenient: as in `schema.scalar_schema`.
    """

    def __init__(self, interfaces: Definitions, now: Callable[[], int], *, lenient: bool) -> None:
        # Not a method: schemas must not keep each other alive when a definition is forgotten.
        now_parts = partial(_now_parts, now)
        self._interfaces = interfaces
        self._lenient = lenient
        self._by_type: dict[str, core_schema.CoreSchema] = {
            "time": time_schema("time", base=zero_time, now=now_parts, lenient=lenient),
            "duration": time_schema("duration", base=zero_time, now=None, lenient=lenient),
        }
        self._fields: dict[tuple[str, Array | None], core_schema.CoreSchema] = {}
        self._stamp = core_schema.with_default_schema(
            time_schema("time", base=now_parts, now=now_parts, lenient=lenient),
            default_factory=now_parts,
        )

    def message(
        self, definition: MessageDefinition, *, rounded: bool = True
    ) -> core_schema.CoreSchema:
        """The schema of an object in which all fields are optional, and no others are allowed.

        Args:
            rounded: whether the object's own float32 values are rounded.
        """
        fields = {
            field.name: self._field(field)
            if rounded or not _is_float32(field)
            else _with_default(field, scalar_schema(field, lenient=self._lenient, rounded=False))
            for field in definition.fields
        }
        if definition.type == builtin.HEADER and Field("stamp", "time") in definition.fields:
            fields["stamp"] = self._stamp
        return core_schema.typed_dict_schema(
            {
                name: core_schema.typed_dict_field(schema, required=False)
                for name, schema in fields.items()
            },
            extra_behavior="forbid",
            strict=True,
        )

    def _field(self, field: Field) -> core_schema.CoreSchema:
        """The schema of a field, with its default.

        Fields that are alike share one: the validators keep them all.
        """
        key = (field.element_type, field.array)
        if field.default is not None:
            return self._new_field(field)
        if key not in self._fields:
            self._fields[key] = self._new_field(field)
        return self._fields[key]

    def _new_field(self, field: Field) -> core_schema.CoreSchema:
        schema = self._element(field)
        if field.array is not None:
            schema = array_schema(field, schema, lenient=self._lenient)
            if field.is_nested:
                schema = self._rounding_columns(field, schema)
        return _with_default(field, schema)

    def _rounding_columns(
        self, field: Field, exact: core_schema.CoreSchema
    ) -> core_schema.CoreSchema:
        """The schema of an array of messages, which rounds their float32 values together."""
        definition = self._interfaces.message(field.type)
        names = [each.name for each in definition.fields if _is_float32(each)]
        if not names:
            return exact
        plain = self.message(definition, rounded=False)
        return rounded_columns(names, array_schema(field, plain, lenient=self._lenient), exact)

    def _element(self, field: Field) -> core_schema.CoreSchema:
        if not field.is_nested and field.type not in builtin.TIMES:
            return scalar_schema(field, lenient=self._lenient)
        if field.type not in self._by_type:
            self._by_type[field.type] = self.message(self._interfaces.message(field.type))
        return self._by_type[field.type]


def _is_float32(field: Field) -> bool:
    return field.type == "float32" and field.array is None


def _now_parts(now: Callable[[], int]) -> dict[str, int]:
    secs, nsecs = divmod(now(), 1_000_000_000)
    return {"secs": secs, "nsecs": nsecs}


class _Nested(NamedTuple):
    """A field in which there are arrays of messages: such an array, or a message with some in it.

    ``values`` are those of one message with empty arrays, ``inner`` its own fields of that kind.
    """

    name: str
    is_array: bool
    values: int
    inner: tuple[_Nested, ...]


class MessageValidator:
    """Validates the messages of one type."""

    __slots__ = (
        "_interfaces",
        "_lenient",
        "_nested",
        "_schemas",
        "_shape",
        "_validate",
        "definition",
        "has_sequenced_header",
        "type",
    )

    def __init__(
        self,
        definition: MessageDefinition,
        schemas: _Schemas,
        lenient: _Schemas | None,
        interfaces: Definitions,
    ) -> None:
        self.definition = definition
        self.type = definition.type
        self.has_sequenced_header = interfaces.has_sequenced_header(definition)
        self._interfaces = interfaces
        # Both are made on first use. Most types of a hub's services are never asked for, messages
        # of many topics travel serialized only, and nearly all others are in the strict spelling.
        self._schemas = schemas
        self._validate: Validate | None = None
        self._lenient: _Schemas | Validate | None = lenient
        self._nested = self._find_nested(definition)
        self._shape: _Shape | None = None

    def validate(self, msg: object) -> dict[str, Any]:
        """Return the message with all fields.

        Raises:
            InvalidMessage: it does not fit the type, and the text names the first field at fault;
                or it leaves out too many fields.
        """
        if self._nested and type(msg) is dict:
            self._check_absent(msg)
        validate = self._validate
        if validate is None:
            validate = self._validate = self._make(self._schemas)
        try:
            valid: dict[str, Any] = validate(msg)
        except ValidationError as error:
            if self._lenient is None or error.error_count() > MOST_EXPLAINED:
                raise self._explained(error) from None
        else:
            return valid
        return self._validate_leniently(msg)

    def _validate_leniently(self, msg: object) -> dict[str, Any]:
        validate = self._lenient
        if isinstance(validate, _Schemas):
            validate = self._lenient = self._make(validate)
        assert validate is not None
        try:
            return validate(msg)
        except ValidationError as error:
            raise self._explained(error) from None

    def _make(self, schemas: _Schemas) -> Validate:
        return SchemaValidator(schemas.message(self.definition)).validate_python

    def _explained(self, error: ValidationError) -> InvalidMessage:
        return explain(self.definition, self._interfaces.message, error)

    def _check_absent(self, msg: dict[str, Any]) -> None:
        """Refuse a message that leaves so much out that its defaults are most of the work."""
        if _most_values(self._nested, msg) <= MOST_ABSENT:
            return
        if self._shape is None:
            self._shape = _shape(self.definition, self._interfaces)
        present, absent = _count(self._shape, msg)
        most = MOST_ABSENT + present // 4
        if absent > most:
            raise InvalidMessage(
                f"Message type {self.type} leaves {absent} values to their defaults, "
                f"the limit for a message with {present} values is {most}"
            )

    def _find_nested(self, definition: MessageDefinition) -> tuple[_Nested, ...]:
        found = []
        for field in definition.fields:
            if field.is_nested:
                nested = self._interfaces.message(field.type)
                inner = self._find_nested(nested)
                if field.array is not None or inner:
                    values = self._interfaces.default_values(nested.type)
                    found.append(_Nested(field.name, field.array is not None, values, inner))
        return tuple(found)

    def missing(self, msg: dict[str, Any]) -> list[str]:
        """Return the fields missing in a valid message, such as ``pose.x``; ``...`` for more."""
        paths = self._missing(self.definition, msg, "", repeat(None, MOST_SEARCHED))
        found = list(islice(paths, MOST_MISSING + 1))
        return found if len(found) <= MOST_MISSING else [*found[:MOST_MISSING], "..."]

    def _missing(
        self, definition: MessageDefinition, msg: dict[str, Any], prefix: str, left: Iterator[None]
    ) -> Iterator[str]:
        for field in definition.fields:
            path = f"{prefix}{field.name}"
            if field.name not in msg:
                yield path
            elif field.is_nested:
                nested = self._interfaces.message(field.type)
                value = msg[field.name]
                if field.array is None:
                    yield from self._missing(nested, value, f"{path}.", left)
                    continue
                # `left` comes first: no element is taken once it is used up.
                for _, (index, element) in zip(left, enumerate(value), strict=False):
                    yield from self._missing(nested, element, f"{path}[{index}].", left)


class _Shape(NamedTuple):
    """A type, as `_count` needs it.

    ``values`` are those of a message with empty arrays; ``fields`` have for each field its name,
    the values that it has if it is left out, and the shape of messages in it; ``is_flat`` says that
    there are no such messages.
    """

    values: int
    fields: tuple[tuple[str, int, _Shape | None], ...]
    is_flat: bool


def _shape(definition: MessageDefinition, interfaces: Definitions) -> _Shape:
    fields = []
    for field in definition.fields:
        nested = interfaces.message(field.type) if field.is_nested else None
        inner = _shape(nested, interfaces) if nested is not None else None
        each = inner.values if inner is not None else 1
        count = 1 if field.array is None else field.fixed_size
        fields.append((field.name, max(1, count * each), inner))
    is_flat = all(inner is None for _, _, inner in fields)
    return _Shape(sum(values for _, values, _ in fields), tuple(fields), is_flat)


def _count(shape: _Shape, msg: dict[str, Any]) -> tuple[int, int]:
    """Return how many values a message has, and how many it leaves to their defaults."""
    present = absent = 0
    for name, values, inner in shape.fields:
        value = msg.get(name)
        if value is None:
            absent += values
            continue
        present += 1
        if inner is None:
            continue
        if inner.is_flat and type(value) is list and _are_complete(value, inner):
            present += len(value) * len(inner.fields)
            continue
        for element in value if type(value) is list else (value,):
            if not element:
                absent += inner.values
            elif type(element) is dict:
                counts = _count(inner, element)
                present += counts[0]
                absent += counts[1]
    return present, absent


def _are_complete(elements: list[Any], shape: _Shape) -> bool:
    """Return whether messages have as many members as fields, as the points of a cloud do.

    If they are others than the fields, or no messages, they are refused later.
    """
    try:
        return set(map(len, elements)) == {len(shape.fields)}
    except TypeError:
        return False


def _most_values(fields: tuple[_Nested, ...], msg: dict[str, Any]) -> int:
    """Return an upper bound for the values that elements of arrays leave to their defaults."""
    count = 0
    for field in fields:
        value = msg.get(field.name)
        if type(value) is list and field.is_array:
            count += len(value) * field.values
            if field.inner:
                for element in value:
                    if type(element) is dict:
                        count += _most_values(field.inner, element)
        elif type(value) is dict:
            count += _most_values(field.inner, value)
    return count


def _with_default(field: Field, schema: core_schema.CoreSchema) -> core_schema.CoreSchema:
    """The schema of an optional field."""
    with_default = core_schema.with_default_schema
    if field.is_bytes:
        return with_default(schema, default_factory=partial(_default_bytes, field))
    if field.array is not None:
        return with_default(
            schema, default_factory=partial(_default_list, field), validate_default=True
        )
    if field.type in builtin.TIMES:
        return with_default(schema, default_factory=zero_time)
    if field.is_nested:
        # The default of a nested message is an empty object, validated by its schema.
        return with_default(schema, default_factory=dict, validate_default=True)
    return with_default(
        schema, default=field.default_value, validate_default=field.default is not None
    )


# Default elements are made when they are needed: a short definition can declare millions.


def _default_bytes(field: Field) -> str:
    if field.default is None:
        return base64text.encode(bytes(field.fixed_size))
    return base64text.encode(bytes(map(int, field.default_elements)))


def _default_list(field: Field) -> list[object]:
    if field.type not in builtin.CONSTANTS:
        return [{}] * field.fixed_size
    return list(field.default_elements)
