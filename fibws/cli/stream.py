"""The bytes between a tool and a hub: connect, shake hands, and hand on whole messages.

The WebSocket protocol is that of the library without its sockets, since those that it has bring
threads or asyncio along, which take longer to load than a tool runs.
"""

from __future__ import annotations

import socket
import sys
import time
from collections import deque
from contextlib import suppress

from websockets.client import ClientProtocol
from websockets.exceptions import InvalidStatus
from websockets.frames import Frame, Opcode
from websockets.http11 import Response
from websockets.uri import parse_uri

from fibws.errors import HubLost, HubUnreachable, NoHub
from fibws.node import address

PATIENCE = 5.0
"""Seconds in which a hub must take a connection, and let go of it."""
MOST_BYTES = 2**28
"""Bytes of one message: no hub has larger ones, and what is none must not fill the memory."""
MOST_FRAGMENTS = 4096
"""Frames of one message: empty ones do not count towards its size."""
LONGEST_FAULT = 300
"""Characters of a refusal's words: whatever answers there may have said them."""
_CHUNK = 2**18
# Ctrl-C does not wake a socket on Windows.
_SLICE = 0.5 if sys.platform == "win32" else None


class Stream:
    """One connection to a hub, open from its making on.

    Args:
        url: the hub's URL.
        node: the name that the tool has as a node.

    Raises:
        NoHub: nothing answers there.
        HubUnreachable: what answers is no hub, or will not have this tool.
    """

    def __init__(self, url: str, node: str) -> None:
        self.url = url
        self.messages: deque[bytes] = deque()
        """Those that have come, for whoever reads to take away."""
        self._fragments: list[bytes] = []
        uri = parse_uri(address.node_url(url, node))
        # With none at all, TLS would say of nothing that it is an error.
        self._least_wait = 0.001 if uri.secure else 0.0
        self._protocol = ClientProtocol(uri, max_size=MOST_BYTES)
        self._socket = self._connect(uri.host, uri.port, secure=uri.secure)
        try:
            self._shake_hands()
        except BaseException:
            self._socket.close()
            raise

    def fileno(self) -> int:
        """For ``select``: when this can be read, there may be something to `read`."""
        return self._socket.fileno()

    def send(self, text: bytes) -> None:
        """Send a message; it raises `HubLost` if there is no hub any more."""
        self._protocol.send_text(text)
        self._flush()

    def read(self, timeout: float | None) -> bool:
        """Take in what the hub has sent; False if that was nothing for so many seconds.

        Raises:
            HubLost: there is no hub any more, and no message that it has sent before.
            HubUnreachable: what answers is no hub.
        """
        waits = [each for each in (timeout, _SLICE) if each is not None]
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
            elif isinstance(event, Response) and self._protocol.handshake_exc is not None:
                raise HubUnreachable(self.url, _fault(self._protocol.handshake_exc))
        if self._protocol.parser_exc is not None and self._protocol.handshake_exc is None:
            raise self.no_hub(str(self._protocol.parser_exc))
        self._flush()
        if not data or (self._protocol.close_rcvd is not None and not self.messages):
            close = self._protocol.close_rcvd
            said = "the connection broke" if close is None else close.reason or f"code {close.code}"
            raise HubLost(self.url, said)
        return True

    def close(self) -> None:
        """Say good-bye, and wait until the hub has read all that was sent."""
        try:
            if self._protocol.state.name == "OPEN":
                self._protocol.send_close(1000)
            self._flush()
            deadline = time.monotonic() + PATIENCE
            while (rest := deadline - time.monotonic()) > 0 and self.read(rest):
                self.messages.clear()
        except (HubLost, HubUnreachable):
            pass  # The first is as it should be, and the second has been told.
        finally:
            self._socket.close()

    def leave(self) -> None:
        """Say good-bye and go: what Ctrl-C broke into may be in no state to be gone on with."""
        with suppress(Exception):
            self._protocol.send_close(1000)
            self._flush()
        self._socket.close()

    def no_hub(self, fault: str) -> HubUnreachable:
        """The error that what answers there speaks as no hub does."""
        return HubUnreachable(self.url, f"what answers there is no hub ({fault})")

    def _connect(self, host: str, port: int, *, secure: bool) -> socket.socket:
        try:
            connected = socket.create_connection((host, port), PATIENCE)
            connected.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
            if not secure:
                return connected
            import ssl  # 20 ms that few need

            return ssl.create_default_context().wrap_socket(connected, server_hostname=host)
        except (ConnectionRefusedError, TimeoutError) as error:
            raise NoHub(self.url, _text(error)) from None
        except OSError as error:
            raise HubUnreachable(self.url, _text(error)) from None

    def _shake_hands(self) -> None:
        self._protocol.send_request(self._protocol.connect())
        try:
            self._flush()
            deadline = time.monotonic() + PATIENCE
            while self._protocol.state.name == "CONNECTING":
                if self._protocol.handshake_exc is not None:
                    raise HubUnreachable(self.url, _fault(self._protocol.handshake_exc))
                if not self.read(deadline - time.monotonic()):
                    raise HubUnreachable(self.url, f"no handshake within {PATIENCE:g} s")
        except HubLost as error:
            fault = self._protocol.handshake_exc
            cause = error.cause if fault is None else _fault(fault)
            raise HubUnreachable(self.url, cause) from None

    def _take(self, frame: Frame) -> None:
        if frame.opcode not in (Opcode.TEXT, Opcode.BINARY, Opcode.CONT):
            return
        if len(self._fragments) == MOST_FRAGMENTS:
            raise self.no_hub(f"it sends a message in more than {MOST_FRAGMENTS} fragments")
        self._fragments.append(bytes(frame.data))
        if frame.fin:
            data, self._fragments = b"".join(self._fragments), []
            self.messages.append(data)

    def _flush(self) -> None:
        """Send what the protocol has to say; empty bytes stand for the end of the stream."""
        self._socket.settimeout(None)
        try:
            for data in self._protocol.data_to_send():
                if data:
                    self._socket.sendall(data)
        except OSError as error:
            raise HubLost(self.url, _text(error)) from None


def _text(error: OSError) -> str:
    if type(error).__module__ == "ssl":  # which need not be imported for that
        fault = getattr(error, "verify_message", "")
        return f"its certificate: {fault}" if fault else "it speaks no TLS, so write ws://"
    return (error.strerror or str(error) or type(error).__name__).lower()


def _fault(error: Exception) -> str:
    """Why the handshake failed, in the hub's own words if it is one."""
    if isinstance(error, InvalidStatus):
        words = bytes(error.response.body or b"").decode(errors="replace").split()
        body = " ".join(words).rstrip(".")[:LONGEST_FAULT]
        if error.response.status_code in (400, 403) and body:
            return body
    return f"what answers there is no hub ({error})"
