"""The values of a call or a goal, in the form in which they arrived and in each requested form."""

from __future__ import annotations

from typing import Any, Protocol, cast

from pydantic_core import from_json

from fibws.errors import NotSerialized
from fibws.hub.graph.types import read_values
from fibws.interfaces.json_text import exact_json_of
from fibws.interfaces.serialization import Serializer
from fibws.interfaces.serialized_values import SerializedValues


class BodyType(Protocol):
    """The type of a service or an action, which has a serializer for each of its messages."""

    def serializer(self, message: int) -> Serializer:
        """Return the serializer of one of its messages; raise `UnknownDefinition`."""


class Body:
    """A request, a response, a goal, feedback or a result.

    It holds the form in which it arrived: validated values, their JSON, or checked bytes in ROS 1's
    serialization. Each other form is made on first use.

    Args:
        type_: of the service or the action.
        message: which of the type's messages it is.
        json: in which infinity is as in `exact_json_of`.
    """

    __slots__ = ("_json", "_message", "_ros1", "_type", "_values")

    def __init__(
        self,
        type_: BodyType,
        message: int,
        *,
        values: Any = None,
        json: bytes | None = None,
        ros1: bytes | None = None,
    ) -> None:
        self._type = type_
        self._message = message
        self._values = values
        self._json = json
        self._ros1 = ros1

    def values(self) -> Any:
        """Return the values; do not change them.

        They are a dict, unless the type is unknown and a client has sent something else.

        Raises:
            OperationError: to make them of bytes would keep the hub busy for too long.
        """
        if self._values is None:
            if self._ros1 is not None:
                serializer = self._type.serializer(self._message)
                self._values = read_values(serializer, self._ros1, is_checked=True)
            elif self._json is not None:
                self._values = from_json(self._json)
        return self._values

    def json(self) -> bytes:
        """Return the values as JSON, in which infinity is as in `exact_json_of`; as `values`."""
        if self._json is None:
            self._json = exact_json_of(self.values())
        return self._json

    def ros1(self) -> bytes:
        """Return the values in ROS 1's serialization.

        Raises:
            UnknownDefinition: the fields of the type are unknown.
        """
        if self._ros1 is None:
            values = cast("dict[str, Any]", self.values())
            self._ros1 = self._type.serializer(self._message).serialize(values)
        return self._ros1


def check_serialized(
    type_: BodyType, message: int, given: SerializedValues, name: str, md5sum: str | None
) -> Body:
    """Return the body that a client has sent as bytes.

    Args:
        name: of the type.
        md5sum: the type's.

    Raises:
        NotSerialized: the client knows another definition of the type than the hub, or the hub
            knows none.
        InvalidMessage: the bytes do not fit the type.
    """
    if md5sum is None or given.md5sum not in (None, md5sum):
        raise NotSerialized(name, md5sum)
    type_.serializer(message).check(given.data)
    return Body(type_, message, ros1=given.data)
