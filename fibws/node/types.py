"""The types that a node speaks: their classes, and what it must tell the hub about them."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, cast

from typing_extensions import TypeVar

from fibws.action import action_class
from fibws.interfaces import Action, Message, Service, Validators
from fibws.interfaces.message import F, G, R, Req, Res
from fibws.msg import default_interfaces, message_class
from fibws.node.service_type import ServiceType
from fibws.node.wire import Wire
from fibws.srv import service_class

M = TypeVar("M", bound=Message, default=Any)


class Types:
    """One node's types.

    Args:
        now: gives the nanoseconds since 1970.
    """

    def __init__(self, now: Callable[[], int]) -> None:
        self._interfaces = default_interfaces()
        self._validators = Validators(self._interfaces, now)
        self._services: dict[type[Service[Any, Any]], ServiceType[Any, Any]] = {}

    def message_class(self, type_: Callable[..., M] | str) -> type[M]:
        """The class itself, or that of the type of this name.

        Raises:
            InterfaceError: there is no such type.
        """
        if isinstance(type_, str):
            return cast(type[M], message_class(self._interfaces.message(type_).type))
        found = cast(type[M], type_)
        self._interfaces.message(found._type)
        return found

    def validate(self, type_: str) -> Callable[[Any], dict[str, Any]]:
        """What checks a message of the type and fills its fields."""
        return self._validators.of(type_).validate

    def wire(self, message_class: type[M]) -> Wire[M]:
        """The way of a class's messages to the wire and back."""
        return Wire(message_class, self.validate(message_class._type))

    def definition(self, type_: str) -> str | None:
        """The text that explains the type to a hub that may not have it: none for standard ones."""
        if self._interfaces.is_users(self._interfaces.message(type_).package):
            return self._interfaces.full_text(type_)
        return None

    def service_class(self, type_: type[Service[Req, Res]] | str) -> type[Service[Any, Any]]:
        """The class itself, or that of the service type of this name; as `message_class`."""
        return service_class(type_) if isinstance(type_, str) else type_

    def service(self, type_: type[Service[Req, Res]]) -> ServiceType[Req, Res]:
        """The messages of a service type, on their way to the wire and back.

        Raises:
            InterfaceError: there is no such type.
        """
        if type_ not in self._services:
            definition = self._interfaces.service(type_._type)
            request = self._validators.of_definition(definition.request).validate
            response = self._validators.of_definition(definition.response).validate
            self._services[type_] = ServiceType(
                definition.type, Wire(type_.Request, request), Wire(type_.Response, response)
            )
        return self._services[type_]

    def service_definition(self, type_: str) -> str | None:
        """As `definition`, for a service type."""
        if self._interfaces.is_users(self._interfaces.service(type_).package):
            return self._interfaces.service_text(type_)
        return None

    def action_class(self, type_: type[Action[G, R, F]] | str) -> type[Action[Any, Any, Any]]:
        """The class itself, or that of the action type of this name; as `message_class`."""
        return action_class(type_) if isinstance(type_, str) else type_

    def action_definition(self, type_: str) -> str | None:
        """As `definition`, for an action type."""
        if self._interfaces.is_users(self._interfaces.action(type_).package):
            return self._interfaces.action_text(type_)
        return None
