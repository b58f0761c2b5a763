"""The answering end of a service."""

from __future__ import annotations

import asyncio
from collections import deque
from collections.abc import Awaitable, Callable, Mapping
from inspect import isawaitable
from typing import Any, Generic, Self, TypeAlias

from fibws.errors import CallRefused, InvalidMessage
from fibws.interfaces.message import Req, Res
from fibws.node.fault import throw
from fibws.node.service_type import ServiceType
from fibws.node.session import Session
from fibws.node.tasks import Tasks
from fibws.node.text import sendable
from fibws.protocol.operations import AdvertiseService, CallService, ServiceResponse

MOST_CALLS = 100
"""How many calls of one service are answered at once."""

MOST_WAITING = 1000
"""How many more of them wait for that; the hub lets one client have as many under way."""

Answer: TypeAlias = (
    Res | Mapping[str, Any] | tuple[Any, ...] | list[Any] | bool | int | float | str | bytes
)
"""A response: whole, or its fields by name or in order, or the value of its only field."""

Handler: TypeAlias = Callable[[Req], Answer[Res] | Awaitable[Answer[Res]]]
"""What answers a request: a plain function or an async one."""

HeaderHandler: TypeAlias = Callable[[Req, dict[str, str]], Answer[Res] | Awaitable[Answer[Res]]]
"""As `Handler`, but it is given the caller's header, too, whose ``callerid`` is its node."""


class ServiceServer(Generic[Req, Res]):
    """Answers the calls of one service, each in a task of its own.

    Leave it with `close`, or by ``async with``, to answer no more before the node ends.
    """

    def __init__(
        self,
        session: Session,
        operation: AdvertiseService,
        types: ServiceType[Req, Res],
        handler: Handler[Req, Res] | HeaderHandler[Req, Res],
        leave: Callable[[ServiceServer[Any, Any]], None],
    ) -> None:
        self._session = session
        self._operation = operation
        self._types = types
        self._handler: Callable[..., Any] = handler
        self._leave = leave
        self._tasks = Tasks(session.tasks)
        self._waiting: deque[CallService] = deque()
        self._asked_by = object()
        self._ended = asyncio.Event()
        self._fault: Exception | None = None

    def __repr__(self) -> str:
        return f"<ServiceServer {self.name} [{self.type}]>"

    @property
    def name(self) -> str:
        """The service's global name."""
        return self._operation.service

    @property
    def type(self) -> str:
        """The service's type, such as ``std_srvs/Trigger``."""
        return self._operation.type

    @property
    def operation(self) -> AdvertiseService:
        """What offers the service to the hub."""
        return self._operation

    async def spin(self) -> None:
        """Wait until the service or its node ends; raise the reason if something was the matter.

        Raises:
            OperationRejected: the hub refused the service, so that nobody can call it.
        """
        await self._ended.wait()
        if self._fault is not None:
            throw(self._fault)

    def close(self) -> None:
        """Answer no more, and cancel what is not answered yet. Does nothing when called again.

        The hub tells the callers so. Whoever calls this from the handler is not answered either.
        """
        if not self._ended.is_set():
            self.end()
            self._leave(self)

    def take(self, call: CallService) -> None:
        """Answer a call, now or later."""
        if len(self._tasks) < MOST_CALLS:
            self._start(call)
        elif len(self._waiting) < MOST_WAITING:
            self._waiting.append(call)
        else:
            calls = MOST_CALLS + MOST_WAITING
            self._say(call, f"service [{self.name}] is busy with {calls} calls", result=False)

    def lose(self) -> None:
        """The connection is gone: nobody waits for answers to what came from it."""
        self._asked_by = object()
        self._waiting.clear()

    def end(self, fault: Exception | None = None) -> None:
        """No call will come any more, because of ``fault`` if there is one."""
        self.lose()
        self._fault = fault
        self._ended.set()
        self._tasks.cancel()

    async def __aenter__(self) -> Self:
        return self

    async def __aexit__(self, *error: object) -> None:
        self.close()
        await self._tasks.finished()

    def _start(self, call: CallService) -> None:
        self._tasks.start(self._answer(call, self._asked_by), f"{self.name} answers {call.id}")

    async def _answer(self, call: CallService, asked_by: object) -> None:
        values: Any = "error processing request: it was cancelled"
        result = False
        try:
            values, result = await self._outcome(call)
            await self._session.outbox.room()
        except BrokenPipeError as fault:
            # Nobody reads what the program prints any more (``| head``): its node's `spin` ends it.
            self._session.end(fault)
        finally:
            # Whatever befell the handler, its caller waits, unless the service or the hub is gone.
            if asked_by is self._asked_by:
                self._say(call, values, result=result)
            if self._waiting:
                self._start(self._waiting.popleft())

    async def _outcome(self, call: CallService) -> tuple[Any, bool]:
        """The response's values, or the text of what went wrong, which is rospy's."""
        try:
            request = self._types.asked(call.args)
        except InvalidMessage as error:
            # The caller's fault, and nothing that a look at the handler would explain.
            self._session.log.error("Service %s was asked wrongly: %s", self.name, error)
            return f"error processing request: {error}", False
        try:
            header = (call.header or {},) if self._operation.headers else ()
            answer = self._handler(request, *header)
            if isawaitable(answer):
                answer = await answer
        except BrokenPipeError:
            raise
        except CallRefused as refusal:
            return sendable(str(refusal)), False
        except Exception as error:
            text = f"{type(error).__name__}: {error}"
            self._session.log.error("Service %s failed: %s", self.name, text, exc_info=error)
            text = str(error) or type(error).__name__
            return sendable(f"error processing request: {text}"), False
        try:
            return self._types.answer(answer), True
        except Exception as error:
            self._session.log.error("Service %s failed: %s", self.name, error)
            return sendable(f"service cannot process request: {error}"), False

    def _say(self, call: CallService, values: Any, *, result: bool) -> None:
        self._session.say(
            ServiceResponse(id=call.id, service=call.service, values=values, result=result)
        )
