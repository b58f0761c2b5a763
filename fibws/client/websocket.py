"""A blocking WebSocket connection to a hub.

It uses the sans-I/O protocol of ``websockets``. With that library's own blocking connection, which
runs a thread, a short command takes a tenth more CPU time, and each received message a fifth more.
"""

from __future__ import annotations

import json
import math
import socket
import sys
import time
from collections import deque
from collections.abc import Mapping
from contextlib import suppress
from typing import Any, NamedTuple

from websockets.client import ClientProtocol
from websockets.exceptions import InvalidStatus
from websockets.frames import Frame, Opcode
from websockets.http11 import Response
from websockets.typing import Subprotocol
from websockets.uri import parse_uri

from fibws import credentials, hub_address, tls
from fibws.credentials import Credentials
from fibws.errors import AccessDenied, HubLost, HubUnreachable, InvalidAddress, NoHub, NotAHub
from fibws.protocol.refusals import Refusal
from fibws.protocol.serialized import SUBPROTOCOL
from fibws.protocol.websocket import SIZE_HEADER, UNLIMITED, largest_message

PATIENCE = 5.0
"""Seconds in which a hub must accept a connection, and close it."""
MOST_BYTES = 2**28
"""Maximum size of a message: no hub sends larger ones, and other servers must not fill the memory.
"""
MOST_FRAGMENTS = 4096
"""Maximum number of frames of a message: empty frames do not count towards its size."""
MOST_REDIRECTS = 5
# Messages of 1 MB take half the CPU time that they take with 2**18.
_CHUNK = 2**16
# Ctrl-C does not interrupt a socket on Windows.
_SLICE = 0.5 if sys.platform == "win32" else None


REDIRECTS = (301, 302, 303, 307, 308)
"""HTTP's statuses for a resource that is elsewhere (RFC 9110, section 15.4)."""


class _Redirect(Exception):
    def __init__(self, url: str) -> None:
        self.url = url


class ReceivedMessage(NamedTuple):
    """A WebSocket message."""

    data: bytes | bytearray
    is_binary: bool


