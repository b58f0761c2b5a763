"""Creates message and service classes from definitions, one for each type in a process."""

from __future__ import annotations

from collections.abc import Callable, Collection
from dataclasses import replace
from threading import RLock
from typing import Any

from fibws.errors import InterfaceError
from fibws.interfaces import MessageDefinition, Service
from fibws.interfaces.catalogue import Definitions
from fibws.interfaces.full_text import write_message
from fibws.interfaces.md5sum import message_md5
from fibws.msg import default_interfaces
from genpy.member import attribute, make_member
from genpy.message import Message

_messages: dict[str, type[Message]] = {}
_services: dict[str, type[Service[Any, Any]]] = {}
_lock = RLock()
"""Held while classes are created: callbacks in several threads may request them."""


def message_class(name: str) -> type[Message]:
    """Return the class of a message type, ``std_msgs/Int32``.

    Raises:
        InterfaceError: the type is unknown, or its definition is invalid.
    """
    with _lock:
        if name not in _messages:
            definition = default_interfaces().message(name)
            if definition.type not in _messages:
                _messages[definition.type] = make_class(definition, "msg", definition.name)
            _messages[name] = _messages[definition.type]
        return _messages[name]


def service_class(name: str) -> type[Service[Any, Any]]:
    """Return the class of a service type, ``std_srvs/SetBool``; raise as `message_class`."""
    with _lock:
        if name not in _services:
            interfaces = default_interfaces()
            definition = interfaces.service(name)
            request_definition = definition.request
            if request_definition.text:  # Its line break separates it from the response.
                request_definition = replace(
                    request_definition, text=f"{request_definition.text}\n"
                )
            request = make_class(request_definition, "srv", definition.name)
            response = make_class(definition.response, "srv", definition.name)
            _services[name] = type(
                definition.name,
                (Service,),
                {
                    "__module__": f"{definition.package}.srv._{definition.name}",
                    "_type": definition.type,
                    "_md5sum": interfaces.service_md5(definition.type),
                    "_request_class": request,
                    "_response_class": response,
                    "Request": request,
                    "Response": response,
                },
            )
        return _services[name]


def forget(packages: Collection[str]) -> None:
    """Forget the classes of packages, so that changed definitions get new classes."""
    with _lock:
        for known in (_messages, _services):
            for name in [name for name in known if name.partition("/")[0] in packages]:
                del known[name]


def make_class(
    definition: MessageDefinition,
    kind: str,
    module: str,
    interfaces: Definitions | None = None,
    find: Callable[[str], type[Message]] = message_class,
) -> type[Message]:
    """Create a class.

    Args:
        definition: the message's definition.
        kind: ``msg`` or ``srv``, the name of its module in the package.
        module: the type whose module contains it.
        interfaces: the definitions of the types nested in it; by default those that are installed.
        find: returns the class of a nested type.

    Raises:
        InterfaceError: a field's or constant's name is that of a method.
    """
    interfaces = interfaces or default_interfaces()
    members = tuple(
        make_member(field, find(field.type) if field.is_nested else None)
        for field in definition.fields
    )
    constants = {attribute(each.name): each.value for each in definition.constants}
    for name in (*constants, *(member.attribute for member in members)):
        if hasattr(Message, name):
            raise InterfaceError(
                f"invalid name {name} of a field or a constant in {definition.type}: "
                "message classes have a method of this name"
            )
    namespace: dict[str, Any] = {
        **constants,
        "__module__": f"{definition.package}.{kind}._{module}",
        "__doc__": f"{definition.type}: {_fields(definition) or 'no fields'}",
        "__slots__": [member.attribute for member in members],
        "_slot_types": [field.ros1_type for field in definition.fields],
        "_type": definition.type,
        "_md5sum": _md5(definition, interfaces),
        "_has_header": definition.has_header,
        "_full_text": write_message(definition, interfaces.message),
        "_members": members,
        "_definition": definition,
        "_find_interfaces": staticmethod(lambda: interfaces),
    }
    return type(definition.name, (Message,), namespace)


def _fields(definition: MessageDefinition) -> str:
    return ", ".join(f"{field.full_type} {field.name}" for field in definition.fields)


def _md5(definition: MessageDefinition, interfaces: Definitions) -> str:
    return message_md5(definition, interfaces.message, {})
