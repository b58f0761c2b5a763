"""A node's calls of services, until they are answered."""

from __future__ import annotations

import asyncio
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, TypeAlias
from weakref import WeakValueDictionary

from fibws.errors import (
    InvalidMessage,
    NodeClosed,
    OperationRejected,
    ServiceError,
    ServiceLost,
    ServiceTimeout,
    UnknownService,
)
from fibws.interfaces import Service
from fibws.interfaces.message import Req, Res
from fibws.node.fault import throw
from fibws.node.part import Part
from fibws.node.session import Session
from fibws.node.types import Types
from fibws.protocol.headers import check_headers
from fibws.protocol.operations import CallService, Reply, ServiceResponse
from fibws.protocol.parsing import quoted

MOST_CALLS = 500
"""How many calls of one service wait for answers at once; the hub bounds those of all (1000)."""

SHORTEST_TIMEOUT = 0.001
"""Seconds that the hub is given at least: it takes 0 for no limit of ours."""

_Outcome: TypeAlias = ServiceResponse | Exception


@dataclass(slots=True, eq=False)
class _Call:
    service: str
    outcome: asyncio.Future[_Outcome]

    def settle(self, outcome: _Outcome) -> None:
        if not self.outcome.done():
            self.outcome.set_result(outcome)


class Calls(Part):
    """The part of a session that calls services."""

    def __init__(self, session: Session, types: Types) -> None:
        self._session = session
        self._types = types
        self._waiting: dict[str, _Call] = {}
        # One for each service: calls that a handler makes must not wait for those of the handler.
        self._slots: WeakValueDictionary[str, asyncio.Semaphore] = WeakValueDictionary()
        session.join(self)

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
        types = self._types.service(type_)
        header = check_headers(headers) if headers else None
        values = await self._ask(service, types.ask(request), within, header)
        try:
            return types.answered(values)
        except InvalidMessage as error:
            text = f"its response does not fit {types.name}: {error}"
            raise ServiceError(service, text) from None

    async def _ask(
        self,
        service: str,
        args: dict[str, Any],
        within: float | None,
        headers: dict[str, str] | None,
    ) -> Any:
        loop = asyncio.get_running_loop()
        end = loop.time() + within if within is not None else None
        id_ = self._session.id("call_service", service)
        try:
            async with asyncio.timeout_at(end), self._slots_of(service):
                await self._session.wait_for_hub()
                call = self._waiting[id_] = _Call(service, loop.create_future())
                left = max(end - loop.time(), SHORTEST_TIMEOUT) if end is not None else None
                self._session.say(
                    CallService(id=id_, service=service, args=args, timeout=left, headers=headers)
                )
                outcome = await call.outcome
        except TimeoutError:
            asked = id_ in self._waiting or self._session.outbox.connected
            fault = "no answer" if asked else "no hub to ask"
            raise ServiceTimeout(service, f"{fault} within {within:g} s") from None
        finally:
            self._waiting.pop(id_, None)
        if isinstance(outcome, Exception):
            throw(outcome)
        if not outcome.result:
            raise _failure(service, outcome.values)
        return outcome.values

    def _slots_of(self, service: str) -> asyncio.Semaphore:
        return self._slots.setdefault(service, asyncio.Semaphore(MOST_CALLS))

    def receive(self, reply: Reply) -> bool:
        """Take an answer; it may come late, when nobody waits for it any more."""
        if not isinstance(reply, ServiceResponse):
            return False
        if (call := self._waiting.get(str(reply.id))) is not None:
            call.settle(reply)
        return True

    def refuse(self, id_: str, fault: OperationRejected) -> bool:
        """Fail a call that the hub did not understand."""
        if (call := self._waiting.get(id_)) is None:
            return False
        call.settle(ServiceError(call.service, str(fault)))
        return True

    def lose(self) -> None:
        """Fail the calls that the lost hub was told of: it may have passed them on or not."""
        for call in self._waiting.values():
            call.settle(ServiceLost(call.service))

    def end(self, fault: Exception | None) -> None:
        """Let all callers know."""
        for call in self._waiting.values():
            call.settle(fault or NodeClosed("the node has ended"))


def _failure(service: str, values: Any) -> ServiceError:
    """What a response means that is none; rosbridge has no codes for it, only our hub's texts."""
    text = values if isinstance(values, str) else quoted(values)
    if text == f"Service {service} does not exist":
        return UnknownService(service, text)
    if text.startswith(f"Service {service} did not answer within "):
        return ServiceTimeout(service, text)
    return ServiceError(service, text)
