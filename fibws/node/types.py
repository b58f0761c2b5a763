"""The types that a node speaks: their classes, and what it must tell the hub about them."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar

from fibws.interfaces import Message, Validators
from fibws.msg import default_interfaces, message_class

M = TypeVar("M", bound=Message)


class Types:
    """One node's types.

    Args:
        now: gives the nanoseconds since 1970.
    """

    def __init__(self, now: Callable[[], int]) -> None:
        self._interfaces = default_interfaces()
        self._validators = Validators(self._interfaces, now)

    def message_class(self, type_: type[M] | str) -> type[M] | type[Message]:
        """The class itself, or that of the type of this name.

        Raises:
            InterfaceError: there is no such type.
        """
        if isinstance(type_, str):
            return message_class(self._interfaces.message(type_).type)
        self._interfaces.message(type_._type)
        return type_

    def validate(self, type_: str) -> Callable[[Any], dict[str, Any]]:
        """What checks a message of the type and fills its fields."""
        return self._validators.of(type_).validate

    def reader(self, message_class: type[M]) -> Callable[[Any], M]:
        """What makes a message out of what came from the wire, or raises `InvalidMessage`."""
        validate = self.validate(message_class._type)
        return lambda msg: message_class.from_dict(validate(msg))

    def definition(self, type_: str) -> str | None:
        """The text that explains the type to a hub that may not have it: none for standard ones."""
        if self._interfaces.is_users(self._interfaces.message(type_).package):
            return self._interfaces.full_text(type_)
        return None
