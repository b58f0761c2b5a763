"""The services that one client provides."""

from __future__ import annotations

from typing import NamedTuple

from fibws.errors import InvalidMessage
from fibws.hub.graph.service import Call, Service
from fibws.hub.session.client import Client, check_room
from fibws.protocol.operations import (
    AdvertiseService,
    Id,
    ServiceResponse,
    UnadvertiseService,
    encode_fields,
)


class Provided(NamedTuple):
    """One of the client's services, as it advertised it.

    Args:
        spelling: the service's name as the client knows it.
        headers: whether it wants the callers' headers.
    """

    service: Service
    spelling: str
    headers: bool


class Services:
    """One client's services, and the calls that it is to answer."""

    __slots__ = ("_client", "_due", "_provided")

    def __init__(self, client: Client) -> None:
        self._client = client
        self._provided: dict[str, Provided] = {}
        """By the service's name."""
        self._due: dict[Id, Call] = {}
        """What the client is to answer, by the ids that it was given."""

    @property
    def node(self) -> str:
        """The name of the client's node."""
        return self._client.node

    def names(self) -> list[str]:
        """The names of the services."""
        return list(self._provided)

    def advertise(self, request: AdvertiseService) -> None:
        """Provide a service; whoever did before is displaced."""
        name = self._client.resolve(request.service)
        if name not in self._provided:
            limit = self._client.settings.max_advertisements
            check_room(len(self._provided), limit, "advertisements")
        service = self._client.graph.add_service(name, request.type, request.definition, self)
        self._provided[name] = Provided(service, request.service, bool(request.headers))
        if service.type.arguments is None:
            self._client.statuses.warning(
                request.id, f"{name}: calls of type {service.type.name} are not checked"
            )
        self._client.statuses.info(request.id, f"{self.node} provides {name} ({service.type.name})")

    def unadvertise(self, request: UnadvertiseService) -> None:
        """Provide a service no more; what was asked of it fails at once."""
        if request.service is None:
            # ros-sharp sends no name, by mistake: none is taken back by that.
            return
        provided = self._provided.pop(self._client.resolve(request.service), None)
        if provided is not None:
            service = provided.service
            self._client.graph.remove_service(service)
            for id_, call in list(self._due.items()):
                if call.service.name == service.name:
                    self._fail(id_, f"Service {service.name} was unadvertised")

    def take(self, call: Call) -> None:
        """Ask the client."""
        provided = self._provided[call.service.name]
        call.id = f"service_request:{provided.spelling}:{next(self._client.numbers)}"
        fields = {
            "op": "call_service",
            "id": call.id,
            "service": provided.spelling,
            "args": call.request,
        }
        if provided.headers:
            fields["header"] = {"callerid": call.caller, **(call.headers or {})}
        if self._client.ask(encode_fields(fields)):
            self._due[call.id] = call
        else:
            call.fail(f"service [{call.service.name}] unavailable: {self.node} reads too slowly")

    def respond(self, response: ServiceResponse) -> None:
        """Take the client's answer to a call.

        Raises:
            InvalidMessage: it does not fit the type, as the caller was told, too.
        """
        call = self._due_call(response)
        if call is None:
            # It may have come too late.
            self._client.statuses.info(
                response.id, f"service_response: no call of {response.service} waits for this"
            )
            return
        if not response.result and not self._is_answer(response):
            reason = response.values
            name = call.service.name
            call.fail(
                reason
                if isinstance(reason, str) and reason
                else f"service [{name}] responded with an error"
            )
            return
        try:
            call.answer({} if response.values is None else response.values)
        except InvalidMessage as error:
            call.fail(str(error))
            raise

    def spoil(self, id_: object, text: str) -> None:
        """The client's answer to a call was no operation at all: ``text`` says why."""
        if isinstance(id_, str) and id_ in self._due:
            self._fail(id_, text)

    def forget(self, call: Call) -> None:
        """A call needs no answer any more."""
        self._due.pop(call.id, None)

    def displaced(self, service: Service) -> None:
        """Another provider has taken a service over; calls that are due may still be answered.

        It may be this one, by advertising again.
        """
        if self._client.graph.services[service.name].provider is not self:
            self._provided.pop(service.name, None)
            self._client.statuses.warning(None, f"{service.name} has another provider now")

    def _is_answer(self, response: ServiceResponse) -> bool:
        """Whether a failure is an answer all the same.

        The real server takes it for one if it has values, and roslibpy's users rely on that.
        """
        if not isinstance(response.values, dict) or self._client.settings.strict_responses:
            return False
        self._client.statuses.warning(
            response.id, "service_response: result is false, but there are values: taken for true"
        )
        return True

    def _due_call(self, response: ServiceResponse) -> Call | None:
        if response.id is not None:
            return self._due.pop(response.id, None)
        # Who sends no id answers in the order of the calls.
        name = self._client.resolve(response.service)
        for id_, call in self._due.items():
            if call.service.name == name:
                return self._due.pop(id_)
        return None

    def leave(self) -> None:
        """Take all back: the calls of others fail."""
        for provided in self._provided.values():
            self._client.graph.remove_service(provided.service)
        self._provided.clear()
        for id_, call in list(self._due.items()):
            self._fail(id_, f"service [{call.service.name}] unavailable: {self.node} has left")

    def _fail(self, id_: Id, text: str) -> None:
        self._due.pop(id_).fail(text)
