"""Schemas of the responses of rosapi: another kind of server may send something else."""

from __future__ import annotations

import sys
from collections.abc import Mapping
from typing import TypeAlias

Schema: TypeAlias = "str | list[Schema] | Mapping[str, Schema]"
"""A primitive type of ROS; a list with the elements' schema; or an object's fields."""

_TIME: Schema = {"secs": "uint32", "nsecs": "uint32"}
_NODES: Schema = [
    {
        "name": "string",
        "address": "string",
        "since": _TIME,
        "own": "bool",
        "api": "string",
        "fault": "string",
        "hub": "string",
    }
]
_HUB: Mapping[str, Schema] = {
    "id": "string",
    "name": "string",
    "version": "string",
    "link": "string",
    "distance": "uint32",
    "nodes": "uint32",
}
_LINK: Mapping[str, Schema] = {
    "kind": "string",
    "address": "string",
    "name": "string",
    "id": "string",
    "version": "string",
    "fault": "string",
    "since": _TIME,
    "round_trip": "float64",
    "clock_offset": "float64",
    "messages_sent": "uint64",
    "messages_received": "uint64",
    "bytes_sent": "uint64",
    "bytes_received": "uint64",
    "dropped": "uint64",
    "lost": "uint64",
}
_SUBSCRIPTION: Mapping[str, Schema] = {
    "node": "string",
    "queue_length": "uint32",
    "throttle_rate": "uint32",
    "compression": "string",
}
_TOPIC: Mapping[str, Schema] = {
    "name": "string",
    "type": "string",
    "checked": "bool",
    "publishers": [{"node": "string", "latch": "bool"}],
    "subscriptions": [_SUBSCRIPTION],
    "conflicts": [{"node": "string", "type": "string", "publishes": "bool", "fault": "string"}],
}
_SERVICE: Mapping[str, Schema] = {"name": "string", "type": "string", "node": "string"}
_STATISTICS: Mapping[str, Schema] = {
    "topic": "string",
    "publishers": [{"node": "string", "messages": "uint64", "bytes": "uint64"}],
    "subscriptions": [
        {"node": "string", "messages": "uint64", "dropped": "uint64", "throttled": "uint64"}
    ],
}
_CLIENT: Mapping[str, Schema] = {
    "node": "string",
    "address": "string",
    "principal": "string",
    "protocol": "string",
    "since": _TIME,
    "messages_received": "uint64",
    "bytes_received": "uint64",
    "messages_sent": "uint64",
    "bytes_sent": "uint64",
    "kept_bytes": "uint64",
    "dropped": "uint64",
    "limited": "uint64",
    "subscriptions": "uint32",
    "advertisements": "uint32",
    "slow": "bool",
}

RESPONSES: Mapping[str, Mapping[str, Schema]] = {
    "/rosapi/graph": {
        "nodes": _NODES,
        "topics": [_TOPIC],
        "services": [_SERVICE],
        "actions": [{**_SERVICE, "over_topics": "bool"}],
    },
    "/rosapi/hubs": {"stamp": _TIME, "hub": _HUB, "links": [_LINK], "hubs": [_HUB]},
    "/rosapi/statistics": {"stamp": _TIME, "topics": [_STATISTICS], "clients": [_CLIENT]},
    "/rosapi/topics": {"topics": ["string"], "types": ["string"]},
    "/rosapi/topics_for_type": {"topics": ["string"]},
    "/rosapi/topic_type": {"type": "string"},
    "/rosapi/service_type": {"type": "string"},
    "/rosapi/nodes": {"nodes": ["string"]},
    "/rosapi/get_time": {"time": _TIME},
    "/rosapi/get_param": {"value": "string"},
    "/rosapi/get_param_names": {"names": ["string"]},
    "/rosapi/ping_node": {"success": "bool", "message": "string", "seconds": "float64"},
    "/rosapi/kill_node": {"success": "bool", "message": "string"},
    "/rosapi/unregister_node": {"success": "bool", "message": "string"},
}
"""The fields of responses that tools use, by the services' names."""

LOG: Schema = {
    "header": {"stamp": _TIME},
    "level": "int8",
    "name": "string",
    "msg": "string",
}
"""The fields of a rosgraph_msgs/Log that tools use."""

MAX_QUOTED = 40
"""Maximum number of characters that are quoted from a wrong value."""


def schema_error(value: object, schema: Schema, name: str) -> str | None:
    """Return why a value does not fit a schema: ``nodes[0].own is 5, expected bool``; else None.

    Additional fields of objects are ignored.

    Args:
        name: the value's name in the text.
    """
    if isinstance(schema, str):
        return None if _is_of(value, schema) else _expected(schema, name, value)
    if isinstance(schema, list):
        if not isinstance(value, list):
            return _expected("a list", name, value)
        errors = (schema_error(each, schema[0], f"{name}[{i}]") for i, each in enumerate(value))
        return next(filter(None, errors), None)
    if not isinstance(value, dict):
        return _expected("an object", name, value)
    for field, of in schema.items():
        if field not in value:
            return f"{name} has no {field}"
        if error := schema_error(value[field], of, f"{name}.{field}"):
            return error
    return None


def _is_of(value: object, type_: str) -> bool:
    if type_ == "string":
        return isinstance(value, str)
    if type_ == "bool" or isinstance(value, bool):
        return type_ == "bool" and isinstance(value, bool)
    if type_ == "float64":
        most = sys.float_info.max
        return isinstance(value, int | float) and -most <= value <= most
    bits = int(type_.lstrip("uint"))
    least, end = (0, 1 << bits) if type_[0] == "u" else (-1 << bits - 1, 1 << bits - 1)
    return isinstance(value, int) and least <= value < end


def _expected(what: str, name: str, value: object) -> str:
    text = ascii(value)
    shown = text if len(text) <= MAX_QUOTED else f"{text[:MAX_QUOTED]}..."
    return f"{name} is {shown}, expected {what}"
