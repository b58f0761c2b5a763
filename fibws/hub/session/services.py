"""The services that one client provides, and its calls of others'."""

from __future__ import annotations

from itertools import count

from pydantic_core import to_json

from fibws.errors import FibwsError, InvalidMessage, OperationError
from fibws.hub.clock import Timer
from fibws.hub.framing import text_frame
from fibws.hub.graph.encoding import text_frames
from fibws.hub.graph.service import Call, Service
from fibws.hub.session.client import Client
from fibws.protocol.operations import (
    AdvertiseService,
    CallService,
    Id,
    ServiceResponse,
    UnadvertiseService,
    encode_fields,
)

LONGEST_TIMEOUT = 86400.0
"""Seconds that a call may ask for: a day."""


class Services:
    """One client's part in services, as provider and as caller."""

    __slots__ = ("_alarm", "_calls", "_client", "_due", "_numbers", "_provided", "_rings")

    def __init__(self, client: Client) -> None:
        self._client = client
        self._provided: dict[str, tuple[Service, str]] = {}
        """By the service's name, with the spelling of it that the client knows."""
        self._due: dict[Id, Call] = {}
        """What the client is to answer, by the ids that it was given."""
        self._calls: dict[Call, CallService] = {}
        """What the client waits for."""
        self._alarm: Timer | None = None
        self._rings = 0.0
        """When the alarm will go off: it is one for all calls, no later than the first is due."""
        self._numbers = count(1)

    @property
    def node(self) -> str:
        """The name of the client's node."""
        return self._client.node

    def provided(self) -> list[str]:
        """The names of the services that it provides."""
        return list(self._provided)

    # As a caller.

    def call(self, request: CallService) -> None:
        """Call a service; whatever becomes of that, there is a response."""
        spelling, hash_, suffix = request.service.partition("#")
        if hash_ and request.id is None:
            # An id behind the name, as the real server's call_service.py takes it.
            request = request.model_copy(update={"id": suffix})
        try:
            self._call(request, self._client.resolve(spelling if hash_ else request.service))
        except FibwsError as error:
            self._fail(request, str(error))

    def _call(self, request: CallService, name: str) -> None:
        service = self._client.graph.services.get(name)
        if service is None:
            raise OperationError(f"Service {name} does not exist")
        self._client.check_room(len(self._calls), "max_calls")
        valid = service.type.ask(request.args)
        call = Call(service, valid, self.node, self._succeeded, self._failed)
        call.due = self._client.clock.time() + self._patience(request)
        self._calls[call] = request
        self._watch(call.due)
        call.start()

    def _succeeded(self, call: Call, values: bytes) -> None:
        self._respond(self._calls.pop(call), values, result=True)

    def _failed(self, call: Call, text: str) -> None:
        self._fail(self._calls.pop(call), text)

    def _fail(self, request: CallService, text: str) -> None:
        self._respond(request, to_json(text), result=False)

    def _respond(self, request: CallService, values: bytes, *, result: bool) -> None:
        fields = {
            "op": "service_response",
            "service": request.service,
            "id": request.id,
            "result": result,
        }
        text = encode_fields(fields, values=values)
        self._client.outbox.reply(text_frames(text, request.fragment_size, self._fragment_id))

    def _fragment_id(self) -> str:
        return f"service_response:{next(self._numbers)}"

    def _watch(self, due: float) -> None:
        """See to it that the alarm goes off when a call is due."""
        if self._alarm is not None:
            if self._rings <= due:
                return
            self._alarm.cancel()
        self._rings = due
        clock = self._client.clock
        self._alarm = clock.call_later(due - clock.time(), self._give_up)

    def _patience(self, request: CallService) -> float:
        """Seconds for which a call is waited for; no time of its own, or 0, is the hub's."""
        if request.timeout is None or request.timeout <= 0:
            return self._client.settings.service_timeout
        return min(request.timeout, LONGEST_TIMEOUT)

    def _give_up(self) -> None:
        """Fail the calls that are overdue."""
        self._alarm = None
        for call in [each for each in self._calls if each.due <= self._rings]:
            call.give_up(self._patience(self._calls[call]))
        if self._calls:
            self._watch(min(call.due for call in self._calls))

    # As a provider.

    def advertise(self, request: AdvertiseService) -> None:
        """Provide a service; whoever did before is displaced."""
        name = self._client.resolve(request.service)
        if name not in self._provided:
            self._client.check_room(len(self._provided), "max_advertisements")
        service = self._client.graph.add_service(name, request.type, request.definition, self)
        self._provided[name] = (service, request.service)
        if service.type.arguments is None:
            self._client.statuses.warning(
                request.id, f"{name}: calls of type {service.type.type} are not checked"
            )
        self._client.statuses.info(request.id, f"{self.node} provides {name} ({service.type.type})")

    def unadvertise(self, request: UnadvertiseService) -> None:
        """Provide a service no more; what was asked of it fails at once."""
        if request.service is None:
            # ros-sharp sends no name, by mistake: none is taken back by that.
            return
        service, _ = self._provided.pop(self._client.resolve(request.service), (None, ""))
        if service is not None:
            self._client.graph.remove_service(service)
            for id_, call in list(self._due.items()):
                if call.service.name == service.name:
                    del self._due[id_]
                    call.fail(f"Service {service.name} was unadvertised")

    def take(self, call: Call) -> None:
        """Ask the client."""
        _, spelling = self._provided[call.service.name]
        id_ = f"service_request:{spelling}:{next(self._numbers)}"
        text = encode_fields(
            {"op": "call_service", "id": id_, "service": spelling, "args": call.request}
        )
        outbox = self._client.outbox
        if outbox.has_room(len(text)):
            call.id = id_
            self._due[id_] = call
            outbox.reply(text_frame(text))
        else:
            # Its replies may not be dropped: it must not be others' calls that break its bounds.
            call.fail(f"service [{call.service.name}] unavailable: {self.node} reads too slowly")

    def respond(self, response: ServiceResponse) -> None:
        """Take the client's answer to a call.

        Raises:
            OperationError: it does not fit the type, as the caller was told, too.
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

    def forget(self, call: Call) -> None:
        """A call needs no answer any more."""
        self._due.pop(call.id, None)

    def displaced(self, service: Service) -> None:
        """Another client has taken a service over; calls that this one has may still be answered.

        A client may displace itself, by advertising again.
        """
        provided = self._provided.get(service.name)
        if provided is not None and provided[0] is service:
            del self._provided[service.name]
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
        """Take all back: the calls of others fail, its own need no answer."""
        for service, _ in self._provided.values():
            self._client.graph.remove_service(service)
        self._provided.clear()
        for call in list(self._calls):
            call.abandon()
        self._calls.clear()
        if self._alarm is not None:
            self._alarm.cancel()
            self._alarm = None
        for id_, call in list(self._due.items()):
            del self._due[id_]
            call.fail(f"service [{call.service.name}] unavailable: {self.node} has left")
