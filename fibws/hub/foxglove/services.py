"""The services that one client calls."""

from __future__ import annotations

from typing import NamedTuple

from pydantic_core import from_json

from fibws.errors import FibwsError, OperationError
from fibws.hub.errors import CallFailed, UnknownDefinition
from fibws.hub.foxglove.client import FoxgloveClient
from fibws.hub.foxglove.feeds import ServiceFeed
from fibws.hub.foxglove.messages import (
    ENCODINGS,
    JSON,
    ClientRequest,
    response_frame,
    text_frame,
)
from fibws.hub.graph.body import Body
from fibws.hub.graph.service import Call
from fibws.hub.log.text import INTERNAL_ERROR, shortened
from fibws.hub.websocket.endpoint import Removals, Work
from fibws.interfaces.json_text import plain_json
from fibws.interfaces.serialized_values import SerializedValues
from fibws.protocol.value_limits import check_json


class FoxgloveCall(NamedTuple):
    """A call until its response, by the numbers that the client knows it by."""

    service: int
    call: int
    encoding: str


class FoxgloveCalls:
    """One client's calls until their responses; each call gets one.

    Args:
        services: those that the client may call.
    """

    def __init__(self, client: FoxgloveClient, services: ServiceFeed) -> None:
        self._client = client
        self._services = services
        self._waiting: dict[Call, FoxgloveCall] = {}

    def call(self, request: ClientRequest) -> None:
        """Call a service; a failure is sent to the client."""
        if self._client.queue.overfull:
            return  # No response would be kept: the client is to be closed.
        try:
            self._start(request)
        except FibwsError as error:
            self.refuse(request, str(error))
        except Exception as fault:
            self.refuse(request, INTERNAL_ERROR, fault)

    def refuse(self, request: ClientRequest, text: str, fault: Exception | None = None) -> None:
        """Respond that a call has failed before its service was asked."""
        self._fail(request.service, request.call, text)
        self._client.statuses.log(f"service {request.service}: {text}", fault=fault)

    def withdraw_forbidden(self) -> Work:
        """End, one by one, the calls that the client's rights do not allow any more."""
        for call in list(self._waiting):
            if call in self._waiting and not self._client.is_allowed("call", call.service.name):
                call.withdraw()
            yield

    def leave(self) -> Removals:
        """Return the calls that are to be abandoned."""
        return ((self._abandon, list(self._waiting)),)

    def _abandon(self, call: Call) -> None:
        if self._waiting.pop(call, None) is not None:  # It may have ended meanwhile.
            call.abandon()

    def _start(self, request: ClientRequest) -> None:
        client = self._client
        entry = self._services.find(request.service)
        if entry is None:
            raise CallFailed(f"Unknown service ID: {request.service}", "unknown_service")
        if request.encoding not in ENCODINGS:
            known = " or ".join(ENCODINGS)
            raise OperationError(f"encoding must be {known}, got {request.encoding!r}")
        limit = client.settings.max_calls
        if len(self._waiting) >= limit:
            raise OperationError(f"too many calls of one client (limit {limit}, --max-calls)")
        service = client.view.service(entry.name)
        if service is None:
            raise CallFailed(f"Service {entry.name} does not exist", "unknown_service")
        type_ = service.type
        if type_.codecs is None:
            raise UnknownDefinition(type_.name, type_.fault)
        if (type_.name, type_.md5sum) != (entry.type, entry.md5sum):
            raise CallFailed(f"Service {entry.name} has another type now", "type_conflict")
        args = _read(request)
        call = client.graph.call(entry.name, args, client.node, self._succeeded, self._failed)
        self._waiting[call] = FoxgloveCall(request.service, request.call, request.encoding)
        try:
            call.start(client.settings.service_timeout, client.clock.call_later)
        except Exception:
            del self._waiting[call]
            raise

    def _succeeded(self, call: Call, response: Body) -> None:
        waiting = self._waiting.pop(call)
        try:
            is_json = waiting.encoding == JSON
            data = plain_json(response.json()) if is_json else response.ros1()
        except FibwsError as error:  # It came as bytes that are too much for JSON.
            self._fail(waiting.service, waiting.call, str(error))
            return
        except Exception as fault:  # It is no fault of the server's.
            self._fail(waiting.service, waiting.call, INTERNAL_ERROR)
            self._client.statuses.log(f"{call.service.name}: {INTERNAL_ERROR}", fault=fault)
            return
        frame = response_frame(waiting.service, waiting.call, waiting.encoding, data)
        self._client.queue.reply(frame)

    def _failed(self, call: Call, text: str, code: str) -> None:
        waiting = self._waiting.pop(call)
        self._fail(waiting.service, waiting.call, text)

    def _fail(self, service: int, call: int, text: str) -> None:
        message = shortened(text)
        frame = text_frame("serviceCallFailure", serviceId=service, callId=call, message=message)
        self._client.queue.reply(frame)


def _read(request: ClientRequest) -> object:
    """Return the values of a request; raise `OperationError` if they are invalid JSON."""
    if request.encoding == JSON:
        text = bytes(request.data)
        check_json(text)
        try:
            return from_json(text) if text.strip() else {}
        except ValueError as error:
            raise OperationError(f"invalid JSON: {error}") from None
    return SerializedValues(bytes(request.data))
