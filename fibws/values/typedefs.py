"""What types are made of, as the hub tells it."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from typing import Any, NamedTuple, Protocol, Self

from fibws.errors import ServiceError

HEADER = "std_msgs/Header"
TIMES = frozenset({"time", "duration"})
STRINGS = frozenset({"string", "wstring"})
FLOATS = frozenset({"float32", "float64"})
BYTES = frozenset({"uint8", "char"})
"""What arrays of are base64 on the wire."""
_SCALARS: dict[str, object] = {"bool": False, **dict.fromkeys(STRINGS, "")}
_SCALARS |= dict.fromkeys(FLOATS, 0.0)


class Caller(Protocol):
    """A client that can call the hub's services, such as `HubClient`."""

    def call(self, service: str, request: dict[str, Any] | None = None) -> dict[str, Any]:
        """Return the response; raise `ServiceError` if the call fails."""


class Field(NamedTuple):
    """A field of a message, or whatever else has its type."""

    name: str
    type: str
    length: int | None = None
    """None if it is no array; 0 for an array of any number of elements, else how many."""

    @property
    def written_type(self) -> str:
        """Its type as definitions have it: ``int32``, ``int32[]`` or ``int32[3]``."""
        return self.type if self.length is None else f"{self.type}[{self.length or ''}]"


class Typedefs:
    """A type with all the types in it.

    Args:
        root: the type's name.
        typedefs: those of rosapi/TypeDef that a service of rosapi gave.
    """

    def __init__(self, root: str, typedefs: Iterable[Mapping[str, Any]] = ()) -> None:
        self.root = root
        """The type's name; a service's request has that of the service with ``Request`` to it."""
        self._fields: dict[str, list[Field]] = {}
        self._constants: dict[str, dict[str, str]] = {}
        for each in typedefs:
            lengths = (None if n < 0 else n for n in each["fieldarraylen"])
            self._fields[each["type"]] = [
                Field(*parts)
                for parts in zip(each["fieldnames"], each["fieldtypes"], lengths, strict=True)
            ]
            self._constants[each["type"]] = dict(
                zip(each["constnames"], each["constvalues"], strict=True)
            )

    @classmethod
    def of_message(cls, client: Caller, type_: str) -> Self:
        """Those of a message; it raises `ServiceError` if the hub has no such type."""
        return cls._ask(client, "/rosapi/message_details", type_)

    @classmethod
    def of_request(cls, client: Caller, service_type: str) -> Self:
        """Those of a service's request; it raises `ServiceError` if the hub has no such type."""
        return cls._ask(client, "/rosapi/service_request_details", service_type)

    @classmethod
    def of_response(cls, client: Caller, service_type: str) -> Self:
        """Those of a service's response; it raises `ServiceError` if the hub has no such type."""
        return cls._ask(client, "/rosapi/service_response_details", service_type)

    @classmethod
    def _ask(cls, client: Caller, service: str, type_: str) -> Self:
        typedefs = client.call(service, {"type": type_})["typedefs"]
        try:
            return cls(typedefs[0]["type"] if typedefs else type_, typedefs)
        except (LookupError, TypeError, ValueError):
            raise ServiceError(service, f"what it told of {type_} is no rosapi/TypeDef[]") from None

    def __contains__(self, type_: str) -> bool:
        return type_ in self._fields

    def fields(self, type_: str) -> list[Field]:
        """The fields of a message type, in order; it raises `KeyError` if that is none of these."""
        return self._fields[type_]

    def constants(self, type_: str) -> dict[str, str]:
        """The constants of a message type by their names, each as text; raises as `fields`."""
        return self._constants[type_]

    def fit(self, message: Mapping[str, Any]) -> bool:
        """Whether a message looks like one of the type, by its fields and what kind each is of."""
        return all(
            each.name in message and isinstance(message[each.name], self._kind(each))
            for each in self._fields.get(self.root, ())
        )

    def _kind(self, field: Field) -> type | tuple[type, ...]:
        """What JSON has for a field; a number that is none is null there."""
        if field.length is not None:
            return (str, list) if field.type in BYTES else list
        if field.type in self._fields or field.type in TIMES:
            return dict
        return str if field.type in STRINGS else (int, float, type(None))

    def has_header(self, type_: str) -> bool:
        """Whether messages of a type begin with a header, which is where ROS looks for a stamp."""
        return [field[:2] for field in self._fields.get(type_, [])[:1]] == [("header", HEADER)]

    def default(self, field: Field) -> Any:
        """What a field is that nobody has given a value."""
        if field.length is not None:
            return [self.default(Field("", field.type)) for _ in range(field.length)]
        if field.type in self._fields:
            return {each.name: self.default(each) for each in self._fields[field.type]}
        return _SCALARS.get(field.type, 0)


def if_known(ask: Callable[[Caller, str], Typedefs], client: Caller, type_: str) -> Typedefs:
    """What ``ask``, such as `Typedefs.of_message`, says of a type; nothing if nobody defined it."""
    try:
        return ask(client, type_)
    except ServiceError:
        return Typedefs(type_)
