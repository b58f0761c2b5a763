"""The head of a client's first request: how long it may be, and why it is invalid."""

from __future__ import annotations

import http
from collections.abc import Generator

from websockets.datastructures import Headers
from websockets.exceptions import InvalidMessage
from websockets.extensions import Extension
from websockets.http11 import Request, Response
from websockets.server import ServerProtocol
from websockets.streams import StreamReader
from websockets.typing import LoggerLike

from fibws.hub.http.requests import text_response
from fibws.hub.websocket.deflate_extension import DeflateExtension, DeflateFactory
from fibws.hub.websocket.endpoint import Endpoints

SUBPROTOCOL = "Sec-WebSocket-Protocol"
_DEFLATE = DeflateFactory()


class HandshakeProtocol(ServerProtocol):
    """The library's part of a connection, with the hub's own limit of a request's head.

    That of the library is 8 KiB a line, which the cookies of other servers on the machine may
    exceed: browsers send them to all ports.

    Args:
        limit: most bytes of the head.
        max_size: most bytes of a message.
    """

    def __init__(
        self, endpoints: Endpoints, *, limit: int, max_size: int, logger: LoggerLike
    ) -> None:
        self.may_deflate = False
        """Whether the client's offer of permessage-deflate is accepted, if its protocol has long
        texts."""
        self._limit = limit
        self._endpoints = endpoints
        super().__init__(
            select_subprotocol=endpoints.select,
            extensions=[_DEFLATE],
            max_size=max_size,
            logger=logger,
        )

    def parse(self) -> Generator[None]:
        """Parse what arrives; called once, when the connection is made."""
        self.reader = _HeadReader(self._limit)
        return super().parse()

    def process_extensions(self, headers: Headers) -> tuple[str | None, list[Extension]]:
        """Return the header of the response for extensions, and those that are accepted."""
        if self.may_deflate and self._endpoints.has_texts(self.process_subprotocol(headers)):
            return super().process_extensions(headers)
        return None, []

    @property
    def deflate_bits(self) -> int:
        """The size of the client's window for compressed texts, as a power of two; 0 for none."""
        for each in self.extensions:
            assert isinstance(each, DeflateExtension)
            return each.bits
        return 0

    def refusal(self) -> str | None:
        """Return why the library has answered a request by itself, if it has."""
        fault = self.handshake_exc
        return None if fault is None or isinstance(fault, InvalidMessage) else str(fault)

    def response_to_invalid(self) -> Response | None:
        """Return the response to what is no valid request, which the library ends without one."""
        fault = self.handshake_exc
        cause = fault.__cause__ if isinstance(fault, InvalidMessage) else None
        if cause is None or isinstance(cause, EOFError):
            return None
        has_body = isinstance(cause, NotImplementedError) or "body" in str(cause)
        text = "Invalid HTTP request"
        if has_body:
            text += ": this port answers GET and HEAD without a body, and WebSockets"
        return text_response(http.HTTPStatus.BAD_REQUEST, text)


class _HeadReader(StreamReader):
    """Reads the lines of a head.

    Args:
        limit: most bytes of a line, whatever the library asks for.
    """

    def __init__(self, limit: int) -> None:
        super().__init__()
        self._limit = limit

    def read_line(
        self, m: int, too_long_exc_type: type[Exception] = RuntimeError
    ) -> Generator[None, None, bytearray]:
        """Read a line."""
        try:
            return (yield from super().read_line(self._limit, too_long_exc_type))
        except too_long_exc_type:
            raise too_long_exc_type(too_long(self._limit)) from None


def too_long(limit: int) -> str:
    """Return why a head is refused that is too long."""
    return f"the request's head is too long (limit {limit} bytes, --max-request-head)"


def drop_empty_subprotocols(request: Request) -> None:
    """Remove header lines that name no subprotocol, which the library refuses."""
    lines = request.headers.get_all(SUBPROTOCOL)
    named = [line for line in lines if line.strip()]
    if len(named) < len(lines):
        del request.headers[SUBPROTOCOL]
        for line in named:
            request.headers[SUBPROTOCOL] = line
