"""Validates messages: takes a dict and returns one with all fields.

How JSON becomes a message is ROS's own rule, as rosbridge_library's ``message_conversion.py`` has
it. The result is ready for ``pydantic_core.to_json(..., inf_nan_mode="null")``: byte strings are
base64, and NaN is either itself or None, since JSON has null for both.
"""

from __future__ import annotations

from base64 import b64encode
from collections.abc import Callable, Iterator
from functools import partial
from typing import Any

from pydantic_core import SchemaValidator, ValidationError, core_schema

from fibws.interfaces import builtin
from fibws.interfaces.catalogue import Interfaces
from fibws.interfaces.definition import Array, Field, MessageDefinition
from fibws.interfaces.schema import array_schema, scalar_schema, time_schema, zero_time
from fibws.interfaces.validation_errors import explain


class Validators:
    """The validators of all types, each made when first asked for.

    Args:
        interfaces: where the types are looked up.
        now: gives the nanoseconds since 1970, for stamps and the word "now".
    """

    def __init__(self, interfaces: Interfaces, now: Callable[[], int]) -> None:
        self._interfaces = interfaces
        self._now = now
        self._by_name: dict[str, MessageValidator] = {}
        self._schemas: dict[str, core_schema.CoreSchema] = {
            "time": time_schema("time", base=zero_time, now=self._now_parts),
            "duration": time_schema("duration", base=zero_time, now=None),
        }
        self._fields: dict[tuple[str, Array | None], core_schema.CoreSchema] = {}
        self._stamp = core_schema.with_default_schema(
            time_schema("time", base=self._now_parts, now=self._now_parts),
            default_factory=self._now_parts,
        )

    def of(self, name: str) -> MessageValidator:
        """The validator of a message type; raises as `Interfaces.message` does."""
        found = self._by_name.get(name)
        if found is None:
            definition = self._interfaces.message(name)
            found = self._by_name.get(definition.type) or self.of_definition(definition)
            self._by_name[name] = self._by_name[definition.type] = found
        return found

    def of_definition(self, definition: MessageDefinition) -> MessageValidator:
        """A new validator of a message without a name of its own, such as a service's request."""
        return MessageValidator(definition, self._message(definition), self._interfaces)

    def _now_parts(self) -> dict[str, int]:
        secs, nsecs = divmod(self._now(), 1_000_000_000)
        return {"secs": secs, "nsecs": nsecs}

    def _message(self, definition: MessageDefinition) -> core_schema.CoreSchema:
        """The schema of an object in which all fields are optional, and no others are allowed."""
        fields = {field.name: self._field(field) for field in definition.fields}
        if definition.type == builtin.HEADER:
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
            most = self._interfaces.most_elements(field.type) if field.is_nested else None
            schema = array_schema(field, schema, most)
        return _with_default(field, schema)

    def _element(self, field: Field) -> core_schema.CoreSchema:
        if not field.is_nested and field.type not in builtin.TIMES:
            return scalar_schema(field)
        if field.type not in self._schemas:
            self._schemas[field.type] = self._message(self._interfaces.message(field.type))
        return self._schemas[field.type]


class MessageValidator:
    """Validates the messages of one type."""

    __slots__ = ("_interfaces", "_validate", "definition", "has_sequenced_header", "type")

    def __init__(
        self, definition: MessageDefinition, schema: core_schema.CoreSchema, interfaces: Interfaces
    ) -> None:
        self.definition = definition
        self.type = definition.type
        self.has_sequenced_header = definition.has_sequenced_header
        self._interfaces = interfaces
        self._validate = SchemaValidator(schema).validate_python

    def validate(self, msg: object) -> dict[str, Any]:
        """Return the message with all fields.

        Raises:
            InvalidMessage: it does not fit the type; the text names the first field at fault.
        """
        try:
            valid: dict[str, Any] = self._validate(msg)
        except ValidationError as error:
            raise explain(self.definition, self._interfaces.message, error) from None
        return valid

    def missing(self, msg: dict[str, Any]) -> list[str]:
        """The fields that a valid message leaves out, such as ``pose.x``."""
        return list(self._missing(self.definition, msg, ""))

    def _missing(
        self, definition: MessageDefinition, msg: dict[str, Any], prefix: str
    ) -> Iterator[str]:
        for field in definition.fields:
            path = f"{prefix}{field.name}"
            if field.name not in msg:
                yield path
            elif field.is_nested:
                nested = self._interfaces.message(field.type)
                value = msg[field.name]
                if field.array is None:
                    yield from self._missing(nested, value, f"{path}.")
                    continue
                for index, element in enumerate(value):
                    yield from self._missing(nested, element, f"{path}[{index}].")


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
        # The default of a nested message is what its schema makes of an empty object.
        return with_default(schema, default_factory=dict, validate_default=True)
    return with_default(
        schema, default=field.default_value, validate_default=field.default is not None
    )


# Default elements are made when they are needed: a short definition can declare millions.


def _default_bytes(field: Field) -> str:
    if field.default is None:
        return b64encode(bytes(field.fixed_size)).decode()
    return b64encode(bytes(map(int, field.default_elements))).decode()


def _default_list(field: Field) -> list[object]:
    if field.type not in builtin.CONSTANTS:
        return [{}] * field.fixed_size
    return list(field.default_elements)
