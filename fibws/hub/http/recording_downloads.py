"""Downloads of what the hub has recorded: ``GET /recordings/NAME``.

Only complete files are sent that this hub has recorded since its start, to those who may start and
stop recordings. They are read piece by piece, as fast as the client takes them. A client may ask
for one range of bytes, as the page does to show a recording without downloading it.
"""

from __future__ import annotations

import http
import os
import re
import stat
from collections.abc import Callable
from functools import partial
from pathlib import Path
from urllib.parse import quote, unquote

from websockets.datastructures import Headers
from websockets.http11 import Response

from fibws.access.rights import Principal
from fibws.hub.access.authentication import Authentication
from fibws.hub.http.file_route import FileRefused, FileRoute
from fibws.hub.http.requests import (
    PIECE,
    FileResponse,
    Get,
    HttpRequests,
    response,
    text_response,
)
from fibws.hub.log.audit import Audit
from fibws.hub.memory.byte_room import ByteRoom, Reservation
from fibws.hub.recording import Recording
from fibws.hub.worker_threads import WorkerThreads

HELD = 2 * PIECE
"""Bytes in memory of one download: a piece, and what the network has still to take."""
FLAGS = os.O_RDONLY | getattr(os, "O_NOFOLLOW", 0) | getattr(os, "O_BINARY", 0)


RANGE = re.compile(r"bytes=(?:(\d{1,18})-(\d{1,18})?|-(\d{1,18}))", re.ASCII | re.IGNORECASE)


class RecordingRoute(FileRoute):
    """``/recordings/``.

    On a hub with authentication the client needs the right ``admin``.
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
        self._recording = recording
        super().__init__(requests, authentication, threads, room, audit)

    def _find(
        self, get: Get, path: str, principal: Principal | None, reservation: Reservation
    ) -> Callable[[], Response]:
        if principal is not None and not principal.rights.admin:
            fault = "recordings need a token with the right admin"
            self._audit.refused("right", fault, principal=principal.title, ip=get.address)
            raise FileRefused(http.HTTPStatus.FORBIDDEN, fault)
        found = self._recording.find(unquote(path))
        if found is None:
            fault = (
                "this hub has not recorded such a file since its start; see its folder (--record)"
            )
            raise FileRefused(http.HTTPStatus.NOT_FOUND, fault)
        return partial(self._make, found, get.headers, reservation)

    def _refusal(self, status: http.HTTPStatus, reason: str) -> Response:
        return text_response(status, reason)

    def _make(self, path: Path, asked: Headers, reservation: Reservation) -> Response:
        """Open a file; in any thread."""
        if not reservation.reserve(HELD):
            return self._busy()
        try:
            return _file_response(path, asked)
        except FileNotFoundError:
            fault = f"{path.name} is not complete yet, or has been removed"
        except OSError as error:
            fault = f"the hub cannot read {path.name}: {error.strerror}"
        return self._refusal(http.HTTPStatus.NOT_FOUND, fault)


def _file_response(path: Path, asked: Headers) -> Response:
    file = os.fdopen(os.open(path, FLAGS), "rb")
    info = os.fstat(file.fileno())
    if not stat.S_ISREG(info.st_mode):
        file.close()
        raise FileNotFoundError(path)
    part = requested_range(asked, info.st_size)
    if part is not None and not part:
        file.close()
        refusal = text_response(
            http.HTTPStatus.REQUESTED_RANGE_NOT_SATISFIABLE, f"{path.name} has no such bytes"
        )
        refusal.headers["Content-Range"] = f"bytes */{info.st_size}"
        return refusal
    headers = response(http.HTTPStatus.OK).headers
    headers["Content-Type"] = "application/octet-stream"
    headers["Content-Length"] = str(info.st_size if part is None else len(part))
    headers["Content-Disposition"] = f"attachment; filename*=UTF-8''{quote(path.name)}"
    headers["Accept-Ranges"] = "bytes"
    headers["Cache-Control"] = "no-store"
    headers["Content-Security-Policy"] = "default-src 'none'; sandbox"
    headers["Cross-Origin-Resource-Policy"] = "same-origin"
    if part is None:
        return FileResponse(headers, file, info.st_size)
    headers["Content-Range"] = f"bytes {part.start}-{part.stop - 1}/{info.st_size}"
    file.seek(part.start)
    return FileResponse(headers, file, len(part), http.HTTPStatus.PARTIAL_CONTENT)


def requested_range(headers: Headers, size: int) -> range | None:
    """Return the bytes that a client asks for, of a file of some size.

    Returns:
        None if it wants the whole file, asks for several parts, or has a part of a version that the
        hub cannot know; an empty range if there are no such bytes.
    """
    asked = headers.get_all("Range")
    if len(asked) != 1 or headers.get_all("If-Range"):
        return None
    found = RANGE.fullmatch(asked[0].strip())
    if found is None:
        return None
    first, last, length = found.groups()
    if length is not None:
        return range(max(0, size - int(length)), size)
    if last is not None and int(last) < int(first):
        return None
    return range(int(first), size if last is None else min(size, int(last) + 1))
