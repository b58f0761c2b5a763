"""The services that a node offers, as its hub knows them."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from fibws.errors import AlreadyOffered, OperationRejected
from fibws.interfaces import Service
from fibws.interfaces.message import Req, Res
from fibws.node.part import Part
from fibws.node.service import Handler, HeaderHandler, ServiceServer
from fibws.node.session import Session
from fibws.node.types import Types
from fibws.protocol.operations import (
    AdvertiseService,
    CallService,
    Reply,
    ServiceResponse,
    UnadvertiseService,
    encode,
)


class Services(Part):
    """The part of a session that answers calls."""

    def __init__(self, session: Session, types: Types) -> None:
        self._session = session
        self._types = types
        self._offered: dict[str, ServiceServer[Any, Any]] = {}
        session.join(self)

    def serve(
        self,
        name: str,
        type_: type[Service[Req, Res]],
        handler: Handler[Req, Res] | HeaderHandler[Req, Res],
        *,
        headers: bool = False,
    ) -> ServiceServer[Req, Res]:
        """Offer a service by its global name; see `Node.service`."""
        self._session.check()
        if not callable(handler):
            raise TypeError(f"a service's handler is a function, not {handler!r}")
        types = self._types.service(type_)
        if name in self._offered:
            raise AlreadyOffered(name)
        operation = AdvertiseService(
            id=self._session.id("advertise_service", name),
            service=name,
            type=types.name,
            definition=self._types.service_definition(types.name),
            headers=headers or None,
        )
        server = ServiceServer(self._session, operation, types, handler, self._withdraw)
        self._offered[name] = server
        self._session.say(operation)
        return server

    def greeting(self) -> Iterator[bytes]:
        """All that is offered."""
        for server in self._offered.values():
            yield encode(server.operation)

    def receive(self, reply: Reply) -> bool:
        """Hand on a call; it may come late, for a service that was taken back."""
        if not isinstance(reply, CallService):
            return False
        if (server := self._offered.get(reply.service)) is not None:
            server.take(reply)
        else:
            text = f"service [{reply.service}] is offered no more"
            self._session.say(
                ServiceResponse(id=reply.id, service=reply.service, values=text, result=False)
            )
        return True

    def refuse(self, id_: str, fault: OperationRejected) -> bool:
        """End a service that the hub will not have; its owner may not be waiting for that."""
        for server in self._offered.values():
            if server.operation.id == id_:
                del self._offered[server.name]
                self._session.log.error("The hub refused the service %s: %s", server.name, fault)
                server.end(fault)
                return True
        return False

    def lose(self) -> None:
        """Let all services know."""
        for server in self._offered.values():
            server.lose()

    def end(self, fault: Exception | None) -> None:
        """Let all services know."""
        for server in self._offered.values():
            server.end(fault)
        self._offered.clear()

    def _withdraw(self, server: ServiceServer[Any, Any]) -> None:
        del self._offered[server.name]
        self._session.say(UnadvertiseService(id=server.operation.id, service=server.name))
