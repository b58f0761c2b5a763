"""The services that a node provides."""

from __future__ import annotations

import asyncio
from collections import deque
from collections.abc import Awaitable, Callable, Iterator, Mapping
from inspect import isawaitable
from typing import Any, Generic, Self, TypeAlias

from fibws.errors import (
    AlreadyOffered,
    CallRefused,
    InvalidMessage,
    MessageTooLarge,
    OperationRejected,
)
from fibws.interfaces import Service
from fibws.interfaces.message import Req, Res
from fibws.interfaces.serialized_values import SerializedValues
from fibws.node.checks import described, without_surrogates
from fibws.node.session import OperationHandler, Registration, Session, Tasks, throw
from fibws.node.types import NodeServiceType, NodeTypes
from fibws.protocol.operations import (
    AdvertiseService,
    CallService,
    Operation,
    Reply,
    ServiceResponse,
    UnadvertiseService,
)
from fibws.protocol.serialized import ROS1
from fibws.public_classes import made_by

MOST_CALLS = 100
"""Calls of one service that are handled at once."""
MOST_WAITING = 1000
"""Calls of one service that wait for that; the hub lets one client have as many under way."""

Answer: TypeAlias = (
    Res | Mapping[str, Any] | tuple[Any, ...] | list[Any] | bool | int | float | str | bytes
)
"""A response: whole, or its fields by name or in order, or the value of its only field."""

Handler: TypeAlias = Callable[[Req], Answer[Res] | Awaitable[Answer[Res]]]
"""A service's handler: a plain function or an async one, which is given the request."""

HeaderHandler: TypeAlias = Callable[[Req, dict[str, str]], Answer[Res] | Awaitable[Answer[Res]]]
"""A `Handler` that is also given the caller's header, whose ``callerid`` is the caller's node."""


@made_by("Node.service")
class ServiceServer(Registration, Generic[Req, Res]):
    """Handles the calls of one service, each in a task of its own.

    Leave it with `close`, or by ``async with``, to end the service before the node does.
    """

    # session: the node's.
    # operation: the registration.
    # type_: the service's type.
    # handler: handles a call; it is given the header, too, if the operation asks for headers.
    # withdraw: takes the registration back.
    def __init__(
        self,
        session: Session,
        operation: AdvertiseService,
        type_: NodeServiceType[Req, Res],
        handler: Handler[Req, Res] | HeaderHandler[Req, Res],
        withdraw: Callable[[ServiceServer[Any, Any]], None],
    ) -> None:
        self._session = session
        self._operation = operation
        self._type = type_
        self._handler: Callable[..., Any] = handler
        self._withdraw = withdraw
        self._tasks = Tasks(session.tasks)
        self._waiting: deque[CallService] = deque()
        self._connection = object()
        """Stands for the current connection, so that a call of a former one is not answered."""
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
    def fault(self) -> Exception | None:
        """The error that ended the service, such as the hub's refusal; usually None."""
        return self._fault

    def _registration(self) -> AdvertiseService:
        """Return the registration for the current connection."""
        if not self._session.serialized_values:
            return self._operation
        update = {"compression": ROS1, "md5sum": self._type.md5sum}
        return self._operation.model_copy(update=update)

    async def spin(self) -> None:
        """Wait until the service or its node ends.

        Raises:
            OperationRejected: the hub refused the service.
        """
        await self._ended.wait()
        if self._fault is not None:
            throw(self._fault)

    def close(self) -> None:
        """End the service and cancel its pending calls. Does nothing when called again.

        The hub fails these calls, even the one whose handler calls this.
        """
        if not self._ended.is_set():
            self._end()
            self._withdraw(self)

    def _take(self, call: CallService) -> None:
        """Handle a call, now or when another one ends."""
        if len(self._tasks) < MOST_CALLS:
            self._start(call)
        elif len(self._waiting) < MOST_WAITING:
            self._waiting.append(call)
        else:
            calls = MOST_CALLS + MOST_WAITING
            self._respond(call, f"service [{self.name}] is busy with {calls} calls", result=False)

    def _on_disconnect(self) -> None:
        """Drop waiting calls and the responses of running ones: their callers have failed."""
        self._connection = object()
        self._waiting.clear()

    def _end(self, fault: Exception | None = None) -> None:
        """End the service, because of ``fault`` unless that is None."""
        self._on_disconnect()
        self._fault = fault
        self._ended.set()
        self._tasks.cancel()

    async def __aenter__(self) -> Self:
        return self

    async def __aexit__(self, *error: object) -> None:
        self.close()
        await self._session.end_of(self._tasks)

    def _start(self, call: CallService) -> None:
        name = f"the handler of service {self.name} (call {call.id})"
        self._tasks.start(self._handle(call, self._connection), name)

    async def _handle(self, call: CallService, connection: object) -> None:
        values: Any = "error processing request: it was cancelled"
        result = False
        try:
            values, result = await self._outcome(call)
            await self._session.outgoing.room()
        except BrokenPipeError as fault:
            # The program's output is no longer read (``| head``): `spin` of its node raises this.
            self._session.end(fault)
        finally:
            # The caller waits for a response, unless the service or the connection has ended.
            if connection is self._connection:
                self._respond(call, values, result=result)
            if self._waiting:
                self._start(self._waiting.popleft())

    async def _outcome(self, call: CallService) -> tuple[Any, bool]:
        """Return the response's values and True, or an error's text (rospy's) and False."""
        try:
            request = self._type.read_request(call.args)
        except InvalidMessage as error:
            # The caller's mistake: the handler is not called.
            self._session.log.error("Service %s got an invalid request: %s", self.name, error)
            return f"error processing request: {error}", False
        try:
            header = (call.header or {},) if self._operation.headers else ()
            answer = self._handler(request, *header)
            if isawaitable(answer):
                answer = await answer
        except BrokenPipeError:
            raise
        except CallRefused as refusal:
            return without_surrogates(str(refusal)), False
        except Exception as error:
            text = described(error)
            self._session.log.error("Service %s failed: %s", self.name, text, exc_info=error)
            return f"error processing request: {text}", False
        try:
            data = self._type.encode_response(answer)
            if isinstance(call.args, SerializedValues):
                return SerializedValues(data), True
            return self._type.response.json(data), True
        except Exception as error:
            self._session.log.error("Service %s failed: %s", self.name, error)
            return without_surrogates(f"service cannot process request: {error}"), False

    def _respond(self, call: CallService, values: Any, *, result: bool) -> None:
        response = ServiceResponse(id=call.id, service=call.service, values=values, result=result)
        try:
            self._session.send(response)
        except MessageTooLarge as error:
            self._session.log.error("Service %s failed: %s", self.name, error)
            self._session.send(response.model_copy(update={"values": str(error), "result": False}))


