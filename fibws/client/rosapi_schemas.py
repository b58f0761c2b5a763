"""What a hub's own answers are made of: what answers there may be another kind of hub, or lie."""

from __future__ import annotations

import sys
from collections.abc import Mapping
from typing import TypeAlias

Shape: TypeAlias = "str | list[Shape] | Mapping[str, Shape]"
"""A type of ROS's definitions; a list of one shape, of which there may be any number; or fields."""

_TIME: Shape = {"secs": "uint32", "nsecs": "uint32"}
_NODES: Shape = [{"name": "string", "address": "string", "since": _TIME, "own": "bool"}]
_SUBSCRIPTION: Mapping[str, Shape] = {
    "node": "string",
    "queue_length": "uint32",
    "throttle_rate": "uint32",
    "compression": "string",
}
_TOPIC: Mapping[str, Shape] = {
    "name": "string",
    "type": "string",
    "checked": "bool",
    "publishers": [{"node": "string", "latch": "bool"}],
    "subscriptions": [_SUBSCRIPTION],
}
_SERVICE: Mapping[str, Shape] = {"name": "string", "type": "string", "node": "string"}
_STATISTICS: Mapping[str, Shape] = {
    "topic": "string",
    "publishers": [{"node": "string", "messages": "uint64", "bytes": "uint64"}],
    "subscriptions": [{"node": "string", "messages": "uint64", "dropped": "uint64"}],
}
_CLIENT: Mapping[str, Shape] = {
    "node": "string",
    "address": "string",
    "kept_bytes": "uint64",
    "dropped": "uint64",
    "slow": "bool",
}

ANSWERS: Mapping[str, Mapping[str, Shape]] = {
    "/rosapi/graph": {
        "nodes": _NODES,
        "topics": [_TOPIC],
        "services": [_SERVICE],
        "actions": [{**_SERVICE, "over_topics": "bool"}],
    },
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
}
"""What tools read of the answers, by the services' names."""

LOG: Shape = {
    "header": {"stamp": _TIME},
    "level": "int8",
    "name": "string",
    "msg": "string",
}
"""What tools read of a rosgraph_msgs/Log."""

MOST_SHOWN = 40
"""Characters that are shown of a value that is wrong."""


def fault(value: object, shape: Shape, name: str) -> str | None:
    """What is wrong with the value of this name, such as ``nodes[0].own is 5, no bool``, if it is.

    What else an object has than its shape tells of does not matter.
    """
    if isinstance(shape, str):
        return None if _is_of(value, shape) else f"{name} is {_shown(value)}, no {shape}"
    if isinstance(shape, list):
        if not isinstance(value, list):
            return f"{name} is {_shown(value)}, no list"
        faults = (fault(each, shape[0], f"{name}[{i}]") for i, each in enumerate(value))
        return next(filter(None, faults), None)
    if not isinstance(value, dict):
        return f"{name} is {_shown(value)}, no object"
    for field, of in shape.items():
        if field not in value:
            return f"{name} has no {field}"
        if found := fault(value[field], of, f"{name}.{field}"):
            return found
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


def _shown(value: object) -> str:
    text = ascii(value)
    return text if len(text) <= MOST_SHOWN else f"{text[:MOST_SHOWN]}..."
