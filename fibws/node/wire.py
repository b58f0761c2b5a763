"""How one class's messages get to the wire, and back from it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any, Generic, TypeVar

from fibws.interfaces import Duration, Message, Time

M = TypeVar("M", bound=Message)


class Wire(Generic[M]):
    """One message class on the wire.

    Args:
        message_class: whose messages these are.
        check: fills a message's fields, or raises `InvalidMessage`.
    """

    def __init__(self, message_class: type[M], check: Callable[[Any], dict[str, Any]]) -> None:
        self.message_class = message_class
        self._check = check

    def write(self, given: object) -> dict[str, Any]:
        """A message for the wire, or a dict of its fields, of which those left out have defaults.

        Raises:
            InvalidMessage: a field does not fit the type.
            TypeError: it is a message of another class, or none.
        """
        if not isinstance(given, self.message_class) and not isinstance(given, Mapping):
            found = given._type if isinstance(given, Message) else type(given).__name__
            raise TypeError(f"expected [{self.message_class._type}] but got [{found}]")
        return self._check(_plain(given))

    def read(self, values: Any) -> M:
        """The message that came from the wire, or `InvalidMessage`."""
        return self.message_class.from_dict(self._check(values))


def _plain(value: object) -> Any:
    """A message, or fields that may hold messages, as JSON has it."""
    match value:
        case Message():
            return value.to_dict()
        case Time() | Duration():
            return {"secs": value.secs, "nsecs": value.nsecs}
        case Mapping():
            return {name: _plain(field) for name, field in value.items()}
        case list() | tuple():
            return [_plain(element) for element in value]
        case _:
            return value
