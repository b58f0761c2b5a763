"""The type of a service: how its requests and responses get to the wire, and back."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Generic

from fibws.errors import InvalidMessage
from fibws.interfaces import Message
from fibws.interfaces.message import Req, Res
from fibws.node.wire import Wire


class ServiceType(Generic[Req, Res]):
    """One service type.

    Args:
        name: its name, ``package/Type``.
        request: its requests on the wire.
        response: its responses on the wire.
    """

    def __init__(self, name: str, request: Wire[Req], response: Wire[Res]) -> None:
        self.name = name
        self._request = request
        self._response = response

    def ask(self, given: Req | Mapping[str, Any] | None) -> dict[str, Any]:
        """A caller's request for the wire; fields that are not given have their defaults.

        Raises:
            InvalidMessage: a field does not fit the type.
            TypeError: it is a message of another class, or none.
        """
        return self._request.write({} if given is None else given)

    def asked(self, args: Any) -> Req:
        """The request that came from the wire, or `InvalidMessage`."""
        return self._request.read({} if args is None else args)

    def answer(self, given: object) -> dict[str, Any]:
        """What a handler returned, for the wire.

        As in rospy it may be a response, a dict of its fields, a tuple or list of them in order, or
        the only field's value.

        Raises:
            InvalidMessage: it is none of these; the texts are rospy's (rospy.service).
        """
        if given is None:
            raise InvalidMessage("service handler returned None")
        if not isinstance(given, Mapping | Message):
            fields = given if isinstance(given, (tuple, list)) else (given,)
            try:
                given = self._response.message_class(*fields)
            except TypeError as error:
                fault = f"handler returned wrong number of values: {error}"
                raise InvalidMessage(fault) from None
        try:
            return self._response.write(given)
        except (InvalidMessage, TypeError) as error:
            raise InvalidMessage(f"handler returned invalid value: {error}") from None

    def answered(self, values: Any) -> Res:
        """The response that came from the wire, or `InvalidMessage`."""
        return self._response.read(values)
