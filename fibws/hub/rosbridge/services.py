"""The services that one client calls, and those that it serves."""

from __future__ import annotations

import secrets
from collections import OrderedDict
from typing import Any, NamedTuple

from fibws.errors import FibwsError, InvalidMessage, InvalidName, NotSerialized, OperationError
from fibws.hub.errors import NotAllowed
from fibws.hub.graph.body import Body
from fibws.hub.graph.service import Call, Service
from fibws.hub.rosbridge.client import RosbridgeClient, check_room
from fibws.hub.websocket.endpoint import Removals, Work
from fibws.interfaces.serialized_values import SerializedValues
from fibws.protocol.operations import (
    LONGEST_ID,
    AdvertiseService,
    CallService,
    Id,
    ServiceResponse,
    UnadvertiseService,
    encode_fields,
    json_of,
    legal_id,
)
from fibws.protocol.serialized import ROS1

LONGEST_TIMEOUT = 86400.0
"""Seconds that a call may ask for: a day."""
SECRET_BYTES = 8
"""Random bytes in the ids of a server's calls."""


class RosbridgeCall(NamedTuple):
    """A call until its response, without its arguments, which may be large.

    ``headers`` is true if the caller sent headers, and so wants the server's; ``serialized`` if its
    request came as bytes, and so the response is to.
    """

    id: Id
    service: str
    fragment_size: int | None
    headers: bool = False
    serialized: bool = False


class RosbridgeCalls:
    """One client's calls until their responses; each call gets one."""

    __slots__ = ("_client", "_waiting")

    def __init__(self, client: RosbridgeClient) -> None:
        self._client = client
        self._waiting: dict[Call, RosbridgeCall] = {}

    def call(self, request: CallService) -> None:
        """Call a service.

        Raises:
            OperationError: the id behind the service's name is too long.
        """
        if self._client.queue.overfull:
            # No response would be kept, and it may be much work: the client is to be closed.
            return
        spelling, hash_, suffix = request.service.partition("#")
        if len(suffix) > LONGEST_ID:
            raise OperationError(f"an id behind the # has at most {LONGEST_ID} characters")
        # There may be an id behind the name, as the real server's call_service.py takes it.
        id_ = suffix if hash_ and request.id is None else request.id
        waiting = RosbridgeCall(
            id_,
            request.service,
            request.fragment_size,
            headers=request.headers is not None,
            serialized=isinstance(request.args, SerializedValues),
        )
        try:
            self._start(waiting, self._client.resolve(spelling), request)
        except FibwsError as error:
            self._fail(waiting, str(error), error.code)

    def refuse(self, fields: dict[str, Any], text: str, code: str) -> None:
        """Respond with an error to a malformed call_service: its caller may wait all the same."""
        service, id_ = fields.get("service"), legal_id(fields.get("id"))
        if isinstance(service, str) and id_ is not None:
            self._fail(RosbridgeCall(id_, service, None), text, code)

    def withdraw_forbidden(self) -> Work:
        """End, one by one, the calls that the client's rights do not allow any more."""
        client = self._client
        for call in list(self._waiting):
            is_allowed = client.graph.rights.allows(client.node, "call", call.service.name)
            if call in self._waiting and not is_allowed:
                call.withdraw()
            yield

    def leave(self) -> Removals:
        """Return the calls that are to be abandoned."""
        return ((self._abandon, list(self._waiting)),)

    def _abandon(self, call: Call) -> None:
        if self._waiting.pop(call, None) is not None:  # It may have ended meanwhile.
            call.abandon()

    def _start(self, waiting: RosbridgeCall, name: str, request: CallService) -> None:
        client = self._client
        check_room(len(self._waiting), client.settings.max_calls, "calls")
        call = client.graph.call(
            name, request.args, client.node, self._succeeded, self._failed, request.headers
        )
        self._waiting[call] = waiting
        try:
            call.start(self._timeout(request), client.clock.call_later)
        except Exception:
            self._waiting.pop(call, None)
            raise

    def _succeeded(self, call: Call, response: Body) -> None:
        waiting = self._waiting.pop(call)
        fields = self._fields(waiting, None)
        if waiting.headers:
            fields["header"] = {"callerid": call.service.node}
        try:
            frames = self._client.body_frames(
                fields,
                response,
                serialized=waiting.serialized,
                fragment_size=waiting.fragment_size,
            )
        except FibwsError as error:  # It came as bytes that are too much for JSON.
            self._fail(waiting, str(error), error.code)
        else:
            self._client.queue.reply(frames)

    def _failed(self, call: Call, text: str, code: str) -> None:
        self._fail(self._waiting.pop(call), text, code)

    def _fail(self, waiting: RosbridgeCall, text: str, code: str) -> None:
        fields = self._fields(waiting, code)
        self._client.reply(encode_fields(fields, values=json_of(text)), waiting.fragment_size)

    def _fields(self, waiting: RosbridgeCall, code: str | None) -> dict[str, Any]:
        """Return the fields of a response, without its values."""
        return {
            "op": "service_response",
            "service": waiting.service,
            "id": waiting.id,
            "result": code is None,
            "code": self._client.code(code),
        }

    def _timeout(self, request: CallService) -> float:
        """Return the seconds that a call may take, 0 for no limit; the hub has a default."""
        if request.timeout is None or request.timeout <= 0:
            return self._client.settings.service_timeout
        return min(request.timeout, LONGEST_TIMEOUT)


