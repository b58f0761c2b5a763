"""Services: their servers, and their calls until the response.

A call gets exactly one response: its server's, or the hub's own when the server is lost, does not
respond in time, or responds with something that does not fit the type.
"""

from __future__ import annotations

import logging
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from typing import Any, Protocol, TypeAlias

from fibws.errors import FibwsError
from fibws.hub.errors import CallFailed, NotAllowed
from fibws.hub.graph.body import Body, check_serialized
from fibws.hub.graph.totals import CallTotals
from fibws.hub.graph.types import ServiceType
from fibws.interfaces.serialized_values import SerializedValues

logger = logging.getLogger("fibws.hub")

REQUEST, RESPONSE = 0, 1
"""The messages of a service's type."""
ANY_MD5SUM = "*"
"""The md5sum of a caller that leaves open which type it means."""

CallLater: TypeAlias = Callable[[float, Callable[[], object]], Any]
"""Calls a function after some seconds, and returns what cancels that: ``call_later`` of a loop."""
Response: TypeAlias = dict[str, Any] | bytes
"""A response's values, or their JSON where that is at hand."""


class Deferred:
    """A response of the hub's own that may come later.

    It ends once: with a response, or because no caller waits for one. Its two sides may come in any
    order: a response may be there before somebody takes it, or before it is known how to cancel it.
    """

    __slots__ = ("_cancel", "_is_cancelled", "_take", "_values")

    def __init__(self) -> None:
        self._values: dict[str, Any] | None = None
        self._is_cancelled = False
        self._take: Callable[[dict[str, Any]], object] | None = None
        self._cancel: Callable[[], object] | None = None

    def respond(self, values: dict[str, Any]) -> None:
        """Give the response; ignored if this has ended."""
        if self._values is None and not self._is_cancelled:
            self._values, self._cancel = values, None
            if self._take is not None:
                self._take(values)

    def then(self, take: Callable[[dict[str, Any]], object]) -> None:
        """Call a function with the response, at once if it is there."""
        self._take = take
        if self._values is not None:
            take(self._values)

    def cancel(self) -> None:
        """Stop waiting for the response; ignored if this has ended."""
        if self._values is None and not self._is_cancelled:
            self._is_cancelled, self._take = True, None
            if self._cancel is not None:
                self._cancel()

    def on_cancel(self, cancel: Callable[[], object]) -> None:
        """Call a function if no caller waits any more, at once if none does."""
        if self._is_cancelled:
            cancel()
        elif self._values is None:
            self._cancel = cancel


Function: TypeAlias = Callable[[dict[str, Any], str], Response | Deferred]
"""Responds to a call within the hub, given the request and the caller's node.

It raises `FibwsError` when the call fails.
"""


class ServiceServer(Protocol):
    """Responds to the calls of services."""

    @property
    def node(self) -> str:
        """The name of its node."""

    def handle(self, call: Call) -> None:
        """Respond to a call, now or later."""

    def cancel(self, call: Call) -> None:
        """Forget a call, which needs no response any more."""

    def displaced(self, service: Service) -> None:
        """Called when another server has taken the service over."""


@dataclass(slots=True, eq=False)
class Service:
    """One service of the graph."""

    name: str
    type: ServiceType
    """`ANY_TYPE` until it is known; see `Graph.learn_service_type`."""
    server: ServiceServer

    @property
    def node(self) -> str:
        """The node that serves it."""
        return self.server.node


