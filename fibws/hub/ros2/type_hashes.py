"""The hashes by which ROS 2 compares types (REP 2016): ``RIHS01_`` and a SHA-256.

What is hashed is a JSON text that describes the fields of a type and of all types in it, so that
hashes are equal if the fields have the same names and types in the same order. Constants and
defaults do not count.

Definitions are those of ROS 1: here they are described as ROS 2 has them. A header has no ``seq``,
``time`` and ``duration`` are messages, and field names are in lower case, as ROS 2 demands.
"""

from __future__ import annotations

import json
from collections.abc import Iterable
from hashlib import sha256
from typing import Any, Final, TypeAlias

from fibws.errors import Ros2Error
from fibws.interfaces import builtin
from fibws.interfaces.definition import Field, MessageDefinition, ServiceDefinition
from fibws.interfaces.ros2_definitions import Find, ros2_fields

Description: TypeAlias = dict[str, Any]

TYPE_IDS: Final = {
    "int8": 2,
    "uint8": 3,
    "int16": 4,
    "uint16": 5,
    "int32": 6,
    "uint32": 7,
    "int64": 8,
    "uint64": 9,
    "float32": 10,
    "float64": 11,
    "bool": 15,
    "byte": 16,
    "char": 3,  # ROS 2's own definitions have uint8 for it.
    "string": 17,
    "wstring": 18,
}
"""As in type_description_interfaces/FieldType."""
_NESTED, _BOUNDED_STRING, _BOUNDED_WSTRING = 1, 21, 22
_ARRAY, _BOUNDED_SEQUENCE, _SEQUENCE = 48, 96, 144
"""Added to the id of an element."""
EMPTY_MEMBER: Final = "structure_needs_at_least_one_member"
"""The only field of a message without fields, a uint8."""

_TIME: Final = "builtin_interfaces/msg/Time"
_DURATION: Final = "builtin_interfaces/msg/Duration"
_EVENT_INFO: Final = "service_msgs/msg/ServiceEventInfo"


def message_hash(definition: MessageDefinition, find: Find) -> str:
    """Return the hash of a message.

    Raises:
        InterfaceError: a type in it is unknown.
    """
    name = f"{definition.package}/msg/{definition.name}"
    described: dict[str, Description] = {}
    _describe(name, definition, find, described)
    return _hash(name, described)


def service_hash(definition: ServiceDefinition, find: Find) -> str:
    """Return the hash of a service; raises as `message_hash`."""
    name = f"{definition.package}/srv/{definition.name}"
    described: dict[str, Description] = {}
    _describe(f"{name}_Request", definition.request, find, described)
    _describe(f"{name}_Response", definition.response, find, described)
    described[_TIME] = _time(_TIME)
    described[_EVENT_INFO] = _type(
        _EVENT_INFO,
        (
            _field("event_type", 3),
            _field("stamp", _NESTED, nested=_TIME),
            _field("client_gid", 3 + _ARRAY, 16),
            _field("sequence_number", 8),
        ),
    )
    one = _NESTED + _BOUNDED_SEQUENCE
    described[f"{name}_Event"] = _type(
        f"{name}_Event",
        (
            _field("info", _NESTED, nested=_EVENT_INFO),
            _field("request", one, 1, nested=f"{name}_Request"),
            _field("response", one, 1, nested=f"{name}_Response"),
        ),
    )
    described[name] = _type(
        name,
        (
            _field("request_message", _NESTED, nested=f"{name}_Request"),
            _field("response_message", _NESTED, nested=f"{name}_Response"),
            _field("event_message", _NESTED, nested=f"{name}_Event"),
        ),
    )
    return _hash(name, described)


def _hash(name: str, described: dict[str, Description]) -> str:
    text = json.dumps(
        {
            "type_description": described.pop(name),
            "referenced_type_descriptions": [described[each] for each in sorted(described)],
        }
    )
    return f"RIHS01_{sha256(text.encode()).hexdigest()}"


def _describe(
    name: str, definition: MessageDefinition, find: Find, described: dict[str, Description]
) -> None:
    """Describe a type, and all types in it that are not described yet."""
    fields = []
    nested: dict[str, str] = {}
    for field in ros2_fields(definition):
        fields.append(_described(field, nested))
    described[name] = _type(name, fields or (_field(EMPTY_MEMBER, 3),))
    for each, type_ in nested.items():
        if each in described:
            continue
        if type_ in builtin.TIMES:
            described[each] = _time(each)
        else:
            _describe(each, find(type_), find, described)


def _described(field: Field, nested: dict[str, str]) -> Description:
    """Return the description of a field, and add its type to those that are nested."""
    name, capacity, string_capacity = "", 0, 0
    if field.type in builtin.TIMES:
        id_, name = _NESTED, _TIME if field.type == "time" else _DURATION
        nested[name] = field.type
    elif field.is_nested:
        package, _, type_ = field.type.partition("/")
        id_, name = _NESTED, f"{package}/msg/{type_}"
        nested[name] = field.type
    elif field.limit is not None:
        id_ = _BOUNDED_STRING if field.type == "string" else _BOUNDED_WSTRING
        string_capacity = field.limit
    else:
        id_ = TYPE_IDS[field.type]
    if field.array is not None:
        if field.array.fixed is not None:
            id_ += _ARRAY
        else:
            id_ += _BOUNDED_SEQUENCE if field.array.bounded else _SEQUENCE
        capacity = field.array.size or 0
    if not field.name.isascii():
        raise Ros2Error(f"{field.name} is not a name of a field of ROS 2")
    return _field(field.name.lower(), id_, capacity, string_capacity, name)


def _field(
    name: str, id_: int, capacity: int = 0, string_capacity: int = 0, nested: str = ""
) -> Description:
    return {
        "name": name,
        "type": {
            "type_id": id_,
            "capacity": capacity,
            "string_capacity": string_capacity,
            "nested_type_name": nested,
        },
    }


def _type(name: str, fields: Iterable[Description]) -> Description:
    return {"type_name": name, "fields": list(fields)}


def _time(name: str) -> Description:
    return _type(name, (_field("sec", 6), _field("nanosec", 7)))
