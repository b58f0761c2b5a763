"""A message class's way to ROS 1's bytes and back."""

from __future__ import annotations

from functools import cached_property
from typing import Any

from fibws.interfaces import Interfaces, MessageDefinition, MessageValidator, Validators
from fibws.interfaces.serialization import Serializer, Serializers


class Codec:
    """The bytes of one message class; what makes them is made on first use.

    Args:
        definition: the message's.
        interfaces: where the types nested in it are looked up.
    """

    def __init__(self, definition: MessageDefinition, interfaces: Interfaces) -> None:
        self._definition = definition
        self._interfaces = interfaces

    def serialize(self, values: dict[str, Any]) -> bytes:
        """The bytes of a message that is given as JSON has it, or `InvalidMessage`."""
        return self._serializer.serialize(self._validator.validate(values))

    def deserialize(self, data: bytes) -> dict[str, Any]:
        """The message that the bytes are, as JSON has it, or `InvalidMessage`."""
        return self._serializer.deserialize(data)

    @cached_property
    def _validator(self) -> MessageValidator:
        # Every field is given, so that no stamp is made.
        return Validators(self._interfaces, now=int).of_definition(self._definition)

    @cached_property
    def _serializer(self) -> Serializer:
        return Serializers(self._interfaces).of_definition(self._definition)
