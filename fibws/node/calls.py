"""The services that a node calls: its own calls, and those of its library to the hub (rosapi)."""

from __future__ import annotations

import asyncio
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, TypeAlias
from weakref import WeakValueDictionary

from fibws.errors import (
    InvalidMessage,
    NodeClosed,
    NotSerialized,
    OperationRejected,
    ServiceError,
    ServiceLost,
    ServiceTimeout,
    UnknownService,
    WaitTimeout,
)
from fibws.interfaces import Service
from fibws.interfaces.message import Req, Res
from fibws.interfaces.serialized_values import SerializedValues
from fibws.node.checks import check_timeout
from fibws.node.session import OperationHandler, Session, throw
from fibws.node.types import NodeTypes
from fibws.protocol.decoding import quoted
from fibws.protocol.headers import check_headers
from fibws.protocol.operations import CallService, Reply, ServiceResponse

MOST_CALLS = 500
"""Calls of one service that wait for responses at once; the hub bounds those of all (1000)."""
SHORTEST_TIMEOUT = 0.001
"""Least seconds to send as a call's timeout: 0 would mean no limit."""
ROUND_TRIP = "/rosapi/get_time"
"""The service that `Calls.round_trip` calls: one that costs the hub nothing."""
FIRST_LOOK = 0.05
LONGEST_LOOK = 0.5
"""Seconds between two checks whether a service exists, at first and in the end (rospy's: 0.3)."""

_ERRORS: dict[str | None, type[ServiceError]] = {
    "unknown_service": UnknownService,
    "timeout": ServiceTimeout,
}
"""Errors by the code of a failed response; others raise ServiceError."""

_Outcome: TypeAlias = ServiceResponse | Exception


@dataclass(slots=True, eq=False)
class _Call:
    service: str
    outcome: asyncio.Future[_Outcome]

    def settle(self, outcome: _Outcome) -> None:
        if not self.outcome.done():
            self.outcome.set_result(outcome)


