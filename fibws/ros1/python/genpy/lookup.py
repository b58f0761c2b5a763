"""Finds message and service classes by the names of their types."""

from __future__ import annotations

from typing import Any

from fibws.errors import UnknownPackage, UnknownType
from fibws.interfaces import Service
from genpy.rostime import Duration, Time, TVal


def get_message_class(message_type: str, reload_on_error: bool = False) -> Any:
    """Return the class of a message type, or None if the type is unknown.

    Args:
        message_type: ``std_msgs/Int32``, ``Header``, ``time`` or ``duration``.
        reload_on_error: has no effect.

    Raises:
        ValueError: the name has no package.
        InterfaceError: the definition is invalid.
    """
    from genpy import classes  # It imports genpy.message, which imports this.

    times: dict[str, type[TVal]] = {"time": Time, "duration": Duration}
    if message_type in times:
        return times[message_type]
    try:
        return classes.message_class(
            _full("std_msgs/Header" if message_type == "Header" else message_type)
        )
    except (UnknownPackage, UnknownType):
        return None


def get_service_class(
    service_type: str, reload_on_error: bool = False
) -> type[Service[Any, Any]] | None:
    """Return the class of a service type, or None; otherwise like `get_message_class`."""
    from genpy import classes

    try:
        return classes.service_class(_full(service_type))
    except (UnknownPackage, UnknownType):
        return None


def _full(name: str) -> str:
    if "/" not in name:
        raise ValueError(f"message type is missing package name: {name}")
    return name
