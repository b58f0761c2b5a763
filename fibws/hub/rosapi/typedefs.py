"""What types are made of, as rosapi/TypeDef tells it (rosapi's objectutils.py)."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

from pydantic_core import to_json

from fibws.hub.graph.service import Function
from fibws.hub.rosapi.texts import Texts
from fibws.interfaces import Interfaces, MessageDefinition, builtin
from fibws.interfaces.definition import Field


class TypeDefs:
    """Lists of type definitions: a type's own, then those of the types in it, depth first.

    Every list is the JSON text of a response with ``typedefs`` in it. Names may have ROS 2's
    spelling. What there is no definition of raises `InterfaceError`.
    """

    def __init__(self, interfaces: Interfaces) -> None:
        self._interfaces = interfaces
        self._messages = Texts(lambda name: self._text(interfaces.message(name)))
        self._requests = Texts(lambda name: self._text(interfaces.service(name).request))
        self._responses = Texts(lambda name: self._text(interfaces.service(name).response))

    def services(self) -> dict[str, tuple[str, Function]]:
        """All by their global names, each with its type and what answers it."""
        return {
            "/rosapi/message_details": ("rosapi/MessageDetails", _asked_for(self.message)),
            "/rosapi/service_request_details": (
                "rosapi/ServiceRequestDetails",
                _asked_for(self.request),
            ),
            "/rosapi/service_response_details": (
                "rosapi/ServiceResponseDetails",
                _asked_for(self.response),
            ),
        }

    def message(self, name: str) -> bytes:
        """Of a message; of a type that ROS itself defines, which is no message, there are none."""
        if name in builtin.TIMES:
            return _response([_time(name)])
        if name in builtin.NAMES:
            return _response([])
        return self._messages.of(self._interfaces.canonical(name))

    def request(self, name: str) -> bytes:
        """Of a service's request."""
        return self._requests.of(self._interfaces.canonical(name))

    def response(self, name: str) -> bytes:
        """Of a service's response."""
        return self._responses.of(self._interfaces.canonical(name))

    def _text(self, definition: MessageDefinition) -> bytes:
        return _response(list(self._typedefs(definition, set())))

    def _typedefs(self, definition: MessageDefinition, seen: set[str]) -> Iterator[dict[str, Any]]:
        yield _typedef(definition)
        for field in definition.fields:
            if field.type in seen:
                continue
            seen.add(field.type)
            if field.is_nested:
                yield from self._typedefs(self._interfaces.message(field.type), seen)
            elif field.type in builtin.TIMES:
                yield _time(field.type)


def _asked_for(tell: Callable[[str], bytes]) -> Function:
    """What answers a request that names a type."""
    return lambda request, caller: tell(request["type"])


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
    """The two types of time as if they were messages; unsigned or not, their parts are int32."""
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
    """The elements of an array: 0 stands for any number of them, and -1 for no array."""
    if field.array is None:
        return -1
    return field.array.fixed or 0


def _example(field: Field) -> str:
    """What the field is unless told otherwise, as Python's ``str`` writes it."""
    if field.array is not None:
        return "[]"
    if field.is_nested or field.type in builtin.TIMES:
        return "{}"
    return str(field.default_value)
