"""Downloads of what the hub has recorded: ``GET /recordings/NAME``.

Only complete files are sent that this hub has recorded since its start, to those who may start and
stop recordings. They are read piece by piece, as fast as the client takes them.
"""

from __future__ import annotations

import http
import os
import stat
from functools import partial
from pathlib import Path
from urllib.parse import quote, unquote

from websockets.http11 import Response

from fibws.access.rights import Principal
from fibws.errors import AuthenticationError
from fibws.hub.access.authentication import Authentication
from fibws.hub.audit import Audit
from fibws.hub.byte_room import ByteRoom, Reservation
from fibws.hub.recording import Recording
from fibws.hub.websocket.http import (
    PIECE,
    DeferredResponse,
    FileResponse,
    Get,
    HttpRequests,
    response,
    text_response,
)
from fibws.hub.worker_threads import WorkerThreads

HELD = 2 * PIECE
"""Bytes in memory of one download: a piece, and what the network has still to take."""
FLAGS = os.O_RDONLY | getattr(os, "O_NOFOLLOW", 0) | getattr(os, "O_BINARY", 0)


class RecordingRoute:
    """``/recordings/``.

    On a hub with authentication the client needs the right ``admin``.

    Args:
        requests: what the resources are added to.
        authentication: None on a hub without authentication.
        threads: read the files.
        room: for files on their way to clients.
        audit: records refusals.
    """

    PATH = "/recordings/"

    def __init__(
        self,
        requests: HttpRequests,
        recording: Recording,
        authentication: Authentication | None,
        threads: WorkerThreads,
        room: ByteRoom,
        audit: Audit,
    ) -> None:
        self._requests = requests
        self._audit = audit
        self._recording = recording
        self._authentication = authentication
        self._threads = threads
        self._room = room
        requests.add_folder(self.PATH, self._respond)

    def _respond(self, get: Get) -> Response:
        refusal = self._requests.refusal(get)
        if refusal is not None:
            return text_response(http.HTTPStatus.FORBIDDEN, refusal)
        try:
            principal = self._principal(get)
            if principal is not None and not principal.rights.admin:
                fault = "recordings need a token with the right admin"
                self._audit.refused("right", fault, principal=principal.title, ip=get.address)
                return text_response(http.HTTPStatus.FORBIDDEN, fault)
        except AuthenticationError as error:
            self._audit.refused("authentication", f"{self.PATH}: {error}", ip=get.address)
            found = text_response(http.HTTPStatus.UNAUTHORIZED, str(error))
            found.headers["WWW-Authenticate"] = "Bearer"
            return found
        name = unquote(get.path.partition("?")[0].removeprefix(self.PATH))
        path = self._recording.find(name)
        if path is None:
            return text_response(
                http.HTTPStatus.NOT_FOUND,
                "this hub has not recorded such a file since its start; see its folder (--record)",
            )
        reservation = Reservation(self._room)
        make = partial(self._make, path, reservation)
        return DeferredResponse(make, self._threads.run, reservation.end)

    def _principal(self, get: Get) -> Principal | None:
        """Return who asks; None on a hub without authentication."""
        if self._authentication is None:
            return None
        login = self._authentication.log_in(get.headers, "/", (), get.certificate, get.address)
        if login is None:
            raise AuthenticationError("missing token")
        return login.principal

    def _make(self, path: Path, reservation: Reservation) -> Response:
        """Open a file; in any thread."""
        if not reservation.reserve(HELD):
            fault = "the hub is busy with other files; try again"
            found = text_response(http.HTTPStatus.SERVICE_UNAVAILABLE, fault)
            found.headers["Retry-After"] = "1"
            return found
        try:
            return _file_response(path)
        except FileNotFoundError:
            fault = f"{path.name} is not complete yet, or has been removed"
        except OSError as error:
            fault = f"the hub cannot read {path.name}: {error.strerror}"
        return text_response(http.HTTPStatus.NOT_FOUND, fault)


def _file_response(path: Path) -> Response:
    file = os.fdopen(os.open(path, FLAGS), "rb")
    info = os.fstat(file.fileno())
    if not stat.S_ISREG(info.st_mode):
        file.close()
        raise FileNotFoundError(path)
    headers = response(http.HTTPStatus.OK).headers
    headers["Content-Type"] = "application/octet-stream"
    headers["Content-Length"] = str(info.st_size)
    headers["Content-Disposition"] = f"attachment; filename*=UTF-8''{quote(path.name)}"
    headers["Cache-Control"] = "no-store"
    headers["Content-Security-Policy"] = "default-src 'none'; sandbox"
    headers["Cross-Origin-Resource-Policy"] = "same-origin"
    return FileResponse(headers, file, info.st_size)
