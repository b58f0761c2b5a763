"""What a service is asked and what it answers: from Python to the wire, and back."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any, Generic

from fibws.errors import InvalidMessage
from fibws.interfaces import Duration, Message, Service, Time
from fibws.interfaces.bases import Req, Res


class ServiceType(Generic[Req, Res]):
    """One service type.

    Args:
        service: its class.
        name: its name, ``package/Type``.
        check_request: fills a request's fields, or raises `InvalidMessage`.
        check_response: does so for a response.
    """

    def __init__(
        self,
        service: type[Service[Req, Res]],
        name: str,
        check_request: Callable[[Any], dict[str, Any]],
        check_response: Callable[[Any], dict[str, Any]],
    ) -> None:
        self.name = name
        self._request = service.Request
        self._response = service.Response
        self._check_request = check_request
        self._check_response = check_response

    def ask(self, given: Req | Mapping[str, Any] | None) -> dict[str, Any]:
        """A caller's request for the wire; fields that are not given have their defaults.

        Raises:
            InvalidMessage: a field does not fit the type.
            TypeError: it is a message of another class, or none.
        """
        if given is None:
            given = {}
        if not isinstance(given, Mapping) and not isinstance(given, self._request):
            raise TypeError(f"expected [{self._request._type}] but got [{_name(given)}]")
        return self._check_request(_plain(given))

    def asked(self, args: Any) -> Req:
        """The request that came from the wire, or `InvalidMessage`."""
        return self._request.from_dict(self._check_request({} if args is None else args))

    def answer(self, given: object) -> dict[str, Any]:
        """What a handler returned, for the wire.

        As in rospy it may be a response, a dict of its fields, a tuple or list of them in order, or
        the only field's value.

        Raises:
            InvalidMessage: it is none of these; the texts are rospy's (rospy.service).
        """
        if given is None:
            raise InvalidMessage("service handler returned None")
        if isinstance(given, Message):
            if not isinstance(given, self._response):
                fault = f"expected [{self._response._type}] but got [{given._type}]"
                raise InvalidMessage(f"handler returned invalid value: {fault}")
        elif not isinstance(given, Mapping):
            fields = given if isinstance(given, (tuple, list)) else (given,)
            try:
                given = self._response(*fields)
            except TypeError as error:
                fault = f"handler returned wrong number of values: {error}"
                raise InvalidMessage(fault) from None
        try:
            return self._check_response(_plain(given))
        except InvalidMessage as error:
            raise InvalidMessage(f"handler returned invalid value: {error}") from None

    def answered(self, values: Any) -> Res:
        """The response that came from the wire, or `InvalidMessage`."""
        return self._response.from_dict(self._check_response(values))


def _plain(value: object) -> Any:
    """A message, or fields that may hold messages, as JSON has it."""
    match value:
        case Message():
            return value.to_dict()
        case Time() | Duration():
            return {"secs": value.secs, "nsecs": value.nsecs}
        case Mapping():
            return {name: _plain(field) for name, field in value.items()}
        case list() | tuple():
            return [_plain(element) for element in value]
        case _:
            return value


def _name(value: object) -> str:
    return value._type if isinstance(value, Message) else type(value).__name__
