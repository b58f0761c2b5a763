"""Files that the hub sends by HTTP: to those who may have them, and not too many at once."""

from __future__ import annotations

import http
from abc import ABC, abstractmethod
from collections.abc import Callable
from typing import ClassVar

from websockets.http11 import Response

from fibws.access.rights import Principal
from fibws.errors import AuthenticationError
from fibws.hub.access.authentication import Authentication
from fibws.hub.http.requests import DeferredResponse, Get, HttpRequests
from fibws.hub.log.audit import Audit
from fibws.hub.memory.byte_room import ByteRoom, Reservation
from fibws.hub.worker_threads import WorkerThreads


class FileRefused(Exception):
    """A file is not sent.

    Args:
        status: of the response.
        reason: for people.
    """

    def __init__(self, status: http.HTTPStatus, reason: str) -> None:
        self.status = status
        super().__init__(reason)


class FileRoute(ABC):
    """Files below a path.

    Args:
        requests: what the resources are added to.
        authentication: None on a hub without authentication.
        threads: read the files.
        room: for files on their way to clients, by any protocol.
        audit: records refusals.
    """

    PATH: ClassVar[str]

    def __init__(
        self,
        requests: HttpRequests,
        authentication: Authentication | None,
        threads: WorkerThreads,
        room: ByteRoom,
        audit: Audit,
    ) -> None:
        self._requests = requests
        self._authentication = authentication
        self._threads = threads
        self._room = room
        self._audit = audit
        requests.add_folder(self.PATH, self._respond)

    @abstractmethod
    def _find(
        self, get: Get, path: str, principal: Principal | None, reservation: Reservation
    ) -> Callable[[], Response]:
        """Return a function that reads a file, in any thread.

        Args:
            path: what follows `PATH`.
            principal: who asks; None on a hub without authentication.
            reservation: for the room that the file takes.

        Raises:
            FileRefused: it is not sent.
        """

    @abstractmethod
    def _refusal(self, status: http.HTTPStatus, reason: str) -> Response:
        """Return the response to a client that gets no file."""

    def _completed(self, found: Response, get: Get) -> Response:
        """Return a response with what else clients with an allowed origin need."""
        return found

    def _respond(self, get: Get) -> Response:
        refusal = self._requests.refusal(get)
        if refusal is not None:
            return self._refusal(http.HTTPStatus.FORBIDDEN, refusal)
        path = get.path.partition("?")[0].removeprefix(self.PATH)
        reservation = Reservation(self._room)
        try:
            make = self._find(get, path, self._principal(get), reservation)
        except AuthenticationError as error:
            self._audit.refused("authentication", f"{self.PATH}: {error}", ip=get.address)
            found = self._refusal(http.HTTPStatus.UNAUTHORIZED, str(error))
            found.headers["WWW-Authenticate"] = "Bearer"
            return self._completed(found, get)
        except FileRefused as error:
            return self._completed(self._refusal(error.status, str(error)), get)
        return DeferredResponse(make, self._threads.run, reservation.end)

    def _principal(self, get: Get) -> Principal | None:
        """Return who asks; raises `AuthenticationError`."""
        if self._authentication is None:
            return None
        login = self._authentication.log_in(get.headers, "/", (), get.certificate, get.address)
        if login is None:
            raise AuthenticationError("missing token")
        return login.principal

    def _busy(self) -> Response:
        """Return the response to a client for whose file there is no room at present."""
        reason = "the hub is busy with other files; try again"
        found = self._refusal(http.HTTPStatus.SERVICE_UNAVAILABLE, reason)
        found.headers["Retry-After"] = "1"
        return found
