"""Definitions of types as the hub reports them, in rosapi/TypeDef."""

from __future__ import annotations

from binascii import a2b_base64
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any, NamedTuple, Protocol, Self

from fibws.errors import ServiceError

if TYPE_CHECKING:
    from fibws.interfaces.catalogue import Definitions

HEADER = "std_msgs/Header"
TIMES = frozenset({"time", "duration"})
STRINGS = frozenset({"string", "wstring"})
FLOATS = frozenset({"float32", "float64"})
BYTES = frozenset({"uint8", "char"})
"""Types whose arrays are base64 in JSON."""
_SCALARS: dict[str, object] = {"bool": False, **dict.fromkeys(STRINGS, "")}
_SCALARS |= dict.fromkeys(FLOATS, 0.0)


class Caller(Protocol):
    """A client that can call the hub's services, such as `HubClient`."""

    def call(self, service: str, request: dict[str, Any] | None = None) -> dict[str, Any]:
        """Return the response; raise `ServiceError` if the call fails."""


class TypedefField(NamedTuple):
    """A field of a message, or a whole message, whose name is empty."""

    name: str
    type: str
    length: int | None = None
    """None without an array, 0 for an array of any length, otherwise the length."""

    @property
    def written_type(self) -> str:
        """The type as in definitions: ``int32``, ``int32[]`` or ``int32[3]``."""
        return self.type if self.length is None else f"{self.type}[{self.length or ''}]"

    def elements(self, array: Any) -> Sequence[Any]:
        """Return the elements of an array in JSON, in which bytes are base64."""
        if self.type in BYTES and isinstance(array, str):
            return list(a2b_base64(array))
        return array if isinstance(array, list) else []


class Typedefs:
    """A type with all its nested types.

    Args:
        root: the type's name.
        typedefs: the rosapi/TypeDef messages that a service of rosapi returned; none if the type
            is unknown.
    """

    def __init__(self, root: str, typedefs: Iterable[Mapping[str, Any]] = ()) -> None:
        self.root = root
        """The type's name; that of a service's request ends in ``Request``."""
        self._fields: dict[str, list[TypedefField]] = {}
        self._constants: dict[str, dict[str, str]] = {}
        for each in typedefs:
            lengths = (None if n < 0 else n for n in each["fieldarraylen"])
            self._fields[each["type"]] = [
                TypedefField(*parts)
                for parts in zip(each["fieldnames"], each["fieldtypes"], lengths, strict=True)
            ]
            self._constants[each["type"]] = dict(
                zip(each["constnames"], each["constvalues"], strict=True)
            )

    @classmethod
    def of_message(cls, client: Caller, type_: str) -> Self:
        """Return a message type; raise `ServiceError` if the hub does not know it."""
        return cls._request(client, "/rosapi/message_details", type_)

    @classmethod
    def of_request(cls, client: Caller, service_type: str) -> Self:
        """Return the type of a service's request; raise `ServiceError` as `of_message`."""
        return cls._request(client, "/rosapi/service_request_details", service_type)

    @classmethod
    def of_response(cls, client: Caller, service_type: str) -> Self:
        """Return the type of a service's response; raise `ServiceError` as `of_message`."""
        return cls._request(client, "/rosapi/service_response_details", service_type)

    @classmethod
    def _request(cls, client: Caller, service: str, type_: str) -> Self:
        typedefs = client.call(service, {"type": type_})["typedefs"]
        try:
            return cls(typedefs[0]["type"] if typedefs else type_, typedefs)
        except (LookupError, TypeError, ValueError):
            raise ServiceError(service, f"invalid rosapi/TypeDef[] for {type_}") from None

    @classmethod
    def of_definitions(cls, definitions: Definitions, type_: str) -> Self:
        """Return a message type by its definition; raise as `Definitions.message`."""
        found = cls(definitions.canonical(type_))
        found._add(definitions, found.root)
        return found

    def _add(self, definitions: Definitions, type_: str) -> None:
        definition = definitions.message(type_)
        self._fields[type_] = [
            TypedefField(
                field.name,
                "string" if field.type == "wstring" else field.type,
                None if field.array is None else field.array.fixed or 0,
            )
            for field in definition.fields
        ]
        self._constants[type_] = {each.name: str(each.value) for each in definition.constants}
        for field in definition.fields:
            if field.is_nested and field.type not in self._fields:
                self._add(definitions, field.type)

    def __contains__(self, type_: str) -> bool:
        return type_ in self._fields

    def fields(self, type_: str) -> list[TypedefField]:
        """Return the fields of a message type in order; raise `KeyError` for an unknown type."""
        return self._fields[type_]

    def constants(self, type_: str) -> dict[str, str]:
        """Return the constants of a message type as text, by name; raise as `fields`."""
        return self._constants[type_]

    def fits(self, message: Mapping[str, Any]) -> bool:
        """Return whether a message has the type's fields, with values of their kinds."""
        return all(
            each.name in message and isinstance(message[each.name], self._kind(each))
            for each in self._fields.get(self.root, ())
        )

    def _kind(self, field: TypedefField) -> type | tuple[type, ...]:
        """Return the Python type of a field in JSON, in which NaN is null."""
        if field.length is not None:
            return (str, list) if field.type in BYTES else list
        if field.type in self._fields or field.type in TIMES:
            return dict
        return str if field.type in STRINGS else (int, float, type(None))

    def has_header(self, type_: str) -> bool:
        """Return whether messages of a type begin with a header, where ROS expects a stamp."""
        return [field[:2] for field in self._fields.get(type_, [])[:1]] == [("header", HEADER)]

    def has_sequenced_header(self, type_: str) -> bool:
        """Return whether that header begins with ``seq``; a Header of ROS 2 has none."""
        first = self._fields.get(HEADER, [])[:1]
        return self.has_header(type_) and [field.name for field in first] == ["seq"]

    def default(self, field: TypedefField) -> Any:
        """Return the default of a field."""
        if field.length is not None:
            return [self.default(TypedefField("", field.type)) for _ in range(field.length)]
        if field.type in self._fields:
            return {each.name: self.default(each) for each in self._fields[field.type]}
        return _SCALARS.get(field.type, 0)


def if_known(request: Callable[[Caller, str], Typedefs], client: Caller, type_: str) -> Typedefs:
    """Return ``request(client, type_)``, or an empty `Typedefs` if the hub does not know the type.

    Args:
        request: `Typedefs.of_message`, `Typedefs.of_request` or `Typedefs.of_response`.
    """
    try:
        return request(client, type_)
    except ServiceError:
        return Typedefs(type_)