class ServedService(NamedTuple):
    """One of the client's services, as it advertised it.

    ``spelling`` is the service's name as the client knows it; ``headers`` is true if it wants
    the callers' headers. Requests are serialized if the type has the ``md5sum``.
    """

    service: Service
    spelling: str
    headers: bool
    md5sum: str | None


class RosbridgeServices:
    """One client's services, and the calls that it is to respond to; a `ServiceServer`.

    As with the real server, a response may come on another connection than the call went out on:
    rosbridgecpp opens one for each operation. Any client that names the call's id and may provide
    the service can respond. Ids hold a secret of the server's that others cannot guess.
    """

    __slots__ = ("_calls", "_calls_of", "_client", "_secret", "_served")

    def __init__(self, client: RosbridgeClient) -> None:
        self._client = client
        self._secret = secrets.token_hex(SECRET_BYTES)
        """Finds the server by the ids of its calls."""
        self._served: dict[str, ServedService] = {}
        """By the service's name."""
        self._calls: dict[Id, Call] = {}
        """The calls that wait for the client, by the ids that it was given."""
        self._calls_of: dict[str, OrderedDict[Id, Call]] = {}
        """The same by the services' names, the oldest first."""

    @property
    def node(self) -> str:
        """The name of the client's node."""
        return self._client.node

    def names(self) -> list[str]:
        """Return the names of the services."""
        return list(self._served)

    def advertise(self, request: AdvertiseService) -> None:
        """Serve a service; an older server is displaced."""
        name = self._client.resolve(request.service)
        if "#" in name:
            raise InvalidName(request.service, "in calls, an id follows the #")
        if name not in self._served:
            self._client.check_room("advertisements", len(self._served))
        service = self._client.graph.serve(name, request.type, request.definition, self)
        is_serialized = self._client.serialized and request.compression == ROS1
        md5sum = request.md5sum if is_serialized else None
        served = ServedService(service, request.service, bool(request.headers), md5sum)
        self._served[name] = served
        self._client.servers[self._secret] = self
        statuses, type_ = self._client.statuses, service.type
        if type_.arguments is None:
            text = f"{name}: calls of type {type_.name} are not checked"
            statuses.unchecked(request.id, text, type_)
        self._client.check_legal(request.id, request.service, name)
        statuses.info(request.id, f"{self.node} provides {name} ({type_.name})")

    def unadvertise(self, request: UnadvertiseService) -> Work | None:
        """Stop serving a service; return the steps that fail the calls that wait."""
        if request.service is None:
            # ros-sharp sends no name, by mistake: that takes none back.
            return None
        name = self._client.resolve(request.service)
        return self._remove(name) if name in self._served else None

    def _remove(self, name: str) -> Work:
        served = self._served.pop(name, None)
        if served is not None:
            self._client.graph.remove_service(served.service)
        return self._fail_all(name)

    def _fail_all(self, name: str) -> Work:
        for id_ in list(self._calls_of.get(name, ())):
            self._fail(id_, f"Service {name} was unadvertised", "server_lost")
            yield

    def withdraw_forbidden(self) -> Work:
        """Take back, one by one, the services that the client's rights do not allow any more.

        Another server may have displaced the client; the calls that it still has fail, too.
        """
        for name in dict.fromkeys((*self._served, *self._calls_of)):
            if not self._client.graph.rights.allows(self.node, "provide", name):
                yield from self._remove(name)
                self._client.report_withdrawn("provide", name)
            yield

    def handle(self, call: Call) -> None:
        """Pass a call to the client."""
        served = self._served[call.service.name]
        number = next(self._client.numbers)
        call.id = f"service_request:{served.spelling}:{self._secret}-{number}"
        fields: dict[str, Any] = {
            "op": "call_service",
            "id": call.id,
            "service": served.spelling,
        }
        if served.headers:
            fields["header"] = self._client.graph.header(call.caller, call.headers or {})
        serialized = served.md5sum is not None and served.md5sum == call.service.type.md5sum
        try:
            frame = self._client.body_frames(fields, call.request, serialized=serialized)
        except FibwsError as error:  # It came as bytes that are too much for JSON.
            call.fail(str(error), error.code)
            return
        if self._client.forward_request(frame):
            self._calls[call.id] = call
            self._calls_of.setdefault(call.service.name, OrderedDict())[call.id] = call
        else:
            text = f"service [{call.service.name}] unavailable: {self.node} reads too slowly"
            call.fail(text, "server_busy")

    def respond(self, response: ServiceResponse) -> None:
        """Take the client's response to a call.

        Raises:
            InvalidMessage, NotSerialized: it does not fit the type; the caller gets the error, too.
            NotAllowed: the call went to another client, and this one may not provide the service.
        """
        call = self._server_of(response.id)._pop_call(response)
        if call is None:
            # It may have come too late.
            self._client.statuses.info(
                response.id, f"service_response: no call of {response.service} waits for this"
            )
            return
        if not response.result and not self._counts_as_success(response):
            reason = response.values
            name = call.service.name
            call.fail(
                reason
                if isinstance(reason, str) and reason
                else f"service [{name}] responded with an error"
            )
            return
        try:
            call.respond({} if response.values is None else response.values)
        except (InvalidMessage, NotSerialized) as error:
            call.fail(str(error), error.code)
            raise

    def fail_malformed_response(self, id_: object, text: str, code: str) -> None:
        """Fail the call whose service_response was malformed."""
        try:
            server = self._server_of(id_)
        except NotAllowed:
            return
        if isinstance(id_, str) and id_ in server._calls:
            server._fail(id_, text, code)

    def cancel(self, call: Call) -> None:
        """Forget a call, which needs no response any more."""
        self._pop(call.id)

    def displaced(self, service: Service) -> None:
        """Called when another server has the service; calls that wait may still be answered.

        It may be this one, by advertising again.
        """
        newer = self._client.graph.services[service.name]
        if newer.server is not self:
            self._served.pop(service.name, None)
            self._client.statuses.displaced(service.name, newer.node)

    def leave(self) -> Removals:
        """Serve nothing any more, and return the services to remove and the calls that fail."""
        graph = self._client.graph
        services = [served.service for served in self._served.values()]
        self._served.clear()
        self._client.servers.pop(self._secret, None)
        graph.abandon(services)
        return (graph.remove_service, services), (self._lose, list(self._calls))

    def _lose(self, id_: Id) -> None:
        call = self._calls.get(id_)
        if call is not None:
            text = f"service [{call.service.name}] unavailable: {self.node} has left"
            self._fail(id_, text, "server_lost")

    def _counts_as_success(self, response: ServiceResponse) -> bool:
        """Return whether a failure is taken for a response all the same.

        The real server does so if it has values, and roslibpy's users rely on that.
        """
        if not isinstance(response.values, dict) or self._client.settings.strict_responses:
            return False
        self._client.statuses.warning(
            response.id, "service_response: result is false, but there are values: taken for true"
        )
        return True

    def _server_of(self, id_: object) -> RosbridgeServices:
        """Return the server whose call has an id: another client's, or else this one.

        Raises:
            NotAllowed: it is another client's, and this one may not provide the service.
        """
        if not isinstance(id_, str) or id_ in self._calls:
            return self
        server = self._client.servers.get(id_.rpartition(":")[2].partition("-")[0])
        call = server._calls.get(id_) if server is not None else None
        if server is None or call is None:
            return self
        self._client.graph.rights.check(self.node, "provide", call.service.name)
        return server

    def _pop_call(self, response: ServiceResponse) -> Call | None:
        if response.id is not None:
            return self._pop(response.id)
        # A client that sends no id responds in the order of the calls.
        calls = self._calls_of.get(self._client.resolve(response.service))
        return self._pop(next(iter(calls))) if calls else None

    def _pop(self, id_: Id) -> Call | None:
        call = self._calls.pop(id_, None)
        if call is not None:
            calls = self._calls_of[call.service.name]
            del calls[id_]
            if not calls:
                del self._calls_of[call.service.name]
        return call

    def _fail(self, id_: Id, text: str, code: str) -> None:
        call = self._pop(id_)
        if call is not None:
            call.fail(text, code)
