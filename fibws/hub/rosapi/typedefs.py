"""The fields of types, as rosapi/TypeDef lists them (rosapi's objectutils.py)."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

from pydantic_core import to_json

from fibws.hub.graph.service import Function
from fibws.hub.rosapi.cache import TextCache
from fibws.interfaces import Interfaces, MessageDefinition, builtin
from fibws.interfaces.client_definitions import ClientDefinitions
from fibws.interfaces.definition import Field


class TypeDefs:
    """Lists of type definitions: a type's own, then those of the types in it, depth first.

    Every list is the JSON of a response with ``typedefs`` in it. Names may have ROS 2's spelling.
    An unknown type raises `InterfaceError`.
    """

    def __init__(self, definitions: Interfaces | ClientDefinitions) -> None:
        self._definitions = definitions
        self._messages = TextCache(lambda name: self._text(definitions.message(name)))
        self._requests = TextCache(lambda name: self._text(definitions.service(name).request))
        self._responses = TextCache(lambda name: self._text(definitions.service(name).response))
        if isinstance(definitions, ClientDefinitions):
            for cache in (self._messages, self._requests, self._responses):
                definitions.watch(cache.forget)

    def services(self) -> dict[str, tuple[str, Function]]:
        """Return all services by their global names, each with its type and handler."""
        return {
            "/rosapi/message_details": ("rosapi/MessageDetails", _for_type(self.message)),
            "/rosapi/service_request_details": (
                "rosapi/ServiceRequestDetails",
                _for_type(self.request),
            ),
            "/rosapi/service_response_details": (
                "rosapi/ServiceResponseDetails",
                _for_type(self.response),
            ),
        }

    def message(self, name: str) -> bytes:
        """Return the definitions of a message; none for the builtin types, except the times."""
        if name in builtin.TIMES:
            return _response([_time(name)])
        if name in builtin.NAMES:
            return _response([])
        return self._messages.get(Interfaces.canonical(name))

    def request(self, name: str) -> bytes:
        """Return the definitions of a service's request."""
        return self._requests.get(Interfaces.canonical(name))

    def response(self, name: str) -> bytes:
        """Return the definitions of a service's response."""
        return self._responses.get(Interfaces.canonical(name))

    def _text(self, definition: MessageDefinition) -> bytes:
        return _response(list(self._typedefs(definition, set())))

    def _typedefs(self, definition: MessageDefinition, seen: set[str]) -> Iterator[dict[str, Any]]:
        yield _typedef(definition)
        for field in definition.fields:
            if field.type in seen:
                continue
            seen.add(field.type)
            if field.is_nested:
                yield from self._typedefs(self._definitions.message(field.type), seen)
            elif field.type in builtin.TIMES:
                yield _time(field.type)


def _for_type(respond: Callable[[str], bytes]) -> Function:
    """Return the handler of a request that names a type."""
    return lambda request, caller: respond(request["type"])


def _response(typedefs: list[dict[str, Any]]) -> bytes:
    return to_json({"typedefs": typedefs})


def _typedef(definition: MessageDefinition) -> dict[str, Any]:
    constants = sorted((each.name, str(each.value)) for each in definition.constants)
    return {
        "type": definition.type,
        "fieldnames": [field.name for field in definition.fields],
        "fieldtypes": [
            "string" if field.type == "wstring" else field.type for field in definition.fields
        ],
        "fieldarraylen": [_length(field) for field in definition.fields],
        "examples": [_example(field) for field in definition.fields],
        "constnames": [name for name, _ in constants],
        "constvalues": [value for _, value in constants],
    }


def _time(name: str) -> dict[str, Any]:
    """Describe a type of time as if it were a message; its parts are always called int32."""
    return {
        "type": name,
        "fieldnames": ["secs", "nsecs"],
        "fieldtypes": ["int32", "int32"],
        "fieldarraylen": [-1, -1],
        "examples": ["0", "0"],
        "constnames": [],
        "constvalues": [],
    }


def _length(field: Field) -> int:
    """Return the number of an array's elements: 0 stands for any number, -1 for no array."""
    if field.array is None:
        return -1
    return field.array.fixed or 0


def _example(field: Field) -> str:
    """Return the field's default, as Python's ``str`` writes it."""
    if field.array is not None:
        return "[]"
    if field.is_nested or field.type in builtin.TIMES:
        return "{}"
    return str(field.default_value)