class NodeServices(OperationHandler):
    """Handles the operations of the services that the node provides."""

    def __init__(self, session: Session, types: NodeTypes) -> None:
        self._session = session
        self._types = types
        self._servers: dict[str, ServiceServer[Any, Any]] = {}
        session.add_handler(self)

    def serve(
        self,
        name: str,
        type_: type[Service[Req, Res]],
        handler: Handler[Req, Res] | HeaderHandler[Req, Res],
        *,
        headers: bool = False,
    ) -> ServiceServer[Req, Res]:
        """Provide a service by its global name; see `Node.service`."""
        self._session.check()
        if not callable(handler):
            raise TypeError(f"a service's handler must be a function, got {handler!r}")
        service_type = self._types.service(type_)
        if name in self._servers:
            raise AlreadyOffered(name)
        operation = AdvertiseService(
            id=self._session.id("advertise_service", name),
            service=name,
            type=service_type.name,
            definition=self._types.service_definition(service_type.name),
            headers=headers or None,
        )
        server = ServiceServer(self._session, operation, service_type, handler, self._withdraw)
        self._servers[name] = server
        self._session.send(server._registration())
        return server

    def _registrations(self) -> Iterator[Operation]:
        """Yield the registrations of all services."""
        for server in self._servers.values():
            yield server._registration()

    def _on_reply(self, reply: Reply) -> bool:
        """Handle a call; it may come late, for a service that was withdrawn."""
        if not isinstance(reply, CallService):
            return False
        if (server := self._servers.get(reply.service)) is not None:
            server._take(reply)
        else:
            text = f"service [{reply.service}] was withdrawn"
            self._session.send(
                ServiceResponse(id=reply.id, service=reply.service, values=text, result=False)
            )
        return True

    def _on_refusal(self, id_: str, error: OperationRejected) -> bool:
        """End a service that the hub refuses; log it if nobody may be waiting for it."""
        for server in self._servers.values():
            if server._operation.id == id_:
                del self._servers[server.name]
                if not server._is_awaited:
                    log = self._session.log
                    log.error("The hub refused the service %s: %s", server.name, error)
                server._end(error)
                return True
        return False

    def _on_disconnect(self) -> None:
        """Drop all calls of the lost connection."""
        for server in self._servers.values():
            server._on_disconnect()

    def _on_end(self, error: Exception | None) -> None:
        """End all services."""
        for server in self._servers.values():
            server._end(error)
        self._servers.clear()

    def _withdraw(self, server: ServiceServer[Any, Any]) -> None:
        del self._servers[server.name]
        self._session.send(UnadvertiseService(id=server._operation.id, service=server.name))