class Calls(OperationHandler):
    """Calls services, and handles their responses."""

    def __init__(self, session: Session, types: NodeTypes) -> None:
        self._session = session
        self._types = types
        self._waiting: dict[str, _Call] = {}
        # One for each service: calls that a handler makes must not wait for those of the handler.
        self._slots: WeakValueDictionary[str, asyncio.Semaphore] = WeakValueDictionary()
        session.add_handler(self)

    def __len__(self) -> int:
        return len(self._waiting)

    async def call(
        self,
        service: str,
        type_: type[Service[Req, Res]],
        request: Req | Mapping[str, Any] | None = None,
        *,
        within: float | None = None,
        headers: Mapping[str, str] | None = None,
    ) -> Res:
        """Call a service by its global name; see `Node.call`."""
        return (await self.call_with_header(service, type_, request, within, headers or None))[0]

    async def call_with_header(
        self,
        service: str,
        type_: type[Service[Req, Res]],
        request: Req | Mapping[str, Any] | None,
        within: float | None,
        headers: Mapping[str, str] | None,
    ) -> tuple[Res, dict[str, str]]:
        """Call a service by its global name; see `Node.call_with_header`."""
        type_of_service = self._types.service(type_)
        header = check_headers(headers) if headers is not None else None
        data = type_of_service.encode_request(request)
        codec = type_of_service.request
        serialized = SerializedValues(data, type_of_service.md5sum)
        response = await self._call(service, within, header, lambda: codec.json(data), serialized)
        try:
            return type_of_service.response.read(response.values), response.header or {}
        except InvalidMessage as error:
            text = f"its response does not fit {type_of_service.name}: {error}"
            raise ServiceError(service, text) from None

    async def call_rosapi(
        self,
        service: str,
        type_: type[Service[Req, Res]],
        within: float | None = None,
        /,
        **request: Any,
    ) -> Res:
        """Call ``/rosapi/<service>``, a service of the hub, with a request of these fields.

        Raises:
            ValueError: ``within``, the most seconds to wait, is not above 0.
        """
        check_timeout(within)
        return await self.call(f"/rosapi/{service}", type_, request, within=within)

    async def query_rosapi(
        self,
        service: str,
        type_: type[Service[Req, Res]],
        within: float | None = None,
        /,
        **request: Any,
    ) -> Res:
        """Call a service of the hub that changes nothing, again if the connection is lost."""
        loop = asyncio.get_running_loop()
        end, left = loop.time() + (within or 0), within
        while True:
            try:
                return await self.call_rosapi(service, type_, left, **request)
            except ServiceLost:
                # The next call waits until there is a hub again.
                left = within and max(end - loop.time(), SHORTEST_TIMEOUT)

    async def round_trip(self) -> None:
        """Wait until the hub has handled everything that was sent; without a hub, wait for that.

        rosbridge handles a client's operations in order: the response to a call says so, whether
        the hub has the service or not.

        Raises:
            NodeClosed: the node has ended; or the error that ended it.
        """
        while True:
            try:
                await self._call(ROUND_TRIP, None, None, dict)
            except ServiceLost:
                continue  # On the next connection, everything is registered again.
            except ServiceError:
                pass
            return

    async def wait_for_service(self, name: str, within: float | None) -> None:
        """Wait until a service exists, by its global name; see `Node.wait_for_service`."""
        delay = FIRST_LOOK
        try:
            async with asyncio.timeout(within):
                while not await self._exists(name):
                    if await self._session.ended(delay):
                        raise NodeClosed(f"the node ended while waiting for service {name}")
                    delay = min(2 * delay, LONGEST_LOOK)
        except TimeoutError:
            raise WaitTimeout(f"timeout exceeded while waiting for service {name}") from None

    def _on_reply(self, reply: Reply) -> bool:
        """Handle a response; it may arrive after the call was given up."""
        if not isinstance(reply, ServiceResponse):
            return False
        if (call := self._waiting.get(str(reply.id))) is not None:
            call.settle(reply)
        return True

    def _on_refusal(self, id_: str, error: OperationRejected) -> bool:
        """Fail a call that the hub refuses."""
        if (call := self._waiting.get(id_)) is None:
            return False
        call.settle(ServiceError(call.service, str(error)))
        return True

    def _on_disconnect(self) -> None:
        """Fail all pending calls: they may have taken place or not."""
        for call in self._waiting.values():
            call.settle(ServiceLost(call.service))

    def _on_end(self, error: Exception | None) -> None:
        """Fail all pending calls."""
        for call in self._waiting.values():
            call.settle(error or NodeClosed("the node has ended"))

    async def _call(
        self,
        service: str,
        within: float | None,
        headers: dict[str, str] | None,
        json: Callable[[], dict[str, Any]],
        serialized: SerializedValues | None = None,
    ) -> ServiceResponse:
        """Call a service.

        Args:
            json: returns the request as JSON values.
            serialized: the request as bytes, for a hub that takes those.
        """
        loop = asyncio.get_running_loop()
        end = loop.time() + within if within is not None else None
        id_ = self._session.id("call_service", service)
        outcome: _Outcome
        try:
            async with asyncio.timeout_at(end), self._slots_of(service):
                await self._session.wait_for_hub()
                call = self._waiting[id_] = _Call(service, loop.create_future())
                left = max(end - loop.time(), SHORTEST_TIMEOUT) if end is not None else None
                is_serialized = serialized is not None and self._session.serialized_values
                request = CallService(
                    id=id_,
                    service=service,
                    args=serialized if is_serialized else json(),
                    timeout=left,
                    headers=headers,
                )
                self._session.send(request)
                outcome = await call.outcome
                if is_serialized and isinstance(outcome, ServiceResponse):
                    if outcome.code == NotSerialized.code:  # It was not executed.
                        call = self._waiting[id_] = _Call(service, loop.create_future())
                        self._session.send(request.model_copy(update={"args": json()}))
                        outcome = await call.outcome
        except TimeoutError:
            sent = id_ in self._waiting or self._session.outgoing.connected
            missing = "no response" if sent else "no hub"
            raise ServiceTimeout(service, f"{missing} within {within:g} s") from None
        finally:
            self._waiting.pop(id_, None)
        if isinstance(outcome, Exception):
            throw(outcome)
        if not outcome.result:
            raise _failure(service, outcome)
        return outcome

    def _slots_of(self, service: str) -> asyncio.Semaphore:
        return self._slots.setdefault(service, asyncio.Semaphore(MOST_CALLS))

    async def _exists(self, name: str) -> bool:
        from fibws.srv.rosapi import ServiceType  # It takes 10 ms to load.

        return bool((await self.query_rosapi("service_type", ServiceType, service=name)).type)


def _failure(service: str, response: ServiceResponse) -> ServiceError:
    """Return the error that a failed response stands for."""
    values = response.values
    text = values if isinstance(values, str) else quoted(values)
    return _ERRORS.get(response.code, ServiceError)(service, text, response.code)
