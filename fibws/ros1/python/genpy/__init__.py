"""Message classes as in ROS 1's genpy, made from definitions when they are first needed.

    finder ─> classes ─> Message, with a Member for each field ─> JSON, ROS 1's bytes, YAML

A module of this name is on the path only where a script of ROS 1 runs (see `fibws.ros1`).
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from genpy.message import (
        DeserializationError,
        Message,
        MessageException,
        SerializationError,
        struct_I,
    )
    from genpy.rostime import Duration, Time, TVal

_HOMES = {
    "genpy.message": (
        "DeserializationError",
        "Message",
        "MessageException",
        "SerializationError",
        "struct_I",
    ),
    "genpy.rostime": ("Duration", "TVal", "Time"),
}
_HOME = {name: home for home, names in _HOMES.items() for name in names}

__all__ = [
    "DeserializationError",
    "Duration",
    "Message",
    "MessageException",
    "SerializationError",
    "TVal",
    "Time",
    "struct_I",
]


if not TYPE_CHECKING:

    def __getattr__(name: str) -> Any:
        """Load a name when it is first used: times need no definitions."""
        if name not in _HOME:
            raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
        value = getattr(import_module(_HOME[name]), name)
        globals()[name] = value
        return value


def __dir__() -> list[str]:
    return sorted({*globals(), *_HOME})