class WebSocket:
    """A connection to a hub, open once it is created.

    It offers the subprotocol ``fibws.v1``. A server that does not select it is spoken to in plain
    rosbridge.

    Args:
        url: the hub's URL.
        node: the tool's node name.
        token: the tool's token, if the hub wants one.

    Raises:
        NoHub: nothing listens there.
        HubUnreachable: the server is not a hub, or refuses the connection.
        AccessError: the file of the token cannot be read.
    """

    def __init__(self, url: str, node: str, token: Credentials | None = None) -> None:
        self.url = url
        """The hub's URL, after redirects."""
        self._first_url = url
        self._credentials = token or Credentials()
        self._token = self._credentials.read()
        self._headers = credentials.headers(self._token)
        self._next_check = math.inf
        """When the file of the token must be read again, by the monotonic clock."""
        self.largest = UNLIMITED
        """Bytes that the hub takes in one message."""
        self._has_denied = False
        """Whether `AccessDenied` has been raised."""
        self.messages: deque[ReceivedMessage] = deque()
        """Received messages; the caller of `read` removes them."""
        self._fragments: list[bytes | bytearray] = []
        self._is_binary = False
        for _ in range(1 + MOST_REDIRECTS):
            uri = parse_uri(hub_address.node_url(self.url, node))
            # With a timeout of 0, TLS reports missing data as an error.
            self._least_wait = 0.001 if uri.secure else 0.0
            self._protocol = ClientProtocol(
                uri,
                subprotocols=[Subprotocol(SUBPROTOCOL)],
                max_size=MOST_BYTES,
                logger=credentials.handshake_log(),
            )
            self._socket = self._connect(uri.host, uri.port, secure=uri.secure)
            try:
                self._shake_hands()
                self._plan_renewal()
                return
            except _Redirect as redirect:
                self._socket.close()
                self._redirect(redirect.url)
            except BaseException:
                self._socket.close()
                raise
        raise HubUnreachable(url, f"too many redirects (limit {MOST_REDIRECTS})")

    @property
    def serialized(self) -> bool:
        """Whether the server selected ``fibws.v1``: binary messages are serialized messages."""
        return self._protocol.subprotocol == SUBPROTOCOL

    def fileno(self) -> int:
        """Return the socket's descriptor for ``select``."""
        return self._socket.fileno()

    def send(self, text: bytes) -> None:
        """Send a text message; raise `HubLost` if the connection is lost."""
        self._protocol.send_text(text)
        self._flush()

    def read(self, timeout: float | None) -> bool:
        """Wait for data and append the complete messages to `messages`.

        Args:
            timeout: maximum seconds to wait; None to wait without a limit.

        Returns:
            Whether data was received, or there is time left to wait for it.

        Raises:
            HubLost: the connection is lost, and all messages received before have been removed.
            AccessDenied: likewise, and the hub has closed it for good.
            HubUnreachable: the server is not a hub.
        """
        waits = [each for each in (timeout, _SLICE, self._renew()) if each is not None]
        waited = max(self._least_wait, min(waits)) if waits else None
        self._socket.settimeout(waited)
        try:
            data = self._socket.recv(_CHUNK)
        except (TimeoutError, BlockingIOError):
            return timeout is None or (waited is not None and waited < timeout)
        except OSError as error:
            raise HubLost(self.url, _text(error)) from None
        if data:
            self._protocol.receive_data(data)
        else:
            self._protocol.receive_eof()
        for event in self._protocol.events_received():
            if isinstance(event, Frame):
                self._take(event)
            elif isinstance(event, Response):
                self._answered(event)
        if self._protocol.parser_exc is not None and self._protocol.handshake_exc is None:
            raise self.not_a_hub(str(self._protocol.parser_exc))
        self._flush()
        if not data or (self._protocol.close_rcvd is not None and not self.messages):
            close = self._protocol.close_rcvd
            if close is not None and (denied := self._denied(close.code, close.reason)):
                self._has_denied = True
                raise denied
            cause = "connection lost" if close is None else close.reason or f"code {close.code}"
            raise HubLost(self.url, cause)
        return True

    def _renew(self) -> float | None:
        """Give the hub the next token from the file before the current one, a JWT, expires.

        Returns:
            The seconds until the file must be read again, if ever.
        """
        if self._next_check == math.inf:
            return None
        if time.monotonic() >= self._next_check:
            token = self._credentials.replacement(self._token)
            if token is not None:
                self._token = token
                self.send(json.dumps({"op": "auth", "token": token}).encode())
            self._plan_renewal()
        return max(0.0, self._next_check - time.monotonic())

    def _plan_renewal(self) -> None:
        token = self._token if self.has_sent_token else None
        pause = self._credentials.next_check(token, time.time())
        self._next_check = math.inf if pause is None else time.monotonic() + pause

    def _answered(self, response: Response) -> None:
        """Handle the response to the handshake."""
        if self._protocol.handshake_exc is not None:
            raise self._refusal(self._protocol.handshake_exc)
        self.largest = largest_message(response.headers.get(SIZE_HEADER))

    def close(self) -> None:
        """Close the connection after the hub has read everything that was sent.

        Raises:
            AccessDenied: the hub has not read it, because it had closed the connection for good;
                not if `read` has raised that before.
        """
        try:
            if self._protocol.state.name == "OPEN":
                self._protocol.send_close(1000)
            self._flush()
            deadline = time.monotonic() + PATIENCE
            while not self._has_denied and (rest := deadline - time.monotonic()) > 0:
                if not self.read(rest):
                    break
                self.messages.clear()
        except AccessDenied:
            raise
        except (HubLost, HubUnreachable):
            pass  # HubLost is expected; HubUnreachable has been reported before.
        finally:
            self._socket.close()

    def abort(self) -> None:
        """Close the connection without waiting: Ctrl-C may have interrupted a read or a send."""
        with suppress(Exception):
            self._protocol.send_close(1000)
            self._flush()
        self._socket.close()

    def not_a_hub(self, fault: str) -> HubUnreachable:
        """Return the error for a server that violates the protocol."""
        return NotAHub(self.url, fault)

    def _connect(self, host: str, port: int, *, secure: bool) -> socket.socket:
        try:
            connected = socket.create_connection((host, port), PATIENCE)
            try:
                connected.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
                if not secure:
                    return connected
                context = tls.TlsFiles.choose().context(self.url)
                return context.wrap_socket(connected, server_hostname=host)
            except BaseException:
                connected.close()
                raise
        except (ConnectionRefusedError, TimeoutError, socket.gaierror) as error:
            raise NoHub(self.url, _text(error)) from None
        except OSError as error:
            raise HubUnreachable(self.url, _text(error)) from None

    def _shake_hands(self) -> None:
        request = self._protocol.connect()
        request.headers.update(self._headers)
        self._protocol.send_request(request)
        try:
            self._flush()
            deadline = time.monotonic() + PATIENCE
            while self._protocol.state.name == "CONNECTING":
                if self._protocol.handshake_exc is not None:
                    raise self._refusal(self._protocol.handshake_exc)
                if not self.read(deadline - time.monotonic()):
                    raise HubUnreachable(self.url, f"no handshake within {PATIENCE:g} s")
        except HubLost as error:
            fault = self._protocol.handshake_exc
            if fault is None:
                raise HubUnreachable(self.url, error.cause) from None
            raise _unreachable(self.url, fault) from None

    def _redirect(self, url: str) -> None:
        """Continue at another address, without the token if it is another server's."""
        if _origin(url) != _origin(self.url):
            self._headers = {}
        self.url = url

    @property
    def has_sent_token(self) -> bool:
        """Whether the hub was given the token; a redirect to another server is followed without."""
        return bool(self._headers)

    @property
    def headers(self) -> Mapping[str, str]:
        """The headers of the token, for other requests to the same server."""
        return self._headers

    def certificate_end(self) -> float | None:
        """Return when the server's certificate ends, in seconds since 1970; None without TLS."""
        certificate: Mapping[str, Any] = getattr(self._socket, "getpeercert", dict)()
        return tls.end_of(certificate) if certificate else None

    def missing_token(self) -> AccessDenied:
        """Return the error for a hub that waits for a token."""
        self._has_denied = True
        return self._credentials.missing(self.url, self._first_url)

    def _denied(self, code: int, reason: str) -> AccessDenied | None:
        return self._credentials.refusal(
            self.url,
            code,
            reason,
            sent=self.has_sent_token,
            redirected_from=self._first_url,
            certificate=tls.TlsFiles.choose().client_cert if self.url.startswith("wss:") else None,
        )

    def _refusal(self, error: Exception) -> Exception:
        """Return the error for a failed handshake; `_Redirect` if the hub is elsewhere."""
        if isinstance(error, InvalidStatus) and error.response.status_code in REDIRECTS:
            if location := error.response.headers.get("Location"):
                try:
                    return _Redirect(hub_address.redirected(self.url, location))
                except InvalidAddress as fault:
                    return HubUnreachable(self.url, str(fault))
        return _unreachable(self.url, error)

    def _take(self, frame: Frame) -> None:
        if frame.opcode in (Opcode.TEXT, Opcode.BINARY):
            self._is_binary = frame.opcode is Opcode.BINARY
        elif frame.opcode is not Opcode.CONT:
            return
        if len(self._fragments) == MOST_FRAGMENTS:
            raise self.not_a_hub(f"it sent a message of more than {MOST_FRAGMENTS} fragments")
        data = frame.data
        assert not isinstance(data, memoryview), "only frames to be sent may have views"
        if not frame.fin:
            self._fragments.append(data)
            return
        if self._fragments:
            data = b"".join([*self._fragments, data])
            self._fragments = []
        self.messages.append(ReceivedMessage(data, self._is_binary))

    def _flush(self) -> None:
        """Write what the protocol has queued; empty bytes mean the end of the stream."""
        self._socket.settimeout(None)
        try:
            for data in self._protocol.data_to_send():
                if data:
                    self._socket.sendall(data)
        except OSError as error:
            raise HubLost(self.url, _text(error)) from None


def _origin(url: str) -> tuple[bool, str, int]:
    uri = parse_uri(url)
    return uri.secure, uri.host, uri.port


def _text(error: OSError) -> str:
    if fault := tls.fault(error):
        return fault
    return (error.strerror or str(error) or type(error).__name__).lower()


def _unreachable(url: str, error: Exception) -> HubUnreachable:
    """Return why the handshake failed: a hub explains it in the body of its HTTP response."""
    if not isinstance(error, InvalidStatus):
        return NotAHub(url, tls.expects_tls(error) or str(error))
    response = error.response
    content_type = response.headers.get("Content-Type", "")
    refusal = Refusal(
        response.status_code, response.reason_phrase, content_type, bytes(response.body or b"")
    )
    texts = (400, 403, 404, 426, 429, 503)  # 503: the hub is full, or about to end.
    is_explained = refusal.status in (
        texts if content_type.startswith("text/plain") else (400, 403)
    )
    if is_explained and refusal.text and "html" not in content_type:
        return HubUnreachable(url, refusal.text)
    return NotAHub(url, str(refusal))