class Call:
    """One call, from its start to its response.

    Args:
        args: the request: an object, a list of its fields in order, or `SerializedValues`.
        caller: the calling node.
        succeeded: takes the response.
        failed: takes the error's text and code (see `CallFailed`).
        headers: the connection header that the caller sends with the request.
        totals: counts how the call ends.

    Raises:
        InvalidMessage: the request does not fit the type.
        NotSerialized: it is serialized by another definition.
        CallFailed: the caller means another type.
    """

    __slots__ = (
        "_failed",
        "_open",
        "_started",
        "_succeeded",
        "_timer",
        "_totals",
        "caller",
        "headers",
        "id",
        "request",
        "service",
    )

    def __init__(
        self,
        service: Service,
        args: object,
        caller: str,
        succeeded: Callable[[Call, Body], None],
        failed: Callable[[Call, str, str], None],
        headers: dict[str, str] | None = None,
        totals: CallTotals | None = None,
    ) -> None:
        _check_md5sum(service, caller, headers or {})
        self.service = service
        self.request = _request(service.type, args)
        """With every field filled; unchanged from the caller if the type is unknown."""
        self.caller = caller
        self.headers = headers
        self.id = ""
        """Its id at the server."""
        self._succeeded = succeeded
        self._failed = failed
        self._open = True
        self._timer: Any = None
        self._totals = totals
        self._started = totals.now() if totals is not None else 0

    def start(self, timeout: float, call_later: CallLater) -> None:
        """Pass the call to the server.

        Args:
            timeout: seconds in which the server must respond; 0 for no limit.
            call_later: calls a function after some seconds, unless it is cancelled.
        """
        self.service.server.handle(self)
        if timeout and self._open:
            self._timer = call_later(timeout, partial(self.time_out, timeout))
        # The server has it; a large request need not be kept until it responds.
        self.request = Body(self.service.type, REQUEST, values={})
        self.headers = None

    def fill(self, args: object, headers: Mapping[str, str] | None) -> Body:
        """Return the request of a call that was made before its service's type was known.

        Raises:
            InvalidMessage: the request does not fit the type.
            CallFailed: the caller means another type.
        """
        _check_md5sum(self.service, self.caller, headers or {})
        return _request(self.service.type, args)

    def respond(self, values: object) -> None:
        """Take the server's response: an object, or `SerializedValues`.

        Raises:
            InvalidMessage: it does not fit the type; the call still waits for a response.
            NotSerialized: it is serialized by another definition; as for `InvalidMessage`.
        """
        type_ = self.service.type
        if isinstance(values, SerializedValues):
            body = check_serialized(type_, RESPONSE, values, type_.name, type_.md5sum)
        else:
            body = Body(type_, RESPONSE, values=type_.response(values))
        self._respond(body)

    def respond_json(self, text: bytes) -> None:
        """Take the response as JSON, in which infinity is as in `exact_json_of`."""
        self._respond(Body(self.service.type, RESPONSE, json=text))

    def _respond(self, body: Body) -> None:
        if self._close():
            if self._totals is not None:
                self._totals.responded(self.service.name, self._started)
            self._succeeded(self, body)

    def fail(self, text: str, code: str = "server_failed") -> None:
        """End the call without a response."""
        if self._close():
            if self._totals is not None:
                self._totals.failed(self.service.name, code)
            self._failed(self, text, code)

    def abandon(self) -> None:
        """End the call of a caller that has left."""
        if self._close():
            self.service.server.cancel(self)

    def time_out(self, timeout: float) -> None:
        """End the call, to which the server has not responded within ``timeout`` seconds."""
        self.give_up(f"Service {self.service.name} did not answer within {timeout:g} s", "timeout")

    def withdraw(self) -> None:
        """End the call of a caller that has lost the right to it."""
        error = NotAllowed(self.caller, "call", self.service.name)
        self.give_up(f"{error}; the call was ended", error.code)

    def give_up(self, text: str, code: str) -> None:
        """End the call with an error; a response that comes later is dropped."""
        self.service.server.cancel(self)
        self.fail(text, code)

    def _close(self) -> bool:
        """Return whether this is the call's one end."""
        was_open, self._open = self._open, False
        if self._timer is not None:
            self._timer.cancel()
            self._timer = None
        return was_open


class InternalServer:
    """A part of the hub that serves one service.

    Args:
        node: the hub's own node that it belongs to.
    """

    def __init__(self, node: str, function: Function) -> None:
        self.node = node
        self._function = function
        self._deferred: dict[Call, Deferred] = {}

    def handle(self, call: Call) -> None:
        """Respond to a call, now or later."""
        try:
            response = self._function(call.request.values(), call.caller)
        except FibwsError as error:
            call.fail(str(error), error.code)
        except Exception:
            logger.exception("%s failed.", call.service.name)
            call.fail(f"{call.service.name} failed in the hub; see its log")
        else:
            if isinstance(response, Deferred):
                self._deferred[call] = response
                response.then(partial(self._respond, call))
            else:
                self._respond(call, response)

    def cancel(self, call: Call) -> None:
        """Forget a call, which needs no response any more."""
        deferred = self._deferred.pop(call, None)
        if deferred is not None:
            deferred.cancel()

    def displaced(self, service: Service) -> None:
        """Fail: the graph does not let a client take over a service of the hub."""
        raise AssertionError(f"{service.name} is the hub's own")

    def _respond(self, call: Call, response: Response) -> None:
        self._deferred.pop(call, None)
        if isinstance(response, bytes):
            call.respond_json(response)
            return
        try:
            call.respond(response)
        except FibwsError as error:
            call.fail(str(error), error.code)


def _request(type_: ServiceType, args: object) -> Body:
    """Return a request; raises as `Call`."""
    if isinstance(args, SerializedValues):
        return check_serialized(type_, REQUEST, args, type_.name, type_.md5sum)
    values = type_.fill_request(args) if type_.is_known else args
    return Body(type_, REQUEST, values=values)


def _check_md5sum(service: Service, caller: str, headers: Mapping[str, str]) -> None:
    """Refuse a caller that means another type, as ROS 1 does when two nodes connect."""
    known, given = service.type.md5sum, headers.get("md5sum", ANY_MD5SUM)
    if known is not None and given not in (known, ANY_MD5SUM):
        text = f"request from [{caller}]: md5sums do not match: [{given}] vs. [{known}]"
        raise CallFailed(text, "type_conflict")
