"""Finds message and service classes by the names of their types."""

from __future__ import annotations

from typing import Any

from fibws.errors import UnknownPackage, UnknownType
from fibws.interfaces import Service
from genpy.rostime import Duration, Time, TVal


def get_message_class(message_type: str, reload_on_error: bool = False) -> Any:
    """The class of a message type, or None if there is no such type.

    Args:
        message_type: ``std_msgs/Int32``, ``Header``, ``time`` or ``duration``.
        reload_on_error: is there for scripts that give it.

    Raises:
        ValueError: the type is named without its package.
        InterfaceError: its definition is wrong.
    """
    from genpy import classes  # It needs the base of the classes, where this is found, too.

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
    """The class of a service type, or None if there is none; it does as `get_message_class`."""
    from genpy import classes

    try:
        return classes.service_class(_full(service_type))
    except (UnknownPackage, UnknownType):
        return None


def _full(name: str) -> str:
    if "/" not in name:
        raise ValueError(f"message type is missing package name: {name}")
    return name
