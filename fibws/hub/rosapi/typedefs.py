"""The fields of types, as rosapi/TypeDef lists them (rosapi's objectutils.py)."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial
from typing import Any, TypeAlias

from pydantic_core import to_json

from fibws.hub.graph.service import Function
from fibws.hub.rosapi.cache import TextCache
from fibws.interfaces import Interfaces, MessageDefinition, builtin
from fibws.interfaces.catalogue import Definitions
from fibws.interfaces.client_definitions import ClientDefinitions
from fibws.interfaces.definition import Field
from fibws.interfaces.folders import Kind

Find: TypeAlias = Callable[[Definitions, str], MessageDefinition]
"""Finds a message, or a part of a service or an action, by the name of the type."""


class TypeDefs:
    """Lists of type definitions: a type's own, then those of the types in it, depth first.

    Every list is the JSON of a response with ``typedefs`` in it. Names may have ROS 2's spelling.
    An unknown type raises `InterfaceError`.
    """

    def __init__(self, definitions: Interfaces | ClientDefinitions) -> None:
        self._definitions = definitions
        self._messages = TextCache(partial(_text, _message))
        self._requests = TextCache(partial(_text, _request))
        self._responses = TextCache(partial(_text, _response_of))
        self._goals = TextCache(partial(_text, _goal))
        self._feedback = TextCache(partial(_text, _feedback))
        self._results = TextCache(partial(_text, _result))

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
            "/rosapi/action_goal_details": ("rosapi/ActionGoalDetails", _for_type(self.goal)),
            "/rosapi/action_feedback_details": (
                "rosapi/ActionFeedbackDetails",
                _for_type(self.feedback),
            ),
            "/rosapi/action_result_details": ("rosapi/ActionResultDetails", _for_type(self.result)),
        }

    def message(self, name: str, caller: str = "") -> bytes:
        """Return the definitions of a message; none for the builtin types, except the times."""
        if name in builtin.TIMES:
            return _response([_time(name)])
        if name in builtin.NAMES:
            return _response([])
        return self._get(self._messages, "msg", name, caller)

    def request(self, name: str, caller: str = "") -> bytes:
        """Return the definitions of a service's request."""
        return self._get(self._requests, "srv", name, caller)

    def response(self, name: str, caller: str = "") -> bytes:
        """Return the definitions of a service's response."""
        return self._get(self._responses, "srv", name, caller)

    def goal(self, name: str, caller: str = "") -> bytes:
        """Return the definitions of an action's goal."""
        return self._get(self._goals, "action", name, caller)

    def feedback(self, name: str, caller: str = "") -> bytes:
        """Return the definitions of an action's feedback."""
        return self._get(self._feedback, "action", name, caller)

    def result(self, name: str, caller: str = "") -> bytes:
        """Return the definitions of an action's result."""
        return self._get(self._results, "action", name, caller)

    def _get(self, texts: TextCache, kind: Kind, name: str, caller: str) -> bytes:
        name, definitions = Interfaces.canonical(name), self._definitions
        if isinstance(definitions, ClientDefinitions):
            # A type that is hidden from the caller is unknown to it, even if its text is cached.
            return texts.get(definitions.known_to(caller, kind, name), name)
        return texts.get(definitions, name)


def _text(find: Find, definitions: Definitions, name: str) -> bytes:
    return _response(list(_typedefs(definitions, find(definitions, name), set())))


def _typedefs(
    definitions: Definitions, definition: MessageDefinition, seen: set[str]
) -> Iterator[dict[str, Any]]:
    yield _typedef(definition)
    for field in definition.fields:
        if field.type in seen:
            continue
        seen.add(field.type)
        if field.is_nested:
            yield from _typedefs(definitions, definitions.message(field.type), seen)
        elif field.type in builtin.TIMES:
            yield _time(field.type)


def _for_type(respond: Callable[[str, str], bytes]) -> Function:
    """Return the handler of a request that names a type."""
    return lambda request, caller: respond(request["type"], caller)


def _message(definitions: Definitions, name: str) -> MessageDefinition:
    return definitions.message(name)


def _request(definitions: Definitions, name: str) -> MessageDefinition:
    return definitions.service(name).request


def _response_of(definitions: Definitions, name: str) -> MessageDefinition:
    return definitions.service(name).response


def _goal(definitions: Definitions, name: str) -> MessageDefinition:
    return definitions.action(name).goal


def _feedback(definitions: Definitions, name: str) -> MessageDefinition:
    return definitions.action(name).feedback


def _result(definitions: Definitions, name: str) -> MessageDefinition:
    return definitions.action(name).result


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
